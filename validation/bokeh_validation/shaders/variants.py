"""Which shader programs there are, and which compilers each goes through."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from bokeh_validation import shaders
from bokeh_validation.shaders import entries

VERTEX = "BokehFullScreen"
ENTRIES = (VERTEX, *entries.ENTRIES)

PAPER_SAMPLES = 13  # on a line, section 4.3

# Values of BOKEH_NUM_SAMPLES by the role of an entry; others, and those of the layers, do not depend on it.
SAMPLES: dict[str, tuple[int, ...]] = {
    # on a line: the fewest, and the paper's
    entries.LINE: (2, PAPER_SAMPLES),
    # and the most that a wide blur takes, with counts that follow the blur
    entries.ADAPTIVE: (2, PAPER_SAMPLES, 64),
    **dict.fromkeys((entries.FIRST, entries.SECOND, entries.EDGE), (7,)),
    # offsets in the kernel: as above, the hexagon of the paper's Figure 4, and the largest of its Table 1
    entries.TABLE: (2, 13, 127, 576),
    # along a side of the grid: 24 is the largest of Table 1, 576 samples
    entries.GRID: (2, 13, 24),
}
# Shader model 3, where the count may decide whether a loop is unrolled: all of Table 1 beside the usual ones
SAMPLES_SM3 = SAMPLES | {
    **dict.fromkeys((entries.FIRST, entries.SECOND, entries.EDGE), (7, 2, 33)),
    entries.TABLE: (2, 13, 16, 64, 127, 144, 256, 400, 576),
    entries.GRID: (2, 4, 8, 12, 13, 16, 20, 24),
}
# For images that are a part of their textures, one of each kind: the longest program of shader model 3 among them
_FILTERS = "LinearDepth CoCMap DepthOfFieldFinal AdaptiveFinal NaiveGather HexagonFirst DecagonFirst DecagonSecond"
_FILTERS += " LateralColor"
_OF_LAYERS = "LayerReach LayerSplit LayerFill DecagonLayerSecond Layered"
VIEWPORT = {f"Bokeh{name}": (7,) for name in _FILTERS.split()} | {f"Bokeh{n}": (None,) for n in _OF_LAYERS.split()}
# With the character of a lens, one of each kind; in shader model 3 only exact polygons with several targets have room
_CUT = "SquareSecond HexagonFirst OctagonFirst OctagonSecond DecagonFirst DecagonSecond"
_CUT_LAYERS = "LayerFill DecagonLayerFirst DecagonLayerSecond LayerEdge Layered"
CHARACTER = {f"Bokeh{name}": (7,) for name in _CUT.split()}
_AXIAL = "HexagonFirst HexagonSecond OctagonSecond DecagonFirst DecagonSecond ExactEdge"
CHARACTER_LAYERS = {"BokehExactEdge": (7,)} | {f"Bokeh{name}": (None,) for name in _CUT_LAYERS.split()}

# Language, profile, compilers of the programs as they are, compilers of those with BOKEH_VIEWPORT or BOKEH_CHARACTER
VARIANTS = (
    # OpenGL 3.3
    ("glsl", "330", "glslang spirv-val mesa", "glslang spirv-val mesa"),
    # OpenGL ES 3.0, WebGL 2. The ES dialect has no SPIR-V below 3.10.
    ("glsl", "300es", "glslang mesa angle", "glslang mesa angle"),
    # Vulkan, and from there to where Vulkan is not; mesa compiles it as OpenGL 4.5
    (
        "glsl", "450", "glslang glslc spirv-val essl300 essl310 msl hlsl50 mesa",
        "glslang glslc spirv-val essl300 msl hlsl50",
    ),
    # Direct3D 9: ps_3_0, vs_3_0. fxc does not enforce its 512 slots, 224 constants, 16 samplers, 32 temporaries: we do.
    ("hlsl", "sm3", "fxc mojoshader", "fxc mojoshader"),
    # Direct3D 10: ps_4_0, vs_4_0
    ("hlsl", "sm4", "fxc", ""),
    # Direct3D 11: ps_5_0, vs_5_0, and by way of glslang to where Direct3D is not
    ("hlsl", "sm5", "fxc glslang spirv-val essl300 essl310 msl", "fxc glslang spirv-val"),
    # Direct3D 12, and Vulkan by way of DXC
    ("hlsl", "sm6", "dxc-spirv dxc-dxil spirv-val essl300 essl310 msl naga", "dxc-spirv dxc-dxil spirv-val naga"),
    # WebGPU; BOKEH_NUM_SAMPLES is a pipeline constant
    ("wgsl", "wgsl", "naga tint", "naga tint"),
)  # fmt: skip


@dataclass(frozen=True)
class Program:
    """A shader in one configuration.

    variant    such as 'glsl-330' or 'wgsl-viewport': what it is compiled for
    language   'hlsl', 'glsl' or 'wgsl'
    profile    such as '330' or 'sm6'
    entry      one of ENTRIES
    samples    BOKEH_NUM_SAMPLES, or None for the default of the shader file
    compilers  those it goes through, of registry.COMPILERS
    values     other configuration values of section [1], as they are written in the file
    cells      what each compiler said of it (registry.Cell), once they were asked
    """

    variant: str
    language: str
    profile: str
    entry: str
    samples: int | None
    compilers: tuple[str, ...]
    values: Mapping[str, int] = field(default_factory=dict)
    cells: Mapping[str, object] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Unique in the matrix and readable, such as 'glsl-330 BokehNaiveGather 127'."""
        return " ".join(filter(None, (self.variant, self.entry, str(self.samples or ""))))

    @property
    def stage(self) -> str:
        """'vert' or 'frag'."""
        return "vert" if self.entry == VERTEX else "frag"

    @property
    def targets(self) -> int:
        """How many render targets it writes; of a vertex shader, what it is linked with does."""
        return entries.ENTRIES[self.entry].targets if self.entry in entries.ENTRIES else 1

    @property
    def function(self) -> str:
        """Name of the entry point in HLSL and WGSL."""
        return self.entry + ("_VS" if self.entry == VERTEX else "_PS")

    @property
    def shader_model(self) -> int:
        """Of HLSL, 3 to 6."""
        return int(self.profile.removeprefix("sm"))

    @property
    def configuration(self) -> dict[str, int]:
        """What is not left at the default of the shader file: in WGSL, the pipeline constants."""
        return ({} if self.samples is None else {"BOKEH_NUM_SAMPLES": self.samples}) | dict(self.values)

    @property
    def source(self) -> str:
        """The complete text. In WGSL the configuration is not in it."""
        if self.language == "glsl":
            return shaders.glsl(self.entry, self.profile, self.configuration)
        if self.language == "hlsl":
            return shaders.hlsl(self.shader_model, self.configuration)
        return shaders.wgsl()


