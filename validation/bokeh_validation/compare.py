"""Find out which mistake explains an engine's result: the command `validation/run compare`.

Known mistakes are made on purpose, one at a time; the image nearest to the engine's names the likeliest mistake. The
distance between two images is the mean over all pixels of log2(1 + steps), so that neither a few lights nor the size
of one large error decides.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated

import numpy as np
from typer import Argument, Option

from bokeh_validation import drivers, exr, metrics, options, plan, render, shaders, terminal
from bokeh_validation.drivers.base import Driver
from bokeh_validation.errors import Unavailable, UserError
from bokeh_validation.exr import Scene
from bokeh_validation.frame import methods
from bokeh_validation.frame.methods import Settings
from bokeh_validation.numerics.images import STORAGE
from bokeh_validation.reference.listings import DEPTH_KINDS, linear_depth, stored_depth
from bokeh_validation.shaders.parameters import PARAMETERS
from bokeh_validation.shaders.passes import Pass

# Kinds of depth that an engine's buffer may hold, and that it may have been mistaken for
KINDS = ("window", "reversed", "infinite", "clip", "metres", "fraction")
# A mistake is named only if it reduces the distance at least by this factor; devices' rounding and filtering differ by
# less
NEARER = 0.5
# Distances closer than this are ties, such as two mistakes that a clamped CoC makes equal
AS_NEAR = 0.01
INFINITE_STEPS = 2.0**16
# Focal lengths in metres to try instead of the one given
FOCAL_LENGTHS = (0.024, 0.028, 0.035, 0.05, 0.07, 0.085, 0.1, 0.135, 0.2)
# Parameters that describe the depth buffer; the EXR holds metres, so they need not agree
DEPTH_PARAMETERS = ("BokehDepthKind", "BokehNear", "BokehFar")
# Relative error that float32 and a few typed decimals leave
SAME_VALUE = 1e-4
# Replaces the linear filter by a fetch of the nearest texel; GLSL only, hence these drivers
GLSL_DRIVERS = ("egl", "osmesa")
NEAREST = """#define textureLod(name, uv, level) texelFetch(name, BokehNearestTexel(uv, textureSize(name, 0)), 0)
ivec2 BokehNearestTexel(vec2 uv, ivec2 size) { return clamp(ivec2(floor(uv * vec2(size))), ivec2(0), size - 1); }
"""
Change = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Mistake:
    """Describe a mistake that an engine may have made.

    name, advice   printed for the user
    settings       of the frame that has the mistake
    color, depth   changes of the input: linear rgb, metres
    result         change of the finished image
    storage        format of the targets, a key of STORAGE
    passes         change of each pass's program
    drivers        names of the drivers that can draw it; empty for all
    """

    name: str
    advice: str
    settings: Settings
    color: Change = np.asarray
    depth: Change = np.asarray
    result: Change = np.asarray
    storage: str = "half"
    passes: Callable[[Pass], Pass] = lambda item: item
    drivers: tuple[str, ...] = ()

    def rendered(self, driver: Driver, scene: Scene) -> np.ndarray:
        """Draw the scene with this mistake; returns (H, W, 3) float64. Raises Unavailable."""
        frame = methods.plan(self.settings, scene.size)
        color, depth = scene.color.copy(), self.depth(scene.depth).astype(np.float32)
        color[..., :3] = self.color(color[..., :3].astype(np.float64))
        textures = {"color": color, "depth": depth, **frame.tables}
        result = driver.run(list(map(self.passes, frame.passes)), textures, scene.size, self.storage)["result"]
        return self.result(result[..., :3].astype(np.float64))


def to_srgb(linear: np.ndarray) -> np.ndarray:
    """Encode linear light, an array of any shape, as sRGB; the curve is continued above 1."""
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 0.0) ** (1 / 2.4) - 0.055)


def mistakes(settings: Settings, near: float, far: float, read: float | None = None) -> Iterator[Mistake]:
    """Yield every mistake that makes sense with these settings.

    near, far  distances of the camera's near and far planes, metres
    read       the BokehDepthKind that the engine sets, or None if unknown
    """
    flip = "Row 0 of every texture must be the top of the image. Flip v once, at the end (docs/troubleshooting.md)."
    yield Mistake("the result is upside down: v is flipped", flip, settings, result=np.flipud)
    linear = "Blur linear light, before tone mapping, and write the unchanged target to the EXR."
    yield Mistake("the result is sRGB, not linear", linear, settings, result=to_srgb)
    yield Mistake("the colour that was blurred is sRGB, not linear", linear, settings, color=to_srgb)
    if settings.rotation:
        turned = replace(settings, rotation=-settings.rotation)
        yield Mistake(
            "the rotation's sign is wrong", "A positive angle turns from +x towards +y, which points down.", turned
        )
    filtered = "Every texture except depth needs a clamped sampler with a linear filter."
    yield Mistake(
        "a texture is read without a linear filter", filtered, settings, passes=_unfiltered, drivers=GLSL_DRIVERS
    )
    yield from _others(settings)
    yield from _presets(settings)
    if settings.coc is None:
        yield from _lenses(settings)
        yield from _depths(settings, near, far, read)


def _unfiltered(render_pass: Pass) -> Pass:
    """Return the pass with a program that reads the nearest texel instead of filtering."""
    version, _, body = shaders.glsl(render_pass.entry, "330", render_pass.constants).partition("\n")
    return replace(render_pass, sources={"glsl": f"{version}\n{NEAREST}{body}"})


def _with_alpha(render_pass: Pass, expression: str) -> Pass:
    """Return the CoC map's pass with a program that changes its result's alpha; other passes stay as they are.

    expression  GLSL of the new alpha, with BokehResult.a as the signed CoC
    """
    if render_pass.entry != plan.SIGNED_MAP:
        return render_pass
    program = shaders.glsl(render_pass.entry, "330", render_pass.constants).replace("void main()", "void bokehMap()")
    new_main = f"\nvoid main()\n{{\n    bokehMap();\n    BokehResult.a = {expression};\n}}\n"
    return replace(render_pass, sources={"glsl": program + new_main})


def _others(settings: Settings) -> Iterator[Mistake]:
    """Yield other methods and other polygons."""
    for name in ("layered", "exact", "paper"):
        other = replace(settings, method=name, samples=None, spacing=None)
        if name != settings.method and (name == "paper" or settings.aperture in methods.EXACT):
            yield Mistake(f"the method is {name}", f"If you want {name}, compare with --method {name}.", other)
    for name in methods.EXACT:
        if name != settings.aperture:
            advice = f"If you want it, compare with --aperture {name}; else check BokehSides and the entry points."
            yield Mistake(f"the polygon's shape is {name}", advice, replace(settings, aperture=name))


def _lenses(settings: Settings) -> Iterator[Mistake]:
    """Yield other focal lengths, and the sensor's width mistaken for its height."""
    camera = settings.camera
    for length in FOCAL_LENGTHS:
        if length not in (camera.focal_length, camera.focus_distance) and length < camera.focus_distance:
            advice = (
                f"If that is your lens, compare with --focal-length {length:g}; else set BokehFocalLength, in metres."
            )
            lens = replace(settings, camera=replace(camera, focal_length=length))
            yield Mistake(f"the focal length is {length:g} m", advice, lens)
    wide = replace(settings, camera=replace(camera, sensor_height=1.5 * camera.sensor_height))
    yield Mistake("BokehSensorHeight is the sensor's width", "The height of a full-frame sensor is 0.024 m.", wide)


