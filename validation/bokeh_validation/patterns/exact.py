"""The exact polygons: shape, light and flatness for every rotation, and highlights that add up where min fails."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from bokeh_validation import apertures, methods
from bokeh_validation.patterns import impulse, two_points
from bokeh_validation.patterns.model import Case, Check, Outputs, Probe, depth_of, flat, pixel_center
from bokeh_validation.reference import polygons

SIZE = (144, 112)  # not square, so that a missing aspect ratio shows
COC = 80  # pixels
SPACING = 1.0  # pixels
CENTER = (72, 56)
ROTATIONS = (0.0, 7.0, 22.5, 45.0)
BLOCK = 9  # pixels: side of the wide highlight

# What is asked of the overlap with the analytic polygon (sum of min / sum of max) at a sample a pixel. The samples of
# one pixel are tents on a lattice that is not aligned with the pixels: in the square their sum ripples most.
OVERLAP = {"square": 0.86, "hexagon": 0.92, "octagon": 0.92, "decagon": 0.92}
# Two stores in half floats lose up to one step of 2^-10 each, where a device cuts off, and a step near AMBIENT, where
# most of a thinly spread highlight is, is up to 2^-11 / plateau of it. Asked for: 0.01.
HALF_LIGHT = 0.01
FLATNESS = 0.05


@dataclass(frozen=True)
class Turns:
    """Rotations of a probe in degrees: those of its bright pixel and those of its wide highlight."""

    points: tuple[float, ...]
    blocks: tuple[float, ...]


ALL_TURNS = Turns(ROTATIONS, (0.0, 22.5))
# for a first answer; no polygon has an edge along the pixels
ONE_TURN = Turns((7.0,), (7.0,))


def settings(aperture: str, rotation: float, size: tuple[int, int] = SIZE, coc: float = COC) -> methods.Settings:
    """The exact method at a sample a pixel, with a CoC of `coc` pixels everywhere."""
    camera = methods.Camera(max_coc=1.0)
    return methods.Settings(
        "exact", aperture, rotation=rotation, camera=camera, coc=coc / size[1], spacing=SPACING, max_samples=2 * COC + 1
    )


def polygon(aperture: str, rotation: float) -> np.ndarray:
    """Corners in pixels."""
    return COC * apertures.even_polygon(methods.EXACT[aperture], rotation)


def area(aperture: str) -> float:
    """Of the polygon, square pixels."""
    return abs(polygons.signed_area(polygon(aperture, 0.0)))


def impulse_case(aperture: str, rotation: float) -> Case:
    """One bright pixel."""
    return Case(
        f"{rotation:g} degrees",
        settings(aperture, rotation),
        impulse.impulse_image((CENTER,), SIZE),
        depth_of(SIZE, 10.0),
        exposure=impulse.PICTURE * area(aperture) / impulse.PEAK,
    )


def block_case(aperture: str, rotation: float) -> Case:
    """A bright square of BLOCK pixels."""
    image = flat(SIZE, impulse.AMBIENT)
    half = BLOCK // 2
    image[CENTER[1] - half : CENTER[1] + half + 1, CENTER[0] - half : CENTER[0] + half + 1, :3] += impulse.PEAK / 16
    return Case(
        f"wide highlight, {rotation:g} degrees",
        settings(aperture, rotation),
        image,
        depth_of(SIZE, 10.0),
        exposure=impulse.PICTURE * area(aperture) / (impulse.PEAK / 16 * BLOCK**2),
    )


def shape_checks(aperture: str, rotation: float, value: np.ndarray, light_tolerance: float) -> list[Check]:
    """Light and overlap of an impulse, (H, W) float64 without the ambient light."""
    label = f"{rotation:g} degrees"
    truth = polygons.coverage(polygon(aperture, rotation), SIZE, pixel_center(*CENTER))
    seen = value * area(aperture) / impulse.PEAK
    overlap = np.minimum(seen, truth).sum() / np.maximum(seen, truth).sum()
    return [
        Check(
            f"light kept, {label}",
            value.sum() / impulse.PEAK,
            1 - light_tolerance,
            1 + light_tolerance,
            "bilinear samples share their light out completely; the rest is rounding of the stores",
        ),
        Check(f"overlap with the polygon, {label}", overlap, OVERLAP[aperture], 1.0, "asked for at a sample a pixel"),
    ]


def flatness_check(aperture: str, rotation: float, value: np.ndarray) -> Check:
    """Largest distance from flat inside the blur of the block, (H, W) float64 without the ambient light."""
    plateau = impulse.PEAK / 16 * BLOCK**2 / area(aperture)
    # inside for every pixel of the block, and 2 pixels from the edge
    margin = BLOCK / 2 * np.sqrt(2.0) + 2.0
    inner = polygon(aperture, rotation)
    apothem = COC / 2 * np.cos(np.pi / methods.EXACT[aperture])
    inside = polygons.coverage(inner * (1 - margin / apothem), SIZE, pixel_center(*CENTER)) == 1
    off = np.abs(value[inside] / plateau - 1).max()
    return Check(f"wide highlight off from flat by, {rotation:g} degrees", off, 0.0, FLATNESS, "no seam: asked for")


def _judge(aperture: str, turns: Turns, outputs: dict[str, Outputs]) -> list[Check]:
    checks = []
    for rotation in turns.points:
        value = outputs[f"{rotation:g} degrees"]["result"][..., 1] - impulse.AMBIENT
        checks += shape_checks(aperture, rotation, value, HALF_LIGHT)
    for rotation in turns.blocks:
        block = outputs[f"wide highlight, {rotation:g} degrees"]["result"][..., 1] - impulse.AMBIENT
        checks.append(flatness_check(aperture, rotation, block))
    return checks


def probe(aperture: str, turns: Turns = ALL_TURNS) -> Probe:
    """The probe of one polygon."""
    cases = [impulse_case(aperture, rotation) for rotation in turns.points]
    cases += [block_case(aperture, rotation) for rotation in turns.blocks]
    degrees = ", ".join(f"{turn:g}" for turn in turns.points)
    return Probe(
        f"exact-{aperture}",
        f"One bright pixel becomes a {aperture} of the same light",
        "beyond the paper",
        f"A {aperture} of CoC {COC} pixels at {degrees} degrees, as bright as it should be, and flat without a seam.",
        tuple(cases),
        partial(_judge, aperture, turns),
    )


def _judge_sum(aperture: str, outputs: dict[str, Outputs]) -> list[Check]:
    both = outputs["both"]["result"][..., 1] - impulse.AMBIENT
    alone = sum(outputs[f"point {i}"]["result"][..., 1] - impulse.AMBIENT for i in (1, 2))
    off = np.abs(both - alone).max() / alone.max()
    paper = outputs["paper"]["result"][..., 1] - impulse.AMBIENT
    return [
        Check("two highlights off from their sum by", off, 0.0, 0.01, "the method is linear; stores in half floats"),
        Check(
            "the same, paper",
            np.abs(paper - alone).max() / alone.max(),
            0.2,
            float("inf"),
            "min finds light where there is none: Figure 12 must show, or this probe shows nothing",
        ),
    ]


def sum_probe(aperture: str) -> Probe:
    """Two points at the distance that exposes min, alone and together."""
    size, places = two_points.SIZE, two_points.points(aperture)
    exposure = impulse.PICTURE / impulse.plateau(aperture)

    def case(label: str, shown: tuple, chosen: methods.Settings) -> Case:
        return Case(label, chosen, impulse.impulse_image(shown, size), depth_of(size, 10.0), exposure=exposure)

    chosen = settings(aperture, 0.0, size, impulse.COC)
    return Probe(
        f"two-points-exact-{aperture}",
        f"Two highlights that add up, {aperture}",
        "12, 13",
        "Two clean shapes where min makes false ones, as bright together as each alone.",
        (
            case("point 1", places[:1], chosen),
            case("point 2", places[1:], chosen),
            case("both", places, chosen),
            case("paper", places, impulse.constant_coc(aperture, 0.0, size)),
        ),
        partial(_judge_sum, aperture),
    )


SUMS = tuple(sum_probe(name) for name in ("hexagon", "octagon"))
PROBES = (*(probe(aperture) for aperture in methods.EXACT), *SUMS)
QUICK_PROBES = (*(probe(aperture, ONE_TURN) for aperture in methods.EXACT), *SUMS)
