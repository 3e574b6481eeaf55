"""How far a correct device may be from the formula: the numbers, and where they come from.

The acceptance interval of a pixel is computed beside its value, pass by pass: gather.gather for paper and exact, as
follows; interpreter.py and intervals.py for layered. With

    e      error of a stored texel of the pass before (0 for what was uploaded)
    g      largest difference between neighbouring texels around a sample (per axis)
    d      how far off, in texels, a sample may be taken
    N      samples

one filtered sample is wrong by at most b = max(e) + d_x g_x + d_y g_y + r m: a shifted bilinear lookup cannot change by
more than the shift times the steepest slope around it, and the filter itself rounds by r of the largest texel m.
d is the sum of four parts:

  * sub-texel position. Direct3D 11 and Vulkan ask for 8 bits of sub-texel precision, so a place may be off by 1/256 of
    a texel (1/512 where it is rounded); software filters in float32 have no such step.
  * float32 arithmetic on uv: COORDINATE_ULPS roundings of 2^-24 at uv <= 1, times the width in texels.
  * the sample's distance, |offset| * size, times the error of the centre's stored CoC.
  * the direction of the line: Vulkan and WebGPU let sin and cos be off by 2^-11, so the end of a line, half a CoC away,
    by 2^-12 CoC; a grid has two lines. (SwiftShader's are off by 0.0002, Mesa's by less than a float32 rounding.)

The centre pixel is read through the same filter, so its colour and its CoC are off by b too.

The weighted mean M = sum(w s) / sum(w) of N samples then satisfies, with w' = w + dw and s' = s + ds,

    M' - M = [ sum(w' ds) + sum(dw (s - M)) ] / sum(w')
    |M' - M| <= [ sum((w + |dw|) b) + sum(|dw| (|s - c| + |c - M|)) ] / (sum(w) - sum(|dw|))        c: the centre pixel

and (N + 8) 2^-24 of the largest sample for the sums in float32. dw comes from Listing 3's thresholds: where the errors
of the two CoC and of the place of the depth fetch leave a comparison open, w ranges over both outcomes, and the pixel
is 'undecided'. Storing adds one step of the target's format: both neighbours of a value are valid roundings, and OpenGL
and Vulkan do not say which is taken (Mesa's OpenGL cuts off, its Vulkan rounds to nearest).
"""

from dataclasses import dataclass

COORDINATE_ULPS = 8
FLOAT_STEP = 2.0**-24


@dataclass(frozen=True)
class Precision:
    """Filter precision of a class of devices.

    subtexel  error of a sample's place from fixed-point coordinates, texels
    filter    rounding of the filter's blend, relative to the largest texel it blends
    line      error of a sample's place from sin and cos, in units of the CoC
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
