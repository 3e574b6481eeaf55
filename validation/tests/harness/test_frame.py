"""The frame as data: an engine that knows nothing but the JSON draws it; what is made from it is not out of date."""

import json
import re

import moderngl
import numpy as np
import pytest
from support import called, load

from bokeh_validation import paths
from bokeh_validation.errors import UserError
from bokeh_validation.frame import apertures, methods, port
from bokeh_validation.frame import plan as frame
from bokeh_validation.shaders.passes import target_size

# The lens blurs the near and the far depths of `picture` by most of the height, so that every pass has work to do.
CAMERA = methods.Camera(aperture_diameter=0.4, focal_length=0.05, focus_distance=2.0, max_coc=0.8)
SIZE, WINDOW = (101, 77), (8, 16, 71, 53)
EVERY = {
    "paper star": ({"method": "paper", "aperture": "star", "spacing": 1.0, "jitter": 0.5, "frame": 3}, None),
    "naive": ({"method": "naive"}, None),
    "exact, a lens": (
        {"aperture": "octagon", "cats_eye": 0.4, "roundness": 0.7, "spacing": 1.5}, None
    ),
    "exact, one target": ({"targets": False, "lateral": 0.02, "spacing": 2.0}, WINDOW),
    "layered": ({"method": "layered", "cats_eye": 0.3}, None),
    "layered low": ({"method": "layered", "aperture": "octagon", "targets": False, "preset": "low"}, WINDOW),
    "layered decagon": ({"method": "layered", "aperture": "decagon", "coc": 0.1}, None),
}  # fmt: skip


