"""validation/run demo: the page from disk in headless Chromium, worked by its controls, against the reference."""

import base64
import re
import tempfile
import threading
import urllib.error
import urllib.request
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from PIL import Image
from support import called, load, needed, refused

from bokeh_validation import browser, demo, exr, pictures, shaders
from bokeh_validation.demo import others
from bokeh_validation.drivers.base import Driver
from bokeh_validation.drivers.web import unpacked
from bokeh_validation.engines.pages import CANVAS
from bokeh_validation.errors import Unavailable
from bokeh_validation.frame import methods
from bokeh_validation.probes.model import Case, compared
from bokeh_validation.shaders.passes import is_linear, target_size
from bokeh_validation.truth import ray_traced
from bokeh_validation.truth.peers import effects

SCRIPT = Path(__file__).with_name("demo_page.js").read_text(encoding="utf-8")
SIZE = (160, 90)


class Page:
    """The page in a browser of its own, and all of its errors on the console."""

    def __init__(self, file: Path, kind: str = "webgl2"):
        self.kind = kind
        flags = CANVAS if kind == "webgpu" else ()
        tab = {"viewport": {"width": 1280, "height": 800}, "has_touch": True}
        address = f"{file.as_uri()}#{kind}"
        self.session = browser.Session(address, script=SCRIPT, flags=flags, strict=True, **tab)
        self.call, self.hand = self.session.call, self.session.work
        self.call("ready")


@pytest.fixture(scope="module")
def file(tmp_path_factory) -> Path:
    """What --output writes, in a folder whose name has a space in it."""
    path = tmp_path_factory.mktemp("a page") / "demo.html"
    done = called("demo", "--output", path)
    assert done.returncode == 0, done.stderr
    return path


@pytest.fixture(scope="module", params=["webgl2", "webgpu"])
def page(file, request):
    """It, opened from disk. Nothing may have been said on the console at the end."""
    with needed("Chromium"):
        opened = Page(file, request.param)
    yield opened
    opened.session.close()
    assert opened.session.said == []


def own(depth=True) -> tuple[bytes, np.ndarray, np.ndarray]:
    """market_7, each sixth pixel, as somebody's EXR: the file, color and depth."""
    scene = ray_traced.picture(ray_traced.MARKET)
    color, z = (np.ascontiguousarray(pixels[::6, ::6]) for pixels in (scene.color, scene.depth))
    channels = {name: np.ascontiguousarray(color[..., i]) for i, name in enumerate("RGB")} | ({"Z": z} if depth else {})
    return exr_bytes(channels), color, z


def exr_bytes(channels: dict[str, np.ndarray], compression=OpenEXR.ZIP_COMPRESSION) -> bytes:
    """As a file."""
    with tempfile.NamedTemporaryFile(suffix=".exr") as made:
        with OpenEXR.File({"compression": compression, "type": OpenEXR.scanlineimage}, channels) as written:
            written.write(made.name)
        return Path(made.name).read_bytes()


def packed(*files: tuple[str, bytes]) -> list[list[str]]:
    """Files as they are dropped."""
    return [[name, base64.b64encode(data).decode("ascii")] for name, data in files]


class Shown(Driver):
    """What a side of the page shows, as a driver whose settings are those of its controls."""

    name, software = "the page", False

    def __init__(self, page: Page, side: str):
        self.page, self.side, device = page, side, load(page.kind)
        self.adapter, self.rounding = device.adapter, device.rounding

    def run(self, passes, textures, size, storage="half", keep=("result",)):
        """What it has drawn; the passes are only what it should have."""
        read = self.page.call("pictures", {"side": self.side, "names": list(keep)})
        wide = [image | {"data": _of_four(image)} if image["channels"] == 1 else image for image in read]
        return {name: unpacked(image, storage) for name, image in zip(keep, wide, strict=True)}


def _of_four(image: dict) -> str:
    """Data of one channel, as of four."""
    values = np.frombuffer(base64.b64decode(image["data"]), np.float32)
    return base64.b64encode(values.repeat(4).tobytes()).decode("ascii")


def controls(settings: methods.Settings) -> dict:
    """Of the page, for settings."""
    camera = settings.camera
    exact = {
        "stop": camera.focal_length / camera.aperture_diameter,
        "focal": camera.focal_length,
        "focus": camera.focus_distance,
        "squeeze": settings.squeeze,
        "rotation": settings.rotation,
    }
    blades = {"blades": methods.EXACT[settings.aperture], "preset": "low"}
    return blades | {name: {"exactly": value} for name, value in exact.items()}


