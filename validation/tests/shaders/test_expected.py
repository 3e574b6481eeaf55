"""Compare each pass of layered on small images with results in the repository that were reviewed when they were
written.

The reference of layered is its own GLSL, so a mistake made in all languages would be in the reference too. Here each
pass is compared with stored images, starting from the stored inputs.

After an intended change, write new ones and say in the commit why they changed:

    BOKEH_WRITE_EXPECTED=1 validation/test validation/tests/shaders/test_expected.py
"""

import os
from dataclasses import replace

import numpy as np
import pytest
from support_cases import noise_case

from bokeh_validation import paths
from bokeh_validation.numerics import images
from bokeh_validation.probes import cases, near_edges
from bokeh_validation.probes.model import Case, depth_of
from bokeh_validation.reference import pass_images
from bokeh_validation.shaders.entries import ENTRIES

FILE = paths.VALIDATION / "tests/shaders/expected_layered.npz"
SIZE = (37, 27)
# wide enough that lines of a layer have samples more than a texel apart, and read its quarter layer
WIDE_SIZE = (16, 120)
SETTINGS = cases.tagged(cases.EXPECTED)


def case(name: str) -> Case:
    """Return a case of random patches; "hexagon" also has black on the left and lights on the right, planes have one
    depth.
    """
    size = WIDE_SIZE if name.startswith("wide") else SIZE
    found = noise_case(size, SETTINGS[name])
    if name == "slope":
        # weights of the near layer from 0 to 1
        columns = [near_edges.metres(coc, SIZE[1]) for coc in np.linspace(-4.0, -12.0, SIZE[0])]
        return replace(found, depth=np.tile(np.float32(columns), (SIZE[1], 1)))
    if name.startswith("plane"):
        coc = float(name.removeprefix("plane "))
        return replace(found, depth=depth_of(SIZE, near_edges.metres(coc, SIZE[1])))
    if name.startswith("wide"):
        coc = float(name.removeprefix("wide ").replace("square", "100.0"))
        return replace(found, depth=depth_of(size, near_edges.metres(coc, size[1])))
    if name == "hexagon":
        found = replace(found, color=found.color.copy())
        found.color[:, :16, :3] = 0.0
        found.color[3::9, 20::7, :3] = 60000.0
    return found


@pytest.fixture(scope="module")
def expected() -> dict[str, np.ndarray]:
    """Return 'case/texture' -> (H, W, 4) float16; written first if BOKEH_WRITE_EXPECTED is set."""
    if os.environ.get("BOKEH_WRITE_EXPECTED"):
        written = {}
        for name in SETTINGS:
            passes = case(name).plan.passes
            names = [output for render_pass in passes for output in render_pass.outputs]
            kept = pass_images.images(passes, case(name).textures(), case(name).size)
            written |= {f"{name}/{output}": kept[output].value.astype(np.float16) for output in names}
        np.savez_compressed(FILE, **written)
    with np.load(FILE) as file:
        return dict(file)


@pytest.mark.parametrize("name", SETTINGS)
def test_every_pass(name, expected):
    """Compare to one step of the stored half floats, since sin and cos may differ in the last bit."""
    mine = {key.removeprefix(f"{name}/"): pixels for key, pixels in expected.items() if key.startswith(f"{name}/")}
    drawn = case(name)
    results = pass_images.images(drawn.plan.passes, drawn.textures(), drawn.size, given=mine)
    assert set(results) == set(mine)
    for output, image in results.items():
        reference = mine[output].astype(np.float64)
        off = np.abs(image.value - reference) / images.step(np.abs(reference), np.float16)
        assert off.max() <= 1.0, (output, off.max())


def test_two_steps_are_noticed(expected):
    """Check that the tolerance of test_every_pass is not wider than it says."""
    off = {key: pixels.copy() for key, pixels in expected.items()}
    pixel = off["little/result"][5, 5]
    pixel[:3] += 2 * images.step(np.abs(pixel[:3]).astype(np.float64), np.float16).astype(np.float16)
    with pytest.raises(AssertionError):
        test_every_pass("little", off)


def test_every_entry_is_expected():
    """Check that the cases draw all entries of bokeh_layers.*."""
    drawn = {render_pass.entry for name in SETTINGS for render_pass in case(name).plan.passes}
    assert {entry.name for entry in ENTRIES.values() if entry.layers} <= drawn
