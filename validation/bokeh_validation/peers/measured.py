"""What is measured of the effects and of ours: on a scene, of one light, and the time of a frame."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bokeh_validation import drivers, fetches, likeness, metrics, suite
from bokeh_validation.methods import Camera
from bokeh_validation.patterns.impulse import AMBIENT, PEAK
from bokeh_validation.patterns.model import Case, depth_of, overlap, pixel_center
from bokeh_validation.peers import Peers, counted, crate
from bokeh_validation.peers.effects import EFFECTS, Parameters
from bokeh_validation.quality import outline
from bokeh_validation.reference import polygons

OURS = ("paper", "exact", "layered low", "layered medium")
DRIVER = "webgl2"  # the device that the others are on
# One light of 3 x 3 pixels, so far away that its circle of confusion is that at infinity, 34 pixels
LIGHT, FAR = 3, 10000.0
LIGHT_SIZE, LIGHT_COC = (270, 270), 34
LIGHT_CAMERA = Camera(LIGHT_COC / 270 * 0.024 * 2.37 / 0.05, 0.05, 2.42, 0.024, 0.15)
ROUNDS = 5
# The pictures of the grid are compared at a quarter of their size: FLIP takes longer than an effect
SMALLER = 4
STEP = 0.8  # of a parameter, after the grid


class Drawn(NamedTuple):
    """An effect on a scene.

    documented  FLIP with the parameters that its documentation asks for, and with the best, of the smaller pictures
    fetches     a pixel at the most, see counted.py; of ours see fetches.py
    """

    scene: str
    effect: str
    parameters: Parameters
    documented: tuple[float, float]
    flip: float
    psnr: float
    light: float
    fetches: float


def scene(name: str, effects: list[str]) -> tuple[list[Drawn], dict[str, np.ndarray]]:
    """Rows and pictures of a scene; ours among them."""
    one = next(found for found in suite.SCENES if found.name == name)
    lens, images, rows = suite.truth(one, "hexagon"), {}, []
    if effects:
        rows = _of_effects(one, effects, lens, images)
    for label in OURS:
        case = likeness.case(one, label)
        images[label] = likeness.picture(drivers.load(DRIVER), one, label)
        count = sum(fetches.of_frame(case.plan.passes).values())
        measured = likeness.row(one, label, images[label], lens)
        rows.append(Drawn(name, label, {}, (0.0, 0.0), *measured[2:], count))
    return rows, images


def _of_effects(one: suite.SceneFile, effects: list[str], lens: np.ndarray, images: dict) -> list[Drawn]:
    picture, rows = suite.picture(one), []
    peers = Peers()
    peers.load(picture.color, picture.depth, one.camera)
    for effect in effects:

        def off(parameters: Parameters, effect: str = effect) -> float:
            return metrics.flip(_small(peers.draw(effect, parameters)), _small(lens))

        grid = peers.grid(effect)
        tried = [off(parameters) for parameters in grid]
        best = grid[int(np.argmin(tried))]
        further, least = climbed(off, best, min(tried), EFFECTS[effect].factors)
        # what is better of small pictures need not be of the whole ones
        found = [(peers.draw(effect, parameters), parameters) for parameters in (best, further)]
        of_both = [likeness.row(one, effect, image, lens) for image, _ in found[: 1 + (further != best)]]
        measured, (images[effect], best) = min(zip(of_both, found, strict=False), key=lambda pair: pair[0].flip)
        bevy = EFFECTS[effect].package == crate.NAME
        count = counted.of_bevy(effect, best["maxDiameter"]) if bevy else counted.fetches(peers.draws(effect, best))
        rows.append(Drawn(one.name, effect, best, (tried[0], least), *measured[2:], count))
    peers.close()
    return rows


def climbed(
    off: Callable[[Parameters], float], best: Parameters, least: float, names: Iterable[str]
) -> tuple[Parameters, float]:
    """From the best of a grid on, beyond its edges too: each parameter smaller or larger, as long as it gets better."""
    before = None
    while before != best:
        before = best
        for name in names:
            for factor in (STEP, 1 / STEP):
                tried = {**best, name: best[name] * factor}
                if (found := off(tried)) < least:
                    best, least = tried, found
                    break
    return best, least


def _small(image: np.ndarray) -> np.ndarray:
    height, width = (side // SMALLER for side in image.shape[:2])
    cells = image[: height * SMALLER, : width * SMALLER, :3].astype(np.float32)
    return cells.reshape(height, SMALLER, width, SMALLER, 3).mean(axis=(1, 3))


class Shape(NamedTuple):
    """One light: its overlap with the aperture (patterns.model.overlap, the light of both being the same), the best of
    the grid, and what is kept of its light there."""

    overlap: float
    light: float


def shapes(effects: list[str]) -> dict[str, Shape]:
    """Of effects, and of ours."""
    middle = [(side - LIGHT) // 2 for side in LIGHT_SIZE]
    color = np.full((*LIGHT_SIZE[::-1], 4), AMBIENT, np.float16)
    color[middle[1] : middle[1] + LIGHT, middle[0] : middle[0] + LIGHT] = PEAK
    depth = depth_of(LIGHT_SIZE, FAR)
    before = (color[..., 1].astype(np.float64) - AMBIENT).sum()
    hexagon = LIGHT_COC * outline(likeness.case(suite.MARKET, "exact").settings)
    center = pixel_center(*(side // 2 for side in LIGHT_SIZE))
    wanted = sum(
        np.roll(polygons.coverage(hexagon, LIGHT_SIZE, center), (y, x), (0, 1))
        for y in range(-(LIGHT // 2), LIGHT // 2 + 1)
        for x in range(-(LIGHT // 2), LIGHT // 2 + 1)
    )

    def shape(image: np.ndarray) -> Shape:
        seen = image[..., 1].astype(np.float64) - AMBIENT
        return Shape(overlap(seen / seen.sum(), wanted / wanted.sum()), float(seen.sum() / before))

    found = {}
    if effects:
        peers = Peers()
        peers.load(color, depth, LIGHT_CAMERA)
        for effect in effects:

            def off(parameters: Parameters, effect: str = effect) -> float:
                return 1.0 - shape(peers.draw(effect, parameters)).overlap

            best = min(peers.grid(effect), key=off)
            found[effect] = shape(peers.draw(effect, climbed(off, best, off(best), EFFECTS[effect].factors)[0]))
        peers.close()
    for label in OURS:
        settings = replace(likeness.case(suite.MARKET, label).settings, camera=LIGHT_CAMERA)
        case = Case("", settings, color, depth)
        found[label] = shape(drivers.load(DRIVER).run(case.plan.passes, case.textures(), LIGHT_SIZE)["result"])
    return found


def times(one: suite.SceneFile, chosen: dict[str, Parameters]) -> dict[str, float]:
    """Milliseconds of a frame, the median of ROUNDS, each drawing one after the other; 'input': the scene's quad alone,
    which is in the time of every effect and not in that of ours."""
    picture, peers = suite.picture(one), Peers()
    peers.load(picture.color, picture.depth, one.camera)
    for label in OURS:
        case = likeness.case(one, label)
        peers.add(label, drivers.load(DRIVER).job(case.plan.passes, case.textures(), case.size))
    asked = {"input": {}, **chosen, **dict.fromkeys(OURS, {})}
    taken = peers.time(asked, ROUNDS)
    peers.close()
    return {name: float(np.median(one)) for name, one in zip(asked, taken, strict=True)}