TURNED = {"rotation": 17.0, "squeeze": 0.6}
CAMERA = methods.Camera(0.2, 0.06, 4.0, 0.024, 0.15)  # f/0.3
CASES = [
    *(("paper", name, TURNED) for name in ("square", "hexagon", "decagon")),
    *(("exact", name, TURNED) for name in methods.EXACT),
    *(("layered", name, TURNED) for name in methods.EXACT),
    ("layered", "hexagon", {}),
]


@pytest.mark.parametrize(("method", "aperture", "changes"), CASES)
def test_shows_the_reference(page, method, aperture, changes):
    """A picture that was dropped, blurred as the controls say: every pixel within the reference's interval.

    Steps are not counted: see drivers.web of SwiftShader's sine.
    """
    data, color, depth = own()
    page.call("drop", packed(("own.exr", data)))
    preset = "" if method == "paper" else " low"
    settings = replace(demo.settings()[f"{method} {aperture}{preset}"], camera=CAMERA, **changes)
    said = page.call("set", {"left": "input", "right": method, **controls(settings)})
    case = Case("own", settings, color, depth)
    found = compared(case, Shown(page, "right"))
    assert all(one.outside == 0 for one in found.comparisons.values()), found.comparisons
    assert abs(found.outputs["result"].astype(float) - color)[..., :3].max() > 1.0
    passes = case.plan.passes
    # and to the bit what the driver makes of the same passes
    wanted = load(page.kind).run(passes, case.textures(), SIZE)["result"]
    np.testing.assert_array_equal(found.outputs["result"], wanted)
    assert said["rightFacts"].startswith(f"{len(passes)} passes, ")
    assert said["said"] == ""


def test_scene_as_the_driver_draws_it(page):
    """market_7 at its own lens, layered, and the input and the truth beside it: to the bit what the harness has."""
    page.call("scene", 0)
    page.call("set", {"left": "truth", "right": "layered", "preset": "medium"})
    case = ray_traced.scene_case(ray_traced.MARKET, "layered", "hexagon")
    wanted = load(page.kind).run(case.plan.passes, case.textures(), case.size)["result"]
    shown = Shown(page, "right").run((), {}, ())["result"]
    np.testing.assert_array_equal(shown, wanted)
    lens = ray_traced.truth(ray_traced.MARKET, "hexagon")
    left = Shown(page, "left").run((), {}, (), keep=("truth", "color"))
    np.testing.assert_array_equal(left["truth"][..., :3], lens[..., :3])
    np.testing.assert_array_equal(left["color"][..., :3], case.color[..., :3])
    canvas = np.frombuffer(base64.b64decode(page.call("canvas")), np.uint8).reshape(540, 960, 4)
    exposure = demo.truth.EXPOSURE["market_7"]
    expected = np.hstack([pictures.filmic(lens, exposure)[:, :480], pictures.filmic(wanted, exposure)[:, 480:]])
    # a step: the page's arithmetic is float32
    assert np.abs(canvas[..., :3].astype(int) - expected).max() <= 1


@pytest.mark.parametrize("name", list(others.FACTORS))
def test_others(page, name):
    """Another library's depth of field, on what was dropped: to the bit what `validation/run peers` makes of it."""
    data, color, depth = own()
    page.call("drop", packed(("own.exr", data)))
    lens = {"stop": 0.3, "focal": 0.06, "focus": 4.0}
    said = page.call("set", {"left": "input", "right": name, **{k: {"exactly": v} for k, v in lens.items()}})
    assert re.match(r"\d+\.\d+\.\d+, a disc, ", said["rightFacts"]) and said["said"] == ""
    shown = Shown(page, "right").run((), {}, (), keep=(name,))[name]
    factors, options = others.FACTORS[name]
    with effects.Page() as beside:
        beside.load(color, depth, CAMERA)
        parameters = {k: value * factors.get(k, 1.0) for k, value in beside.documented(name).items()}
        wanted = beside.draw(name, {**parameters, **options})
    np.testing.assert_array_equal(shown[..., :3], wanted[..., :3])
    assert abs(wanted[..., :3].astype(float) - color[..., :3]).max() > 1.0


def test_without_npm(monkeypatch):
    """The page without the other libraries."""

    def absent():
        raise Unavailable("npm is not on this machine")

    monkeypatch.setattr(effects, "installed", absent)
    assert others.listed() == {} and 'id="others"' not in demo.page()


