"""How many texels the passes fetch."""

import numpy as np

from bokeh_validation import methods
from bokeh_validation.passes import COPYING_ENTRIES, Pass

KINDS = ("color", "depth", "table")


def of_pass(item: Pass, in_focus: bool = False) -> dict[str, int]:
    """KINDS -> fetches for a texel of a pass's targets where it takes all of its samples.

    in_focus  of the layers: where nothing around is out of focus
    """
    if is_layers(item):
        return {"color": _of_layers(item, in_focus), "depth": 0, "table": 0}
    color = 1 if item.entry in COPYING_ENTRIES else _of_filter(item)
    # depth is fetched beside each colour but that of the other parallelogram
    depth = color - item.entry.endswith("Final") if "DepthSamp" in item.inputs else 0
    return {"color": color, "depth": depth, "table": item.samples if "KernelSamp" in item.inputs else 0}


def of_frame(passes: tuple[Pass, ...]) -> dict[str, float]:
    """KINDS -> the same for a pixel of the full size, all passes together."""
    counts = [(of_pass(item), item.scale**2) for item in passes]
    return {kind: sum(count[kind] / texel for count, texel in counts) for kind in KINDS}


def of_filters(passes: tuple[Pass, ...]) -> float:
    """Colour fetches a pixel of all filter passes: samples of every line, the pixel itself, other textures read."""
    return of_frame(tuple(item for item in passes if item.entry not in COPYING_ENTRIES))["color"]


def is_layers(item: Pass) -> bool:
    """Whether a pass is one of bokeh_layers.*."""
    return "BOKEH_LAYER_RINGS" in item.defines and item.entry not in COPYING_ENTRIES


def _of_filter(item: Pass) -> int:
    stem = item.entry.removeprefix("Bokeh")
    sides = methods.EXACT.get(stem.removesuffix("First").removesuffix("Second").lower())
    lines = sides // 2 - 1 if sides else 1
    if stem == "ExactEdge":
        lines = round(item.values()["BokehEdge"]) - 1
    others = 1 if stem.endswith("Final") else 0
    return 1 + others + lines * (item.samples**2 if stem == "NaiveGrid" else item.samples)


def _of_layers(item: Pass, in_focus: bool) -> int:
    """As the loops of bokeh_layers.* count."""
    values = item.values()
    sides = round(values["BokehSides"])
    rings, cells, cubic = (item.defines[f"BOKEH_LAYER_{name}"] for name in ("RINGS", "CELLS", "CUBIC"))
    # tiles along one axis; float32 as on the device
    largest = np.float32(values["BokehMaxCoC"]) * np.float32(values["BokehImageHeight"])
    along = min(2 * (int(np.ceil(largest / np.float32(16.0))) + 2) + 1, 255)

    if in_focus:
        cells = 0

    def ring_samples(count: int) -> int:
        return 0 if in_focus else sum(sides * max(int(6 * ring / sides + 0.5), 1) for ring in range(1, count + 1))

    stem = item.entry.removeprefix("Bokeh").removesuffix("One")
    if stem.endswith(("LayerFirst", "LayerSecond")):
        return 1 + max((sides // 2 - 1) * cells, 1)
    return {
        "LayerTiles": 8 * 8,
        "LayerReach": along,
        "LayerSplit": 1 + 2 * 2 + (0 if in_focus else 4 * 4 + 2 * 2),
        "LayerKernels": 2 * 4 * 4,
        "LayerSpread": 1 + 2 * along,
        "LayerSizes": 2 + 2 * along,
        "LayerHoles": 1 + 4 * 4,
        "LayerFill": 1 + 3 * (1 + ring_samples(2)),
        "LayerEdge": 1 + max((round(values["BokehEdge"]) - 1) * cells, 1),
        "Layered": 2 + (0 if in_focus else 2 * (5 if cubic else 1) + ring_samples(rings) + 2),
    }[stem]
