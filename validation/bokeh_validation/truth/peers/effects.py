"""The effects, and what is tried of each beside the parameters that its documentation asks for (page/lens.js)."""

import itertools
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from bokeh_validation.truth.peers import crate

Parameters = dict[str, float | bool]
# What a search found best (`validation/run peers --search`): scene, or ONE_LIGHT -> effect -> parameters
FOUND = Path(__file__).parent / "found.json"
ONE_LIGHT = "one light"


def found() -> dict[str, dict[str, Parameters]]:
    """The contents of found.json."""
    return json.loads(FOUND.read_text(encoding="ascii"))


@dataclass(frozen=True)
class Effect:
    """One of page/peers.js.

    package  of npm, or the crate
    factors  of parameters, that are tried; 1 is among them
    choices  values of its other options; the first is its own default, or the strongest blur
    """

    title: str
    package: str
    factors: Mapping[str, Sequence[float]]
    choices: Mapping[str, Sequence] = field(default_factory=dict)

    def grid(self, base: Parameters) -> Iterator[Parameters]:
        """All that is tried, what is documented (base) first."""
        ordered = {name: sorted(values, key=lambda value: value != 1) for name, values in self.factors.items()}
        for factors in itertools.product(*ordered.values()):
            scaled = {name: base[name] * factor for name, factor in zip(ordered, factors, strict=True)}
            for chosen in itertools.product(*self.choices.values()):
                yield {**base, **scaled, **dict(zip(self.choices, chosen, strict=True))}


SIZES, RANGES, LENS = (0.35, 0.5, 0.7, 1.0), (0.25, 0.5, 1.0), (0.7, 1.0, 1.4)
EFFECTS = {
    "BokehPass": Effect(
        "three.js BokehPass", "three", {"aperture": (0.35, 0.7, 1.0, 1.4), "maxblur": (0.7, 1.0, 1.4)}
    ),
    "DepthOfFieldNode": Effect("three.js DepthOfFieldNode", "three", {"focalLength": RANGES, "bokehScale": SIZES}),
    "DepthOfFieldEffect": Effect(
        "pmndrs DepthOfFieldEffect", "postprocessing", {"focusRange": RANGES, "bokehScale": SIZES},
        {"resolutionScale": (0.5, 1.0)},
    ),
    "Babylon": Effect(
        "Babylon.js DepthOfFieldEffect", "@babylonjs/core", {"fStop": (1.0, 2.0, 4.0, 8.0)},
        {"blurLevel": (2, 1, 0)},
    ),
    "CameraFrame": Effect(
        "PlayCanvas CameraFrame", "playcanvas",
        {"focusRange": RANGES, "blurRadius": (0.7, 1.0, 1.4)},
        {"nearBlur": (True, False), "blurRings": (4,), "blurRingPoints": (5,), "highQuality": (True,)},
    ),
    "BevyBokeh": Effect("Bevy bokeh", crate.NAME, {"scale": LENS, "maxDiameter": (1.0, 2.0)}),
    "BevyGaussian": Effect("Bevy Gaussian", crate.NAME, {"scale": LENS, "maxDiameter": (1.0, 2.0)}),
}  # fmt: skip
