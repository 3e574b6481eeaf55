"""List the passes of each method: Figure 10's workflows, the exact and layered methods, and the naive gather."""

from collections.abc import Sequence
from dataclasses import astuple, dataclass, field, replace
from math import radians

import numpy as np

from bokeh_validation.frame import aperture_shapes
from bokeh_validation.frame.decomposition import LinePass, decompose
from bokeh_validation.shaders.entries import BOTH, COLORS, EXACT
from bokeh_validation.shaders.passes import PAPER_SAMPLES, USUAL_SPACING, Pass

# The shaders' names for the fields of Camera, in the same order
LENS = ("BokehApertureDiameter", "BokehFocalLength", "BokehFocusDistance", "BokehSensorHeight", "BokehMaxCoC")
FOCUS = {"Range": ("Front", "Back"), "Scale": ("Near", "Far"), "MaxCoC": ("Near", "Far")}
LAYER_NAMES = ("near", "far")
# Preset of layered -> rings of the gather, samples on an edge of the layers, whether layers are enlarged bicubically,
# size of the image / size of a layer
PRESET_CONSTANTS = ("BOKEH_LAYER_RINGS", "BOKEH_LAYER_SAMPLES", "BOKEH_LAYER_CUBIC", "BOKEH_LAYER_SCALE")
PRESETS = {
    "mobile": (0, 18, 0, 4),
    "low": (1, 11, 0, 2),
    "medium": (2, 11, 1, 2),
    "high": (3, 18, 1, 2),
    "ultra": (4, 18, 1, 2),
}
# Preset of exact -> maximum number of samples on a line, pixels between them
EXACT_CONSTANTS = ("BOKEH_NUM_SAMPLES", "BOKEH_SPACING")
EXACT_PRESETS = {
    "mobile": (5, 2.0),
    "low": (5, 2.0),
    "medium": (9, USUAL_SPACING),
    "high": (17, 1.0),
    "ultra": (33, 1.0),
}
# Maximum number of samples on a line with a given spacing, unless the settings say otherwise
MOST_SAMPLES = 65
# An edge is shorter than the line of a parallelogram that makes the same polygon by min: 1/2 of it in the hexagon,
# 1/2.41 in the octagon. These counts space the samples of an edge at most as far apart as 13 samples on that line.
EDGE_SAMPLES = {"square": 13, "hexagon": 7, "octagon": 6, "decagon": 5}


@dataclass(frozen=True)
class Camera:
    """Describe a thin lens and sensor in metres; max_coc is a fraction of the image height."""

    aperture_diameter: float = 0.05
    focal_length: float = 0.05
    focus_distance: float = 5.0
    sensor_height: float = 0.024
    max_coc: float = 0.1

    def parameters(self) -> dict[str, float]:
        """Return the shaders' parameters for this camera."""
        return dict(zip(LENS, astuple(self), strict=True))


@dataclass(frozen=True)
class Focus:
    """Hold the CoC map's focus controls (BOKEH_FOCUS_CONTROLS 1), each as (in front of the focus, behind it).

    sharp   distance from the focus that stays sharp, metres
    scale   factors applied to the CoC
    limits  maximum CoC, fractions of the image height
    """

    sharp: tuple[float, float] = (0.0, 0.0)
    scale: tuple[float, float] = (1.0, 1.0)
    limits: tuple[float, float] = (1.0, 1.0)

    def parameters(self) -> dict[str, float]:
        """Return the shaders' parameters for these controls."""
        names = [f"Bokeh{side}{what}" for what, sides in FOCUS.items() for side in sides]
        return dict(zip(names, (*self.sharp, *self.scale, *self.limits), strict=True))


