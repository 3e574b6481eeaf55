"""Figures 5, 6, 9, 12 and 13: bright points spread into apertures."""

from dataclasses import replace
from functools import partial
from math import cos, pi

import numpy as np

from bokeh_validation import apertures, methods, quality
from bokeh_validation.drivers.base import Driver
from bokeh_validation.figures import panels
from bokeh_validation.figures.model import Figure, Made, Table
from bokeh_validation.figures.panels import Panel
from bokeh_validation.patterns import impulse, two_points
from bokeh_validation.patterns.model import Case, depth_of, pixel_center
from bokeh_validation.reference import polygons

# The probes' inputs: a CoC of impulse.COC pixels everywhere, two samples a pixel. The truth is as dense.
CELLS = 2 * impulse.COC
ONE_SIZE, ONE_ZOOM = (88, 76), 3
PAIR_ZOOM = 2
PLATEAU = 0.4
ONE = ((ONE_SIZE[0] // 2, ONE_SIZE[1] // 2),)


def case(method: str, aperture: str, places: tuple, size: tuple[int, int]) -> Case:
    """Bright pixels at (column, row) on a dark image, through a method."""
    return Case(
        f"{method} {aperture}",
        settings(method, aperture, size),
        impulse.impulse_image(places, size),
        depth_of(size, 10.0),
        exposure=exposure(aperture),
    )


def exposure(aperture: str) -> float:
    """Of pictures: one highlight of the paper's method is PLATEAU bright, two on top of each other are not cut off."""
    return PLATEAU / impulse.plateau(aperture)


def settings(method: str, aperture: str, size: tuple[int, int]) -> methods.Settings:
    """Two samples a pixel. The exact octagon is made as large as the paper's, whose corners are outside the CoC."""
    chosen = replace(impulse.constant_coc(aperture, 0.0, size), method=method)
    if method != "exact":
        return chosen
    larger = cos(pi / 8) if aperture == "octagon" else 1.0
    return replace(chosen, coc=chosen.coc / larger, samples=impulse.SAMPLES)


def truth(driver: Driver, case: Case) -> np.ndarray:
    """The paper's shape gathered with two samples a pixel, (H, W, 4)."""
    if case.settings.aperture in apertures.USES_MAX:
        dense = replace(case, settings=replace(case.settings, method="naive", samples=CELLS + 1))
        return drawn(driver, dense)
    return quality.brute_force(driver, case, CELLS)


def drawn(driver: Driver, case: Case) -> np.ndarray:
    """(H, W, 4)"""
    return driver.run(case.plan.passes, case.textures(), case.size)["result"]


def shown(image: np.ndarray, exposure: float, zoom: int) -> np.ndarray:
    """8-bit rgb, without the ambient light."""
    return panels.enlarged(image[..., :3].astype(np.float64) - impulse.AMBIENT, zoom, exposure)


def light(image: np.ndarray) -> np.ndarray:
    """Green without the ambient light, in units of one bright pixel, (H, W) float64."""
    return (image[..., 1].astype(np.float64) - impulse.AMBIENT) / impulse.PEAK


# ------------------------------------------------------------------------------------------------- Figures 5 and 6


def stages(aperture: str, driver: Driver) -> Made:
    """The point, after the first pass, after the second; the arrows are the lines of the passes that come next."""
    number = {"square": 5, "diamond": 6}[aperture]
    one = case("paper", aperture, ONE, ONE_SIZE)
    out = driver.run(one.plan.passes, one.textures(), one.size, keep=("coc", "line 1", "result"))
    lines = [item.parameters["BokehAngle"] for item in one.plan.passes[1:]]
    captions = [
        "(a) one bright pixel",
        f"(b) after a line at {np.degrees(lines[0]):.0f}°",
        f"(c) after a line at {np.degrees(lines[1]):.0f}°",
    ]
    row = []
    for caption, image, angle in zip(captions, out.values(), [*lines, None], strict=True):
        pixels = shown(image, one.exposure, ONE_ZOOM)
        if angle is not None:
            pixels = panels.arrows(pixels, [_line_beside(angle)])
        row.append(Panel(pixels, caption))
    rows = []
    for letter, image in zip("abc", out.values(), strict=True):
        value = light(image)
        lit = float((value > 0.5 * value.max()).sum())
        rows.append((f"({letter})", (lit, float(value.sum()), float(value.max()))))
    table = Table(("pixels lit", "light", "brightest pixel"), tuple(rows), (0, 3, 5))
    images = {f"figure_{number:02}_{letter}": image for letter, image in zip("abc", out.values(), strict=True)}
    return Made({f"figure_{number:02}": panels.grid([row])}, images, (table,))


def _line_beside(angle: float) -> tuple[np.ndarray, np.ndarray]:
    """An arrow as long as the kernel, below or beside what it blurs."""
    half = 0.5 * impulse.COC * ONE_ZOOM * apertures.direction(angle)
    middle = np.array(ONE_SIZE) * ONE_ZOOM / 2 + np.array([0.0, 26.0 * ONE_ZOOM])
    if abs(half[1]) > 1.0:
        middle = np.array(ONE_SIZE) * ONE_ZOOM / 2 + np.array([-30.0 * ONE_ZOOM, 0.0])
    return middle - half, middle + half


# ------------------------------------------------------------------------------------------------------- Figure 9


def shapes(driver: Driver) -> Made:
    """Hexagon, octagon and star: paper, exact, truth."""
    rows, numbers, images = [], [], {}
    for letter, aperture in zip("abc", ("hexagon", "octagon", "star"), strict=True):
        combine = "max" if aperture in apertures.USES_MAX else "min"
        paper = case("paper", aperture, ONE, ONE_SIZE)
        pictures = {"paper": drawn(driver, paper)}
        if aperture in methods.EXACT:
            pictures["exact"] = drawn(driver, case("exact", aperture, ONE, ONE_SIZE))
        pictures["truth"] = truth(driver, paper)
        captions = {"paper": f"({letter}) paper, {aperture} by {combine}", "exact": "exact", "truth": "truth"}
        row = [
            Panel(shown(pictures[name], paper.exposure, ONE_ZOOM), captions[name])
            if name in pictures
            else absent(ONE_SIZE, ONE_ZOOM, "no star by exact")
            for name in captions
        ]
        rows.append(row)
        right = light(pictures["truth"])
        for name in ("paper", "exact"):
            if name in pictures:
                seen = light(pictures[name])
                off = np.abs(seen - right).sum() / right.sum()
                numbers.append((f"{aperture}, {name}", (float(seen.sum()), float(off))))
        images |= {f"figure_09_{letter}_{name}": image for name, image in pictures.items()}
    table = Table(("light kept", "off from the truth, share of its light"), tuple(numbers), (3, 3))
    return Made({"figure_09": panels.grid(rows)}, images, (table,))


def absent(size: tuple[int, int], zoom: int, text: str) -> Panel:
    """A grey panel where a method has nothing to show."""
    return Panel(np.full((size[1] * zoom, size[0] * zoom, 3), 232, np.uint8), text)


# ------------------------------------------------------------------------------------------------ Figures 12 and 13


def pair(driver: Driver, aperture: str) -> dict[str, np.ndarray]:
    """Two points at the places that expose min."""
    size, places = two_points.SIZE, two_points.points(aperture)
    paper = case("paper", aperture, places, size)
    return {
        "paper": drawn(driver, paper),
        "exact": drawn(driver, case("exact", aperture, places, size)),
        "truth": truth(driver, paper),
    }


def false_light(aperture: str, image: np.ndarray) -> float:
    """Light a pixel and more outside the true shapes, share of one highlight of the paper's method."""
    right = two_points.correct_sum(aperture, np.minimum)
    outside = two_points.grown(right > 0) == 0
    return float(light(image)[outside].sum() * impulse.PEAK / impulse.plateau(aperture) / (right.sum() / 2))


def minimum(driver: Driver) -> Made:
    """Figure 12: light where there is none."""
    rows, numbers, images = [], [], {}
    for letter, aperture in zip("ab", ("hexagon", "octagon"), strict=True):
        pictures = pair(driver, aperture)
        factor = exposure(aperture)
        captions = {"paper": f"({letter}) paper, {aperture}", "exact": "exact", "truth": "truth"}
        rows.append([_pair_panel(pictures[name], factor, caption) for name, caption in captions.items()])
        numbers.append((aperture, tuple(false_light(aperture, image) for image in pictures.values())))
        images |= {f"figure_12_{letter}_{name}": image for name, image in pictures.items()}
    table = Table(("paper", "exact", "truth"), tuple(numbers), (3, 3, 3))
    return Made({"figure_12": panels.grid(rows)}, images, (table,))


def maximum(driver: Driver) -> Made:
    """Figure 13: overlapping highlights that do not add up. The exact method has no star: octagons, nearer together."""
    size, places = two_points.SIZE, two_points.points("star")
    paper = case("paper", "star", places, size)
    near = tuple(
        (size[0] // 2 + side * (places[1][0] - places[0][0]) // 4, size[1] // 2 + 4 * side) for side in (-1, 1)
    )
    pictures = {
        "paper": drawn(driver, paper),
        "truth": truth(driver, paper),
        "exact": drawn(driver, case("exact", "octagon", near, size)),
    }
    captions = {
        "paper": "(a) paper, star by max",
        "truth": "(b) truth: intensities added",
        "exact": "exact: octagons, it makes no star",
    }
    row = [_pair_panel(pictures[name], exposure("star"), caption) for name, caption in captions.items()]
    stars = [np.maximum(*shape) for shape in two_points.shapes("star")]
    octagon = quality.outline(settings("paper", "octagon", size)) * impulse.COC
    octagons = [polygons.coverage(octagon, size, pixel_center(*place)) for place in near]
    # where max can show one highlight only: no parallelogram of both has them both
    squares = two_points.shapes("star")
    apart = np.logical_and.reduce([first + second <= 1.0 for first, second in zip(*squares, strict=True)])
    everywhere = np.ones_like(apart)
    values = (
        overlap(pictures["paper"], stars, apart),
        overlap(pictures["truth"], stars, apart),
        overlap(pictures["exact"], octagons, everywhere),
    )
    columns = ("paper, star", "truth, star", "exact, octagon")
    table = Table(columns, (("overlap, times as bright as one highlight", values),), (2, 2, 2))
    images = {f"figure_13_{name}": image for name, image in pictures.items()}
    return Made({"figure_13": panels.grid([row])}, images, (table,))


def overlap(image: np.ndarray, shapes: list[np.ndarray], where: np.ndarray) -> float:
    """Mean brightness where both shapes (H, W) are and `where` holds, over that where one is, a pixel from edges."""
    both = (np.minimum(*shapes) == 1) & where
    one = np.logical_xor(shapes[0] == 1, shapes[1] == 1) & (np.minimum(*shapes) == 0)
    value = light(image)
    return float(np.mean(value[_inner(both)]) / np.mean(value[_inner(one)]))


def _inner(mask: np.ndarray) -> np.ndarray:
    return ~two_points.grown(~mask)


def _pair_panel(image: np.ndarray, exposure: float, caption: str) -> Panel:
    width, height = two_points.SIZE
    return Panel(shown(panels.crop(image, 20, 8, width - 40, height - 16), exposure, PAIR_ZOOM), caption)


FIGURES = (
    Figure(5, "A point becomes a square in two passes", partial(stages, "square")),
    Figure(6, "A point becomes a diamond in two passes", partial(stages, "diamond")),
    Figure(9, "Min and max of parallelograms", shapes),
    Figure(12, "Two points under min", minimum),
    Figure(13, "Two points under max", maximum),
)
