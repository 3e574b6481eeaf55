"""Time other effects beside this package's pass for three.js: the option --time of `validation/run peers`.

All effects draw the same scene on WebGL 2, in one page and in turn. Each time is that of a frame with the effect, less
that of the same frame without it. This package's pass is the one that npm installs, integration/web.
"""

import os
import time
from collections.abc import Callable, Iterator, Sequence
from datetime import UTC, datetime

import numpy as np

from bokeh_validation.errors import UserError
from bokeh_validation.frame.methods import Camera
from bokeh_validation.truth import ray_traced
from lab.other_effects.effects import CRATE, EFFECTS, FOUND, Page, Parameters, title

ROUNDS = 9  # maximum number of measured rounds
# Seconds after which no round begins, so that a busy machine takes at most four minutes
LONGEST = 190.0
# The ratios are to the time of this effect
BASE = "BokehPass"
# Names in page/peers.js. Bevy's effects run on WebGPU only.
OTHERS = tuple(name for name, (_, package, _) in EFFECTS.items() if package != CRATE)
OURS = ("exact low", "exact medium", "layered mobile", "layered low", "layered medium", "layered high")
# Step of the browser's clock, milliseconds; the least time of an effect
RESOLUTION = 0.1


def chosen(names: Sequence[str]) -> list[str]:
    """Return the names of what is timed: these effects, BASE, and OURS. Raises UserError for an effect on WebGPU."""
    for name in names:
        if name not in OTHERS:
            raise UserError(f"--effect {name}: does not run on WebGL 2. With --time give one of {', '.join(OTHERS)}.")
    return [name for name in OTHERS if name == BASE or name in names] + list(OURS)


def lens(camera: Camera) -> Parameters:
    """Return the uniforms of this package's pass for a camera; metres, except maxCoC."""
    values = ((name.removeprefix("Bokeh"), value) for name, value in camera.parameters().items())
    return {name[0].lower() + name[1:]: value for name, value in values}


def measured(scene: ray_traced.SceneFile, names: Sequence[str], step: Callable[[str], None]) -> dict:
    """Time effects on a scene, with the parameters of found.json. Raises Unavailable.

    names  from chosen()
    step   called with the name of each finished round; a round that is not measured comes first
    Returns what --json writes.
    """
    image, given = ray_traced.picture(scene), FOUND[scene.name] | dict.fromkeys(OURS, lens(scene.camera))
    with Page([]) as page:
        page.load(image.color, image.depth, scene.camera)
        rounds, start = [], time.monotonic()
        for turn in range(1 + ROUNDS):
            first = turn % len(names)
            rounds.append({name: page.time(name, given[name]) for name in (*names[first:], *names[:first])})
            step(f"round {turn}" if turn else "warm-up")
            if turn and time.monotonic() - start > LONGEST:
                break
        device, version = page.device(BASE), page.version
    about = {"date": datetime.now(UTC).date().isoformat(), "scene": scene.name, "size": image.size}
    about |= {"rounds": len(rounds) - 1, "device": device, "chromium": version, "cores": os.cpu_count()}
    return about | {"rows": summary(names, np.array([list(map(one.get, names)) for one in rounds[1:]]))}


def summary(names: Sequence[str], times: np.ndarray) -> list[dict]:
    """Return a row for each effect: medians over the rounds, and the quartiles of the ratio.

    times  milliseconds of frames without the effect and with it, (rounds, effects, 2)
    `ms` in a row is the time of the effect itself, `without` that of the frame without it. `ratio` is `ms` over that of
    BASE in the same round.
    """
    own = np.maximum(times[..., 1] - times[..., 0], RESOLUTION)
    ratios = own / own[:, [list(names).index(BASE)]]
    low, ratio, high = np.percentile(ratios, (25, 50, 75), axis=0)
    return [
        {
            "label": title(name) if name in EFFECTS else name,
            "ms": round(float(np.median(own[:, at])), 2),
            "without": round(float(np.median(times[:, at, 0])), 2),
            "ratio": round(float(ratio[at]), 3),
            "quartiles": [round(float(low[at]), 3), round(float(high[at]), 3)],
        }
        for at, name in enumerate(names)
    ]


def table(found: dict) -> Iterator[str]:
    """Yield the lines that the command prints; `found` comes from measured()."""
    yield "{device}; Chromium {chromium}, {cores} cores".format(**found)
    yield "{scene} at {size[0]} x {size[1]}, medians of {rounds} rounds".format(**found)
    yield f"| effect | ms | frame without it, ms | ratio to {EFFECTS[BASE][0]} | quartiles of the ratio |"
    yield f"|{'---|' * 5}"
    for row in found["rows"]:
        ratio, low, high = (f"{value:.2f}" for value in (row["ratio"], *row["quartiles"]))
        yield f"| {row['label']} | {row['ms']:.1f} | {row['without']:.1f} | {ratio} | {low} to {high} |"
