"""The workflows of Figure 10 and the naive gather, as lists of passes."""

from dataclasses import dataclass, field
from math import radians

import numpy as np

from bokeh_validation import apertures
from bokeh_validation.passes import Pass


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
        return {
            "BokehApertureDiameter": self.aperture_diameter,
            "BokehFocalLength": self.focal_length,
            "BokehFocusDistance": self.focus_distance,
            "BokehSensorHeight": self.sensor_height,
            "BokehMaxCoC": self.max_coc,
        }


@dataclass(frozen=True)
class Settings:
    """What to render. `coc`: a constant CoC (fraction of the image height) instead of one from depth."""

    method: str = "paper"
    aperture: str = "hexagon"
    samples: int = 13
    rotation: float = 0.0
    camera: Camera = field(default_factory=Camera)
    coc: float | None = None
    blur_coc: bool = True
    leak_fix: bool = True
    bleeding_bias: float = 0.02
    bleeding_mult: float = 30.0


@dataclass(frozen=True)
class Plan:
    """Passes, the tables they need beside colour and depth, and the name of the result.

    Textures 'color' (H, W, 4) and 'depth' (H, W) are to be handed in with `tables`.
    """

    passes: tuple[Pass, ...]
    tables: dict[str, np.ndarray]
    result: str = "result"


def _coc_pass(settings: Settings) -> Pass:
    parameters = settings.camera.parameters()
    if settings.coc is None:
        return Pass("BokehCoCMap", {"ColorSamp": "color", "DepthSamp": "depth"}, "coc", parameters)
    parameters["BokehConstantCoC"] = settings.coc
    return Pass("BokehConstantCoC", {"ColorSamp": "color"}, "coc", parameters)


def _filter_parameters(settings: Settings, size: tuple[int, int]) -> dict[str, float]:
    return {
        "BokehAspectRatio": size[0] / size[1],
        "BokehBleedingBias": settings.bleeding_bias if settings.leak_fix else 1.0,
        "BokehBleedingMult": settings.bleeding_mult,
        "BokehBlurCoC": 1.0 if settings.blur_coc else 0.0,
    }


def paper(settings: Settings, size: tuple[int, int]) -> Plan:
    """Listings 1 to 4. `size` is (width, height) in pixels.

    Pass k writes 'line k'; the last one writes 'result'. A line that two parallelograms begin with is made once.
    """
    common = _filter_parameters(settings, size)
    shapes = apertures.PARALLELOGRAMS[settings.aperture]
    passes = [_coc_pass(settings)]
    first_lines: dict[float, str] = {}
    finished = None
    for index, shape in enumerate(shapes):
        if shape.first not in first_lines:
            first_lines[shape.first] = name = f"line {len(passes)}"
            passes.append(_line(settings, common, shape.first, "coc", name))
        source = first_lines[shape.first]
        if index + 1 < len(shapes):
            finished = f"line {len(passes)}"
            passes.append(_line(settings, common, shape.second, source, finished))
        else:
            passes.append(_line(settings, common, shape.second, source, "result", finished))
    return Plan(tuple(passes), {})


def _line(settings: Settings, common: dict, angle: float, source: str, target: str, other: str | None = None) -> Pass:
    """One line pass; with `other`, the final one that combines with it."""
    parameters = {**common, "BokehAngle": radians(angle + settings.rotation)}
    inputs = {"ColorSamp": source, "DepthSamp": "depth"}
    if other is None:
        return Pass("BokehDepthOfField", inputs, target, parameters, settings.samples)
    inputs["ColorSampB"] = other
    parameters["BokehUseMax"] = 1.0 if settings.aperture in apertures.USES_MAX else 0.0
    return Pass("BokehDepthOfFieldFinal", inputs, target, parameters, settings.samples)


def naive(settings: Settings, size: tuple[int, int]) -> Plan:
    """Section 3: one gather with the aperture's table of offsets."""
    table = apertures.kernel(settings.aperture, settings.samples, settings.rotation)
    inputs = {"ColorSamp": "coc", "DepthSamp": "depth", "KernelSamp": "kernel"}
    gather = Pass("BokehNaiveGather", inputs, "result", _filter_parameters(settings, size), len(table))
    return Plan((_coc_pass(settings), gather), {"kernel": kernel_texture(table)})


def naive_grid(settings: Settings, size: tuple[int, int]) -> Plan:
    """Section 3 over a samples x samples grid of the aperture's first parallelogram, offsets computed (Table 1)."""
    shape = apertures.PARALLELOGRAMS[settings.aperture][0]
    parameters = {
        **_filter_parameters(settings, size),
        "BokehAngle": radians(shape.first + settings.rotation),
        "BokehAngleB": radians(shape.second + settings.rotation),
    }
    gather = Pass("BokehNaiveGrid", {"ColorSamp": "coc", "DepthSamp": "depth"}, "result", parameters, settings.samples)
    return Plan((_coc_pass(settings), gather), {})


def kernel_texture(table: np.ndarray) -> np.ndarray:
    """Offsets (N, 2) as an N x 1 texture, float32 (1, N, 4), rg = offset."""
    texture = np.zeros((1, len(table), 4), np.float32)
    texture[0, :, :2] = table
    return texture


def plan(settings: Settings, size: tuple[int, int]) -> Plan:
    """The passes of `settings.method`."""
    return {"paper": paper, "naive": naive, "naive-grid": naive_grid}[settings.method](settings, size)
