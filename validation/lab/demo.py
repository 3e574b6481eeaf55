"""A page to try the methods on, live, in a browser: the work behind `validation/run demo`.

The page is a web project, integration/demo, which Vite builds as one HTML file. Here its data is written: the passes of
methods.plan and the scenes. The page draws them with the code of the browser drivers (browser/page).
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

import typer

from bokeh_validation import browser, files, paths, process, shaders, terminal
from bokeh_validation.engines import pages
from bokeh_validation.errors import UserError
from bokeh_validation.frame import methods
from bokeh_validation.shaders.entries import EXACT
from bokeh_validation.shaders.passes import Pass, is_linear
from bokeh_validation.truth import EXPOSURE, ray_traced
from lab.other_effects import effects

PROJECT = paths.ROOT / "integration" / "demo"
# Folders of the repository that the build reads, and its tests
READ = (browser.PAGE, effects.PAGE, paths.ROOT / "integration/web/test")
BUILD_LIMIT = 300.0  # seconds; it takes 3
OTHERS = ("BokehPass", "DepthOfFieldEffect")
SCENES = (ray_traced.MARKET, ray_traced.STREET, ray_traced.CANOPY)
# of the plans: the page puts in its own
SIZE = (960, 540)
HOST = "127.0.0.1"


def settings() -> dict[str, methods.Settings]:
    """'method aperture preset' -> settings of every frame that the page can draw; paper has no preset."""
    frames = {f"paper {aperture}": methods.Settings("paper", aperture) for aperture in EXACT}
    for aperture in EXACT:
        for preset in methods.PRESETS:
            for method in ("exact", "layered"):
                frames[f"{method} {aperture} {preset}"] = methods.Settings(method, aperture, preset=preset)
    return frames


def data() -> dict:
    """What src/main.js works on, ready for JSON."""
    glsl = shaders.text("glsl")
    plans = {name: methods.plan(chosen, SIZE).passes for name, chosen in settings().items()}
    return {
        "plans": {name: [_pass(item, glsl) for item in passes] for name, passes in plans.items()},
        "apertures": {sides: aperture for aperture, sides in EXACT.items()},
        "presets": list(methods.PRESETS),
        "glsl": glsl,
        "vertex": shaders.glsl("BokehFullScreen", "300es"),
        "sensor": ray_traced.MARKET.camera.sensor_height,
        "maxCoC": ray_traced.MARKET.camera.max_coc,
        "others": {name: effects.title(name) for name in OTHERS},
        "scenes": [_scene(scene) for scene in SCENES],
    }


def _pass(item: Pass, glsl: str) -> dict:
    inputs = [
        {"slot": slot, "image": name, "linear": is_linear(item.entry, slot)} for slot, name in item.inputs.items()
    ]
    head = shaders.glsl(item.entry, "300es", item.constants).removesuffix(glsl)
    values = {name: float(value) for name, value in item.values().items()}
    return {"head": head, "inputs": inputs, "targets": item.outputs, "scale": item.scale, "values": values}


def _scene(scene: ray_traced.SceneFile) -> dict:
    camera = scene.camera
    return {
        "name": scene.name,
        "stop": camera.focal_length / camera.aperture_diameter,
        "focal": camera.focal_length,
        "focus": camera.focus_distance,
        "exposure": EXPOSURE.get(scene.name, 1.0),
        "rotation": ray_traced.TRUTH_ROTATION["hexagon"],
    }


def write_data(folder: Path) -> None:
    """Write what the page is built with: page.json, and of each scene the input and the ray-traced truth."""
    (folder / "page.json").write_text(json.dumps(data()), encoding="utf-8")
    for scene in SCENES:
        truth = paths.SCENES / f"{scene.name}_{ray_traced.TRUTHS['hexagon']}.exr"
        shutil.copy(scene.source, folder / f"{scene.name}_pinhole.exr")
        shutil.copy(truth, folder / f"{scene.name}_truth.exr")


def copied(repository: Path) -> Path:
    """Copy the project and what it reads to where they are in a repository, and install its packages there.

    Returns the project's folder. Raises Unavailable where npm is missing or Node.js is too old for Vite.
    """
    pages.check_node()
    return pages.copied(PROJECT, repository, READ)


def page() -> str:
    """Build the page and return the whole file. Raises Unavailable where npm is missing."""
    with tempfile.TemporaryDirectory(prefix="bokeh-") as repository:
        project = copied(Path(repository))
        write_data(paths.ensured(project / "data"))
        process.run(["npm", "run", "build"], BUILD_LIMIT, project)
        return (project / "dist" / "index.html").read_text(encoding="utf-8")


class _Handler(SimpleHTTPRequestHandler):
    """Files of a folder, in silence."""

    def log_message(self, *_):
        """Nothing."""


@contextmanager
def server(port: int) -> Iterator[ThreadingHTTPServer]:
    """What serves the page to this machine alone; port 0 takes a free one. Raises UserError."""
    with tempfile.TemporaryDirectory(prefix="bokeh-") as folder:
        Path(folder, "index.html").write_text(page(), encoding="utf-8")
        try:
            serving = ThreadingHTTPServer((HOST, port), partial(_Handler, directory=folder))
        except (OSError, OverflowError) as error:
            raise UserError(f"--port {port}: cannot be used ({error}). Give another, or 0 for any.") from error
        with serving:
            yield serving


def demo(
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE.html", help="Write the page, and do not serve it.")
    ] = None,
    port: Annotated[int, typer.Option(help="To serve it on; 0: any that is free.")] = 8015,
    data_folder: Annotated[
        Path | None, typer.Option("--data", metavar="FOLDER", help="Write only the data, for Vite's own server.")
    ] = None,
) -> None:
    """A page to try it: methods side by side, focus by a click, lens and aperture by sliders, pictures of your own."""
    if data_folder is not None:
        files.check_folder("--data", data_folder)
        write_data(data_folder)
        return
    if output is not None:
        terminal.check_writable(output)
        text = page()
        files.whole(output, lambda partial: partial.write_text(text, encoding="utf-8"))
        terminal.tell(f"{output}: {len(text) / 1e6:.1f} MB; open it in a browser with WebGL 2")
        return
    with server(port) as serving:
        terminal.tell(f"http://{HOST}:{serving.server_address[1]}/  (Ctrl+C ends it)")
        try:
            serving.serve_forever()
        except KeyboardInterrupt:
            terminal.tell("ended")
