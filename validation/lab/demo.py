"""Build a live page to try the methods in a browser: the command `validation/run demo`.

The page is a web project, integration/demo, which Vite builds for a static host or as one HTML file. This module
writes its data: the passes of methods.plan and the scenes. The page draws them with the code of the browser drivers
(browser/page).
"""

import json
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Annotated

import numpy as np
import OpenEXR
import typer

from bokeh_validation import browser, files, paths, process, shaders, terminal
from bokeh_validation.errors import UserError
from bokeh_validation.frame import methods
from bokeh_validation.shaders.entries import EXACT
from bokeh_validation.shaders.passes import Pass, is_linear
from bokeh_validation.truth import EXPOSURE, ray_traced
from engines import pages
from lab.other_effects import effects

PROJECT = paths.ROOT / "integration" / "demo"
# Folders of the repository that the build and its tests read
READ = (browser.PAGE, effects.PAGE, paths.ROOT / "integration/web/test")
BUILD_LIMIT = 300.0  # seconds; it takes 3
OTHERS = ("BokehPass", "DepthOfFieldEffect")
# The page's name of a scene -> the scene
SCENES = {
    "Night market": ray_traced.MARKET,
    "Winter evening": ray_traced.WINTER,
    "Street lights": ray_traced.STREET,
    "Canopy": ray_traced.CANOPY,
}
BOKEH_SCALE = 10.0  # the page's initial value, as in every integration
PACKAGE = paths.ROOT / "integration/web/package.json"
# Text of a link -> file of the repository
LINKS = {"source": "", "guide": "docs/start.md", "results": "docs/results.md", "engines": "integration/README.md"}
# size for the plans; the page replaces it by the image's
SIZE = (960, 540)
HOST = "127.0.0.1"


def settings() -> dict[str, methods.Settings]:
    """Return 'method aperture preset' -> settings of every frame that the page can draw; paper has no presets."""
    frames = {f"paper {aperture}": methods.Settings("paper", aperture) for aperture in EXACT}
    for aperture in EXACT:
        for preset in methods.PRESETS:
            for method in ("exact", "layered"):
                frames[f"{method} {aperture} {preset}"] = methods.Settings(method, aperture, preset=preset)
    return frames


def data() -> dict:
    """Return the data of src/main.js, ready for JSON."""
    glsl = shaders.text("glsl")
    plans = {name: methods.plan(frame_settings, SIZE).passes for name, frame_settings in settings().items()}
    # presets and polygons share many passes
    passes: dict[str, dict] = {}
    numbers = {}
    for name, frame_passes in plans.items():
        texts = [
            (json.dumps(page_pass, sort_keys=True), page_pass)
            for page_pass in (_pass(render_pass, glsl) for render_pass in frame_passes)
        ]
        passes.update(texts)
        numbers[name] = [list(passes).index(text) for text, _ in texts]
    address = json.loads(PACKAGE.read_text(encoding="utf-8")).get("repository", {}).get("url", "")
    return {
        "plans": numbers,
        "passes": list(passes.values()),
        "install": "npm install polygonal-bokeh three"
        if address
        else "npm install --install-links PATH/integration/web three",
        "links": links(address),
        "apertures": {sides: aperture for aperture, sides in EXACT.items()},
        "presets": list(methods.PRESETS),
        # visitors download it: without comments
        "glsl": "\n".join(filter(str.strip, shaders.COMMENT.sub("", glsl).splitlines())) + "\n",
        "vertex": shaders.glsl("BokehFullScreen", "300es").removesuffix(glsl),
        "sensor": ray_traced.MARKET.camera.sensor_height,
        "maxCoC": ray_traced.MARKET.camera.max_coc,
        "others": {name: effects.title(name) for name in OTHERS},
        "scenes": [_scene(name, scene) for name, scene in SCENES.items()],
    }


def links(address: str) -> list[tuple[str, str]]:
    """Return (text, address) of the page's links into the repository at `address`; none without one."""
    page = address.removeprefix("git+").removesuffix(".git")
    return [(text, f"{page}/blob/main/{file}" if file else page) for text, file in LINKS.items()] if page else []


def _pass(render_pass: Pass, glsl: str) -> dict:
    inputs = [
        {"slot": slot, "image": name, "linear": is_linear(render_pass.entry, slot)}
        for slot, name in render_pass.inputs.items()
    ]
    head = shaders.glsl(render_pass.entry, "300es", render_pass.constants).removesuffix(glsl)
    values = {name: float(value) for name, value in render_pass.values().items()}
    return {
        "head": head,
        "inputs": inputs,
        "targets": render_pass.outputs,
        "scale": render_pass.scale,
        "values": values,
    }


