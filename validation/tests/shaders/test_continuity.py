"""Test that small steps of CoC, focus distance and position of a small highlight change the image in small steps.

Every pass of every frame must stay within a bound derived from how far samples move (tests/sweep.py).
"""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest
import rays
import sweep
from support import LANGUAGES, load
from support_cases import everything, float_result, noise_case

from bokeh_validation.drivers.base import Driver
from bokeh_validation.frame import methods
from bokeh_validation.numerics import precision
from bokeh_validation.probes.model import Case, depth_of, flat
from bokeh_validation.truth import ray_traced

WIDE = methods.Camera(max_coc=1.0)
SIZE = (72, 64)
COARSE, FINE = 1 / 8, 1 / 64  # pixels of CoC from frame to frame
METHODS = {
    "paper, 13 samples": methods.Settings("paper", "hexagon", camera=WIDE),
    "paper, spacing 1": methods.Settings("paper", "hexagon", camera=WIDE, spacing=1.0),
    "exact, 7 samples": methods.Settings("exact", "hexagon", 7, camera=WIDE),
    "exact, spacing 1": methods.Settings("exact", "hexagon", camera=WIDE, spacing=1.0),
    "exact, spacing 2, at most 4": methods.Settings("exact", "octagon", camera=WIDE, spacing=2.0, samples=4),
}
# every method on egl, and one driver per other language on the two methods whose sample count follows the CoC
RUNS = [("egl", name) for name in METHODS] + [(d, n) for d in LANGUAGES[1:] for n in METHODS if "spacing 1" in n]


def picture(settings: methods.Settings) -> Case:
    """Return patches with hard edges, noise, and highlights of one and of nine pixels, a hundred times as bright."""
    case = noise_case(SIZE, settings)
    case.color[20, 30, :3] = 300.0
    case.color[40:43, 45:48, :3] = 100.0
    return case


def frame(driver: Driver, case: Case) -> dict[str, np.ndarray]:
    """Draw everything that the passes write; returns target -> green and CoC, (H, W, 2) float64."""
    return {name: image[..., [1, 3]].astype(np.float64) for name, image in everything(driver, case).items()}


def worst(driver: Driver, case: Case, frames: Iterable[methods.Settings]) -> list[float]:
    """Return for each frame the largest change of a pixel in any pass, relative to what sweep.allowed() permits."""
    worst_of_frames, before = [], None
    for settings in frames:
        frame_case = replace(case, settings=settings)
        after = frame(driver, frame_case)
        if before is not None:
            shares = [0.0]
            for render_pass in frame_case.plan.passes[1:]:
                bound = sweep.allowed(render_pass, before, after)[..., 0]
                shares += [(np.abs(after[name] - before[name])[..., 0] / bound).max() for name in render_pass.outputs]
            worst_of_frames.append(max(shares))
        before = after
    return worst_of_frames


@pytest.mark.parametrize(("driver", "method"), RUNS)
def test_coc_sweep(driver, method):
    """Sweep the CoC from 0 to 0.2 of the height in steps of 1/8 pixel: no pixel of any pass changes more than its
    samples' moves allow.

    Where the blur begins and samples are added, steps are 1/64 pixel: there the bound is eight times smaller, while a
    jump in the image would not be.
    """
    base = METHODS[method]
    case = picture(base)
    # where the blur begins, and where a line of one pixel gets a second sample
    sweeps = [np.arange(0.45, 1.1, FINE), np.arange(1.95, 2.1, FINE)]
    if driver == "egl":
        sweeps.append(np.arange(0.0, 0.2 * SIZE[1], COARSE))
    for pixels in sweeps:
        shares = worst(load(driver), case, (replace(base, coc=float(c) / SIZE[1]) for c in pixels))
        assert max(shares) <= 1.0, (pixels[int(np.argmax(shares))], max(shares))


FOCUS = np.linspace(2.0, 30.0, 36)  # metres, 0.8 per frame


def scene_crop(settings: methods.Settings) -> Case:
    """Return a part of a ray-traced scene with near and far objects."""
    scene = ray_traced.scene_case(ray_traced.STREET, "paper", "hexagon")
    return Case("", settings, scene.color[200:272, 280:376].copy(), scene.depth[200:272, 280:376].copy())


