"""Samples for the web (integration/threejs and others) in headless Chromium, WebGL 2 and WebGPU.

'threejs-webgl' is webgl.html of integration/threejs; capture.js beside it makes the captures. The page sees the
repository as it is, and node_modules from the cache folder. Nothing listens on a port: every request of the page is
answered from here.
"""

import base64
import json
import shutil
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from hashlib import sha256
from pathlib import Path

from bokeh_validation import browser, locks, paths
from bokeh_validation.engines import process
from bokeh_validation.errors import Unavailable

INSTALL = "apt-get install -y --no-install-recommends npm"
INSTALL_LIMIT = 300.0  # seconds; it takes 2 to 5
RUN_LIMIT = 240.0  # it takes 10 on two cores
# Of what the browser said, an error repeats so many messages, and so many characters of each
MESSAGES, WORDS = 4, 800

# without them Chromium's software device dies as soon as WebGPU draws onto a canvas
CANVAS = ("--enable-features=Vulkan", "--use-vulkan=swiftshader")
# The sample's page knows nothing of captures: capture.js comes in when one of its functions is asked for.
SCRIPT = """
const asked = (name) => async (argument) => (await import("/integration/%s/capture.js"))[name](argument);
window.bokeh = new Proxy({}, { get: (_, name) => asked(name) });
"""


def run(name: str, folder: Path, project: Path | None = None) -> None:
    """Run 'threejs-webgl', for one, and leave its capture and picture.png in `folder`.

    project   see opened()
    Raises Unavailable where npm or Chromium is missing, RuntimeError with what the engine or the browser said.
    """
    with opened(name, project) as sample:
        leave(sample, folder)


def leave(sample: "Sample", folder: Path) -> None:
    """The sample's capture, put into `folder`. Raises RuntimeError."""
    captured = sample.call("capture", sample.kind)
    for file, data in captured["files"].items():
        (folder / file).write_bytes(base64.b64decode(data))
    (folder / "capture.json").write_text(json.dumps(captured["data"], indent=1), encoding="utf-8")


@dataclass
class Sample:
    """A sample that runs in a browser of its own.

    kind   'webgl', 'webgpu', or '' where there is one only
    said   errors that the engine and the browser wrote to the console
    """

    session: browser.Session
    kind: str = ""
    said: list[str] = field(default_factory=list)

    def call(self, function: str, argument: object) -> object:
        """Call a function that capture.js exports. Raises RuntimeError, also where something was only logged."""
        try:
            result = self.session.call(function, argument, RUN_LIMIT)
        except RuntimeError as error:
            raise RuntimeError("\n".join([str(error), *self._first_words()])) from error
        if self.said:
            raise RuntimeError("\n".join(self._first_words()))
        return result

    def _first_words(self) -> list[str]:
        """What went wrong first: one mistake in the library is told once for every pass, with all of its code."""
        return [text[:WORDS] for text in dict.fromkeys(self.said)][:MESSAGES]


@contextmanager
def opened(name: str, project: Path | None = None) -> Iterator[Sample]:
    """The page of a sample, running. Raises Unavailable.

    project   folder that has integration/, with node_modules in the sample; else the checkout, and the cache folder's
    """
    engine, _, kind = name.partition("-")
    root = project or paths.ROOT
    modules = root / "integration" / engine / "node_modules"
    if project is None:
        modules = installed(root / "integration" / engine)
    flags = CANVAS if kind == "webgpu" else ()
    serve = partial(_serve, root, engine, modules)
    with shown(f"integration/{engine}/{kind}.html", serve, SCRIPT % engine, flags) as sample:
        sample.kind = kind
        yield sample


@contextmanager
def shown(address: str, serve: Callable, script: str, flags: Sequence[str] = ()) -> Iterator[Sample]:
    """A page, running.

    serve   answers a request of it, a route of Playwright's
    script  runs before its own, and makes window.bokeh
    flags   more of Chromium's command line
    """
    said: list[str] = []

    def open_page(chromium):
        page = chromium.new_page()
        page.route("**/*", serve)
        page.on("console", lambda message: said.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: said.append(error.message))
        page.add_init_script(script)
        page.goto(f"{browser.ADDRESS}{address}")
        return page

    session = browser.Session(open_page=open_page, flags=flags)
    try:
        yield Sample(session, said=said)
    finally:
        session.close()


@locks.held("npm")
def installed(source: Path) -> Path:
    """node_modules with what a folder's package-lock.json pins, installed on first use.

    Raises Unavailable, RuntimeError.
    """
    lock = (source / "package-lock.json").read_bytes()
    target = paths.cache_folder() / "engines" / source.name / f"npm-{sha256(lock).hexdigest()[:16]}"
    if not target.exists():
        # in place only when complete
        folder = Path(tempfile.mkdtemp(dir=paths.ensured(target.parent)))
        try:
            for name in ("package.json", "package-lock.json"):
                shutil.copy(source / name, folder)
            call_npm(folder, "ci")
            if not target.exists():
                folder.rename(target)
        finally:
            shutil.rmtree(folder, ignore_errors=True)
    return target / "node_modules"


def call_npm(folder: Path, *command: str | Path) -> None:
    """Have npm install in a folder: its scripts are not run. Raises Unavailable, RuntimeError."""
    npm = shutil.which("npm")
    if npm is None:
        raise Unavailable(f"npm is not on this machine; {INSTALL}")
    options = ("--ignore-scripts", "--no-audit", "--no-fund", "--no-update-notifier", "--loglevel=error")
    cache = str(paths.cache_folder() / "npm")
    process.run([npm, *command, *options], INSTALL_LIMIT, folder, {"npm_config_cache": cache})


def _serve(root: Path, engine: str, modules: Path, route) -> None:
    """Answer a request: a file of `root`, or of `modules`."""
    name = browser.asked(route)
    local = name.removeprefix(f"integration/{engine}/node_modules/")
    if name == "favicon.ico":
        route.fulfill(status=204)
    else:
        browser.answer(route, modules / local if local != name else root / name)
