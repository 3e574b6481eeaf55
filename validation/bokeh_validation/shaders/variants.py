"""List the shader programs that are compiled, and the compilers that each goes through."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from bokeh_validation import shaders
from bokeh_validation.shaders import entries
from bokeh_validation.shaders.passes import PAPER_SAMPLES

VERTEX = "BokehFullScreen"

# Values of BOKEH_NUM_SAMPLES by the role of an entry; other roles and the layers do not depend on it.
SAMPLES: dict[str, tuple[int, ...]] = {
    # on a line: the minimum, and the paper's
    entries.LINE: (2, PAPER_SAMPLES),
    # and the maximum for a wide blur, where the number of samples follows the CoC
    entries.ADAPTIVE: (2, PAPER_SAMPLES, 64),
    **dict.fromkeys((entries.FIRST, entries.SECOND, entries.EDGE), (7, 33)),
    # offsets in the kernel: as above, the hexagon of the paper's Figure 4, more than a loop of shader model 3 can
    # count, and the largest of the paper's Table 1
    entries.TABLE: (2, PAPER_SAMPLES, 127, 256, 576),
    # along one side of the grid: 24 is the largest of Table 1, 576 samples
    entries.GRID: (2, PAPER_SAMPLES, 24),
}

# Switches: images inside larger textures; cat's eye and curved blades; focus controls of the CoC map; random offsets;
# a constant number of sides, here the maximum; half precision
SWITCHES = {
    "viewport": {"BOKEH_VIEWPORT": 1},
    "lens": {"BOKEH_LENS_SHAPE": 1},
    "focus": {"BOKEH_FOCUS_CONTROLS": 1},
    "jitter": {"BOKEH_JITTER": 1},
    "sides": {"BOKEH_SIDES": 10},
    "half": {"BOKEH_HALF_PRECISION": 1},
}
# A switch that is only compiled where it matters, because it makes programs larger -> the profile with the tight
# limits
ONLY_IN = {"jitter": "sm3"}
# A switch that affects few programs -> parts of their names
NOTICED_BY = {"sides": ("HoleFill", "Composite"), "half": ("Composite",)}
# A switch that some compilers do not know -> their names: Mesa's OpenGL has no 16-bit floats, and neither has
# Chromium's WebGPU on a software device
UNKNOWN_TO = {"half": ("mesa", "tint")}
# Entries that are compiled with the switches: one of each kind, and the longest programs of shader model 3
SWITCHED = (
    "CoCMap SignedCoCMap AdaptiveFinal NaiveGather OctagonFirst DecagonFirst DecagonSecond ExactEdge StableMap "
    "LateralColor TileDilateRows Prefilter HoleFill DecagonNearSecond Composite"
)
# Combinations that exceed shader model 3: a cat's eye fits only exact polygons with several targets, and a viewport
# does not fit the last pass of layered
NO_ROOM = {"lens": ("ExactEdge", "Layer", "Near", "Far", "HoleFill", "Composite"), "viewport": ("Composite",)}

# Language, profile, main compilers (those that users of the language have), other compilers.
VARIANTS = (
    # OpenGL 3.3
    ("glsl", "330", "glslang mesa", "spirv-val"),
    # OpenGL ES 3.0 and WebGL 2. glslang makes SPIR-V of the ES dialect from version 3.10 on only.
    ("glsl", "300es", "angle", "glslang mesa"),
    # Vulkan, and from there Apple's Metal; Mesa compiles it as OpenGL 4.5
    ("glsl", "450", "glslang", "spirv-val msl mesa"),
    # Direct3D 9: ps_3_0, vs_3_0. fxc does not enforce the limits of 512 slots, 224 constants, 16 samplers and 32
    # temporaries, so the harness does.
    ("hlsl", "sm3", "fxc", ""),
    # Direct3D 11: ps_5_0, vs_5_0, and through glslang to Vulkan and Metal
    ("hlsl", "sm5", "fxc", "glslang spirv-val msl"),
    # Direct3D 12, and Vulkan through DXC
    ("hlsl", "sm6", "dxc-spirv", "dxc-dxil spirv-val msl naga"),
    # Slang to each of its languages; its output is checked by Khronos's validator, glslang and wgpu
    ("hlsl", "slang", "slang-spirv slang-glsl slang-wgsl slang-metal naga", "spirv-val glslang"),
    # WebGPU; BOKEH_NUM_SAMPLES is a pipeline constant
    ("wgsl", "wgsl", "naga tint", ""),
)


@dataclass(frozen=True)
class Program:
    """Describe a shader in one configuration.

    variant    what it is compiled for, such as 'glsl-330' or 'wgsl-viewport'
    profile    such as '330', 'sm6' or 'slang'
    entry      an entry's name or VERTEX
    samples    BOKEH_NUM_SAMPLES; None: the default of the shader file
    compilers  names of registry.COMPILERS
    values     other configuration values of section [1], by their names in the file
    """

    variant: str
    language: str
    profile: str
    entry: str
    samples: int | None
    compilers: tuple[str, ...]
    values: Mapping[str, int] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Return a unique, readable name, such as 'glsl-330 BokehNaiveGather 127'."""
        return " ".join(filter(None, (self.variant, self.entry, str(self.samples or ""))))

    @property
    def stage(self) -> str:
        """Return 'vert' or 'frag'."""
        return "vert" if self.entry == VERTEX else "frag"

    @property
    def targets(self) -> int:
        """Return the number of render targets; for a vertex shader, of the fragment shader linked to it."""
        return 1 if self.entry == VERTEX else entries.ENTRIES[self.entry].targets

    @property
    def function(self) -> str:
        """Return the name of the entry point in HLSL and WGSL."""
        return self.entry + ("_VS" if self.entry == VERTEX else "_PS")

    @property
    def configuration(self) -> dict[str, int]:
        """Return the values that differ from the shader file's defaults; in WGSL they are pipeline constants."""
        if self.samples is None:
            return dict(self.values)
        counted = entries.ENTRIES[self.entry].role in entries.COUNTED
        return {"BOKEH_PAPER_SAMPLES" if counted else "BOKEH_NUM_SAMPLES": self.samples} | dict(self.values)

    @property
    def source(self) -> str:
        """Return the complete text; of the configuration, WGSL contains only half precision."""
        if self.language == "glsl":
            return shaders.glsl(self.entry, self.profile, self.configuration)
        if self.language == "hlsl":
            # Slang has to detect its shader model itself
            model = None if self.profile == "slang" else int(self.profile.removeprefix("sm"))
            return shaders.hlsl(model, self.configuration)
        return shaders.wgsl(self.values)