def load(quick: bool = False) -> list[Program]:
    """All programs; `quick`: one sample count for each entry, the paper's where there is one."""
    found = []
    for language, profile, usual, viewport in VARIANTS:
        name = language if language == profile else f"{language}-{profile}"
        counts = SAMPLES_SM3 if profile == "sm3" else SAMPLES
        axial = {} if profile == "sm3" else dict.fromkeys((f"Bokeh{one}" for one in _AXIAL.split()), (7,))
        whole = {VERTEX: (None,)}
        cut = CHARACTER if profile == "sm3" else CHARACTER | CHARACTER_LAYERS
        for entry in entries.ENTRIES.values():
            whole[entry.name] = counts.get("" if entry.layers else entry.role, (None,))
        for variant, chosen, compilers, values in (
            (name, whole, usual, {}),
            (f"{name}-viewport", VIEWPORT, viewport, {"BOKEH_VIEWPORT": 1}),
            (f"{name}-character", cut, viewport, {"BOKEH_CHARACTER": 1}),
            (f"{name}-axial", axial, viewport, {"BOKEH_CHARACTER": 2}),
        ):
            for entry, samples in chosen.items() if compilers else ():
                if quick:
                    samples = (PAPER_SAMPLES,) if PAPER_SAMPLES in samples else samples[:1]
                known = tuple(compilers.split())
                found += [Program(variant, language, profile, entry, count, known, values) for count in samples]
    return found
