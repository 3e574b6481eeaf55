"""Microsoft's fxc: HLSL of shader models 3 to 5 to Direct3D bytecode, by d3dcompiler_47.dll.

A small program of ours (windows/fxc.cpp) loads it, under Wine.
"""

import re
from collections.abc import Mapping
from pathlib import Path

from bokeh_validation import locks
from bokeh_validation.compilers.tool import CompileResult, accepted, refused
from bokeh_validation.process import once
from bokeh_validation.windows import programs, server, wine

RELEASE = "10.0.26100.4654"  # of the library
COMPILE_S = 60.0  # a program takes 0.01 to 2 s

# What shader model 3 guarantees (Direct3D 9). fxc compiles beyond it without a word; drivers refuse.
BUDGETS = {
    "ps_3_0": {"slots": 512, "constants": 224, "samplers": 16, "temporaries": 32},
    "vs_3_0": {"slots": 512, "constants": 256, "samplers": 4, "temporaries": 32},
}

fetch = wine.COMPILER.fetch


@once
def load() -> server.Server:
    """The running compiler, fetched, built and started on first use. Raises Unavailable."""
    running = server.Server(programs.build("fxc", "-ld3dcompiler_47"))
    running.start()
    return running


def compiled(source: str, profile: str, entry: str) -> CompileResult:
    """One program at a time, of a profile such as ps_3_0. A hang or a crash is a refusal. Raises Unavailable."""
    running, problem = load(), ""
    kept = {name: running.folder / f"fxc.{name}" for name in ("messages", "bytecode", "listing")}
    for file in kept.values():
        file.write_bytes(b"")
    (running.folder / "fxc.source").write_bytes(source.encode("ascii"))
    try:
        running.ask(f"{profile} {entry}", COMPILE_S)
    except RuntimeError as error:
        problem = str(error)
    said, bytecode, listing = (file.read_bytes() for file in kept.values())
    said, listing = (text.decode("utf-8", "replace").replace("\r", "").strip("\0") for text in (said, listing))
    messages = _PLACE.sub(r"bokeh.hlsl:\1:\2", said).strip()
    if problem:
        return refused(messages or problem)
    known = facts(listing)
    problem = over_budget(known, profile) or dead_break(listing)
    if problem:
        return CompileResult(False, f"{problem}\n{messages}".strip(), b"", known)
    return accepted(messages, bytecode, known)


# fxc names the file with the whole path of its working directory, and (line,column); DXC writes bokeh.hlsl:12:5
_PLACE = re.compile(r"^.*?bokeh\.hlsl\((\d+),([\d-]+)\)", re.MULTILINE)
_SLOTS = re.compile(r"approximately (\d+) instruction slots? used", re.IGNORECASE)


def facts(listing: str) -> dict[str, int]:
    """Counts from a disassembly.

    slots                             as fxc counts them
    temporaries, constants, samplers  registers rN, cN and sN that the code names, of shader model 3
    """
    code = "\n".join(line for line in listing.splitlines() if not line.lstrip().startswith("//"))
    match = _SLOTS.search(listing)
    known = {"slots": int(match[1])} if match else {}
    for name, letter in {"temporaries": "r", "constants": "c", "samplers": "s"}.items():
        known[name] = len(set(re.findall(rf"(?<![\w.]){letter}\d+(?!\w)", code)))
    return known


# break_ne and its like, of a register with itself
_DEAD_BREAK = re.compile(r"^\s*(break_(?:ne|lt|gt)\s+(\S+),\s*\2)\s*$", re.MULTILINE)


def dead_break(listing: str) -> str:
    """What is wrong where a loop of shader model 3 does not end: a `break` that compares a register with itself, or ''.

    fxc writes `break` as 'break_ne 1, -1' and takes the two from its constants. Where it holds -1 alone, it has been
    seen to write 'break_ne -c0.w, -c0.w', which is never taken.
    """
    dead = _DEAD_BREAK.search(listing)
    return f"miscompiled: '{dead[1]}' is never taken, the loop runs to its end" if dead else ""


def over_budget(known: Mapping[str, int], profile: str) -> str:
    """A line for each limit of the shader model that is exceeded, or ''."""
    words = {"slots": "instruction slots"}
    return "\n".join(
        f"over the budget of {profile}: {known[name]} {words.get(name, name)}, {limit} allowed"
        for name, limit in BUDGETS.get(profile, {}).items()
        if known.get(name, 0) > limit
    )


def version() -> str:
    """Of the library. Raises Unavailable."""
    load()
    return RELEASE


def build(source: str, stage: str, entry: str, shader_model: int) -> CompileResult:
    """HLSL of shader model 3, 4 or 5 to bytecode, with facts. `stage` is 'vert' or 'frag'. Raises Unavailable."""
    profile = {"vert": "vs", "frag": "ps"}[stage] + f"_{shader_model}_0"
    return compiled(source, profile, entry)


def bytecode(source: str, profile: str, entry: str) -> Path:
    """File with the bytecode of a program that must compile, in the cache folder by its hash.

    Raises RuntimeError with fxc's words where it refuses, and Unavailable.
    """

    def make() -> bytes:
        result = compiled(source, profile, entry)
        if not result.ok:
            raise RuntimeError(f"fxc refused {entry} ({profile}):\n{result.messages}")
        return result.binary

    return locks.kept("bytecode", f".{profile}", (wine.VERSION, profile, entry, source), make)
