"""The command `validation/run compare`: an engine's result beside ours, and the mistake that explains the difference.

Mistakes are made on purpose, one after the other; the picture that is nearest to the engine's names its mistake. How
near: the mean over all pixels of log2(1 + steps), which neither a few lights nor the size of a large error decides.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated

import numpy as np
from typer import Argument, Option

from bokeh_validation import exr, metrics, options, render, terminal
from bokeh_validation.drivers.base import Driver
from bokeh_validation.errors import Unavailable, UserError
from bokeh_validation.exr import Scene
from bokeh_validation.frame import methods
from bokeh_validation.frame.methods import Settings
from bokeh_validation.numerics.images import STORAGE
from bokeh_validation.reference.listings import DEPTH_KINDS, linear_depth, stored_depth

# What an engine's depth buffer may hold, and may have been read as
KINDS = ("window", "reversed", "infinite", "clip", "metres", "fraction")
# A mistake is named where it is nearer by so much: less is how devices round and filter
NEARER = 0.5
# The same picture, where a clamped CoC hides what they differ in
AS_NEAR = 0.01
INFINITE_STEPS = 2.0**16
Change = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Mistake:
    """What an engine may have done differently: settings, changes of rgb and metres, of its result, and its targets."""

    name: str
    advice: str
    settings: Settings
    color: Change = np.asarray
    depth: Change = np.asarray
    result: Change = np.asarray
    storage: str = "half"

    def rendered(self, driver: Driver, scene: Scene) -> np.ndarray:
        """Its picture, (H, W, 3) float64. Raises Unavailable."""
        plan = methods.plan(self.settings, scene.size)
        color, depth = scene.color.copy(), self.depth(scene.depth).astype(np.float32)
        color[..., :3] = self.color(color[..., :3].astype(np.float64))
        textures = {"color": color, "depth": depth, **plan.tables}
        result = driver.run(plan.passes, textures, scene.size, self.storage)["result"]
        return self.result(result[..., :3].astype(np.float64))


def to_srgb(linear: np.ndarray) -> np.ndarray:
    """Linear light as sRGB encodes it; its curve goes on above 1."""
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 0.0) ** (1 / 2.4) - 0.055)


def mistakes(settings: Settings, near: float, far: float) -> Iterator[Mistake]:
    """All that make sense of some settings; near, far: the camera's planes, metres."""
    flip = "Row 0 of every texture is the top of the picture: turn v round once, at the end (docs/troubleshooting.md)."
    yield Mistake("the result is upside down: v is flipped", flip, settings, result=np.flipud)
    linear = "Blur linear light, before tone mapping, and write the EXR from the target as it is."
    yield Mistake("the result is sRGB, not linear", linear, settings, result=to_srgb)
    yield Mistake("the colour that was blurred is sRGB, not linear", linear, settings, color=to_srgb)
    if settings.rotation:
        turned = replace(settings, rotation=-settings.rotation)
        yield Mistake("the rotation's sign is the other one", "Angles go from +x towards +y, which is down.", turned)
    yield from _presets(settings)
    yield from _depths(settings, near, far) if settings.coc is None else ()


def _presets(settings: Settings) -> Iterator[Mistake]:
    """Layered has presets of its own; in exact and paper they are a number of samples and their spacing."""
    for name in methods.PRESETS if settings.method != "naive" else ():
        samples, spacing = methods.EXACT_PRESETS[name]
        other, given = replace(settings, samples=samples, spacing=spacing), f"--samples {samples} --spacing {spacing}"
        if settings.method != "paper":
            other, given = replace(settings, preset=name, samples=None, spacing=None), f"--preset {name}"
        if other != settings:
            yield Mistake(f"it is preset {name.upper()}", f"If that is meant, compare with {given}.", other)


