"""validation/run demo: the page from disk in headless Chromium, worked by its controls, against the reference."""

import base64
import re
import tempfile
import threading
import urllib.request
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from PIL import Image
from support import called, load, needed, refused
from support_inputs import inputs

from bokeh_validation import browser, demo, pictures
from bokeh_validation.drivers.base import Driver
from bokeh_validation.drivers.web import unpacked
from bokeh_validation.engines import pages
from bokeh_validation.frame import methods
from bokeh_validation.probes.judges import compared
from bokeh_validation.probes.model import Case
from bokeh_validation.truth import ray_traced
from lab.other_effects import effects

pytestmark = inputs(
    "integration/web", "validation/bokeh_validation/demo", "validation/lab/other_effects", "validation/scenes",
    "validation/tests/harness/test_demo.py", "validation/tests/harness/demo_page.js",
)  # fmt: skip

SCRIPT = Path(__file__).with_name("demo_page.js").read_text(encoding="utf-8")
LENS = {"stop": 0.3, "focal": 0.06, "focus": 4.0}
CAMERA = methods.Camera(0.2, 0.06, 4.0, 0.024, 0.15)


@pytest.fixture(scope="module")
def file(tmp_path_factory) -> Path:
    """What --output writes, in a folder whose name has a space in it: nothing is outside of it."""
    path = tmp_path_factory.mktemp("a page") / "demo.html"
    with needed("npm"):
        pages.installed(effects.FOLDERS[0])
    done = called("demo", "--output", path)
    assert done.returncode == 0, done.stderr
    text = path.read_text(encoding="utf-8")
    assert len(text) < 12e6 and re.findall(r'(?:src|href)="(?!data:)', text) == []
    return path


@pytest.fixture(scope="module")
def page(file):
    """It, opened from disk."""
    with needed("Chromium"):
        opened = browser.Session(file.as_uri(), script=SCRIPT)
    with opened:
        opened.call("ready")
        yield opened


def own(depth=True, compression=OpenEXR.ZIP_COMPRESSION, kind=np.float16) -> tuple[bytes, np.ndarray, np.ndarray]:
    """market_7, each sixth pixel, as somebody's EXR: the file, color and depth."""
    scene = ray_traced.picture(ray_traced.MARKET)
    color, z = (np.ascontiguousarray(pixels[::6, ::6]) for pixels in (scene.color, scene.depth))
    channels = {name: np.ascontiguousarray(color[..., i].astype(kind)) for i, name in enumerate("RGB")}
    with tempfile.NamedTemporaryFile(suffix=".exr") as target:
        header = {"compression": compression, "type": OpenEXR.scanlineimage}
        with OpenEXR.File(header, channels | ({"Z": z} if depth else {})) as written:
            written.write(target.name)
        return Path(target.name).read_bytes(), color, z


def opened(page: browser.Session, *files: tuple[str, bytes]) -> str:
    """What the page says of files, by name."""
    return page.call("open", [[name, base64.b64encode(data).decode("ascii")] for name, data in files])


class Shown(Driver):
    """What a side of the page shows, as a driver whose settings are those of its controls."""

    name, software = "the page", False

    def __init__(self, page: browser.Session, side: str):
        self.page, self.side, device = page, side, load("webgl2")
        self.adapter, self.rounding = device.adapter, device.rounding

    def run(self, passes, textures, size, storage="half", keep=("result",)):
        """What it has drawn; the passes are only what it should have."""
        images = self.page.call("pictures", {"side": self.side, "names": list(keep)})
        return {name: unpacked(image, storage) for name, image in zip(keep, images, strict=True)}

    def pictures(self, *names: str) -> list[np.ndarray]:
        """By their names."""
        return list(self.run((), {}, (), keep=names).values())


@pytest.mark.parametrize(
    ("method", "aperture"),
    [("paper", "square"), ("exact", "hexagon"), ("exact", "decagon"), ("layered", "octagon"), ("layered", "hexagon")],
)
def test_shows_the_reference(page, method, aperture):
    """A picture of one's own, blurred as the controls say: every pixel within the reference's interval.

    Steps are not counted: see drivers.web of SwiftShader's sine.
    """
    data, color, depth = own()
    assert opened(page, ("own.exr", data)) == ""
    name = f"{method} {aperture}" + ("" if method == "paper" else " low")
    settings = replace(demo.settings()[name], camera=CAMERA, rotation=17.0, squeeze=0.6)
    controls = {"left": "input", "right": method, "blades": methods.EXACT[aperture], "preset": "low"}
    page.call("set", [controls, LENS | {"squeeze": 0.6, "rotation": 17.0}])
    result = compared(Case("own", settings, color, depth), Shown(page, "right"))
    assert all(comparison.outside == 0 for comparison in result.comparisons.values()), result.comparisons
    assert abs(result.outputs["result"].astype(float) - color)[..., :3].max() > 1.0


