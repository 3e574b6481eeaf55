"""Run what users paste: the blocks at the top of each library and in the README, unchanged, as one chain of passes.

A program is the library followed by one block, with the vertex shader given next to it. The chain starts from a depth
buffer of 0 to 1; its result is compared with the float64 reference.
"""

import re
import shutil
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import moderngl
import numpy as np
import pytest
from support import load
from test_inputs import FAR, NEAR

from bokeh_validation import exr, metrics, paths, shaders
from bokeh_validation.compilers import dxc, fxc, glslang, spirv
from bokeh_validation.drivers.base import Image
from bokeh_validation.frame import methods
from bokeh_validation.probes.model import Case
from bokeh_validation.reference import listings, pass_images

README = paths.ROOT / "README.md"
WINDOW = listings.DEPTH_KINDS["window"]  # what the blocks assume the depth buffer to be
CAMERA = methods.Camera(aperture_diameter=0.08, focal_length=0.05, focus_distance=6.0)
# For each block: the texture in each of its slots (GLSL and shader model 3 append Samp to the slot's name), and its
# targets, by the plan's names
READS = ({"Color": "color", "Depth": "depth"}, {"Map": "coc"}, {"Strip2": "strip 2", "Strip3": "strip 3"})
WRITES = (("coc",), ("strip 2", "strip 3"), ("result",))
NAMES = [name for names in WRITES for name in names]


@dataclass(frozen=True)
class Block:
    """Hold a block: the line above it, and its code."""

    title: str
    code: str

    def named(self, kind: str) -> dict[str, int]:
        """Return the resources of a kind with their registers or bindings; a suffix Samp is removed from the names."""
        pattern = {
            "t": r"Texture2D (\w+) : register\(t(\d)\)",
            "s": r"sampler2D (\w+?)(?:Samp)? : register\(s(\d)\)",
            "sampler": r"SamplerState (\w+) : register\(s(\d)\)",
            "wgsl": r"(?=@binding\(\d\) var(?:<uniform>)? (\w+):)@binding\((\d)\)",
        }[kind]
        return {name: int(number) for name, number in re.findall(pattern, self.code)}

    @property
    def entry(self) -> str:
        """Return the name of its entry point in HLSL and WGSL."""
        return re.search(r"^(?:@\w+ fn|\w+) (\w+)\(", self.code, re.MULTILINE)[1]


def header_blocks(language: str) -> list[Block]:
    """Return the blocks at the top of a library: the vertex shader, then the three passes."""
    text = shaders.file_text(language)
    paste = text[text.index("// PASTE: ") : text.index("// CONTENTS\n")]
    header = re.findall(r"^//   ((?:\d\. |Vertex ).*\n(?://   .*\n)*?)((?://          .*\n)+)", paste, re.MULTILINE)
    plain = [(" ".join(title.replace("//", " ").split()), re.sub(r"^//          ", "", code, flags=re.MULTILINE))
             for title, code in header]  # fmt: skip
    blocks = [Block(title, code) for title, code in plain]
    assert [block.title[:2] for block in blocks] == ["Ve", "1.", "2.", "3."]
    return blocks


