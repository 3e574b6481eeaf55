"""The workflows of Figure 10 and the naive gather, as lists of passes."""

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
# Preset of layered -> rings of its gather, samples on an edge of its layers, cubic enlargement
PRESET_CONSTANTS = ("BOKEH_LAYER_RINGS", "BOKEH_LAYER_SAMPLES", "BOKEH_LAYER_CUBIC")
PRESETS = {"low": (1, 11, 0), "medium": (2, 11, 1), "high": (3, 18, 1), "ultra": (4, 18, 1)}
# Of exact -> samples on a line at most, pixels between them
EXACT_CONSTANTS = ("BOKEH_NUM_SAMPLES", "BOKEH_SPACING")
EXACT_PRESETS = {"low": (5, 2.0), "medium": (9, USUAL_SPACING), "high": (17, 1.0), "ultra": (33, 1.0)}
# With spacing, where nobody says
MOST_SAMPLES = 65
# An edge is shorter than the line of a parallelogram that makes the same polygon by min: 1/2 of it in the hexagon,
# 1/2.41 in the octagon. So many samples on it are at least as close to each other as 13 on that line.
EDGE_SAMPLES = {"square": 13, "hexagon": 7, "octagon": 6, "decagon": 5}


@dataclass(frozen=True)
class Camera:
    """Thin lens and sensor, metres; max_coc is a fraction of the image height."""

    aperture_diameter: float = 0.05
    focal_length: float = 0.05
    focus_distance: float = 5.0
    sensor_height: float = 0.024
    max_coc: float = 0.1

    def parameters(self) -> dict[str, float]:
        """As the shaders name them."""
        return dict(zip(LENS, astuple(self), strict=True))


@dataclass(frozen=True)
class Focus:
    """What the CoC map can do with BOKEH_FOCUS_CONTROLS 1; (in front of the focus, behind it).

    sharp   metres from the focus distance that stay sharp
    scale   factors of the CoC
    limits  of the CoC, fractions of the image height
    """

    sharp: tuple[float, float] = (0.0, 0.0)
    scale: tuple[float, float] = (1.0, 1.0)
    limits: tuple[float, float] = (1.0, 1.0)

    def parameters(self) -> dict[str, float]:
        """As the shaders name them."""
        names = [f"Bokeh{side}{what}" for what, sides in FOCUS.items() for side in sides]
        return dict(zip(names, (*self.sharp, *self.scale, *self.limits), strict=True))


@dataclass(frozen=True)
class Settings:
    """What to render.

    samples      on a line, with spacing at most; default: see `count`
    coc          a constant CoC (fraction of the image height) instead of one from depth
    spacing      pixels between samples, as many samples as the CoC needs; 0: a fixed number of samples; default: exact
                 has its preset's, all others 0
    jitter       amount of noise on the samples' places, 0 .. 1, where they are farther apart than a pixel
    frame        number of the frame: the noise is another in each
    squeeze      width of the bokeh over its height
    cats_eye     share of the bokeh's width that the lens barrel cuts off in the corners; exact and layered only
    roundness    of octagons in the same: 0 a square, 1 regular
    lateral      how much larger red of the finished picture is than green, and blue smaller
    use_mrt      whether a pass may write several targets; exact and layered only
    preset       of exact and layered, one of PRESETS; for exact it counts where neither samples nor spacing is given
    focus        BOKEH_FOCUS_CONTROLS: (front, back) range in metres, scales, limits; None: without
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
        """Whether samples of `exact` are those of its preset."""
        return self.method == "exact" and self.samples is None and self.spacing is None

    @property
    def count(self) -> int:
        """Samples on a line: by default those of the preset, or 13, as in the paper's section 4.3."""
        if self.samples is not None:
            return self.samples
        if self.has_preset:
            return EXACT_PRESETS[self.preset][0]
        if self.spacing:
            return MOST_SAMPLES
        return EDGE_SAMPLES.get(self.aperture, PAPER_SAMPLES) if self.method in ("exact", "layered") else PAPER_SAMPLES


@dataclass(frozen=True)
class Plan:
    """Passes, the tables they need beside colour and depth, and the name of the result.

    Textures 'color' (H, W, 4) and 'depth' (H, W) are to be handed in with `tables`.
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
    # programs without it have no code for it
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
    """Listings 1 to 4. `size` is (width, height) in pixels.

    Pass k writes 'line k'; the last one writes 'result'. A line that two parallelograms begin with is drawn once.
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
    """The paper's method for a convex polygon (n, 2), units of the CoC; `settings.aperture` is not looked at.

    Names are those of `paper`. The entries are the adaptive ones, which take lines of any length beside the pixel.
    """
    return _line_passes(settings, size, "BokehAdaptive", decompose(corners, settings.rotation).passes)


