"""Draw small frames that together reach every entry, switch and branch of the shaders.

`check` draws those that an edit can have broken; `mutants` tests that they reveal mistakes.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from bokeh_validation.frame import methods
from bokeh_validation.frame.methods import Camera, Settings
from bokeh_validation.probes import cases, near_edges
from bokeh_validation.probes.cases import EXACT, FOCUS, LAYERED, WIDE, WIDEST
from bokeh_validation.probes.judges import Frame
from bokeh_validation.probes.model import flat
from bokeh_validation.reference import listings
from bokeh_validation.shaders.passes import Pass

SIZE, LAYERED_SIZE = (45, 29), (75, 50)
# An image inside larger textures, away from their middle
PART_SIZE, TEXTURES, CORNER = (48, 37), (89, 73), (24, 8)
HOSTILE_DEPTH = (np.nan, np.inf, -np.inf, -1e30, -2.0, 1e30, 1e9, 0.0, 1.0)


def all_frames() -> dict[str, Frame]:
    """Return label -> frame, for every kind of frame below."""
    plain = {label: of_settings(settings) for label, settings in cases.tagged(cases.COVERAGE).items()}
    in_parts = cases.tagged(cases.PART)
    parts = {f"{label}, part": in_part(of_settings(settings, PART_SIZE)) for label, settings in in_parts.items()}
    return {**dict(_inputs()), **dict(_steady()), **plain, **parts, **dict(_layers()), **dict(_values())}


def noise(size: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Return random patches of HDR colour (H, W, 4) float16 and depth (H, W) float32; every comparison
    goes both ways.
    """
    random, (width, height) = np.random.default_rng(1), size
    coarse = random.lognormal(0.0, 1.0, (height // 6 + 2, width // 6 + 2, 4))
    # CoC values are uniform in 1 / depth
    coarse[..., 3] = 1.0 / random.uniform(0.033, 0.8, coarse.shape[:2])
    # the outermost patches are cropped, so that the blur of the next ones reaches beyond the image
    patches = np.kron(coarse, np.ones((6, 6, 1)))[4 : 4 + height, 4 : 4 + width]
    color = patches + 0.1 * random.random(patches.shape)
    color[..., 3] = 1.0
    return color.astype(np.float16), patches[..., 3].astype(np.float32)


def of_settings(settings: Settings, size: tuple[int, int] | None = None) -> Frame:
    """Return a frame of noise, with some invalid depth if the method's passes read depth themselves."""
    size = size or (LAYERED_SIZE if settings.method == "layered" else SIZE)
    color, depth = noise(size)
    if settings.method not in ("exact", "layered"):
        depth[::7, ::8] = np.resize(np.float32(HOSTILE_DEPTH), depth[::7, ::8].shape)
    plan = methods.plan(settings, size)
    return Frame(plan.passes, {"color": color, "depth": depth, **plan.tables}, size)


def in_part(frame: Frame) -> Frame:
    """Return the frame with its image inside larger textures of NaN; a kernel remains a table."""

    def framed(image: np.ndarray) -> np.ndarray:
        canvas = np.full((TEXTURES[1], TEXTURES[0], *image.shape[2:]), np.nan, image.dtype)
        canvas[CORNER[1] : CORNER[1] + image.shape[0], CORNER[0] : CORNER[0] + image.shape[1]] = image
        return canvas

    area = (*CORNER, *frame.size)
    plan = methods.in_viewport(methods.Plan(frame.passes, {}), area, TEXTURES)
    textures = {name: image if name == "kernel" else framed(image) for name, image in frame.textures.items()}
    return replace(frame, passes=plan.passes, textures=textures, size=TEXTURES, area=area)


# Invalid and valid values; powers of two, whose differences float32 represents exactly
DEPTHS = (0.0625, 0.5, 2.0, 3.0, 4.0, 5.0, 8.0, 1024.0, np.inf, 1e30, 1e9, 1e-30, 0.0, -1.0, -np.inf, np.nan)
COLORS = (np.nan, np.inf, -np.inf, -1.0, -65504.0, -0.0, 6e-8, 65504.0, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0)
LENS = Camera(0.0625, 0.0625, 4.0, sensor_height=0.03125, max_coc=0.25)
# How many times as bright as the plane lights are, around the limit from which the rim of one is blurred
RIM_LIGHTS = (60.0, 72.0, 96.0, 120.0, 300.0)
CAMERAS = {
    "lens": LENS,
    "pinhole": replace(LENS, max_coc=0.0),
    "focus at infinity": replace(LENS, focus_distance=float("inf"), max_coc=1.0),
    "focus in the lens": replace(LENS, aperture_diameter=2.0**-22, focus_distance=0.0625, max_coc=1.0),
    "no sensor": replace(LENS, aperture_diameter=2.0**-20, sensor_height=0.0, max_coc=1.0),
}


def _inputs() -> Iterator[tuple[str, Frame]]:
    """Yield frames of the CoC maps, of depth of every kind and of the debug views, with invalid values in each."""
    size = (len(COLORS), 4)
    color = flat(size, 1.0)
    for channel in range(3):
        color[channel, :, channel] = COLORS
    textures = {"color": color, "depth": np.tile(np.float32(DEPTHS), (4, 1))}
    read = {"ColorSamp": "color", "DepthSamp": "depth"}
    for label, camera in CAMERAS.items():
        maps = [Pass(entry, read, entry, camera.parameters()) for entry in ("BokehCoCMap", "BokehSignedCoCMap")]
        yield f"map, {label}", Frame(tuple(maps), textures, size)
    # near lights of different brightness over a dark plane in focus, each with a rim that has the plane's depth
    lights = np.array([[1.0, 4.0, times] for times in RIM_LIGHTS]).ravel()
    near = np.array([[4.0, 4.0, 0.5] for _ in RIM_LIGHTS]).ravel()
    lit = {"color": flat((len(lights), 16), 1.0), "depth": np.tile(near.astype(np.float32), (16, 1))}
    lit["color"][..., :3] = lights[:, None] / 16.0
    parameters = {**LENS.parameters(), "BokehImageWidth": float(len(lights)), "BokehImageHeight": 16.0}
    yield "map, near lights", Frame((replace(maps[1], parameters=parameters),), lit, (len(lights), 16))
    # a debug view with a CoC above its BokehMaxCoC, and one at half of the value that replaces a BokehMaxCoC of 0
    for label, largest, max_coc in (("lens", 0.25, 0.125), ("pinhole", 2.0**-21, 0.0)):
        camera = replace(LENS, max_coc=largest).parameters()
        passes = [Pass("BokehSignedCoCMap", read, "coc", camera)]
        for mode in range(4):
            parameters = {**camera, "BokehMaxCoC": max_coc, "BokehDebugMode": float(mode)}
            passes.append(Pass("BokehDebug", {**read, "ColorSamp": "coc"}, f"view {mode}", parameters))
        views = Frame(tuple(passes), textures, size, "float")
        yield f"views, {label}", views
    # a view of depth, which is fetched texel by texel
    yield "view, part", in_part(replace(views, passes=(views.passes[0], views.passes[2])))
    for name, kind in listings.DEPTH_KINDS.items():
        metres = np.geomspace(0.11, 190.0, 40).reshape(4, 10)
        stored = np.concatenate([listings.stored_depth(metres, kind, 0.1, 200.0), np.resize(HOSTILE_DEPTH, (2, 10))])
        parameters = {"BokehDepthKind": float(kind), "BokehNear": 0.1, "BokehFar": 200.0}
        render_pass = Pass("BokehLinearDepth", {"DepthSamp": "depth"}, "metres", parameters)
        frame = Frame((render_pass,), {"depth": stored.astype(np.float32)}, (10, 6), "float")
        yield f"depth, {name}", frame
    yield "depth, part", in_part(frame)
    # opacity below, at and above a half, and invalid; metres times opacity
    opacity = np.resize(np.float32([0.25, 0.5, 0.75, 1.0, *HOSTILE_DEPTH]), (6, 10))
    with np.errstate(over="ignore", invalid="ignore"):
        weighted = np.stack([stored.astype(np.float32) * opacity, opacity, *np.zeros((2, 6, 10), np.float32)], axis=-1)
    render_pass = replace(render_pass, parameters={"BokehDepthKind": float(listings.WEIGHTED)})
    yield "depth, weighted", Frame((render_pass,), {"depth": weighted}, (10, 6), "float")
    # the image covers a part of the depth buffer, with different fractions of its width and height
    rectangle = {"BokehDepthX": 0.5, "BokehDepthY": 0.25, "BokehDepthWidth": 0.5, "BokehDepthHeight": 0.25}
    render_pass = Pass("BokehSignedCoCMap", read, "coc", LENS.parameters() | FOCUS.parameters() | rectangle)
    depth_buffer = np.geomspace(3.0, 7.0, 4 * 2 * textures["depth"].size).reshape(4 * size[1], -1).astype(np.float32)
    yield "map, depth in a part", Frame((render_pass,), {**textures, "depth": depth_buffer}, size)


def _steady() -> Iterator[tuple[str, Frame]]:
    """Yield frames of the stabilised map: velocities of a fraction of a pixel, from outside the image, NaN or
    infinite, and different blends.
    """
    random, (width, height) = np.random.default_rng(3), SIZE
    velocity, history = np.zeros((2, height, width, 4), np.float16)
    velocity[..., :2] = random.uniform(-3.0, 3.0, (height, width, 2)) / SIZE
    velocity[:, ::9, 0] = 0.4
    velocity[2::5, ::4, 0], velocity[3::5, ::4, 1] = np.nan, -np.inf
    history[..., 3] = random.uniform(-0.25, 0.25, (height, width))
    for blend in (0.0, 1.0, 3.0, -1.0, 0.25):
        frame = of_settings(EXACT)
        # CoC below one pixel behind the focus
        frame.textures["color"][:, ::3, :3] = 0.0
        passes = methods.steadied(methods.Plan(frame.passes, {}), SIZE, blend).passes[:2]
        frame = replace(frame, passes=passes, textures={**frame.textures, "velocity": velocity, "history": history})
        yield f"steady, {blend}", frame
    yield "steady, part", in_part(frame)


# CoC in pixels of objects in focus, and of their surroundings: a wide blur; a far layer that only just exists; and
# pixels outside all layers with the CoC from which the gather has an additional ring
OUTLINES = {
    "wide blur": (0.0, 0.8, -1.6, 18.0, 20.0),
    "small layer": (0.0, 0.5, 10.3, 10.7),
    "wide gather": (0.0, 0.9, 11.3, 11.7, 28.0),
}


def _outlines(cocs: tuple[float, ...]) -> Frame:
    """Return a frame of patches with these CoC in pixels, antialiased colour, and bright and dark patches."""
    frame = of_settings(replace(LAYERED, camera=near_edges.CAMERA), (64, 48))
    random = np.random.default_rng(6)
    # three by three samples in a pixel, and patches of 5 1/3 by 5 1/3 pixels
    patches = np.kron(random.integers(0, len(cocs), (9, 12)), np.ones((16, 16), int))
    colors = random.lognormal(0.0, 1.0, (9, 12, 3)) * random.choice((0.02, 1.0, 10.0), (9, 12, 3))
    colors = np.kron(colors, np.ones((16, 16, 1)))
    # the tint makes some pixels no mixture of those beside them
    tint = random.choice((0.1, 1.0), (48, 64, 3)) ** (random.random((48, 64, 1)) < 0.5)
    frame.textures["color"][..., :3] = colors.reshape(48, 3, 64, 3, 3).mean(axis=(1, 3)) * tint
    depth = np.vectorize(near_edges.metres)(np.array(cocs)[patches[1::3, 1::3]], 48).astype(np.float32)
    return replace(frame, textures={**frame.textures, "depth": depth})


def _layers() -> Iterator[tuple[str, Frame]]:
    """Yield frames of layered: planes partly in a layer or in none, near over far, black next to bright, many tiles,
    one pixel.
    """
    frame = of_settings(replace(LAYERED, camera=near_edges.CAMERA), (50, 40))
    ragged = np.random.default_rng(2).uniform(-16.0, 20.0, (40, 50))
    planes = {f"plane, {coc}": np.full((40, 50), coc) for coc in (11.0, 14.0)}
    # there is no layer, so the gather takes an additional ring
    planes["moderate"] = np.random.default_rng(5).uniform(4.0, 9.0, (40, 50))
    planes["near over far"] = np.tile(np.where(abs(np.arange(50.0) - 25.0) < 2.0, -20.0, 18.0), (40, 1))
    # each ring has the CoC that covers the middle pixel most; together they cover it more than completely
    y, x = np.mgrid[-20.0:20.0, -25.0:25.0] % 12.0 - 6.0
    planes["cones"] = -np.where(np.hypot(y, x) > 0.0, np.minimum(np.hypot(y, x) * 2.0 + 1.0, 5.0), 0.0)
    for label, cocs in (planes | {"ragged": ragged, "ragged, near": np.minimum(ragged, 0.0)}).items():
        depth = np.vectorize(near_edges.metres)(cocs, 40).astype(np.float32)
        yield label, replace(frame, textures={**frame.textures, "depth": depth})
    # LOW beside near objects only; and rings by a loop, of which the last, of few samples, lies in both layers' reach
    wider = np.random.default_rng(7).uniform(-30.0, 14.0, (40, 50))
    for label, cocs, changes in (
        ("ragged, near, low", np.minimum(ragged, 0.0), {"preset": "low"}),
        ("ragged, wider, cut", wider, {"cats_eye": 0.5}),
    ):
        frame = of_settings(replace(LAYERED, camera=near_edges.CAMERA, **changes), (50, 40))
        depth = np.vectorize(near_edges.metres)(cocs, 40).astype(np.float32)
        yield label, replace(frame, textures={**frame.textures, "depth": depth})
    for label, cocs in OUTLINES.items():
        yield f"outlines, {label}", _outlines(cocs)
    frame = _outlines(OUTLINES["wide blur"])
    without = {"BOKEH_LAYER_OUTLINES": 0}
    passes = (replace(render_pass, defines=render_pass.defines | without) for render_pass in frame.passes)
    yield "outlines, off", replace(frame, passes=tuple(passes))
    frame = of_settings(replace(LAYERED, **WIDE), (64, 48))
    frame.textures["color"][:, :32, :3] = 0.0
    frame.textures["color"][3::9, 36::7, :3] = 60000.0
    yield "black and bright", frame
    # random offsets along a layer's edge show, and a BokehSides that nobody has set means a hexagon
    frame = of_settings(replace(LAYERED, preset="low", use_mrt=False, **WIDEST), (75, 50))
    passes = (
        replace(render_pass, parameters={**render_pass.parameters, "BokehSides": 0.0}) for render_pass in frame.passes
    )
    yield "layered, sides unset, one target", replace(frame, passes=tuple(passes))
    # a CoC of 98 pixels spreads over 12 tiles; the quarter layer is read, whose size is not exactly half of the
    # layer's
    yield "large", of_settings(replace(LAYERED, **WIDEST), (130, 98))
    yield "layered, one pixel", of_settings(replace(LAYERED, **WIDE), (1, 1))
    # CoC no larger than pixels and the linear filter resolve: the layer is copied, not blurred
    frame = of_settings(replace(LAYERED, **WIDE), (64, 48))
    *_, first, second, _ = frame.passes
    random = np.random.default_rng(4)
    textures = {name: random.random((24, 32, 4)).astype(np.float16) for name in first.inputs.values()}
    textures |= {name: textures[name][::2, ::2] for name in ("near quarter", "far quarter")}
    textures["layer coc"] = np.full((6, 8, 4), 4.0, np.float16)
    yield "layered, not blurred", replace(frame, passes=(first, second), textures=textures)


# Library functions that no entry calls, and values that no device can be given
SINE = float(np.sin(np.pi / 8.0))
DECLARED = (
    "vec2 end = vec2(0.25, 0.5); BokehSamplingSettings plain = BokehDefaultSampling(vec2(64.0, 32.0));"
    "BokehPolygon polygon = BokehMakePolygon(8, 0.5, 0.75);"
    "BokehLayerContext layers = BokehMakeLayerContext(vec2(0.25, 0.75), vec2(64.0, 48.0), 0.25);"
    "BokehLens lens = BokehMakeLens(0.03, 0.05, 2.0);"
    "BokehLens open = BokehMakeLens(0.2, 0.05, 2.0); open.maxCoC = 1.0;"
    "BokehSetViewport(vec4(0.0, 0.0, 1.0, 8.0), vec2(16.0, 16.0));"
    "BokehPolygon square = BokehWithRoundness(polygon, 0.0); BokehPolygon curved = BokehWithRoundness(polygon, 0.5);"
    "BokehPolygon uncut = BokehWithCatsEye(BokehWithRoundness(polygon, 0.004), end, vec2(64.0, 32.0), 0.0);"
    "BokehBlur wide = BokehLayerBlur(vec2(0.0, 60.0), true, polygon);"
    "BokehBlur wideSquare = BokehLayerBlur(vec2(150.0, 0.0), false, BokehMakePolygon(4, 0.0, 1.0));"
)
SAMPLES = methods.PRESETS[LAYERED.preset][1]
# The CoC of `open` at the planes of the calls below. Row 1 is a light next to row 0, which is black. With reversed
# depth the light is at the near plane, so row 0 at the far plane takes its CoC. Otherwise the light is farther away
# and row 0 keeps its own.
LIGHT_COC, OWN_COC = (
    float(np.sign(depth - 2.0) * listings.circle_of_confusion(depth, 0.2, 0.05, 2.0, 0.024, 1.0))
    for depth in (0.5, 8.0)
)
MAP = "BokehSignedCoCMap(BokehColorSamp, BokehDepthSamp, {0}, BokehToTexture({0}), {1}, open, {2}, vec2(0.5, 8.0)).a"
VALUES = {
    MAP.format("vec2(0.5, 0.03125)", "vec2(16.0, 16.0)", 2): LIGHT_COC,
    MAP.format("vec2(0.5, 0.03125)", "vec2(16.0, 16.0)", 1): LIGHT_COC,
    **{"plain.aspectRatio": 2.0, "plain.imageHeight": 32.0, "plain.spacing": 1.5, "plain.jitter": 0.0},
    **{"plain.bleedingBias": 0.02, "plain.bleedingMult": 30.0, "BokehMakeOffsets(end, 0, 1).x": -0.25},
    **{"BokehMakeOffsets(end, 0, 1).y": -0.5, "BokehMakeOffsets(end, 2, 5).x": 0.0},
    **{"BokehMakeOffsets(end, 4, 5).y": 0.5, "lens.sensorHeight": 0.024, "lens.maxCoC": 0.1},
    **{"lens.apertureDiameter": 0.03, "lens.focalLength": 0.05, "lens.focusDistance": 2.0},
    **{"polygon.lengths.x": SINE, "polygon.lengths.w": SINE, "polygon.fifth": SINE, "polygon.squeeze": 0.75},
    **{"layers.jitter": 0.0, "layers.largest": 12.0, "layers.origin.x": 0.0, "layers.texel.y * 48.0": 1.0},
    **{"layers.uv.x": 0.25, "layers.uv.y": 0.75, "layers.size.x": 64.0, "BokehFullGrid(layers).size.y": 48.0},
    # a position on the border, an invalid number of sides, and edges of zero and almost zero length
    **{"BokehFetchTexel(BokehColorSamp, vec2(1.0, 1.0)).r": 15.0, "BokehAnyAperture(end).sides": 10.0},
    **{"square.lengths.x": 0.001, "uncut.lengths.x": float(np.sin(np.pi / 2000.0))},
    # far layers read the quarter layer from a spacing of 1.15 on
    **{"wide.useQuarterLayer": 1.0, "wide.spacing": 15.0 / SAMPLES, "wide.sideTap": 0.0},
    # what the layer's size and the quarter size blur already: at most 22, and 14
    "wide.CoC": float(np.sqrt(30.0**2 - 22.0 - 14.0)),
    "wideSquare.sideTap": 0.25 * 0.354 * 75.0 / SAMPLES - 0.2,
    "curved.area": float(np.sin(np.pi / 8.0) + np.sin(np.pi * 3.0 / 8.0)) / 2.0,
}
# an image of one texel has no room for the inset
IN_A_PART = {
    # 8 pixels high: the light is in front of the focus and the pixel behind it, so its CoC is taken from 1.5 pixels on
    MAP.format("vec2(0.5, 0.0625)", "vec2(1.0, 8.0)", 2): LIGHT_COC if 8.0 * OWN_COC >= 1.5 else OWN_COC,
    # taller, the light's CoC is taken completely; its depth lies in the next row
    MAP.format("vec2(0.5, 0.1)", "vec2(1.0, 16.0)", 2): LIGHT_COC,
    "layers.origin.x": 0.0,
    "BokehViewportBounds.x": 0.03125,
    "BokehGridCoords(vec2(0.25, 0.25), BokehFullGrid(BokehMakeLayerContext(end, vec2(1.0, 1.0), 0.25))).y": 0.5,
    "BokehSignedCoCMap(BokehColorSamp, BokehDepthSamp, end, end, end, lens, 0, end).r": 4.0,
}


def _values() -> Iterator[tuple[str, Frame]]:
    """Yield a row of pixels with one expression each, and its expected value; every texel holds the
    number of its row.
    """
    rows = np.repeat(np.arange(16.0), 16).reshape(16, 16).astype(np.float32)
    textures = {"color": np.stack([rows] * 4, axis=-1), "depth": rows}
    read = {"ColorSamp": "color", "DepthSamp": "depth"}
    for label, defines, values in (
        ("values", {}, VALUES),
        ("values in a part", {"BOKEH_VIEWPORT": 1}, IN_A_PART),
    ):
        listed = ", ".join(f"float({name})" for name in values)
        main = f"{DECLARED} float values[] = float[]({listed}); float value = values[int(gl_FragCoord.x)];"
        main += " BokehResult = vec4(value, value, value, value);"
        expected = np.repeat([[[value] for value in values.values()]], 4, axis=2)
        render_pass = Pass("BokehSignedCoCMap", read, "result", {"BokehSides": 12.0}, defines=defines)
        size = len(values), 1
        yield label, Frame((render_pass,), textures, size, "float", expected={"result": expected}, main=main)
