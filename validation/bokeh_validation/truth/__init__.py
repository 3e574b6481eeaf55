"""Draw every ray-traced scene with every method, and compare the results with a lens."""

from collections.abc import Mapping, Sequence

import numpy as np

from bokeh_validation import metrics, terminal
from bokeh_validation.drivers.base import Driver
from bokeh_validation.probes.model import Case
from bokeh_validation.truth import labels, ray_traced
from bokeh_validation.truth.labels import METHODS
from bokeh_validation.truth.ray_traced import SceneFile

DEFAULT = METHODS[: METHODS.index("layered medium") + 1]
# Exposure with which scenes are displayed; 1 for all others
EXPOSURE = {"market_7": 2.2, "canopy_12": 0.5, "canopy_12x3": 0.5}


def case(scene: SceneFile, label: str, aperture: str = "hexagon", **changes) -> Case:
    """Return a case of a scene with one of METHODS, the polygon rotated as in the truth; `changes` are to its
    settings.
    """
    changes = {"rotation": ray_traced.TRUTH_ROTATION[aperture], **changes}
    image = ray_traced.picture(scene)
    return Case(scene.name, labels.settings(label, scene.camera, aperture, **changes), image.color, image.depth)


def picture(driver: Driver, scene: SceneFile, label: str, aperture: str = "hexagon", **changes) -> np.ndarray:
    """Draw a scene with one of METHODS, (H, W, >= 3); arguments as in case()."""
    return labels.picture(driver, label, case(scene, label, aperture, **changes))


def measured(image: np.ndarray, lens: np.ndarray) -> dict[str, float]:
    """Compare an image with the truth `lens`, both linear (H, W, >= 3): mean FLIP, PSNR of tone-mapped colour in dB,
    and light divided by the truth's.
    """
    light = image[..., :3].astype(np.float64).sum() / lens[..., :3].astype(np.float64).sum()
    return {"flip": metrics.flip(image, lens), "psnr": metrics.psnr(image, lens), "light": float(light)}


def markdown(rows: Sequence[Mapping]) -> list[str]:
    """Return a Markdown table with a row per method and a column per scene: FLIP, PSNR in dB, light kept."""
    names = dict.fromkeys(row["scene"] for row in rows)
    lines = [f"| | {' | '.join(names)} |", f"|{'---|' * (len(names) + 1)}"]
    for label in dict.fromkeys(row["label"] for row in rows):
        cells = ["{flip:.4f}/{psnr:.2f}/{light:.3f}".format_map(row) for row in rows if row["label"] == label]
        lines.append(f"| {label} | {' | '.join(cells)} |")
    return lines


def ray_traced_report(
    methods: Sequence[str], driver: Driver, scenes: Sequence[SceneFile]
) -> tuple[list[dict], list[str]]:
    """Measure the methods on the scenes; returns the rows and their Markdown table."""
    rows = []
    with terminal.progress("truth", len(scenes) * len(methods)) as step:
        for file in scenes:
            lens = ray_traced.truth(file, "hexagon")
            for label in methods:
                rows.append({"scene": file.name, "label": label, **measured(picture(driver, file, label), lens)})
                step(f"{file.name}, {label}")
    return rows, markdown(rows)