@dataclass(frozen=True)
class Settings:
    """Describe what to render.

    samples    on a line; the maximum if a spacing is given; default: see `count`
    rotation   of the polygon, degrees
    coc        a constant CoC, fraction of the image height, that replaces the one from depth
    spacing    pixels between samples, so that the CoC determines their number; 0: a fixed number of samples; default:
               the preset's for exact, 0 for all others
    jitter     amount of random sample offsets, 0 to 1, where samples are more than a pixel apart
    frame      number of the frame, which the random offsets depend on
    squeeze    width of the bokeh over its height
    cats_eye   fraction of the bokeh's width that the lens barrel cuts off in the corners; exact and layered only
    roundness  of octagons in exact and layered: 0 a square, 1 regular
    lateral    how much larger red is than green in the finished image; blue is smaller by as much
    use_mrt    whether a pass may write several targets; exact and layered only
    preset     of exact and layered, one of PRESETS; exact ignores it if samples or spacing are given
    focus      BOKEH_FOCUS_CONTROLS; None: off
    """

    method: str = "paper"
    aperture: str = "hexagon"
    samples: int | None = None
    rotation: float = 0.0
    camera: Camera = field(default_factory=Camera)
    coc: float | None = None
    blur_coc: bool = True
    leak_fix: bool = True
    bleeding_bias: float = 0.02
    bleeding_mult: float = 30.0
    spacing: float | None = None
    jitter: float = 0.0
    frame: int = 0
    squeeze: float = 1.0
    cats_eye: float = 0.0
    roundness: float = 1.0
    lateral: float = 0.0
    use_mrt: bool = True
    preset: str = "medium"
    focus: Focus | None = None

    @property
    def has_preset(self) -> bool:
        """Return whether the preset determines the samples of `exact`."""
        return self.method == "exact" and self.samples is None and self.spacing is None

    @property
    def count(self) -> int:
        """Return the samples on a line: the preset's by default, or 13 as in section 4.3 of the paper."""
        if self.samples is not None:
            return self.samples
        if self.has_preset:
            return EXACT_PRESETS[self.preset][0]
        if self.spacing:
            return MOST_SAMPLES
        return EDGE_SAMPLES.get(self.aperture, PAPER_SAMPLES) if self.method in ("exact", "layered") else PAPER_SAMPLES


@dataclass(frozen=True)
class Plan:
    """Hold the passes of a frame, the tables that they read, and the name of the result.

    The textures 'color' (H, W, 4) and 'depth' (H, W) are to be supplied along with `tables`.
    """

    passes: tuple[Pass, ...]
    tables: dict[str, np.ndarray]
    result: str = "result"


def _coc_pass(settings: Settings, size: tuple[int, int], entry: str = "BokehCoCMap") -> Pass:
    lens = settings.camera.parameters()
    if settings.focus and entry == "BokehSignedCoCMap":
        lens |= settings.focus.parameters()
    if settings.coc is None and entry == "BokehSignedCoCMap":
        lens |= {"BokehImageWidth": float(size[0]), "BokehImageHeight": float(size[1])}
    if settings.coc is None:
        return Pass(entry, {"ColorSamp": "color", "DepthSamp": "depth"}, "coc", lens)
    return Pass("BokehConstantCoC", {"ColorSamp": "color"}, "coc", lens | {"BokehConstantCoC": settings.coc})


def _filter_parameters(settings: Settings, size: tuple[int, int]) -> dict[str, float]:
    # without these parameters the programs are compiled without the code for them
    character = {"BokehCatsEye": settings.cats_eye, "BokehRoundness": settings.roundness}
    character = character if settings.cats_eye > 0.0 or settings.roundness < 1.0 else {}
    return character | {
        "BokehAspectRatio": size[0] / size[1],
        "BokehBleedingBias": settings.bleeding_bias if settings.leak_fix else 2.0,
        "BokehBleedingMult": settings.bleeding_mult,
        "BokehBlurCoC": 1.0 if settings.blur_coc else 0.0,
        "BokehSqueeze": settings.squeeze,
        "BokehSpacing": settings.spacing or 0.0,
        "BokehImageWidth": float(size[0]),
        "BokehImageHeight": float(size[1]),
        "BokehJitter": settings.jitter,
        "BokehFrame": float(settings.frame),
    }


