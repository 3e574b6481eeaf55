"""A page to try the methods on, live, in a browser: the work behind `validation/run demo`.

One HTML file with everything in it. Its passes are those of methods.plan as data; it draws them with the code of the
browser drivers (browser/page).
"""

import base64
import gzip
import json
import re
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Annotated

import typer

from bokeh_validation import browser, files, paths, shaders, terminal
from bokeh_validation.errors import UserError
from bokeh_validation.frame import fetches, methods
from bokeh_validation.shaders.entries import EXACT
from bokeh_validation.shaders.passes import PARAMETERS, Pass, is_linear
from bokeh_validation.truth import EXPOSURE, ray_traced
from bokeh_validation.truth.peers import effects
from bokeh_validation.truth.peers.effects import EFFECTS

PAGE = Path(__file__).parent / "page"
MODULES = (
    *(browser.PAGE / name for name in ("job.js", "webgl2.js")),
    *(effects.PAGE / name for name in ("feed.js", "lens.js", "three_webgl.js")),
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
# Parameters of the other libraries' effects: times what their documentation asks for, best for market_7; other options
OTHERS = {
    "BokehPass": ({"aperture": 1.12, "maxblur": 0.7}, {}),
    "DepthOfFieldEffect": ({"focusRange": 0.5, "bokehScale": 0.35}, {"resolutionScale": 0.5}),
}

SCENES = (ray_traced.MARKET, ray_traced.STREET, ray_traced.CANOPY)
PRESETS = tuple(methods.PRESETS)
# what the page's controls set; the size does not matter, the page puts in its own
SIZE = (960, 540)
HOST = "127.0.0.1"


def settings() -> dict[str, methods.Settings]:
    """'method aperture preset' -> settings of every frame that the page can draw; paper has no preset."""
    of_exact = shaders.presets(paths.library("glsl").read_text(encoding="ascii"))
    frames = {f"paper {aperture}": methods.Settings("paper", aperture) for aperture in EXACT}
    for aperture in EXACT:
        for preset in PRESETS:
            chosen = of_exact[preset.upper()]
            spacing, samples = float(chosen["BOKEH_PRESET_SPACING"]), int(chosen["BOKEH_PRESET_SAMPLES"])
            exact = methods.Settings("exact", aperture, spacing=spacing, samples=samples)
            frames[f"exact {aperture} {preset}"] = exact
            frames[f"layered {aperture} {preset}"] = methods.Settings("layered", aperture, preset=preset)
    return frames


def data() -> dict:
    """What page/main.js works on, ready for JSON. Raises Unavailable where npm is missing."""
    glsl = shaders.text("glsl")
    versions = effects.versions([effects.installed()], OTHERS)
    return {
        "plans": {name: _plan(chosen, glsl) for name, chosen in settings().items()},
        "parameters": PARAMETERS,
        "apertures": {sides: aperture for aperture, sides in EXACT.items()},
        "presets": PRESETS,
        "glsl": glsl,
        "vertex": shaders.glsl("BokehFullScreen", "300es"),
        "sensor": ray_traced.MARKET.camera.sensor_height,
        "maxCoC": ray_traced.MARKET.camera.max_coc,
        "others": {
            name: {
                "title": EFFECTS[name].title,
                "version": versions[EFFECTS[name].package],
                "factors": factors,
                "options": options,
            }
            for name, (factors, options) in OTHERS.items()
        },
        "scenes": [_scene(scene) for scene in SCENES],
    }


def _plan(chosen: methods.Settings, glsl: str) -> dict:
    """Passes, and what they fetch a pixel at most: [number, more for each tile that passes over tiles look along]."""
    small, large = (methods.plan(chosen, size).passes for size in (SIZE, (2 * SIZE[0], 2 * SIZE[1])))
    counts = [fetches.of_frame(passes)["color"] for passes in (small, large)]
    tiles = [fetches.tiles_along(passes[-1]) for passes in (small, large)]
    more = (counts[1] - counts[0]) / (tiles[1] - tiles[0])
    return {"passes": [_pass(item, glsl) for item in small], "fetches": [counts[0] - more * tiles[0], more]}


def _pass(item: Pass, glsl: str) -> dict:
    return {
        "head": shaders.glsl(item.entry, "300es", item.constants).removesuffix(glsl),
        "inputs": [[slot, name, is_linear(item.entry, slot)] for slot, name in item.inputs.items()],
        "targets": item.outputs,
        "scale": item.scale,
        "values": dict(item.parameters),
    }


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
    files = [*MODULES, *(effects.installed() / name for name in LIBRARIES)]
    texts = {file.name: IMPORT.sub(_imported, file.read_text(encoding="utf-8")) for file in files}
    return gzip.compress(json.dumps(texts).encode(), mtime=0)


def _imported(statement: re.Match) -> str:
    name = statement[3]
    return f'{statement[1]} "bokeh/{PACKAGES.get(name, name.rpartition("/")[2])}"'


class _Answer(BaseHTTPRequestHandler):
    def __init__(self, body: bytes, *arguments):
        self.body = body
        super().__init__(*arguments)

    def do_GET(self):
        """The page, under one name."""
        known = self.path.split("?")[0] == "/"
        self.send_response(200 if known else 404)
        self.send_header("Content-Type", "text/html; charset=utf-8")
        self.send_header("Content-Length", str(len(self.body) if known else 0))
        self.end_headers()
        if known:
            self.wfile.write(self.body)

    def log_message(self, *_):
        """Nothing."""


def server(port: int) -> ThreadingHTTPServer:
    """What serves the page to this machine alone; port 0 takes a free one. Raises UserError."""
    body = page().encode()
    try:
        return ThreadingHTTPServer((HOST, port), partial(_Answer, body))
    except (OSError, OverflowError) as error:
        raise UserError(f"--port {port}: cannot be used ({error}). Give another, or 0 for any.") from error


def demo(
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE.html", help="Write the page, and do not serve it.")
    ] = None,
    port: Annotated[int, typer.Option(help="To serve it on; 0: any that is free.")] = 8015,
) -> None:
    """A page to try it: methods side by side, focus by a click, lens and aperture by sliders, own pictures."""
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
