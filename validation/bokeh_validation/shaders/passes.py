"""What a driver is asked to run: a list of passes over named textures."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from bokeh_validation.shaders.entries import COLORS, COPYING_ENTRIES, COUNTED, ENTRIES, Entry
from bokeh_validation.shaders.parameters import PARAMETERS

# Texture slots in the order of their bindings.
SLOTS = (*COLORS[:1], "DepthSamp", *COLORS[1:4], "KernelSamp", *COLORS[4:])
# Set 0 in Vulkan and WebGPU: the parameters at binding 0, the linear sampler, the textures at what is left.
FIRST_SAMPLER = 7
BINDINGS = dict(zip(SLOTS, (1, 2, 3, 4, 5, 6, 8, 9), strict=True))
# Slot -> sample type of its binding in WebGPU: what is only loaded need not be filterable.
SAMPLE_TYPES = {slot: "float" if slot in COLORS else "unfilterable-float" for slot in SLOTS}
# BOKEH_SPACING where nobody says: that of the preset MEDIUM
USUAL_SPACING = 1.5
# On a line of the paper: section 4.3
PAPER_SAMPLES = 13
# What Pass.scale may be
SCALES = (1, 2, 4, 8)


def is_linear(entry: str, slot: str) -> bool:
    """Whether a pass samples a slot with the linear filter, as filter passes do with their colours.

    All else is fetched texel by texel, and needs a nearest filter in Direct3D 9 only.
    """
    if entry == "BokehStableMap":
        # only its history is between texels
        return slot == "ColorSampB"
    return slot in COLORS and entry not in COPYING_ENTRIES


def target_size(scale: int, size: tuple[int, int]) -> tuple[int, int]:
    """(width, height) of a pass's targets; `size` is the full one, that run() is told."""
    return -(-size[0] // scale), -(-size[1] // scale)


def target_area(scale: int, viewport: tuple[int, int, int, int]) -> tuple[int, int, int, int]:
    """Pass.viewport in texels of the pass's targets: (x, y, width, height).

    Raises ValueError where it begins within a texel.
    """
    x, y, width, height = viewport
    if x % scale or y % scale:
        raise ValueError(f"viewport {viewport} begins within a texel of targets of scale {scale}")
    return (x // scale, y // scale, *target_size(scale, (width, height)))


@dataclass(frozen=True)
class Pass:
    """One full-screen pass.

    entry       one of entries.ENTRIES
    inputs      slot -> name of a texture: one that was handed in, or the output of an earlier pass
    output      name of the texture it writes; a tuple of names where it writes several targets at once
    parameters  those that differ from PARAMETERS
    samples     BOKEH_NUM_SAMPLES, or BOKEH_PAPER_SAMPLES
    defines     other constants of the program, name -> value
    sources     language ('glsl', 'hlsl', 'wgsl') -> a complete program of the harness in place of the package's; its
                entry is named as `entry` says, main in GLSL. OpenGL and WebGPU drivers only.
    viewport    (x, y, width, height) in texels of the full size, y from the first row in memory: the part of the
                targets that is drawn, over what an earlier pass has left in a target of that name; None: all of it,
                into new targets. x and y are multiples of `scale`; see target_area()
    scale       one of SCALES: the targets have the full size divided by it, rounded up; see target_size()

    Raises ValueError where the entry writes another number of targets or does not read a slot, and for other scales.
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
        """What its entry is."""
        return ENTRIES[self.entry]

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of all textures it writes, in the order of the targets."""
        return (self.output,) if isinstance(self.output, str) else self.output

    @property
    def counted(self) -> bool:
        """Whether it always takes as many samples as it is compiled for; what is not the package's is not looked up."""
        return self.entry in ENTRIES and self.spec.role in COUNTED

    @property
    def constants(self) -> dict[str, float]:
        """What is fixed when its program is compiled; without a spacing, samples are of a fixed number."""
        return {
            "BOKEH_PAPER_SAMPLES" if self.counted else "BOKEH_NUM_SAMPLES": self.samples,
            "BOKEH_SPACING": USUAL_SPACING if self.values()["BokehSpacing"] > 0.0 else 0.0,
            # to draw into a part of a target is one thing, to read a part of a texture another
            "BOKEH_VIEWPORT": int("BokehTextureWidth" in self.parameters),
            "BOKEH_JITTER": int(self.values()["BokehJitter"] != 0.0),
            "BOKEH_LENS_SHAPE": int("BokehCatsEye" in self.parameters),
            "BOKEH_FOCUS_CONTROLS": int("BokehNearScale" in self.parameters),
            **self.defines,
        }

    @property
    def spacing(self) -> float:
        """Pixels between samples, 0 for a fixed number of them: the parameter, or the constant where it is 0."""
        constant = self.constants["BOKEH_SPACING"]
        return constant and (self.given()["BokehSpacing"] or constant)

    def values(self) -> dict[str, float]:
        """All parameters, in layout order."""
        if unknown := set(self.parameters) - set(PARAMETERS):
            raise KeyError(f"no such parameter: {', '.join(sorted(unknown))}")
        return {**PARAMETERS, **self.parameters}

    def given(self) -> dict[str, float]:
        """`values` as a device gets them, in float32: depth in focus is exactly the focus distance there."""
        return {name: float(np.float32(value)) for name, value in self.values().items()}
