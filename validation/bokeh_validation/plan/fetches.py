"""Count the texels that the passes fetch."""

from math import ceil, pi, sin

import numpy as np

from bokeh_validation.frame.methods import PRESET_CONSTANTS
from bokeh_validation.shaders.entries import (
    ADAPTIVE,
    BOTH,
    DEPTH,
    EDGE,
    ENTRIES,
    FIRST,
    GRID,
    LATERAL,
    LINE,
    SECOND,
    STEADY,
    Most,
)
from bokeh_validation.shaders.passes import Pass

KINDS = ("color", "depth", "table")


def of_pass(render_pass: Pass) -> dict[str, int]:
    """Return KINDS -> fetches for one texel of a pass's targets if it takes all of its samples."""
    if render_pass.spec.layers:
        return {"color": _of_layers(render_pass), "depth": 0, "table": 0}
    # one fetch of the other parallelogram in a final pass, without its depth
    further = int("DepthSamp" in render_pass.inputs and "ColorSampB" in render_pass.inputs)
    samples = render_pass.samples if "KernelSamp" in render_pass.inputs else lines(render_pass) * render_pass.samples
    # lateral colour: red and blue; the steady map: the 3 x 3 neighbourhood and two other textures; the signed map: the
    # four neighbours (depth only for one that is a light)
    further += (
        2 * (render_pass.spec.role == LATERAL)
        + 11 * (render_pass.spec.role == STEADY)
        + 4 * (render_pass.entry == "BokehSignedCoCMap")
    )
    depth = 1 + samples if "DepthSamp" in render_pass.inputs else 0
    return {
        "color": 0 if render_pass.spec.role == DEPTH else 1 + further + samples,
        "depth": depth,
        "table": render_pass.samples if "KernelSamp" in render_pass.inputs else 0,
    }


def lines(render_pass: Pass) -> int:
    """Return along how many lines a filter pass takes samples, except for passes of the layers; an n x n grid is n
    lines.
    """
    entry = render_pass.spec
    if entry.role in (LINE, ADAPTIVE):
        return 1
    if entry.role == GRID:
        return render_pass.samples
    if entry.role == EDGE:
        # including the lines of the earlier edges' parallelograms
        return render_pass.constants["BOKEH_TARGET_INDEX"] + 1
    return entry.sides // 2 - 1 if entry.role in (FIRST, SECOND) else 0


def of_frame(passes: tuple[Pass, ...]) -> dict[str, float]:
    """Return KINDS -> fetches per full-size pixel for all passes together."""
    counts = [(of_pass(render_pass), render_pass.scale**2) for render_pass in passes]
    return {kind: sum(count[kind] / texel for count, texel in counts) for kind in KINDS}


def tiles_along(render_pass: Pass) -> int:
    """Return how many tiles along one axis the layers' tile passes read; computed in float32 like on the device."""
    values = render_pass.values()
    largest = np.float32(values["BokehMaxCoC"]) * np.float32(values["BokehImageHeight"])
    return min(2 * (int(np.ceil(largest / np.float32(16.0))) + 2) + 1, 255)


def _of_layers(render_pass: Pass) -> int:
    """Return the colour fetches of a pass of the layers, by the loops of bokeh_layers.*."""
    values = render_pass.values()
    sides = round(values["BokehSides"])
    rings, samples, cubic, scale = (render_pass.defines[name] for name in PRESET_CONSTANTS)
    tiles = tiles_along(render_pass)

    def ring_samples(count: int) -> int:
        return sum(sides * max(int(6 * ring / sides + 0.5), 1) for ring in range(1, count + 1))

    if render_pass.spec.role in (FIRST, SECOND, EDGE):
        edges = render_pass.constants["BOKEH_TARGET_INDEX"] + 1 if render_pass.spec.role == EDGE else sides // 2 - 1
        # a square's lines have twice the sample density
        along_edge = ceil(samples * (1.4142136 / 0.708 if sides == 4 else 2.0 * sin(pi / sides)))
        layers_at_once = 2 if render_pass.spec.sides in BOTH else 1
        return 1 + layers_at_once * edges * along_edge
    # HoleFill takes three rings of the size of the gather's first one. A wide gather adds one such ring, except where
    # Composite reads the fills, which are fewer fetches. A preset with at most one ring adds it where one fill is read.
    gather = ring_samples(rings) + ring_samples(1) + (rings <= 1)
    loop_counts = Most(tiles, 1 + 3 * ring_samples(1), 5 if cubic else 1, gather, scale)
    counts = ENTRIES[render_pass.spec.whole or render_pass.entry].fetches(loop_counts)
    return counts[1 + render_pass.constants["BOKEH_TARGET_INDEX"] if render_pass.spec.whole else 0]
