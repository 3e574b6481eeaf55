"""Score methods on random scenes: FLIP, number of faulty pixels, and crops of the worst parts."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import astuple
from functools import cache
from typing import NamedTuple

import numpy as np

from bokeh_validation import drivers, metrics, pictures, terminal
from bokeh_validation.drivers.base import Driver
from bokeh_validation.probes.model import Case
from bokeh_validation.reference import listings
from bokeh_validation.truth import labels
from lab import captioned, jobs
from lab.captioned import Captioned
from lab.rasterised import faults
from lab.rasterised.random_scenes import random_scene
from lab.rasterised.rasteriser import Rasteriser

SIZE, POINTS = (320, 180), 320
APERTURES = {6: "hexagon", 8: "octagon"}
# Scenes per job, which share a driver
PORTION = 5
# The sheet of crops: side of a crop in pixels, its zoom, crops per scene and in total, the error that is shown white
PLACE, ZOOM, PLACES, SHOWN, WHITE = 56, 4, 2, 12, 0.33


class Score(NamedTuple):
    """Hold a method's result on a scene.

    row     numbers by name
    places  the worst crops, each with its excess over the limit and its images
    """

    row: dict
    places: list[tuple[float, list[Captioned]]]


@cache
def _tools(driver: str, adapter: str | None, size: tuple[int, int], points: int) -> tuple[Driver, Rasteriser]:
    loaded = drivers.load(driver, adapter)
    return loaded, Rasteriser(size, points, loaded)


def scores(
    seeds: Iterable[int], methods: Sequence[str], driver: str, adapter: str | None = None,
    size: tuple[int, int] = SIZE, points: int = POINTS,
) -> list[Score]:  # fmt: skip
    """Draw random scenes by some of labels.METHODS.

    size    (width, height)
    points  of the lens for the truth
    A row has: seed, label, flip, light relative to the truth, and the number of pixels for each of faults.LIMITS.
    """
    (active_driver, rasteriser), scores_so_far = _tools(driver, adapter, size, points), []
    for seed in seeds:
        scene, antialiased = random_scene(seed)
        pinhole, lens = rasteriser.pinhole(scene, antialiased=antialiased), rasteriser.lens(scene)
        coc = listings.circle_of_confusion(pinhole.depth.astype(np.float64), *astuple(scene.camera)) * size[1]
        for label in methods:
            settings = labels.settings(label, scene.camera, APERTURES[scene.sides])
            image = labels.picture(active_driver, label, Case(str(seed), settings, pinhole.color, pinhole.depth))
            image = np.nan_to_num(image[..., :3].astype(np.float32), posinf=listings.MAX_COLOR)
            wrong = faults.maps(image, pinhole, lens, None if antialiased else coc)
            row = {"seed": seed, "label": label, "flip": metrics.flip(image, lens.color)}
            row |= {"light": float(image.mean() / lens.color.mean())}
            row |= {name: int((values > faults.LIMITS[name]).sum()) for name, values in wrong.items()}
            scores_so_far.append(Score(row, _worst(row, wrong, [pinhole.color, image, lens.color])))
    return scores_so_far


def _worst(row: Mapping, wrong: Mapping[str, np.ndarray], images: Sequence[np.ndarray]) -> list:
    """Return the worst crops, which do not overlap; `images` are input, result and truth, (H, W, >= 3)."""
    excess = {name: faults.around(values, 1, np.mean) / faults.LIMITS[name] for name, values in wrong.items()}
    displayed, places = [pictures.filmic(image, faults.RANDOM_EXPOSURE) for image in images], []
    error = np.abs(faults.display(images[1]) - faults.display(images[2])).max(axis=-1)
    displayed.append(pictures.heat(error, WHITE))
    for _ in range(PLACES):
        name = max(excess, key=lambda name: excess[name].max())
        worst_pixel = np.unravel_index(excess[name].argmax(), error.shape)
        indices = zip(worst_pixel, error.shape, strict=True)
        top, left = (min(max(index - PLACE // 2, 0), extent - PLACE) for index, extent in indices)
        value, area = float(excess[name][worst_pixel]), (int(left), int(top), PLACE, PLACE)
        captions = (f"{row['seed']} at {area[:2]}: input", row["label"], "truth", f"error; {name} {value:.1f}")
        crops = [captioned.enlarged(captioned.crop(pixels, *area), ZOOM) for pixels in displayed]
        places.append((value, list(map(Captioned, crops, captions))))
        for values in excess.values():
            captioned.crop(values, *area)[...] = 0.0
    return places


def sheet(scored: Sequence[Score]) -> np.ndarray:
    """Return the worst crops of all scores as one 8-bit rgb image: input, result, truth, error."""
    places = sorted((place for score in scored for place in score.places), key=lambda place: -place[0])
    return captioned.grid([panels for _, panels in places[:SHOWN]])


def table(rows: Sequence[Mapping]) -> list[str]:
    """Return a table with a row per method: mean, 95th percentile and worst over the scenes."""
    lines = [
        f"| {len({row['seed'] for row in rows})} scenes | FLIP | bright | dark | rough | light |",
        "|---" * 6 + "|",
    ]
    for label in dict.fromkeys(row["label"] for row in rows):
        line = f"| {label}"
        for name in ("flip", *faults.LIMITS):
            values = np.array([row[name] for row in rows if row["label"] == label])
            form = " | {:.4f}/{:.4f}/{:.4f}" if name == "flip" else " | {:.1f}/{:.0f}/{:.0f}"
            line += form.format(values.mean(), np.percentile(values, 95), values.max())
        lines.append(f"{line} | {np.mean([row['light'] for row in rows if row['label'] == label]):.3f} |")
    return lines


def by_processes(methods: Sequence[str], driver: str, adapter: str | None, seeds: Sequence[int]) -> list[Score]:
    """Return what scores() returns, computed in several processes."""
    work = [(scores, (seeds[at : at + PORTION], methods, driver, adapter)) for at in range(0, len(seeds), PORTION)]
    with terminal.progress("truth", len(work)) as step:
        return [score for portion in jobs.run(work, step) for score in portion]


def report(
    methods: Sequence[str], driver: str, adapter: str | None, seeds: Sequence[int]
) -> tuple[list[dict], list[str]]:
    """Return the rows of scores() and their table."""
    rows = [score.row for score in by_processes(methods, driver, adapter, seeds)]
    return rows, [*table(rows), "Mean / 95th percentile / worst of the scenes: FLIP; pixels that are wrong"]
