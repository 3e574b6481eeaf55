"""The passes of layered and exact in ReShade FX: what integration/reshade has of the frame."""

import re
from collections.abc import Iterator

from bokeh_validation import plan
from bokeh_validation.frame import methods
from bokeh_validation.generate import samples
from bokeh_validation.shaders.passes import Pass

SIZE = (64, 64)
TECHNIQUES = {
    "layered": ("PolygonalBokeh", "Near objects spread over what is behind them."),
    "exact": ("PolygonalBokehExact", "Fewer passes; near objects keep a hard outline."),
}
# Locals of a pixel shader -> how it gets them
LOCALS = {
    "layers": "BokehLayers layers = Layers(uv);",
    "polygon": "BokehPolygon polygon = Aperture();",
    "settings": "BokehFilter settings = BokehDefaultFilter(float2(BUFFER_WIDTH, BUFFER_HEIGHT));",
}
VERTEX = "VertexShader = PostProcessVS"


def effect() -> Iterator[str]:
    """Textures, pixel shaders and technique of each method; textures that may share their memory are one."""
    for number, (method, (title, tip)) in enumerate(TECHNIQUES.items()):
        yield from [""] * (number > 0)
        yield from _technique(method, title, tip)


def _technique(method: str, title: str, tip: str) -> Iterator[str]:
    settings = methods.Settings(method, "hexagon")
    planned = plan.frame(settings, SIZE)
    names = {
        texture["name"]: f"{method.title()}{texture['memory']}"
        for texture in planned["textures"]
        if texture["written"] is not None
    }
    scales, bodies = {}, []
    passes = ["FocusPS; RenderTarget = PolygonalBokehFocus;", "KeepFocusPS; RenderTarget = PolygonalBokehFocusBefore;"]
    for number, item in enumerate(methods.plan(settings, SIZE).passes):
        shader = "MapPS"
        if item.entry != plan.SIGNED_MAP:
            shader = f"{method.title()}{item.entry.removeprefix('Bokeh')}{number}PS"
            bodies += [*_shader(shader, item, names, planned["result"]), ""]
        # the result is the screen
        written = [names[name] for name in item.outputs if name != planned["result"]]
        scales |= {name: item.scale for name in written}
        targets = " ".join(f"RenderTarget{index} = PolygonalBokeh{name};" for index, name in enumerate(written))
        passes.append(f"{shader}; {targets}".rstrip())
    for name, scale in scales.items():
        width, height = (f"(BUFFER_{side} + {scale - 1}) / {scale}" for side in ("WIDTH", "HEIGHT"))
        yield f"texture PolygonalBokeh{name} {{ Width = {width}; Height = {height}; Format = RGBA16F; }};"
        yield f"sampler {name} {{ Texture = PolygonalBokeh{name}; AddressU = CLAMP; AddressV = CLAMP; }};"
    yield from ("", *bodies)
    yield from (f'technique {title} < ui_tooltip = "{tip}"; >', "{")
    yield from (f"    pass {{ {VERTEX}; PixelShader = {line} }}" for line in passes)
    yield "}"


def _shader(name: str, item: Pass, names: dict[str, str], result: str) -> Iterator[str]:
    call = samples.call(item, names).replace("vec2(", "float2(")
    shown = item.outputs == (result,)
    outs = ["color"] if shown else [f"target{index}" for index in range(len(item.outputs))]
    parameters = "".join(f", out float4 {out} : SV_Target{index}" for index, out in enumerate(outs))
    yield f"void {name}(float4 position : SV_Position, float2 uv : TEXCOORD{parameters})"
    yield "{"
    yield from (f"    {text}" for local, text in LOCALS.items() if re.search(rf"\b{local}\b", call))
    kind, *members = samples.returned(item) or ("",)
    if shown:
        yield f"    color = {call};"
        yield "    color = float4(Compressed(color.rgb), 1.0);"
    elif members and len(outs) > 1:
        yield f"    {kind} targets = {call};"
        yield from (f"    {out} = targets.{member};" for out, member in zip(outs, members, strict=True))
    else:
        yield f"    target0 = {call};"
    yield "}"
