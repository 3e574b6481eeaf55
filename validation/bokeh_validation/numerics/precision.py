"""How far correct devices may be from the formula: the numbers, and where they come from.

The acceptance interval of a pixel is computed beside its value, operation by operation (intervals.py). What is more
than float32's roundings is where a texture is read, and what sin and cos give:

  * Sub-texel position. Direct3D 11 and Vulkan ask for 8 bits of sub-texel precision, so a place may be off by 1/256 of
    a texel (1/512 where it is rounded); software filters in float32 have no such step.
  * Vulkan and WebGPU let sin and cos be off by 2^-11. (SwiftShader's are off by 0.0002, Mesa's by less than a float32
    rounding.)

Storing adds one step of the target's format: both neighbours of a value are valid roundings, and OpenGL and Vulkan do
not say which is taken (Mesa's OpenGL cuts off, its Vulkan rounds to nearest).
"""

from dataclasses import dataclass

COORDINATE_ULPS = 8
FLOAT_STEP = 2.0**-24


@dataclass(frozen=True)
class Precision:
    """Filter precision of a class of devices.

    subtexel  error of a sample's place from fixed-point coordinates, texels
    filter    rounding of the filter's blend, relative to the largest texel it blends
    line      error of sin and cos
    """

    subtexel: float
    filter: float
    line: float

    def place(self, length: int) -> float:
        """Error of a sample's place along an axis of `length` texels, in texels."""
        return self.subtexel + length * COORDINATE_ULPS * FLOAT_STEP


# 8 bits of sub-texel position; blend in the precision of a half float, the least that a half-float texture needs.
GPU = Precision(subtexel=2.0**-8, filter=2.0**-11, line=2.0**-11)
# Mesa's software texture unit filters float formats in float32.
SOFTWARE = Precision(subtexel=0.0, filter=4 * FLOAT_STEP, line=4 * FLOAT_STEP)
# Chromium's software device filters float formats in float32 too, but its sin and cos are those of a GPU.
SWIFTSHADER = Precision(subtexel=0.0, filter=4 * FLOAT_STEP, line=2.0**-11)
