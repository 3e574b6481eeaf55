"""Test the frame as data: an engine that knows only the JSON can draw it, and generated files are up to date."""

import json
import re

import moderngl
import numpy as np
import pytest
from support import called, compiled, load
from support_inputs import inputs

from bokeh_validation import drivers, generate, options, paths, shaders
from bokeh_validation import plan as frame
from bokeh_validation.compilers import dxc, spirv
from bokeh_validation.errors import UserError
from bokeh_validation.frame import aperture_shapes, methods
from bokeh_validation.probes import cases
from bokeh_validation.shaders.passes import target_size

# The lens blurs the near and far depths of `picture` by most of the height, so that every pass has something to do.
CAMERA = methods.Camera(aperture_diameter=0.4, focal_length=0.05, focus_distance=2.0, max_coc=0.8)
SIZE, WINDOW = (101, 77), (8, 16, 71, 53)
SETTINGS = cases.tagged(cases.JSON, CAMERA)
# Settings to draw into a part of the textures
IN_WINDOW = ("exact decagon, one target", "layered, one target")


def picture(size: tuple[int, int]) -> dict[str, np.ndarray]:
    """Return colour and depth of blocks of 4 x 4 pixels: near, in focus, slightly behind the focus, and far."""
    random = np.random.default_rng(5)
    wide, high = size
    color = np.ones((high, wide, 4), np.float16)
    color[..., :3] = random.exponential(1.0, (high, wide, 3))
    blocks = random.choice(np.float32([0.5, 1.0, 2.0, 2.2, 4.0, 50.0]), (-(-high // 4), -(-wide // 4)))
    return {"color": color, "depth": blocks.repeat(4, 0).repeat(4, 1)[:high, :wide].copy()}


# load() and draw() of docs/own-engine.md, as printed; and its lines that choose the preset HIGH
PAGE = (paths.ROOT / "docs/own-engine.md").read_text(encoding="utf-8")
ENGINE, CHOOSE_HIGH = re.findall(r"^```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
FRAME: dict = {}
exec(ENGINE, FRAME)


class Renderer:
    """Implement the page's `gpu` with OpenGL 3.3."""

    def __init__(self, context: moderngl.Context):
        self.context, self.current = context, None

    def texture(self, size: tuple[int, int], form: str) -> moderngl.Texture:
        channels, dtype = {"RGBA16F": (4, "f2"), "R32F": (1, "f4")}[form]
        return self.context.texture(size, channels, dtype=dtype)

    def program(self, vertex: str, fragment: str) -> moderngl.Program:
        return self.context.program(vertex_shader=vertex, fragment_shader=fragment)

    def begin(self, program: moderngl.Program, targets: list, viewport: list[int] | None) -> None:
        self.current, self.unit = program, 0
        target = self.context.framebuffer(targets)
        target.viewport = tuple(viewport or (0, 0, *target.size))
        target.use()

    def bind(self, uniform: str, texture: moderngl.Texture, name: str) -> None:
        texture.use(self.unit)
        kind = {"linear": moderngl.LINEAR, "nearest": moderngl.NEAREST}[name]
        self.context.sampler(repeat_x=False, repeat_y=False, filter=(kind, kind)).use(self.unit)
        self.current[uniform] = self.unit
        self.unit += 1

    def set(self, name: str, value: float) -> None:
        if name in self.current:
            self.current[name] = value

    def triangle(self) -> None:
        self.context.vertex_array(self.current, []).render(moderngl.TRIANGLES, vertices=3)


def given(context: moderngl.Context, pixels: np.ndarray) -> moderngl.Texture:
    """Create a texture of these pixels, which no pass writes."""
    size, channels = pixels.shape[1::-1], pixels.shape[2] if pixels.ndim == 3 else 1
    return context.texture(size, channels, pixels.tobytes(), alignment=1, dtype={2: "f2", 4: "f4"}[pixels.itemsize])


def drawn(driver: drivers.Driver, planned: dict, inputs: dict[str, np.ndarray], own: dict | None = None) -> np.ndarray:
    """Return the result (H, W, 4) of the frame `planned`, drawn by the page's code with the parameters `own`."""
    driver.make_current()
    gpu = Renderer(driver.context)
    programs, textures = FRAME["load"](gpu, planned, lambda file: (paths.ROOT / file).read_text("ascii"), *SIZE)
    # depth is in metres, BokehDepthKind 0
    tables = {key: np.float32([[(x, y, 0.0, 0.0) for x, y in rows]]) for key, rows in planned["tables"].items()}
    for key, pixels in {"color": inputs["color"], "depth buffer": inputs["depth"], **tables}.items():
        textures[key] = given(driver.context, pixels)
    output = FRAME["draw"](gpu, planned, programs, textures, own or {}).read(alignment=1)
    return np.frombuffer(output, np.float16).reshape(*SIZE[::-1], 4)


@inputs("validation/tests/harness/test_frame.py", "integration/frames", of_code=True)
@pytest.mark.parametrize("name", SETTINGS)
def test_an_engine_runs_from_the_json(name):
    """Check that an engine which uses only the JSON draws bit-identical images to the harness, for every method and
    option.
    """
    settings, window = SETTINGS[name], WINDOW if name in IN_WINDOW else None
    planned = json.loads(json.dumps(frame.frame(settings, SIZE, window), allow_nan=False))
    plan = methods.plan(settings, window[2:] if window else SIZE)
    plan = methods.in_viewport(plan, window, SIZE) if window else plan
    driver, inputs = load("egl"), picture(SIZE)
    expected = driver.run(plan.passes, {**inputs, **plan.tables}, SIZE)["result"]
    # for methods without presets: a define that nothing reads
    planned["preset"] = planned["preset"] or {"define": "BOKEH_PRESET_NONE"}
    output = drawn(driver, planned, inputs)
    x, y, wide, high = window or (0, 0, *SIZE)
    part = (slice(y, y + high), slice(x, x + wide))
    np.testing.assert_array_equal(output[part], expected[part])
    assert np.ptp(output[part][..., :3].astype(float)) > 0.0


@inputs("validation/tests/harness/test_frame.py", "integration/frames", of_code=True)
@pytest.mark.parametrize("preset", ["high", "mobile"])
@pytest.mark.parametrize("name", ["layered-hexagon", "exact-hexagon"])
def test_another_preset_from_the_json(name, preset):
    """Check that a file of integration/frames draws another preset's image by the page's lines, bit-identical to the
    harness's frame of that preset, and that the image differs from that of the file's own preset.
    """
    method, aperture = name.split("-")
    file = json.loads((paths.ROOT / f"integration/frames/{name}.json").read_text(encoding="utf-8"))
    other = {"plan": json.loads(json.dumps(file))}
    exec(CHOOSE_HIGH.replace('"high"', f'"{preset}"'), other)
    driver, inputs = load("egl"), picture(SIZE)
    settings = methods.Settings(method, aperture, camera=CAMERA, preset=preset)
    passes, camera = methods.plan(settings, SIZE).passes, frame.frame(settings, SIZE)["parameters"]
    expected = driver.run(passes, inputs, SIZE)["result"]
    np.testing.assert_array_equal(drawn(driver, other["plan"], inputs, camera), expected)
    assert (drawn(driver, file, inputs, camera) != expected).any()


def test_dxc_for_vulkan(monkeypatch):
    """Compile with the DXC options of docs/own-engine.md; bindings and the size of the block must match the JSON."""
    planned = frame.frame(methods.Settings("layered"), SIZE)
    vertex, fragment = re.findall(
        r"dxc -spirv -T \w+ -E (\w+)((?: -fvk[^\n]*?(?= passes.hlsl)|.*?```))", PAGE, re.DOTALL
    )
    bound = re.findall(r"-fvk-bind-register (\w+) 0 (\d+) 0", fragment[1])
    inputs = {(f"t{source['register']}", str(source["binding"])) for p in planned["passes"] for source in p["inputs"]}
    assert inputs | {("b0", "0"), ("s0", str(planned["bindings"]["sampler"]))} <= set(bound)
    text = shaders.hlsl(6)
    for stage, (entry, words) in {"vert": vertex, "frag": fragment}.items():
        flags = re.findall(r"-fvk-(?:invert-y|bind-register \w+ \d+ \d+ \d+)", words)
        split = [word for flag in flags for word in flag.split()]
        monkeypatch.setattr(dxc, "spirv_options", lambda _, split=split: ["-spirv", *split])
        built = compiled(lambda stage=stage, entry=entry: dxc.build(text, stage, entry))
        assert built.ok and spirv.validate(built.binary).ok, built.messages
    assert f"block of {4 * planned['block']['floats']} bytes ({planned['block']['floats']} floats" in PAGE


@pytest.mark.parametrize("targets", [True, False])
@pytest.mark.parametrize("method", aperture_shapes.METHODS)
def test_every_frame_is_whole(method, targets):
    """Check that every texture read is supplied or was written before, every target is read, and each is freed once
    except the result.

    Textures share memory with others of their kind, and never two at a time.
    """
    for aperture in methods.EXACT if method in ("exact", "layered") else aperture_shapes.NAMES:
        planned = frame.frame(methods.Settings(method, aperture, use_mrt=targets), (1921, 1081))
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
    """Check that `validation/run plan` prints frame() as JSON."""
    done = called("plan", "--method", "layered", "--size", "1921x1081")
    planned = frame.frame(options.DEFAULT, (1921, 1081))
    assert done.returncode == 0 and json.loads(done.stdout) == json.loads(json.dumps(planned)), done.stderr


def test_nothing_is_out_of_date():
    """Check that `validation/run generate` would not change any file."""
    assert list(generate.out_of_date()) == []


def test_a_region_needs_its_markers():
    """Check that a file without the markers is refused."""
    with pytest.raises(UserError, match="a.py: its markers .* Restore them"):
        marker = f"# {generate.WRITTEN_BY} {generate.FRAME}: "
        generate.replaced("a.py", f"{marker}begin\n", f"{marker}begin\n{marker}end\n")


def test_layers_page():
    """Compare docs/methods/layered.md with the code: its presets, and the passes that it explains."""
    text = (paths.ROOT / "docs/methods/layered.md").read_text(encoding="utf-8")
    row = r"^\| `BOKEH_PRESET_(\w+)`[^|]*\| (\d+) \| (\d+) \| (\w+) \| 1/(\d) \|$"
    rows = re.findall(row, text, re.MULTILINE)
    enlarged = {"bilinear": 0, "cubic": 1}
    found = {name.lower(): (int(rings), int(most), enlarged[how], int(size)) for name, rings, most, how, size in rows}
    assert found == methods.PRESETS
    explained = re.findall(r"\*\*(\w+)\*\*", text.split("## The passes")[1].split("\n## ")[0])
    steps = frame.frame(methods.Settings("layered"), SIZE)["passes"][1:]
    assert sorted(explained) == sorted({re.sub(r"Bokeh(?:Hexagon)?", "", step["entry"]) for step in steps})


def test_exact_page():
    """Compare the presets in docs/methods/exact.md with the code."""
    text = (paths.ROOT / "docs/methods/exact.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `BOKEH_PRESET_(\w+)`[^|]*\| (\d+) \| ([\d.]+) \|$", text, re.MULTILINE)
    assert {name.lower(): (int(count), float(spacing)) for name, count, spacing in rows} == methods.EXACT_PRESETS


@pytest.mark.parametrize("targets", [True, False])
@pytest.mark.parametrize("method", ["exact", "layered", "paper"])
def test_layouts_made_from_the_wgsl(method, targets):
    """Check the layouts that WebGPU derives from each pass, the debug view included, against the JSON.

    A set of bindings with more or fewer entries is an error of the device.
    """
    device = load("wgpu").device
    for aperture in methods.EXACT if method != "paper" else ("hexagon", "octagon"):
        planned = frame.frame(methods.Settings(method, aperture, use_mrt=targets), SIZE)
        program = planned["programs"]["wgsl"]
        text = "".join((paths.ROOT / name).read_text(encoding="ascii") for name in program["files"])
        module = device.create_shader_module(code=text)
        sampler = device.create_sampler(min_filter="linear", mag_filter="linear")
        view = device.create_texture(size=(1, 1, 1), format="rgba16float", usage="TEXTURE_BINDING").create_view()
        block = device.create_buffer(size=4 * planned["block"]["floats"], usage="UNIFORM")
        bindings, groups = planned["bindings"], []
        for step in [*planned["passes"], *([planned["debug"]] if planned["debug"] else [])]:
            stage = {"module": module, "entry_point": program["entry"].format(**step), "constants": step["constants"]}
            pipeline = device.create_render_pipeline(
                layout="auto",
                vertex={"module": module, "entry_point": program["vertex_entry"]},
                fragment={**stage, "targets": [{"format": "rgba16float"}] * len(step["targets"])},
            )
            entries = [{"binding": bindings["parameters"], "resource": {"buffer": block}}]
            entries += [
                {"binding": read["binding"], "resource": view} for read in step["inputs"] + step.get("unread", [])
            ]
            if step["sampler"]:
                entries.append({"binding": bindings["sampler"], "resource": sampler})
            layout = pipeline.get_bind_group_layout(bindings["group"])
            groups.append(device.create_bind_group(layout=layout, entries=entries))
        assert len(groups) >= len(planned["passes"]) >= 3
