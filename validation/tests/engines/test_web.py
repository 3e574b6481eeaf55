"""The npm package of integration/web: installed as it stands, through bundlers and types, by the oldest three.js, and
what its classes promise.
"""

import base64
import json
import shutil

import pytest
from support import needed
from support_pages import assert_picture

from bokeh_validation import browser, paths, process
from bokeh_validation.engines import pages

INTEGRATION = paths.ROOT / "integration"
WEB = INTEGRATION / "web"
# Sample -> statements that draw a frame of it, after its imports
ENTRIES = {
    "threejs": """import { renderer, composer } from './webgl.js';
const canvas = renderer.domElement, draw = () => composer.render();""",
    "babylonjs": """import { sample } from './webgl.js';
const canvas = sample.engine.getRenderingCanvas(), draw = () => sample.scene.render();
await sample.scene.whenReadyAsync();""",
    "playcanvas": """import { app } from './sample.js';
const canvas = app.graphicsDevice.canvas, draw = () => { app.renderNextFrame = true; app.tick(performance.now()); };""",
}
# Programs of Node.js that make OUT/main.js of ENTRY
BUNDLERS = {
    "esbuild": """import { build } from 'esbuild';
await build({ entryPoints: ['ENTRY'], bundle: true, minify: true, format: 'esm', outfile: 'OUT/main.js' });""",
    "vite": """import { build } from 'vite';
const lib = { entry: 'ENTRY', formats: ['es'], fileName: () => 'main.js' };
await build({ logLevel: 'warn', build: { outDir: 'OUT', minify: true, lib } });""",
    "webpack": """import webpack from 'webpack';
const output = { path: process.cwd() + '/OUT', filename: 'main.js', module: true };
const [mode, performance, experiments] = ['production', { hints: false }, { outputModule: true }];
webpack({ mode, entry: './ENTRY', output, performance, experiments }, (error, stats) => {
  if (error || stats.hasErrors() || stats.hasWarnings()) throw error ?? new Error(stats.toString());
});""",
}
PAGE = b"""<!doctype html>
<canvas width="640" height="480" data-device="webgl2"></canvas>
<script type="module" src="main.js"></script>"""


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """A folder with the package installed in it, as a user's; what it and the tests need is in the one above."""
    root = tmp_path_factory.mktemp("web")
    with needed("npm"):
        (root / "node_modules").symlink_to(pages.installed(WEB))
        folder = root / "project"
        folder.mkdir()
        (folder / "package.json").write_text('{"type": "module"}')
        pages.call_npm(folder, "install", "--install-links", WEB)
    for name in ENTRIES:
        shutil.copytree(INTEGRATION / name, folder / name, ignore=shutil.ignore_patterns("*.json", "node_modules"))
    return folder


def node(folder, program):
    """What a program in JavaScript prints."""
    return process.run(["node", "--input-type=module", "-e", program], 300.0, folder)


@pytest.mark.parametrize(
    ("bundler", "sample"),
    [*((bundler, "threejs") for bundler in BUNDLERS), ("esbuild", "babylonjs"), ("esbuild", "playcanvas")],
)
def test_bundled(project, tmp_path, bundler, sample):
    """No warning; a page without an import map draws the guide's picture, and the console stays empty.

    Of the shaders there is one language where the engine has one.
    """
    entry, out = f"{sample}/{bundler}.js", f"out-{bundler}-{sample}"
    program = f"{ENTRIES[sample]}\nwindow.bokeh = {{ picture: () => (draw(), canvas.toDataURL()) }};\n"
    (project / entry).write_text(program)
    said = node(project, BUNDLERS[bundler].replace("ENTRY", entry).replace("OUT", out))
    assert "warn" not in said.lower(), said
    text = (project / out / "main.js").read_text(encoding="utf-8")
    assert "vec4 BokehFetchTexel" in text and ("fn BokehFetchTexel" in text) == (sample != "threejs")
    places = [("page.html", PAGE), ("", project / out)]
    with browser.Session("page.html", places, limit=pages.RUN_LIMIT) as session:
        url = session.call("picture")
    drawn = tmp_path / "picture.png"
    drawn.write_bytes(base64.b64decode(url.partition(",")[2]))
    assert_picture(drawn, INTEGRATION / sample / "picture.png")


def test_shaders_are_small():
    """Of one language at most 60 kB."""
    program = """import * as languages from './shaders.js';
console.log(JSON.stringify(Object.values(languages).map((files) => Object.values(files).join('').length)));"""
    assert max(json.loads(node(WEB, program))) <= 60_000
