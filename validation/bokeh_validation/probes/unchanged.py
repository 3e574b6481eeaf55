"""The layered method: what must not change at all, and what must not jump."""

import numpy as np

from bokeh_validation.probes.lights import LIGHT
from bokeh_validation.probes.model import Case, Check, Outputs, Probe, depth_of, flat
from bokeh_validation.probes.near_edges import CAMERA, STEP, metres, settings

SWEEP_STEP = 0.25
# Through the focus, and where a plane goes from the gather into the near and the far layer
SWEEPS = ((-9.75, -8.25), (-3.0, 0.0), (0.0, 3.0), (12.25, 13.75))
SWEEP_COCS = [np.arange(first, last + SWEEP_STEP / 2, SWEEP_STEP) for first, last in SWEEPS]
SWEEP_SIZE = (40, 32)
COLOR = (0.7, 0.3, 40.0)
# CoC of planes: in focus, gathered, going into the near and into the far layer, in a layer
PLANES = (-24.0, -9.0, -4.0, 4.0, 13.0, 24.0)


def patches(size: tuple[int, int]) -> np.ndarray:
    """Random patches of 6 pixels, 0 to 1, (H, W, 3)."""
    width, height = size
    coarse = np.random.default_rng(3).random((height // 6 + 1, width // 6 + 1, 3))
    return np.kron(coarse, np.ones((6, 6, 1)))[:height, :width]


def hills() -> np.ndarray:
    """Random values 6 pixels apart, with straight slopes between them, 0 to 1, (H, W, 4) float16 in SWEEP_SIZE."""
    width, height = SWEEP_SIZE
    values = np.random.default_rng(3).random((height // 6 + 2, width // 6 + 2, 3))
    for axis, length in ((0, height), (1, width)):
        place = np.arange(length) / 6.0
        first = place.astype(int)
        share = np.expand_dims(place - first, (1 - axis, 2))
        values = values.take(first, axis) * (1.0 - share) + values.take(first + 1, axis) * share
    color = flat(SWEEP_SIZE)
    color[..., :3] = values
    return color


def jump_allowed(first: np.ndarray, last: np.ndarray) -> float:
    """How far a pixel of hills() may change in a step of a sweep; its pictures at both ends, (H, W, 3).

    A lens moves what a pixel sees by half of the step at most: half the step times the largest difference of
    neighbours on each axis. A plane goes into a layer within 1.2 pixels of CoC (its share is 5 (c - 6) / 6 - 2 of the
    near layer, 5 (c - 10) / 6 - 2 of the far one). What it becomes by that, the two ends of the sweep, comes at that
    rate, or at twice that where two shares are multiplied: 0.42 of it in a quarter of a pixel. The gather's first ring,
    a pixel away, comes with a weight of 2 (r - 1/2) / max(r^2, 1/4), r half the CoC less half a pixel, against
    1/4 / max(r^2, 1/4) of the middle: a half within the first quarter. So half of it is allowed; a pop is all of it.
    """
    image = hills()[..., :3].astype(np.float64)
    slopes = sum(np.abs(np.diff(image, axis=axis)).max() for axis in (0, 1))
    return float(SWEEP_STEP * 0.5 * slopes + 0.5 * np.abs(last - first).max() + 2 * STEP)


def _judge_sweep(outputs: dict[str, Outputs]) -> list[Check]:
    checks, why = [], "half of all that the sweep does, and a lens's own change: derived at jump_allowed"
    for cocs in SWEEP_COCS:
        pictures = np.array([outputs[f"CoC {coc:g}"]["result"][..., :3] for coc in cocs])
        name = f"largest change in steps of {SWEEP_STEP} pixels, CoC {cocs[0]:g} to {cocs[-1]:g}"
        largest = np.abs(np.diff(pictures, axis=0)).max()
        checks.append(Check(name, largest, 0.0, jump_allowed(pictures[0], pictures[-1]), why))
    return checks


def constant_cases() -> list[Case]:
    """Planes; random depth, each pixel and in patches."""
    size = (61, 43)
    color = flat(size)
    color[..., :3] = COLOR
    depths = {f"plane at CoC {coc:g}": depth_of(size, metres(coc, size[1])) for coc in PLANES}
    depths["noise"] = np.random.default_rng(5).uniform(0.8, 30.0, size[::-1])
    depths["patches"] = 0.8 + 29.0 * patches(size)[..., 0]
    return [Case(label, settings(), color, depth.astype(np.float32)) for label, depth in depths.items()]


def _judge_constant(outputs: dict[str, Outputs]) -> list[Check]:
    constant = np.array(COLOR, np.float16).astype(np.float64)
    why = "a mean of one colour: a layer and its share are cut off three times each, the picture once"
    return [
        Check(f"off by, {label}", np.abs(textures["result"][..., :3] / constant - 1.0).max(), 0.0, 4 * STEP, why)
        for label, textures in outputs.items()
    ]


def focus_case(size: tuple[int, int] = (64, 32)) -> Case:
    """Patches with lights, all in focus; powers of two, so that a fetch in the middle of a texel is a copy."""
    color = flat(size)
    color[..., :3] = patches(size)
    color[4::9, 5::11, :3] = LIGHT
    return Case("in focus", settings(), color, depth_of(size, CAMERA.focus_distance))


def _judge_focus(outputs: dict[str, Outputs]) -> list[Check]:
    off = np.abs(outputs["in focus"]["result"][..., :3] - focus_case().color[..., :3].astype(np.float64)).max()
    return [Check("off by", off, 0.0, 0.0, "nothing spreads: the picture is copied, to the bit")]


SWEEP = Probe(
    "layered-sweep",
    "Nothing pops as the CoC goes through zero and into the layers",
    "Hills that get blurred a little more from picture to picture.",
    tuple(
        Case(f"CoC {coc:g}", settings(), hills(), depth_of(SWEEP_SIZE, metres(coc, SWEEP_SIZE[1])))
        for coc in np.unique(np.concatenate(SWEEP_COCS))
    ),
    _judge_sweep,
)
CONSTANT = Probe(
    "layered-constant",
    "One colour stays as it is at any depth",
    "A plain grey-blue everywhere: no seam between layers, tiles and gather.",
    tuple(constant_cases()),
    _judge_constant,
)
FOCUS = Probe(
    "layered-focus", "What is in focus stays as it is", "The picture, to the bit.", (focus_case(),), _judge_focus
)
PROBES = (SWEEP, CONSTANT, FOCUS)
