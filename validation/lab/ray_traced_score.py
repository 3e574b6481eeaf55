"""Measure methods on the ray-traced scenes, and write the table of `truth` and `peers`."""

from collections.abc import Mapping, Sequence

from bokeh_validation import terminal, truth
from bokeh_validation.drivers.base import Driver
from bokeh_validation.truth import ray_traced
from bokeh_validation.truth.ray_traced import SceneFile


def markdown(rows: Sequence[Mapping]) -> list[str]:
    """Return a Markdown table with a row per method and a column per scene: FLIP, PSNR in dB, light kept."""
    names = dict.fromkeys(row["scene"] for row in rows)
    lines = [f"| | {' | '.join(names)} |", f"|{'---|' * (len(names) + 1)}"]
    for label in dict.fromkeys(row["label"] for row in rows):
        cells = ["{flip:.4f}/{psnr:.2f}/{light:.3f}".format_map(row) for row in rows if row["label"] == label]
        lines.append(f"| {label} | {' | '.join(cells)} |")
    return lines


def report(methods: Sequence[str], driver: Driver, scenes: Sequence[SceneFile]) -> tuple[list[dict], list[str]]:
    """Measure the methods on the scenes; returns the rows and their Markdown table."""
    rows = []
    with terminal.progress("truth", len(scenes) * len(methods)) as step:
        for file in scenes:
            lens = ray_traced.truth(file, "hexagon")
            for label in methods:
                rows.append(
                    {"scene": file.name, "label": label, **truth.measured(truth.picture(driver, file, label), lens)}
                )
                step(f"{file.name}, {label}")
    return rows, markdown(rows)