def _scene(name: str, scene: ray_traced.SceneFile) -> dict:
    camera = scene.camera
    return {
        "name": name,
        "file": scene.name,
        "traced": camera.focal_length / camera.aperture_diameter * BOKEH_SCALE,  # f-stop of the truth
        "focal": camera.focal_length,
        "focus": camera.focus_distance,
        "exposure": EXPOSURE.get(scene.name, 1.0),
        "rotation": ray_traced.TRUTH_ROTATION["hexagon"],
    }


def shown_depth(scene: ray_traced.SceneFile) -> np.ndarray:
    """Return the depth of a scene as the page has it, metres: 16-bit floats, which make the file a third smaller."""
    return ray_traced.picture(scene).depth.astype(np.float16)


def _write_pinhole(scene: ray_traced.SceneFile, target: Path) -> None:
    """Write the image that the page blurs: colour and depth."""
    color = ray_traced.picture(scene).color.astype(np.float16)
    channels = {name: np.ascontiguousarray(color[..., channel]) for channel, name in enumerate("RGB")}
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, channels | {"Z": shown_depth(scene)}) as file:
        file.write(str(target))


def write_data(folder: Path) -> None:
    """Write the data for the build: page.json, and for each scene the input and the ray-traced truth."""
    (folder / "page.json").write_text(json.dumps(data()), encoding="utf-8")
    for scene in SCENES.values():
        truth = paths.SCENES / f"{scene.name}_{ray_traced.TRUTHS['hexagon']}.exr"
        _write_pinhole(scene, folder / f"{scene.name}_pinhole.exr")
        shutil.copy(truth, folder / f"{scene.name}_truth.exr")


def copied(repository: Path) -> Path:
    """Copy the project and the folders that it reads to the same places in a repository, and install its packages.

    Returns the project's folder there. Raises Unavailable if npm is missing, or Node.js is too old for Vite.
    """
    pages.check_node()
    return pages.copied(PROJECT, repository, READ)


@contextmanager
def built(mode: str) -> Iterator[Path]:
    """Build the page and yield its folder. Raises Unavailable if npm is missing.

    mode  "host": index.html with scripts and images as files; "file": index.html that contains all of them
    """
    with tempfile.TemporaryDirectory(prefix="bokeh-") as repository:
        project = copied(Path(repository))
        write_data(paths.ensured(project / "data"))
        process.run(["npm", "run", "build", "--", "--mode", mode], BUILD_LIMIT, project)
        yield project / "dist"


class _Handler(SimpleHTTPRequestHandler):
    """Serve the files of a folder without logging."""

    def log_message(self, *_):
        """Log nothing."""


@contextmanager
def server(port: int) -> Iterator[ThreadingHTTPServer]:
    """Yield a server of the page for this machine only; port 0 chooses a free one. Raises UserError."""
    with built("host") as folder:
        try:
            serving = ThreadingHTTPServer((HOST, port), partial(_Handler, directory=folder))
        except (OSError, OverflowError) as error:
            raise UserError(f"--port {port}: cannot be used ({error}). Give another, or 0 for any.") from error
        with serving:
            yield serving


def _write_host(target: Path) -> None:
    """Write the page for a static host into a folder."""
    with built("host") as folder:
        shutil.copytree(folder, target, dirs_exist_ok=True)


def demo(
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FOLDER or FILE.html", help="Write the page, and do not serve it."),
    ] = None,
    port: Annotated[int, typer.Option(help="Port to serve the page on; 0: any free one.")] = 8015,
    data_folder: Annotated[
        Path | None, typer.Option("--data", metavar="FOLDER", help="Write only the data, for Vite's own server.")
    ] = None,
) -> None:
    """Serve or write a page to try the methods: side by side, focus by a click, sliders for the lens,
    your own images.
    """
    if data_folder is not None:
        files.check_folder("--data", data_folder)
        write_data(data_folder)
        return
    if output is not None and output.suffix.lower() in (".html", ".htm"):
        terminal.check_writable(output)
        with built("file") as folder:
            text = (folder / "index.html").read_text(encoding="utf-8")
        files.whole(output, lambda partial: partial.write_text(text, encoding="utf-8"))
        terminal.tell(f"{output}: {len(text) / 1e6:.1f} MB; open it in a browser with WebGL 2")
        return
    if output is not None:
        files.new_folder("--output", output, _write_host)
        terminal.tell(f"{output}: copy it to a static host; index.html does not open from disk")
        return
    with server(port) as serving:
        terminal.tell(f"http://{HOST}:{serving.server_address[1]}/  (Ctrl+C ends it)")
        try:
            serving.serve_forever()
        except KeyboardInterrupt:
            terminal.tell("ended")
