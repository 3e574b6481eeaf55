"""The entry points of bokeh_passes.*: what each reads, how many targets it writes, and what it is."""

from collections.abc import Callable
from dataclasses import dataclass

COPY, DEPTH, LATERAL, STEADY, VIEW = "copy", "depth", "lateral", "steady", "view"
LINE, ADAPTIVE, GRID, TABLE = "line", "adaptive", "grid", "table"
FIRST, SECOND, EDGE, LAYERS = "first", "second", "edge", "layers"

# Sides of the polygons that are exact, with the name that their entries begin with
EXACT = {"square": 4, "hexagon": 6, "octagon": 8, "decagon": 10}
# Of layers: those whose targets of both layers are four or fewer
BOTH = (4, 6)
COLORS = ("ColorSamp", "ColorSampB", "ColorSampC", "ColorSampD", "ColorSampE", "ColorSampF")


@dataclass(frozen=True)
class Most:
    """What the loops of bokeh_layers.* do at most with the settings of a frame (plan/fetches.py).

    along    tiles that a pass over tiles looks at along one axis
    filled   texels of HoleFill for each of its two textures, the pixel's own included
    layer    fetches that enlarge one layer in Composite
    gather   samples of Composite's gather
    """

    along: int
    filled: int
    layer: int
    gather: int


@dataclass(frozen=True)
class Entry:
    """An entry point by its stem: HLSL and WGSL add _PS, GLSL has one main() chosen by BOKEH_PASS.

    role      COPY makes the CoC map of a colour, STEADY makes it steady; DEPTH linear depth, LATERAL lateral colour,
              VIEW the debug view. LINE blurs along one line of a fixed number of samples, ADAPTIVE along one of any
              length and spacing; GRID and TABLE gather in two dimensions. FIRST and SECOND are the passes of an exact
              polygon, EDGE one target of the first; with `layers`, of a polygon of layers. LAYERS is the rest of
              bokeh_layers.*
    textures  slots that it reads
    targets   how many it writes
    sides     of its polygon; 0 where a parameter says it, or there is none
    layers    whether it is one of bokeh_layers.*
    whole     name of the entry of whose targets it writes one: number BOKEH_TARGET_INDEX
    fetches   of a pass of the layers but the lines: how many a texel takes at most; then, of several targets, those of
              each alone, since its program leaves out what only the others need
    """

    name: str
    role: str
    textures: tuple[str, ...]
    targets: int = 1
    sides: int = 0
    layers: bool = False
    whole: str = ""
    fetches: Callable[[Most], tuple[int, ...]] | None = None


def _polygon(word: str, sides: int, layers: bool = False) -> tuple[Entry, Entry]:
    """The two passes of an exact polygon; those of layers, of both where sides are in BOTH, have the CoC in a slot of
    their own, the second's fifth.
    """
    both = 2 if layers and sides in BOTH else 1
    between = both * (sides // 2 - 1)
    stem = f"Bokeh{word.capitalize()}{'Layer' if layers else ''}"
    first, second = COLORS[:1], COLORS[:between]
    if layers:
        first, second = COLORS[: 2 * both + 1], (*second, COLORS[4])
    return (
        Entry(f"{stem}First", FIRST, first, between, sides, layers),
        Entry(f"{stem}Second", SECOND, second, both, sides, layers),
    )


def _layers(name: str, textures: int, targets: int, fetches: Callable[[Most], tuple[int, ...]]) -> Entry:
    return Entry(f"Bokeh{name}", LAYERS, COLORS[:textures], targets, layers=True, fetches=fetches)


_SEVERAL = (
    _layers("Prefilter", 2, 4, lambda most: (1 + 4 + 8, 13, 5, 13, 5)),
    _layers("LayerCoCReduce", 2, 2, lambda most: (2 * 4 * 4, 16, 16)),
    _layers("LayerCoCRows", 3, 2, lambda most: (1 + 2 * most.along, most.along, 1 + most.along)),
    _layers("LayerCoCColumns", 3, 2, lambda most: (2 + 2 * most.along, 1 + most.along, 2 + most.along)),
    _layers("Downsample", 5, 4, lambda most: (1 + 4 * 4 + 1 + 2 * 9, 17, 17, 10, 10)),
    _layers("HoleFill", 3, 2, lambda most: (1 + 2 * most.filled,) * 3),
)
# Slots that one of the targets alone does not need, target by target
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
    _layers("TileDilate", 1, 1, lambda most: (most.along,)),
    *_SEVERAL,
    *(entry for word, sides in EXACT.items() for entry in _polygon(word, sides, layers=True)),
    _layers("Composite", 6, 1, lambda most: (2 + 2 * most.layer + most.gather + 2,)),
    # one target at a time
    *(Entry(f"{entry.name}One", LAYERS, entry.textures, layers=True, whole=entry.name) for entry in _SEVERAL),
    Entry("BokehLayerEdge", EDGE, COLORS[:3], layers=True),
    Entry("BokehLayerSecondOne", SECOND, COLORS[:5], layers=True),
)
ENTRIES = {entry.name: entry for entry in _ALL}
# With so many samples whatever their spacing: BOKEH_PAPER_SAMPLES
COUNTED = (LINE, GRID, TABLE)
COPYING_ENTRIES = tuple(entry.name for entry in _ALL if entry.role == COPY)
