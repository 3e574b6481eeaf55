"""What we say may be half. The budget and the frames measure it; the tests hold it to the limits below."""

from bokeh_validation.half import domain
from bokeh_validation.half.interpreter import EVERYTHING, FETCHES, RETURNED, Choice

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

WHOLE = (EVERYTHING,)

# Function -> variables that may be half, struct -> members; what is not here must be float altogether. BokehMakeOffsets
# is not, within the limits as it is: a place beside the edge of a texel that is a tenth of a pixel off reads another
# depth, the leakage test says the opposite, and with it the CoC that the next pass blurs by.
MAY_BE_HALF: dict[str, tuple[str, ...]] = {
    "BokehFilter": ("jitter", "bleedingMult"),
    "BokehTargets": ("T2", "T3", "T4", "T5"),
    "BokehCoC": (RETURNED,),
    "BokehSignedCoC": ("CoC", RETURNED),
    "BokehSafeChannel": WHOLE,
    "BokehPackCoC": WHOLE,
    "BokehCoCMap": ("CoC", RETURNED),
    "BokehSignedCoCMap": ("CoC", RETURNED),
    "BokehFilterCoC": WHOLE,
    "BokehCells": WHOLE,
    "BokehNoise": (RETURNED,),
    "BokehLeakageWeight": ("sampleCoC", "weight", RETURNED),
    "BokehSignedLeakageWeight": ("sampleCoC", "weight", RETURNED),
    "BokehResolve": ("centerPixel", "result", RETURNED),
    "BokehDepthOfField": ("centerPixel", "samplePixel", "weight", RETURNED),
    "BokehDepthOfFieldAdaptive": ("centerPixel", "result", "CoC", "samplePixel", "weight", RETURNED),
    "BokehCombine": WHOLE,
    "BokehDepthOfFieldFinal": ("a", RETURNED),
    "BokehNaiveGather": ("centerPixel", "samplePixel", "weight", RETURNED),
    "BokehNaiveGrid": ("centerPixel", "samplePixel", "weight", RETURNED),
    "BokehExactWeight": WHOLE,
    "BokehLineSum": ("CoC", "centerCoC", "samplePixel", "sampleCoC", "weight"),
    "BokehExactTarget": ("centerPixel", RETURNED),
    "BokehChannelFirst": ("centerPixel", "CoC"),
    "BokehChannelSecond": ("centerPixel", "result", "CoC", RETURNED),
    "BokehChannelEdge": ("centerPixel", "result", "CoC", RETURNED),
    "BokehDebugDepth": ("grey", RETURNED),
    "BokehDebugCoC": WHOLE,
    "BokehDebugFocus": ("amount", "result", RETURNED),
}

# beside them what a read of colour returns; that of depth is metres, which overflow
ALLOWED: Choice = MAY_BE_HALF | {FETCHES[0]: (RETURNED,)}
