"""Draw those figures of the paper that shaders can draw, as shown in docs/paper.md.

Photographs come from an npm package. Points, their shapes and their true light are those of the probes.
"""

import base64
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from math import cos, pi, radians, tan
from pathlib import Path

import numpy as np

from bokeh_validation import exr, pictures
from bokeh_validation.drivers.base import Driver
from bokeh_validation.errors import Unavailable
from bokeh_validation.frame import aperture_shapes, methods
from bokeh_validation.probes import highlight, impulse, shapes, two_points
from bokeh_validation.probes.model import Case, depth_of, drawn
from bokeh_validation.reference import sampling
from bokeh_validation.truth import ray_traced
from engines import pages
from lab import captioned
from lab.captioned import Captioned

# Name of a file -> 8-bit rgb (H, W, 3)
Pictures = dict[str, np.ndarray]

# Figure 1: photograph, aperture; degrees to the right from the middle of the panorama, and upwards
VIEWS = {
    "a": ("esplanade", "hexagon", 60.0, 15.0),
    "b": ("workshop", "octagon", 150.0, 15.0),
    "c": ("warehouse", "octagon", 110.0, 12.0),
}
# Horizontal field of view, degrees
FIELD_OF_VIEW = 80.0
PHOTOGRAPH_SIZE, PHOTOGRAPH_COC = (400, 300), 0.1
# Value to which a panorama's median is scaled: dark enough for its lights to stand out
MEDIAN = 0.2
HALF_MAX = 65504.0
# Metres; wider than the scene's own lens, so that the effects that the figures show are large enough
WIDE_APERTURE = 0.15
# Left, top, width, height, pixels
BRANCHES, CROWN = (100, 60, 190, 150), (310, 0, 150, 120)
# Dark enough to distinguish the gaps' shapes from the sky
CANOPY_EXPOSURE = 0.4

# Samples of the points' truth across a CoC: two per pixel, like the probes
CELLS = 2 * impulse.COC
# Size of the image, the border that nothing reaches, and the zoom factor
ONE_POINT, TWO_POINTS = ((88, 76), (0, 0), 3), (two_points.SIZE, (20, 8), 2)
# Display value of a highlight by the paper's method; two on top of each other are not clipped
PLATEAU = 0.4


def tone_mapped(image: np.ndarray, exposure: float = 1.0, zoom: int = 1) -> np.ndarray:
    """Tone-map linear rgb (H, W, >= 3) by x / (1 + x) to 8 bits, with each pixel as a block of `zoom` x `zoom`."""
    return captioned.enlarged(pictures.display(image, exposure, tone_map=True), zoom)


def panorama(name: str) -> np.ndarray:
    """Read an equirectangular photograph of @pmndrs/assets, linear rgb (H, W, 3) float64. Raises Unavailable."""
    try:
        modules = pages.installed(Path(__file__).parent)
    except RuntimeError as error:
        raise Unavailable(f"the photographs could not be downloaded: {str(error).splitlines()[0]}") from error
    # the file is in a JavaScript module, as base64
    module = (modules / "@pmndrs/assets/hdri" / f"{name}.exr.js").read_text(encoding="ascii")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, f"{name}.exr")
        file.write_bytes(base64.b64decode(module.partition("base64,")[2].rpartition("'")[0]))
        return without_negative(exr.read(file, None).color[..., :3].astype(np.float64))


def without_negative(image: np.ndarray) -> np.ndarray:
    """Return an image (H, W, 3) with pixels that have a negative channel replaced by the median of their
    neighbourhood.

    The package's panoramas were scaled down with a filter that rings: lights have dark rims, down to negative values.
    """
    padded = np.pad(image, ((1, 1), (1, 1), (0, 0)), mode="edge")
    neighbours = np.lib.stride_tricks.sliding_window_view(padded, (3, 3), axis=(0, 1))
    median = np.maximum(np.median(neighbours, axis=(-2, -1)), 0.0)
    return np.where((image < 0.0).any(axis=-1, keepdims=True), median, image)