def test_passes_are_the_plans(page):
    """Every frame of the page at random controls: programs, slots, sizes and parameters as methods.plan has them."""
    random = np.random.default_rng(15)
    asked, wanted = [], []
    for name, settings in demo.settings().items():
        size = tuple(int(side) for side in random.integers(20, 900, 2))
        camera = methods.Camera(*random.uniform((0.01, 0.02, 0.5), (0.1, 0.2, 50)), 0.024, 0.15)
        changes = {"rotation": float(random.uniform(0, 90)), "squeeze": float(random.uniform(0.5, 2))}
        settings = replace(settings, camera=camera, **changes)
        stop = camera.focal_length / camera.aperture_diameter
        lens = {"stop": stop, "focal": camera.focal_length, "focus": camera.focus_distance, **changes}
        method, aperture, *preset = name.split()
        blades = methods.EXACT[aperture]
        asked.append([{"method": method, "blades": blades, "preset": (preset or ["low"])[0], **lens}, size])
        wanted.append((methods.plan(settings, size).passes, size))
    text = shaders.text("glsl")
    for passes, (planned, size) in zip(page.call("frames", asked), wanted, strict=True):
        for found, item in zip(passes, planned, strict=True):
            assert found["fragment"] == shaders.glsl(item.entry, "300es", item.constants).replace(text, "")
            inputs = [(one["slot"], one["image"], one["linear"]) for one in found["inputs"]]
            assert inputs == [(slot, name, is_linear(item.entry, slot)) for slot, name in item.inputs.items()]
            assert tuple(found["targets"]) == item.outputs and tuple(found["size"]) == target_size(item.scale, size)
            # a place near 0 is the difference of two that are not
            for name, value in item.parameters.items():
                assert found["values"][name] == pytest.approx(value, rel=1e-12, abs=1e-14), (item.entry, name)


def test_controls(page):
    """Sliders, a click with its pull of focus, the readout, keys."""
    page.call("scene", 0)
    said = page.call(
        "set", {"left": "input", "right": "exact", "preset": "low", "stop": 0, "rotation": 30, "blades": 8}
    )
    state = said["state"]
    assert (state["stop"], state["rotation"], state["blades"]) == (1.0, 30, 8)
    assert re.fullmatch(r"3 passes, \d+ fetches a pixel, \d+\.\d ms", said["rightFacts"])
    picture = ray_traced.picture(ray_traced.MARKET)
    there = (700, 470)
    found = page.call("point", {"kind": "click", "place": there})
    depth = float(picture.depth[there[1], there[0]])
    assert found["state"]["focus"] == pytest.approx(depth)
    assert found["under"]["metres"] == pytest.approx(depth) and found["under"]["pixels"] == pytest.approx(0, abs=1e-3)
    # on its way it was between the two
    between = [focus for focus in found["seen"] if focus not in (2.42, depth)]
    assert between and all(min(2.42, depth) <= focus <= max(2.42, depth) for focus in between)
    other = (300, 60)
    found = page.call("point", {"kind": "pointermove", "place": other})
    z, focus = float(picture.depth[other[1], other[0]]), found["state"]["focus"]
    coc = 0.05 * 0.05 * abs(z - focus) / (z * (focus - 0.05)) / 0.024
    assert found["under"]["pixels"] == pytest.approx(540 * min(coc, 0.15), rel=2e-3)
    assert page.call("press", {"key": "ArrowLeft"})["split"] == pytest.approx(0.48)
    assert page.call("press", {"key": "]"})["stop"] == pytest.approx(2**0.25)
    assert page.call("press", {"key": "b"})["blades"] == 10
    assert page.call("press", {"key": "!", "code": "Digit3", "shiftKey": True})["right"] == "exact"
    swapped = page.call("press", {"key": "x"})
    assert (swapped["left"], swapped["right"]) == ("exact", "input")
    assert page.call("press", {"key": "0"})["focus"] == 2.42


