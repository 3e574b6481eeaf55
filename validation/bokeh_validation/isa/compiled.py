"""The methods whose cost is counted, and their passes as programs: as they are, and with their loops written out."""

from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from bokeh_validation import shaders
from bokeh_validation.compilers import dxc, glslang
from bokeh_validation.compilers.tool import CompileResult
from bokeh_validation.errors import UserError
from bokeh_validation.frame import fetches, methods
from bokeh_validation.frame.methods import Settings
from bokeh_validation.isa.unrolled import unrolled
from bokeh_validation.shaders.entries import EDGE, EXACT
from bokeh_validation.shaders.passes import BINDINGS, FIRST_SAMPLER, Pass

VERTEX = "BokehFullScreen"
PATH = " path"  # ends the names of programs with their loops written out
SIZE = (1920, 1080)  # for which the tiles that the largest CoC reaches are counted
# preset of `exact` -> BOKEH_NUM_SAMPLES, pixels between samples
EXACT_PRESETS = {"low": (5, 2.0), "medium": (9, 1.5), "high": (17, 1.0), "ultra": (33, 1.0)}
# binding -> kind of descriptor, by language: HLSL's textures have a sampler of their own
BOUND = {
    "glsl": {0: "uniform"} | dict.fromkeys(BINDINGS.values(), "combined"),
    "hlsl": {0: "uniform", FIRST_SAMPLER: "sampler"} | dict.fromkeys(BINDINGS.values(), "texture"),
}
THREADS = 2  # for glslang


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
    rows = {f"paper {shape}": Settings("paper", shape) for shape in ("hexagon", "octagon")}
    for shape in EXACT:
        for preset, (samples, spacing) in EXACT_PRESETS.items():
            rows[f"exact {shape} {preset}"] = Settings("exact", shape, spacing=spacing, samples=samples)
    for shape in ("hexagon", "octagon"):
        for preset in methods.PRESETS:
            rows[f"layered {shape} {preset}"] = Settings("layered", shape, preset=preset)
    return [Method(name, settings) for name, settings in rows.items()]


@dataclass(frozen=True)
class PassProgram:
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
        elif self.item.spec.role != "copy":
            words += [str(constants["BOKEH_NUM_SAMPLES"]), "adaptive" * constants["BOKEH_ADAPTIVE_SAMPLES"]]
        if self.path and self.item.spec.layers and not self.item.spec.sides:
            words.append(f"{round(self.item.values()['BokehSides'])} sides")
        return " ".join(word for word in words if word) + PATH * self.path

    @property
    def _settings(self) -> tuple[str, ...]:
        """The constants that decide about the code of a pass of the layers."""
        if self.item.entry == "BokehLayered":
            return ("BOKEH_LAYER_RINGS", "BOKEH_LAYER_CUBIC")
        return ("BOKEH_LAYER_CELLS",) if self.item.spec.sides or self.item.spec.role == EDGE else ()

    def glsl(self, profile: str) -> str:
        """Its GLSL."""
        text, constants = shaders.glsl(self.item.entry, profile, self.item.constants), self.item.constants
        if not self.path:
            return text
        sides, tiles = round(self.item.values()["BokehSides"]), fetches.tiles_along(self.item)
        return unrolled(text, {**constants, "sides": sides, "tiles": tiles})


def of_methods(chosen: Iterable[Method], paths: bool = True) -> dict[str, PassProgram]:
    """Every program that the methods need, once, by name: as it is, and, for `paths`, with its loops written out."""
    programs = [
        PassProgram(item, path) for method in chosen for item in method.passes for path in (False, True)[: 1 + paths]
    ]
    return {program.name: program for program in programs}


@dataclass(frozen=True)
class Code:
    """What a GPU's compiler is given: a vertex stage and fragment stages, each a code and its entry point.

    fragments  name of a program -> (code, entry point, number of targets)
    bindings   binding -> kind of descriptor
    """

    vertex: tuple[bytes, str]
    fragments: Mapping[str, tuple[bytes, str, int]]
    bindings: Mapping[int, str]


def code(programs: Mapping[str, PassProgram], language: str, profile: str = "450") -> Code:
    """Programs as SPIR-V by glslang or, of HLSL, by DXC; GLSL of another profile than 450 as text.

    Raises Unavailable without these compilers and UserError where they refuse a program.
    """
    items = [program.item for program in programs.values()]
    if language == "hlsl":
        vertex, entries = (_hlsl(VERTEX, "vert", {}), f"{VERTEX}_VS"), [f"{item.entry}_PS" for item in items]
        codes = [_hlsl(item.entry, "frag", item.constants) for item in items]
    else:
        entries, texts = ["main"] * len(items), [program.glsl(profile) for program in programs.values()]
        with ThreadPoolExecutor(THREADS) as pool:
            codes = list(pool.map(lambda text: _glsl(text, "frag", profile), texts))
        vertex = _glsl(shaders.glsl(VERTEX, profile), "vert", profile), "main"
    targets = [item.spec.targets for item in items]
    return Code(vertex, dict(zip(programs, zip(codes, entries, targets, strict=True), strict=True)), BOUND[language])


def _glsl(text: str, stage: str, profile: str) -> bytes:
    return _binary(glslang.spirv(text, stage, glslang.VULKAN)) if profile == "450" else text.encode("ascii")


def _hlsl(entry: str, stage: str, constants: Mapping[str, object]) -> bytes:
    return _binary(dxc.build(shaders.hlsl(6, constants), stage, entry + {"vert": "_VS", "frag": "_PS"}[stage]))


def _binary(result: CompileResult) -> bytes:
    if not result.ok:
        raise UserError(f"a shader does not compile: {result.messages.splitlines()[0]}. See validation/run compile.")
    return result.binary
