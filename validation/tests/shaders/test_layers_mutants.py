"""What a mutant of the layers was needed for to be noticed (validation/run mutants)."""

import re
from dataclasses import replace

import numpy as np
import pytest
from support import in_each_language, load
from support_cases import noise_case, within
from support_targets import framed, inside
from test_layers import SETTINGS, TEXTURES

from bokeh_validation import shaders
from bokeh_validation.frame import methods
from bokeh_validation.probes import near_edges
from bokeh_validation.probes.model import Case, depth_of, flat

# A focus between the depths: near CoC up to 25 pixels of 50 rows, far ones up to 17, so that both layers are full
FULL = methods.Camera(1.8, 0.05, 8.0, max_coc=0.5)


def black_and_bright() -> Case:
    """Both ends of what brightness is compared with: a black tile's level, and what a light may weigh."""
    case = noise_case((64, 48), replace(SETTINGS, camera=FULL))
    case.color[:, :32, :3] = 0.0
    case.color[3::9, 36::7, :3] = 60000.0
    return case


def plane(coc: float) -> Case:
    """One depth, of which a part is in a layer."""
    case = noise_case((50, 40), near_edges.settings(rotation=10.0))
    return replace(case, depth=depth_of(case.size, near_edges.metres(coc, case.size[1])))


# much of either layer; the last: edges with fewer samples than texels
BOTH = {
    "hexagon": {"jitter": 1.0, "squeeze": 0.7},
    "decagon": {"aperture": "decagon", "preset": "low", "jitter": 0.5, "rotation": 20.0},
    "one target": {"aperture": "decagon", "preset": "ultra", "targets": False},
    "square": {"aperture": "square", "preset": "low", "jitter": 1.0, "camera": replace(FULL, max_coc=1.0)},
}
CASES = {
    **{f"both {k}": noise_case((75, 50), replace(SETTINGS, **{"camera": FULL, **one})) for k, one in BOTH.items()},
    **{f"half {coc}": plane(coc) for coc in (-11.0, -9.0, 11.0, 14.0)},
    # 1 / (1 / 122) is more than 122 in float32: rounded up without a care, half of it would be 62 texels
    "inverse": noise_case((122, 24), SETTINGS),
    "bright": black_and_bright(),
}


@pytest.mark.parametrize("name", CASES)
@in_each_language
def test_within(name, driver):
    """Each pass is within its interval."""
    within(driver, CASES[name])


@pytest.mark.parametrize("metres", [0.9, 30.0], ids=["near", "far"])
@in_each_language
def test_layers_of_a_viewport(metres, driver):
    """In the middle of a large texture, the image is what it would be alone; 11 pixels near and 16 far.

    Black but for a light whose blur ends before the edges. Places are off by float32 roundings, 8 of 2^-24 of the
    width, and a GPU's step of 2^-8 texel; the light's own slope is the steepest. Four passes store, with a step each.
    """
    viewport = (24, 16, 48, 40)
    camera = methods.Camera(0.3, 0.05, 1.5, max_coc=0.5)
    color, depth = flat(viewport[2:]), depth_of(viewport[2:], metres)
    color[18:22, 22:26, :3] = 40.0
    case = Case("", replace(SETTINGS, camera=camera), color, depth)
    alone = driver.run(case.plan.passes, case.textures(), case.size)["result"].astype(float)[..., :3]
    assert alone.max() < 0.5 * color.max()
    plan = methods.in_viewport(case.plan, viewport, TEXTURES)
    textures = {"color": framed(color, TEXTURES, viewport), "depth": framed(depth, TEXTURES, viewport)}
    output = inside(driver.run(plan.passes, textures, TEXTURES)["result"], viewport).astype(float)[..., :3]
    place = TEXTURES[0] * 8 * 2.0**-24 + (0.0 if driver.software else 2.0**-8)
    assert np.abs(output - alone).max() <= 4 * (place + 2.0**-10) * 40.0


def test_layers_without_jitter():
    """BokehMakeLayers: the image fills its textures, and there is no jitter."""
    text = re.sub(r"\bvoid main\(\)", "void unused()", shaders.glsl("BokehLayerTiles", "330", {}))
    text += (
        "void main()\n{\n    BokehPolygon polygon = BokehMakePolygon(8, 0.5, 0.75);\n"
        "    BokehLayers layers = BokehMakeLayers(vec2(64.0, 48.0), polygon, 0.25);\n"
        "    BokehResult = vec4(layers.jitter, layers.largest, layers.full.origin.x, layers.full.texel.y * 48.0);\n}\n"
    )
    item = methods.plan(SETTINGS, (8, 8)).passes[1]
    textures = {"coc": np.zeros((8, 8, 4), np.float16)}
    found = load("osmesa").run([replace(item, sources={"glsl": text})], textures, (8, 8), keep=item.outputs)
    np.testing.assert_array_equal(found[item.outputs[0]][0, 0], [0.0, 12.0, 0.0, 1.0])
