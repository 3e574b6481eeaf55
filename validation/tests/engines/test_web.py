"""The npm package of integration/web: installed as it stands, through bundlers and types, by the oldest three.js, and
what its classes promise.
"""

import base64
import json
import shutil
from math import inf, nan
from pathlib import Path

import pytest
from support import needed
from support_inputs import inputs
from support_pages import assert_picture

from bokeh_validation import browser, paths, process
from bokeh_validation.engines import pages

pytestmark = inputs(*(f"integration/{name}" for name in ("web", "threejs", "babylonjs", "playcanvas")))

INTEGRATION = paths.ROOT / "integration"
WEB = INTEGRATION / "web"
PAGES = Path(__file__).parent
# Sample -> statements that draw a frame of it, after its imports
ENTRIES = {
    "threejs": """import { renderer, composer } from './webgl.js';
const canvas = renderer.domElement, draw = () => composer.render();""",
    "postprocessing": """import { renderer, composer } from './postprocessing.js';
const canvas = renderer.domElement, draw = () => composer.render();""",
    "react": """import { show } from './react.jsx';
let canvas;
const draw = async (options = {}) => {
  show(options);
  for (let seen, equal = 0; equal < 20; ) {
    await new Promise(requestAnimationFrame);
    canvas = document.querySelector('div canvas');
    const now = canvas?.toDataURL();
    equal = now && now === seen ? equal + 1 : 0;
    seen = now;
  }
};""",
    "babylonjs": """import { sample } from './webgl.js';
const canvas = sample.engine.getRenderingCanvas(), draw = () => sample.scene.render();
await sample.scene.whenReadyAsync();""",
    "playcanvas": """import { app } from './sample.js';
const canvas = app.graphicsDevice.canvas, draw = () => { app.renderNextFrame = true; app.tick(performance.now()); };""",
}
SAMPLES = ("threejs", "babylonjs", "playcanvas")
# Programs of Node.js that make OUT/main.js of ENTRY
BUNDLERS = {
    "esbuild": """import { build } from 'esbuild';
await build({ entryPoints: ['ENTRY'], bundle: true, minify: true, format: 'esm', outfile: 'OUT/main.js',
  jsx: 'automatic', define: { 'process.env.NODE_ENV': '"production"' } });""",
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
# A warning counts as an error does
PAGE = b"""<!doctype html>
<script>console.warn = console.error;</script>
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
        commands = (WEB / "README.md").read_text(encoding="utf-8").split("```")[1].splitlines()[1:]
        for line in [*commands, "npm install"]:  # the last must not make a link of the copy
            pages.call_npm(folder, *(WEB if "PATH" in word else word for word in line.split()[1:]))
    for name in SAMPLES:
        shutil.copytree(INTEGRATION / name, folder / name, ignore=shutil.ignore_patterns("*.json", "node_modules"))
    return folder


def node(folder, program):
    """What a program in JavaScript prints."""
    return process.run(["node", "--input-type=module", "-e", program], 300.0, folder)


@pytest.mark.parametrize(
    ("bundler", "sample"),
    [
        *((bundler, "threejs") for bundler in BUNDLERS),
        *(("esbuild", sample) for sample in ENTRIES if sample != "threejs"),
    ],
)
def test_bundled(project, tmp_path, bundler, sample):
    """No warning; a page without an import map draws the guide's picture, and the console stays empty.

    Of the shaders there is one language where the engine has one.
    """
    engine = sample if sample in SAMPLES else "threejs"
    entry, out = f"{engine}/{bundler}-{sample}.js", f"out-{bundler}-{sample}"
    picture = "async (options) => { await draw(options); return canvas.toDataURL(); }"
    program = f"{ENTRIES[sample]}\nwindow.bokeh = {{ picture: {picture} }};\n"
    (project / entry).write_text(program)
    said = node(project, BUNDLERS[bundler].replace("ENTRY", entry).replace("OUT", out))
    assert "warn" not in said.lower(), said
    text = (project / out / "main.js").read_text(encoding="utf-8")
    assert "vec4 BokehFetchTexel" in text and ("fn BokehFetchTexel" in text) == (engine != "threejs")
    # react-three-fiber uses what three.js warns of
    page = PAGE.replace(b"console.warn", b"window.warn") if sample == "react" else PAGE
    places = [("page.html", page), ("", project / out)]
    with browser.Session("page.html", places, limit=pages.RUN_LIMIT) as session:
        url = session.call("picture")
        if sample == "react":  # its properties change
            other = session.call("picture", {"sides": 4, "method": "exact"})
            assert url != other and session.call("picture", {}) == url
    drawn = tmp_path / "picture.png"
    drawn.write_bytes(base64.b64decode(url.partition(",")[2]))
    assert_picture(drawn, INTEGRATION / engine / "picture.png")


def test_copied(project):
    """The folder copied into a project, and linked there by npm: it finds the project's three.js."""
    folder = project.parent / "copied"
    shutil.copytree(WEB, folder / "web", ignore=shutil.ignore_patterns("node_modules"))
    (folder / "package.json").write_text("{}")
    pages.call_npm(folder, "install", "./web")
    (folder / "entry.js").write_text("export * from 'polygonal-bokeh/three';")
    node(folder, BUNDLERS["esbuild"].replace("ENTRY", "entry.js").replace("OUT", "out"))


def test_types(project):
    """Strict, without a word about the package or its user; what no option may be is an error."""
    shutil.copy(PAGES / "web_types.ts", project)
    tsc = "../node_modules/.bin/tsc --strict --noEmit --target esnext --module esnext --moduleResolution bundler"
    # the engines' own types have errors; the last word shows that it came to an end
    said = process.run(
        ["sh", "-c", f"{tsc} web_types.ts; {tsc} --skipLibCheck web_types.ts && echo right"], 300.0, project
    )
    ours = [line for line in said.splitlines() if "polygonal-bokeh" in line or "web_types" in line]
    assert not ours and said.splitlines()[-1] == "right", "\n".join(ours)


def test_shaders_are_small():
    """Of one language at most 60 kB."""
    program = """import * as languages from './shaders.js';
console.log(JSON.stringify(Object.values(languages).map((files) => Object.values(files).join('').length)));"""
    assert max(json.loads(node(WEB, program))) <= 60_000


# ---- what the classes for three.js promise ----


MAP = """<!doctype html><script type="importmap">{ "imports": { "polygonal-bokeh/": "/integration/web/",
"polygonal-bokeh/three": "/integration/web/three.js",
"polygonal-bokeh/three-webgpu": "/integration/web/three-webgpu.js",
"three": "/MODULES/THREE/build/three.NAME.js", "three/addons/": "/MODULES/THREE/examples/jsm/",
"three/webgpu": "/MODULES/THREE/build/three.webgpu.js", "three/tsl": "/MODULES/THREE/build/three.tsl.js" } }
</script><script type="module" src="PAGE"></script>"""


def opened(version, script, flags=()):
    """A page of this folder, with a three.js of the package's node_modules."""
    with needed("npm"):
        modules = pages.installed(WEB)
    name = "webgpu" if flags else "module"
    text = MAP.replace("THREE", version).replace("NAME", name).replace("PAGE", script).encode()
    places = [("page.html", text), ("MODULES/", modules), ("integration/", INTEGRATION), ("", PAGES)]
    with needed("chromium"):
        return browser.Session("page.html", places, flags=flags, limit=pages.RUN_LIMIT)


@pytest.fixture(scope="module", params=["three", "three-oldest"])
def webgl(request):
    """The page for WebGLRenderer, of the newest and the oldest three.js."""
    with opened(request.param, "web_page.js") as page:
        yield page


@pytest.fixture(scope="module", params=["three", "three-oldest"])
def webgpu(request):
    """The page for WebGPURenderer, likewise."""
    with opened(request.param, "web_page_webgpu.js", pages.CANVAS) as page:
        yield page


REFUSED = [
    ({"preset": "high"}, 'preset is "high". Give "MEDIUM", "LOW", "HIGH", "ULTRA"'),
    ({"sides": 5}, "sides is 5. Give 6, 4, 8, 10"),
    ({"sides": 12}, "sides is 12. Give 6, 4, 8, 10"),
    ({"method": "foo"}, 'method is "foo". Give "layered", "exact", "paper"'),
    ({"method": "paper", "sides": 4}, "paper has no 4 sides. Give 6, 8"),
    ({"side": 6}, 'there is no option side. Give "method", "sides"'),
    ({"opaque": 1}, "opaque is 1. Give true, false"),
    ({"extras": "jitter"}, 'extras is "jitter", not a list. Give "jitter", "catsEye"'),
    ({"extras": ["cats"]}, 'extras is "cats". Give "jitter", "catsEye"'),
]


def test_options_are_checked(webgl):
    """What no option can be is told in one line, with what it can be."""
    for options, said in REFUSED:
        assert f"polygonal-bokeh, PolygonBokehPass: {said}" in webgl.call("refused", options), options
    assert "f-stop of 0" in webgl.call("stops")


def test_depth(webgl):
    """Without depth: nothing blurred, and said so once. Empty: said so. Right: not a word. A pass between: depthOf."""
    found = webgl.call("warned")
    assert [len(found[name]["said"]) for name in ("none", "empty", "right")] == [1, 1, 0], found
    assert "no depth" in found["none"]["said"][0] and "depth is empty" in found["empty"]["said"][0]
    assert found["none"]["off"] == 0 < found["right"]["off"]
    assert webgl.call("between") == [0, 0]


def test_focus(webgl):
    """Of a nested object, from a camera in a scaled rig: the depth that is drawn."""
    found = webgl.call("focus")
    assert found["focus"] == pytest.approx(found["drawn"], rel=1e-4) == found["place"]
    oldest = int(webgl.call("revision")) < 180
    assert found["focus"] == pytest.approx(50.0 if oldest else 5.0, rel=1e-4)


def test_pull(webgl):
    """It recovers from a NaN and a 0, and takes no step to what is no depth."""
    cases = [
        (nan, 0.1, [4]),
        (0, 0.1, [4]),
        (-1, 0.1, [4]),
        (inf, inf, [4]),
        (2, inf, [nan, 3, 0, -1]),
        (2, 0.1, []),
        (2, nan, [4]),
    ]
    assert webgl.call("pulls", cases) == [4, 4, 4, 4, 3, 2, 2]
    assert webgl.call("pulls", [(2, inf, [inf])]) == [inf]


CHANGES = [{"preset": "LOW"}, {"sides": 8}, {"method": "exact"}, {"extras": ["lateral"]}]


@pytest.mark.parametrize("change", CHANGES, ids=str)
def test_change(webgl, change):
    """As from the beginning, no shader is compiled by the frame that follows, and nothing is left of the old ones."""
    assert webgl.call("changed", change) == {"off": 0, "added": 0, "leaked": 0}


def test_changes_race(webgl):
    """The last change counts; a refused one rejects, and changes nothing."""
    found = webgl.call("raced")
    assert (found["sides"], found["preset"]) == (4, "MEDIUM") and 'preset is "low"' in found["error"]


def test_camera(webgl):
    """Another camera, of another kind."""
    assert webgl.call("camera") == 0


EXTRAS = [
    ("jitter", {"jitter": 0}, {"jitter": 1}, {"method": "exact", "preset": "LOW"}),
    ("catsEye", {"catsEye": 0}, {"catsEye": 0.8}, {}),
    ("catsEye", {"catsEye": 0, "roundness": 1}, {"catsEye": 0, "roundness": 0}, {"sides": 8}),
    ("lateral", {"lateral": 0}, {"lateral": 0.02}, {}),
    ("focusRange", {}, {"frontRange": 1, "backRange": 8}, {}),
    ("focusRange", {}, {"nearScale": 0}, {}),
]


@pytest.mark.parametrize("extra", EXTRAS, ids=str)
def test_extras(webgl, extra):
    """Each acts, and at its neutral value changes nothing but by rounding of half floats."""
    neutral, acting = webgl.call("extra", extra)
    assert neutral < 0.005 < acting


def test_memory(webgl):
    """Of exact: map and two targets, RGBA16F; the result is the composer's."""
    assert webgl.call("memory") == {"bytes": 3 * 8 * 96 * 64, "passes": 3}


@pytest.mark.parametrize("method", ["exact", "layered"])
def test_alpha(webgl, method):
    """Over the page's colour as if that had been in the scene: alpha is blurred as colour is."""
    assert_alpha(webgl.call("alpha", {"method": method}))


def assert_alpha(found):
    """What `alpha` found."""
    assert found["shares"] == pytest.approx([0, 1], abs=1e-3) and found["inside"] > 300
    assert found["off"] < 0.01, found


def test_glass(webgl):
    """Drawn sharp over the picture, and not where the subject is before it; scene and camera are as they were."""
    assert_glass(webgl.call("glass"))


def assert_glass(said):
    """What `glass` found: the first picture without it, the last one with it."""
    for name in ("behind", "beside"):
        assert said["found"][name][0] == said["found"][name][-1], name
    before, *_, after = said["found"]["glass"]
    assert after == pytest.approx([0.5 * before[0], 0.5 * before[1] + 0.5, 0.5 * before[2]], abs=2e-3)
    assert said["background"] and said["mask"] == 1


def test_multisampled(webgl):
    """Four samples a pixel: the subject as sharp, and as much light."""
    found = webgl.call("samples")
    assert found["middle"] < 0.002 and found["kept"][0] == pytest.approx(found["kept"][1], abs=0.01)


def test_node_says_errors(webgpu):
    """To the caller, which three.js only logs: options, WebGL 2, a logarithmic depth buffer."""
    assert 'PolygonBokehNode: preset is "high"' in webgpu.call("refused", {"preset": "high"})
    without_webgpu, logarithmic = webgpu.call("errors")
    assert "needs WebGPU" in without_webgpu and "cannot read logarithmicDepthBuffer" in logarithmic


@pytest.mark.parametrize("change", CHANGES, ids=str)
def test_node_changes(webgpu, change):
    """As from the beginning, and the frame that follows makes no pipeline."""
    found = webgpu.call("changed", change)
    assert found["off"] == found["added"] == 0 < found["acts"], found


def test_node_camera(webgpu):
    """It follows the camera of its scene's pass."""
    assert webgpu.call("camera") == {"off": 0, "kind": 5, "far": 40}


@pytest.mark.parametrize("extra", EXTRAS, ids=str)
def test_node_extras(webgpu, extra):
    """As of the pass."""
    neutral, acting = webgpu.call("extra", extra)
    assert neutral < 0.005 < acting


@pytest.mark.parametrize("method", ["exact", "layered"])
def test_node_alpha(webgpu, method):
    """As of the pass."""
    assert_alpha(webgpu.call("alpha", {"method": method}))


def test_node_memory(webgpu):
    """Of exact: map, two targets and the result."""
    assert webgpu.call("memory") == {"bytes": 4 * 8 * 96 * 64, "passes": 3}


def test_node_glass(webgpu):
    """As SharpPass, by the option sharpLayer; from the second frame on, since three.js makes the shared target anew."""
    assert_glass(webgpu.call("glass"))


def test_node_multisampled(webgpu):
    """As of the pass: a scene without highlights, whose light edges do not change."""
    found = webgpu.call("samples")
    assert found["middle"] < 0.002 and found["light"] == pytest.approx(1, abs=0.02)
