"""Run the web samples (integration/threejs and others) in headless Chromium, on WebGL 2 and WebGPU.

'threejs-webgl' is webgl.html of integration/threejs; capture.js next to it makes the captures. The page sees the
repository as it is, and node_modules from the cache folder. Nothing listens on a port: this process answers every
request of the page.
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
RUN_LIMIT = 240.0  # seconds; it takes 10 on two cores

# without these flags Chromium's software device fails as soon as WebGPU draws to a canvas
CANVAS = ("--enable-features=Vulkan", "--use-vulkan=swiftshader")
# The sample's page has no code for captures: capture.js is imported when one of its functions is called.
SCRIPT = """
const asked = (name) => async (argument) => (await import("/integration/%s/capture.js"))[name](argument);
window.bokeh = new Proxy({}, { get: (_, name) => asked(name) });
"""


def run(name: str, folder: Path, project: Path | None = None) -> None:
    """Run a sample such as 'threejs-webgl', which leaves its capture and picture.png in `folder`.

    project  see opened()
    Raises Unavailable if npm or Chromium is missing, RuntimeError with the messages of the engine or the browser.
    """
    with opened(name, project) as sample:
        leave(sample, folder, name.partition("-")[2])


def leave(sample: browser.Session, folder: Path, kind: str = "") -> None:
    """Make a capture of the open sample and write it to `folder`. Raises RuntimeError."""
    captured = sample.call("capture", kind)
    for file, data in captured["files"].items():
        (folder / file).write_bytes(base64.b64decode(data))
    (folder / "capture.json").write_text(json.dumps(captured["data"], indent=1), encoding="utf-8")


def opened(name: str, project: Path | None = None) -> browser.Session:
    """Open the page of a sample; the session's functions are the exports of capture.js. Raises Unavailable.

    project  folder that contains integration/, with node_modules in the sample; None: the checkout, with node_modules
             in the cache folder
    """
    engine, _, kind = name.partition("-")
    root = project or paths.ROOT
    places = [("", root)]
    if project is None:
        places.insert(0, (f"integration/{engine}/node_modules/", installed(root / "integration" / engine)))
    flags = CANVAS if kind == "webgpu" else ()
    return shown(f"integration/{engine}/{kind}.html", places, SCRIPT % engine, flags)


def shown(address: str, places: browser.Places, script: str, flags: tuple[str, ...] = ()) -> browser.Session:
    """Open a page of a sample with a generous time limit; arguments as for browser.Session."""
    return browser.Session(address, places, script, flags=flags, limit=RUN_LIMIT)


def installed(source: Path) -> Path:
    """Return node_modules with the packages pinned in a folder's package-lock.json, installed on first use.

    Raises Unavailable, RuntimeError.
    """
    files = [source / "package.json", source / "package-lock.json"]

    def install(folder: Path) -> None:
        for file in files:
            shutil.copy(file, folder)
        call_npm(folder, "ci")

    return locks.built_once(f"engines/{source.name}/npm", files, install) / "node_modules"


def copied(project: Path, repository: Path, beside: Iterable[Path] = ()) -> Path:
    """Copy a web project, and the folders that it reads, to the same places in another repository, and install its
    packages.

    Returns the project's folder there. Raises Unavailable if npm is missing.
    """
    for folder in (project, *beside):
        local = shutil.ignore_patterns("node_modules", "data", "dist")
        shutil.copytree(folder, repository / folder.relative_to(paths.ROOT), ignore=local)
    (repository / "node_modules").symlink_to(installed(project))
    return repository / project.relative_to(paths.ROOT)


def check_node() -> None:
    """Check that Node.js is recent enough for Vite. Raises Unavailable otherwise."""
    said = process.run([find("node", INSTALL), "--version"], INSTALL_LIMIT).strip()
    if tuple(map(int, said.removeprefix("v").split(".")[:2])) < OLDEST_NODE:
        raise Unavailable(f"Node.js is {said}; Vite needs {'.'.join(map(str, OLDEST_NODE))} or later")


def call_npm(folder: Path, *command: str | Path) -> None:
    """Run an npm command in a folder without running packages' scripts. Raises Unavailable, RuntimeError."""
    npm = find("npm", INSTALL)
    options = ("--ignore-scripts", "--no-audit", "--no-fund", "--no-update-notifier", "--loglevel=error")
    cache = str(paths.cache_folder() / "npm")
    process.run([npm, *command, *options], INSTALL_LIMIT, folder, {"npm_config_cache": cache})
