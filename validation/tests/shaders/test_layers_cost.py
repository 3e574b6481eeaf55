"""What the layers cost: texels fetched, counted on the device."""

import re
from dataclasses import replace

import numpy as np
import pytest
from support import load

from bokeh_validation import shaders
from bokeh_validation.frame import fetches, methods
from bokeh_validation.probes import near_edges
from bokeh_validation.probes.model import depth_of, flat
from bokeh_validation.shaders.passes import COPYING_ENTRIES, Pass

MOST_FETCHES = {"low": (55, 55), "medium": (90, 90)}
# The same where all is in focus, of the paper's 3 x 13 fetches of colour and as many of depth
IN_FOCUS = 0.35 * 2 * 39


def counting(item: Pass, outputs: tuple[str, ...]) -> Pass:
    """A pass that writes how often it fetched in place of its result."""
    text = shaders.glsl(item.entry, "330", item.constants)
    head = re.compile(r"^(vec4 BokehFetch(?:Grid|Around|Nearest)\([^)]*\)\n\{\n)", re.MULTILINE)
    text, found = head.subn(r"\1    fetched += 1.0;\n", text)
    assert found == 3
    text, found = re.subn(r"\bvoid main\(\)", "void counted()", text)
    assert found >= 1
    version, rest = text.split("\n", 1)
    main = "void main()\n{\n    counted();\n    BokehResult = vec4(fetched);\n}\n"
    text = f"{version}\nfloat fetched = 0.0;\n{rest}\n{main}"
    return replace(item, output=outputs, sources={"glsl": text})


def counted(settings: methods.Settings, color: np.ndarray, depth: np.ndarray) -> dict[str, tuple[float, float]]:
    """Entry and number of each pass after the CoC map -> its fetches for a pixel of the full size: mean, most."""
    size = depth.shape[::-1]
    plan, names = methods.plan(settings, size).passes, []
    passes = []
    for number, item in enumerate(plan):
        passes.append(item)
        if item.entry not in COPYING_ENTRIES:
            names.append(f"{number} {item.entry}")
            others = tuple(f"{number}, {k}" for k in range(1, len(item.outputs)))
            passes.append(counting(item, (names[-1], *others)))
    output = load("osmesa").run(passes, {"color": color, "depth": depth}, size, keep=names)
    scales = [item.scale for item in plan if item.entry not in COPYING_ENTRIES]
    found = zip(names, scales, strict=True)
    return {n: tuple(f(output[n][..., 0].astype(float)) / s**2 for f in (np.mean, np.max)) for n, s in found}


COC = 80
SIZE = (256, 2 * COC)


@pytest.mark.parametrize("preset", MOST_FETCHES)
def test_fetches_at_the_worst(preset):
    """Of the picture, and of a pixel for which every pass takes all that it can.

    Patches of 2 pixels of the largest CoC near and far, a third of them and none: layers and gather have most to do
    everywhere.
    """
    depths = [near_edges.metres(coc, SIZE[1]) for coc in (-COC, -COC / 3, 0.0, COC / 3, COC)]
    coarse = np.random.default_rng(4).choice(np.float32(depths), (SIZE[1] // 2, SIZE[0] // 2))
    camera = replace(near_edges.CAMERA, max_coc=COC / SIZE[1])
    settings = replace(near_edges.settings(preset=preset), camera=camera)
    found = counted(settings, flat(SIZE, 1.0), coarse.repeat(2, 0).repeat(2, 1))
    mean, most = (sum(counts[i] for counts in found.values()) for i in (0, 1))
    allowed = MOST_FETCHES[preset]
    assert mean <= allowed[0] and most <= allowed[1], (mean, most, found)
    # the CoC map besides
    assert most + 1 == pytest.approx(fetches.of_frame(methods.plan(settings, SIZE).passes)["color"])


@pytest.mark.parametrize("preset", methods.PRESETS)
def test_fetches_in_focus(preset):
    """What the plan says of it, to the fetch."""
    depth = depth_of(SIZE, near_edges.CAMERA.focus_distance)
    settings = near_edges.settings(preset=preset)
    found = counted(settings, flat(SIZE, 1.0), depth)
    total = sum(mean for mean, _ in found.values())
    assert total <= IN_FOCUS, found
    counts = [(fetches.of_pass(item, True)["color"], item.scale**2) for item in methods.plan(settings, SIZE).passes]
    # the CoC map besides
    assert sum(count / texel for count, texel in counts) == total + 1
