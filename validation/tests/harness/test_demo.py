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

from bokeh_validation import browser, demo, pictures, shaders
from bokeh_validation.drivers.base import Driver
from bokeh_validation.drivers.web import unpacked
from bokeh_validation.frame import methods
from bokeh_validation.probes.model import Case, compared
from bokeh_validation.shaders.passes import is_linear, target_size
from bokeh_validation.truth import ray_traced
from bokeh_validation.truth.peers import effects

SCRIPT = Path(__file__).with_name("demo_page.js").read_text(encoding="utf-8")
CAMERA = methods.Camera(0.2, 0.06, 4.0, 0.024, 0.15)  # f/0.3


@pytest.fixture(scope="module")
def file(tmp_path_factory) -> Path:
    """What --output writes, in a folder whose name has a space in it."""
    path = tmp_path_factory.mktemp("a page") / "demo.html"
    with needed("npm"):
        effects.installed()
    done = called("demo", "--output", path)
    assert done.returncode == 0, done.stderr
    return path


@pytest.fixture(scope="module")
def page(file):
    """It, opened from disk; a call fails where something was written to the console."""
    tab = {"viewport": {"width": 1280, "height": 800}, "has_touch": True}
    with needed("Chromium"):
        opened = browser.Session(file.as_uri(), script=SCRIPT, strict=True, **tab)
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


def packed(*files: tuple[str, bytes]) -> list[list[str]]:
    """Files as they are dropped."""
    return [[name, base64.b64encode(data).decode("ascii")] for name, data in files]


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
    """A picture that was dropped, blurred as the controls say: every pixel within the reference's interval.

    Steps are not counted: see drivers.web of SwiftShader's sine.
    """
    data, color, depth = own()
    page.call("drop", packed(("own.exr", data)))
    name = f"{method} {aperture}" + ("" if method == "paper" else " low")
    settings = replace(demo.settings()[name], camera=CAMERA, rotation=17.0, squeeze=0.6)
    lens = {"stop": 0.3, "focal": 0.06, "focus": 4.0, "squeeze": 0.6, "rotation": 17.0}
    exactly = {name: {"exactly": value} for name, value in lens.items()}
    blades = {"blades": methods.EXACT[aperture], "preset": "low"}
    page.call("set", {"left": "input", "right": method, **blades, **exactly})
    result = compared(Case("own", settings, color, depth), Shown(page, "right"))
    assert all(comparison.outside == 0 for comparison in result.comparisons.values()), result.comparisons
    assert abs(result.outputs["result"].astype(float) - color)[..., :3].max() > 1.0


def test_scene(page):
    """market_7 in full: layered to the bit as the driver, the lens's picture, and the canvas with both of them."""
    page.call("scene", 0)
    page.call("set", {"left": "truth", "right": "layered", "preset": "medium"})
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


@pytest.mark.parametrize("name", list(demo.OTHERS))
def test_others(page, name):
    """Another library's depth of field, on what was dropped: to the bit what `validation/run peers` makes of it."""
    data, color, depth = own()
    page.call("drop", packed(("own.exr", data)))
    lens = {name: {"exactly": value} for name, value in {"stop": 0.3, "focal": 0.06, "focus": 4.0}.items()}
    said = page.call("set", {"left": "input", "right": name, **lens})
    assert re.match(r"\d+\.\d+\.\d+, a disc, ", said["rightFacts"]) and said["said"] == ""
    factors, options = demo.OTHERS[name]
    with effects.Page() as beside:
        beside.load(color, depth, CAMERA)
        parameters = {key: value * factors.get(key, 1.0) for key, value in beside.documented(name).items()}
        expected = beside.draw(name, parameters | options)
    np.testing.assert_array_equal(Shown(page, "right").pictures(name)[0][..., :3], expected[..., :3])
    assert abs(expected[..., :3].astype(float) - color[..., :3]).max() > 1.0