def picture(size: tuple[int, int]) -> dict[str, np.ndarray]:
    """Colour and depth of blocks of 4 x 4 pixels: near, in focus, a little behind it, and far."""
    random = np.random.default_rng(5)
    wide, high = size
    color = np.ones((high, wide, 4), np.float16)
    color[..., :3] = random.exponential(1.0, (high, wide, 3))
    blocks = random.choice(np.float32([0.5, 1.0, 2.0, 2.2, 4.0, 50.0]), (-(-high // 4), -(-wide // 4)))
    return {"color": color, "depth": blocks.repeat(4, 0).repeat(4, 1)[:high, :wide].copy()}


class Engine:
    """OpenGL 3.3 that draws what the JSON says, of the files that it names; targets share their memory."""

    def __init__(self, context: moderngl.Context, planned: dict):
        self.context, self.planned, self.handles = context, planned, {}
        self.places = {t["name"]: t["name"] if t["memory"] is None else t["memory"] for t in planned["textures"]}
        for texture in planned["textures"]:
            if texture["written"] is not None:
                channels, dtype = {"RGBA16F": (4, "f2"), "R32F": (1, "f4")}[texture["format"]]
                handle = context.texture(texture["size"], channels, dtype=dtype)
                self.handles.setdefault(self.places[texture["name"]], handle)

    def give(self, name: str, pixels: np.ndarray) -> None:
        """A texture that no pass writes."""
        size, channels = pixels.shape[1::-1], pixels.shape[2] if pixels.ndim == 3 else 1
        dtype = {2: "f2", 4: "f4"}[pixels.itemsize]
        self.handles[name] = self.context.texture(size, channels, pixels.tobytes(), alignment=1, dtype=dtype)

    def text(self, define: str, constants: dict) -> str:
        """A shader."""
        preset, glsl = self.planned["preset"], self.planned["programs"]["glsl"]
        lines = [line.format(define=define) for line in glsl["before"]]
        lines += [f"#define {name} {value}" for name, value in constants.items()]
        lines += [f"#define {preset['define']}"] if preset else []
        return "\n".join(lines + [(paths.ROOT / name).read_text(encoding="ascii") for name in glsl["files"]])

    def draw(self, step: dict) -> None:
        """A pass."""
        program = self.context.program(
            vertex_shader=self.text(self.planned["vertex"]["define"], {}),
            fragment_shader=self.text(step["define"], step["constants"]),
        )
        for unit, source in enumerate(step["inputs"]):
            self.handles[self.places[source["texture"]]].use(unit)
            kind = {"linear": moderngl.LINEAR, "nearest": moderngl.NEAREST}[source["filter"]]
            self.context.sampler(repeat_x=False, repeat_y=False, filter=(kind, kind)).use(unit)
            program[source["uniform"]] = unit
        for name, value in {**self.planned["parameters"], **step["changes"]}.items():
            if name in program:
                program[name] = value
        target = self.context.framebuffer([self.handles[self.places[name]] for name in step["targets"]])
        assert list(target.size) == step["size"]
        target.viewport = tuple(step["viewport"] or (0, 0, *step["size"]))
        target.use()
        self.context.vertex_array(program, []).render(moderngl.TRIANGLES, vertices=self.planned["vertex"]["vertices"])


@pytest.mark.parametrize("name", EVERY)
def test_an_engine_runs_from_the_json(name):
    """Bit for bit what the harness draws: every method, and every option of render."""
    options, window = EVERY[name]
    settings = methods.Settings(**{"method": "exact", "rotation": 10.0, "squeeze": 0.8, "camera": CAMERA, **options})
    planned = json.loads(json.dumps(frame.frame(settings, SIZE, window), allow_nan=False))
    plan = methods.plan(settings, window[2:] if window else SIZE)
    plan = methods.in_viewport(plan, window, SIZE) if window else plan
    driver, given = load("osmesa"), picture(SIZE)
    expected = driver.run(plan.passes, {**given, **plan.tables}, SIZE)["result"]
    driver.make_current()
    engine = Engine(driver.context, planned)
    # metres already: BokehDepthKind 0
    tables = {key: np.float32([[(x, y, 0.0, 0.0) for x, y in rows]]) for key, rows in planned["tables"].items()}
    for key, pixels in {"color": given["color"], "depth buffer": given["depth"], **tables}.items():
        engine.give(key, pixels)
    for step in planned["passes"]:
        engine.draw(step)
    output = engine.handles[engine.places[planned["result"]]].read(alignment=1)
    x, y, wide, high = window or (0, 0, *SIZE)
    part = (slice(y, y + high), slice(x, x + wide))
    output = np.frombuffer(output, np.float16).reshape(expected.shape)[part]
    np.testing.assert_array_equal(output, expected[part])
    assert np.ptp(output[..., :3].astype(float)) > 0.0


@pytest.mark.parametrize("targets", [True, False])
@pytest.mark.parametrize("method", apertures.METHODS)
def test_every_frame_is_whole(method, targets):
    """What is read was written before or handed in, what is written is read; all is set free once, but the result.

    Textures share memory with their like, and no two at a time.
    """
    for aperture in methods.EXACT if method in ("exact", "layered") else apertures.NAMES:
        planned = frame.frame(methods.Settings(method, aperture, targets=targets), (1921, 1081))
        there = {"color", "depth buffer", *planned["tables"]}
        freed = []
        for number, step in enumerate(planned["passes"]):
            assert step["pass"] == number and (len(step["targets"]) == 1 or targets)
            read = [source["texture"] for source in step["inputs"]]
            assert there.issuperset(read) and not there.intersection(step["targets"])
            assert step["size"] == list(target_size(step["scale"], (1921, 1081)))
            assert set(step["free"]) <= set(read)
            there = there.union(step["targets"]).difference(step["free"])
            freed += step["free"]
        assert there == {planned["result"]} and len(freed) == len(set(freed)) == len(planned["textures"]) - 1
        written = [texture for texture in planned["textures"] if texture["written"] is not None]
        assert planned["bytes"] == sum(texture["bytes"] for texture in written)
        assert all(t["bytes"] == {"RGBA16F": 8, "R32F": 4}[t["format"]] * t["size"][0] * t["size"][1] for t in written)
        assert planned["bytes_shared"] < planned["bytes"] or method == "naive"


def test_the_command():
    """`validation/run plan` prints frame() as JSON."""
    done = called("plan", "--method", "layered", "--size", "1921x1081")
    planned = frame.frame(methods.Settings("layered", "hexagon"), (1921, 1081))
    assert done.returncode == 0 and json.loads(done.stdout) == json.loads(json.dumps(planned)), done.stderr


def test_nothing_is_out_of_date():
    """What samples and documents have of the frame, the parameters and the shaders. Otherwise: validation/run port."""
    assert list(port.out_of_date()) == []


def test_a_region_needs_its_markers():
    """A file without them is left alone."""
    with pytest.raises(UserError, match="a.py: its markers .* Restore them"):
        port.replaced("a.py", f"# {port.WRITTEN_BY} {port.FRAME}: begin\n", port.FRAME, [])


def test_layers_page():
    """docs/methods/layered.md: its presets are the code's, the passes that it names a frame's, in their order."""
    text = (paths.ROOT / "docs/methods/layered.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `BOKEH_PRESET_(\w+)`[^|]*\| (\d+) \| (\d+) \| (\w+) \|", text, re.MULTILINE)
    enlarged = {"bilinear": 0, "cubic": 1}
    assert {row[0].lower(): (int(row[1]), int(row[2]), enlarged[row[3]]) for row in rows} == methods.PRESETS
    named = list(dict.fromkeys(re.findall(r"^\d+\. \*\*(\w+)\*\*", text, re.MULTILINE)))
    steps = frame.frame(methods.Settings("layered"), SIZE)["passes"][1:]
    entries = dict.fromkeys(re.sub(r"Bokeh(?:Hexagon)?", "", step["entry"]) for step in steps)
    assert named == list(entries)