def _line_passes(
    settings: Settings, size: tuple[int, int], entry: str, lines: Sequence[LinePass], use_max: bool = False
) -> Plan:
    """The CoC map and the lines, each of these with noise of its own."""
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
    """Polygons with an even number of sides, added up from parallelograms: docs/methods/exact.md.

    The first pass writes 'strip 2' .. 'strip n', n = sides / 2: at once, or one after the other without several
    targets. The second pass writes 'result'.
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
    """Return what the passes of `layered` have in common: parameters, constants, and constants of a regular polygon."""
    sides = EXACT[settings.aperture]
    defines = dict(zip(PRESET_CONSTANTS, PRESETS[settings.preset], strict=True))
    common = _filter_parameters(settings, size) | {
        "BokehMaxCoC": settings.camera.max_coc,
        "BokehAngle": radians(settings.rotation),
        "BokehSides": float(sides),
    }
    # where the polygon is the same at every pixel, the passes that sample rings of it have their loops written out
    is_regular = settings.cats_eye == 0.0 and settings.roundness == 1.0
    return common, defines, {"BOKEH_SIDES": sides} if is_regular else {}


def layered(settings: Settings, size: tuple[int, int]) -> Plan:
    """Near and far layers at half size and a small gather of the rest: bokeh_layers.*. The last pass writes 'result'.

    Without several targets, a pass of several is drawn once for each.
    """
    sides = EXACT[settings.aperture]
    stem = f"Bokeh{settings.aperture.capitalize()}Layer"
    common, defines, known = _layer_constants(settings, size)
    passes = [_coc_pass(settings, size, "BokehSignedCoCMap")]

    def add(scale: int, entry: str, inputs: tuple[str, ...], outputs: tuple[str, ...], **changed: float) -> None:
        values = {**common, **changed}
        constants = defines | (known if entry in ("BokehHoleFill", "BokehComposite") else {})
        read = dict(zip(COLORS, inputs, strict=False))
        if settings.use_mrt or (len(outputs) == 1 and entry != stem + "First"):
            passes.append(Pass(entry, read, outputs, values, settings.count, constants, scale=scale))
            return
        one = "BokehLayerEdge" if entry == stem + "First" else entry + "One"
        for number, name in enumerate(outputs):
            index = {"BOKEH_TARGET_INDEX": number}
            passes.append(Pass(one, read, name, values, settings.count, constants | index, scale=scale))

    dilated, blurs = "dilated tiles", "layer coc"
    of_tiles, of_rows = (tuple(f"{each} {sums}" for sums in ("gather coc", "coc sums")) for each in ("tile", "row"))
    layers, quarters = ("near", "far"), ("near quarter", "far quarter")
    holes, fills = ("mid with holes", "far with holes"), ("mid fill", "far fill")
    add(8, "BokehTileMax", ("coc",), ("tiles",))
    add(8, "BokehTileDilate", ("tiles",), ("tiles along rows",))
    add(8, "BokehTileDilate", ("tiles along rows",), (dilated,), BokehAxis=1.0)
    add(2, "BokehPrefilter", ("coc", dilated), (*layers, "layer coc sums", "gather coc"))
    add(8, "BokehLayerCoCReduce", ("layer coc sums", "gather coc"), of_tiles)
    add(8, "BokehLayerCoCRows", (*of_tiles, dilated), of_rows)
    add(8, "BokehLayerCoCColumns", (*of_rows, dilated), ("gather tiles", blurs))
    add(4, "BokehDownsample", ("coc", dilated, *layers, blurs), (*holes, *quarters))
    add(4, "BokehHoleFill", (*holes, dilated), fills)
    blurred = {layer: [f"{layer} strip {k}" for k in range(2, sides // 2 + 1)] for layer in layers}
    together = settings.use_mrt and sides in BOTH
    for index, (layer, names) in enumerate(blurred.items()):
        inputs, outputs, values = (layer, f"{layer} quarter"), (f"{layer} blurred",), {"BokehLayer": float(index)}
        if together:
            # near, far of edge 2, then of edge 3
            names = [name for pair in zip(*blurred.values(), strict=True) for name in pair]
            inputs, values = (layers[0], quarters[0], layers[1], quarters[1]), {}
            outputs = ("near blurred", "far blurred")
        add(2, stem + "First", (*inputs, blurs), tuple(names), **values)
        second = stem + "Second"
        if not settings.use_mrt:
            # one program for all polygons: it does not read the last strip again
            second, names = "BokehLayerSecondOne", names + names[-1:] * 3
        # the CoC are in the fifth slot, whatever the number of strips
        read = dict(zip(COLORS, names[:4], strict=False)) | {"ColorSampE": blurs}
        passes.append(Pass(second, read, outputs, common | values, settings.count, defines, scale=2))
        if together:
            break
    add(1, "BokehComposite", ("coc", "gather tiles", "near blurred", "far blurred", *fills), ("result",))
    return Plan(tuple(passes), {})


def naive(settings: Settings, size: tuple[int, int]) -> Plan:
    """Section 3: one gather with the aperture's table of offsets."""
    table = aperture_shapes.kernel(settings.aperture, settings.count, settings.rotation)
    inputs = {"ColorSamp": "coc", "DepthSamp": "depth", "KernelSamp": "kernel"}
    gather = Pass("BokehNaiveGather", inputs, "result", _filter_parameters(settings, size), len(table))
    return Plan((_coc_pass(settings, size), gather), {"kernel": kernel_texture(table)})


