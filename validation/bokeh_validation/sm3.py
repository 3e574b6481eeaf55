"""The naive gather under shader model 3, by how its loops are written: which sample counts of Table 1 compile.

The shaders leave it to the compiler (`BOKEH_LOOP` is empty in shader model 3). Here the attributes take its place, to
see what the paper's remark that 256 samples and more do not compile can mean.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from bokeh_validation import shaders
from bokeh_validation.compilers import fxc
from bokeh_validation.compilers.result import CompileResult

SAMPLES = (16, 64, 144, 256, 400, 576)  # Table 1
LOOPS = {"as it is": "", "[loop]": " [loop]", "[unroll]": " [unroll]"}
EMPTY = "#define BOKEH_LOOP\n"


@dataclass(frozen=True)
class Attempt:
    """A program and what fxc, with the harness's budget behind it, said.

    entry    'BokehNaiveGather' (one loop over a table) or 'BokehNaiveGrid' (two nested loops)
    samples  in all
    loop     a key of LOOPS
    """

    entry: str
    samples: int
    loop: str
    result: CompileResult


def source(entry: str, samples: int, loop: str) -> str:
    """The ps_3_0 program. `samples` must be a square for the grid."""
    count = samples if entry == "BokehNaiveGather" else round(samples**0.5)
    text = shaders.hlsl(3, {"BOKEH_NUM_SAMPLES": count})
    if text.count(EMPTY) != 1:
        raise ValueError("BOKEH_LOOP of shader model 3 is not empty any more")
    return text.replace(EMPTY, EMPTY.replace("\n", LOOPS[loop] + "\n"))


def attempts(samples: Sequence[int] = SAMPLES) -> list[Attempt]:
    """Both entries, every count, every kind of loop. Raises Unavailable without fxc."""
    compiler = fxc.load()
    return [
        Attempt(entry, count, loop, compiler.compile(source(entry, count, loop), "ps_3_0", f"{entry}_PS"))
        for entry in ("BokehNaiveGather", "BokehNaiveGrid")
        for count in samples
        for loop in LOOPS
    ]


def lines(found: Sequence[Attempt]) -> list[str]:
    """A Markdown table: slots (texture + arithmetic) of what compiles, the reason of what does not."""
    text = ["| ps_3_0 | samples | " + " | ".join(LOOPS) + " |", "|---" * (2 + len(LOOPS)) + "|"]
    for entry, samples in dict.fromkeys((item.entry, item.samples) for item in found):
        row = {item.loop: item.result for item in found if (item.entry, item.samples) == (entry, samples)}
        text.append(f"| {entry.removeprefix('Bokeh')} | {samples} | {' | '.join(_cell(row[loop]) for loop in LOOPS)} |")
    return text


def _cell(result: CompileResult) -> str:
    known = result.facts
    slots = ""
    if "slots" in known:
        slots = f"{known['slots']} ({known['texture_slots']} + {known['arithmetic_slots']})"
    if result.ok:
        return slots
    if slots:
        return f"over: {slots}"
    errors = re.findall(r"error (X\d+)", result.messages)
    return f"refused: {', '.join(dict.fromkeys(errors)) or result.messages.splitlines()[0]}"
