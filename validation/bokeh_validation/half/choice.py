"""What we say may be half. The budget and the frames measure it; the tests hold it to the limits below."""

from bokeh_validation.half import domain
from bokeh_validation.half.evaluate import FETCHES, RETURNED, Choice

# A function by itself may be off by so much, in its unit:
#   pixels    an eighth: a place gets its CoC from two such functions, and may be a quarter off
#   relative  two steps of the half-float targets that every colour is stored in
#   absolute  a grey or a weight by one step of 8 bits
#   cells     an eighth of a pixel where 65 cells are as long as the largest CoC
LIMITS = {
    domain.PIXELS: 0.125,
    domain.RELATIVE: 2.0**-9,
    domain.ABSOLUTE: 2.0**-8,
    domain.CELLS: 0.125 * domain.MAX_SAMPLES / (domain.MAX_COC * domain.ROWS),
}

WHOLE = (Choice.EVERYTHING,)

# Function -> variables that may be half; functions that are not here must be float altogether. BokehMakeOffsets and
# BokehCell are not, within the limits as they are: a place beside the edge of a texel that is a tenth of a pixel off
# reads another depth, the leakage test turns, and with it the CoC that the next pass blurs by.
MAY_BE_HALF: dict[str, tuple[str, ...]] = {
    "BokehCoC": (RETURNED,),
    "BokehSafeChannel": WHOLE,
    "BokehPackCoC": WHOLE,
    "BokehCoCMap": ("CoC", RETURNED),
    "BokehFilterCoC": WHOLE,
    "BokehCells": WHOLE,
    "BokehNoise": (RETURNED,),
    "BokehLeakageWeight": ("sampleCoC", "weight", RETURNED),
    "BokehResolve": ("centerPixel", "result", RETURNED),
    "BokehDepthOfField": ("centerPixel", "samplePixel", "weight", RETURNED),
    "BokehLineMean": (
        "CoC", "centerPixel", "jitter", "samplePixel", "leakageWeight", "weight", RETURNED,
    ),
    "BokehDepthOfFieldAdaptive": ("result", "CoC", "mean", RETURNED),
    "BokehCombine": WHOLE,
    "BokehDepthOfFieldFinal": ("a", "b", RETURNED),
    "BokehNaiveGather": ("centerPixel", "samplePixel", "weight", RETURNED),
    "BokehNaiveGrid": ("centerPixel", "samplePixel", "weight", RETURNED),
    "BokehExactWeight": WHOLE,
    "BokehExactTarget": ("B1", "B2", "B3", "B4", "CoC", "mean", RETURNED),
    "BokehExactFirst": (
        "centerPixel", "result", "CoC", "B1", "B2", "B3", "B4", "T2", "T3", "T4", "T5", RETURNED,
    ),
    "BokehExactSecond": ("centerPixel", "result", "CoC", "weight", RETURNED),
    "BokehExactEdge": ("centerPixel", "result", "CoC", RETURNED),
    "BokehDebugDepth": ("grey", RETURNED),
    "BokehDebugCoC": WHOLE,
    "BokehDebugFocus": ("amount", "result", RETURNED),
}  # fmt: skip

# beside them what a read of colour returns; that of depth is metres, which overflow
ALLOWED = Choice({name: frozenset(names) for name, names in {**MAY_BE_HALF, FETCHES[0]: (RETURNED,)}.items()})
