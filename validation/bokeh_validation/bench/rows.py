"""What is measured: the methods of Table 1, the defaults, adaptive counts, a picture in focus, the layers, and how time
grows: with the number of samples, with the CoC, with the size of the picture.
"""

from dataclasses import dataclass, replace
from math import ceil, pi, tan
from typing import NamedTuple

import numpy as np

from bokeh_validation.bench import floors
from bokeh_validation.frame import fetches, methods
from bokeh_validation.reference import listings, segments
from bokeh_validation.reference.lines import lines
from bokeh_validation.shaders.entries import COPYING_ENTRIES
from bokeh_validation.shaders.passes import Pass
from bokeh_validation.truth import ray_traced

# Samples on a line for the effective counts of Table 1: 16, 64, 144, 256, 400, 576
SIDES = (4, 8, 12, 16, 20, 24)
QUICK_SIDES = (4, 12, 24)
SCENE = ray_traced.STREET
# Of the layers: much of it is out of focus, near and far
LAYERS_SCENE = ray_traced.MARKET
LAYERS_PAPER = "paper hexagon, layers"
# Constant CoC of Table 1, fraction of the image height: BOKEH_MAX_COC as it comes. The paper does not say which it had.
COC = 0.1
# As many as a line of CoC length can take at a sample a pixel in a picture of 2540 rows
MOST = 254
FARTHEST = 1e4  # metres: the floors add up depth, and infinity has no mean
TARGET_BYTES = 8  # RGBA16F


@dataclass(frozen=True)
class Row:
    """One method with its settings.

    key        its name in the results
    group      'table 1', 'default', 'adaptive', 'in focus' or 'layers'
    effective  effective samples as the paper counts them; None where the count follows the CoC
    passes     what is timed
    floor      what it is held against; the layers have none
    versus     key -> row that it is divided by: 'naive' and 'paper', where there is one
    """

    key: str
    group: str
    settings: methods.Settings
    effective: int | None
    passes: tuple[Pass, ...]
    floor: tuple[Pass, ...]
    versus: dict[str, str]


def edge_samples(aperture: str, line_samples: int) -> int:
    """Samples on an edge, 2 or more, at least as close to each other as `line_samples` on a line of the paper's.

    The paper's line is as long as its polygon is wide. A hexagon is twice as wide as its edge from corner to corner, an
    octagon 2.414 times from side to side.
    """
    share = 0.5 if aperture == "hexagon" else tan(pi / 8)
    return max(2, ceil(line_samples * share))


def _row(key: str, group: str, settings: methods.Settings, size, effective=None, **versus: str) -> Row:
    passes = methods.plan(settings, size).passes
    floor = ()
    if group != "layers":
        floor = floors.one_fetch(passes) if group == "in focus" else floors.floor(passes)
    return Row(key, group, settings, effective, passes, floor, versus)


def _polygons(group: str, end: str, size, settings, effective: int | None = None, **versus: str) -> list[Row]:
    """Hexagon and octagon by the paper's method and by `exact`; settings: (method, aperture) -> Settings."""
    rows = []
    for aperture in ("hexagon", "octagon"):
        paper, exact = f"paper {aperture}{end}", f"exact {aperture}{end}"
        rows.append(_row(paper, group, settings("paper", aperture), size, effective, **versus))
        rows.append(_row(exact, group, settings("exact", aperture), size, effective, **versus, paper=paper))
    return rows


def _spaced(line: int):
    """A constant CoC, `line` samples on a line of the paper's, as close to each other on an edge."""

    def settings(method: str, aperture: str) -> methods.Settings:
        samples = edge_samples(aperture, line) if method == "exact" else line
        return methods.Settings(method, aperture, samples, camera=methods.Camera(max_coc=1.0), coc=COC)

    return settings


def table_one(size: tuple[int, int], sides: tuple[int, ...] = SIDES) -> list[Row]:
    """Naive, the paper's polygons and `exact` at the same sample spacing, with a constant CoC."""
    rows = []
    for side in sides:
        naive, settings = f"naive {side**2}", _spaced(side)
        rows.append(_row(naive, "table 1", settings("naive-grid", "hexagon"), size, side**2))
        rows += _polygons("table 1", f" {side**2}", size, settings, side**2, naive=naive)
    return rows


def defaults(size: tuple[int, int]) -> list[Row]:
    """The counts that nobody asked for: 13 on a line, 7 and 6 on an edge."""
    return _polygons("default", "", size, _spaced(methods.PAPER_SAMPLES), methods.PAPER_SAMPLES**2)


def adaptive(size: tuple[int, int]) -> list[Row]:
    """A sample a pixel, the CoC from depth; `paper` does not blur it, so that its floor fetches at the same places."""

    def settings(method: str, aperture: str) -> methods.Settings:
        dense = {"spacing": 1.0, "samples": MOST, "blur_coc": method == "exact"}
        return methods.Settings(method, aperture, camera=SCENE.camera, **dense)

    return _polygons("adaptive", " adaptive", size, settings)


def in_focus(size: tuple[int, int]) -> list[Row]:
    """The two passes of `exact` where every pixel is in focus, against one fetch and one write for each target.

    They read 'sharp', a picture with a CoC of 0: the pass that makes the CoC is not in the time.
    """
    rows = []
    for aperture in ("hexagon", "octagon"):
        settings = methods.Settings("exact", aperture, coc=0.0, spacing=1.0, samples=65)
        found = _row(f"exact {aperture} in focus", "in focus", settings, size)
        for part in ("passes", "floor"):
            sharp = tuple(
                replace(item, inputs={slot: name.replace("coc", "sharp") for slot, name in item.inputs.items()})
                for item in getattr(found, part)[1:]
            )
            found = replace(found, **{part: sharp})
        rows.append(found)
    return rows