def perspective(image: np.ndarray, yaw: float, pitch: float) -> np.ndarray:
    """Return what a camera sees of a panorama (H, W, C), float64 of PHOTOGRAPH_SIZE; angles as in VIEWS."""
    pixel = tan(radians(FIELD_OF_VIEW / 2)) / (PHOTOGRAPH_SIZE[0] / 2)
    x, y = np.meshgrid(*((np.arange(extent) + 0.5 - extent / 2) * pixel for extent in PHOTOGRAPH_SIZE))
    # the camera looks along z, y down; pitch is applied first, then yaw
    cosine, sine = np.cos(radians(pitch)), np.sin(radians(pitch))
    up, ahead = -y * cosine + sine, y * sine + cosine
    longitude = np.arctan2(x, ahead) + radians(yaw)
    latitude = np.arctan2(up, np.hypot(x, ahead))
    height, width = image.shape[:2]
    column = (longitude / (2 * np.pi) + 0.5) % 1.0 * width
    # its last column adjoins its first
    wrapped = np.pad(image, ((0, 0), (1, 1), (0, 0)), mode="wrap")
    return sampling.bilinear(wrapped, column + 1.0, (0.5 - latitude / np.pi) * height)


def photographs(driver: Driver) -> Pictures:
    """Draw Figure 1: each photograph, and the same with constant blur, as from a constant depth."""
    figures = {}
    for letter, (name, aperture, yaw, pitch) in VIEWS.items():
        image = panorama(name)
        color = np.ones((*PHOTOGRAPH_SIZE[::-1], 4), np.float16)
        color[..., :3] = np.minimum(perspective(image, yaw, pitch) * MEDIAN / np.median(image), HALF_MAX)
        camera = methods.Camera(max_coc=PHOTOGRAPH_COC)
        settings = methods.Settings("paper", aperture, camera=camera, coc=PHOTOGRAPH_COC)
        result = drawn(driver, Case(name, settings, color, depth_of(PHOTOGRAPH_SIZE, 1.0)))
        photograph = Captioned(tone_mapped(color), f"photograph ({name})")
        blurred = Captioned(tone_mapped(result), f"({letter}) paper, {aperture}, 13 samples a line")
        figures[f"figure_01_{letter}"] = captioned.grid([[photograph, blurred]])
    return figures


def canopy_case(method: str, diameter: float, **settings) -> Case:
    """Return a case of canopy_12 through a hexagon; `diameter` of the aperture is in metres."""
    case = ray_traced.scene_case(ray_traced.CANOPY, method, "hexagon")
    camera = replace(ray_traced.CANOPY.camera, aperture_diameter=diameter)
    return replace(case, settings=replace(case.settings, camera=camera, **settings))


def coc_blur(driver: Driver) -> Pictures:
    """Draw Figure 7: branches with the CoC averaged like the colour, and with the CoC unchanged."""
    panels = []
    for caption, blurred in (("(a) CoC blurred with the colour", True), ("(b) CoC not blurred", False)):
        image = drawn(driver, canopy_case("paper", WIDE_APERTURE, blur_coc=blurred))
        panels.append(Captioned(tone_mapped(captioned.crop(image, *BRANCHES), zoom=2), caption))
    return {"figure_07": captioned.grid([panels])}


def canopy(driver: Driver) -> Pictures:
    """Draw Figure 11, gaps of a canopy as hexagons: whole, a detail, and the detail with the scene's own lens."""
    details = []
    for diameter in (WIDE_APERTURE, ray_traced.CANOPY.camera.aperture_diameter):
        paper = canopy_case("paper", diameter)
        images = {
            "paper, 13 samples a line": drawn(driver, paper),
            "exact, 7 samples an edge": drawn(driver, canopy_case("exact", diameter)),
            "truth: brute force": shapes.brute_force(driver, paper),
            "a lens, ray traced": ray_traced.truth(ray_traced.CANOPY, "hexagon"),
        }
        cropped = {caption: captioned.crop(image, *CROWN) for caption, image in images.items()}
        details.append(
            [Captioned(tone_mapped(image, CANOPY_EXPOSURE, 2), caption) for caption, image in cropped.items()]
        )
    full_image = tone_mapped(drawn(driver, canopy_case("paper", WIDE_APERTURE)), CANOPY_EXPOSURE)
    caption, (wide, own_lens) = f"paper, hexagon, 13 samples a line, aperture {1000 * WIDE_APERTURE:g} mm", details
    return {
        "figure_11": captioned.grid([[Captioned(full_image, caption)]]),
        # this truth was ray traced with the scene's own lens only
        "figure_11_wide": captioned.grid([wide[:3]]),
        "figure_11_own": captioned.grid([own_lens[:2], own_lens[2:]]),
    }


