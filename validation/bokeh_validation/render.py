"""One EXR through the shaders: the work behind `validation/run render`, and the checks of what it is given."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bokeh_validation import apertures, drivers, exr, methods, pictures
from bokeh_validation.errors import Unavailable, UserError

# A kernel is a row of texels; 8192 is what every device of the last fifteen years can hold.
MAX_KERNEL = 8192
MAX_SAMPLES = 1024
# Tried in this order when no driver is named: the fastest to start first.
AUTO = ("egl", "osmesa", "wgpu", "dxc")


@dataclass(frozen=True)
class Request:
    """What the user asked for, unchecked."""

    source: Path
    target: Path
    settings: methods.Settings
    depth_channel: str = "Z"
    layer: str | None = None
    driver: str | None = None
    adapter: str | None = None
    png: Path | None = None


def check(settings: methods.Settings) -> None:
    """Refuse settings that mean nothing, naming the option, its value and what is allowed."""
    camera = settings.camera
    _one_of("--method", settings.method, apertures.METHODS)
    _one_of("--aperture", settings.aperture, apertures.NAMES)
    if settings.method in ("exact", "layered") and settings.aperture not in methods.EXACT:
        raise UserError(
            f"--aperture {settings.aperture}: {settings.method} makes {', '.join(methods.EXACT)} only. "
            f"Give --method paper."
        )
    _one_of("--quality", settings.quality, tuple(methods.QUALITIES))
    _check_samples(settings)
    _number("--squeeze", settings.squeeze, "", lambda v: 0 < v <= 16, "more than 0, at most 16")
    _number("--rotation", settings.rotation, "degrees", lambda v: True, "any finite number")
    _number("--aperture-diameter", camera.aperture_diameter, "m", lambda v: v >= 0, "0 or more")
    _number("--focal-length", camera.focal_length, "m", lambda v: v > 0, "more than 0")
    _number("--sensor-height", camera.sensor_height, "m", lambda v: v > 0, "more than 0")
    _number("--max-coc", camera.max_coc, "", lambda v: 0 <= v <= 1, "0 to 1, a fraction of the image height")
    _number("--focus-distance", camera.focus_distance, "m", lambda v: v > 0, "more than 0")
    if camera.focus_distance <= camera.focal_length:
        raise UserError(
            f"--focus-distance {camera.focus_distance:g} m: a lens of focal length {camera.focal_length:g} m cannot "
            f"focus there. Give more than {camera.focal_length:g}."
        )
    if settings.coc is not None:
        _number("--coc", settings.coc, "", lambda v: 0 <= v <= 1, "0 to 1, a fraction of the image height")
    if settings.method == "naive":
        _check_kernel(settings)


def _check_samples(settings: methods.Settings) -> None:
    if settings.samples is not None and not 2 <= settings.samples <= MAX_SAMPLES:
        raise UserError(f"--samples {settings.samples}: a line has two ends. Give 2 to {MAX_SAMPLES}.")
    if not 2 <= settings.max_samples <= MAX_SAMPLES:
        raise UserError(f"--max-samples {settings.max_samples}: not allowed. Give 2 to {MAX_SAMPLES}.")
    _number("--spacing", settings.spacing, "pixels", lambda v: v >= 0, "0 (a fixed number of samples) or more")
    _number("--jitter", settings.jitter, "", lambda v: 0 <= v <= 1, "0 to 1")
    if settings.frame < 0:
        raise UserError(f"--frame {settings.frame}: not allowed. Give 0 or more.")
    if settings.method == "layered" and (settings.spacing > 0 or settings.samples is not None):
        option = f"--spacing {settings.spacing:g}" if settings.spacing > 0 else f"--samples {settings.samples}"
        raise UserError(f"{option}: layered takes its samples from a preset. Give --quality.")
    if settings.spacing > 0 and settings.method == "naive":
        raise UserError(f"--spacing {settings.spacing:g}: naive has a table of samples. Give --method exact or paper.")
    if settings.spacing > 0 and settings.samples is not None:
        raise UserError(
            f"--samples {settings.samples}: --spacing {settings.spacing:g} sets the number. Give one of them, and "
            f"--max-samples for the most."
        )


def _check_kernel(settings: methods.Settings) -> None:
    # the square's table has the most offsets for a sample count, so it bounds the others before they are made
    if (
        settings.count**2 > MAX_KERNEL
        and len(apertures.kernel(settings.aperture, min(settings.count, 128))) > MAX_KERNEL
    ):
        raise UserError(
            f"--samples {settings.count}: a naive {settings.aperture} of that many is more than {MAX_KERNEL} "
            f"offsets. Give fewer, or --method paper."
        )


def _one_of(option: str, value: str, allowed: tuple[str, ...]) -> None:
    if value not in allowed:
        raise UserError(f"{option} {value}: unknown. Give one of {', '.join(allowed)}.")


def _number(option: str, value: float, unit: str, allowed, text: str) -> None:
    if not math.isfinite(value) or not allowed(value):
        raise UserError(f"{option} {value:g}{' ' + unit if unit else ''}: not allowed. Give {text}.")


def pick_driver(name: str | None, adapter: str | None) -> drivers.Driver:
    """The driver named, or the first that this machine has."""
    if name is not None:
        if name not in drivers.NAMES:
            raise UserError(f"--driver {name}: no such driver. Give one of {', '.join(drivers.NAMES)}.")
        return _loaded(name, adapter)
    for candidate in AUTO:
        try:
            return drivers.load(candidate, adapter)
        except Unavailable:
            continue
    raise UserError("no driver works on this machine. See validation/run doctor, or give --driver reference.")


def _loaded(name: str, adapter: str | None) -> drivers.Driver:
    try:
        return drivers.load(name, adapter)
    except Unavailable as error:
        raise UserError(f"--driver {name}: not on this machine ({error}). See validation/run doctor.") from error


def render(request: Request) -> tuple[np.ndarray, drivers.Driver]:
    """Read, blur, write. Returns the result (H, W, 4), alpha = the CoC after the passes, and its driver.

    H x W are the pixels that the file has: where its data window is not its display window, the passes see the display
    window, and what they made of the rest is left out.
    """
    check(request.settings)
    exr.check_writable(request.target)
    if request.png is not None:
        exr.check_writable(request.png)
    depth_channel = None if request.settings.coc is not None else request.depth_channel
    scene = exr.read(request.source, depth_channel, request.layer)
    driver = pick_driver(request.driver, request.adapter)
    plan = methods.plan(request.settings, scene.size)
    depth = scene.depth if scene.depth is not None else np.ones((scene.size[1], scene.size[0]), np.float32)
    textures = {"color": scene.color, "depth": depth, **plan.tables}
    try:
        result = driver.run(plan.passes, textures, scene.size, scene.storage)["result"]
    except Unavailable as error:
        raise UserError(f"--driver {driver.name}: {error}.") from error
    result = scene.with_data(result)
    exr.write(request.target, result, scene.data, scene.display)
    if request.png is not None:
        pictures.write_png(request.png, pictures.display(result, tone_map=True))
    return result, driver