def _depths(settings: Settings, near: float, far: float) -> Iterator[Mistake]:
    """Depth of another sign about the focus, or of another kind."""
    focus = settings.camera.focus_distance

    def mirrored(depth: np.ndarray) -> np.ndarray:
        # whose CoC has the other sign: 1 / S1 is midway between 1 / S2 and its own; farther than infinity: at infinity
        return focus / np.maximum(2.0 - focus / np.maximum(depth, 1e-6), 1e-9)

    def misread(held: int, read: int, depth: np.ndarray) -> np.ndarray:
        inside = np.clip(depth.astype(np.float64), near, far)
        return linear_depth(stored_depth(inside, held, near, far), read, near, far)

    flip = "Row 0 of the depth buffer is the top of the picture too."
    yield Mistake("depth is upside down: its v is flipped", flip, settings, depth=np.flipud)
    if settings.method in options.POLYGON_METHODS:
        signed = "It is negative before the focus, and positive after it (docs/inputs.md)."
        yield Mistake("the CoC's sign is the other one", signed, settings, depth=mirrored)
        yield Mistake("the CoC has no sign", signed, settings, depth=lambda z: np.where(z < focus, mirrored(z), z))
    for held, read in ((held, read) for held in KINDS[:4] for read in KINDS if held != read):
        kinds = DEPTH_KINDS[held], DEPTH_KINDS[read]
        name = f"the depth is {held} and was read as {read}"
        yield Mistake(name, f"BokehDepthKind is {kinds[0]} ({held}).", settings, depth=partial(misread, *kinds))


def _distance(result: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Half-float steps between two pictures (H, W, 3), the most of the channels, (H, W)."""
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
    far: Annotated[float, Option(help="Its far plane.")] = 1000.0,
    depth_channel: render.DepthChannel = None,
    layer: render.Layer = None,
    driver: terminal.OneDriver = None,
    adapter: terminal.Adapter = None,
) -> None:
    """How far an engine's result is from ours, and the likeliest mistake."""
    if not 0 < near < far < np.inf:
        raise UserError(f"--near {near:g} --far {far:g}: not allowed. Give 0 < near < far, in metres.")
    scene, theirs = render.read(source, settings, depth_channel, layer), exr.read(result, None)
    if scene.size != theirs.size:
        raise UserError(f"{result}: {theirs.size} pixels, the input has {scene.size}. Render it at the input's size.")
    used, pixels = terminal.pick_driver(driver, adapter), theirs.color[..., :3].astype(np.float64)
    (steps, nearest), *_ = _nearest([Mistake("", "", settings, storage=name) for name in STORAGE], used, scene, pixels)
    terminal.tell(
        f"{result} beside {settings.method} {settings.aperture} by {used.name} ({used.adapter}): {_shares(steps)}",
        f"nearest to {nearest.storage} targets; the input has {scene.storage} colour. Either kind of target is right",
    )
    bound = metrics.CLOSE_STEPS
    if (steps <= bound).mean() < metrics.CLOSE_SHARE:
        likeliest = _nearest(list(mistakes(settings, near, far)), used, scene, pixels)
        (explained, mistake), bound = likeliest[0], metrics.FAR_STEPS
        if _score(explained) < NEARER * _score(steps):
            names = "; or ".join(mistake.name for _, mistake in likeliest)
            terminal.tell(f"likeliest mistake: {names}. With it, {_shares(explained)}. {mistake.advice}")
            terminal.end(False)
    same = (steps <= bound).mean() >= metrics.CLOSE_SHARE
    terminal.tell(
        "the same" if same else "not the same, and by no mistake that compare knows. See docs/troubleshooting.md."
    )
    terminal.end(same)


def _nearest(candidates: list[Mistake], driver: Driver, scene: Scene, pixels: np.ndarray) -> list:
    """(steps, mistake) of the nearest, and of others that make the same picture. Raises UserError."""
    tried: list[tuple[np.ndarray, Mistake]] = []
    with terminal.progress("rendering", len(candidates)) as step:
        for candidate in candidates:
            try:
                tried.append((_distance(pixels, candidate.rendered(driver, scene)), candidate))
            except Unavailable as error:
                # several float targets may be more than a device writes at once
                if candidate.storage == "half":
                    raise UserError(f"--driver {driver.name}: {error}.") from error
            step(candidate.name)
    best = min(_score(steps) for steps, _ in tried)
    return [(steps, candidate) for steps, candidate in tried if _score(steps) <= best + AS_NEAR]
