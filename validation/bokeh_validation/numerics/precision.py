"""Define how far correct devices may be from the formula, with the sources of the numbers.

The allowed interval of a pixel is computed along with its value, operation by operation (intervals.py). Only texture
reads are less exact than float32's roundings: Direct3D 11 and Vulkan require 8 bits of sub-texel precision, so a
position may be off by 1/256 of a texel (1/512 if it is rounded). Software filters in float32 have no such step.

Storing adds one step of the target's format: both neighbours of a value are valid roundings, and OpenGL and Vulkan do
not say which one is used (Mesa's OpenGL truncates, its Vulkan rounds to nearest).
"""

from dataclasses import dataclass

# Constants of `layered` that HLSL's shader model 3 fixes
SHADER_MODEL_3 = (("BOKEH_LAYER_OUTLINES", 0),)
COORDINATE_ULPS = 8
FLOAT_STEP = 2.0**-24
# Error of BokehSines for angles up to a turn: three roundings of a value of up to 1.25 turns, times 2 pi, and less than
# a tenth more from the polynomial (test_reference.test_sines). The sin and cos of shader model 3 are as exact.
SINE = 0.000001


@dataclass(frozen=True)
class Precision:
    """Hold how a class of devices computes.

    subtexel  error of a sample's position from fixed-point coordinates, texels
    filter    rounding of the filter's blend, relative to the largest texel that it blends
    constants names and values of constants of `layered` that the language fixes, whatever a pass defines
    """

    subtexel: float
    filter: float
    constants: tuple[tuple[str, int], ...] = ()

    def place(self, length: int) -> float:
        """Return the error of a sample's position along an axis of `length` texels, in texels."""
        return self.subtexel + length * COORDINATE_ULPS * FLOAT_STEP


# 8 bits of sub-texel position; blending in half-float precision, the minimum for a half-float texture.
GPU = Precision(subtexel=2.0**-8, filter=2.0**-11)
# Mesa and SwiftShader, Chromium's software device, filter float formats in float32.
SOFTWARE = Precision(subtexel=0.0, filter=4 * FLOAT_STEP)