def _presets(settings: Settings) -> Iterator[Mistake]:
    """Yield the other presets. `layered` has named presets; in exact and paper a preset is a sample count with its
    spacing, and MOBILE is the same as LOW.
    """
    names = [name for name in methods.PRESETS if settings.method == "layered" or name != "mobile"]
    for name in names if settings.method != "naive" else ():
        samples, spacing = methods.EXACT_PRESETS[name]
        other = replace(settings, samples=samples, spacing=spacing)
        option_text = f"--samples {samples} --spacing {spacing}"
        if settings.method != "paper":
            other = replace(settings, preset=name, samples=None, spacing=None)
            option_text = f"--preset {name}"
        if other != settings:
            yield Mistake(f"the preset is {name.upper()}", f"If you want it, compare with {option_text}.", other)


def _depths(settings: Settings, near: float, far: float, set_kind: float | None) -> Iterator[Mistake]:
    """Yield depth that is flipped, has the wrong sign about the focus distance, or was read as another kind."""

    def misread(stored_kind: int, read_kind: int, depth: np.ndarray) -> np.ndarray:
        inside = np.clip(depth.astype(np.float64), near, far)
        return linear_depth(stored_depth(inside, stored_kind, near, far), read_kind, near, far)

    flip = "Row 0 of the depth buffer must be the top of the image too."
    yield Mistake("the depth is upside down: its v is flipped", flip, settings, depth=np.flipud)
    if settings.method in options.POLYGON_METHODS:
        signed = "The CoC is negative in front of the focus, and positive behind it (docs/inputs.md)."
        for name, alpha in (
            ("the CoC's sign is wrong", "-BokehResult.a"),
            ("the CoC has no sign", "abs(BokehResult.a)"),
        ):
            yield Mistake(name, signed, settings, passes=partial(_with_alpha, expression=alpha), drivers=GLSL_DRIVERS)
    for stored_kind, read_kind in (
        (stored_kind, read_kind) for stored_kind in KINDS[:4] for read_kind in KINDS if stored_kind != read_kind
    ):
        kinds = DEPTH_KINDS[stored_kind], DEPTH_KINDS[read_kind]
        if set_kind not in (None, kinds[1]):
            continue
        name = f"the depth buffer holds {stored_kind} depth, but was read as {read_kind}"
        advice = f"If BokehDepthKind is {kinds[1]} ({read_kind}) now, set it to {kinds[0]} ({stored_kind})."
        yield Mistake(name, advice, settings, depth=partial(misread, *kinds))