def test_passes_are_the_plans(page):
    """Every frame of the page at random controls: programs, slots, sizes and parameters as methods.plan has them."""
    random, asked, expected = np.random.default_rng(15), [], []
    for name, settings in demo.settings().items():
        size = tuple(int(side) for side in random.integers(20, 900, 2))
        camera = methods.Camera(*random.uniform((0.01, 0.02, 0.5), (0.1, 0.2, 50)), 0.024, 0.15)
        changes = {"rotation": float(random.uniform(0, 90)), "squeeze": float(random.uniform(0.5, 2))}
        lens = {"stop": camera.focal_length / camera.aperture_diameter, "focal": camera.focal_length, **changes}
        method, aperture, *preset = name.split()
        controls = {"method": method, "blades": methods.EXACT[aperture], "preset": (preset or ["low"])[0], **lens}
        asked.append([{**controls, "focus": camera.focus_distance}, size])
        expected.append((methods.plan(replace(settings, camera=camera, **changes), size).passes, size))
    text = shaders.text("glsl")
    for passes, (planned, size) in zip(page.call("frames", asked), expected, strict=True):
        for drawn, item in zip(passes, planned, strict=True):
            assert drawn["fragment"] == shaders.glsl(item.entry, "300es", item.constants).replace(text, "")
            inputs = [(read["slot"], read["image"], read["linear"]) for read in drawn["inputs"]]
            assert inputs == [(slot, name, is_linear(item.entry, slot)) for slot, name in item.inputs.items()]
            assert tuple(drawn["targets"]) == item.outputs and tuple(drawn["size"]) == target_size(item.scale, size)
            # a place near 0 is the difference of two that are not
            for name, value in item.parameters.items():
                assert drawn["values"][name] == pytest.approx(value, rel=1e-12, abs=1e-14), (item.entry, name)


def test_controls(page):
    """As a hand does it: sliders, the divider, a click that focuses, a tap, the readout, keys."""
    page.call("scene", 0)
    said = page.call("set", {"left": "input", "right": "exact", "preset": "low", "stop": 0, "rotation": 30})
    assert (said["state"]["stop"], said["state"]["rotation"]) == (1.0, 30)
    assert re.fullmatch(r"3 passes, \d+ fetches a pixel, \d+\.\d ms", said["rightFacts"])
    box = page.work(lambda tab: tab.locator("#canvas").bounding_box())

    def at(x: float, y: float) -> list[float]:
        """The middle of a texel, on the screen."""
        return [box["x"] + (x + 0.5) * box["width"] / 960, box["y"] + (y + 0.5) * box["height"] / 540]

    def drag(tab):
        tab.mouse.move(*at(480, 100))
        tab.mouse.down()
        tab.mouse.move(*at(720, 130), steps=3)
        tab.mouse.up()

    page.work(drag)
    state = page.call("set", {})["state"]
    assert state["split"] == pytest.approx(0.75, abs=0.01) and state["focus"] == 2.42
    depth = ray_traced.picture(ray_traced.MARKET).depth
    page.work(lambda tab: tab.mouse.click(*at(700, 470)))
    focus = page.call("set", {})["state"]["focus"]
    assert focus == pytest.approx(float(depth[470, 700]))
    page.work(lambda tab: tab.mouse.move(*at(300, 60)))
    z, under = float(depth[60, 300]), page.call("scene", None)["under"]
    coc = 0.05 * 0.05 * abs(z - focus) / (z * (focus - 0.05)) / 0.024
    assert under["metres"] == pytest.approx(z) and under["pixels"] == pytest.approx(540 * min(coc, 0.15), rel=2e-3)
    page.work(lambda tab: tab.touchscreen.tap(*at(200, 430)))
    assert page.call("set", {})["state"]["focus"] == pytest.approx(float(depth[430, 200]))
    # a slider keeps its arrows
    page.work(lambda tab: (tab.locator("#stop").focus(), *map(tab.keyboard.press, ("ArrowRight", "x", "]", "b"))))
    after = page.call("set", {})["state"]
    assert after["stop"] == pytest.approx(2 ** (0.05 + 0.25)) and after["split"] == state["split"]
    assert (after["left"], after["right"], after["blades"]) == ("exact", "input", 8)
    page.work(
        lambda tab: (tab.locator("#divider").focus(), *map(tab.keyboard.press, ("ArrowLeft", "Shift+Digit3", "0")))
    )
    last = page.call("set", {})["state"]
    assert last["split"] == pytest.approx(after["split"] - 0.02) and (last["right"], last["focus"]) == ("exact", 2.42)