def document_blocks(document: Path, language: str) -> list[Block]:
    """Return the blocks of a document, each with the line above it without markup."""
    text = document.read_text(encoding="utf-8")
    found = re.findall(rf"^([^\n]+)\n\n```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    return [Block(re.sub(r"[*`]", "", title), code) for title, code in found]


def test_readme_shows_the_header():
    """Check that the README's blocks equal the GLSL library's, including the lines on inputs and outputs."""
    shown, expected = document_blocks(README, "glsl"), header_blocks("glsl")
    assert [block.code for block in shown] == [block.code for block in expected]
    assert [block.title for block in shown[1:]] == [block.title for block in expected[1:]]


def program(language: str, block: Block, *head: str) -> str:
    """Return the lines of `head`, the library and a block as one text."""
    return "\n".join([*head, shaders.file_text(language) + block.code])


@pytest.mark.parametrize("version", ["#version 330", "#version 300 es", "#version 450"])
def test_glsl_compiles(version):
    """Compile the blocks with each GLSL version that the header names."""
    vertex, *blocks = header_blocks("glsl")
    results = [glslang.parse(f"{version}\n{vertex.code}", "vert")]
    for result in results + [glslang.parse(program("glsl", block, version), "frag") for block in blocks]:
        assert result.ok, result.messages


@pytest.mark.parametrize("model", [4, 5, 6])
def test_hlsl_compiles(model):
    """Compile the blocks for shader models 4 to 6, with fxc and DXC."""
    for number, block in enumerate(header_blocks("hlsl")):
        text = program("hlsl", block, f"#define BOKEH_HLSL_SM {model}")
        if model < 6:
            assert fxc.bytecode(text, f"{'ps' if number else 'vs'}_{model}_0", block.entry)
        else:
            result = dxc.build(text, "frag" if number else "vert", block.entry)
            assert result.ok, result.messages


@cache
def scene() -> dict[str, np.ndarray]:
    """Return every fourth pixel of the street: "color" (H, W, 4) float16, "depth" (H, W) float32, 0 to 1."""
    image = exr.read(paths.SCENES / "street_11_pin.exr")
    metres = np.clip(image.depth[::4, ::4].astype(np.float64), NEAR, FAR)
    stored = listings.stored_depth(metres, WINDOW, NEAR, FAR).astype(np.float32)
    return {"color": np.ascontiguousarray(image.color[::4, ::4]), "depth": stored}


def size() -> tuple[int, int]:
    """Return (width, height) of the scene."""
    height, width = scene()["depth"].shape
    return width, height


def values() -> dict[str, tuple[float, ...]]:
    """Return the values of all variables of the blocks by name."""
    diameter, length, distance = CAMERA.aperture_diameter, CAMERA.focal_length, CAMERA.focus_distance
    lens = {"apertureDiameter": (diameter,), "focalLength": (length,), "focusDistance": (distance,)}
    image = {"imageSize": tuple(map(float, size())), "rotation": (float(np.radians(17.0)),)}
    return {"nearPlane": (NEAR,), "farPlane": (FAR,), **lens, **image}


def targets(driver, names: Sequence[str]) -> list[tuple]:
    """Return (name, texture) for the targets of a block on an OpenGL or WebGPU driver."""
    return [(name, driver.texture(Image(name, size(), "half", 4))) for name in names]


def on_opengl(vertex: Block, *blocks: Block) -> dict[str, bytes]:
    """Run the blocks in GLSL 3.30 with a linear filter everywhere, which must not affect what is fetched texel by
    texel.

    Returns target -> its bytes.
    """
    driver = load("egl")
    driver.make_current()
    context = driver.context
    live = {name: driver.texture(Image.of(name, pixels)) for name, pixels in scene().items()}
    for block, reads, writes in zip(blocks, READS, WRITES, strict=True):
        head = "#version 330\n"
        linked = context.program(vertex_shader=head + vertex.code, fragment_shader=program("glsl", block, head))
        for unit, (name, texture) in enumerate(reads.items()):
            linked[f"{name}Samp"] = unit
            live[texture].use(unit)
            driver.samplers[True].use(unit)
        for name in set(values()) & set(linked):
            found = values()[name]
            linked[name] = found if len(found) > 1 else found[0]
        live |= targets(driver, writes)
        context.framebuffer([live[name] for name in writes]).use()
        context.vertex_array(linked, []).render(moderngl.TRIANGLES, vertices=3)
    return {name: live[name].read(alignment=1) for name in NAMES}


def on_webgpu(name: str, build: Callable, vertex: Block, *blocks: Block) -> dict[str, bytes]:
    """Run the blocks on WebGPU with the layout 'auto', on a device that cannot filter 32-bit textures.

    name   of the driver
    build  (driver, linear sampler, vertex shader, block) -> its two stages, and binding -> what is bound there: the
           name of a texture, or a WebGPU resource
    Returns target -> its bytes.
    """
    driver = copy(load(name))
    device = driver.device = driver.device.adapter.request_device_sync(required_features=[])
    assert "float32-filterable" not in device.features
    live = {name: driver.texture(Image.of(name, pixels)) for name, pixels in scene().items()}
    linear = device.create_sampler(min_filter="linear", mag_filter="linear")  # clamp is the default
    for block, reads, writes in zip(blocks, READS, WRITES, strict=True):
        live |= targets(driver, writes)
        vertex_stage, stage, bound = build(driver, linear, vertex, block)
        assert {name for name in bound.values() if isinstance(name, str)} == set(reads)
        pipeline = device.create_render_pipeline(
            layout="auto",
            vertex=vertex_stage,
            fragment={**stage, "targets": [{"format": live[name].format} for name in writes]},
            primitive={"topology": "triangle-list"},
        )
        views = {name: live[texture].create_view() for name, texture in reads.items()}
        entries = [
            {"binding": binding, "resource": views[found] if isinstance(found, str) else found}
            for binding, found in bound.items()
        ]
        encoder = device.create_command_encoder()
        written = [{"view": live[name].create_view(), "load_op": "clear", "store_op": "store"} for name in writes]
        render = encoder.begin_render_pass(color_attachments=written)
        render.set_pipeline(pipeline)
        render.set_bind_group(0, device.create_bind_group(layout=pipeline.get_bind_group_layout(0), entries=entries))
        render.draw(3)
        render.end()
        device.queue.submit([encoder.finish()])

    width, height = size()
    layout = {"bytes_per_row": width * 8, "rows_per_image": height}
    return {name: device.queue.read_texture({"texture": live[name]}, layout, (width, height, 1)) for name in NAMES}


def wgsl_stages(driver, linear, vertex: Block, block: Block) -> tuple[dict, dict, dict[int, object]]:
    """Return what on_webgpu() needs: one module with both stages, and a buffer with the variables."""
    device = driver.device
    module = device.create_shader_module(code=program("wgsl", Block("", vertex.code + block.code)))
    struct = re.search(r"struct (?:Camera|Aperture) ([^}]*)", block.code)[1]
    fields = (values()[name] for name in re.findall(r"(\w+): (?:f32|vec2f)\b", struct))
    members = np.float32([*(number for field in fields for number in field), 0, 0, 0, 0, 0])[:8]
    buffer = device.create_buffer_with_data(data=members.tobytes(), usage=driver.wgpu.BufferUsage.UNIFORM)
    variables = {"buffer": buffer, "offset": 0, "size": members.nbytes}
    inputs = [name for names in READS for name in names]
    bound = {
        binding: name if name in inputs else linear if name == "Linear" else variables
        for name, binding in block.named("wgsl").items()
    }
    vertex_stage, stage = ({"module": module, "entry_point": render_pass.entry} for render_pass in (vertex, block))
    return vertex_stage, stage, bound


def hlsl_stages(driver, linear, vertex: Block, block: Block) -> tuple[dict, dict, dict[int, object]]:
    """Return what on_webgpu() needs: the text for shader model 5, compiled by DXC; test_hlsl_compiles compiles it with
    fxc.
    """

    def stage(kind: str, one: Block) -> dict:
        text = with_values(program("hlsl", one, "#define BOKEH_HLSL_SM 5"))
        module = driver.device.create_shader_module(code=dxc.kept_spirv(text, kind, one.entry))
        return {"module": module, "entry_point": one.entry}

    samplers = {spirv.REGISTERS["s0"] + register: linear for register in block.named("sampler").values()}
    textures = {register: name for name, register in block.named("t").items()}
    return stage("vert", vertex), stage("frag", block), textures | samplers


def with_values(code: str) -> str:
    """Return HLSL with its variables as constants, since drivers set only the library's parameters."""

    def constant(found: re.Match) -> str:
        kind, names = found.groups()
        given = [f"{name} = {kind}({', '.join(f'{v:.9g}' for v in values()[name])})" for name in names.split(", ")]
        return f"static const {kind} {', '.join(given)};"

    return re.sub(r"^(float2?) (\w[\w, ]*);$", constant, code, flags=re.MULTILINE)


def on_direct3d_9(*blocks: Block) -> dict[str, bytes]:
    """Run the blocks in HLSL of shader model 3, compiled by fxc, with the library's vertex shader; returns target ->
    its bytes.
    """
    driver = load("d3d9")
    driver.ask("clear")
    driver.ask("vertex", driver.shader("vs", "BokehFullScreen_VS", {}))
    driver.ask("viewport", 0, 0, *size())
    live: dict[str, tuple[int, Image]] = {}

    def make(image: Image) -> None:
        live[image.name] = len(live), image
        driver.make(*live[image.name])

    for name, pixels in scene().items():
        make(Image.of(name, pixels))
    for block, reads, writes in zip(blocks, READS, WRITES, strict=True):
        code = fxc.bytecode(with_values(program("hlsl", block, "#define BOKEH_HLSL_SM 3")), "ps_3_0", block.entry)
        shutil.copy(code, driver.server.folder)
        driver.ask("pixel", code.name)
        # use the filter that the line above the block asks for
        kind = "nearest" if "nearest" in block.title else "linear"
        slots = block.named("s")
        assert set(slots) == set(reads)
        for name, texture in reads.items():
            driver.ask("input", slots[name], live[texture][0], kind)
        for name in writes:
            make(Image(name, size(), "half", 4))
        driver.ask("draw", *(live[name][0] for name in writes))
    return {name: driver.pixels(*live[name]).tobytes() for name in NAMES}


RUNS = {
    "GLSL 3.30, README": ("egl", lambda: on_opengl(*document_blocks(README, "glsl"))),
    "WGSL": ("wgpu", lambda: on_webgpu("wgpu", wgsl_stages, *header_blocks("wgsl"))),
    "HLSL, shader model 3": ("d3d9", lambda: on_direct3d_9(*model_3_blocks())),
    "HLSL, shader model 5": ("dxc", lambda: on_webgpu("dxc", hlsl_stages, *header_blocks("hlsl"))),
}


def model_3_blocks() -> list[Block]:
    """Return the blocks of the Direct3D 9 guide."""
    blocks = document_blocks(paths.ROOT / "integration/direct3d9/README.md", "hlsl")
    blocks = [block for block in blocks if re.match(r"\d\. ", block.title)]
    if not blocks:
        pytest.skip("integration/direct3d9/README.md has no blocks to paste yet")
    return blocks


@pytest.mark.parametrize("name", RUNS)
def test_the_chain_runs(name):
    """Check the pasted chain from a depth buffer and HDR colour to the blurred image.

    Each pass must be within the reference's interval at the library's defaults, and the result within the bounds in
    steps too.
    """
    driver, run = RUNS[name]
    driver, (width, height), pixels = load(driver), size(), run()
    outputs = {name: np.frombuffer(given, np.float16).reshape(height, width, 4) for name, given in pixels.items()}
    settings = methods.Settings("exact", "hexagon", rotation=17.0, camera=CAMERA)
    case = Case(name, settings, scene()["color"], scene()["depth"])
    buffer = {"BokehDepthKind": float(WINDOW), "BokehNear": NEAR, "BokehFar": FAR}
    first, *others = case.plan.passes
    passes = [replace(first, parameters={**first.parameters, **buffer}), *others]
    precision = driver.precision, driver.rounding
    images = pass_images.images(passes, case.textures(), size(), "half", *precision, given=outputs)
    for name in NAMES:
        comparison = metrics.compare(outputs[name], images[name], driver.software and name == "result")
        assert comparison.ok, (name, comparison)
    actual, expected = outputs["result"], images["result"]
    # there is something to compare: the image is blurred, and its CoC has both signs
    assert metrics.compare(scene()["color"], expected, driver.software).outside > 0.5 * width * height
    assert actual[..., 3].min() < -1.0 / height and actual[..., 3].max() > 1.0 / height
