"""Figures 5, 6, 9, 12 and 13: bright points spread into apertures."""

from dataclasses import replace
from math import cos, pi

import numpy as np

from bokeh_validation import pictures
from bokeh_validation.drivers.base import Driver
from bokeh_validation.figures import panels
from bokeh_validation.figures.figure import Made, Table, drawn, named
from bokeh_validation.figures.panels import Panel
from bokeh_validation.frame import apertures, methods, polygons
from bokeh_validation.probes import impulse, two_points
from bokeh_validation.probes import shapes as measured
from bokeh_validation.probes.model import Case, depth_of, pixel_center

# The probes' inputs: a CoC of impulse.COC pixels everywhere, two samples a pixel. The truth is as dense.
CELLS = 2 * impulse.COC
ONE_SIZE, ONE_ZOOM = (88, 76), 3
PAIR_ZOOM = 2
PLATEAU = 0.4
ONE = ((ONE_SIZE[0] // 2, ONE_SIZE[1] // 2),)


def case(method: str, aperture: str, places: tuple, size: tuple[int, int]) -> Case:
    """Bright pixels at (column, row) on a dark image, through a method, two samples a pixel."""
    settings = replace(impulse.constant_coc(aperture, 0.0, size), method=method)
    if method == "exact":
        # as large as the paper's octagon, whose corners are outside the CoC
        larger = cos(pi / 8) if aperture == "octagon" else 1.0
        settings = replace(settings, coc=settings.coc / larger, samples=impulse.SAMPLES)
    image, depth = impulse.impulse_image(places, size), depth_of(size, 10.0)
    return Case(f"{method} {aperture}", settings, image, depth, exposure=exposure(aperture))


def exposure(aperture: str) -> float:
    """Of pictures: one highlight of the paper's method is PLATEAU bright, two on top of each other are not cut off."""
    return PLATEAU / impulse.plateau(aperture)


def truth(driver: Driver, case: Case) -> np.ndarray:
    """The paper's shape gathered with two samples a pixel, (H, W, 4)."""
    if case.settings.aperture in apertures.USES_MAX:
        return drawn(driver, replace(case, settings=replace(case.settings, method="naive", samples=CELLS + 1)))
    return measured.brute_force(driver, case, CELLS)


def shown(image: np.ndarray, exposure: float, zoom: int) -> np.ndarray:
    """8-bit rgb, without the ambient light, cut off at 1."""
    lit = image[..., :3].astype(np.float64) - impulse.AMBIENT
    return pictures.enlarged(pictures.display(lit, exposure), zoom)


def light(image: np.ndarray) -> np.ndarray:
    """Green without the ambient light, in units of one bright pixel, (H, W) float64."""
    return (image[..., 1].astype(np.float64) - impulse.AMBIENT) / impulse.PEAK


def stages(number: int, aperture: str, driver: Driver) -> Made:
    """Figures 5 and 6: the point, after the first pass, after the second; arrows are the lines of the next pass."""
    one = case("paper", aperture, ONE, ONE_SIZE)
    out = driver.run(one.plan.passes, one.textures(), one.size, keep=("coc", "line 1", "result"))
    images = dict(zip("abc", out.values(), strict=True))
    angles = [item.parameters["BokehAngle"] for item in one.plan.passes[1:]]
    captions = ["one bright pixel", *(f"after a line at {np.degrees(angle):.0f}°" for angle in angles)]
    row, rows = [], []
    for (letter, image), caption, angle in zip(images.items(), captions, [*angles, None], strict=True):
        pixels = shown(image, one.exposure, ONE_ZOOM)
        row.append(Panel(pixels if angle is None else panels.arrows(pixels, [_beside(angle)]), f"({letter}) {caption}"))
        value = light(image)
        lit = float((value > 0.5 * value.max()).sum())
        rows.append((f"({letter})", (lit, float(value.sum()), float(value.max()))))
    table = Table(("pixels lit", "light", "brightest pixel"), rows, (0, 3, 5))
    name = f"figure_{number:02}"
    return Made({name: panels.grid([row])}, named(name, images), (table,))


def _beside(angle: float) -> tuple[np.ndarray, np.ndarray]:
    """An arrow as long as the kernel, below or beside what it blurs."""
    half = 0.5 * impulse.COC * ONE_ZOOM * apertures.direction(angle)
    away = (-30.0, 0.0) if abs(half[1]) > 1.0 else (0.0, 26.0)
    middle = ONE_ZOOM * (np.array(ONE_SIZE) / 2 + away)
    return middle - half, middle + half


def shapes(driver: Driver) -> Made:
    """Figure 9: a point through each aperture by the paper, by exact where it has one, and the truth."""
    rows, numbers, images = [], [], {}
    for letter, aperture in zip("abc", ("hexagon", "octagon", "star"), strict=True):
        combine = "max" if aperture in apertures.USES_MAX else "min"
        paper = case("paper", aperture, ONE, ONE_SIZE)
        found = {"paper": drawn(driver, paper)}
        if aperture in methods.EXACT:
            found["exact"] = drawn(driver, case("exact", aperture, ONE, ONE_SIZE))
        found["truth"] = truth(driver, paper)
        right = light(found["truth"])
        grey = Panel(np.full((ONE_SIZE[1] * ONE_ZOOM, ONE_SIZE[0] * ONE_ZOOM, 3), 232, np.uint8), "no star by exact")
        row = {"paper": None, "exact": grey, "truth": None}
        for name, image in found.items():
            caption = f"({letter}) paper, {aperture} by {combine}" if name == "paper" else name
            row[name] = Panel(shown(image, paper.exposure, ONE_ZOOM), caption)
            if name != "truth":
                off = np.abs(light(image) - right).sum() / right.sum()
                numbers.append((f"{aperture}, {name}", (float(light(image).sum()), float(off))))
        rows.append([*row.values()])
        images |= named(f"figure_09_{letter}", found)
    table = Table(("light kept", "off from the truth, share of its light"), numbers, (3, 3))
    return Made({"figure_09": panels.grid(rows)}, images, (table,))


def false_light(aperture: str, image: np.ndarray) -> float:
    """Light a pixel and more outside the true shapes, share of one highlight of the paper's method."""
    right = two_points.correct_sum(aperture, np.minimum)
    outside = two_points.grown(right > 0) == 0
    return float(light(image)[outside].sum() * impulse.PEAK / impulse.plateau(aperture) / (right.sum() / 2))


def minimum(driver: Driver) -> Made:
    """Figure 12: light where there is none."""
    rows, numbers, images = [], [], {}
    for letter, aperture in zip("ab", ("hexagon", "octagon"), strict=True):
        places, size = two_points.points(aperture), two_points.SIZE
        paper, exact = (case(method, aperture, places, size) for method in ("paper", "exact"))
        found = {"paper": drawn(driver, paper), "exact": drawn(driver, exact), "truth": truth(driver, paper)}
        captions = (f"({letter}) paper, {aperture}", "exact", "truth")
        rows.append(_row(found, captions, exposure(aperture)))
        numbers.append((aperture, tuple(false_light(aperture, image) for image in found.values())))
        images |= named(f"figure_12_{letter}", found)
    table = Table(("paper", "exact", "truth"), numbers, (3, 3, 3))
    return Made({"figure_12": panels.grid(rows)}, images, (table,))


def maximum(driver: Driver) -> Made:
    """Figure 13: overlapping highlights that do not add up. The exact method has no star: octagons, nearer together."""
    size, places = two_points.SIZE, two_points.points("star")
    paper, apart = case("paper", "star", places, size), (places[1][0] - places[0][0]) // 4
    near = tuple((size[0] // 2 + side * apart, size[1] // 2 + 4 * side) for side in (-1, 1))
    exact = case("exact", "octagon", near, size)
    found = {"paper": drawn(driver, paper), "truth": truth(driver, paper), "exact": drawn(driver, exact)}
    captions = ("(a) paper, star by max", "(b) truth: intensities added", "exact: octagons, it makes no star")
    squares = two_points.shapes("star")
    stars = [np.maximum(*shape) for shape in squares]
    outline = measured.outline(methods.Settings("paper", "octagon")) * impulse.COC
    octagons = [polygons.coverage(outline, size, pixel_center(*place)) for place in near]
    # where max can show one highlight only: no parallelogram of both has them both
    single = np.logical_and.reduce([first + second <= 1.0 for first, second in zip(*squares, strict=True)])
    values = (*(overlap(found[name], stars, single) for name in ("paper", "truth")), overlap(found["exact"], octagons))
    columns = ("paper, star", "truth, star", "exact, octagon")
    table = Table(columns, [("overlap, times as bright as one highlight", values)], (2, 2, 2))
    picture = panels.grid([_row(found, captions, exposure("star"))])
    return Made({"figure_13": picture}, named("figure_13", found), (table,))


def overlap(image: np.ndarray, shapes: list[np.ndarray], where: np.ndarray | bool = True) -> float:
    """Mean brightness where both shapes (H, W) are and `where` holds, over that where one is, a pixel from edges."""
    both = (np.minimum(*shapes) == 1) & where
    one = np.logical_xor(shapes[0] == 1, shapes[1] == 1) & (np.minimum(*shapes) == 0)
    means = [light(image)[~two_points.grown(~mask)].mean() for mask in (both, one)]
    return float(means[0] / means[1])


def _row(found: dict[str, np.ndarray], captions: tuple[str, ...], exposure: float) -> list[Panel]:
    width, height = two_points.SIZE
    cut = [panels.crop(image, 20, 8, width - 40, height - 16) for image in found.values()]
    return [Panel(shown(image, exposure, PAIR_ZOOM), caption) for image, caption in zip(cut, captions, strict=True)]
