"""What is measured of the effects and of ours: on a scene, of one light, and the time of a frame."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bokeh_validation import drivers, metrics, truth
from bokeh_validation.frame import fetches, polygons
from bokeh_validation.frame.methods import Camera
from bokeh_validation.probes.impulse import AMBIENT, PEAK
from bokeh_validation.probes.model import Case, depth_of, overlap, pixel_center
from bokeh_validation.probes.shapes import outline
from bokeh_validation.truth import ray_traced
from bokeh_validation.truth.peers import Peers, counted, crate
from bokeh_validation.truth.peers.effects import EFFECTS, Parameters

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


def scene(name: str, chosen: Chosen) -> tuple[list[Drawn], dict[str, np.ndarray]]:
    """Rows and pictures of a scene; ours among them. Effects with parameters None: the best are searched."""
    one = next(found for found in ray_traced.SCENES if found.name == name)
    lens, images, rows = ray_traced.truth(one, "hexagon"), {}, []
    if chosen:
        rows = _of_effects(one, chosen, lens, images)
    for label in OURS:
        case = truth.case(one, label)
        images[label] = truth.picture(drivers.load(DRIVER), one, label)
        count = sum(fetches.of_frame(case.plan.passes).values())
        measured = truth.row(one, label, images[label], lens)
        rows.append(Drawn(name, label, {}, *measured[2:], count))
    return rows, images


def _of_effects(one: ray_traced.SceneFile, chosen: Chosen, lens: np.ndarray, images: dict) -> list[Drawn]:
    picture, rows = ray_traced.picture(one), []
    peers = Peers()
    peers.load(picture.color, picture.depth, one.camera)
    for effect, parameters in chosen.items():

        def off(tried: Parameters, effect: str = effect) -> float:
            return metrics.flip(_small(peers.draw(effect, tried)), _small(lens))

        # what is better of small pictures need not be of the whole ones
        asked = [parameters] if parameters else best_two(peers, effect, off)
        found = [(peers.draw(effect, one), one) for one in asked]
        of_each = [truth.row(one, effect, image, lens) for image, _ in found]
        measured, (images[effect], best) = min(zip(of_each, found, strict=True), key=lambda pair: pair[0].flip)
        bevy = EFFECTS[effect].package == crate.NAME
        count = counted.of_bevy(effect, best["maxDiameter"]) if bevy else counted.fetches(peers.draws(effect, best))
        rows.append(Drawn(one.name, effect, best, *measured[2:], count))
    peers.close()
    return rows


def best_two(peers: Peers, effect: str, off: Callable[[Parameters], float]) -> list[Parameters]:
    """What is the least off of an effect's grid, and of the steps from there; of both one where they are the same."""
    tried = {off(parameters): parameters for parameters in peers.grid(effect)}
    best = tried[min(tried)]
    further = climbed(off, best, min(tried), EFFECTS[effect].factors)
    return [best] if further == best else [best, further]


def climbed(off: Callable[[Parameters], float], best: Parameters, least: float, names: Iterable[str]) -> Parameters:
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
    return best


def _small(image: np.ndarray) -> np.ndarray:
    height, width = (side // SMALLER for side in image.shape[:2])
    cells = image[: height * SMALLER, : width * SMALLER, :3].astype(np.float32)
    return cells.reshape(height, SMALLER, width, SMALLER, 3).mean(axis=(1, 3))


class Shape(NamedTuple):
    """One light: its overlap with the aperture (patterns.model.overlap, the light of both being the same), and what is
    kept of its light."""

    parameters: Parameters
    overlap: float
    light: float


def shapes(chosen: Chosen) -> dict[str, Shape]:
    """Of effects, and of ours. Those with parameters None: what overlaps the most is searched."""
    middle = [(side - LIGHT) // 2 for side in LIGHT_SIZE]
    color = np.full((*LIGHT_SIZE[::-1], 4), AMBIENT, np.float16)
    color[middle[1] : middle[1] + LIGHT, middle[0] : middle[0] + LIGHT] = PEAK
    depth = depth_of(LIGHT_SIZE, FAR)
    before = (color[..., 1].astype(np.float64) - AMBIENT).sum()
    hexagon = LIGHT_COC * outline(truth.case(ray_traced.MARKET, "exact").settings)
    center = pixel_center(*(side // 2 for side in LIGHT_SIZE))
    wanted = sum(
        np.roll(polygons.coverage(hexagon, LIGHT_SIZE, center), (y, x), (0, 1))
        for y in range(-(LIGHT // 2), LIGHT // 2 + 1)
        for x in range(-(LIGHT // 2), LIGHT // 2 + 1)
    )

    def shape(image: np.ndarray, parameters: Parameters) -> Shape:
        seen = image[..., 1].astype(np.float64) - AMBIENT
        return Shape(parameters, overlap(seen / seen.sum(), wanted / wanted.sum()), float(seen.sum() / before))

    found = {}
    if chosen:
        peers = Peers()
        peers.load(color, depth, LIGHT_CAMERA)
        for effect, parameters in chosen.items():

            def off(tried: Parameters, effect: str = effect) -> float:
                return 1.0 - shape(peers.draw(effect, tried), tried).overlap

            best = parameters or best_two(peers, effect, off)[-1]
            found[effect] = shape(peers.draw(effect, best), best)
        peers.close()
    for label in OURS:
        settings = replace(truth.case(ray_traced.MARKET, label).settings, camera=LIGHT_CAMERA)
        case = Case("", settings, color, depth)
        found[label] = shape(drivers.load(DRIVER).run(case.plan.passes, case.textures(), LIGHT_SIZE)["result"], {})
    return found


def times(one: ray_traced.SceneFile, chosen: Chosen) -> dict[str, float]:
    """Milliseconds of a frame, the median of ROUNDS, each drawing one after the other; 'input': the scene's quad alone,
    which is in the time of every effect and not in that of ours."""
    picture, peers = ray_traced.picture(one), Peers()
    peers.load(picture.color, picture.depth, one.camera)
    for label in OURS:
        case = truth.case(one, label)
        peers.add(label, drivers.load(DRIVER).job(case.plan.passes, case.textures(), case.size))
    asked = {"input": {}, **chosen, **dict.fromkeys(OURS, {})}
    taken = peers.time(asked, ROUNDS)
    peers.close()
    return {name: float(np.median(one)) for name, one in zip(asked, taken, strict=True)}
