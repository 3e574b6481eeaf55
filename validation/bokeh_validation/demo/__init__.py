"""A page to try the methods on, live, in a browser: the work behind `validation/run demo`.

One HTML file with everything in it. Its passes are those of methods.plan as data; it draws them with the code of the
browser drivers (browser/page).
"""

import base64
import gzip
import json
import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Annotated

import typer

from bokeh_validation import browser, files, paths, shaders, terminal
from bokeh_validation.engines import pages
from bokeh_validation.errors import UserError
from bokeh_validation.frame import methods
from bokeh_validation.shaders.entries import EXACT
from bokeh_validation.shaders.passes import Pass, is_linear
from bokeh_validation.truth import EXPOSURE, ray_traced
from lab.other_effects import effects

PAGE = Path(__file__).parent / "page"
MODULES = (
    *(browser.PAGE / name for name in ("job.js", "webgl2.js")),
    *(effects.PAGE / name for name in ("feed.js", "three_webgl.js")),
    *sorted(PAGE.glob("*.js")),
)
# What they use of npm's packages
LIBRARIES = (
    *(f"three/build/three.{name}.js" for name in ("core", "module")),
    *(f"three/examples/jsm/postprocessing/{name}Pass.js" for name in ("Bokeh", "Mask", "Render", "Shader")),
    *(f"three/examples/jsm/postprocessing/{name}.js" for name in ("EffectComposer", "Pass")),
    *(f"three/examples/jsm/shaders/{name}Shader.js" for name in ("Bokeh", "Copy")),
    "three/examples/jsm/loaders/EXRLoader.js",
    "three/examples/jsm/libs/fflate.module.js",
    "postprocessing/build/index.js",
)
PACKAGES = {"three": "three.module.js", "postprocessing": "index.js"}
IMPORT = re.compile(r"""\b(from|import)\s*(['"])(three|postprocessing|[./\w-]+\.js)\2""")
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
    """What page/main.js works on, ready for JSON."""
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


def page() -> str:
    """The whole file. Raises Unavailable where npm is missing."""
    text = (PAGE / "index.html").read_text(encoding="utf-8")
    # in a text of JSON "</" would end the element
    text_of_data = json.dumps(data()).replace("</", "<\\/")
    parts = [f'<script type="application/json" id="data">{text_of_data}</script>', _packed("modules", _modules())]
    for scene in SCENES:
        truth = paths.SCENES / f"{scene.name}_{ray_traced.TRUTHS['hexagon']}.exr"
        parts += [_packed(f"{scene.name} pinhole", scene.source.read_bytes())]
        parts += [_packed(f"{scene.name} truth", truth.read_bytes())]
    return text.replace("<!-- data -->", "\n".join(parts))


def _packed(name: str, content: bytes) -> str:
    return f'<script type="text/plain" id="{name}">{base64.b64encode(content).decode("ascii")}</script>'


def _modules() -> bytes:
    """The modules as the page takes them: gzip of JSON, name -> text, each importing others as "bokeh/NAME"."""
    installed = pages.installed(effects.FOLDERS[0])
    files = [*MODULES, *(installed / name for name in LIBRARIES)]
    texts = {file.name: IMPORT.sub(_imported, file.read_text(encoding="utf-8")) for file in files}
    return gzip.compress(json.dumps(texts).encode(), mtime=0)


def _imported(statement: re.Match) -> str:
    name = statement[3]
    return f'{statement[1]} "bokeh/{PACKAGES.get(name, name.rpartition("/")[2])}"'


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
) -> None:
    """A page to try it: methods side by side, focus by a click, lens and aperture by sliders, pictures of your own."""
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
