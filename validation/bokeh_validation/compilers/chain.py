"""One variant through its compilers: from a shader to the cells of its row."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from bokeh_validation import browser, variants
from bokeh_validation.compilers import angle, dxc, fxc, glslang, glslc, mesa, mojoshader, naga, places, spirv, tint
from bokeh_validation.compilers.result import CompileResult, accepted, refused
from bokeh_validation.errors import Unavailable
from bokeh_validation.variants import Variant

OK, FAILED, NOT_APPLICABLE, MISSING = "ok", "failed", "n/a", "missing"

OPENGL_RULES, VULKAN_RULES = "opengl4.5", "vulkan1.0"


@dataclass(frozen=True)
class Cell:
    """Outcome of one compiler for one row.

    status   OK, FAILED, NOT_APPLICABLE or MISSING
    message  what the compiler printed; for MISSING how to install it
    facts    see CompileResult; warnings = number of lines printed although it is ok
    follows  the compiler whose failure left this one without input, else empty
    """

    status: str
    message: str = ""
    facts: dict[str, object] = field(default_factory=dict)
    follows: str = ""


Cells = dict[str, Cell]


class Runtimes:
    """Compilers that live in this process: made on first use and once, and remembered too where they are missing.

    gl, wgpu   functions that make the drivers, or raise Unavailable; by default mesa.driver and naga.driver
    chromium   function that gives the running browser, a new one where the last has died

    Use it from one thread.
    """

    def __init__(self, gl: Callable = mesa.driver, wgpu: Callable = naga.driver, chromium: Callable = browser.session):
        self.chromium = chromium
        self._make = {"gl": gl, "wgpu": wgpu, "dxc": dxc.load, "fxc": fxc.load}
        self._made: dict[str, object] = {}

    def get(self, name: str):
        """'gl' (a GLDriver), 'wgpu' (a WGPU), 'dxc' or 'fxc'. Raises Unavailable, the same each time."""
        if name not in self._made:
            try:
                self._made[name] = self._make[name]()
            except Unavailable as error:
                self._made[name] = error
            except ImportError as error:
                self._made[name] = Unavailable(f"{error.name} is not installed; validation/run sets it up")
        made = self._made[name]
        if isinstance(made, Unavailable):
            raise made
        return made


def in_process(variant: Variant, source: str, runtimes: Runtimes) -> tuple[Cells, CompileResult | None]:
    """Cells of fxc, DXC, mesa, angle, naga and tint, and DXC's SPIR-V for the tools that follow.

    Call it from one thread only.
    """
    cells: Cells = {}
    binary = None
    if variant.profile == "sm6":
        spirv_cell, binary = _attempt(lambda: _dxc(variant, source, runtimes, True))
        dxil_cell, _ = _attempt(lambda: _dxc(variant, source, runtimes, False))
        cells = {"dxc-spirv": spirv_cell, "dxc-dxil": dxil_cell}
        cells = {name: _located(cell, variant, source) for name, cell in cells.items()}
    if "fxc" in variant.compilers:
        cell, bytecode = _attempt(lambda: _fxc(variant, source, runtimes))
        cells["fxc"] = _located(cell, variant, source)
        if "mojoshader" in variant.compilers:
            cells["mojoshader"] = _following("fxc", cells["fxc"], lambda: mojoshader.build(bytecode.binary))
    if "mesa" in variant.compilers:
        cell, _ = _attempt(lambda: _mesa(variant, source, runtimes))
        cells["mesa"] = _located(cell, variant, source)
    if "angle" in variant.compilers:
        cell, _ = _attempt(lambda: _angle(variant, source, runtimes))
        cells["angle"] = _located(cell, variant, source)
    if "tint" in variant.compilers:
        cell, _ = _attempt(lambda: tint.build(*_wgsl_stages(variant, source), runtimes.chromium()))
        cells["tint"] = _located(cell, variant, source)
    if "naga" in variant.compilers:
        if variant.language == "wgsl":
            cell, _ = _attempt(lambda: naga.build(*_wgsl_stages(variant, source), runtimes.get("wgpu")))
            cells["naga"] = _located(cell, variant, source)
        else:
            cells["naga"] = _following(
                "dxc-spirv", cells["dxc-spirv"], lambda: _naga_spirv(variant, binary.binary, runtimes)
            )
    return cells, binary


def tools(variant: Variant, source: str, before: Cells, binary: CompileResult | None) -> Cells:
    """All cells of a row: those of in_process() and those of the command line compilers. Any thread may call it."""
    cells = dict(before)
    producer = "dxc-spirv"
    if "glslang" in variant.compilers:
        producer = "glslang"
        cell, binary = _attempt(lambda: _glslang(variant, source))
        cells["glslang"] = _located(cell, variant, source)
    if "glslc" in variant.compilers:
        cell, _ = _attempt(lambda: glslc.build(source, variant.stage))
        cells["glslc"] = _located(cell, variant, source)
    after: dict[str, Callable[[], CompileResult]] = {
        "spirv-val": lambda: spirv.validate(binary.binary, OPENGL_RULES if variant.profile == "330" else VULKAN_RULES),
        "essl300": lambda: spirv.cross_checked(binary.binary, variant.stage, "essl300"),
        "essl310": lambda: spirv.cross_checked(binary.binary, variant.stage, "essl310"),
        "msl": lambda: spirv.cross(binary.binary, "msl"),
        "hlsl50": lambda: _hlsl_again(binary.binary, variant.stage),
    }
    for column, step in after.items():
        if column in variant.compilers:
            cells[column] = _following(producer, cells[producer], step)
    return {name: cells[name] if name in variant.compilers else Cell(NOT_APPLICABLE) for name in variants.COLUMNS}


def _attempt(step: Callable[[], CompileResult]) -> tuple[Cell, CompileResult | None]:
    """Run one compiler. The result is None unless it is ok."""
    try:
        result = step()
    except Unavailable as error:
        return Cell(MISSING, str(error)), None
    cell = Cell(OK if result.ok else FAILED, result.messages, result.facts)
    return cell, result if result.ok else None


def _hlsl_again(binary: bytes, stage: str) -> CompileResult:
    """SPIR-V to HLSL by spirv-cross, compiled by fxc."""
    text = spirv.cross(binary, "hlsl50")
    if not text.ok:
        return text
    result = fxc.load().compile(text.binary.decode(), "vs_5_0" if stage == "vert" else "ps_5_0", "main")
    if result.ok:
        return accepted(result.messages, result.binary)
    return refused(f"spirv-cross wrote HLSL that fxc refuses:\n{result.messages}")


def _located(cell: Cell, variant: Variant, source: str) -> Cell:
    """The same with places as in the package's files."""
    return replace(cell, message=places.located(cell.message, source, variant.language))


