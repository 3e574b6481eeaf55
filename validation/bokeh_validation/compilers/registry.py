"""All compilers: what each takes, how it is run, and which version it is."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial

from bokeh_validation import paths
from bokeh_validation.compilers import angle_tint, dxc, fxc, glslang, mesa, mojoshader, naga, spirv
from bokeh_validation.compilers.tool import CompileResult, accepted, refused
from bokeh_validation.errors import Unavailable
from bokeh_validation.shaders import variants
from bokeh_validation.shaders.variants import Program

OK, FAILED, MISSING = "ok", "failed", "missing"


@dataclass(frozen=True)
class Cell:
    """Outcome of one compiler for one program.

    status   OK, FAILED, MISSING, or "n/a" where the program does not go through it
    message  what the compiler printed; for MISSING how to install it
    facts    see CompileResult; warnings = number of lines printed although it is ok
    follows  the compiler whose failure left this one without input, else empty
    """

    status: str = "n/a"
    message: str = ""
    facts: dict[str, object] = field(default_factory=dict)
    follows: str = ""


@dataclass
class Job:
    """A program on its way through the compilers.

    cells   what they said
    binary  what each has made
    """

    program: Program
    source: str
    cells: dict[str, Cell] = field(default_factory=dict)
    binary: dict[str, bytes] = field(default_factory=dict)


# What a compiler takes of a program: its source, or what another compiler has made of it
Given = tuple[Program, str | bytes]


@dataclass(frozen=True)
class Compiler:
    """A column of the matrix.

    tools  keys of TOOLS: what it consists of
    run    what it says of each of some programs of one variant, of what it takes of them; raises Unavailable
    takes  the compilers whose output it takes, if the program goes through one of them; else the source
    here   whether it has to stay in one thread
    """

    name: str
    tools: tuple[str, ...]
    run: Callable[[Sequence[Given]], Sequence[CompileResult]]
    takes: tuple[str, ...] = ()
    here: bool = False

    def version(self) -> str:
        """Of its tools. Raises Unavailable."""
        told = [(name, TOOLS[name]()) for name in self.tools]
        return ", ".join(version if name == self.name else f"{name} {version}" for name, version in told)


def compile_(compilers: Sequence[Compiler], jobs: Sequence[Job]) -> None:
    """Fill the compilers' cells of each job; these are all of one variant."""
    for compiler in compilers:
        _compile(compiler, jobs)


def _compile(compiler: Compiler, jobs: Sequence[Job]) -> None:
    producer = next((name for name in compiler.takes if name in jobs[0].program.compilers), "")
    ready = []
    for job in jobs:
        before = job.cells[producer] if producer else Cell(OK)
        if before.status == OK:
            ready.append(job)
        else:
            message = before.message if before.status == MISSING else f"no input: {producer} failed"
            job.cells[compiler.name] = Cell(before.status, message, follows=producer)
    try:
        results = compiler.run([(job.program, job.binary.get(producer, job.source)) for job in ready]) if ready else ()
    except Unavailable as error:
        for job in ready:
            job.cells[compiler.name] = Cell(MISSING, str(error))
        return
    for job, result in zip(ready, results, strict=True):
        message = result.messages if producer else located(result.messages, job.source, job.program.language)
        job.cells[compiler.name] = Cell(OK if result.ok else FAILED, message, result.facts)
        job.binary[compiler.name] = result.binary


# How each compiler writes a place, up to the line number: glslang, glslc and mesa, DXC and fxc, naga and tint
_PLACE = re.compile(r"(?<![\w.])(?:shader\.(?:vert|frag)|0|bokeh\.hlsl|wgsl):(\d+)(?=[:(])")


def located(message: str, source: str, language: str) -> str:
    """Places in the complete program as places in the package's files, such as bokeh.glsl:251.

    source  the program: lines of its own (version, defines), whose places are left as they are, then the three files
    """
    if not message:
        return ""
    files = [paths.library(language), paths.layers(language), paths.passes(language)]
    names = [f"{file.name}:{n}" for file in files for n in range(1, len(file.read_text("ascii").splitlines()) + 1)]
    head = len(source.splitlines()) - len(names)

    def place(match: re.Match) -> str:
        line = int(match[1]) - head
        return names[line - 1] if 1 <= line <= len(names) else match[0]

    return _PLACE.sub(place, message) if head >= 0 else message


# ------------------------------------------------------------------------------------------------------ how each is run


def _each(run: Callable[..., CompileResult]) -> Callable[[Sequence[Given]], list[CompileResult]]:
    """One after the other; `run` takes the program and what is given of it."""
    return lambda given: [run(*one) for one in given]


def _texts(given: Sequence[Given]) -> list[tuple[str, str]]:
    return [(text, program.stage) for program, text in given]


def _glslang(given: Sequence[Given]) -> list[CompileResult]:
    first, _ = given[0]
    if first.language == "glsl":
        return glslang.glsl(_texts(given), first.profile)
    return [glslang.hlsl(text, program.stage, program.function) for program, text in given]


def _valid(program: Program, module: bytes) -> CompileResult:
    return spirv.validate(module, spirv.OPENGL_RULES if program.profile == "330" else spirv.VULKAN_RULES)


def _essl(target: str, given: Sequence[Given]) -> list[CompileResult]:
    return glslang.checked([(spirv.cross(module, target), program.stage) for program, module in given], target)


