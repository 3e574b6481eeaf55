"""Describe the entry points of bokeh_passes.*: what each reads, how many targets it writes, and its role."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

COPY, DEPTH, LATERAL, STEADY, VIEW = "copy", "depth", "lateral", "steady", "view"
LINE, ADAPTIVE, GRID, TABLE = "line", "adaptive", "grid", "table"
FIRST, SECOND, EDGE, LAYERS = "first", "second", "edge", "layers"

# Polygons of the exact and layered methods -> number of sides; their entries' names begin with the polygon's
EXACT = {"square": 4, "hexagon": 6, "octagon": 8, "decagon": 10}
# Sides of the layered polygons for which one pass draws both layers, since that takes four targets at most
BOTH = (4, 6)
# Layer, as it is called in the names of the entries that blur it alone -> Entry.given
ONE_LAYER = {"Near": {"isFar": "false"}, "Far": {"isFar": "true"}}
COLORS = ("ColorSamp", "ColorSampB", "ColorSampC", "ColorSampD", "ColorSampE", "ColorSampF")


@dataclass(frozen=True)
class Most:
    """Hold the maximum work of the loops of bokeh_layers.* with the settings of a frame (plan/fetches.py).

    along   tiles that a tile pass reads along one axis
    filled  texels that HoleFill reads from each of its two textures, the centre included
    layer   fetches with which Composite enlarges one layer
    gather  samples of Composite's gather
    scale   size of the image / size of a layer
    """

    along: int
    filled: int
    layer: int
    gather: int
    scale: int


@dataclass(frozen=True)
class Entry:
    """Describe an entry point by its stem: HLSL and WGSL add _PS, GLSL has a main() chosen by BOKEH_PASS.

    role      COPY makes a CoC map from colour, STEADY stabilises it; DEPTH computes linear depth, LATERAL lateral
              colour, VIEW the debug view. LINE blurs along a line with a fixed number of samples, ADAPTIVE along a
              line of any length and spacing; GRID and TABLE gather in two dimensions. FIRST and SECOND are the passes
              of an exact polygon, or of a layer's polygon if `layers` is true; EDGE writes one target of FIRST. LAYERS
              are the other passes of bokeh_layers.*
    textures  slots that it reads
    targets   number of targets that it writes
    sides     of its polygon; 0 if a parameter sets them, or if it has no polygon
    layers    whether it belongs to bokeh_layers.*
    whole     name of the entry with several targets of which it writes one, number BOKEH_TARGET_INDEX
    given     parameter of the library's function -> the literal that this entry passes, in GLSL
    fetches   for passes of the layers other than lines: the maximum per texel; for several targets, followed by the
              maximum of each target drawn alone, whose program omits the fetches that only the others need
    """

    name: str
    role: str
    textures: tuple[str, ...]
    targets: int = 1
    sides: int = 0
    layers: bool = False
    whole: str = ""
    given: Mapping[str, str] = field(default_factory=dict)
    fetches: Callable[[Most], tuple[int, ...]] | None = None


def _polygon(word: str, sides: int) -> tuple[Entry, Entry]:
    """Return the two passes of an exact polygon."""
    stem, between = f"Bokeh{word.capitalize()}", sides // 2 - 1
    return (
        Entry(f"{stem}First", FIRST, COLORS[:1], between, sides),
        Entry(f"{stem}Second", SECOND, COLORS[:between], sides=sides),
    )


def _layer_polygon(word: str, sides: int) -> tuple[Entry, ...]:
    """Return the passes that blur the layers, two for both layers if `sides` is in BOTH, else two for each layer.

    The layer CoC has a slot of its own, the fifth of the second pass.
    """
    stem, between = f"Bokeh{word.capitalize()}", sides // 2 - 1
    if sides in BOTH:
        return (
            Entry(f"{stem}LayerFirst", FIRST, COLORS[:5], 2 * between, sides, layers=True),
            Entry(f"{stem}LayerSecond", SECOND, (*COLORS[: 2 * between], COLORS[4]), 2, sides, layers=True),
        )
    return tuple(
        entry
        for layer, given in ONE_LAYER.items()
        for entry in (
            Entry(f"{stem}{layer}First", FIRST, COLORS[:3], between, sides, layers=True, given=given),
            Entry(f"{stem}{layer}Second", SECOND, (*COLORS[:between], COLORS[4]), 1, sides, layers=True, given=given),
        )
    )


def _layers(name: str, textures: int, targets: int, fetches: Callable[[Most], tuple[int, ...]], **given: str) -> Entry:
    return Entry(f"Bokeh{name}", LAYERS, COLORS[:textures], targets, layers=True, given=given, fetches=fetches)


_SEVERAL = (
    _layers("Prefilter", 2, 4, lambda most: tuple(1 + count * (most.scale // 2) ** 2 for count in (4 + 4, 8, 4, 8, 4))),
    _layers("LayerCoCReduce", 2, 2, lambda most: tuple(count * (8 // most.scale) ** 2 for count in (2, 1, 1))),
    _layers("LayerCoCRows", 3, 2, lambda most: (1 + 2 * most.along, most.along, 1 + most.along)),
    _layers("LayerCoCColumns", 3, 2, lambda most: (2 + 2 * most.along, 1 + most.along, 2 + most.along)),
    _layers("Downsample", 5, 4, lambda most: (1 + 4 * 4 + 1 + 2 * 9, 17, 17, 10, 10)),
    _layers("HoleFill", 3, 2, lambda most: (1 + 2 * most.filled,) * 3),
)
# Slots that an entry does not read when it draws one target alone, by target
UNREAD = {
    "BokehLayerCoCReduce": (COLORS[:1], COLORS[1:2]),
    "BokehLayerCoCRows": (COLORS[1:3], COLORS[:1]),
    "BokehLayerCoCColumns": (COLORS[1:2], COLORS[:1]),
    "BokehDownsample": (COLORS[2:5], COLORS[2:5], (*COLORS[:2], COLORS[3]), COLORS[:3]),
}
_COLOR_DEPTH = ("ColorSamp", "DepthSamp")
_ALL = (
    Entry("BokehLinearDepth", DEPTH, ("DepthSamp",)),
    Entry("BokehSignedCoCMap", COPY, _COLOR_DEPTH),
    Entry("BokehConstantCoC", COPY, ("ColorSamp",)),
    *(entry for word, sides in EXACT.items() for entry in _polygon(word, sides)),
    Entry("BokehExactEdge", EDGE, COLORS[:1]),
    Entry("BokehDebug", VIEW, _COLOR_DEPTH),
    # bokeh_paper
    Entry("BokehCoCMap", COPY, _COLOR_DEPTH),
    Entry("BokehDepthOfField", LINE, _COLOR_DEPTH),
    Entry("BokehDepthOfFieldFinal", LINE, (*_COLOR_DEPTH, "ColorSampB")),
    Entry("BokehAdaptive", ADAPTIVE, _COLOR_DEPTH),
    Entry("BokehAdaptiveFinal", ADAPTIVE, (*_COLOR_DEPTH, "ColorSampB")),
    Entry("BokehNaiveGather", TABLE, (*_COLOR_DEPTH, "KernelSamp")),
    Entry("BokehNaiveGrid", GRID, _COLOR_DEPTH),
    # bokeh_lens
    Entry("BokehStableMap", STEADY, COLORS[:3]),
    Entry("BokehLateralColor", LATERAL, COLORS[:1]),
    # bokeh_layers
    _layers("TileMax", 1, 1, lambda most: (8 * 8,)),
    _layers("TileDilateRows", 1, 1, lambda most: (most.along,), axis="vec2(1.0, 0.0)"),
    _layers("TileDilateColumns", 1, 1, lambda most: (most.along,), axis="vec2(0.0, 1.0)"),
    *_SEVERAL,
    *(entry for word, sides in EXACT.items() for entry in _layer_polygon(word, sides)),
    _layers("Composite", 6, 1, lambda most: (2 + 2 * most.layer + most.gather,)),
    # the same passes for one target at a time
    *(Entry(f"{entry.name}One", LAYERS, entry.textures, layers=True, whole=entry.name) for entry in _SEVERAL),
    *(Entry(f"Bokeh{layer}Edge", EDGE, COLORS[:3], layers=True, given=given) for layer, given in ONE_LAYER.items()),
    *(
        Entry(f"Bokeh{layer}SecondOne", SECOND, COLORS[:5], layers=True, given=given)
        for layer, given in ONE_LAYER.items()
    ),
)
ENTRIES = {entry.name: entry for entry in _ALL}
# Roles with a number of samples that is fixed by BOKEH_PAPER_SAMPLES
COUNTED = (LINE, GRID, TABLE)
COPYING_ENTRIES = tuple(entry.name for entry in _ALL if entry.role == COPY)
# Entries that fetch all their textures texel by texel, so that the filter does not matter
_TILES = ("BokehTileMax", "BokehLayerCoCReduce")
TEXEL_ENTRIES = COPYING_ENTRIES + tuple(entry.name for entry in _ALL if (entry.whole or entry.name) in _TILES)
