"""Map where the error of `layered` varies in a pan, and how much of it is due to what near objects hide."""

import numpy as np

from bokeh_validation import pictures
from bokeh_validation.drivers.base import Driver
from bokeh_validation.probes.model import Case
from bokeh_validation.truth import labels
from lab import captioned
from lab.captioned import Captioned
from lab.rasterised import faults, motion
from lab.rasterised.rasteriser import Rasteriser, Scene
from lab.rasterised.sequences import moment

LABEL = "layered medium"
# Things nearer than this, in metres, are in front of the focus
NEAR = 2.0
FAR, FILLS = "far blurred", ("mid fill", "far fill")
READ = ("coc", "gather tiles", "near blurred", FAR, *FILLS)
# Deviation from which the map is white, in 1/255 of display values, and the hidden fraction likewise
MOST_DEVIATION, MOST_HIDDEN = 60.0, 0.5


def quartered(image: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """Return the means of 4 x 4 pixels of an image (H, W, C), as a target with this (height, width)."""
    height, width = size
    padding = [(0, max(4 * height - image.shape[0], 0)), (0, max(4 * width - image.shape[1], 0)), (0, 0)]
    padded = np.pad(image, padding, "edge")[: 4 * height, : 4 * width]
    return padded.reshape(height, 4, width, 4, -1).mean(axis=(1, 3))


def _case(rasteriser: Rasteriser, scene: Scene) -> Case:
    pinhole = rasteriser.pinhole(scene, antialiased=True)
    return Case(LABEL, labels.settings(LABEL, scene.camera), pinhole.color, pinhole.depth)


def deviations(
    driver: Driver, size: tuple[int, int] = motion.SIZE, points: int = motion.POINTS, frames: int = motion.FRAMES
) -> dict[str, np.ndarray]:
    """Return maps (H, W) of the pan.

    layered   standard deviation of the error over the frames, of the worst channel, in 1/255 of display values
    informed  the same, if the last pass gets the far layer of the scene without near objects, and fills with the truth
              of that scene
    hidden    mean fraction of the lens that sees what the input does not contain

    The last of `frames` is returned as `result`, (H, W, 3).
    """
    rasteriser, hidden = Rasteriser(size, points, driver), []
    errors: dict[str, list[np.ndarray]] = {"layered": [], "informed": []}
    for frame in range(frames):
        scene = moment("pan", frame)
        bare = scene._replace(things=tuple(thing for thing in scene.things if thing.place[2] >= NEAR))
        lens, behind = rasteriser.lens(scene), rasteriser.lens(bare).color
        case, bare_case = _case(rasteriser, scene), _case(rasteriser, bare)
        targets = driver.run(case.plan.passes, case.textures(), size, keep=(*READ, "result"))
        known = driver.run(bare_case.plan.passes, bare_case.textures(), size, keep=(FAR,))
        for name in FILLS:
            filled = targets[name].copy()
            filled[..., :3] = quartered(behind, filled.shape[:2])
            known[name] = filled
        inputs = {name: targets[name] for name in READ} | known
        informed = driver.run(case.plan.passes[-1:], inputs, size)["result"]
        for name, result in (("layered", targets["result"]), ("informed", informed)):
            errors[name].append(faults.display(result[..., :3]) - faults.display(lens.color))
        hidden.append(lens.hidden)
    maps = {name: 255.0 * np.std(values, axis=0).max(axis=-1) for name, values in errors.items()}
    return maps | {"hidden": np.mean(hidden, axis=0), "result": targets["result"][..., :3]}


def sheet(driver: Driver) -> np.ndarray:
    """Return the maps beside a frame of the pan, 8-bit rgb."""
    maps = deviations(driver)
    return captioned.grid(
        [
            [
                Captioned(pictures.filmic(maps["result"], faults.RANDOM_EXPOSURE), "layered, preset MEDIUM"),
                Captioned(pictures.heat(maps["hidden"], MOST_HIDDEN), "hidden from the input; white: half of the lens"),
            ],
            [
                Captioned(pictures.heat(maps["layered"], MOST_DEVIATION), "deviation of the error; white: 60/255"),
                Captioned(
                    pictures.heat(maps["informed"], MOST_DEVIATION), "the same, if the far layer and the fills knew it"
                ),
            ],
        ]
    )
