"""ANGLE, the GLSL ES compiler of Chromium (and of Firefox, Safari and Edge on WebGL), asked through WebGL 2."""

from bokeh_validation import browser
from bokeh_validation.compilers.result import CompileResult, accepted, refused

INSTALL = browser.INSTALL
STAGES = ("vertex", "fragment", "link")


def version(session: browser.Session | None = None) -> str:
    """Chromium, which ANGLE has the version of, and the device below. Raises Unavailable."""
    session = session or browser.session()
    return f"Chromium {session.version}, {session.call('webgl2.describe', limit=browser.COMPILE_LIMIT)['device']}"


def build(vertex: str, fragment: str, session: browser.Session) -> CompileResult:
    """Compile both stages and link them. Each line of the messages begins with its stage, or with 'link'."""
    try:
        sources = {"vertex": vertex, "fragment": fragment}
        done = session.call("webgl2.compile", sources, limit=browser.COMPILE_LIMIT)
    except (browser.BrowserError, browser.Refused) as error:
        return refused(str(error))
    lines = [f"{stage}: {line}" for stage in STAGES for line in _lines(done["logs"][stage])]
    return accepted("\n".join(lines)) if done["ok"] else refused("\n".join(lines))


def _lines(log: str) -> list[str]:
    # ANGLE ends its logs with a zero
    return [line.rstrip() for line in log.replace("\0", "").splitlines() if line.strip()]
