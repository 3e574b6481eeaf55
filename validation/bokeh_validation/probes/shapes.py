"""What a method makes of a shape, and how close it comes to a brute-force gather on real input."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bokeh_validation import terminal
from bokeh_validation.drivers.base import Driver
from bokeh_validation.frame import apertures, fetches, methods, polygons
from bokeh_validation.probes import highlight
from bokeh_validation.probes.model import Case, depth_of, drawn, overlap, pixel_center
from bokeh_validation.shaders.passes import Pass

# Lattice points across the CoC: 900 and more inside a hexagon and an octagon.
BRUTE_CELLS = 38


def outline(settings: methods.Settings) -> np.ndarray:
    """Corners of the shape that a method blurs into, (N, 2), for a CoC of 1, not mirrored."""
    if settings.method == "exact":
        return apertures.even_polygon(methods.EXACT[settings.aperture], settings.rotation)
    if settings.aperture in apertures.POLYGONS:
        return apertures.rotated(apertures.regular_polygon(apertures.POLYGONS[settings.aperture]), settings.rotation)
    shapes = _parallelograms(settings)
    return shapes[0] if len(shapes) == 1 else polygons.clip_convex(*shapes)


def _parallelograms(settings: methods.Settings) -> list[np.ndarray]:
    return [shape.corners(settings.rotation) for shape in apertures.PARALLELOGRAMS[settings.aperture]]


def brute_force(driver: Driver, case: Case, cells: int = BRUTE_CELLS) -> np.ndarray:
    """The polygon of a case gathered by the naive pass with `cells` samples across, (H, W, 4)."""
    corners = outline(case.settings)
    # midpoints of a square lattice, mirrored as a gather needs them
    table = -apertures.lattice_kernel(cells, lambda x, y: polygons.inside(corners, x, y))
    inputs = {"ColorSamp": "coc", "DepthSamp": "depth", "KernelSamp": "kernel"}
    naive = methods.plan(replace(case.settings, method="naive", aperture="hexagon", spacing=0.0, samples=3), case.size)
    coc = naive.passes[0]
    gather = Pass("BokehNaiveGather", inputs, "result", naive.passes[1].parameters, len(table))
    textures = {**case.textures(), "kernel": methods.kernel_texture(table)}
    return driver.run([coc, gather], textures, case.size)["result"]


# Shapes of the table in docs/apertures.md: method, aperture
SHAPES = (
    *(("exact", aperture) for aperture in methods.EXACT),
    *(("paper", aperture) for aperture in apertures.NAMES),
    ("naive", "hexagon"),
    ("naive", "octagon"),
)
COC, SIZE = 80, (176, 160)
PAIR_COC, PAIR_SIZE = 40, (188, 180)
# Where the second highlight is, in CoC from the first: min and max fail at some distances and not at others.
DISTANCES, DIRECTIONS = (0.5, 0.8, 1.06), 8


class Shape(NamedTuple):
    """What a method makes of one bright pixel and of two.

    passes   after the CoC map; `targets` of the widest of them
    fetches  of colour a pixel, with the default number of samples
    light    of the pixel that is kept
    error    1 - overlap (sum of min / sum of max) with the polygon of the same light, a sample a pixel
    sum_off  two highlights against the sum of each alone: the largest difference anywhere, for the worst of some
             distances between them, relative to the brightest place
    """

    passes: int
    targets: int
    fetches: int
    light: float
    error: float
    sum_off: float

    def __str__(self) -> str:
        """Cells of the table in docs/apertures.md."""
        shares = f"{self.light:.3f} | {100 * self.error:.0f} % | {100 * self.sum_off:.0f} %"
        return f"{self.passes} | {self.targets} | {self.fetches} | {shares}"


def shape(driver: Driver, method: str, aperture: str) -> Shape:
    """Measure a row of the table: CoC 80 pixels, 40 for two highlights; half-float targets."""
    middle = (SIZE[0] // 2, SIZE[1] // 2)
    settings = _dense(method, aperture, COC / SIZE[1], COC)
    value = _lit(driver, settings, SIZE, [middle])
    shapes = _parallelograms(settings) if aperture in apertures.USES_MAX else [outline(settings)]
    truth = np.max([polygons.coverage(COC * corners, SIZE, pixel_center(*middle)) for corners in shapes], axis=0)
    plan = methods.plan(methods.Settings(method, aperture), SIZE).passes
    return Shape(
        len(plan) - 1,
        max(len(item.outputs) for item in plan),
        round(fetches.of_filters(plan)),
        float(value.sum() / highlight.PEAK),
        1.0 - overlap(value * truth.sum() / value.sum(), truth),
        _sum_off(driver, _dense(method, aperture, PAIR_COC / PAIR_SIZE[1], PAIR_COC)),
    )


def _sum_off(driver: Driver, settings: methods.Settings) -> float:
    """See Shape."""
    first = (PAIR_SIZE[0] // 2, PAIR_SIZE[1] // 2)
    single, worst = _lit(driver, settings, PAIR_SIZE, [first]), 0.0
    for distance in DISTANCES:
        for turn in np.arange(DIRECTIONS) * 2.0 * np.pi / DIRECTIONS:
            dx, dy = np.rint(distance * PAIR_COC * apertures.direction(turn)).astype(int)
            both = _lit(driver, settings, PAIR_SIZE, [first, (first[0] + dx, first[1] + dy)])
            # the second one alone is the first, moved: by whole pixels, and nothing reaches the border
            alone = single + np.roll(single, (dy, dx), axis=(0, 1))
            worst = max(worst, float(np.abs(both - alone).max() / max(alone.max(), both.max())))
    return worst


def _dense(method: str, aperture: str, coc: float, pixels: int) -> methods.Settings:
    """A sample a pixel and a constant CoC, also given in pixels."""
    dense = {"samples": pixels + 1} if method == "naive" else {"spacing": 1.0, "samples": 2 * pixels + 1}
    return methods.Settings(method, aperture, camera=methods.Camera(max_coc=1.0), coc=coc, **dense)


def _lit(driver: Driver, settings: methods.Settings, size: tuple[int, int], places) -> np.ndarray:
    """Bright pixels through a method, without the ambient light, (H, W)."""
    case = Case("", settings, highlight.impulse_image(places, size), depth_of(size, 1.0))
    return drawn(driver, case)[..., 1].astype(np.float64) - highlight.AMBIENT


def shapes(driver: terminal.OneDriver = None, adapter: terminal.Adapter = None) -> None:
    """The table of docs/apertures.md: every shape by every method, measured on a driver."""
    used = terminal.pick_driver(driver, adapter)
    heads = ("shape", "method", "passes", "targets", "fetches a pixel", "light kept", "shape off by")
    lines = [f"| {' | '.join(heads)} | two highlights off by |", "|---" * 8 + "|"]
    with terminal.progress("shapes", len(SHAPES)) as step:
        for method, aperture in SHAPES:
            lines.append(f"| {aperture} | {method} | {shape(used, method, aperture)} |")
            step(f"{method} {aperture}")
    terminal.tell(*lines, f"CoC {COC:g} pixels, {used.name} ({used.adapter})")
