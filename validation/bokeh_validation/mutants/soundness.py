"""Whether a mutant proves anything: it compiles, and is a mistake of the kind that it says."""

from collections.abc import Mapping
from functools import cache
from threading import Lock

from bokeh_validation import parity, rules, shaders
from bokeh_validation.compilers import dxc, glslang, naga
from bokeh_validation.drivers.webgpu import WGPU
from bokeh_validation.entries import ENTRIES
from bokeh_validation.mutants.edits import originals
from bokeh_validation.mutants.model import Mutant

# DXC has one compiler object, and the device is shared
_one_at_a_time = Lock()


def refusal(mutant: Mutant, texts: Mapping[str, str], seen: bool) -> str:
    """Why it proves nothing, or ''. Raises Unavailable.

    texts  the files that it changes
    seen   whether the parity check notices
    """
    for language in mutant.languages:
        files = {**originals(), **texts}
        parts = [files[keys[language]] for keys in (parity.LIBRARY, parity.LAYERS, parity.PASSES)]
        said = COMPILERS[language](parts[0], "".join(parts), parity.PASSES[language] in texts)
        if said:
            return f"{language} does not compile: {said}"
    if mutant.everywhere and seen:
        return "not the same in all languages: the parity check sees it"
    return ""


def seen_by_parity(texts: Mapping[str, str]) -> bool:
    """Whether the parity check notices more in these files than a line that an edit has made too long."""
    return any(rules.TOO_LONG not in difference.what for difference in parity.check(texts))


def _glsl(library: str, whole: str, passes: bool) -> str:
    """The library is the same text in every pass: one shows whether it compiles."""
    head = shaders.GLSL_VERSIONS["330"] + "\n"
    for entry in ("BokehFullScreen", *ENTRIES) if passes else ("BokehCoCMap",):
        stage = "vert" if entry == "BokehFullScreen" else "frag"
        result = glslang.parse(f"{head}#define BOKEH_PASS {shaders.glsl_pass(entry)}\n{whole}", stage)
        if not result.ok:
            return f"{entry}: {result.messages}"
    return ""


def _hlsl(library: str, whole: str, passes: bool) -> str:
    """DXC reads every function and every entry, whichever it is asked for."""
    with _one_at_a_time:
        result = dxc.build(shaders.defines({"BOKEH_HLSL_SM": 6}) + whole, "frag", "BokehCoCMap_PS")
    return "" if result.ok else result.messages


def _wgsl(library: str, whole: str, passes: bool) -> str:
    with _one_at_a_time:
        device = _device()
        try:
            device.device.create_shader_module(code=whole)
        except (device.wgpu.GPUError, device.wgpu.GPUPipelineError) as error:
            return str(error)
    return ""


@cache
def _device() -> WGPU:
    return naga.driver()


COMPILERS = {"hlsl": _hlsl, "glsl": _glsl, "wgsl": _wgsl}
