"""The compilers of Chromium: ANGLE (GLSL ES), asked through WebGL 2, and tint (WGSL), asked through WebGPU.

ANGLE is that of Firefox, Safari and Edge as well; tint is Dawn's.
"""

from bokeh_validation import browser
from bokeh_validation.compilers.naga import TARGET_FORMAT, Stage
from bokeh_validation.compilers.tool import CompileResult, accepted, refused
from bokeh_validation.shaders.passes import SAMPLE_TYPES


def version() -> str:
    """Chromium's, which both are a part of. Raises Unavailable."""
    return f"Chromium {browser.session().version}"


def angle(vertex: str, fragment: str) -> CompileResult:
    """Compile both stages and link them. Each line of the messages begins with its stage, or with 'link'."""
    done = _called("webgl2.compile", {"vertex": vertex, "fragment": fragment})
    # ANGLE ends its logs with a zero
    logs = {stage: log.replace("\0", "").splitlines() for stage, log in done.get("logs", {}).items()}
    lines = [f"{stage}: {line.rstrip()}" for stage, log in logs.items() for line in log if line.strip()]
    return (accepted if done["ok"] else refused)("\n".join(lines) or done.get("error", ""))


def tint(vertex: Stage, fragment: Stage) -> CompileResult:
    """Make a WGSL module, the code of both stages, and a render pipeline of them, with the package's bindings."""
    job = {
        "code": fragment.code,
        "slots": SAMPLE_TYPES,
        "formats": [TARGET_FORMAT] * fragment.targets,
        "vertex": {"entry": vertex.entry, "constants": dict(vertex.constants)},
        "fragment": {"entry": fragment.entry, "constants": dict(fragment.constants)},
    }
    done = _called("webgpu.compile", job)
    lines = [f"wgsl:{m['line']}:{m['column']}: {m['type']}: {m['text']}" for m in done.get("messages", ())]
    return (accepted if done["ok"] else refused)("\n".join(lines) + "\n" + done.get("pipeline", done.get("error", "")))


def _called(function: str, job: dict) -> dict:
    """What the page answers; a crash or a hang is {'ok': False, 'error': ..}."""
    try:
        return browser.session().call(function, job, limit=browser.COMPILE_LIMIT)
    except (browser.BrowserError, browser.Refused) as error:
        return {"ok": False, "error": str(error)}
