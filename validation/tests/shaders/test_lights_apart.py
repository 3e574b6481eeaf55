"""Measure every light of lights_apart.GROUPS on llvmpipe, and compare it with docs/data/lights_apart.json.

After an intended change, write a new file, and say in the commit why the numbers changed:

    BOKEH_WRITE_EXPECTED=1 validation/test validation/tests/shaders/test_lights_apart.py
    validation/run generate  # writes the tables of docs/results-data.md
"""

import json
import os

import numpy as np
import pytest
from support import load

from bokeh_validation import files, paths
from bokeh_validation.probes import lights_apart
from bokeh_validation.probes.model import drawn

SOURCE = (
    "measured on llvmpipe with BOKEH_WRITE_EXPECTED=1 validation/test validation/tests/shaders/test_lights_apart.py"
)


def result(group: lights_apart.Group, apart: lights_apart.Apart, method: str) -> np.ndarray:
    """Draw a light of a group."""
    return drawn(load("egl"), apart.case(group.settings(method)))


def write() -> None:
    """Measure all lights, and write one line for each."""
    rows = []
    for group in lights_apart.GROUPS.values():
        for apart in group.lights:
            row = {"aperture": group.aperture, "light": apart.label}
            for method in lights_apart.METHODS:
                measured = apart.measured(result(group, apart, method), group.aperture)
                row[method] = [round(value, 2) for value in measured]
            rows.append(json.dumps(row))
    text = f'{{\n "source": {json.dumps(SOURCE)},\n "rows": [\n  ' + ",\n  ".join(rows) + "\n ]\n}\n"
    files.whole(paths.ROOT / lights_apart.FILE, lambda target: target.write_text(text, encoding="utf-8"))


@pytest.fixture(scope="module", autouse=True)
def recorded() -> None:
    """Write the file first if BOKEH_WRITE_EXPECTED is set."""
    if os.environ.get("BOKEH_WRITE_EXPECTED"):
        write()
        lights_apart.recorded.cache_clear()


@pytest.mark.parametrize("method", lights_apart.METHODS)
@pytest.mark.parametrize("name", lights_apart.GROUPS)
def test_lights_apart(name, method):
    """Check that each light is as it was asked for, or else as recorded."""
    group = lights_apart.GROUPS[name]
    failed = [
        f"{check.name} {check.value:.3f} ({check.low:.3f} .. {check.high:.3f}): {check.why}"
        for apart in group.lights
        for check in lights_apart.checks(apart, method, result(group, apart, method), group.aperture)
        if not check.ok
    ]
    assert not failed, failed


def test_the_probes_draw_lights_of_the_groups():
    """Check that each light of the probes is recorded."""
    lights = {apart for group in lights_apart.GROUPS.values() for apart in group.lights if group.aperture == "hexagon"}
    assert set(lights_apart.CASES) <= lights
