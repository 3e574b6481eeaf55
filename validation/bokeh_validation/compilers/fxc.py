"""Microsoft's fxc: HLSL of shader models 3, 4 and 5 to Direct3D bytecode, by d3dcompiler_47.dll.

The library ships in a Windows package of kivy-deps-angle. A small program of ours (windows/fxc.cpp) loads it, on
Windows or under Wine.
"""

import hashlib
import re
import struct
import threading
from collections.abc import Mapping

from bokeh_validation import files, paths
from bokeh_validation.compilers.packages import Package
from bokeh_validation.compilers.tool import CompileResult, accepted, once, refused
from bokeh_validation.windows import programs, server

VERSION = "0.5.0"
LIBRARY = "d3dcompiler_47.dll"
PACKAGE = Package(
    "fxc",
    "kivy-deps-angle",
    VERSION,
    f"kivy_deps_angle-{VERSION}-cp311-cp311-win_amd64.whl",
    "d16d68cc45a2a326a3f8f738c649bb00ae5d7c3e58cff70f415fa57bd1d28713",
    ("--only-binary=:all:", "--platform", "win_amd64", "--python-version", "3.11"),
    f"kivy_deps_angle-{VERSION}.data/data/share/angle/bin/{LIBRARY}",
)

COMPILE_S = 60.0  # a program takes 0.01 to 2 s

# What shader model 3 guarantees (Direct3D 9). fxc compiles beyond it without a word; drivers refuse.
BUDGETS = {
    "ps_3_0": {"slots": 512, "constants": 224, "samplers": 16, "temporaries": 32},
    "vs_3_0": {"slots": 512, "constants": 256, "samplers": 4, "temporaries": 32},
}

fetch = PACKAGE.fetch


class Compiler:
    """The running compiler, for any number of programs. Several threads may call it: they take turns.

    version  such as 10.0.26100.1
    """

    def __init__(self) -> None:
        program, library = programs.build("fxc"), fetch().read_bytes()
        beside = program.with_name(LIBRARY)
        if not beside.exists():
            files.whole(beside, lambda partial: partial.write_bytes(library))
        # VS_FIXEDFILEINFO begins with its signature; the version follows 4 bytes later, two words in each half
        place = library.index(b"\xbd\x04\xef\xfe") + 8
        self.version = "{1}.{0}.{3}.{2}".format(*struct.unpack_from("<4H", library, place))
        self._server = server.Server(program)
        self._server.start()
        self._turn = threading.Lock()

    def compile(self, source: str, profile: str, entry: str, flags: int = 0) -> CompileResult:
        """One program, with facts. A hang or a crash of the compiler is a refusal that says so.

        profile  ps_ or vs_ and the shader model, such as ps_3_0
        flags    D3DCOMPILE_*; 0 is fxc.exe without options
        """
        with self._turn:
            kept = {name: self._server.folder / f"fxc.{name}" for name in ("messages", "bytecode", "listing")}
            for file in kept.values():
                file.write_bytes(b"")
            (self._server.folder / "fxc.source").write_bytes(source.encode("ascii"))
            try:
                ok, answer = self._server.ask(f"{profile} {entry} {flags:x}", COMPILE_S)
            except server.Ended as error:
                return refused(str(error))
            messages, bytecode, listing = (file.read_bytes() for file in kept.values())
        messages = _places(messages.decode("utf-8", "replace"))
        if not ok:
            return refused(messages or f"fxc failed: {answer}")
        return judged(messages, bytecode, listing.decode("utf-8", "replace"), profile)


# fxc names the file with the whole path of its working directory, and (line,column)
_PLACE = re.compile(r"^.*?bokeh\.hlsl\((\d+),([\d-]+)\)", re.MULTILINE)


def _places(messages: str) -> str:
    """Messages with places as DXC writes them, bokeh.hlsl:12:5, which registry.located knows."""
    return _PLACE.sub(r"bokeh.hlsl:\1:\2", messages.replace("\r", "")).strip()


