"""What a driver is asked to run: a list of passes over named textures."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from bokeh_validation import shaders

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
    "BokehLineLength": 1.0,
    "BokehLineCenterX": 0.0,
    "BokehLineCenterY": 0.0,
    "BokehSqueeze": 1.0,
    "BokehSpacing": 0.0,
    "BokehImageWidth": 1.0,
    "BokehImageHeight": 1.0,
    "BokehJitter": 0.0,
    "BokehFrame": 0.0,
    "BokehSides": 6.0,
    "BokehEdge": 1.0,
    "BokehDepthKind": 0.0,
    "BokehNear": 0.1,
    "BokehFar": 1000.0,
    "BokehViewportX": 0.0,
    "BokehViewportY": 0.0,
    "BokehTextureWidth": 1.0,
    "BokehTextureHeight": 1.0,
    "BokehPassIndex": 0.0,
}

# Texture slots in the order of their bindings.
SLOTS = ("ColorSamp", "DepthSamp", "ColorSampB", "ColorSampC", "ColorSampD", "KernelSamp")
# Slots that the filter passes sample with a linear filter; all else is fetched texel by texel, and needs a nearest
# filter in Direct3D 9 only. So is the colour that the first pass copies.
LINEAR_SLOTS = ("ColorSamp", "ColorSampB", "ColorSampC", "ColorSampD")
COPYING_ENTRIES = ("BokehCoCMap", "BokehSignedCoCMap", "BokehConstantCoC")

# Set 0 in Vulkan and WebGPU: the parameters at binding 0, the textures, then the linear sampler.
FIRST_TEXTURE = 1
FIRST_SAMPLER = FIRST_TEXTURE + len(SLOTS)
# Slot -> sample type of its binding in WebGPU: what is only loaded need not be filterable.
SAMPLE_TYPES = {slot: "float" if slot in LINEAR_SLOTS else "unfilterable-float" for slot in SLOTS}


def is_linear(entry: str, slot: str) -> bool:
    """Whether a pass samples a slot with the linear filter."""
    return slot in LINEAR_SLOTS and entry not in COPYING_ENTRIES


@dataclass(frozen=True)
class Pass:
    """One full-screen pass.

    entry       one of shaders.ENTRIES
    inputs      slot -> name of a texture: one that was handed in, or the output of an earlier pass
    output      name of the texture it writes; a tuple of names where it writes several targets at once
    parameters  those that differ from PARAMETERS
    samples     BOKEH_NUM_SAMPLES
    sources     language ('glsl', 'hlsl', 'wgsl') -> a complete program of the harness in place of the package's; its
                entry is named as `entry` says, main in GLSL. OpenGL and WebGPU drivers only.
    viewport    (x, y, width, height) in texels, y from the first row in memory: the part of the targets that is drawn,
                over what an earlier pass has left in a target of that name; None: all of it, into new targets

    Raises ValueError where the entry writes another number of targets.
    """

    entry: str
    inputs: Mapping[str, str]
    output: str | tuple[str, ...]
    parameters: Mapping[str, float] = field(default_factory=dict)
    samples: int = 13
    sources: Mapping[str, str] | None = None
    viewport: tuple[int, int, int, int] | None = None

    def __post_init__(self):
        if self.sources is None and len(self.outputs) != shaders.targets(self.entry):
            raise ValueError(f"{self.entry} writes {shaders.targets(self.entry)} targets, not {self.outputs}")

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of all textures it writes, in the order of the targets."""
        return (self.output,) if isinstance(self.output, str) else self.output

    @property
    def constants(self) -> dict[str, int]:
        """What is fixed when its program is compiled; a fixed number of samples is told to the compiler."""
        values = self.values()
        adaptive = values["BokehSpacing"] > 0.0 or values["BokehJitter"] > 0.0
        return {
            "BOKEH_NUM_SAMPLES": self.samples,
            "BOKEH_ADAPTIVE_SAMPLES": int(adaptive),
            # to draw into a part of a target is one thing, to read a part of a texture another
            "BOKEH_VIEWPORT": int("BokehTextureWidth" in self.parameters),
        }

    def values(self) -> dict[str, float]:
        """All parameters, in layout order."""
        unknown = set(self.parameters) - set(PARAMETERS)
        if unknown:
            raise KeyError(f"no such parameter: {', '.join(sorted(unknown))}")
        return {**PARAMETERS, **self.parameters}

    def given(self) -> dict[str, float]:
        """`values` as a device gets them, in float32: depth in focus is exactly the focus distance there."""
        return {name: float(np.float32(value)) for name, value in self.values().items()}
