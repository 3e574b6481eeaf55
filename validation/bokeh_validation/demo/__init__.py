"""A page to try the methods on, live, in a browser: the work behind `validation/run demo`.

One HTML file with everything in it. Its passes are those of methods.plan as data; it draws them with the code of the
browser drivers (browser/page).
"""

import base64
import json
import re
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Annotated

import typer

from bokeh_validation import browser, files, paths, shaders, terminal, truth
from bokeh_validation.demo import others
from bokeh_validation.errors import UserError
from bokeh_validation.frame import fetches, methods
from bokeh_validation.shaders.entries import EXACT
from bokeh_validation.shaders.passes import PARAMETERS, SAMPLE_TYPES, Pass, is_linear
from bokeh_validation.truth import ray_traced
from bokeh_validation.truth.peers import effects

PAGE = Path(__file__).parent / "page"
SHARED = (*(browser.PAGE / name for name in ("job.js", "webgl2.js", "webgpu.js")), effects.PAGE / "lens.js")
MODULES = (*SHARED, *sorted(PAGE.glob("*.js")))
IMPORT = re.compile(r'(from|import) "[./\w]*?(\w+\.js)"')

SCENES = (ray_traced.MARKET, ray_traced.STREET, ray_traced.CANOPY)
PRESETS = tuple(methods.PRESETS)
# what the page's controls set; the size does not matter, the page puts in its own
SIZE = (960, 540)
HOST = "127.0.0.1"


def settings() -> dict[str, methods.Settings]:
    """'method aperture preset' -> settings of every frame that the page can draw; paper has no preset."""
    of_exact = shaders.presets(paths.library("glsl").read_text(encoding="ascii"))
    found = {f"paper {aperture}": methods.Settings("paper", aperture) for aperture in EXACT}
    for aperture in EXACT:
        for preset in PRESETS:
            chosen = of_exact[preset.upper()]
            found[f"exact {aperture} {preset}"] = methods.Settings(
                "exact",
                aperture,
                spacing=float(chosen["BOKEH_PRESET_SPACING"]),
                samples=int(chosen["BOKEH_PRESET_SAMPLES"]),
            )
            found[f"layered {aperture} {preset}"] = methods.Settings("layered", aperture, preset=preset)
    return found


def data() -> dict:
    """What page/main.js works on, ready for JSON."""
    glsl = shaders.text("glsl")
    plans = {name: _plan(one, glsl) for name, one in settings().items()}
    return {
        "plans": plans,
        "parameters": PARAMETERS,
        "apertures": {sides: aperture for aperture, sides in EXACT.items()},
        "presets": PRESETS,
        "glsl": glsl,
        "wgsl": shaders.wgsl(),
        "slots": SAMPLE_TYPES,
        "vertex": shaders.glsl("BokehFullScreen", "300es"),
        "sensor": ray_traced.MARKET.camera.sensor_height,
        "maxCoC": ray_traced.MARKET.camera.max_coc,
        "others": others.listed(),
        "scenes": [_scene(scene) for scene in SCENES],
    }


def _plan(one: methods.Settings, glsl: str) -> dict:
    """Passes, and what they fetch a pixel at most: [number, more for each tile that passes over tiles look along]."""
    near, far = (methods.plan(one, size).passes for size in (SIZE, (2 * SIZE[0], 2 * SIZE[1])))
    counts = [fetches.of_frame(passes)["color"] for passes in (near, far)]
    tiles = [fetches.tiles_along(passes[-1]) for passes in (near, far)]
    more = (counts[1] - counts[0]) / (tiles[1] - tiles[0])
    return {"passes": [_pass(item, glsl) for item in near], "fetches": [counts[0] - more * tiles[0], more]}


def _pass(item: Pass, glsl: str) -> dict:
    return {
        "entry": item.entry + "_PS",
        "constants": item.constants,
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
        "exposure": truth.EXPOSURE.get(scene.name, 1.0),
        "rotation": ray_traced.TRUTH_ROTATION["hexagon"],
    }


def page() -> str:
    """The whole file."""
    text = (PAGE / "index.html").read_text(encoding="utf-8")
    imports = {f"bokeh/{file.name}": _module(file) for file in MODULES}
    parts = [f'<script type="importmap">{json.dumps({"imports": imports})}</script>']
    # in a text of JSON "</" would end the element
    text_of_data = json.dumps(data()).replace("</", "<\\/")
    parts.append(f'<script type="application/json" id="data">{text_of_data}</script>')
    if others.listed():
        parts.append(f'<script type="text/plain" id="others">{others.packed()}</script>')
    for scene in SCENES:
        truth = paths.SCENES / f"{scene.name}_{ray_traced.TRUTHS['hexagon']}.exr"
        for kind, file in (("pinhole", scene.source), ("truth", truth)):
            packed = base64.b64encode(file.read_bytes()).decode("ascii")
            parts.append(f'<script type="text/plain" id="{scene.name} {kind}">{packed}</script>')
    return text.replace("<!-- data -->", "\n".join(parts))


def _module(file: Path) -> str:
    """A module as an address that needs no file; others are imported by the names of the page's import map."""
    text = IMPORT.sub(r'\1 "bokeh/\2"', file.read_text(encoding="utf-8"))
    return f"data:text/javascript;base64,{base64.b64encode(text.encode()).decode('ascii')}"


class _Answer(BaseHTTPRequestHandler):
    def __init__(self, body: bytes, *arguments):
        self.body = body
        super().__init__(*arguments)

    def do_GET(self):
        """The page, under one name."""
        found = self.path.split("?")[0] == "/"
        self.send_response(200 if found else 404)
        self.send_header("Content-Type", "text/html; charset=utf-8")
        self.send_header("Content-Length", str(len(self.body) if found else 0))
        self.end_headers()
        if found:
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
