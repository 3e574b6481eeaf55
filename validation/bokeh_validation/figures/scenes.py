"""Figures 2, 3, 7 and 11: scenes with depth, and the probes that put a number to what they show."""

from dataclasses import replace

import numpy as np

from bokeh_validation import metrics, quality, suite
from bokeh_validation.drivers.base import Driver
from bokeh_validation.figures import panels
from bokeh_validation.figures.model import Figure, Made, Table
from bokeh_validation.figures.panels import Panel
from bokeh_validation.patterns import scenes as probes
from bokeh_validation.patterns.model import Case, Probe

STREET, CANOPY = suite.DRIVER_SCENES
# A wider lens than the scenes' own, so that what Figures 2 and 7 are about is large enough to be seen.
WIDE = 0.15


def scene(file: suite.SceneFile, method: str = "paper", diameter: float | None = None, **changes) -> Case:
    """A scene through a hexagon; `diameter` of the aperture in metres, else the scene's own."""
    case = suite.scene_case(file, method, "hexagon")
    if diameter is not None:
        changes["camera"] = replace(file.camera, aperture_diameter=diameter)
    return replace(case, settings=replace(case.settings, **changes), tone_map=True)


def drawn(driver: Driver, case: Case) -> np.ndarray:
    """(H, W, 4)"""
    return driver.run(case.plan.passes, case.textures(), case.size)["result"]


def measured(driver: Driver, probe: Probe) -> dict[str, float]:
    """The probe's checks, name -> value. Whether they are right is for `validation/run patterns` to say."""
    outputs = {
        case.label: driver.run(case.plan.passes, case.textures(), case.size, keep=case.keep) for case in probe.cases
    }
    seen = {label: {name: image.astype(np.float64) for name, image in one.items()} for label, one in outputs.items()}
    return {check.name: float(check.value) for check in probe.judge(seen)}


def _cut(image: np.ndarray, place: tuple[int, int, int, int], zoom: int) -> np.ndarray:
    """A tone-mapped detail; place: left, top, width, height."""
    return panels.toned(panels.crop(image, *place), factor=zoom)


# ---------------------------------------------------------------------------------------------------------- Figure 2

BALL = (225, 155, 230, 220)


def leakage(driver: Driver) -> Made:
    """A focused ball before a blurred background, without and with the leakage test."""
    pictures = {
        "a": drawn(driver, scene(STREET, diameter=WIDE, leak_fix=False)),
        "b": drawn(driver, scene(STREET, diameter=WIDE)),
    }
    captions = {"a": "(a) without the leakage test", "b": "(b) with it"}
    row = [Panel(_cut(pictures[key], BALL, 2), captions[key]) for key in pictures]
    found = measured(driver, probes.LEAKAGE)
    without = found["light leaked without the fix (pixels of the square)"]
    share = found["leaked with the fix, share of that without"]
    rows = (("light leaked from a focused square, pixels of it", (without, share * without)),)
    table = Table(("without", "with"), rows, (0, 0))
    images = {f"figure_02_{key}": image for key, image in pictures.items()}
    return Made({"figure_02": panels.grid([row])}, images, (table,))


# ---------------------------------------------------------------------------------------------------------- Figure 3

POST = (345, 175, 130, 140)
POST_ZOOM = 3
# letter -> (where it stands, where its arrow ends), pixels of the enlarged detail
MARKS = {"a": ((330.0, 330.0), (222.0, 262.0)), "b": ((60.0, 390.0), (172.0, 330.0))}


def silhouette(driver: Driver) -> Made:
    """A near post, out of focus, before a focused ball; beside it what a lens sees."""
    ours, lens = drawn(driver, scene(STREET)), suite.truth(STREET, "hexagon")
    row = [
        Panel(panels.marked(_cut(ours, POST, POST_ZOOM), MARKS), "paper, hexagon"),
        Panel(panels.marked(_cut(lens, POST, POST_ZOOM), MARKS), "truth: ray traced through a lens"),
    ]
    found = measured(driver, probes.SILHOUETTE)
    rows = (
        ("change outside the outline of a near square", (found["change outside the silhouette"],)),
        ("pixels over which it fades inside", (found["fading inside the silhouette (pixels)"],)),
        ("its CoC, pixels", (probes.coc_pixels(probes.NEAR),)),
    )
    images = {"figure_03": ours, "figure_03_truth": lens}
    return Made({"figure_03": panels.grid([row])}, images, (Table(("paper",), rows, (1,)),))


# ---------------------------------------------------------------------------------------------------------- Figure 7

BRANCHES = (100, 60, 190, 150)


