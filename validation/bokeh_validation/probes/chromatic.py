"""Chromatic aberration: red and blue of a light's bokeh at other places than green (lateral), or of other sizes
(axial).
"""

from dataclasses import replace

import numpy as np

from bokeh_validation.frame import polygons
from bokeh_validation.probes import exact, impulse, near_edges
from bokeh_validation.probes.model import Case, Check, Outputs, Probe, depth_of, flat, overlap, pixel_center

SIZE, PLACE = (280, 208), (222, 46)  # of the image; of the light
COC, AMOUNT, ROTATION = 40, 0.05, 7.0
AXIAL = (-4, 6)  # pixels of CoC that red and blue have more, as through a plain lens
CHANNELS = ("red", "green", "blue")


def polygon(coc: float) -> np.ndarray:
    """Corners of the hexagon in pixels."""
    return coc * np.asarray(exact.polygon("hexagon", ROTATION)) / exact.COC


def checks(label: str, value: np.ndarray, shape: np.ndarray, middle: np.ndarray, off: float) -> list[Check]:
    """Light, place and outline of the bokeh of a light of 1, (H, W) without what is around.

    shape, middle  what it should be, pixels
    off            pixels that its outline may be off by
    """
    wanted = polygons.coverage(shape, SIZE, tuple(middle))
    area, edge = abs(polygons.signed_area(shape)), off * polygons.perimeter(shape)
    y, x = np.mgrid[: SIZE[1], : SIZE[0]] + 0.5
    # what is around may be stored a step off: so many pixels of it, far from the light, would move the middle
    lit = value - np.median(value)
    found = np.array([(lit * x).sum(), (lit * y).sum()]) / lit.sum()
    slip = exact.HALF_LIGHT * np.linalg.norm(shape, axis=1).max()
    kept, least = exact.HALF_LIGHT, (area - edge) / (area + edge)
    return [
        Check(f"light, {label}", value.sum(), 1 - kept, 1 + kept, "bilinear samples share it out; roundings of stores"),
        Check(
            f"middle off by, {label} (pixels)", np.linalg.norm(found - middle), 0.0, slip, "the same light, at a rim"
        ),
        Check(
            f"overlap with its polygon, {label}", overlap(value * area, wanted), least, 1.0, f"known to {off} pixels"
        ),
    ]


def light_case(label: str, depth: float = 10.0, **changes) -> Case:
    """One bright pixel in the exact method; a sample a pixel."""
    image = flat(SIZE, impulse.AMBIENT)
    image[PLACE[1], PLACE[0], :3] += impulse.PEAK
    chosen = replace(exact.settings("hexagon", ROTATION, SIZE, COC), **changes)
    exposure = impulse.PICTURE * abs(polygons.signed_area(polygon(COC))) / impulse.PEAK
    return Case(label, chosen, image, depth_of(SIZE, depth), exposure=exposure)


def scales(amount: float) -> dict[str, float]:
    """Size of each channel's picture."""
    return dict(zip(CHANNELS, (1.0 + amount, 1.0, 1.0 - amount), strict=True))


def _judge_lateral(outputs: dict[str, Outputs]) -> list[Check]:
    """A picture that is larger by s has the light s^2 times. Half a pixel for the outline, half for resampling."""
    found, image_middle = [], np.array(SIZE) / 2
    at = np.array(pixel_center(*PLACE)) - image_middle
    for label, amount in (("red larger", AMOUNT), ("blue larger", -AMOUNT)):
        for channel, (name, scale) in enumerate(scales(amount).items()):
            value = (outputs[label]["result"][..., channel] - impulse.AMBIENT) / (impulse.PEAK * scale**2)
            middle = image_middle + at * scale
            found += checks(f"{label}, {name}", value, polygon(COC * scale), middle, 0.5 + 0.5 * (scale != 1.0))
            if scale != 1.0:
                still = overlap(value * abs(polygons.signed_area(polygon(COC))), green())
                found.append(
                    Check(f"green's place overlaps less, {label}, {name}", still, 0.0, found[-1].low, "it shows")
                )
    return found


def green() -> np.ndarray:
    """Share of each pixel that the bokeh in green covers."""
    return polygons.coverage(polygon(COC), SIZE, pixel_center(*PLACE))


def axial_case(sign: int) -> Case:
    """A plane with a light, out of focus and far or near."""
    lens = {"camera": near_edges.CAMERA, "coc": None, "axial": tuple(pixels / SIZE[1] for pixels in AXIAL)}
    return light_case("far" if sign > 0 else "near", near_edges.metres(sign * COC, SIZE[1]), **lens)


def _judge_axial(outputs: dict[str, Outputs]) -> list[Check]:
    """A channel is as large as its signed CoC says: what is larger far away is smaller nearby."""
    found, middle = [], np.array(pixel_center(*PLACE))
    for label, sign in (("far", 1), ("near", -1)):
        for channel, (name, more) in enumerate(zip(CHANNELS, (AXIAL[0], 0, AXIAL[1]), strict=True)):
            value = (outputs[label]["result"][..., channel] - impulse.AMBIENT) / impulse.PEAK
            found += checks(f"{label}, {name}", value, polygon(abs(sign * COC + more)), middle, 0.5)
    return found


PROBES = (
    Probe(
        "lateral-color",
        "Red and blue of a picture at other scales",
        "A red rim on one side of the bokeh and a blue one on the other, both on the line to the image's middle.",
        (light_case("red larger", lateral=AMOUNT), light_case("blue larger", lateral=-AMOUNT)),
        _judge_lateral,
    ),
    Probe(
        "axial-color",
        "Red and blue are in focus at other distances",
        "Far bokeh has a blue rim and near bokeh a red one; nothing moves.",
        (axial_case(1), axial_case(-1)),
        _judge_axial,
        but=("d3d9",),
    ),
)
