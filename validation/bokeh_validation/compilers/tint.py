"""tint, the WGSL compiler of Chromium and Dawn, asked through WebGPU."""

from bokeh_validation import browser
from bokeh_validation.compilers.naga import TARGET_FORMAT, Stage
from bokeh_validation.compilers.result import CompileResult, accepted, refused
from bokeh_validation.passes import SAMPLE_TYPES

INSTALL = browser.INSTALL


def version(session: browser.Session | None = None) -> str:
    """Chromium, which tint and Dawn have the version of, and the device below. Raises Unavailable."""
    session = session or browser.session()
    return f"Chromium {session.version}, {session.call('webgpu.describe', limit=browser.COMPILE_LIMIT)['device']}"


def build(vertex: Stage, fragment: Stage, session: browser.Session) -> CompileResult:
    """Make a WGSL module and a render pipeline of two of its entry points, with the package's bindings.

    Both stages are of one module: they have the same code.
    """
    if vertex.code != fragment.code:
        raise ValueError("the stages are of different modules")
    job = {
        "code": fragment.code,
        "slots": SAMPLE_TYPES,
        "formats": [TARGET_FORMAT] * fragment.targets,
        "vertex": {"entry": vertex.entry, "constants": dict(vertex.constants)},
        "fragment": {"entry": fragment.entry, "constants": dict(fragment.constants)},
    }
    try:
        done = session.call("webgpu.compile", job, limit=browser.COMPILE_LIMIT)
    except (browser.BrowserError, browser.Refused) as error:
        return refused(str(error))
    lines = [f"wgsl:{said['line']}:{said['column']}: {said['type']}: {said['text']}" for said in done["messages"]]
    lines += done["pipeline"].splitlines()
    return accepted("\n".join(lines)) if done["ok"] else refused("\n".join(lines))