def _distance(result: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Return the largest difference over the channels in half-float steps, (H, W), between two images (H, W, 3)."""
    opaque = (np.concatenate([pixels, np.ones_like(pixels[..., :1])], axis=-1) for pixels in (result, expected))
    return np.minimum(metrics.steps(*opaque), INFINITE_STEPS)


def _score(steps: np.ndarray) -> float:
    return float(np.log2(1.0 + steps).mean())


def _shares(steps: np.ndarray) -> str:
    close, far = (100 * (steps <= bound).mean() for bound in (metrics.CLOSE_STEPS, metrics.FAR_STEPS))
    return f"{close:.2f} % within {metrics.CLOSE_STEPS} half-float steps, {far:.2f} % within {metrics.FAR_STEPS}"


@options.with_settings
def compare(
    source: render.Source,
    result: Annotated[Path, Argument(metavar="RESULT.exr", help="What your engine made of it, linear R G B.")],
    settings: Settings,
    near: Annotated[float, Option(help="Your camera's near plane, metres, to recognise a depth buffer.")] = 0.1,
    far: Annotated[float, Option(help="Your camera's far plane, metres.")] = 1000.0,
    depth_channel: render.DepthChannel = None,
    layer: render.Layer = None,
    sets: options.Sets = None,
    driver: terminal.OneDriver = None,
    adapter: terminal.Adapter = None,
) -> None:
    """Compare an engine's result with ours, and name the likeliest mistake."""
    if not 0 < near < far < np.inf:
        raise UserError(f"--near {near:g} --far {far:g}: not allowed. Give 0 < near < far, in metres.")
    engine_values = options.parsed_sets(sets)
    near, far = engine_values.get("BokehNear", near), engine_values.get("BokehFar", far)
    scene, theirs = render.read(source, settings, depth_channel, layer), exr.read(result, None)
    if scene.size != theirs.size:
        raise UserError(f"{result}: {theirs.size} pixels, the input has {scene.size}. Render it at the input's size.")
    active_driver, pixels = drivers.pick(driver, adapter), theirs.color[..., :3].astype(np.float64)
    (steps, nearest), *_ = _nearest(
        [Mistake("", "", settings, storage=name) for name in STORAGE], active_driver, scene, pixels
    )
    terminal.tell(
        f"{result} beside {settings.method} {settings.aperture} by {active_driver.name} ({active_driver.adapter}): "
        f"{_shares(steps)}",
        f"It is nearest to {nearest.storage} targets, and the input has {scene.storage} colour. Both kinds are right.",
    )
    terminal.tell(*_set_otherwise(engine_values, settings, scene.size))
    bound = metrics.CLOSE_STEPS
    if (steps <= bound).mean() < metrics.CLOSE_SHARE:
        likeliest = _nearest(
            list(mistakes(settings, near, far, engine_values.get("BokehDepthKind"))), active_driver, scene, pixels
        )
        explained, bound = likeliest[0][0], metrics.FAR_STEPS
        if _score(explained) < NEARER * _score(steps):
            tie_text = f"one of {len(likeliest)} that result in the same image: " if len(likeliest) > 1 else ""
            for _, mistake in likeliest:
                terminal.tell(f"likeliest mistake: {tie_text}{mistake.name}. {mistake.advice}")
            terminal.tell(f"with it, {_shares(explained)}")
            terminal.end(False)
    same = (steps <= bound).mean() >= metrics.CLOSE_SHARE
    terminal.tell(
        "the same"
        if same
        else "not the same, and no mistake that compare knows explains it. See docs/troubleshooting.md."
    )
    terminal.end(same)


def _set_otherwise(engine_values: dict[str, float], settings: Settings, size: tuple[int, int]) -> Iterator[str]:
    """Yield a line for each parameter that the engine sets to another value; parameters of the depth buffer are
    skipped.
    """
    passes = methods.plan(settings, size).passes
    for name, value in engine_values.items():
        ours = {render_pass.values()[name] for render_pass in passes if name in render_pass.parameters}
        ours = ours or {PARAMETERS[name]}
        if name not in DEPTH_PARAMETERS and not any(abs(value - our) <= SAME_VALUE * abs(our) for our in ours):
            yield f"{name} is {value:g} in your engine and {' or '.join(f'{our:g}' for our in sorted(ours))} here"


def _nearest(candidates: list[Mistake], driver: Driver, scene: Scene, pixels: np.ndarray) -> list:
    """Draw every candidate and return (steps, mistake) for the nearest one and its ties, in the candidates' order.

    pixels  the engine's result, (H, W, 3) float64
    Raises UserError if the driver cannot draw into half-float targets.
    """
    tried: list[tuple[np.ndarray, Mistake]] = []
    with terminal.progress("rendering", len(candidates)) as step:
        for candidate in candidates:
            if candidate.drivers and driver.name not in candidate.drivers:
                continue
            try:
                tried.append((_distance(pixels, candidate.rendered(driver, scene)), candidate))
            except Unavailable as error:
                # a device may lack support for writing several float targets at once
                if candidate.storage == "half":
                    raise UserError(f"--driver {driver.name}: {error}.") from error
            step(candidate.name)
    best = min(_score(steps) for steps, _ in tried)
    return [(steps, candidate) for steps, candidate in tried if _score(steps) <= best + AS_NEAR]