def layers(size: tuple[int, int]) -> list[Row]:
    """`layered` against the paper's hexagon with 13 samples, all with the CoC from depth; and a picture in focus."""
    camera = LAYERS_SCENE.camera
    layered = methods.Settings("layered", "hexagon", camera=camera)
    every = {f"layered {preset}": replace(layered, preset=preset) for preset in ("low", "medium", "high")}
    every["layered in focus"] = replace(layered, coc=0.0)
    paper = _row(LAYERS_PAPER, "layers", methods.Settings("paper", "hexagon", camera=camera), size)
    return [paper, *(_row(key, "layers", one, size, paper=LAYERS_PAPER) for key, one in every.items())]


# Growth: CoC as fractions of the image height, and sides of the picture relative to the size that is measured
COCS = (0.025, 0.05, 0.1, 0.2)
SCALES = (0.5, 0.7071, 1.0, 1.4142)
CURVES = (
    ("naive 144", methods.Settings("naive-grid", "hexagon", 12)),
    ("paper hexagon 144", methods.Settings("paper", "hexagon", 12)),
    ("exact hexagon 144", methods.Settings("exact", "hexagon", 6)),
    ("exact hexagon adaptive", methods.Settings("exact", "hexagon", spacing=1.0, samples=MOST)),
)
# x of a curve, size, passes
Point = tuple[float, tuple[int, int], tuple[Pass, ...]]


def _passes(settings: methods.Settings, size: tuple[int, int], coc: float) -> tuple[Pass, ...]:
    return methods.plan(replace(settings, camera=methods.Camera(max_coc=1.0), coc=coc), size).passes


def with_coc(size: tuple[int, int]) -> dict[str, list[Point]]:
    """Time against the CoC, pixels: fixed counts stay, adaptive ones grow with it."""
    return {
        name: [(coc * size[1], size, _passes(settings, size, coc)) for coc in COCS] for name, settings in CURVES[1:]
    }


def with_size(size: tuple[int, int]) -> dict[str, list[Point]]:
    """Time against the number of pixels, the CoC a constant fraction of the height."""
    sizes = [tuple(max(2, round(side * scale)) for side in size) for scale in SCALES]
    return {
        name: [(float(w * h), (w, h), _passes(settings, (w, h), COC)) for w, h in sizes] for name, settings in CURVES
    }


def textures(size: tuple[int, int], file: ray_traced.SceneFile = SCENE) -> dict[str, np.ndarray]:
    """A scene at (width, height), nearest texel: 'color', 'depth', and 'sharp' with alpha 0."""
    scene = ray_traced.picture(file)
    width, height = scene.size
    columns, lines = np.arange(size[0]) * width // size[0], np.arange(size[1]) * height // size[1]
    color = scene.color[lines][:, columns]
    sharp = color.copy()
    sharp[..., 3] = 0.0
    depth = np.minimum(scene.depth[lines][:, columns], np.float32(FARTHEST))
    return {"color": color, "depth": depth, "sharp": sharp}


class Cost(NamedTuple):
    """Of one picture: passes, and a pixel's colour and depth fetches and bytes written.

    Fetches are means; of the layers they are the most that a pixel takes, or all that it takes in focus. A texel of a
    target of 1 / n of the size counts 1 / n^2.
    """

    passes: int
    color: float
    depth: float
    written: float


def stored_coc(item: Pass, depth: np.ndarray) -> np.ndarray:
    """Size of the CoC that the first pass stores in a half float, from depth (H, W) in metres; (H, W)."""
    values = item.values()
    if item.entry not in COPYING_ENTRIES:
        found = np.zeros(depth.shape)  # it reads 'sharp'
    elif item.entry == "BokehConstantCoC":
        found = np.full(depth.shape, min(values["BokehConstantCoC"], values["BokehMaxCoC"]))
    else:
        names = ("ApertureDiameter", "FocalLength", "FocusDistance", "SensorHeight", "MaxCoC")
        lens = (values[f"Bokeh{name}"] for name in names)
        found = listings.circle_of_confusion(listings.safe_depth(depth.astype(np.float64)), *lens)
    return found.astype(np.float16).astype(np.float64)


def cost(passes: tuple[Pass, ...], depth: np.ndarray) -> Cost:
    """Cost of a plan on this depth, (H, W) in metres: filter passes that all blur by the CoC of the first pass."""
    coc, height = stored_coc(passes[0], depth), len(depth)
    color, of_depth, written = 0.0, 0.0, 0.0
    for item in passes:
        texel, spacing = 1.0 / item.scale**2, floors.adaptive(item)
        counts = fetches.of_pass(item, not coc.any())
        if spacing > 0.0 and not item.spec.layers and (along := lines(item)):
            used = segments.filter_coc(coc, height, spacing)
            cells = sum(
                np.ceil(np.clip(2.0 * line.segment.half_length * used * height / spacing, 1.0, item.samples))
                for line in along
            )
            samples = np.where(used > 0.0, cells, 0.0)
            counts["color"] = float(samples.mean()) + 1 + len(floors.others(item))
            counts["depth"] = float((samples + (used > 0.0)).mean()) if "DepthSamp" in item.inputs else 0.0
        color, of_depth = color + counts["color"] * texel, of_depth + counts["depth"] * texel
        written += TARGET_BYTES * len(item.outputs) * texel
    return Cost(len(passes), color, of_depth, written)