def _following(producer: str, before: Cell, step: Callable[[], CompileResult]) -> Cell:
    """Run a compiler on the output of another, if there is any."""
    if before.status == MISSING:
        return Cell(MISSING, before.message, follows=producer)
    if before.status != OK:
        return Cell(FAILED, f"no input: {producer} failed", follows=producer)
    return _attempt(step)[0]


def _other(variant: Variant) -> Variant:
    """A program is a vertex and a fragment shader: what a row is linked with, taken as the package has it."""
    return replace(variant, entry=variants.VERTEX if variant.stage == "frag" else "BokehCoCMap", samples=None)


def _glslang(variant: Variant, source: str) -> CompileResult:
    if variant.language == "hlsl":
        return glslang.hlsl(source, variant.stage, variant.function)
    return glslang.glsl(source, variant.stage, variant.profile)


def _fxc(variant: Variant, source: str, runtimes: Runtimes) -> CompileResult:
    runtimes.get("fxc")
    return fxc.build(source, variant.stage, variant.function, int(variant.profile.removeprefix("sm")))


def _dxc(variant: Variant, source: str, runtimes: Runtimes, to_spirv: bool) -> CompileResult:
    runtimes.get("dxc")
    return dxc.build(source, variant.stage, variant.function, to_spirv)


def _mesa(variant: Variant, source: str, runtimes: Runtimes) -> CompileResult:
    return _own(variant, mesa.build(*_glsl_stages(variant, source), runtimes.get("gl")))


def _angle(variant: Variant, source: str, runtimes: Runtimes) -> CompileResult:
    return _own(variant, angle.build(*_glsl_stages(variant, source), runtimes.chromium()))


def _glsl_stages(variant: Variant, source: str) -> tuple[str, str]:
    """Vertex and fragment shader of a row."""
    pair = {variant.stage: source, _other(variant).stage: variants.source(_other(variant))}
    return pair["vert"], pair["frag"]


def _own(variant: Variant, result: CompileResult) -> CompileResult:
    """What a linker of two stages says of the row's own."""
    # the partner is as the package has it, so what it says is not about this row, and its line numbers are not either
    own = ("vertex:", "link:") if variant.stage == "vert" else ("fragment:", "link:")
    messages = "\n".join(line for line in result.messages.splitlines() if line.startswith(own))
    if result.ok:
        return accepted(messages)
    return refused(messages or result.messages)


def _wgsl_stages(variant: Variant, source: str) -> tuple[naga.Stage, naga.Stage]:
    """Vertex and fragment stage of a row."""
    other = _other(variant)
    pair = {
        variant.stage: naga.Stage(source, variant.function, variants.constants(variant), variant.targets),
        other.stage: naga.Stage(source, other.function),
    }
    return pair["vert"], pair["frag"]


def _naga_spirv(variant: Variant, binary: bytes, runtimes: Runtimes) -> CompileResult:
    other = _other(variant)
    partner = dxc.build(variants.source(other), other.stage, other.function)
    if not partner.ok:
        return partner
    pair = {
        variant.stage: naga.Stage(binary, variant.function, targets=variant.targets),
        other.stage: naga.Stage(partner.binary, other.function),
    }
    return naga.build(pair["vert"], pair["frag"], runtimes.get("wgpu"))