def paper(settings: Settings, size: tuple[int, int]) -> Plan:
    """Return the plan of the paper's method, Listings 1 to 4. `size` is (width, height) in pixels.

    Pass k writes 'line k'; the last one writes 'result'. A first line that two parallelograms share is drawn once.
    """
    if settings.aperture in aperture_shapes.POLYGONS:
        return paper_polygon(
            aperture_shapes.regular_polygon(aperture_shapes.POLYGONS[settings.aperture]), settings, size
        )
    lines: list[LinePass] = []
    first_lines: dict[float, int] = {}
    finished = None
    for shape in aperture_shapes.PARALLELOGRAMS[settings.aperture]:
        if shape.first not in first_lines:
            first_lines[shape.first] = len(lines)
            lines.append(LinePass(shape.first + settings.rotation))
        lines.append(LinePass(shape.second + settings.rotation, reads=first_lines[shape.first], combines=finished))
        finished = len(lines) - 1
    entry = "BokehAdaptive" if settings.spacing else "BokehDepthOfField"
    return _line_passes(settings, size, entry, lines, use_max=settings.aperture in aperture_shapes.USES_MAX)


def paper_polygon(corners: np.ndarray, settings: Settings, size: tuple[int, int]) -> Plan:
    """Return the paper's plan for a convex polygon (n, 2) in units of the CoC; `settings.aperture` is ignored.

    Textures are named as in `paper`. The passes are the adaptive ones, whose lines may have any length and need not be
    centred on the pixel.
    """
    return _line_passes(settings, size, "BokehAdaptive", decompose(corners, settings.rotation).passes)


def _line_passes(
    settings: Settings, size: tuple[int, int], entry: str, lines: Sequence[LinePass], use_max: bool = False
) -> Plan:
    """Return the plan of the CoC map and the lines; every line has its own random offsets."""
    common = _filter_parameters(settings, size)
    names = [f"line {number}" for number in range(1, len(lines))] + ["result"]
    passes = [_coc_pass(settings, size)]
    for index, (line, name) in enumerate(zip(lines, names, strict=True)):
        inputs = {"ColorSamp": "coc" if line.reads is None else names[line.reads], "DepthSamp": "depth"}
        parameters, final = {**common, **line.parameters(), "BokehPassIndex": float(index)}, ""
        if line.combines is not None:
            inputs["ColorSampB"], parameters["BokehUseMax"], final = names[line.combines], float(use_max), "Final"
        passes.append(Pass(entry + final, inputs, name, parameters, settings.count))
    return Plan(tuple(passes), {})