def test_scene(page):
    """market_7 in full: layered to the bit as the driver, the lens's picture, and the canvas with both of them."""
    page.call("scene", 0)
    page.call("set", [{"left": "truth", "right": "layered", "preset": "medium"}, {}])
    case = ray_traced.scene_case(ray_traced.MARKET, "layered", "hexagon")
    expected = load("webgl2").run(case.plan.passes, case.textures(), case.size)["result"]
    np.testing.assert_array_equal(Shown(page, "right").pictures("result")[0], expected)
    lens = ray_traced.truth(ray_traced.MARKET, "hexagon")
    for shown, image in zip(Shown(page, "left").pictures("truth", "color"), (lens, case.color), strict=True):
        np.testing.assert_array_equal(shown[..., :3], image[..., :3])
    canvas = np.frombuffer(base64.b64decode(page.call("canvas")), np.uint8).reshape(540, 960, 4)
    left, right = (pictures.filmic(image, demo.EXPOSURE["market_7"]) for image in (lens, expected))
    # a step: the page's arithmetic is float32
    assert np.abs(canvas[..., :3].astype(int) - np.hstack([left[:, :480], right[:, 480:]])).max() <= 1


@pytest.fixture(scope="module")
def beside():
    """market_7 on the page of validation/run peers."""
    picture = ray_traced.picture(ray_traced.MARKET)
    with effects.Page(list(demo.OTHERS)) as opened:
        opened.load(picture.color, picture.depth, ray_traced.MARKET.camera)
        yield opened


@pytest.mark.parametrize("name", demo.OTHERS)
def test_others(page, beside, name):
    """Another library's depth of field, with the scene's lens: what `validation/run peers` makes of it."""
    page.call("scene", 0)
    said = page.call("set", [{"left": "input", "right": name}, {}])
    assert said["facts"].startswith("a disc, ") and said["said"] == ""
    expected = beside.draw(name, effects.FOUND["market_7"][name])
    np.testing.assert_allclose(Shown(page, "right").pictures(name)[0][..., :3], expected[..., :3], rtol=2e-3, atol=2e-3)


def test_controls(page):
    """As a hand does it: sliders, lists, the divider by mouse and finger, a click that focuses, the readout, keys."""
    page.call("scene", 0)
    said = page.call("set", [{"left": "input", "right": "exact", "preset": "low", "stop": 0, "rotation": 30}, {}])
    assert (said["stop"], said["rotation"]) == (1.0, 30)
    assert re.fullmatch(r"\d passes, \d+\.\d ms", said["facts"])
    tab, depth = page.page, ray_traced.picture(ray_traced.MARKET).depth
    box = page.work(tab.locator("#canvas").bounding_box())

    def at(x: float, y: float) -> tuple[float, float]:
        """The middle of a texel, on the screen."""
        return box["x"] + (x + 0.5) * box["width"] / 960, box["y"] + (y + 0.5) * box["height"] / 540

    def near(x: int, y: int) -> np.ndarray:
        """Depths where the pointer can be: a click is on a whole pixel of the screen."""
        return depth[y - 1 : y + 2, x - 1 : x + 2]

    async def by_mouse() -> None:
        await tab.mouse.move(*at(480, 100))
        await tab.mouse.down()
        await tab.mouse.move(*at(720, 130), steps=3)
        await tab.mouse.up()

    async def by_finger() -> None:
        fingers = await tab.context.new_cdp_session(tab)
        for kind, x in (("touchStart", 720), ("touchMove", 600), ("touchMove", 240), ("touchEnd", None)):
            points = [] if x is None else [dict(zip("xy", at(x, 130), strict=True))]
            await fingers.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    for drag, split in ((by_mouse, 0.75), (by_finger, 0.25)):
        page.work(drag())
        said = page.call("set", [{}, {}])
        assert said["split"] == pytest.approx(split, abs=0.01) and said["focus"] == 2.42
    page.call("set", [{}, {"focus": 60.0}])
    page.call("focuses")
    page.work(tab.mouse.click(*at(700, 470)))
    focus = page.call("set", [{}, {}])["focus"]
    assert near(700, 470).min() <= focus <= near(700, 470).max() < 2.42
    passed = page.call("focuses")  # it did not jump
    assert len(set(passed) - {60.0, focus}) > 1 and passed == sorted(passed, reverse=True)
    page.work(tab.mouse.move(*at(300, 60)))
    under = page.call("set", [{}, {}])["under"]
    metres, pixels = map(float, re.fullmatch(r"\d+, \d+: (\S+) m, CoC (\S+) pixels far", under).groups())
    assert near(300, 60).min() * 0.99 < metres < near(300, 60).max() * 1.01
    coc = 0.05 * 0.05 * (metres - focus) / (metres * (focus - 0.05)) / 0.024
    assert pixels == pytest.approx(540 * min(coc, 0.15), rel=0.02)

    def keys(focused: str, *names: str) -> dict:
        page.work(tab.locator(focused).focus())
        for name in names:
            page.work(tab.keyboard.press(name))
        return page.call("set", [{}, {}])

    # a slider keeps its arrows
    after = keys("#stop", "ArrowRight", "x", "]", "b")
    assert after["stop"] == pytest.approx(2 ** (0.05 + 0.25)) and after["split"] == said["split"]
    assert (after["left"], after["right"], after["blades"]) == ("exact", "input", 8)
    last = keys("#divider", "ArrowLeft", "Shift+Digit3", "0")
    assert last["split"] == pytest.approx(after["split"] - 0.02)
    assert (last["right"], last["focus"], last["rotation"], last["blades"]) == ("exact", 2.42, 0, 6)


