"""Samples for the web (integration/threejs and others) in headless Chromium, WebGL 2 and WebGPU.

'threejs-webgl' is webgl.html of integration/threejs; capture.js beside it makes the captures. The page sees the
repository as it is, and node_modules from the cache folder. Nothing listens on a port: every request of the page is
answered from here.
"""

import base64
import json
import shutil
from collections.abc import Iterable
from pathlib import Path

from bokeh_validation import browser, locks, needs, paths, process
from bokeh_validation.errors import Unavailable
from bokeh_validation.process import find

NAMES = tuple(f"{engine}-{kind}" for engine in ("threejs", "babylonjs", "playcanvas") for kind in ("webgl", "webgpu"))
INSTALL = needs.install("npm")
OLDEST_NODE = (20, 19)
INSTALL_LIMIT = 300.0  # seconds; it takes 2 to 5
RUN_LIMIT = 240.0  # it takes 10 on two cores

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
        leave(sample, folder, name.partition("-")[2])


def leave(sample: browser.Session, folder: Path, kind: str = "") -> None:
    """The sample's capture, put into `folder`. Raises RuntimeError."""
    captured = sample.call("capture", kind)
    for file, data in captured["files"].items():
        (folder / file).write_bytes(base64.b64decode(data))
    (folder / "capture.json").write_text(json.dumps(captured["data"], indent=1), encoding="utf-8")


def opened(name: str, project: Path | None = None) -> browser.Session:
    """The page of a sample, running; its functions are those that capture.js exports. Raises Unavailable.

    project   folder that has integration/, with node_modules in the sample; else the checkout, and the cache folder's
    """
    engine, _, kind = name.partition("-")
    root = project or paths.ROOT
    places = [("", root)]
    if project is None:
        places.insert(0, (f"integration/{engine}/node_modules/", installed(root / "integration" / engine)))
    flags = CANVAS if kind == "webgpu" else ()
    return shown(f"integration/{engine}/{kind}.html", places, SCRIPT % engine, flags)


def shown(address: str, places: browser.Places, script: str, flags: tuple[str, ...] = ()) -> browser.Session:
    """A page of a sample, as browser.Session takes it; in no hurry."""
    return browser.Session(address, places, script, flags=flags, limit=RUN_LIMIT)


def installed(source: Path) -> Path:
    """node_modules with what a folder's package-lock.json pins, installed on first use.

    Raises Unavailable, RuntimeError.
    """
    files = [source / "package.json", source / "package-lock.json"]

    def install(folder: Path) -> None:
        for file in files:
            shutil.copy(file, folder)
        call_npm(folder, "ci")

    return locks.built_once(f"engines/{source.name}/npm", files, install) / "node_modules"


def copied(project: Path, repository: Path, beside: Iterable[Path] = ()) -> Path:
    """Copy a web project, and what it reads beside it, to where they are in a repository; install its packages there.

    Returns the project's folder. Raises Unavailable where npm is missing.
    """
    for folder in (project, *beside):
        local = shutil.ignore_patterns("node_modules", "data", "dist")
        shutil.copytree(folder, repository / folder.relative_to(paths.ROOT), ignore=local)
    (repository / "node_modules").symlink_to(installed(project))
    return repository / project.relative_to(paths.ROOT)


def check_node() -> None:
    """Refuse a Node.js that Vite does not run on. Raises Unavailable."""
    said = process.run([find("node", INSTALL), "--version"], INSTALL_LIMIT).strip()
    if tuple(map(int, said.removeprefix("v").split(".")[:2])) < OLDEST_NODE:
        raise Unavailable(f"Node.js is {said}; Vite needs {'.'.join(map(str, OLDEST_NODE))} or later")


def call_npm(folder: Path, *command: str | Path) -> None:
    """Have npm install in a folder: its scripts are not run. Raises Unavailable, RuntimeError."""
    npm = find("npm", INSTALL)
    options = ("--ignore-scripts", "--no-audit", "--no-fund", "--no-update-notifier", "--loglevel=error")
    cache = str(paths.cache_folder() / "npm")
    process.run([npm, *command, *options], INSTALL_LIMIT, folder, {"npm_config_cache": cache})
