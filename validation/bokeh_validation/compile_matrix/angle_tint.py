"""Compile with Chromium's compilers: ANGLE (GLSL ES) through WebGL 2, and Tint (WGSL) through WebGPU.

Firefox, Safari and Edge use ANGLE too; Tint is part of Dawn.
"""

from bokeh_validation import browser
from bokeh_validation.compile_matrix.naga import TARGET_FORMAT, Stage
from bokeh_validation.compilers.tool import CompileResult, accepted, refused
from bokeh_validation.shaders.passes import SAMPLE_TYPES


def version() -> str:
    """Return the version of Chromium, which contains both. Raises Unavailable."""
    return f"Chromium {browser.session().version}"


def angle(vertex: str, fragment: str) -> CompileResult:
    """Compile and link both stages. Each line of the messages begins with its stage, or with 'link'."""
    return _compiled("webgl2.compile", {"vertex": vertex, "fragment": fragment})


def tint(vertex: Stage, fragment: Stage) -> CompileResult:
    """Create a WGSL module, the code of both stages, and a render pipeline with the package's bindings."""
    job = {
        "code": fragment.code,
        "slots": SAMPLE_TYPES,
        "formats": [TARGET_FORMAT] * fragment.targets,
        "vertex": {"entry": vertex.entry, "constants": dict(vertex.constants)},
        "fragment": {"entry": fragment.entry, "constants": dict(fragment.constants)},
    }
    return _compiled("webgpu.compile", job)


def _compiled(function: str, job: dict) -> CompileResult:
    """Return the page's answer as a result; a crash or a hang is reported as a rejection."""
    try:
        done = browser.session().call(function, job)
    except (browser.BrowserError, browser.Refused) as error:
        return refused(str(error))
    return (accepted if done["ok"] else refused)("\n".join(done["lines"]))
