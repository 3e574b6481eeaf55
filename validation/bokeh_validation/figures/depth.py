"""Figures 2, 3, 7 and 11: scenes with depth, and the probes that put a number to what they show."""

from dataclasses import replace

import numpy as np

from bokeh_validation import metrics
from bokeh_validation.drivers.base import Driver
from bokeh_validation.figures import panels
from bokeh_validation.figures.figure import Made, Table, drawn, named
from bokeh_validation.figures.panels import Panel
from bokeh_validation.probes import scenes as probes
from bokeh_validation.probes import shapes
from bokeh_validation.probes.model import Case, Probe
from bokeh_validation.truth import ray_traced

STREET, CANOPY = ray_traced.DRIVER_SCENES
# A wider lens than the scenes' own, so that what Figures 2 and 7 are about is large enough to be seen.
WIDE = 0.15


def scene(file: ray_traced.SceneFile, method: str = "paper", diameter: float | None = None, **changes) -> Case:
    """A scene through a hexagon; `diameter` of the aperture in metres, else the scene's own."""
    case = ray_traced.scene_case(file, method, "hexagon")
    if diameter is not None:
        changes["camera"] = replace(file.camera, aperture_diameter=diameter)
    return replace(case, settings=replace(case.settings, **changes), tone_map=True)


def measured(driver: Driver, probe: Probe) -> dict[str, float]:
    """The probe's checks, name -> value. Whether they are right is for `validation/run probes` to say."""
    seen = {}
    for case in probe.cases:
        outputs = driver.run(case.plan.passes, case.textures(), case.size, keep=case.keep)
        seen[case.label] = {name: image.astype(np.float64) for name, image in outputs.items()}
    return {check.name: float(check.value) for check in probe.judge(seen)}


def _cut(image: np.ndarray, place: tuple[int, int, int, int], zoom: int) -> np.ndarray:
    """A tone-mapped detail; place: left, top, width, height."""
    return panels.toned(panels.crop(image, *place), factor=zoom)


def _pair(number: int, images: dict[str, np.ndarray], captions: dict[str, str], place, table: Table) -> Made:
    """The same detail of (a) and (b)."""
    row = [Panel(_cut(images[key], place, 2), f"({key}) {captions[key]}") for key in images]
    name = f"figure_{number:02}"
    return Made({name: panels.grid([row])}, named(name, images), (table,))


BALL = (225, 155, 230, 220)


def leakage(driver: Driver) -> Made:
    """Figure 2: a focused ball before a blurred background, without and with the leakage test."""
    cases = {"a": scene(STREET, diameter=WIDE, leak_fix=False), "b": scene(STREET, diameter=WIDE)}
    found = measured(driver, probes.LEAKAGE)
    without = found["light leaked without the fix (pixels of the square)"]
    values = (without, found["leaked with the fix, share of that without"] * without)
    table = Table(("without", "with"), (("light leaked from a focused square, pixels of it", values),), (0, 0))
    captions = {"a": "without the leakage test", "b": "with it"}
    return _pair(2, {key: drawn(driver, case) for key, case in cases.items()}, captions, BALL, table)


POST, POST_ZOOM = (345, 175, 130, 140), 3
# letter -> (where it stands, where its arrow ends), pixels of the enlarged detail
MARKS = {"a": ((330.0, 330.0), (222.0, 262.0)), "b": ((60.0, 390.0), (172.0, 330.0))}


def silhouette(driver: Driver) -> Made:
    """Figure 3: a near post, out of focus, before a focused ball; beside it what a lens sees."""
    ours, lens = drawn(driver, scene(STREET)), ray_traced.truth(STREET, "hexagon")
    shown = {"paper, hexagon": ours, "truth: ray traced through a lens": lens}
    row = [Panel(panels.marked(_cut(image, POST, POST_ZOOM), MARKS), caption) for caption, image in shown.items()]
    found = measured(driver, probes.SILHOUETTE)
    rows = (
        ("change outside the outline of a near square", (found["change outside the silhouette"],)),
        ("pixels over which it fades inside", (found["fading inside the silhouette (pixels)"],)),
        ("its CoC, pixels", (probes.coc_pixels(probes.NEAR),)),
    )
    images = {"figure_03": ours, "figure_03_truth": lens}
    return Made({"figure_03": panels.grid([row])}, images, (Table(("paper",), rows, (1,)),))