def load(quick: bool = False, main: bool = False) -> list[Program]:
    """Return all programs.

    quick  one sample count per entry, the paper's if it is listed, and no switches
    main   with the main compilers only
    """
    programs = []
    for language, profile, main_compilers, other_compilers in VARIANTS:
        variant = language if language == profile else f"{language}-{profile}"
        compilers = tuple((main_compilers if main else f"{main_compilers} {other_compilers}").split())
        for entry, count in _entries(quick):
            programs.append(Program(variant, language, profile, entry, count, compilers))
        for switch, values in () if quick else SWITCHES.items():
            if ONLY_IN.get(switch, profile) != profile:
                continue
            no_room = NO_ROOM.get(switch, ()) if profile == "sm3" else ()
            for entry in (entries.ENTRIES[f"Bokeh{name}"] for name in SWITCHED.split()):
                noticed = any(part in entry.name for part in NOTICED_BY.get(switch, ("",)))
                if noticed and not any(part in entry.name for part in no_room):
                    count, variant_name = None if entry.layers else 7, f"{variant}-{switch}"
                    knowing = tuple(name for name in compilers if name not in UNKNOWN_TO.get(switch, ()))
                    programs.append(Program(variant_name, language, profile, entry.name, count, knowing, values))
    return programs


def _entries(quick: bool) -> Iterator[tuple[str, int | None]]:
    """Yield each entry with its sample counts."""
    yield VERTEX, None
    for entry in entries.ENTRIES.values():
        counts = (None,) if entry.layers else SAMPLES.get(entry.role, (None,))
        if quick:
            counts = (PAPER_SAMPLES,) if PAPER_SAMPLES in counts else counts[:1]
        yield from ((entry.name, count) for count in counts)
