"""The small frames that mutants are judged by: every pass of every method, and every switch away from its default."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from bokeh_validation import shaders
from bokeh_validation.frame import methods
from bokeh_validation.frame.methods import Camera, Settings
from bokeh_validation.probes import near_edges
from bokeh_validation.probes.model import depth_of, flat
from bokeh_validation.reference import listings
from bokeh_validation.reference.device import Reference
from bokeh_validation.shaders.passes import Pass

Area = tuple[int, int, int, int]
SIZE = (45, 29)
# Larger textures, and where an image is in them: not in the middle; they have no size by which a texel less is none
TEXTURES, CORNER = (89, 73), (24, 8)
ALL = {
    "rotation": 17.0,
    "squeeze": 0.7,
    "bleeding_bias": 0.03,
    "bleeding_mult": 30.0,
    "camera": Camera(0.12, 0.05, 4.0, sensor_height=0.02, max_coc=0.25),
}
# Every program is compiled for its constants: as few of them as will do
FEW = {"spacing": 1.5, "jitter": 1.0, "frame": 61}
CUT = {"cats_eye": 0.7, "roundness": 0.5}
AXIAL = {"axial": (0.05, -0.03), **CUT, **FEW}
WIDE = {"camera": Camera(1.8, 0.05, 8.0, max_coc=0.5)}  # near and far layers of up to 25 pixels of 50
WIDEST = {"camera": Camera(1.8, 0.05, 8.0, max_coc=1.0)}
PAPER, EXACT = Settings("paper", "hexagon", 5, **ALL), Settings("exact", "hexagon", 5, **ALL)
LAYERED = Settings("layered", "hexagon", 5, jitter=0.5, frame=3, **ALL)
SETTINGS = {
    "paper pentagon": replace(PAPER, aperture="pentagon", **FEW),
    "paper triangle": replace(PAPER, aperture="triangle", blur_coc=False, **FEW),
    "paper star, few": replace(PAPER, aperture="star", **FEW),
    "paper hexagon": PAPER,
    "paper star": replace(PAPER, aperture="star", blur_coc=False),
    "naive": replace(PAPER, method="naive", aperture="triangle", samples=6),
    "naive, many": replace(PAPER, method="naive", aperture="square", samples=12),
    "naive grid": replace(PAPER, method="naive-grid", aperture="square"),
    **{f"exact {name}": replace(EXACT, aperture=name, **FEW) for name in methods.EXACT},
    **{f"exact {name}, axial": replace(EXACT, aperture=name, **AXIAL) for name in methods.EXACT},
    "exact decagon, one target": replace(EXACT, aperture="decagon", targets=False, **FEW),
    "exact hexagon, one target": replace(EXACT, targets=False, **FEW),
    "exact octagon, cut": replace(EXACT, aperture="octagon", **CUT),
    "exact octagon, cut too far": replace(EXACT, aperture="octagon", cats_eye=5.0, roundness=-1.0),
    "exact decagon, axial, one target": replace(EXACT, aperture="decagon", targets=False, **AXIAL),
    "exact decagon, fixed": replace(EXACT, aperture="decagon"),
    "lateral": replace(EXACT, lateral=0.02),
    "lateral, too much": replace(EXACT, lateral=5.0),
    "lateral, too little": replace(EXACT, lateral=-5.0),
    "constant CoC": replace(PAPER, coc=0.2),
    "constant CoC, too large": replace(PAPER, coc=0.4),
    "constant CoC, negative": replace(EXACT, coc=-0.1),
    **{f"layered {name}": replace(LAYERED, aperture=name) for name in methods.EXACT},
    "layered, wide": replace(LAYERED, jitter=1.0, **WIDE),
    "layered, low": replace(LAYERED, aperture="decagon", preset="low", **WIDE),
    "layered, ultra": replace(LAYERED, aperture="octagon", preset="ultra", targets=False, **WIDE),
    "layered, widest": replace(LAYERED, aperture="square", preset="low", **WIDEST),
    "layered, cut": replace(LAYERED, aperture="octagon", **CUT, **WIDE),
    "layered decagon, cut": replace(LAYERED, aperture="decagon", cats_eye=0.9, **WIDE),
    "layered, cut, one target": replace(LAYERED, aperture="decagon", targets=False, cats_eye=0.9, **WIDE),
}
IN_PART = ("paper pentagon", "paper hexagon", "naive", "naive grid", "exact decagon", "exact decagon, one target")
IN_PART += ("lateral", "constant CoC", "layered hexagon", "layered, cut")


@dataclass(frozen=True)
class Frame:
    """Passes to draw, with what they read.

    area  the viewport, where the image is a part of its textures
    told  output -> what must be in it, (H, W, 4), in place of the reference's interval
    main  body of a main function in place of the entry's
    """

    passes: tuple[Pass, ...]
    textures: Mapping[str, np.ndarray]
    size: tuple[int, int]
    storage: str = "half"
    area: Area | None = None
    told: Mapping[str, np.ndarray] = field(default_factory=dict)
    main: str = ""


def noise(size: tuple[int, int], seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Random HDR colour (H, W, 4) float16 and depth (H, W) float32 in patches: every comparison goes both ways."""
    random, (width, height) = np.random.default_rng(seed), size
    coarse = random.lognormal(0.0, 1.0, (height // 6 + 2, width // 6 + 2, 4))
    # CoC are even in 1 / depth
    coarse[..., 3] = 1.0 / random.uniform(0.033, 0.8, coarse.shape[:2])
    # the outermost are narrow, so that a blur from the next one leaves the image
    patches = np.kron(coarse, np.ones((6, 6, 1)))[4 : 4 + height, 4 : 4 + width]
    color = patches + 0.1 * random.random(patches.shape)
    color[..., 3] = 1.0
    return color.astype(np.float16), patches[..., 3].astype(np.float32)


def of_settings(settings: Settings, size: tuple[int, int] = SIZE) -> Frame:
    """A frame of noise."""
    color, depth = noise(size)
    plan = methods.plan(settings, size)
    return Frame(plan.passes, {"color": color, "depth": depth, **plan.tables}, size)


def in_part(frame: Frame) -> Frame:
    """The same image within larger textures of NaN; a kernel is a table of its own."""

    def framed(image: np.ndarray) -> np.ndarray:
        whole = np.full((TEXTURES[1], TEXTURES[0], *image.shape[2:]), np.nan, image.dtype)
        whole[CORNER[1] : CORNER[1] + image.shape[0], CORNER[0] : CORNER[0] + image.shape[1]] = image
        return whole

    plan = methods.in_viewport(methods.Plan(frame.passes, {}), (*CORNER, *frame.size), TEXTURES)
    textures = {name: image if name == "kernel" else framed(image) for name, image in frame.textures.items()}
    told = {name: framed(image) for name, image in frame.told.items()}
    return replace(frame, passes=plan.passes, textures=textures, size=TEXTURES, area=(*CORNER, *frame.size), told=told)


def all_frames() -> dict[str, Frame]:
    """Label -> frame."""
    plain = {
        label: of_settings(settings, (75, 50) if settings.method == "layered" else SIZE)
        for label, settings in SETTINGS.items()
    }
    parts = {f"{label}, part": in_part(of_settings(SETTINGS[label], (48, 37))) for label in IN_PART}
    return {**dict(_inputs()), **dict(_edges()), **dict(_functions()), **parts, **plain, **dict(_layers())}


# What no renderer should hand over, and what it should; powers of two, of which float32 has the differences
DEPTHS = (0.0625, 0.5, 2.0, 3.0, 4.0, 5.0, 8.0, 1024.0, np.inf, 1e30, 1e9, 1e-30, 0.0, -1.0, -np.inf, np.nan)
COLORS = (np.nan, np.inf, -np.inf, -1.0, -65504.0, -0.0, 6e-8, 65504.0, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0)
LENS = Camera(0.0625, 0.0625, 4.0, sensor_height=0.03125, max_coc=0.25)
CAMERAS = {
    "lens": LENS,
    "pinhole": replace(LENS, max_coc=0.0),
    "focus at infinity": replace(LENS, focus_distance=float("inf"), max_coc=1.0),
    "focus in the lens": replace(LENS, aperture_diameter=2.0**-22, focus_distance=0.0625, max_coc=1.0),
    "no sensor": replace(LENS, aperture_diameter=2.0**-20, sensor_height=0.0, max_coc=1.0),
}


def _inputs() -> Iterator[tuple[str, Frame]]:
    """CoC maps, depth of every kind and the debug views, with what is hostile in each."""
    size = (len(COLORS), 4)
    color = flat(size, 1.0)
    for channel in range(3):
        color[channel, :, channel] = COLORS
    textures = {"color": color, "depth": np.tile(np.float32(DEPTHS), (4, 1))}
    read = {"ColorSamp": "color", "DepthSamp": "depth"}
    for label, camera in CAMERAS.items():
        maps = [Pass(entry, read, entry, camera.parameters()) for entry in ("BokehCoCMap", "BokehSignedCoCMap")]
        yield f"map, {label}", Frame(tuple(maps), textures, size)
    # a view of what is larger than its MaxCoC, and of half of what a MaxCoC of 0 is taken for
    for label, largest, most in (("lens", 0.25, 0.125), ("pinhole", 2.0**-21, 0.0)):
        camera = replace(LENS, max_coc=largest).parameters()
        passes = [Pass("BokehSignedCoCMap", read, "coc", camera)]
        for mode in range(4):
            parameters = {**camera, "BokehMaxCoC": most, "BokehDebugMode": float(mode)}
            passes.append(Pass("BokehDebug", {**read, "ColorSamp": "coc"}, f"view {mode}", parameters))
        views = _told(tuple(passes), textures, size)
        yield f"views, {label}", views
        # depth alone is read texel by texel
        yield f"view of a part, {label}", in_part(replace(views, told={"view 1": views.told["view 1"]}))
    for name, kind in listings.DEPTH_KINDS.items():
        metres = np.geomspace(0.11, 190.0, 40).reshape(4, 10)
        stored = np.concatenate([listings.stored_depth(metres, kind, 0.1, 200.0), np.resize(HOSTILE, (2, 10))])
        parameters = {"BokehDepthKind": float(kind), "BokehNear": 0.1, "BokehFar": 200.0}
        item = Pass("BokehLinearDepth", {"DepthSamp": "depth"}, "metres", parameters)
        metres = _told((item,), {"depth": stored.astype(np.float32)}, (10, 6))
        yield f"depth, {name}", metres
        yield f"depth of a part, {name}", in_part(metres)


HOSTILE = (np.nan, np.inf, -np.inf, -1e30, -2.0, 1e30, 1e9, 0.0, 1.0)


def _told(passes: tuple[Pass, ...], textures: Mapping[str, np.ndarray], size: tuple[int, int]) -> Frame:
    """What the reference computes, where it has no interval."""
    names = [name for item in passes for name in item.outputs]
    return Frame(passes, textures, size, "float", told=Reference().run(passes, textures, size, "float", names))


def _edges() -> Iterator[tuple[str, Frame]]:
    """Where a method turns from one thing into another: no sample left, half a pixel, no length, the last frame."""
    for around in (2.0, 1.9998):
        color, depth = flat((16, 8), 9.0), depth_of((16, 8), around)
        color[4, 8, :3], depth[4, 8] = 0.5, 50.0
        settings = Settings("naive-grid", "square", 2, camera=Camera(0.3, 0.05, 2.0, max_coc=1.0))
        yield f"rejected, {around}", replace(of_settings(settings, (16, 8)), textures={"color": color, "depth": depth})
    for method in ("paper", "exact"):
        for pixels in (0.3, 0.5, 1.0):
            near = Settings(
                method, samples=65, spacing=0.1, leak_fix=False, camera=Camera(max_coc=1.0), coc=pixels / 32.0
            )
            yield f"{method}, {pixels} pixels", of_settings(near, (64, 32))
        for aperture in ("hexagon", "decagon" if method == "exact" else "square"):
            far = Settings(method, aperture, coc=0.5, camera=Camera(max_coc=1.0), samples=5, spacing=1.0, jitter=1.0)
            for frame in (5, 2**22 + 5):
                yield f"{method} {aperture}, frame {frame}", of_settings(replace(far, frame=frame), (61, 48))
            dense = replace(far, samples=65, squeeze=0.3, rotation=20.0)
            yield f"{method} {aperture}, dense", of_settings(dense, (61, 48))
    for method in ("paper", "adaptive", "naive", "naive-grid"):
        more = FEW if method == "adaptive" else {}
        frame = of_settings(replace(PAPER, method=method.replace("adaptive", "paper"), aperture="square", **more))
        depth = frame.textures["depth"]
        depth[::3, ::4] = np.resize(np.float32(HOSTILE), depth[::3, ::4].shape)
        yield f"hostile depth, {method}", frame
    color, depth = noise((64, 32))
    first = Pass("BokehConstantCoC", {"ColorSamp": "color"}, "coc", {"BokehConstantCoC": 0.25, "BokehMaxCoC": 1.0})
    line = {"BokehAspectRatio": 2.0, "BokehImageWidth": 64.0, "BokehImageHeight": 32.0, "BokehSpacing": 1.0}
    line |= {"BokehLineLength": 0.0, "BokehLineCenterX": 0.5, "BokehLineCenterY": -0.25}
    adaptive = Pass("BokehAdaptive", {"ColorSamp": "coc", "DepthSamp": "depth"}, "result", line)
    yield "line of no length", Frame((first, adaptive), {"color": color, "depth": depth}, (64, 32))
    column = np.zeros((8, 8, 4), np.float16)
    column[1:6, 3] = 1.0
    plan = methods.plan(Settings("exact", "square", coc=0.5, camera=Camera(max_coc=1.0)), (1, 5))
    plan = methods.in_viewport(plan, (3, 1, 1, 5), (8, 8))
    # there is no room for the inset: it is the image alone where what is around is black and not NaN
    told = {"result": column.astype(float) * [1.0, 1.0, 1.0, 0.5]}
    yield "column", Frame(plan.passes, {"color": column, "depth": depth_of((8, 8), 1.0)}, (8, 8), told=told)


def _layers() -> Iterator[tuple[str, Frame]]:
    """Planes that are partly in a layer, black beside bright, and images that fill few texels of an eighth."""
    frame = of_settings(replace(LAYERED, camera=near_edges.CAMERA), (50, 40))
    ragged = np.random.default_rng(2).uniform(-16.0, 20.0, (40, 50))
    planes = {f"plane, {coc}": np.full((40, 50), coc) for coc in (-11.0, -9.0, 11.0, 14.0)}
    for label, cocs in (planes | {"ragged": ragged, "ragged, near": np.minimum(ragged, 0.0)}).items():
        depth = np.vectorize(near_edges.metres)(cocs, 40).astype(np.float32)
        yield label, replace(frame, textures={**frame.textures, "depth": depth})
    frame = of_settings(replace(LAYERED, **WIDE), (64, 48))
    frame.textures["color"][:, :32, :3] = 0.0
    frame.textures["color"][3::9, 36::7, :3] = 60000.0
    yield "black and bright", frame
    passes = (replace(item, defines={**item.defines, "BOKEH_ADAPTIVE_SAMPLES": 0}) for item in frame.passes)
    yield "jitter of a fixed number", replace(frame, passes=tuple(passes))
    # a CoC of 96 pixels spreads over 12 tiles
    yield "large", of_settings(replace(LAYERED, **WIDEST), (128, 96))
    for size in ((1, 1), (96, 2)):
        yield f"layered {size}", of_settings(replace(LAYERED, **WIDE), size)


# What no entry calls, and numbers that no device can be given
DECLARED = (
    "vec2 end = vec2(0.25, 0.5); BokehFilter plain = BokehDefaultFilter(vec2(64.0, 32.0));"
    "BokehPolygon polygon = BokehMakePolygon(8, 0.5, 0.75);"
    "BokehLayers layers = BokehMakeLayers(vec2(64.0, 48.0), polygon, 0.25);"
)
VALUES = {
    **{"BOKEH_SENSOR_HEIGHT": 0.024, "BOKEH_MAX_COC": 0.1, "BOKEH_SPACING": 1.0, "BOKEH_NUM_SAMPLES": 13.0},
    **{"BOKEH_LAYER_RINGS": 3.0, "BOKEH_LAYER_CELLS": 12.0, "BOKEH_LAYER_CUBIC": 1.0, "BOKEH_ADAPTIVE_SAMPLES": 1.0},
    **{"plain.aspectRatio": 2.0, "plain.imageHeight": 32.0, "plain.spacing": 1.0, "plain.jitter": 0.0},
    **{"plain.bleedingBias": 0.02, "plain.bleedingMult": 30.0, "BokehMakeOffsets(end, 0, 1).x": -0.25},
    **{"BokehMakeOffsets(end, 0, 1).y": -0.5, "BokehMakeOffsets(end, 2, 5).x": 0.0},
    **{"BokehMakeOffsets(end, 4, 5).y": 0.5, "BokehDepthFromLogarithmic(-1.0, 100.0)": 0.0},
    **{"polygon.lengths.x": 0.0, "polygon.fifth": 0.0, "polygon.roundness": 1.0, "polygon.axial.y": 0.0},
    **{"layers.jitter": 0.0, "layers.largest": 12.0, "layers.full.origin.x": 0.0, "layers.full.texel.y * 48.0": 1.0},
    **{"layers.polygon.sides": 8.0, "polygon.rotation": 0.5, "polygon.squeeze": 0.75, "layers.full.size.x": 64.0},
}
SINE = float(np.sin(np.pi / 8.0))
OF_A_CUT = {"polygon.lengths.x": SINE, "polygon.lengths.w": SINE, "polygon.fifth": SINE, "polygon.roundness": 1.0}

# an image of one texel has no room for the inset
IN_A_PART = {
    "layers.full.origin.x": 0.0,
    "BokehGridCoords(vec2(0.25, 0.25), BokehMakeGrid(vec4(0.0, 0.0, 1.0, 1.0), vec2(4.0, 8.0))).y": 0.0625,
}


def _functions() -> Iterator[tuple[str, Frame]]:
    """A row of pixels, one for each value."""
    for label, defines, values in (
        ("values", {}, VALUES),
        ("values of a cut", {"BOKEH_CHARACTER": 1}, OF_A_CUT),
        ("values in a part", {"BOKEH_VIEWPORT": 1}, IN_A_PART),
    ):
        listed = ", ".join(f"float({name})" for name in values)
        main = f"{DECLARED} float values[] = float[]({listed}); float value = values[int(gl_FragCoord.x)];"
        told = np.repeat([[[value] for value in values.values()]], 4, axis=2)
        item = Pass("BokehLayerTiles", {}, "result", defines=defines)
        main += " BokehResult = vec4(value, value, value, value);"
        yield label, Frame((item,), {}, (len(values), 1), "float", told={"result": told}, main=main)


def program(main: str, defines: Mapping[str, int]) -> str:
    """A complete GLSL program of the package with another main."""
    text = re.sub(r"\bvoid main\(\)", "void unused()", shaders.glsl("BokehLayerTiles", "330", defines))
    return f"{text}\nvoid main()\n{{\n    {main}\n}}\n"