def png(pixels: np.ndarray) -> bytes:
    """As a file."""
    buffer = BytesIO()
    Image.fromarray(pixels).save(buffer, "PNG")
    return buffer.getvalue()


def test_own_pictures(page):
    """A picture and its depth.png; EXR of floats, of another compression; one line for what is no picture."""
    grey = np.linspace(0, 255, 40).astype(np.uint8)[None].repeat(24, 0)
    color, depth = png(np.dstack([grey, grey[:, ::-1], grey])), png(grey)
    # dropped in any order
    said = page.call("drop", packed(("a depth.png", depth), ("a.png", color)))
    assert said["said"] == "" and said["state"]["scene"] == len(demo.SCENES)
    page.call("set", {"left": "input", "right": "exact"})
    shown, metres = Shown(page, "left").pictures("color", "depth")
    linear = np.where(grey <= 10.3, grey / 255 / 12.92, ((grey / 255 + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(shown[..., 0], linear, atol=1e-3)
    np.testing.assert_allclose(metres[..., 0], 1 / (0.01 + 0.99 * grey / 255), rtol=1e-3)
    for compression, kind in ((OpenEXR.NO_COMPRESSION, np.float32), (OpenEXR.PIZ_COMPRESSION, np.float32)):
        data, half, z = own(compression=compression, kind=kind)
        assert page.call("drop", packed(("own.EXR", data)))["said"] == ""
        shown, metres = Shown(page, "left").pictures("color", "depth")
        np.testing.assert_array_equal(shown[..., :3], half[..., :3])
        np.testing.assert_array_equal(metres[..., 0], z.astype(np.float16))
    refusals = {
        "depth is 40 x 24, the picture 160 x 90": (("a.exr", own(depth=False)[0]), ("a_depth.png", depth)),
        "no.exr: no depth": (("no.exr", own(depth=False)[0]),),
        "piz.exr: channels of two types; save it with ZIP": (("piz.exr", own(compression=OpenEXR.PIZ_COMPRESSION)[0]),),
        "bad.exr: not an EXR file": (("bad.exr", b"no picture"),),
        "cut.exr: ": (("cut.exr", data[:900]),),
        "bad.png: ": (("bad.png", b"no picture"),),
    }
    for words, files in refusals.items():
        said = page.call("drop", packed(*files))
        assert words in said["said"] and "\n" not in said["said"], said


def test_served(file):
    """One file with nothing outside it, over HTTP the same, to this machine; bad options are refused in one line."""
    text = file.read_text(encoding="utf-8")
    assert len(text) < 12e6 and re.findall(r'(?:src|href)="(?!data:)', text) == []
    with demo.server(0) as serving:
        thread = threading.Thread(target=serving.serve_forever)
        thread.start()
        try:
            host, port = serving.server_address
            assert host == "127.0.0.1"
            with urllib.request.urlopen(f"http://{host}:{port}/") as answer:
                assert answer.read() == file.read_bytes()
            refused(called("demo", "--port", port), [f"--port {port}", "cannot be used"])
        finally:
            serving.shutdown()
            thread.join()
    refused(called("demo", "--output", "/nonexistent/demo.html"), ["/nonexistent"])
