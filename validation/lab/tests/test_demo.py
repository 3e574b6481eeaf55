"""Test validation/run demo with the page from disk.

Node.js operates its controls (integration/demo/test) and leaves what it drew; here that is compared with the
reference, the driver, and the page of `validation/run peers`.
"""

import json
import re
import tempfile
import threading
import urllib.request
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from PIL import Image
from support import called, load, needed, refused
from support_inputs import inputs
from support_node import assert_passes, files

from bokeh_validation import metrics, paths, pictures
from bokeh_validation.drivers.base import STORAGE, Driver
from bokeh_validation.frame import methods
from bokeh_validation.probes.model import Case
from bokeh_validation.reference import pass_images
from bokeh_validation.truth import ray_traced
from engines import pages
from lab import demo
from lab.other_effects import effects

CAMERA = methods.Camera(0.2, 0.06, 4.0, 0.024, 0.15)
# the same lens in the page's controls
LENS = {"stop": 0.3, "scale": 1.0, "focal": 0.06, "focus": 4.0, "squeeze": 0.6, "rotation": 17.0}
METHODS = [
    ("paper", "square"), ("exact", "hexagon"), ("exact", "decagon"), ("layered", "octagon"), ("layered", "hexagon"),
]  # fmt: skip
GREY = np.linspace(0, 255, 40).astype(np.uint8)[None].repeat(24, 0)
COMPRESSIONS = {"none": OpenEXR.NO_COMPRESSION, "piz": OpenEXR.PIZ_COMPRESSION}

pytestmark = [
    pytest.mark.timeout(1500),
    inputs(
        *(f"integration/demo/{name}" for name in ("index.html", "package-lock.json", "src", "test", "vite.config.js")),
        "validation/lab/demo.py", "validation/lab/other_effects", "validation/scenes",
        "validation/lab/tests/test_demo.py", "integration/web/test/chromium.js",
        of_code=True,
    ),
]  # fmt: skip


def settings_of(method: str, aperture: str) -> methods.Settings:
    """Return the settings that the page should draw with LENS."""
    name = f"{method} {aperture}" + ("" if method == "paper" else " low")
    return replace(demo.settings()[name], camera=CAMERA, rotation=17.0, squeeze=0.6)


def own_pixels() -> tuple[np.ndarray, np.ndarray]:
    """Return every sixth pixel of market_7: color and depth."""
    scene = ray_traced.picture(ray_traced.MARKET)
    return tuple(np.ascontiguousarray(pixels[::6, ::6]) for pixels in (scene.color, scene.depth))


def own(depth=True, compression=OpenEXR.ZIP_COMPRESSION, kind=np.float16) -> bytes:
    """Return the same image as a user's EXR file."""
    color, z = own_pixels()
    channels = {name: np.ascontiguousarray(color[..., i].astype(kind)) for i, name in enumerate("RGB")}
    with tempfile.NamedTemporaryFile(suffix=".exr") as target:
        header = {"compression": compression, "type": OpenEXR.scanlineimage}
        with OpenEXR.File(header, channels | ({"Z": z} if depth else {})) as written:
            written.write(target.name)
        return Path(target.name).read_bytes()