def judged(messages: str, bytecode: bytes, listing: str, profile: str) -> CompileResult:
    """What compiled, with its facts; refused where it is over the budget of its shader model, or miscompiled."""
    known = facts(listing)
    over = over_budget(known, profile) or dead_break(listing)
    if over:
        return CompileResult(False, "\n".join(filter(None, (over, messages))), b"", known)
    return accepted(messages, bytecode, known)


_SLOTS = re.compile(
    r"approximately (\d+) instruction slots? used(?: \((\d+) texture, (\d+) arithmetic\))?", re.IGNORECASE
)


def facts(listing: str) -> dict[str, object]:
    """Counts from a disassembly.

    slots, texture_slots, arithmetic_slots  as fxc counts them; without texture instructions all are arithmetic
    temporaries, constants, samplers        registers rN, cN and sN that the code names (from shader model 4 on:
                                            dcl_temps, the size of cb0, and s registers)
    """
    code = "\n".join(line for line in listing.splitlines() if not line.lstrip().startswith("//"))
    known: dict[str, object] = {}
    if found := _SLOTS.search(listing):
        total, texture, arithmetic = found.groups()
        known |= {"slots": int(total), "texture_slots": int(texture or 0), "arithmetic_slots": int(arithmetic or total)}
    temporaries = re.search(r"dcl_temps (\d+)", code)
    buffer = re.search(r"dcl_constantbuffer cb0\[(\d+)\]", code, re.IGNORECASE)
    return known | {
        "temporaries": int(temporaries[1]) if temporaries else _registers("r", code),
        "constants": int(buffer[1]) if buffer else _registers("c", code),
        "samplers": _registers("s", code),
    }


def _registers(kind: str, code: str) -> int:
    """Number of different registers of a kind that the code names."""
    return len(set(re.findall(rf"(?<![\w.]){kind}\d+(?!\w)", code)))


# break_ne and its like: a comparison, two operands
_BREAK = re.compile(r"^\s*break_(ne|lt|gt)\s+(\S+),\s*(\S+)\s*$", re.MULTILINE)


def dead_break(listing: str) -> str:
    """What is wrong where a loop of shader model 3 does not end: a `break` that compares a register with itself, or ''.

    fxc writes `break` as 'break_ne 1, -1' and takes the two from its constants. Where it holds -1 alone, it has been
    seen to write 'break_ne -c0.w, -c0.w', which is never taken.
    """
    for comparison, one, other in _BREAK.findall(listing):
        if one == other:
            return f"miscompiled: 'break_{comparison} {one}, {other}' is never taken, the loop runs to its end"
    return ""


def over_budget(known: Mapping[str, object], profile: str) -> str:
    """A line for each limit of the shader model that is exceeded, or ''."""
    words = {"slots": "instruction slots"}
    lines = [
        f"over the budget of {profile}: {known[name]} {words.get(name, name)}, {limit} allowed"
        for name, limit in BUDGETS.get(profile, {}).items()
        if known.get(name, 0) > limit
    ]
    return "\n".join(lines)


@once
def load() -> Compiler:
    """The compiler, fetched, built and started on first use. Raises Unavailable."""
    return Compiler()


def build(source: str, stage: str, entry: str, shader_model: int) -> CompileResult:
    """HLSL of shader model 3, 4 or 5 to bytecode, with facts. `stage` is 'vert' or 'frag'. Raises Unavailable."""
    profile = {"vert": "vs", "frag": "ps"}[stage] + f"_{shader_model}_0"
    return load().compile(source, profile, entry)


def bytecode(source: str, profile: str, entry: str) -> bytes:
    """Bytecode of a program that must compile, kept in the cache folder by its hash.

    Raises RuntimeError with fxc's words where it refuses, and Unavailable.
    """
    key = hashlib.sha256("\0".join((VERSION, profile, entry, source)).encode()).hexdigest()[:32]
    kept = paths.cache_folder() / "bytecode" / f"{key}.{profile}"
    if kept.exists():
        return kept.read_bytes()
    result = load().compile(source, profile, entry)
    if not result.ok:
        raise RuntimeError(f"fxc refused {entry} ({profile}):\n{result.messages}")
    paths.ensured(kept.parent)
    files.whole(kept, lambda partial: partial.write_bytes(result.binary))
    return result.binary
