"""validation/run demo: the page from disk in headless Chromium, worked by its controls, against the reference."""

import base64
import re
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from support import called, load, needed

from bokeh_validation import browser, demo, pictures
from bokeh_validation.drivers.base import Driver
from bokeh_validation.drivers.web import unpacked
from bokeh_validation.engines import pages
from bokeh_validation.frame import methods
from bokeh_validation.probes.model import Case, compared
from bokeh_validation.truth import ray_traced
from bokeh_validation.truth.peers import effects

SCRIPT = Path(__file__).with_name("demo_page.js").read_text(encoding="utf-8")
LENS = {"stop": 0.3, "focal": 0.06, "focus": 4.0}
CAMERA = methods.Camera(0.2, 0.06, 4.0, 0.024, 0.15)


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """What --output writes, in a folder whose name has a space in it, opened from disk: nothing is outside of it."""
    path = tmp_path_factory.mktemp("a page") / "demo.html"
    with needed("npm"):
        pages.installed(effects.FOLDERS[0])
    done = called("demo", "--output", path)
    assert done.returncode == 0, done.stderr
    text = path.read_text(encoding="utf-8")
    assert len(text) < 12e6 and re.findall(r'(?:src|href)="(?!data:)', text) == []
    with needed("Chromium"):
        opened = browser.Session(path.as_uri(), script=SCRIPT)
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


def opened(page: browser.Session, name: str, data: bytes) -> str:
    """What the page says of a file."""
    return page.call("open", [name, base64.b64encode(data).decode("ascii")])


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
    assert opened(page, "own.exr", data) == ""
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


@pytest.mark.parametrize("name", demo.OTHERS)
def test_others(page, name):
    """Another library's depth of field, with the scene's lens: what `validation/run peers` makes of it."""
    page.call("scene", 0)
    said = page.call("set", [{"left": "input", "right": name}, {}])
    assert said["facts"].startswith("a disc, ") and said["said"] == ""
    picture, camera = ray_traced.picture(ray_traced.MARKET), ray_traced.MARKET.camera
    with effects.Page([name]) as beside:
        beside.load(picture.color, picture.depth, camera)
        expected = beside.draw(name, effects.FOUND["market_7"][name])
    np.testing.assert_allclose(Shown(page, "right").pictures(name)[0][..., :3], expected[..., :3], rtol=2e-3, atol=2e-3)


def test_controls(page):
    """Sliders, lists, a click that focuses, the scene's lens."""
    page.call("scene", 0)
    said = page.call(
        "set", [{"right": "exact", "preset": "low", "stop": 0, "rotation": 30, "blades": 8, "split": 0.75}, {}]
    )
    assert (said["stop"], said["rotation"], said["blades"], said["split"]) == (1.0, 30, 8, 0.75)
    assert re.fullmatch(r"\d passes, \d+\.\d ms", said["facts"])

    async def click() -> None:
        box = await page.page.locator("#canvas").bounding_box()
        await page.page.mouse.click(box["x"] + 700.5 / 960 * box["width"], box["y"] + 470.5 / 540 * box["height"])

    page.work(click())
    # a click is on a whole pixel of the screen
    depth = ray_traced.picture(ray_traced.MARKET).depth[469:472, 699:702]
    assert depth.min() <= page.call("set", [{}, {}])["focus"] <= depth.max() < 2.42
    page.work(page.page.click("#reset"))
    said = page.call("set", [{}, {}])
    assert (said["focus"], said["rotation"], said["blades"]) == (2.42, 0, 6)


def test_own_pictures(page):
    """EXR of floats and of another compression; one line for what cannot be read."""
    for compression in (OpenEXR.NO_COMPRESSION, OpenEXR.PIZ_COMPRESSION):
        data, half, z = own(compression=compression, kind=np.float32)
        assert opened(page, "own.EXR", data) == ""
        page.call("set", [{"left": "input", "right": "exact"}, {}])
        shown, metres = Shown(page, "left").pictures("color", "depth")
        np.testing.assert_array_equal(shown[..., :3], half[..., :3])
        np.testing.assert_array_equal(metres[..., 0], z.astype(np.float16))
    refusals = {
        "no.exr: no depth": own(depth=False)[0],
        "piz.exr: channels of two types; save it with ZIP": own(compression=OpenEXR.PIZ_COMPRESSION)[0],
        "bad.exr: not an EXR file": b"no picture",
        "cut.exr: ": data[:900],
    }
    for words, file in refusals.items():
        said = opened(page, words.partition(":")[0], file)
        assert words in said and "\n" not in said, said