def write_given(folder: Path) -> None:
    """Write the files that the page is given, and cases.json: what to draw of them and which images to leave."""
    (folder / "own.exr").write_bytes(own())
    (folder / "color.exr").write_bytes(own(depth=False))
    (folder / "two types.exr").write_bytes(own(compression=OpenEXR.PIZ_COMPRESSION))
    for name, compression in COMPRESSIONS.items():
        (folder / f"{name}.EXR").write_bytes(own(compression=compression, kind=np.float32))
    Image.fromarray(GREY).save(folder / "a depth.png")
    Image.fromarray(np.dstack([GREY, GREY[:, ::-1], GREY])).save(folder / "a.png")
    demo.shown_depth(ray_traced.MARKET).astype(np.float32).tofile(folder / "market_7 depth.f32")
    cases = []
    for method, aperture in METHODS:
        passes = methods.plan(settings_of(method, aperture), demo.SIZE).passes
        controls = {"left": "input", "right": method, "blades": methods.EXACT[aperture], "preset": "low"}
        keep = {"right": list(dict.fromkeys(name for render_pass in passes for name in render_pass.outputs))}
        cases.append([f"{method} {aperture}", ["own.exr"], controls, LENS, keep])
    controls, keep = {"left": "input", "right": "exact"}, {"left": ["color", "depth"]}
    cases.append(["a picture", ["a depth.png", "a.png"], controls, {}, keep])
    cases += [[f"EXR {name}", [f"{name}.EXR"], controls, {}, keep] for name in COMPRESSIONS]
    names = ("label", "files", "controls", "exactly", "keep")
    (folder / "cases.json").write_text(json.dumps([dict(zip(names, case, strict=True)) for case in cases]))


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """Return a folder, with a space in its name, that has page.html and site/ as written by --output, and given/ and
    drawn/.
    """
    made = tmp_path_factory.mktemp("a page")
    with needed("npm"):
        pages.check_node()
        pages.installed(demo.PROJECT)
    for name in ("page.html", "site"):
        done = called("demo", "--output", made / name)
        assert done.returncode == 0, done.stderr
    for name in ("given", "drawn"):
        (made / name).mkdir()
    write_given(made / "given")
    return made


@pytest.fixture(scope="module")
def worked(folder, tmp_path_factory) -> Path:
    """Return that folder after Node.js has operated the page."""
    project = demo.copied(tmp_path_factory.mktemp("repository") / "copy")
    (tests,) = files(demo.PROJECT)
    assert_passes(project, tests, {"BOKEH_PAGE": str(folder)})
    return folder


def test_links():
    """Check that the page links into the repository if its address is known, and that each link leads to an existing
    file.
    """
    assert demo.links("") == []
    found = demo.links("git+https://example.com/owner/name.git")
    assert found[0] == ("source", "https://example.com/owner/name")
    for _, address in found[1:]:
        page, _, file = address.partition("/blob/main/")
        assert page == "https://example.com/owner/name" and (paths.ROOT / file).is_file(), address


def test_page_by_hand(worked):
    """Run every test of integration/demo/test; the single file must be at most 12 MB."""
    assert (worked / "page.html").stat().st_size < 12e6
    # the page is self-contained: only its own markup could refer to an address
    markup = re.sub(r"<(script|style)\b.*?</\1>", "", (worked / "page.html").read_text(encoding="utf-8"), flags=re.S)
    assert re.findall(r'(?:src|href)="(?!data:)', markup) == []


