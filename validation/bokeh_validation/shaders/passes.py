"""Describe what a driver is asked to run: a list of passes over named textures."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from bokeh_validation.shaders.entries import COLORS, COUNTED, ENTRIES, TEXEL_ENTRIES, Entry
from bokeh_validation.shaders.parameters import PARAMETERS

# Texture slots in the order of their registers in HLSL.
SLOTS = (*COLORS[:1], "DepthSamp", *COLORS[1:4], "KernelSamp", *COLORS[4:])
# Bindings in set 0 of Vulkan and WebGPU: the parameters at 0, the linear sampler at 7, the textures at the others.
FIRST_SAMPLER = 7
BINDINGS = dict(zip(SLOTS, (1, 2, 3, 4, 5, 6, 8, 9), strict=True))
# Slot -> sample type of its binding in WebGPU; a texture that is only fetched texel by texel need not be filterable.
SAMPLE_TYPES = {slot: "float" if slot in COLORS else "unfilterable-float" for slot in SLOTS}
# BOKEH_SPACING by default: the preset MEDIUM's
USUAL_SPACING = 1.5
# Samples on a line in the paper: section 4.3
PAPER_SAMPLES = 13
# Allowed values of Pass.scale
SCALES = (1, 2, 4, 8)


def is_linear(entry: str, slot: str) -> bool:
    """Return whether a pass samples a slot with the linear filter, as filter passes do with their colours.

    Everything else is fetched texel by texel, and needs a nearest filter in Direct3D 9 only.
    """
    if entry == "BokehStableMap":
        # only its history is sampled between texels
        return slot == "ColorSampB"
    return slot in COLORS and entry not in TEXEL_ENTRIES


def target_size(scale: int, size: tuple[int, int]) -> tuple[int, int]:
    """Return (width, height) of a pass's targets; `size` is the full size as passed to run()."""
    return -(-size[0] // scale), -(-size[1] // scale)


def target_area(scale: int, viewport: tuple[int, int, int, int]) -> tuple[int, int, int, int]:
    """Return Pass.viewport in texels of the pass's targets: (x, y, width, height).

    Raises ValueError if it begins inside a texel.
    """
    x, y, width, height = viewport
    if x % scale or y % scale:
        raise ValueError(f"viewport {viewport} begins within a texel of targets of scale {scale}")
    return (x // scale, y // scale, *target_size(scale, (width, height)))


@dataclass(frozen=True)
class Pass:
    """Describe one full-screen pass.

    entry       one of entries.ENTRIES
    inputs      slot -> name of a texture: an input of the frame, or the output of an earlier pass
    output      name of the texture that it writes; a tuple of names for several targets
    parameters  values that differ from PARAMETERS
    samples     BOKEH_NUM_SAMPLES, or BOKEH_PAPER_SAMPLES
    defines     other constants of the program, name -> value
    sources     language ('glsl', 'hlsl', 'wgsl') -> a complete program to run instead of the package's; its entry is
                named as `entry` says, main in GLSL. OpenGL and WebGPU drivers only.
    viewport    part of the targets that is drawn, (x, y, width, height) in texels of the full size, y from the first
                row in memory; the rest keeps what an earlier pass wrote. None: the whole of new targets. x and y are
                multiples of `scale`; see target_area()
    scale       one of SCALES: the targets have the full size divided by it, rounded up; see target_size()

    Raises ValueError if the entry writes another number of targets or does not read a slot, and for other scales.
    """

    entry: str
    inputs: Mapping[str, str]
    output: str | tuple[str, ...]
    parameters: Mapping[str, float] = field(default_factory=dict)
    samples: int = PAPER_SAMPLES
    defines: Mapping[str, float] = field(default_factory=dict)
    sources: Mapping[str, str] | None = None
    viewport: tuple[int, int, int, int] | None = None
    scale: int = 1

    def __post_init__(self):
        if self.scale not in SCALES:
            raise ValueError(f"{self.entry}: scale is one of {', '.join(map(str, SCALES))}, not {self.scale}")
        if self.sources is None and len(self.outputs) != self.spec.targets:
            raise ValueError(f"{self.entry} writes {self.spec.targets} targets, not {self.outputs}")
        if unread := set(self.inputs) - set(SLOTS if self.sources else self.spec.textures):
            raise ValueError(f"{self.entry} does not read {', '.join(sorted(unread))}")

    @property
    def spec(self) -> Entry:
        """Return the description of its entry."""
        return ENTRIES[self.entry]

    @property
    def outputs(self) -> tuple[str, ...]:
        """Return the names of all textures that it writes, in the order of the targets."""
        return (self.output,) if isinstance(self.output, str) else self.output

    @property
    def counted(self) -> bool:
        """Return whether the number of samples is fixed at compile time; False for entries that are not
        the package's.
        """
        return self.entry in ENTRIES and self.spec.role in COUNTED

    @property
    def constants(self) -> dict[str, float]:
        """Return the constants that its program is compiled with; without a spacing, the number of samples is fixed."""
        return {
            "BOKEH_PAPER_SAMPLES" if self.counted else "BOKEH_NUM_SAMPLES": self.samples,
            "BOKEH_SPACING": USUAL_SPACING if self.values()["BokehSpacing"] > 0.0 else 0.0,
            # for images inside larger textures; drawing into a part of a target needs no constant
            "BOKEH_VIEWPORT": int("BokehTextureWidth" in self.parameters),
            "BOKEH_JITTER": int(self.values()["BokehJitter"] != 0.0),
            "BOKEH_LENS_SHAPE": int("BokehCatsEye" in self.parameters),
            "BOKEH_FOCUS_CONTROLS": int("BokehNearScale" in self.parameters),
            **self.defines,
        }

    @property
    def spacing(self) -> float:
        """Return the pixels between samples, 0 for a fixed number of samples: the parameter, or the constant if that
        is 0.
        """
        constant = self.constants["BOKEH_SPACING"]
        return constant and (self.given()["BokehSpacing"] or constant)

    def values(self) -> dict[str, float]:
        """Return all parameters in the order of the block. Raises KeyError for unknown names."""
        if unknown := set(self.parameters) - set(PARAMETERS):
            raise KeyError(f"no such parameter: {', '.join(sorted(unknown))}")
        return {**PARAMETERS, **self.parameters}

    def given(self) -> dict[str, float]:
        """Return `values` rounded to float32, as a device receives them: depth in focus then equals the focus
        distance.
        """
        return {name: float(np.float32(value)) for name, value in self.values().items()}
