"""Check Godot's effect for Forward+ and Mobile, which cannot run here.

Its shader is split and compiled like Godot's importer does, its passes are compared with the frame's, and OpenGL draws
them and must give the harness's image.
"""

import ast
import json
import re
from functools import cache
from math import degrees

import moderngl
import numpy as np
import pytest
from support import compiled, load
from support_inputs import of_sample

from bokeh_validation import paths
from bokeh_validation.compilers import glslang, spirv
from bokeh_validation.frame import methods
from bokeh_validation.shaders.entries import COLORS
from bokeh_validation.truth import ray_traced
from engines.godot import ADDON

pytestmark = of_sample("godot")

EXTENSIONS = {"vertex": "vert", "fragment": "frag"}
# A part of market_7 whose size is not divisible by 2, 4 or 8
PART, SIZE = (slice(200, 317), slice(300, 457)), (157, 117)
NEAR, FAR = 0.1, 100.0
# In front of the focus distance, and behind it
FOCUS = methods.Focus(scale=(0.5, 0.75), limits=(0.04, 0.05))


@cache
def sections() -> dict[str, str]:
    """Return name -> text of each section of the shader, the lines after a name in brackets, with its includes
    resolved.
    """
    head, *parts = re.split(
        r"^#\[(\w+)\]$", (ADDON / "compositor.glsl").read_text(encoding="ascii"), flags=re.MULTILINE
    )
    # the importer accepts nothing else before the first section
    assert all(not line or line.startswith("//") for line in head.splitlines())
    texts = dict(zip(parts[::2], parts[1::2], strict=True))
    assert list(texts) == ["versions", *EXTENSIONS]

    def included(found: re.Match) -> str:
        text = (ADDON / found[1]).read_text(encoding="ascii")
        # the importer does not resolve nested includes
        assert not re.search(r"^\s*#include", text, re.MULTILINE)
        return text

    return {name: re.sub(r'^#include "(.*)"$', included, text, flags=re.MULTILINE) for name, text in texts.items()}


@cache
def versions() -> dict[str, str]:
    """Return name of each version -> its defines."""
    lines = [line for line in sections()["versions"].splitlines() if line and not line.startswith("//")]
    rows = [re.fullmatch(r'([a-z]\w*) = "([^"=;]*)";', line) for line in lines]
    assert all(rows), [line for line, row in zip(lines, rows, strict=True) if not row]
    return {row[1]: row[2].replace(r"\n", "\n") for row in rows}


def source(section: str, version: str) -> str:
    """Return the text that Godot compiles for a stage of a version."""
    return sections()[section].replace("VERSION_DEFINES", f"\n{versions()[version]}\n")


@cache
def frames() -> dict[str, dict[int, list]]:
    """Return method -> sides -> [version, scale, textures by slot, targets]."""
    text = (ADDON / "compositor_frames.gd").read_text(encoding="ascii")
    return ast.literal_eval(text.partition("const FRAMES := ")[2].partition("\n# generated")[0].replace("\t", " "))


@pytest.mark.parametrize("preset", [*methods.PRESETS])
def test_compiled(preset):
    """Compile every version of the preset to valid SPIR-V without messages, and check that a frame uses it."""
    names = [name for name in versions() if name.startswith(f"{preset}_")]
    used = {row[0] for by_sides in frames().values() for rows in by_sides.values() for row in rows}
    assert {name.removeprefix(f"{preset}_") for name in names} == used
    for name in names:
        built = compiled(lambda name=name: glslang.spirv(source("fragment", name).strip(), "frag", glslang.VULKAN))
        assert built.ok and not built.messages, f"{name}: {built.messages}"
        checked = compiled(lambda built=built: spirv.validate(built.binary))
        assert checked.ok and not checked.messages, f"{name}: {checked.messages}"
    assert compiled(lambda: glslang.spirv(source("vertex", names[0]).strip(), "vert", glslang.VULKAN)).ok


@pytest.mark.parametrize("plan", sorted((paths.ROOT / "integration/frames").glob("*.json")), ids=lambda path: path.stem)
def test_frame(plan):
    """Compare the passes with a frame's JSON: textures by slot, targets, sizes, memory."""
    planned = json.loads(plan.read_text(encoding="utf-8"))
    memory = {texture["name"]: f"texture_{texture['memory']}" for texture in planned["textures"]}
    rows = frames()[planned["method"]][methods.EXACT[planned["aperture"]]]
    first, *steps = planned["passes"]
    assert rows[0] == ["map", 1, ["color", "depth"], [memory[first["targets"][0]]]]
    assert len(rows) == len(planned["passes"])
    for (version, scale, reads, writes), step in zip(rows[1:], steps, strict=True):
        expected = {COLORS.index(item["slot"]): memory[item["texture"]] for item in step["inputs"]}
        assert {i: name for i, name in enumerate(reads) if name != "-"} == expected, version
        assert scale == step["scale"]
        is_last = step is steps[-1]
        assert writes == (["color"] if is_last else [memory[name] for name in step["targets"]]), version
        # a pass never writes a texture that it reads
        assert not set(reads) & set(writes)


