"""The methods whose cost is counted, and their passes as programs: as they are, and with their loops written out."""

from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from bokeh_validation import shaders
from bokeh_validation.compilers import glslang
from bokeh_validation.errors import UserError
from bokeh_validation.frame import fetches, methods
from bokeh_validation.frame.methods import Settings
from bokeh_validation.isa.unrolled import unrolled
from bokeh_validation.shaders.entries import EDGE, EXACT
from bokeh_validation.shaders.passes import Pass

VERTEX = "BokehFullScreen"
PATH = " path"  # ends the names of programs with their loops written out
THREADS = 2  # for the compilations to SPIR-V
SIZE = (1920, 1080)  # for which the tiles that the largest CoC reaches are counted
# preset of `exact` -> BOKEH_NUM_SAMPLES, pixels between samples
EXACT_PRESETS = {"low": (5, 2.0), "medium": (9, 1.5), "high": (17, 1.0), "ultra": (33, 1.0)}


@dataclass(frozen=True)
class Method:
    """A row of the table: a way to render, with all of its passes."""

    name: str
    settings: Settings

    @property
    def passes(self) -> tuple[Pass, ...]:
        """From the CoC map on."""
        return methods.plan(self.settings, SIZE).passes

    @property
    def fetches(self) -> float:
        """A pixel's, of colour and depth, where every pass takes all of its samples."""
        return sum(fetches.of_frame(self.passes)[kind] for kind in ("color", "depth"))


def all_methods() -> list[Method]:
    """`paper`, `exact` and `layered`, with all presets."""
    found = [Method(f"paper {shape}", Settings("paper", shape)) for shape in ("hexagon", "octagon")]
    for shape in EXACT:
        for preset, (samples, spacing) in EXACT_PRESETS.items():
            settings = Settings("exact", shape, spacing=spacing, samples=samples)
            found.append(Method(f"exact {shape} {preset}", settings))
    for shape in ("hexagon", "octagon"):
        found += [
            Method(f"layered {shape} {preset}", Settings("layered", shape, preset=preset)) for preset in methods.PRESETS
        ]
    return found


@dataclass(frozen=True)
class Program:
    """A pass as it is compiled.

    path  with its loops written out: its counts are those of the path that a pixel takes
    """

    item: Pass
    path: bool = False

    @property
    def name(self) -> str:
        """Unique, such as 'HexagonFirst 17 adaptive'; what does not decide about the code is not in it."""
        constants = self.item.constants
        words = [self.item.entry.removeprefix("Bokeh")]
        if self.item.spec.layers:
            words += [f"{key.removeprefix('BOKEH_LAYER_').lower()} {constants[key]}" for key in self._settings]
        elif "BOKEH_NUM_SAMPLES" in self._settings:
            words += [str(constants["BOKEH_NUM_SAMPLES"]), "adaptive" * constants["BOKEH_ADAPTIVE_SAMPLES"]]
        if self.path and self.item.spec.layers and not self.item.spec.sides:
            words.append(f"{round(self.item.values()['BokehSides'])} sides")
        return " ".join(word for word in words if word) + PATH * self.path

    @property
    def _settings(self) -> tuple[str, ...]:
        """The constants that decide about its code."""
        entry = self.item.entry
        if not self.item.spec.layers:
            return ("BOKEH_NUM_SAMPLES",) if self.item.spec.role != "copy" else ()
        if entry == "BokehLayered":
            return ("BOKEH_LAYER_RINGS", "BOKEH_LAYER_CUBIC")
        return ("BOKEH_LAYER_CELLS",) if self.item.spec.sides or self.item.spec.role == EDGE else ()

    def source(self, text: str, profile: str) -> str:
        """Its GLSL; `text` is the library with the passes."""
        constants = self.item.constants
        if self.path:
            values = self.item.values()
            tiles = fetches.tiles_along(self.item)
            text = unrolled(text, {**constants, "sides": round(values["BokehSides"]), "tiles": tiles})
        head = {"BOKEH_PASS": shaders.glsl_pass(self.item.entry), **constants}
        return shaders.GLSL_VERSIONS[profile] + "\n" + shaders.defines(head) + text


def of_methods(chosen: Iterable[Method], paths: bool = True) -> dict[str, Program]:
    """Every program that the methods need, once, by name: as it is, and, for `paths`, with its loops written out."""
    found = {}
    for method in chosen:
        for item in method.passes:
            for path in (False, True) if paths else (False,):
                program = Program(item, path)
                found.setdefault(program.name, program)
    return found


def made(
    wanted: dict[str, Program], profile: str, folder: Path | None = None
) -> tuple[bytes, dict[str, tuple[bytes, int]]]:
    """(vertex shader, name -> (code, targets)): SPIR-V in profile 450, else text. Raises Unavailable without glslang.

    folder  holds glsl/ of another release, whose entries need not be all of them; None: this one's
    """
    text = shaders.text("glsl") if folder is None else _other(folder)
    known = {name: program for name, program in wanted.items() if shaders.glsl_pass(program.item.entry) in text}
    head = {"BOKEH_PASS": shaders.glsl_pass(VERTEX)}
    vertex = shaders.GLSL_VERSIONS[profile] + "\n" + shaders.defines(head) + text
    sources = [vertex, *(program.source(text, profile) for program in known.values())]
    codes = [source.encode("ascii") for source in sources] if profile != "450" else _spirv(sources, ["", *known])
    targets = [program.item.spec.targets for program in known.values()]
    return codes[0], dict(zip(known, zip(codes[1:], targets, strict=True), strict=True))


def _spirv(sources: list[str], names: list[str]) -> list[bytes]:
    """A vertex shader and fragment shaders for Vulkan."""

    def compiled(source: str, name: str) -> bytes:
        result = glslang.spirv(source, "frag" if name else "vert", glslang.VULKAN)
        if not result.ok:
            raise UserError(f"{name or 'the vertex shader'}: {result.messages.splitlines()[0]}")
        return result.binary

    with ThreadPoolExecutor(THREADS) as pool:
        return list(pool.map(compiled, sources, names))


def _other(folder: Path) -> str:
    """Library, layers if there are any, and passes of another release."""
    files = [folder / "glsl" / f"{name}.glsl" for name in ("bokeh", "bokeh_layers", "bokeh_passes")]
    if not files[0].is_file():
        raise UserError(f"--against {folder}: there is no glsl/bokeh.glsl in it. Name a folder with another release.")
    return "".join(file.read_text(encoding="ascii") for file in files if file.is_file())