BRANCHES = (100, 60, 190, 150)


def coc_blur(driver: Driver) -> Made:
    """Figure 7: branches with the CoC averaged like the colour, and with the CoC left alone."""
    cases = {"a": scene(CANOPY, diameter=WIDE), "b": scene(CANOPY, diameter=WIDE, blur_coc=False)}
    images = {key: drawn(driver, case) for key, case in cases.items()}
    values = tuple(edges(image) for image in images.values())
    table = Table(("(a)", "(b)"), (("hard edges, per mille of neighbouring pixels", values),), (1, 1))
    return _pair(7, images, {"a": "CoC blurred with the colour", "b": "CoC not blurred"}, BRANCHES, table)


def edges(image: np.ndarray) -> float:
    """How many of a thousand pairs of horizontal neighbours in BRANCHES differ by more than 0.2 on the display."""
    shown = metrics.tone_mapped(panels.crop(image, *BRANCHES)[..., 1])
    return 1000.0 * float((np.abs(np.diff(shown, axis=1)) > 0.2).mean())


CROWN = (310, 0, 150, 120)
# dark enough to tell the gaps' shapes from the sky
EXPOSURE = 0.4
CAPTIONS = {
    "paper": "paper, 13 samples a line",
    "exact": "exact, 7 samples an edge",
    "truth": "truth: brute force",
    "lens": "a lens, ray traced",
}


def canopy(driver: Driver) -> Made:
    """Figure 11, gaps of a canopy as hexagons: paper, exact, brute force; for the scene's own aperture also the lens.

    Three pictures: all of it through a wide aperture, a detail of that, and the same detail through its own aperture.
    """
    lens, pinhole, rows, details, images = ray_traced.truth(CANOPY, "hexagon"), scene(CANOPY).color, [], {}, {}
    for key, diameter in (("wide", WIDE), ("own", None)):
        paper = scene(CANOPY, diameter=diameter)
        found = {"paper": drawn(driver, paper), "exact": drawn(driver, scene(CANOPY, "exact", diameter))}
        found["truth"] = shapes.brute_force(driver, paper)
        for name, image in {"pinhole": pinhole, **found}.items():
            # FLIP takes seconds: only where it says most
            flip = key == "own" and name != "pinhole"
            to_truth = _near(image, found["truth"] if name != "truth" else None, flip)
            rows.append((f"{name}, {key}", (*to_truth, *_near(image, lens if key == "own" else None, flip))))
        found |= {"lens": lens} if key == "own" else {}
        images |= named(f"figure_11_{key}", found)
        details[key] = [
            Panel(panels.toned(panels.crop(image, *CROWN), EXPOSURE, 2), CAPTIONS[name])
            for name, image in found.items()
        ]
    rows = [row for row in rows if row[0] != "truth, wide"]
    caption = f"paper, hexagon, 13 samples a line, aperture {1000 * WIDE:g} mm"
    pictures = {
        "figure_11": panels.grid([[Panel(panels.toned(images["figure_11_wide_paper"], EXPOSURE), caption)]]),
        "figure_11_wide": panels.grid([details["wide"]]),
        "figure_11_own": panels.grid([details["own"][:2], details["own"][2:]]),
    }
    columns = ("dB to the truth", "FLIP to the truth", "dB to the lens", "FLIP to the lens")
    return Made(pictures, images, (Table(columns, rows, (1, 3, 1, 3)),))


def _near(image: np.ndarray, wanted: np.ndarray | None, flip: bool) -> tuple[float | None, float | None]:
    """PSNR and FLIP."""
    if wanted is None:
        return None, None
    return metrics.psnr(image, wanted), metrics.flip(image, wanted) if flip else None
