"""One EXR through the shaders: the work behind `validation/run render`, and the checks of what it is given."""

import math
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from typer import Option

from bokeh_validation import exr, pictures, terminal
from bokeh_validation.errors import Unavailable, UserError
from bokeh_validation.frame import apertures, methods

# A kernel is a row of texels; 8192 is what every device of the last fifteen years can hold.
MAX_KERNEL = 8192
MAX_SAMPLES = 1024
APERTURES = "square, hexagon, octagon, decagon; paper and naive also diamond, star, triangle, pentagon, heptagon."


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
    _one_of("--preset", settings.preset, tuple(methods.PRESETS))
    _check_samples(settings)
    _number("--squeeze", settings.squeeze, "", lambda v: 0 < v <= 16, "more than 0, at most 16")
    _number("--cats-eye", settings.cats_eye, "", lambda v: 0 <= v <= 0.9, "0 to 0.9, a share of the bokeh's width")
    _number("--roundness", settings.roundness, "", lambda v: 0 <= v <= 1, "0 (a square) to 1 (an octagon)")
    _number("--lateral", settings.lateral, "", lambda v: abs(v) <= 0.1, "-0.1 to 0.1, a share of the image")
    for option, value in zip(("--axial-red", "--axial-blue"), settings.axial, strict=True):
        _number(option, value, "", lambda v: abs(v) <= 1, "-1 to 1, a fraction of the image height")
        if value and settings.method != "exact":
            raise UserError(f"{option} {value:g}: {settings.method} has no axial colour. Give --method exact.")
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
        if settings.coc > camera.max_coc:
            raise UserError(
                f"--coc {settings.coc:g}: more than --max-coc {camera.max_coc:g}, which would clamp it. "
                f"Raise --max-coc as well."
            )
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
        raise UserError(f"{option}: layered takes its samples from a preset. Give --preset.")
    if settings.spacing > 0 and settings.method == "naive":
        raise UserError(f"--spacing {settings.spacing:g}: naive has a table of samples. Give --method exact or paper.")
    if settings.spacing > 0 and settings.samples is not None:
        raise UserError(
            f"--samples {settings.samples}: --spacing {settings.spacing:g} sets the number. Give one of them, and "
            f"--max-samples for the most."
        )


def _check_kernel(settings: methods.Settings) -> None:
    # the square's table has the most offsets for a sample count, so it bounds the others before they are made
    if settings.count**2 <= MAX_KERNEL:
        return
    if len(apertures.kernel(settings.aperture, min(settings.count, 128))) > MAX_KERNEL:
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


def render(
    source: Annotated[Path, typer.Argument(metavar="IN.exr", help="R G B and planar view depth in metres.")],
    target: Annotated[Path, Option("-o", "--output", metavar="OUT.exr", help="R G B A, A = CoC after the passes.")],
    method: Annotated[str, Option(help="exact, layered (near objects spread as well), paper or naive.")] = "exact",
    aperture: Annotated[str, Option(help=APERTURES)] = "hexagon",
    samples: Annotated[int | None, Option(help="On a line, 2 or more. Default: 13; exact: as close together.")] = None,
    spacing: Annotated[float, Option(help="Pixels between samples, as many as the CoC needs. 0: --samples.")] = 0.0,
    max_samples: Annotated[int, Option(help="Samples on a line at most, with --spacing.")] = 65,
    jitter: Annotated[float, Option(help="Noise, 0 to 1, on places of samples more than a pixel apart.")] = 0.0,
    frame: Annotated[int, Option(help="Number of the frame; the noise is another in each.")] = 0,
    squeeze: Annotated[float, Option(help="Width of the bokeh over its height: 0.5 for an anamorphic lens.")] = 1.0,
    cats_eye: Annotated[float, Option(help="exact, layered: share of the bokeh's width cut off in corners.")] = 0.0,
    roundness: Annotated[float, Option(help="exact, layered, octagon: 0 makes a square, 1 a regular octagon.")] = 1.0,
    axial_red: Annotated[float, Option(help="exact, axial colour: how much more signed CoC red has.")] = 0.0,
    axial_blue: Annotated[float, Option(help="The same of blue, a fraction of the image height.")] = 0.0,
    lateral: Annotated[float, Option(help="Lateral colour: red larger, blue smaller, a share of the image.")] = 0.0,
    targets: Annotated[bool, Option("--mrt/--no-mrt", help="exact, layered: write several targets in a pass.")] = True,
    preset: Annotated[str, Option(help="layered: low, medium, high or ultra.")] = "medium",
    rotation: Annotated[float, Option(help="Degrees, from +x towards +y (down).")] = 0.0,
    aperture_diameter: Annotated[float, Option(help="Metres.")] = 0.05,
    focal_length: Annotated[float, Option(help="Metres.")] = 0.05,
    focus_distance: Annotated[float, Option(help="Metres, more than the focal length.")] = 5.0,
    sensor_height: Annotated[float, Option(help="Metres.")] = 0.024,
    max_coc: Annotated[float, Option(help="Largest CoC, fraction of the image height.")] = 0.1,
    coc: Annotated[float | None, Option(help="The same CoC everywhere, instead of one from depth.")] = None,
    coc_blur: Annotated[bool, Option("--coc-blur/--no-coc-blur", help="Average the CoC with the colour.")] = True,
    leak_fix: Annotated[bool, Option("--leak-fix/--no-leak-fix", help="Listing 3's leakage test.")] = True,
    depth_channel: Annotated[str, Option(help="Depth in metres, as Z, ViewLayer.Depth.Z, or PART.Z.")] = "Z",
    layer: Annotated[str | None, Option(help="Layer or part that has R, G and B: ViewLayer.Combined.")] = None,
    driver: terminal.OneDriver = None,
    adapter: terminal.Adapter = None,
    png: Annotated[Path | None, Option(help="Write a tone-mapped picture as well.")] = None,
) -> None:
    """Blur an EXR with the shaders on a real driver."""
    settings = methods.Settings(
        method, aperture, samples, rotation, coc=coc, blur_coc=coc_blur, leak_fix=leak_fix, spacing=spacing,
        max_samples=max_samples, jitter=jitter, frame=frame, squeeze=squeeze, targets=targets, preset=preset,
        cats_eye=cats_eye, roundness=roundness, lateral=lateral, axial=(axial_red, axial_blue),
        camera=methods.Camera(aperture_diameter, focal_length, focus_distance, sensor_height, max_coc),
    )  # fmt: skip
    check(settings)
    terminal.check_writable(target, png)
    scene = exr.read(source, None if coc is not None else depth_channel, layer)
    used = terminal.pick_driver(driver, adapter)
    made = methods.plan(settings, scene.size)
    depth = scene.depth if scene.depth is not None else np.ones((scene.size[1], scene.size[0]), np.float32)
    textures = {"color": scene.color, "depth": depth, **made.tables}
    try:
        result = used.run(made.passes, textures, scene.size, scene.storage)["result"]
    except Unavailable as error:
        raise UserError(f"--driver {used.name}: {error}.") from error
    exr.write(target, result)
    if png is not None:
        pictures.write_png(png, pictures.display(result, tone_map=True))
    size = f"{result.shape[1]} x {result.shape[0]}"
    terminal.console.print(f"{target}: {size}, {result.dtype}, by {used.name} ({used.adapter})")