def drawn(
    context: moderngl.Context, method: str, sides: int, preset: str, textures: dict, parameters: list
) -> np.ndarray:
    """Draw every pass with OpenGL as the script says, with a buffer instead of the push constant; returns the last
    target.
    """
    block = context.buffer(np.array(parameters, np.float32).tobytes())
    block.bind_to_uniform_block(0)
    made = dict(textures)
    for version, scale, reads, writes in frames()[method][sides]:
        fragment = source("fragment", f"{preset}_{version}").replace(
            "layout(push_constant)", "layout(std140, binding = 0)"
        )
        program = context.program(
            vertex_shader=source("vertex", f"{preset}_{version}").replace("gl_VertexIndex", "gl_VertexID").strip(),
            fragment_shader=fragment.replace("layout(set = 0, ", "layout(").strip(),
        )
        size = tuple(-(-side // scale) for side in SIZE)
        targets = [context.texture(size, 4, dtype="f2") for _ in writes]
        for slot, name in enumerate(reads):
            if name != "-":
                kind = moderngl.NEAREST if name == "depth" else moderngl.LINEAR
                made[name].filter = (kind, kind)
                made[name].repeat_x = made[name].repeat_y = False
                made[name].use(slot)
        for unit in range(len(reads)):
            context.clear_samplers(unit, unit + 1)
        context.framebuffer(targets).use()
        context.vertex_array(program, []).render(moderngl.TRIANGLES, vertices=3)
        made |= zip(writes, targets, strict=True)
    return np.frombuffer(made["color"].read(alignment=1), np.float16).reshape(SIZE[1], SIZE[0], 4)


@pytest.mark.parametrize(
    ("method", "aperture", "preset"),
    [("layered", "hexagon", "medium"), ("layered", "decagon", "low"), ("layered", "square", "high"),
     ("exact", "square", "medium"), ("exact", "hexagon", "ultra"), ("exact", "octagon", "low"),
     ("exact", "decagon", "medium")],
)  # fmt: skip
def test_picture(method, aperture, preset):
    """Compare with the harness's frame of that method; depth from Godot's reversed buffer is off by a few 2^-24."""
    driver = load("egl")
    scene = ray_traced.picture(ray_traced.MARKET)
    color = np.dstack([scene.color[PART][..., :3], np.ones(SIZE[::-1])]).astype(np.float16)
    metres = np.clip(scene.depth[PART], 2.0 * NEAR, 0.9 * FAR).astype(np.float32)
    camera = methods.Camera(0.05 / 0.28, 0.05, 2.5, 0.024, 0.1)
    settings = methods.Settings(
        method, aperture, camera=camera, preset=preset, rotation=degrees(0.3), squeeze=0.8, focus=FOCUS
    )
    plan = methods.plan(settings, SIZE)
    expected = driver.run(plan.passes, {"color": color, "depth": metres, **plan.tables}, SIZE)["result"]
    # rows z and w of Godot's projection, which puts the far plane at 0
    row = (NEAR / (FAR - NEAR), NEAR * FAR / (FAR - NEAR), -1.0, 0.0)
    stored = ((row[1] - row[0] * metres.astype(np.float64)) / metres).astype(np.float32)
    sides = methods.EXACT[aperture]
    parameters = [0.05 / 0.28, 0.05, 2.5, 0.024, *row, *SIZE, 0.1, sides, 0.3, 0.8]
    parameters += [*FOCUS.scale, *FOCUS.limits, 0.0, 0.0]
    driver.make_current()
    textures = {
        "color": driver.context.texture(SIZE, 4, color.tobytes(), alignment=1, dtype="f2"),
        "depth": driver.context.texture(SIZE, 1, stored.tobytes(), alignment=1, dtype="f4"),
    }
    actual = drawn(driver.context, method, sides, preset, textures, parameters)[..., :3].astype(np.float64)
    expected = expected[..., :3].astype(np.float64)
    # within four steps of a half float
    near = np.abs(actual - expected) <= 4.0 * 2.0**-10 * np.maximum(np.abs(expected), 2.0**-14)
    assert near.all(axis=-1).mean() >= 0.998
    assert (np.abs(expected - color[..., :3]) > 0.05).any(axis=-1).mean() > 0.1


def test_ignored():
    """Check that a .gdignore keeps Godot from importing shaders of this repository that are not the add-on's."""
    foreign = [path for path in paths.ROOT.glob("**/*.glsl") if ADDON not in path.parents and ".git" not in path.parts]
    assert len(foreign) >= 7
    for path in foreign:
        assert any((folder / ".gdignore").exists() for folder in path.parents if folder != paths.ROOT), path
    assert not any((folder / ".gdignore").exists() for folder in (ADDON, *ADDON.parents))
