"""The naive gather under shader model 3, by how its loops are written: which sample counts of Table 1 compile.

The shaders leave it to the compiler (`BOKEH_LOOP` is empty in shader model 3). Here the attributes take its place, to
see what the paper's remark that 256 samples and more do not compile can mean.
"""

import re
from collections.abc import Sequence

from bokeh_validation import shaders, terminal
from bokeh_validation.compilers import fxc
from bokeh_validation.compilers.tool import CompileResult

SAMPLES = (16, 64, 144, 256, 400, 576)  # Table 1
LOOPS = {"as it is": "", "[loop]": " [loop]", "[unroll]": " [unroll]"}
EMPTY = "#define BOKEH_LOOP\n"
# Unrolled, 64 samples are over the budget already; from 256 up fxc takes minutes to say so.
UNROLLED = 144

# What the paper's shader may have been: all samples in one loop.
ONE_LOOP = "BokehOneLoop"
ONE_LOOP_TEXT = """
float4 BokehOneLoop_PS(BOKEH_INPUT) : BOKEH_OUTPUT
{
    float4 centerPixel = BokehFetch(BOKEH_ARGUMENT(BokehColorSamp), uv);
    float centerDepth = BokehFetchNearest(BokehDepthSamp, uv).r;
    float4 color = float4(0.0, 0.0, 0.0, 0.0);
    float totalWeight = 0.0;
    BokehFilter settings = BokehDefaultFilter(float2(BokehImageWidth, BokehImageHeight));
    BOKEH_LOOP for (int i = 0; i < BOKEH_NUM_SAMPLES; i++)
    {
        float2 offset = BokehFetchTable(BokehKernelSamp, i, BOKEH_NUM_SAMPLES).rg;
        float4 samplePixel = BokehFetch(BOKEH_ARGUMENT(BokehColorSamp), uv + offset * centerPixel.a);
        float sampleDepth = BokehFetchNearest(BokehDepthSamp, uv + offset * centerPixel.a).r;
        float weight = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth, centerPixel.a, settings);
        color += samplePixel * weight;
        totalWeight += weight;
    }
    return BokehResolve(color, totalWeight, centerPixel, true);
}
"""
ENTRIES = ("BokehNaiveGather", "BokehNaiveGrid", ONE_LOOP)


# (entry, samples in all) -> a key of LOOPS -> what fxc, with the harness's budget behind it, said. BokehNaiveGather is
# one loop over a table, BokehNaiveGrid two nested ones.
Attempts = dict[tuple[str, int], dict[str, CompileResult]]


def source(entry: str, samples: int, loop: str) -> str:
    """The ps_3_0 program. `samples` must be a square for the grid."""
    count = round(samples**0.5) if entry == "BokehNaiveGrid" else samples
    text = shaders.hlsl(3, {"BOKEH_NUM_SAMPLES": count})
    if text.count(EMPTY) != 1:
        raise ValueError("BOKEH_LOOP of shader model 3 is not empty any more")
    text = text.replace(EMPTY, EMPTY.replace("\n", LOOPS[loop] + "\n"))
    return text + ONE_LOOP_TEXT if entry == ONE_LOOP else text


def attempts(samples: Sequence[int] = SAMPLES) -> Attempts:
    """Every entry, every count, every kind of loop. Raises Unavailable without fxc."""
    compiler = fxc.load()
    return {
        (entry, count): {
            loop: compiler.compile(source(entry, count, loop), "ps_3_0", f"{entry}_PS")
            for loop in LOOPS
            if loop != "[unroll]" or count <= UNROLLED
        }
        for entry in ENTRIES
        for count in samples
    }


def lines(found: Attempts) -> list[str]:
    """A Markdown table: slots (texture + arithmetic) of what compiles, the reason of what does not."""
    text = ["| ps_3_0 | samples | " + " | ".join(LOOPS) + " |", "|---" * (2 + len(LOOPS)) + "|"]
    for (entry, samples), results in found.items():
        cells = [_cell(results.get(loop)) for loop in LOOPS]
        text.append(f"| {entry.removeprefix('Bokeh')} | {samples} | {' | '.join(cells)} |")
    return text


def _cell(result: CompileResult | None) -> str:
    if result is None:
        return "not tried"
    known = result.facts
    if "slots" in known:
        slots = f"{known['slots']} ({known['texture_slots']} + {known['arithmetic_slots']})"
        return slots if result.ok else f"over: {slots}"
    errors = re.findall(r"error (X\d+)", result.messages)
    return f"refused: {', '.join(dict.fromkeys(errors)) or result.messages.splitlines()[0]}"


def sm3() -> None:
    """Instruction slots of the naive gather under shader model 3, by how its loops are written."""
    terminal.tell(*lines(attempts()))
