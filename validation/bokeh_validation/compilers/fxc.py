"""Compile HLSL of shader models 3 to 5 to Direct3D bytecode with Microsoft's fxc, which is d3dcompiler_47.dll.

A small program, windows/fxc.cpp, loads the DLL under Wine.
"""

import re
from collections.abc import Mapping
from pathlib import Path

from bokeh_validation import locks
from bokeh_validation.compilers.tool import CompileResult, accepted, refused
from bokeh_validation.process import once
from bokeh_validation.windows import programs, server, wine

RELEASE = "10.0.26100.4654"  # of the library
COMPILE_S = 60.0  # seconds; a program takes 0.01 to 2

# Limits that shader model 3 guarantees (Direct3D 9). fxc silently compiles beyond them; drivers then refuse.
BUDGETS = {
    "ps_3_0": {"slots": 512, "constants": 224, "samplers": 16, "temporaries": 32},
    "vs_3_0": {"slots": 512, "constants": 256, "samplers": 4, "temporaries": 32},
}

fetch = wine.COMPILER.fetch


@once
def load() -> server.Server:
    """Return the running compiler; it is downloaded, built and started on first use. Raises Unavailable."""
    running = server.Server(programs.build("fxc", "-ld3dcompiler_47"))
    running.start()
    return running


def compiled(source: str, profile: str, entry: str) -> CompileResult:
    """Compile a program for a profile such as ps_3_0. A hang or a crash is reported as a rejection. Raises
    Unavailable.

    Not thread-safe, since there is one compiler process.
    """
    running, problem = load(), ""
    output_files = {name: running.folder / f"fxc.{name}" for name in ("messages", "bytecode", "listing")}
    for file in output_files.values():
        file.write_bytes(b"")
    (running.folder / "fxc.source").write_bytes(source.encode("ascii"))
    try:
        running.ask(f"{profile} {entry}", COMPILE_S)
    except RuntimeError as error:
        problem = str(error)
    printed, bytecode, listing = (file.read_bytes() for file in output_files.values())
    printed, listing = (text.decode("utf-8", "replace").replace("\r", "").strip("\0") for text in (printed, listing))
    messages = _PLACE.sub(r"bokeh.hlsl:\1:\2", printed).strip()
    if problem:
        return refused(messages or problem)
    counts = facts(listing)
    problem = over_budget(counts, profile) or dead_break(listing)
    if problem:
        return CompileResult(False, f"{problem}\n{messages}".strip(), b"", counts)
    return accepted(messages, bytecode, counts)


# fxc gives the file's full path and (line,column); this is rewritten to DXC's form, bokeh.hlsl:12:5
_PLACE = re.compile(r"^.*?bokeh\.hlsl\((\d+),([\d-]+)\)", re.MULTILINE)
_SLOTS = re.compile(r"approximately (\d+) instruction slots? used", re.IGNORECASE)


def facts(listing: str) -> dict[str, int]:
    """Count resources in a disassembly.

    slots                             instruction slots as fxc counts them
    temporaries, constants, samplers  distinct registers rN, cN and sN in code of shader model 3
    """
    code = "\n".join(line for line in listing.splitlines() if not line.lstrip().startswith("//"))
    match = _SLOTS.search(listing)
    counts = {"slots": int(match[1])} if match else {}
    for name, letter in {"temporaries": "r", "constants": "c", "samplers": "s"}.items():
        counts[name] = len(set(re.findall(rf"(?<![\w.]){letter}\d+(?!\w)", code)))
    return counts


# break_ne and similar instructions that compare a register with itself
_DEAD_BREAK = re.compile(r"^\s*(break_(?:ne|lt|gt)\s+(\S+),\s*\2)\s*$", re.MULTILINE)


def dead_break(listing: str) -> str:
    """Return a message if a loop of shader model 3 has a `break` that is never taken, or ''.

    fxc writes `break` as 'break_ne 1, -1' and takes both numbers from its constants. If it stores only -1, it may
    write 'break_ne -c0.w, -c0.w', which compares a register with itself.
    """
    dead = _DEAD_BREAK.search(listing)
    return f"miscompiled: '{dead[1]}' is never taken, the loop runs to its end" if dead else ""


def over_budget(known: Mapping[str, int], profile: str) -> str:
    """Return a line for each limit of the shader model that is exceeded, or ''."""
    words = {"slots": "instruction slots"}
    return "\n".join(
        f"over the budget of {profile}: {known[name]} {words.get(name, name)}, {limit} allowed"
        for name, limit in BUDGETS.get(profile, {}).items()
        if known.get(name, 0) > limit
    )


def version() -> str:
    """Return the version of the library. Raises Unavailable."""
    load()
    return RELEASE


def build(source: str, stage: str, entry: str, shader_model: int) -> CompileResult:
    """Compile HLSL of shader model 3, 4 or 5 to bytecode, with facts(). `stage` is 'vert' or 'frag'. Raises
    Unavailable.
    """
    profile = {"vert": "vs", "frag": "ps"}[stage] + f"_{shader_model}_0"
    return compiled(source, profile, entry)


def bytecode(source: str, profile: str, entry: str) -> Path:
    """Return the file with the bytecode of a program that must compile, in the cache folder.

    Raises RuntimeError with fxc's messages if it rejects the program, and Unavailable.
    """

    def make() -> bytes:
        result = compiled(source, profile, entry)
        if not result.ok:
            raise RuntimeError(f"fxc refused {entry} ({profile}):\n{result.messages}")
        return result.binary

    return locks.kept("bytecode", f".{profile}", (wine.VERSION, profile, entry, source), make)
