"""Complete programs out of the package's files, the way a user makes them: by concatenation."""

import re
from collections.abc import Mapping
from functools import cache

from bokeh_validation import paths

# Entry points by their stem: HLSL and WGSL add _PS, GLSL has one main() chosen by BOKEH_PASS.
ENTRIES = (
    "BokehLinearDepth",
    "BokehCoCMap",
    "BokehSignedCoCMap",
    "BokehConstantCoC",
    "BokehDepthOfField",
    "BokehDepthOfFieldFinal",
    "BokehAdaptive",
    "BokehAdaptiveFinal",
    "BokehNaiveGather",
    "BokehNaiveGrid",
    "BokehSquareFirst",
    "BokehSquareSecond",
    "BokehHexagonFirst",
    "BokehHexagonSecond",
    "BokehOctagonFirst",
    "BokehOctagonSecond",
    "BokehDecagonFirst",
    "BokehDecagonSecond",
    "BokehExactEdge",
    "BokehDebug",
    "BokehLayerTiles",
    "BokehLayerReach",
    "BokehLayerSplit",
    "BokehLayerKernels",
    "BokehLayerSpread",
    "BokehLayerSizes",
    "BokehLayerHoles",
    "BokehLayerFill",
    "BokehSquareLayerFirst",
    "BokehSquareLayerSecond",
    "BokehHexagonLayerFirst",
    "BokehHexagonLayerSecond",
    "BokehOctagonLayerFirst",
    "BokehOctagonLayerSecond",
    "BokehDecagonLayerFirst",
    "BokehDecagonLayerSecond",
    "BokehLayered",
    "BokehLayerSplitOne",
    "BokehLayerKernelsOne",
    "BokehLayerSpreadOne",
    "BokehLayerSizesOne",
    "BokehLayerHolesOne",
    "BokehLayerFillOne",
    "BokehLayerEdge",
)
# Render targets of the entries that write more than one
_TARGETS = {
    "BokehHexagonFirst": 2,
    "BokehOctagonFirst": 3,
    "BokehDecagonFirst": 4,
    "BokehHexagonLayerFirst": 2,
    "BokehOctagonLayerFirst": 3,
    "BokehDecagonLayerFirst": 4,
    "BokehLayerSplit": 4,
    "BokehLayerKernels": 2,
    "BokehLayerSpread": 2,
    "BokehLayerSizes": 2,
    "BokehLayerHoles": 3,
    "BokehLayerFill": 2,
}

# Shader text in pieces, any language: heads of functions begin in the first column, the braces of a body have lines of
# their own, sections have a heading between two rules.
COMMENT = re.compile(r"//[^\n]*")
FUNCTION = re.compile(
    r"^(?P<doc>(?://[^\n]*\n)*)(?P<head>(?:@\w+ )?\w+ (?P<name>\w+)\([^{};]*)\n(?P<body>\{\n.*?^\})$",
    re.MULTILINE | re.DOTALL,
)
_HEADING = re.compile(r"^// -+\n// \[(\d+)\] .+\n// -+\n", re.MULTILINE)

# GLSL kinds: profile -> version line
GLSL_VERSIONS = {"330": "#version 330", "300es": "#version 300 es", "450": "#version 450"}


def targets(entry: str) -> int:
    """How many render targets an entry writes."""
    return _TARGETS.get(entry, 1)


def glsl_pass(entry: str) -> str:
    """Name of BOKEH_PASS for an entry: BokehDepthOfField -> BOKEH_DEPTH_OF_FIELD."""
    if entry == "BokehFullScreen":
        return "BOKEH_FULL_SCREEN"
    words = entry.removeprefix("Bokeh").replace("CoC", "Coc")
    return "BOKEH" + re.sub(r"([A-Z])", r"_\1", words).upper()


@cache
def text(language: str) -> str:
    """Library, layers and passes of a language, in that order."""
    files = (paths.library(language), paths.layers(language), paths.passes(language))
    return "".join(file.read_text(encoding="ascii") for file in files)


def sections(source: str) -> dict[int, str]:
    """Number -> text of the numbered sections of a library or of the layers."""
    parts = _HEADING.split(source)
    return {int(number): part for number, part in zip(parts[1::2], parts[2::2], strict=True)}


def defines(values: Mapping[str, object]) -> str:
    """`#define` lines for HLSL and GLSL."""
    return "".join(f"#define {name} {value}\n" for name, value in values.items())


def glsl(entry: str, profile: str = "330", values: Mapping[str, object] | None = None) -> str:
    """A complete GLSL shader: `entry` is one of ENTRIES or BokehFullScreen, `profile` one of GLSL_VERSIONS."""
    head = GLSL_VERSIONS[profile] + "\n" + defines({"BOKEH_PASS": glsl_pass(entry), **(values or {})})
    return head + text("glsl")


def hlsl(shader_model: int, values: Mapping[str, object] | None = None) -> str:
    """A complete HLSL file with every entry point, for shader model 3 to 6."""
    return defines({"BOKEH_HLSL_SM": shader_model, **(values or {})}) + text("hlsl")


def wgsl() -> str:
    """A complete WGSL module with every entry point; the sample count is a pipeline constant."""
    return text("wgsl")
