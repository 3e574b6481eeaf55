"""The shader programs that are compiled, and the compilers that each goes through."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from bokeh_validation import shaders
from bokeh_validation.shaders import entries
from bokeh_validation.shaders.passes import PAPER_SAMPLES

VERTEX = "BokehFullScreen"

# Values of BOKEH_NUM_SAMPLES by the role of an entry; others, and those of the layers, do not depend on it.
SAMPLES: dict[str, tuple[int, ...]] = {
    # on a line: the fewest, and the paper's
    entries.LINE: (2, PAPER_SAMPLES),
    # and the most that a wide blur takes, with counts that follow the blur
    entries.ADAPTIVE: (2, PAPER_SAMPLES, 64),
    **dict.fromkeys((entries.FIRST, entries.SECOND, entries.EDGE), (7, 33)),
    # offsets in the kernel: as above, the hexagon of the paper's Figure 4, more than shader model 3 counts to, and the
    # largest of the paper's Table 1
    entries.TABLE: (2, PAPER_SAMPLES, 127, 256, 576),
    # along a side of the grid: 24 is the largest of Table 1, 576 samples
    entries.GRID: (2, PAPER_SAMPLES, 24),
}

# Switches: images that are a part of their textures; a cat's eye and curved blades; what the CoC map can do; noise;
# polygons of as many sides as there are
SWITCHES = {
    "viewport": {"BOKEH_VIEWPORT": 1},
    "lens": {"BOKEH_LENS_SHAPE": 1},
    "focus": {"BOKEH_FOCUS_CONTROLS": 1},
    "jitter": {"BOKEH_JITTER": 1},
    "sides": {"BOKEH_SIDES": 10},
}
# A switch that matters for the room of a program alone -> where room is short
ONLY_IN = {"jitter": "sm3"}
# A switch that few programs notice -> what is in their names
NOTICED_BY = {"sides": ("HoleFill", "Composite")}
# The entries that are compiled with them: one of each kind, and the longest programs of shader model 3
SWITCHED = (
    "CoCMap SignedCoCMap AdaptiveFinal NaiveGather OctagonFirst DecagonFirst DecagonSecond ExactEdge StableMap "
    "LateralColor TileDilate Prefilter HoleFill DecagonLayerSecond Composite"
)
# In shader model 3 only exact polygons with several targets have room for a cat's eye, and the last pass of layered
# none for a viewport
NO_ROOM = {"lens": ("ExactEdge", "Layer", "HoleFill", "Composite"), "viewport": ("Composite",)}

# Language, profile, main compilers, the others. The main ones are those that users of the language have.
VARIANTS = (
    # OpenGL 3.3
    ("glsl", "330", "glslang mesa", "spirv-val"),
    # OpenGL ES 3.0, WebGL 2. The ES dialect has no SPIR-V below 3.10.
    ("glsl", "300es", "angle", "glslang mesa"),
    # Vulkan, and from there to Apple's Metal; mesa compiles it as OpenGL 4.5
    ("glsl", "450", "glslang", "spirv-val msl mesa"),
    # Direct3D 9: ps_3_0, vs_3_0. fxc does not enforce its 512 slots, 224 constants, 16 samplers, 32 temporaries: we do.
    ("hlsl", "sm3", "fxc", ""),
    # Direct3D 11: ps_5_0, vs_5_0, and by way of glslang to Vulkan and Metal
    ("hlsl", "sm5", "fxc", "glslang spirv-val msl"),
    # Direct3D 12, and Vulkan by way of DXC
    ("hlsl", "sm6", "dxc-spirv", "dxc-dxil spirv-val msl naga"),
    # Slang, to each of its languages; what Khronos and wgpu say of what comes out
    ("hlsl", "slang", "slang-spirv slang-glsl slang-wgsl slang-metal naga", "spirv-val glslang"),
    # WebGPU; BOKEH_NUM_SAMPLES is a pipeline constant
    ("wgsl", "wgsl", "naga tint", ""),
)


@dataclass(frozen=True)
class Program:
    """A shader in one configuration.

    variant    such as 'glsl-330' or 'wgsl-viewport': what it is compiled for
    profile    such as '330', 'sm6' or 'slang'
    entry      an entry's name or VERTEX
    samples    BOKEH_NUM_SAMPLES, or None for the default of the shader file
    compilers  those it goes through, of registry.COMPILERS
    values     other configuration values of section [1], as they are written in the file
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
        """Unique and readable, such as 'glsl-330 BokehNaiveGather 127'."""
        return " ".join(filter(None, (self.variant, self.entry, str(self.samples or ""))))

    @property
    def stage(self) -> str:
        """'vert' or 'frag'."""
        return "vert" if self.entry == VERTEX else "frag"

    @property
    def targets(self) -> int:
        """How many render targets it writes; of a vertex shader, what it is linked with does."""
        return 1 if self.entry == VERTEX else entries.ENTRIES[self.entry].targets

    @property
    def function(self) -> str:
        """Name of the entry point in HLSL and WGSL."""
        return self.entry + ("_VS" if self.entry == VERTEX else "_PS")

    @property
    def configuration(self) -> dict[str, int]:
        """What is not left at the default of the shader file: in WGSL, the pipeline constants."""
        if self.samples is None:
            return dict(self.values)
        counted = entries.ENTRIES[self.entry].role in entries.COUNTED
        return {"BOKEH_PAPER_SAMPLES" if counted else "BOKEH_NUM_SAMPLES": self.samples} | dict(self.values)

    @property
    def source(self) -> str:
        """The complete text. In WGSL the configuration is not in it."""
        if self.language == "glsl":
            return shaders.glsl(self.entry, self.profile, self.configuration)
        if self.language == "hlsl":
            # Slang is to find out its shader model itself
            model = None if self.profile == "slang" else int(self.profile.removeprefix("sm"))
            return shaders.hlsl(model, self.configuration)
        return shaders.wgsl()


def load(quick: bool = False, main: bool = False) -> list[Program]:
    """All programs.

    quick  one sample count for each entry, the paper's where there is one, and no switches
    main   through the main compilers only
    """
    programs = []
    for language, profile, main_compilers, others in VARIANTS:
        variant = language if language == profile else f"{language}-{profile}"
        compilers = tuple((main_compilers if main else f"{main_compilers} {others}").split())
        for entry, count in _entries(quick):
            programs.append(Program(variant, language, profile, entry, count, compilers))
        for switch, values in () if quick else SWITCHES.items():
            if ONLY_IN.get(switch, profile) != profile:
                continue
            no_room = NO_ROOM.get(switch, ()) if profile == "sm3" else ()
            for entry in (entries.ENTRIES[f"Bokeh{name}"] for name in SWITCHED.split()):
                noticed = any(part in entry.name for part in NOTICED_BY.get(switch, ("",)))
                if noticed and not any(part in entry.name for part in no_room):
                    count, named = None if entry.layers else 7, f"{variant}-{switch}"
                    programs.append(Program(named, language, profile, entry.name, count, compilers, values))
    return programs


def _entries(quick: bool) -> Iterator[tuple[str, int | None]]:
    """Each entry with its sample counts."""
    yield VERTEX, None
    for entry in entries.ENTRIES.values():
        counts = (None,) if entry.layers else SAMPLES.get(entry.role, (None,))
        if quick:
            counts = (PAPER_SAMPLES,) if PAPER_SAMPLES in counts else counts[:1]
        yield from ((entry.name, count) for count in counts)