def exact(settings: Settings, size: tuple[int, int]) -> Plan:
    """Return the plan of the exact method, which sums parallelograms to polygons with an even number of sides:
    docs/methods/exact.md.

    The first pass writes 'strip 2' to 'strip n', n = sides / 2, or one pass per strip without multiple render targets.
    The second pass writes 'result'.
    """
    sides = EXACT[settings.aperture]
    stem = f"Bokeh{settings.aperture.capitalize()}"
    common = _filter_parameters(settings, size) | {"BokehAngle": radians(settings.rotation)}
    defines = {"BOKEH_SPACING": EXACT_PRESETS[settings.preset][1]} if settings.has_preset else {}
    names = tuple(f"strip {k}" for k in range(2, sides // 2 + 1))
    passes = [_coc_pass(settings, size, "BokehSignedCoCMap")]
    if settings.use_mrt:
        passes.append(Pass(stem + "First", {"ColorSamp": "coc"}, names, common, settings.count, defines))
    else:
        for number, name in enumerate(names):
            index = defines | {"BOKEH_TARGET_INDEX": number}
            edge = {**common, "BokehSides": float(sides)}
            passes.append(Pass("BokehExactEdge", {"ColorSamp": "coc"}, name, edge, settings.count, index))
    read = dict(zip(COLORS, names, strict=False))
    passes.append(Pass(stem + "Second", read, "result", common, settings.count, defines))
    return Plan(tuple(passes), {})


def _layer_constants(settings: Settings, size: tuple[int, int]) -> tuple[dict, dict, dict]:
    """Return what the passes of `layered` share: parameters, constants, and the additional constants for a regular
    polygon.
    """
    sides = EXACT[settings.aperture]
    defines = dict(zip(PRESET_CONSTANTS, PRESETS[settings.preset], strict=True))
    common = _filter_parameters(settings, size) | {
        "BokehMaxCoC": settings.camera.max_coc,
        "BokehAngle": radians(settings.rotation),
        "BokehSides": float(sides),
    }
    # if the polygon is the same at every pixel, the passes that sample rings of it are compiled for a constant number
    # of sides, so that their loops are unrolled
    is_regular = settings.cats_eye == 0.0 and settings.roundness == 1.0
    return common, defines, {"BOKEH_SIDES": sides} if is_regular else {}


def _layer_blurs(sides: int, use_mrt: bool) -> list[tuple[str, tuple[str, ...], list[str], tuple[str, ...]]]:
    """Return what blurs the layers, both together or one after the other.

    Each item has the word in the entries' names, what the first pass reads, the strips between the two passes, and what
    the second one writes.
    """
    numbers = range(2, sides // 2 + 1)
    if use_mrt and sides in BOTH:
        strips = [f"{layer} strip {k}" for k in numbers for layer in LAYER_NAMES]
        return [("Layer", ("near", "near quarter", "far", "far quarter"), strips, ("near blurred", "far blurred"))]
    strips_of = {layer: [f"{layer} strip {k}" for k in numbers] for layer in LAYER_NAMES}
    return [
        (layer.capitalize(), (layer, f"{layer} quarter"), strips, (f"{layer} blurred",))
        for layer, strips in strips_of.items()
    ]


def layered(settings: Settings, size: tuple[int, int]) -> Plan:
    """Return the plan of the layered method: near and far layers at half size (the preset MOBILE: a quarter), and a
    gather of the rest (bokeh_layers.*).

    The last pass writes 'result'. Without multiple render targets, a pass with several targets is drawn once for each.
    """
    sides = EXACT[settings.aperture]
    common, defines, known = _layer_constants(settings, size)
    reduced = defines["BOKEH_LAYER_SCALE"]
    passes = [_coc_pass(settings, size, "BokehSignedCoCMap")]

    def add(scale: int, entry: str, inputs: tuple[str, ...], outputs: tuple[str, ...], one: str = "") -> None:
        constants = defines | (known if entry in ("BokehHoleFill", "BokehComposite") else {})
        read = dict(zip(COLORS, inputs, strict=False))
        if settings.use_mrt or (len(outputs) == 1 and not one):
            passes.append(Pass(entry, read, outputs, common, settings.count, constants, scale=scale))
            return
        for number, name in enumerate(outputs):
            indexed = constants | {"BOKEH_TARGET_INDEX": number}
            passes.append(Pass(one or entry + "One", read, name, common, settings.count, indexed, scale=scale))

    dilated, blurs = "dilated tiles", "layer coc"
    of_tiles, of_rows = (tuple(f"{each} {sums}" for sums in ("gather coc", "coc sums")) for each in ("tile", "row"))
    quarters = tuple(f"{layer} quarter" for layer in LAYER_NAMES)
    holes, fills = ("mid with holes", "far with holes"), ("mid fill", "far fill")
    add(8, "BokehTileMax", ("coc",), ("tiles",))
    add(8, "BokehTileDilateRows", ("tiles",), ("tiles along rows",))
    add(8, "BokehTileDilateColumns", ("tiles along rows",), (dilated,))
    add(reduced, "BokehPrefilter", ("coc", dilated), (*LAYER_NAMES, "layer coc sums", "gather coc"))
    add(8, "BokehLayerCoCReduce", ("layer coc sums", "gather coc"), of_tiles)
    add(8, "BokehLayerCoCRows", (*of_tiles, dilated), of_rows)
    add(8, "BokehLayerCoCColumns", (*of_rows, dilated), ("gather tiles", blurs))
    add(4, "BokehDownsample", ("coc", dilated, *LAYER_NAMES, blurs), (*holes, *quarters))
    add(4, "BokehHoleFill", (*holes, dilated), fills)
    for word, inputs, strips, outputs in _layer_blurs(sides, settings.use_mrt):
        stem = f"Bokeh{settings.aperture.capitalize()}{word}"
        add(reduced, stem + "First", (*inputs, blurs), tuple(strips), f"Bokeh{word}Edge")
        second = stem + "Second"
        if not settings.use_mrt:
            # one program for all polygons, which needs a texture in every slot: the last strip fills the unused ones
            second, strips = f"Bokeh{word}SecondOne", strips + strips[-1:] * 3
        # the layer CoC is in the fifth slot, whatever the number of strips
        read = dict(zip(COLORS, strips[:4], strict=False)) | {"ColorSampE": blurs}
        passes.append(Pass(second, read, outputs, common, settings.count, defines, scale=reduced))
    add(1, "BokehComposite", ("coc", "gather tiles", "near blurred", "far blurred", *fills), ("result",))
    return Plan(tuple(passes), {})


def naive(settings: Settings, size: tuple[int, int]) -> Plan:
    """Return the plan of one gather with the aperture's table of offsets (section 3)."""
    table = aperture_shapes.kernel(settings.aperture, settings.count, settings.rotation)
    inputs = {"ColorSamp": "coc", "DepthSamp": "depth", "KernelSamp": "kernel"}
    gather = Pass("BokehNaiveGather", inputs, "result", _filter_parameters(settings, size), len(table))
    return Plan((_coc_pass(settings, size), gather), {"kernel": kernel_texture(table)})


def naive_grid(settings: Settings, size: tuple[int, int]) -> Plan:
    """Return the plan of a gather over a samples x samples grid of the aperture's first parallelogram (section 3,
    Table 1).

    The shader computes the offsets; there is no table.
    """
    shape = aperture_shapes.PARALLELOGRAMS[settings.aperture][0]
    angles = [radians(angle + settings.rotation) for angle in (shape.first, shape.second)]
    parameters = _filter_parameters(settings, size) | dict(zip(("BokehAngle", "BokehAngleB"), angles, strict=True))
    gather = Pass("BokehNaiveGrid", {"ColorSamp": "coc", "DepthSamp": "depth"}, "result", parameters, settings.count)
    return Plan((_coc_pass(settings, size), gather), {})


def steadied(full: Plan, size: tuple[int, int], blend: float) -> Plan:
    """Return the plan with a pass that stabilises its CoC map, 'coc', over time.

    That pass reads 'history', which is 'coc' of the previous frame, and 'velocity', how far each pixel has moved since
    then in uv. `blend` is the weight of this frame, 1 if there is no previous one.
    """
    first, *others = full.passes
    inputs = {"ColorSamp": "new coc", "ColorSampB": "history", "ColorSampC": "velocity"}
    image = {"BokehImageWidth": float(size[0]), "BokehImageHeight": float(size[1])}
    steady = Pass("BokehStableMap", inputs, first.output, {**image, "BokehStableBlend": blend})
    return replace(full, passes=(replace(first, output="new coc"), steady, *others))


def in_viewport(full: Plan, viewport: tuple[int, int, int, int], size: tuple[int, int]) -> Plan:
    """Return the plan for an image that fills only a part of its textures.

    viewport  (x, y, width, height) of the image, texels; `full` was made for its width and height
    size      (width, height) of the textures and targets
    """
    names = ("ViewportX", "ViewportY", "ImageWidth", "ImageHeight", "TextureWidth", "TextureHeight")
    place = {f"Bokeh{name}": float(value) for name, value in zip(names, (*viewport, *size), strict=True)}
    passes = (replace(item, viewport=viewport, parameters={**item.parameters, **place}) for item in full.passes)
    return replace(full, passes=tuple(passes))


def kernel_texture(table: np.ndarray) -> np.ndarray:
    """Convert offsets (N, 2) to an N x 1 texture, float32 (1, N, 4), with the offset in rg."""
    return np.pad(table, ((0, 0), (0, 2)))[None].astype(np.float32)


METHODS = {"paper": paper, "exact": exact, "layered": layered, "naive": naive, "naive-grid": naive_grid}


def plan(settings: Settings, size: tuple[int, int]) -> Plan:
    """Return the plan of `settings.method`, followed by the pass for lateral colour if that is used."""
    planned = METHODS[settings.method](settings, size)
    if settings.lateral == 0.0:
        return planned
    *others, last = planned.passes
    finished = replace(last, output="finished")
    lateral = Pass("BokehLateralColor", {"ColorSamp": "finished"}, "result", {"BokehLateral": settings.lateral})
    return replace(planned, passes=(*others, finished, lateral))