def test_pointer_and_touch(page):
    """As a hand does it: the divider is dragged without a change of focus, a tap focuses, a slider keeps its arrows."""
    page.call("scene", 0)
    split = page.call("set", {"left": "input", "right": "exact", "preset": "low"})["state"]["split"]
    box = page.hand(lambda tab: tab.locator("#canvas").bounding_box())
    at = [box["x"] + split * box["width"], box["y"] + 0.2 * box["height"]]

    def drag(tab):
        tab.mouse.move(*at)
        tab.mouse.down()
        tab.mouse.move(box["x"] + 0.75 * box["width"], at[1] + 30, steps=3)
        tab.mouse.up()

    page.hand(drag)
    state = page.call("set", {})["state"]
    assert state["split"] == pytest.approx(0.75, abs=0.01) and state["focus"] == 2.42
    page.hand(lambda tab: tab.touchscreen.tap(box["x"] + 0.2 * box["width"], box["y"] + 0.8 * box["height"]))
    assert page.call("set", {})["state"]["focus"] != 2.42
    page.hand(lambda tab: (tab.locator("#stop").focus(), tab.keyboard.press("ArrowRight"), tab.keyboard.press("x")))
    after = page.call("set", {})["state"]
    assert after["stop"] > state["stop"] and after["split"] == state["split"]
    assert (after["left"], after["right"]) == ("exact", "input")


def test_own_pictures(page):
    """A picture and its depth.png, a float EXR without compression, and one line for what is no picture."""
    grey = np.linspace(0, 255, 40).astype(np.uint8)[None].repeat(24, 0)
    files = []
    for pixels in (np.dstack([grey, grey[:, ::-1], grey]), grey):
        buffer = BytesIO()
        Image.fromarray(pixels).save(buffer, "PNG")
        files.append(buffer.getvalue())
    color, depth = files
    # dropped in any order
    said = page.call("drop", packed(("a depth.png", depth), ("a.png", color)))
    assert said["said"] == "" and said["state"]["scene"] == len(demo.SCENES)
    page.call("set", {"left": "input", "right": "exact"})
    shown = Shown(page, "left").run((), {}, (), keep=("color", "depth"))
    linear = np.where(grey <= 10.3, grey / 255 / 12.92, ((grey / 255 + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(shown["color"][..., 0], linear, atol=1e-3)
    np.testing.assert_allclose(shown["depth"][..., 0], 1 / (0.01 + 0.99 * grey / 255), rtol=1e-3)
    _, half, z = own()
    channels = {name: np.ascontiguousarray(half[..., i].astype(np.float32)) for i, name in enumerate("RGB")}
    data = exr_bytes({**channels, "Z": z}, OpenEXR.NO_COMPRESSION)
    assert page.call("drop", packed(("plain.EXR", data)))["said"] == ""
    np.testing.assert_array_equal(Shown(page, "left").run((), {}, (), keep=("color",))["color"], half)
    refusals = {
        "depth is 40 x 24, the picture 160 x 90": (("a.exr", own(depth=False)[0]), ("a_depth.png", depth)),
        "no.exr: no depth": (("no.exr", own(depth=False)[0]),),
        "bad.exr: not an EXR file": (("bad.exr", b"no picture"),),
        "cut.exr: ": (("cut.exr", data[:900]),),
        "bad.png: ": (("bad.png", b"no picture"),),
        "its compression is not read here": (("piz.exr", exr_bytes(channels, OpenEXR.PIZ_COMPRESSION)),),
    }
    for words, files in refusals.items():
        said = page.call("drop", packed(*files))
        assert words in said["said"] and "\n" not in said["said"], said


def test_file(file):
    """One file with nothing outside it, and not too large to send: three scenes, three.js and postprocessing."""
    text = file.read_text(encoding="utf-8")
    assert len(text) < 12e6
    assert re.findall(r'(?:src|href)="(?!data:)', text) == [] and "//# source" not in text
    for scene in demo.SCENES:
        assert f'id="{scene.name} pinhole"' in text and exr.read(scene.source).depth is not None


def test_served(file):
    """The same over HTTP, to this machine; a port in use and a bad file are refused in one line."""
    with demo.server(0) as serving:
        thread = threading.Thread(target=serving.serve_forever)
        thread.start()
        try:
            host, port = serving.server_address
            assert host == "127.0.0.1"
            with urllib.request.urlopen(f"http://{host}:{port}/") as answer:
                assert answer.read() == file.read_bytes()
            with pytest.raises(urllib.error.HTTPError, match="404"):
                urllib.request.urlopen(f"http://{host}:{port}/etc/passwd")
            refused(called("demo", "--port", port), [f"--port {port}", "cannot be used"])
        finally:
            serving.shutdown()
            thread.join()
    refused(called("demo", "--port", 70000), ["--port 70000"])
    refused(called("demo", "--output", "/nonexistent/demo.html"), ["/nonexistent"])