class Drawn(Driver):
    """Provide what one side of the page showed as a driver, as if it had the settings of the page's controls."""

    name, software = "the page", False

    def __init__(self, folder: Path, label: str):
        self.folder, self.label, device = folder, label, load("webgl2")
        self.adapter, self.rounding = device.adapter, device.rounding

    def run(self, passes, textures, size, storage="half", keep=("result",)):
        """Return what the page drew; the passes that it should have drawn determine the sizes."""
        scales = {name: render_pass.scale for render_pass in passes for name in render_pass.outputs}
        found = {}
        for name in keep:
            width, height = (-(-side // scales.get(name, 1)) for side in size)
            pixels = np.fromfile(self.folder / "drawn" / f"{self.label} {name}.f32", np.float32)
            found[name] = pixels.reshape(height, width, 4).astype(STORAGE[storage])
        return found

    def pictures(self, size: tuple[int, int], *names: str) -> list[np.ndarray]:
        """Return images by their names, in the size of the scene."""
        return list(self.run((), {}, size, keep=names).values())


@pytest.mark.parametrize(("method", "aperture"), METHODS)
def test_shows_the_reference(worked, method, aperture):
    """Check a user's image, blurred by the controls: every pixel must be within the reference's interval.

    Each pass is judged on the page's own inputs, since the page draws only whole frames. The bounds in steps do not
    apply, because of SwiftShader's sine (drivers/base.py).
    """
    color, depth = own_pixels()
    case, page = Case("own", settings_of(method, aperture), color, depth), Drawn(worked, f"{method} {aperture}")
    passes, textures = case.plan.passes, case.textures()
    names = [name for render_pass in passes for name in render_pass.outputs]
    drawn = page.run(passes, textures, case.size, keep=names)
    expected = pass_images.images(passes, textures, case.size, "half", page.precision, page.rounding, given=drawn)
    outside = {name: metrics.compare(drawn[name], expected[name], False).outside for name in names}
    assert not any(outside.values()), outside
    assert abs(drawn["result"].astype(float) - color)[..., :3].max() > 1.0


def test_scene(worked):
    """Check market_7 in full: layered is bit-identical to the driver, the lens's image is shown, and the canvas shows
    both.
    """
    case = ray_traced.scene_case(ray_traced.MARKET, "layered", "hexagon")
    # the page's depth has 16 bits
    case = replace(case, depth=demo.shown_depth(ray_traced.MARKET).astype(np.float32))
    expected = load("webgl2").run(case.plan.passes, case.textures(), case.size)["result"]
    result, lens, color = Drawn(worked, "market_7").pictures(case.size, "result", "truth", "color")
    np.testing.assert_array_equal(result, expected)
    truth = ray_traced.truth(ray_traced.MARKET, "hexagon")
    for shown, image in ((lens, truth), (color, case.color)):
        np.testing.assert_array_equal(shown[..., :3], image[..., :3])
    canvas = np.fromfile(worked / "drawn" / "market_7 canvas.u8", np.uint8).reshape(540, 960, 4)
    left, right = (pictures.filmic(image, demo.EXPOSURE["market_7"]) for image in (truth, expected))
    # within a step, since the page computes in float32
    assert np.abs(canvas[..., :3].astype(int) - np.hstack([left[:, :480], right[:, 480:]])).max() <= 1


@pytest.fixture(scope="module")
def beside():
    """Open market_7 on the page of validation/run peers."""
    picture = ray_traced.picture(ray_traced.MARKET)
    with effects.Page(list(demo.OTHERS)) as opened:
        depth = demo.shown_depth(ray_traced.MARKET).astype(np.float32)
        opened.load(picture.color, depth, ray_traced.MARKET.camera)
        yield opened


@pytest.mark.parametrize("name", demo.OTHERS)
def test_others(worked, beside, name):
    """Check that another library's depth of field, with the scene's lens, equals that of `validation/run peers`."""
    expected = beside.draw(name, effects.FOUND["market_7"][name])
    (shown,) = Drawn(worked, "market_7").pictures((960, 540), name)
    np.testing.assert_allclose(shown[..., :3], expected[..., :3], rtol=2e-3, atol=2e-3)


def test_one_version_of_the_others():
    """Check that the page has the package versions that its titles name, which `validation/run peers` uses."""
    pins = [json.loads((where / "package.json").read_bytes()) for where in (demo.PROJECT, effects.FOLDERS[0])]
    assert pins[0]["dependencies"] == pins[1]["dependencies"]


def test_own_pictures(worked):
    """Check an image with its depth.png, and EXR with floats and other compression. integration/demo/test has
    refusals.
    """
    shown, metres = Drawn(worked, "a picture").pictures((40, 24), "color", "depth")
    linear = np.where(GREY <= 10.3, GREY / 255 / 12.92, ((GREY / 255 + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(shown[..., 0], linear, atol=1e-3)
    np.testing.assert_allclose(metres[..., 0], 1 / (0.01 + 0.99 * GREY / 255), rtol=1e-3)
    half, z = own_pixels()
    for name in COMPRESSIONS:
        shown, metres = Drawn(worked, f"EXR {name}").pictures((160, 90), "color", "depth")
        np.testing.assert_array_equal(shown[..., :3], half[..., :3])
        np.testing.assert_array_equal(metres[..., 0], z.astype(np.float16))


def test_served(folder):
    """Check the page over HTTP, served to this machine only; a port in use is refused in one line."""
    with demo.server(0) as serving:
        threading.Thread(target=serving.serve_forever, daemon=True).start()
        host, port = serving.server_address
        assert host == "127.0.0.1"
        with urllib.request.urlopen(f"http://{host}:{port}/") as answer:
            assert answer.read() == (folder / "site/index.html").read_bytes()
        refused(called("demo", "--port", port), [f"--port {port}", "cannot be used"])
        serving.shutdown()
