"""three.js: the samples of integration/threejs in headless Chromium, WebGL 2 and WebGPU.

The page sees the repository as it is, and node_modules from the cache folder. Nothing listens on a port: every request
of the page is answered from here.
"""

import base64
import json
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path

from bokeh_validation import browser, locks, paths
from bokeh_validation.engines import process
from bokeh_validation.errors import Unavailable

FOLDER = paths.ROOT / "integration" / "threejs"
KINDS = {"threejs-webgl": "webgl", "threejs-webgpu": "webgpu"}
INSTALL = "apt-get install -y --no-install-recommends npm"
INSTALL_LIMIT = 300.0  # seconds; it takes 2
RUN_LIMIT = 240.0  # it takes 10 on two cores
# Of what the browser said, an error repeats so many messages, and so many characters of each
MESSAGES, WORDS = 4, 800

MODULES = "integration/threejs/node_modules/"
# without them Chromium's software device dies as soon as WebGPU draws onto a canvas
CANVAS = ("--enable-features=Vulkan", "--use-vulkan=swiftshader")
# The sample's page knows nothing of captures: capture.js comes in when it is asked for.
SCRIPT = """
const asked = (name) => async (argument) => (await import("/integration/threejs/capture.js"))[name](argument);
const names = ["capture", "depths", "logarithmic", "views", "interaction"];
window.bokeh = Object.fromEntries(names.map((name) => [name, asked(name)]));
"""


def run(name: str, folder: Path) -> None:
    """Run 'threejs-webgl' or 'threejs-webgpu' and leave its capture and picture.png in `folder`.

    Raises Unavailable where npm or Chromium is missing, RuntimeError with what three.js or the browser said.
    """
    kind = KINDS[name]
    with opened(kind) as sample:
        captured = sample.call("capture", kind)
    for file, data in captured["files"].items():
        (folder / file).write_bytes(base64.b64decode(data))
    (folder / "capture.json").write_text(json.dumps(captured["data"], indent=1), encoding="utf-8")


@dataclass
class Sample:
    """A sample that runs in a browser of its own.

    said   errors that three.js and the browser wrote to the console
    """

    session: browser.Session
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
def opened(kind: str) -> Iterator[Sample]:
    """The page of 'webgl' or 'webgpu', running. Raises Unavailable."""
    modules = installed()
    said: list[str] = []

    def open_page(chromium):
        page = chromium.new_page()
        page.route("**/*", lambda route: _serve(route, modules))
        page.on("console", lambda message: said.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: said.append(error.message))
        page.add_init_script(SCRIPT)
        page.goto(f"{browser.ADDRESS}integration/threejs/{kind}.html")
        return page

    session = browser.Session(open_page=open_page, flags=CANVAS if kind == "webgpu" else ())
    try:
        yield Sample(session, said)
    finally:
        session.close()


@locks.held("threejs")
def installed() -> Path:
    """node_modules with what package-lock.json pins, installed on first use. Raises Unavailable, RuntimeError."""
    lock = (FOLDER / "package-lock.json").read_bytes()
    target = paths.cache_folder() / "engines" / "threejs" / f"npm-{sha256(lock).hexdigest()[:16]}"
    if not target.exists():
        npm = shutil.which("npm")
        if npm is None:
            raise Unavailable(f"npm is not on this machine; {INSTALL}")
        # in place only when complete
        folder = Path(tempfile.mkdtemp(dir=paths.ensured(target.parent)))
        try:
            for name in ("package.json", "package-lock.json"):
                shutil.copy(FOLDER / name, folder)
            options = ("--ignore-scripts", "--no-audit", "--no-fund", "--no-update-notifier", "--loglevel=error")
            cache = str(paths.cache_folder() / "npm")
            process.run([npm, "ci", *options], INSTALL_LIMIT, folder, {"npm_config_cache": cache})
            if not target.exists():
                folder.rename(target)
        finally:
            shutil.rmtree(folder, ignore_errors=True)
    return target / "node_modules"


def _serve(route, modules: Path) -> None:
    """Answer a request: a file of the repository, or of `modules`."""
    name = browser.asked(route)
    if name == "favicon.ico":
        route.fulfill(status=204)
    else:
        browser.answer(route, modules / name.removeprefix(MODULES) if name.startswith(MODULES) else paths.ROOT / name)
