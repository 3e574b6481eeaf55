"""What a driver is asked to run: a list of passes over named textures."""

from collections.abc import Mapping
from dataclasses import dataclass, field

# Order is the layout: parameter i is SM3 register c(i) and byte offset 4 i of the uniform block (docs/inputs.md).
# The values are used where a pass does not say otherwise.
PARAMETERS: dict[str, float] = {
    "BokehApertureDiameter": 0.05,
    "BokehFocalLength": 0.05,
    "BokehFocusDistance": 5.0,
    "BokehSensorHeight": 0.024,
    "BokehMaxCoC": 0.1,
    "BokehConstantCoC": 0.0,
    "BokehAspectRatio": 1.0,
    "BokehAngle": 0.0,
    "BokehAngleB": 0.0,
    "BokehBleedingBias": 0.02,
    "BokehBleedingMult": 30.0,
    "BokehBlurCoC": 1.0,
    "BokehUseMax": 0.0,
    "BokehDebugMode": 0.0,
}

# Texture slots in the order of their bindings.
SLOTS = ("ColorSamp", "DepthSamp", "ColorSampB", "KernelSamp")
# Slots that the filter passes sample with a linear filter; all else is fetched from the nearest texel. The first pass
# copies colour texel by texel: a linear filter there would blur by the rounding of uv.
LINEAR_SLOTS = ("ColorSamp", "ColorSampB")
COPYING_ENTRIES = ("BokehCoCMap", "BokehConstantCoC")


def is_linear(entry: str, slot: str) -> bool:
    """Whether a pass samples a slot with the linear filter."""
    return slot in LINEAR_SLOTS and entry not in COPYING_ENTRIES


@dataclass(frozen=True)
class Pass:
    """One full-screen pass.

    entry       one of shaders.ENTRIES
    inputs      slot -> name of a texture: one that was handed in, or the output of an earlier pass
    output      name of the texture it writes
    parameters  those that differ from PARAMETERS
    samples     BOKEH_NUM_SAMPLES
    """

    entry: str
    inputs: Mapping[str, str]
    output: str
    parameters: Mapping[str, float] = field(default_factory=dict)
    samples: int = 13

    def values(self) -> dict[str, float]:
        """All parameters, in layout order."""
        unknown = set(self.parameters) - set(PARAMETERS)
        if unknown:
            raise KeyError(f"no such parameter: {', '.join(sorted(unknown))}")
        return {**PARAMETERS, **self.parameters}