def _hlsl50(program: Program, module: bytes) -> CompileResult:
    text = spirv.cross(module, "hlsl50")
    if not text.ok:
        return text
    result = fxc.build(text.binary.decode(), program.stage, "main", 5)
    if result.ok:
        return accepted(result.messages, result.binary)
    return refused(f"spirv-cross wrote HLSL that fxc refuses:\n{result.messages}")


def _other(program: Program) -> Program:
    """A program is a vertex and a fragment shader: what one is linked with, taken as the package has it."""
    return replace(program, entry=variants.VERTEX if program.stage == "frag" else "BokehCoCMap", samples=None)


def _linked(link: Callable[[str, str], CompileResult], program: Program, source: str) -> CompileResult:
    """GLSL with its other stage, and what the compiler says of the program's own and of linking.

    The other is as the package has it: what is said of it is not about this program, and its line numbers are not.
    """
    other = _other(program)
    pair = {program.stage: source, other.stage: other.source}
    result = link(pair["vert"], pair["frag"])
    own = ("vertex:", "link:") if program.stage == "vert" else ("fragment:", "link:")
    messages = "\n".join(line for line in result.messages.splitlines() if line.startswith(own))
    return accepted(messages) if result.ok else refused(messages or result.messages)


def _pipeline(build: Callable[..., CompileResult], program: Program, code: str | bytes) -> CompileResult:
    """WGSL, or SPIR-V of DXC, with its other stage."""
    other, constants, partner = _other(program), program.configuration, accepted("", code)
    if program.language == "hlsl":
        constants, partner = {}, _partner(other.source, other.stage, other.function)
        if not partner.ok:
            return partner
    pair = {
        program.stage: naga.Stage(code, program.function, constants, program.targets),
        other.stage: naga.Stage(partner.binary, other.function),
    }
    return build(pair["vert"], pair["frag"])


_partner = lru_cache(maxsize=4)(dxc.build)

SPIRV = ("glslang", "dxc-spirv")
COMPILERS = (
    # Microsoft's d3dcompiler_47, Direct3D 9 to 11: ok when bytecode comes out, in sm3 within the shader model's budget
    Compiler("fxc", ("fxc",), _each(lambda p, text: fxc.build(text, p.stage, p.function, p.shader_model))),
    # on fxc's bytecode of shader model 3: GLSL, SPIR-V and Metal come out
    Compiler("mojoshader", ("mojoshader",), _each(lambda _, bytecode: mojoshader.build(bytecode)), ("fxc",)),
    # the Khronos reference front end. 330, 450, sm5: SPIR-V comes out; 300es: it parses, links
    Compiler("glslang", ("glslang",), _glslang),
    # Google's front end for Vulkan: SPIR-V comes out
    Compiler("glslc", ("glslc",), lambda given: glslang.glslc(_texts(given))),
    # Microsoft's DXC: SPIR-V comes out; DXIL for Direct3D 12 comes out
    Compiler("dxc-spirv", ("dxc",), _each(lambda p, text: dxc.build(text, p.stage, p.function)), here=True),
    Compiler("dxc-dxil", ("dxc",), _each(lambda p, text: dxc.build(text, p.stage, p.function, False)), here=True),
    # the Khronos validator finds nothing in the SPIR-V, by the rules of OpenGL 4.5 for 330, else of Vulkan 1.0
    Compiler("spirv-val", ("spirv-val",), _each(_valid), SPIRV),
    # the SPIR-V, by spirv-cross to GLSL ES: glslang takes that text
    Compiler("essl300", ("spirv-cross", "glslang"), partial(_essl, "essl300"), SPIRV),
    Compiler("essl310", ("spirv-cross", "glslang"), partial(_essl, "essl310"), SPIRV),
    # the same to the Metal Shading Language: text comes out; nothing outside Apple's tools compiles it
    Compiler("msl", ("spirv-cross",), _each(lambda _, module: spirv.cross(module, "msl")), SPIRV),
    # the same to HLSL of shader model 5: fxc takes that text
    Compiler("hlsl50", ("spirv-cross", "fxc"), _each(_hlsl50), SPIRV),
    # the compiler of an OpenGL driver, and the GLSL ES compiler of Chromium: both stages compile and link to a program
    Compiler("mesa", ("mesa",), _each(partial(_linked, mesa.build)), here=True),
    Compiler("angle", ("angle",), _each(partial(_linked, angle_tint.angle))),
    # wgpu's compiler, on WGSL or on DXC's SPIR-V, and Chromium's WGSL compiler: module and render pipeline are made
    Compiler("naga", ("naga",), _each(partial(_pipeline, naga.build)), ("dxc-spirv",), here=True),
    Compiler("tint", ("tint",), _each(partial(_pipeline, angle_tint.tint))),
)
# What they consist of -> which version it is, or Unavailable, which says how it is installed
TOOLS: dict[str, Callable[[], str]] = {
    "glslang": glslang.GLSLANG.version,
    "glslc": glslang.GLSLC.version,
    "mojoshader": mojoshader.version,
    "spirv-val": spirv.VAL.version,
    "spirv-cross": spirv.version_cross,
    "mesa": mesa.version,
    "naga": naga.version,
    "angle": partial(angle_tint.version, "webgl2"),
    "tint": partial(angle_tint.version, "webgpu"),
    "dxc": lambda: dxc.load().version,
    "fxc": lambda: fxc.load().version,
}