def coc_blur(driver: Driver) -> Made:
    """Branches with the CoC averaged like the colour, and with the CoC left alone."""
    pictures = {
        "a": drawn(driver, scene(CANOPY, diameter=WIDE)),
        "b": drawn(driver, scene(CANOPY, diameter=WIDE, blur_coc=False)),
    }
    captions = {"a": "(a) CoC blurred with the colour", "b": "(b) CoC not blurred"}
    row = [Panel(_cut(pictures[key], BRANCHES, 2), captions[key]) for key in pictures]
    values = tuple(edges(image) for image in pictures.values())
    table = Table(("(a)", "(b)"), (("hard edges, per mille of neighbouring pixels", values),), (1, 1))
    images = {f"figure_07_{key}": image for key, image in pictures.items()}
    return Made({"figure_07": panels.grid([row])}, images, (table,))


def edges(image: np.ndarray, step: float = 0.2) -> float:
    """How many of a thousand pairs of horizontal neighbours in BRANCHES differ by more than `step` on the display."""
    shown = metrics.tone_mapped(panels.crop(image, *BRANCHES)[..., 1])
    return 1000.0 * float((np.abs(np.diff(shown, axis=1)) > step).mean())


# --------------------------------------------------------------------------------------------------------- Figure 11

CROWN = (310, 0, 150, 120)
# dark enough to tell the gaps' shapes from the sky
EXPOSURE = 0.4
METHODS = ("paper", "exact")
CAPTIONS = {
    "paper": "paper, 13 samples a line",
    "exact": "exact, 7 samples an edge",
    "truth": "truth: brute force",
    "lens": "a lens, ray traced",
}


def canopy(driver: Driver) -> Made:
    """Gaps of a canopy as hexagons: paper, exact, brute force; for the scene's own aperture also the ray-traced lens.

    Three pictures: all of it through a wide aperture, a detail of that, and the same detail through its own aperture.
    """
    wide, own = (_three(driver, diameter) for diameter in (WIDE, None))
    lens = suite.truth(CANOPY, "hexagon")
    pinhole = scene(CANOPY).color
    # FLIP takes seconds: only where it says most
    rows = [("pinhole, wide", (metrics.psnr(pinhole, wide["truth"]), None, None, None))]
    rows += [(f"{name}, wide", (metrics.psnr(wide[name], wide["truth"]), None, None, None)) for name in METHODS]
    rows += [("pinhole, own", (metrics.psnr(pinhole, own["truth"]), None, metrics.psnr(pinhole, lens), None))]
    rows += [(f"{name}, own", (*_distance(own[name], own["truth"]), *_distance(own[name], lens))) for name in METHODS]
    rows += [("truth, own", (None, None, *_distance(own["truth"], lens)))]
    columns = ("dB to the truth", "FLIP to the truth", "dB to the lens", "FLIP to the lens")
    whole = Panel(
        panels.toned(wide["paper"], EXPOSURE), f"paper, hexagon, 13 samples a line, aperture {1000 * WIDE:g} mm"
    )
    details = {name: _details(three) for name, three in (("wide", [wide]), ("own", [own, {"lens": lens}]))}
    images = {f"figure_11_wide_{name}": image for name, image in wide.items()}
    images |= {f"figure_11_own_{name}": image for name, image in (own | {"lens": lens}).items()}
    pictures = {"figure_11": panels.grid([[whole]])}
    pictures |= {f"figure_11_{name}": panels.grid(rows) for name, rows in details.items()}
    return Made(pictures, images, (Table(columns, tuple(rows), (1, 3, 1, 3)),))


def _three(driver: Driver, diameter: float | None) -> dict[str, np.ndarray]:
    paper = scene(CANOPY, diameter=diameter)
    return {
        "paper": drawn(driver, paper),
        "exact": drawn(driver, scene(CANOPY, "exact", diameter)),
        "truth": quality.brute_force(driver, paper),
    }


def _details(parts: list[dict[str, np.ndarray]]) -> list[list[Panel]]:
    """One row for three pictures, two rows for four."""
    found = [
        Panel(panels.toned(panels.crop(image, *CROWN), EXPOSURE, 2), CAPTIONS[name])
        for part in parts
        for name, image in part.items()
    ]
    return [found] if len(found) < 4 else [found[:2], found[2:]]


def _distance(image: np.ndarray, truth: np.ndarray) -> tuple[float, float]:
    """PSNR and FLIP."""
    return metrics.psnr(image, truth), metrics.flip(image, truth)


FIGURES = (
    Figure(2, "Intensity leakage", leakage),
    Figure(3, "A sharp silhouette", silhouette),
    Figure(7, "Blurring the CoC", coc_blur),
    Figure(11, "A canopy", canopy),
)