@pytest.mark.parametrize("method", ["paper, spacing 1", "exact, spacing 1", "exact, 7 samples"])
def test_rack_focus(method):
    """Pull the focus through a scene with the CoC from depth: the same bound in every pass, with the
    leakage test off.
    """
    camera = methods.Camera(0.05, 0.05, 5.0, max_coc=0.15)
    base = replace(METHODS[method], camera=camera, leak_fix=False)
    case = scene_crop(base)
    settings = (replace(base, camera=replace(camera, focus_distance=float(s))) for s in FOCUS)
    shares = worst(load("egl"), case, settings)
    assert max(shares) <= 1.0, (FOCUS[int(np.argmax(shares))], max(shares))


def test_a_ray_has_no_step():
    """Check that the weights of a ray change by no more than the derivative of their formula times the change of the
    CoC.

    Both CoC enter only through r, the sample's over the pixel's. Behind the focus sample i of N has the weight
    clamp(|r| N - i, 0, 1) / max(|r|, 1/4): per unit of r, the clamp changes that by 4 N, and 1 / |r| by 16. In front
    of it the weight changes by 4, where the half ramps in over an eighth.
    """
    count, step = 9.0, 1e-5
    begin, end = (np.arange(9)[:, None] + np.array([0.0, 1.0])).T[..., None] / count
    ratio = np.arange(-2.0, 2.0, step)
    steepest = 4.0 * count + 16.0
    for center in (0.04, -0.04):
        weight, reached = rays.weights(ratio * center, np.float64(center), begin, end)
        for values, slope in ((weight, steepest), (reached, count)):
            assert np.abs(np.diff(values * count)).max() <= 1.001 * slope * step


def planes(settings: methods.Settings) -> Case:
    """Return a dark half at 2 m next to a bright half at 10 m."""
    size = (64, 128)
    color, depth = flat(size, 1.0), depth_of(size, 10.0)
    color[:, :32, :3], depth[:, :32] = 0.05, 2.0
    return Case("", settings, color, depth)


@pytest.mark.parametrize(("method", "steps"), [("paper, spacing 1", True), ("exact, spacing 1", False)])
def test_the_leakage_test(method, steps):
    """Check that the image steps in the frame where Listing 3's test flips, and that the weights of `exact` ramp
    instead.

    The dark half at 2 m comes into focus in 50 frames, and in 400. A continuous change is smaller in one of eight
    substeps than in all: an eighth if it is even; the bound is a half. A step happens within a single substep.
    """
    camera = methods.Camera(0.0285, 0.05, 5.0, max_coc=0.2)
    case = planes(replace(METHODS[method], camera=camera))
    pictures = []
    for distance in np.linspace(2.3, 2.05, 401):
        settings = replace(case.settings, camera=replace(camera, focus_distance=float(distance)))
        pictures.append(float_result(load("egl"), replace(case, settings=settings))[..., 1].astype(np.float64))
    fine = np.abs(np.diff(pictures, axis=0)).max(axis=(1, 2)).reshape(50, 8).max(axis=1)
    whole = np.abs(np.diff(pictures[::8], axis=0)).max(axis=(1, 2))
    worst_frame = whole.argmax()
    assert (fine[worst_frame] > 0.9 * whole[worst_frame]) == steps
    assert (fine[worst_frame] < 0.5 * whole[worst_frame]) != steps


def highlight(settings: methods.Settings, diameter: float, place: float) -> Case:
    """Return a disc on black, centred `place` pixels to the right and half as many below a pixel's centre."""
    size = (96, 72)
    color = flat(size)
    color[..., :3] = (1000.0 * sweep.disc(size, (48.5 + place, 36.5 + place / 2), diameter))[..., None]
    return Case("", settings, color, depth_of(size, 5.0))


@pytest.mark.parametrize("pixels", [0.0, 0.6, 0.75, 0.9, 24.0], ids="CoC {:g} px".format)
@pytest.mark.parametrize("changes", [{"spacing": 1.0}, {"spacing": 0.5}, {"samples": 7}], ids=str)
def test_a_small_highlight_keeps_its_light(changes, pixels):
    """Check that a disc of 0.7 pixels that moves by 1/16 pixel per frame keeps its light: in focus, fading in, and
    blurred.

    A sample distributes its light completely wherever it is. Its position is off by e, so the light of a pass by 2 e
    on each axis; the sums round by (N + 8) 2^-24.
    """
    settings = methods.Settings("exact", "hexagon", camera=WIDE, coc=pixels / 72, **changes)
    allowed = 2 * (4 * precision.SOFTWARE.place(96) + (settings.count + 8) * precision.FLOAT_STEP)
    for place in np.arange(16) / 16:
        case = highlight(settings, 0.7, place)
        put_in = case.color[..., 1].astype(np.float64).sum()
        light = float_result(load("egl"), case)[..., 1].sum() / put_in
        assert abs(light - 1.0) <= allowed, place