def point_panel(driver: Driver, caption: str, method: str, aperture: str, places: Sequence, kind: tuple) -> Captioned:
    """Draw bright pixels at (column, row) by 'paper' or 'exact', or as the paper's 'truth', without the ambient light.

    kind  size of the image, border to crop, zoom factor
    """
    size, border, zoom = kind
    settings = impulse.constant_coc(aperture, 0.0, size)
    case = Case(aperture, settings, highlight.impulse_image(places, size), depth_of(size, 10.0))
    if method == "exact":
        # as large as the paper's octagon, whose corners are outside the CoC
        larger = cos(pi / 8) if aperture == "octagon" else 1.0
        case = replace(case, settings=replace(settings, method="exact", coc=settings.coc / larger))
    elif method == "truth" and aperture in aperture_shapes.USES_MAX:
        case = replace(case, settings=replace(settings, method="naive", samples=CELLS + 1))
    by_lattice = method == "truth" and aperture not in aperture_shapes.USES_MAX
    image = shapes.brute_force(driver, case, CELLS) if by_lattice else drawn(driver, case)
    inner = captioned.crop(image[..., :3], *border, size[0] - 2 * border[0], size[1] - 2 * border[1])
    lit = pictures.display(inner.astype(np.float64) - highlight.AMBIENT, PLATEAU / impulse.plateau(aperture))
    return Captioned(captioned.enlarged(lit, zoom), caption)


def by_each_method(driver: Driver, aperture: str, caption: str, places: Sequence, kind: tuple) -> list[Captioned]:
    """Draw points by the paper's method, by exact if it has the aperture, and as the truth."""
    captioned_methods = [
        (caption, "paper"),
        *([("exact", "exact")] if aperture in methods.EXACT else []),
        ("truth", "truth"),
    ]
    return [point_panel(driver, *panel, aperture, places, kind) for panel in captioned_methods]


def apertures_of_points(driver: Driver) -> Pictures:
    """Draw Figure 9, a point through each aperture, and Figure 12, two points with false light between them."""
    middle, rows = [(ONE_POINT[0][0] // 2, ONE_POINT[0][1] // 2)], {"figure_09": [], "figure_12": []}
    for letter, aperture, combined in (("a", "hexagon", "min"), ("b", "octagon", "min"), ("c", "star", "max")):
        caption = f"({letter}) paper, {aperture}"
        rows["figure_09"].append(by_each_method(driver, aperture, f"{caption} by {combined}", middle, ONE_POINT))
        if combined == "min":
            places = two_points.points(aperture)
            rows["figure_12"].append(by_each_method(driver, aperture, caption, places, TWO_POINTS))
    return {name: captioned.grid(panels) for name, panels in rows.items()}


def two_under_max(driver: Driver) -> Pictures:
    """Draw Figure 13: overlapping highlights that do not add up. exact has no star, so it shows octagons, closer
    together.
    """
    (width, height), places = two_points.SIZE, two_points.points("star")
    apart = (places[1][0] - places[0][0]) // 4
    near = [(width // 2 + side * apart, height // 2 + 4 * side) for side in (-1, 1)]
    panels = [
        point_panel(driver, "(a) paper, star by max", "paper", "star", places, TWO_POINTS),
        point_panel(driver, "(b) truth: intensities added", "truth", "star", places, TWO_POINTS),
        point_panel(driver, "exact: octagons, it makes no star", "exact", "octagon", near, TWO_POINTS),
    ]
    return {"figure_13": captioned.grid([panels])}
