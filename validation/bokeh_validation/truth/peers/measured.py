"""What is measured of the effects and of ours, on a scene and of one light."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from bokeh_validation import drivers, metrics, truth
from bokeh_validation.frame import fetches, polygons
from bokeh_validation.frame.methods import Camera
from bokeh_validation.probes.highlight import AMBIENT, PEAK
from bokeh_validation.probes.model import Case, depth_of, overlap, pixel_center
from bokeh_validation.probes.shapes import outline
from bokeh_validation.truth import ray_traced
from bokeh_validation.truth.peers import counted, crate
from bokeh_validation.truth.peers.effects import EFFECTS, Effect, Page, Parameters

OURS = ("paper", "exact", "layered low", "layered medium")
DRIVER = "webgl2"  # the device that the others are on
# One light of 3 x 3 pixels, so far away that its circle of confusion is that at infinity, 34 pixels
LIGHT, FAR = 3, 10000.0
LIGHT_SIZE, LIGHT_COC = (270, 270), 34
LIGHT_CAMERA = Camera(LIGHT_COC / 270 * 0.024 * 2.37 / 0.05, 0.05, 2.42, 0.024, 0.15)
# Pictures of a search are compared at a quarter of their size: FLIP takes longer than an effect
SMALLER = 4
STEPS = (0.5, 0.8)  # of a parameter in a search
# Effect -> its parameters; None: they are searched
Chosen = dict[str, Parameters | None]


class Drawn(NamedTuple):
    """An effect on a scene; fetches: a pixel at the most, see counted.py, of ours see fetches.py."""

    scene: str
    effect: str
    parameters: Parameters
    flip: float
    psnr: float
    light: float
    fetches: float


class Shape(NamedTuple):
    """One light: its overlap with the aperture (probes.model.overlap, the light of both being the same), and the share
    of its light that is kept."""

    parameters: Parameters
    overlap: float
    light: float


def search(effect: Effect, start: Parameters, error: Callable[[Parameters], float]) -> Parameters:
    """Parameters with the least error: each number smaller or larger and each option tried, as long as it gets better.

    start  where it begins: what the documentation asks for
    """
    best, least = start, error(start)
    for step in STEPS:
        before = None
        while before != best:
            before = best
            trials = [{name: best[name] * factor} for name in effect.numbers for factor in (step, 1 / step)]
            trials += [{name: value} for name, values in effect.options.items() for value in values]
            for trial in trials:
                if (distance := error(best | trial)) < least:
                    best, least = best | trial, distance
    return best


def scene(name: str, chosen: Chosen) -> tuple[list[Drawn], dict[str, np.ndarray]]:
    """Rows and pictures of a scene; ours among them. Effects with parameters None: the best are searched."""
    (file,) = ray_traced.chosen([name])
    lens, images, rows = ray_traced.truth(file, "hexagon"), {}, []
    for effect, (parameters, image, count) in _of_effects(file, chosen, lens).items() if chosen else ():
        images[effect] = image
        rows.append(Drawn(name, effect, parameters, *truth.measured(image, lens).values(), count))
    for label in OURS:
        images[label] = truth.picture(drivers.load(DRIVER), file, label)
        count = sum(fetches.of_frame(truth.case(file, label).plan.passes).values())
        rows.append(Drawn(name, label, {}, *truth.measured(images[label], lens).values(), count))
    return rows, images


def _of_effects(file: ray_traced.SceneFile, chosen: Chosen, lens: np.ndarray) -> dict:
    """Effect -> parameters, picture, fetches."""
    picture, drawn = ray_traced.picture(file), {}
    with Page() as page:
        page.load(picture.color, picture.depth, file.camera)

        def error(effect: str, parameters: Parameters) -> float:
            return metrics.flip(_small(page.draw(effect, parameters)), _small(lens))

        for name, given in chosen.items():
            effect = EFFECTS[name]
            used = given or search(effect, page.documented(name), partial(error, name))
            if effect.package == crate.NAME:
                count = counted.of_bevy(name, used["maxDiameter"])
            else:
                count = counted.fetches(page.draws(name, used))
            drawn[name] = used, page.draw(name, used), count
    return drawn


def _small(image: np.ndarray) -> np.ndarray:
    height, width = (side // SMALLER for side in image.shape[:2])
    cells = image[: height * SMALLER, : width * SMALLER, :3].astype(np.float32)
    return cells.reshape(height, SMALLER, width, SMALLER, 3).mean(axis=(1, 3))


def shapes(chosen: Chosen) -> dict[str, Shape]:
    """Of effects, and of ours. Those with parameters None: the largest overlap is searched."""
    middle = [(side - LIGHT) // 2 for side in LIGHT_SIZE]
    color = np.full((*LIGHT_SIZE[::-1], 4), AMBIENT, np.float16)
    color[middle[1] : middle[1] + LIGHT, middle[0] : middle[0] + LIGHT] = PEAK
    depth = depth_of(LIGHT_SIZE, FAR)
    before = (color[..., 1].astype(np.float64) - AMBIENT).sum()
    hexagon = LIGHT_COC * outline(truth.case(ray_traced.MARKET, "exact").settings)
    blurred = polygons.coverage(hexagon, LIGHT_SIZE, pixel_center(*(side // 2 for side in LIGHT_SIZE)))
    reach = range(-(LIGHT // 2), LIGHT // 2 + 1)
    expected = sum(np.roll(blurred, (y, x), (0, 1)) for y in reach for x in reach)

    def shape(image: np.ndarray, parameters: Parameters) -> Shape:
        light = image[..., 1].astype(np.float64) - AMBIENT
        return Shape(parameters, overlap(light / light.sum(), expected / expected.sum()), float(light.sum() / before))

    measured = {}
    if chosen:
        with Page() as page:
            page.load(color, depth, LIGHT_CAMERA)

            def drawn(effect: str, parameters: Parameters) -> Shape:
                return shape(page.draw(effect, parameters), parameters)

            for name, given in chosen.items():
                error = lambda tried, name=name: 1.0 - drawn(name, tried).overlap  # noqa: E731
                measured[name] = drawn(name, given or search(EFFECTS[name], page.documented(name), error))
    for label in OURS:
        settings = replace(truth.case(ray_traced.MARKET, label).settings, camera=LIGHT_CAMERA)
        case = Case("", settings, color, depth)
        image = drivers.load(DRIVER).run(case.plan.passes, case.textures(), LIGHT_SIZE)["result"]
        measured[label] = shape(image, {})
    return measured