def naive_grid(settings: Settings, size: tuple[int, int]) -> Plan:
    """Section 3 over a samples x samples grid of the aperture's first parallelogram, offsets computed (Table 1)."""
    shape = aperture_shapes.PARALLELOGRAMS[settings.aperture][0]
    angles = [radians(angle + settings.rotation) for angle in (shape.first, shape.second)]
    parameters = _filter_parameters(settings, size) | dict(zip(("BokehAngle", "BokehAngleB"), angles, strict=True))
    gather = Pass("BokehNaiveGrid", {"ColorSamp": "coc", "DepthSamp": "depth"}, "result", parameters, settings.count)
    return Plan((_coc_pass(settings, size), gather), {})


def steadied(full: Plan, size: tuple[int, int], blend: float) -> Plan:
    """A plan whose CoC map, 'coc', is made steady.

    It reads 'history', which is 'coc' of the frame before, and 'velocity', how far each pixel has come since then, uv.
    `blend` is the share of this frame, 1 where there is none before.
    """
    first, *others = full.passes
    inputs = {"ColorSamp": "new coc", "ColorSampB": "history", "ColorSampC": "velocity"}
    image = {"BokehImageWidth": float(size[0]), "BokehImageHeight": float(size[1])}
    steady = Pass("BokehStableMap", inputs, first.output, {**image, "BokehStableBlend": blend})
    return replace(full, passes=(replace(first, output="new coc"), steady, *others))


def in_viewport(full: Plan, viewport: tuple[int, int, int, int], size: tuple[int, int]) -> Plan:
    """A plan for an image that is a part of its textures.

    viewport  (x, y, width, height) of the image, texels; `full` was made for its width and height
    size      (width, height) of the textures and targets
    """
    names = ("ViewportX", "ViewportY", "ImageWidth", "ImageHeight", "TextureWidth", "TextureHeight")
    place = {f"Bokeh{name}": float(value) for name, value in zip(names, (*viewport, *size), strict=True)}
    passes = (replace(item, viewport=viewport, parameters={**item.parameters, **place}) for item in full.passes)
    return replace(full, passes=tuple(passes))


def kernel_texture(table: np.ndarray) -> np.ndarray:
    """Offsets (N, 2) as an N x 1 texture, float32 (1, N, 4), rg = offset."""
    return np.pad(table, ((0, 0), (0, 2)))[None].astype(np.float32)


METHODS = {"paper": paper, "exact": exact, "layered": layered, "naive": naive, "naive-grid": naive_grid}


def plan(settings: Settings, size: tuple[int, int]) -> Plan:
    """The passes of `settings.method`, and lateral colour after them."""
    planned = METHODS[settings.method](settings, size)
    if settings.lateral == 0.0:
        return planned
    *others, last = planned.passes
    finished = replace(last, output="finished")
    lateral = Pass("BokehLateralColor", {"ColorSamp": "finished"}, "result", {"BokehLateral": settings.lateral})
    return replace(planned, passes=(*others, finished, lateral))