def png(pixels: np.ndarray) -> bytes:
    """As a file."""
    buffer = BytesIO()
    Image.fromarray(pixels).save(buffer, "PNG")
    return buffer.getvalue()


def test_own_pictures(page):
    """A picture and its depth.png; EXR of floats, of another compression; one line for what cannot be read."""
    grey = np.linspace(0, 255, 40).astype(np.uint8)[None].repeat(24, 0)
    depth = png(grey)
    assert opened(page, ("a depth.png", depth), ("a.png", png(np.dstack([grey, grey[:, ::-1], grey])))) == ""
    page.call("set", [{"left": "input", "right": "exact"}, {}])
    shown, metres = Shown(page, "left").pictures("color", "depth")
    linear = np.where(grey <= 10.3, grey / 255 / 12.92, ((grey / 255 + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(shown[..., 0], linear, atol=1e-3)
    np.testing.assert_allclose(metres[..., 0], 1 / (0.01 + 0.99 * grey / 255), rtol=1e-3)
    for compression in (OpenEXR.NO_COMPRESSION, OpenEXR.PIZ_COMPRESSION):
        data, half, z = own(compression=compression, kind=np.float32)
        assert opened(page, ("own.EXR", data)) == ""
        shown, metres = Shown(page, "left").pictures("color", "depth")
        np.testing.assert_array_equal(shown[..., :3], half[..., :3])
        np.testing.assert_array_equal(metres[..., 0], z.astype(np.float16))
    refusals = {
        "depth is 40 x 24, the picture 160 x 90": [("a.exr", own(depth=False)[0]), ("a_depth.png", depth)],
        "no.exr: no depth": [("no.exr", own(depth=False)[0])],
        "piz.exr: channels of two types; save it with ZIP": [("piz.exr", own(compression=OpenEXR.PIZ_COMPRESSION)[0])],
        "bad.exr: not an EXR file": [("bad.exr", b"no picture")],
        "cut.exr: ": [("cut.exr", data[:900])],
        "bad.png: ": [("bad.png", b"no picture")],
    }
    for words, files in refusals.items():
        said = opened(page, *files)
        assert words in said and "\n" not in said, said


def test_served(file):
    """The same over HTTP, to this machine; a port that is taken is refused in one line."""
    with demo.server(0) as serving:
        threading.Thread(target=serving.serve_forever, daemon=True).start()
        host, port = serving.server_address
        assert host == "127.0.0.1"
        with urllib.request.urlopen(f"http://{host}:{port}/") as answer:
            assert answer.read() == file.read_bytes()
        refused(called("demo", "--port", port), [f"--port {port}", "cannot be used"])
        serving.shutdown()
