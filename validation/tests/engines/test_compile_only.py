"""The Unity and Unreal samples, which cannot run here: compiled against the stand-ins of validation/stubs.

Nothing is run, and a stand-in that is wrong is not found. What two languages of a sample must agree on, names and
order, no compiler sees; that is compared here.
"""

import json
import re
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest
from support import needed

from bokeh_validation import paths
from bokeh_validation.compilers import dxc, fxc, tool
from bokeh_validation.compilers.tool import CompileResult

STUBS = paths.VALIDATION / "stubs"
UNITY = paths.ROOT / "integration/unity"
FEATURE = UNITY / "BokehRendererFeature.cs"
PLUGIN = paths.ROOT / "integration/unreal/BokehDepthOfField"
MODULE = PLUGIN / "Source/BokehDepthOfField"
EXTENSION = MODULE / "Private/BokehViewExtension.cpp"

# The passes of both samples, and the targets that each writes
PASSES = {"Depth": 1, "SignedCoCMap": 1, "CoCMap": 1, "HexagonFirst": 2, "HexagonSecond": 1, "OctagonFirst": 3}
PASSES |= dict.fromkeys(("OctagonSecond", "Line", "LineFinal", "Debug"), 1)
# What shaders are compiled to: by fxc, by DXC
TARGETS = ("ps_4_0", "ps_5_0", "SPIR-V", "DXIL")


def text(path: Path) -> str:
    """A sample's file."""
    return path.read_text(encoding="ascii")


# ---- shaders ----


class Sample(NamedTuple):
    """The shaders of a sample.

    suffix   of an entry, behind the name of its pass
    first    where the functions begin that the package's passes have as well
    names    pattern of theirs -> the package's; alpha is the CoC there
    without  passes that the package has in another way: some read the engine's own textures
    """

    shader: Path
    suffix: str
    first: str
    names: dict[str, str]
    without: tuple[str, ...]


SAMPLES = {
    "unity": Sample(
        UNITY / "BokehDepthOfField.shader",
        "Fragment",
        "    BokehLens BokehGivenLens()",
        {
            r"float4\(color.rgb, 1.0\)": "color",
            "_BlitTexture": "BokehColorSamp",
            r"_Bokeh(Depth|Color)([BC]?)\b": r"Bokeh\1Samp\2",
            "sampler_Linear": "BokehLinear",
            "_BokehImageSize": "float2(BokehImageWidth, BokehImageHeight)",
            "_Bokeh": "Bokeh",
        },
        ("Depth",),
    ),
    "unreal": Sample(
        PLUGIN / "Shaders/BokehDepthOfField.usf",
        "PS",
        "BokehPolygon BokehAperture(int Sides)",
        {
            r"float4\(Color.rgb, 0.0\)": "Color",
            r"LinePS\(SvPosition\)": "LinePS(SvPosition, uv)",
            "float4 SvPosition : SV_POSITION": "float4 SvPosition : SV_POSITION, float2 uv : TEXCOORD0",
            r"ImageUV\(SvPosition\)": "uv",
            "BokehImageSize": "float2(BokehImageWidth, BokehImageHeight)",
            r"\bBokeh(Depth|Color)([BC]?),": r"Bokeh\1Samp\2,",
            r"BokehLinear\b": "BokehLinearClamp",
        },
        ("Depth", "SignedCoCMap", "CoCMap"),
    ),
}
# What a sample leaves out of the package's own passes: it has no noise, the preset's spacing, the default leakage test,
# lines of length 1 that are centred, blurs the CoC with the colour, combines by min; its aspect ratio is the image's
LEFT_OUT = {
    "= BokehAspectRatio;": "= BokehImageWidth / BokehImageHeight;",
    "BokehBleedingBias": "0.02",
    "BokehBleedingMult": "30.0",
    r"BokehSpacing\b": "0.0",
    "BokehBlurCoC > 0.5": "true",
    "BokehUseMax > 0.5": "false",
    "BokehLineLength": "1.0",
    "BokehJitter|BokehLineCenter[XY]": "0.0",
}
UNITY_INPUT = "struct Varyings { float4 positionCS : SV_POSITION; float2 texcoord : TEXCOORD0; };\n"
# In place of what the engines make metres with: the package's own way
METRES = """float BokehMetres(float2 uv)
{
    return BokehLinearDepth(BokehFetchDepth(BokehDepthSamp, uv), int(BokehDepthKind + 0.5), BokehNear, BokehFar);
}
"""
# What the samples include of the package
STEMS = ("bokeh", "bokeh_paper")
INCLUDE = re.compile(r'^[ \t]*#[ \t]*(?:include[ \t]+"([^"]+)"|pragma[ \t]+once)[^\n]*$', re.MULTILINE)


def code(engine: str) -> str:
    """What all entries share: of Unity's shader the part in HLSL."""
    shader = text(SAMPLES[engine].shader)
    return shader.partition("HLSLINCLUDE\n")[2].partition("ENDHLSL")[0] or shader


@cache
def source(engine: str) -> str:
    """The same with what it includes, each file once."""
    folder = STUBS / engine
    files = {path.relative_to(folder).as_posix(): path for path in folder.rglob("*") if path.is_file()}
    files |= {f"/{name}": path for name, path in files.items()}
    for stem in STEMS:
        names = (f"{stem}.hlsl", f"/Plugin/BokehDepthOfField/{stem}.ush")
        files |= dict.fromkeys(names, paths.shader("hlsl", stem))
    result, found = code(engine), 1
    while found:
        result, found = INCLUDE.subn(lambda line: text(files.pop(line[1])) if line[1] in files else "", result, count=1)
    return result


def compiled(source: str, target: str, entry: str) -> CompileResult:
    """For one of TARGETS."""
    with needed(target):
        if target.startswith("ps_"):
            return fxc.build(source, "frag", entry, int(target[3]))
        return dxc.build(source, "frag", entry, target == "SPIR-V")


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("half", ["float", "min16float"])
@pytest.mark.parametrize("engine", SAMPLES)
def test_shader(engine, half, target):
    """Every pass, without a warning, whichever type Unity makes of `half`."""
    for name in PASSES:
        result = compiled(f"#define STUB_HALF {half}\n{source(engine)}", target, name + SAMPLES[engine].suffix)
        assert result.ok and not result.messages, f"{name}: {result.messages}"


def test_unity_shader_refuses_texture_arrays():
    """Single-pass instanced stereo, where the camera's textures are arrays: told in one line."""
    result = compiled(f"#define STUB_STEREO\n{source('unity')}", "ps_5_0", "DepthFragment")
    assert not result.ok and "multi-pass" in result.messages


def replaced(source: str, names: dict[str, str]) -> str:
    """Each pattern in turn; all must occur."""
    for before, after in names.items():
        source, found = re.subn(before, after, source)
        assert found, before
    return source


def program(source: str, entry: str) -> bytes:
    """The instructions of a pixel shader: the compiled file without the names, which come before them."""
    result = compiled(source, "ps_5_0", entry)
    assert result.ok, f"{entry}: {result.messages}"
    return result.binary[result.binary.index(b"SHEX") :]


@pytest.mark.parametrize("engine", SAMPLES)
def test_passes_are_those_of_the_package(engine):
    """The same instructions as the package's own passes, which the suite runs: no argument is in another's place."""
    sample = SAMPLES[engine]
    head, bodies = text(paths.shader("hlsl", "bokeh_passes")).split("// pixel shaders\n")
    library = "".join(text(paths.shader("hlsl", stem)) for stem in STEMS)
    model = f"#define BOKEH_HLSL_SM 5\n{library}{head}"
    package = model + replaced("// pixel shaders\n" + bodies, LEFT_OUT)
    functions = code(engine)[code(engine).index(sample.first) :]
    own = model + UNITY_INPUT + METRES + replaced(functions, sample.names)
    entries = {"Line": "Adaptive", "LineFinal": "AdaptiveFinal"}
    for name in PASSES:
        if name not in sample.without:
            wanted = program(package, f"Bokeh{entries.get(name, name)}_PS")
            assert program(own, name + sample.suffix) == wanted, name


# ---- C# and C++ ----


def check_compiled(program: str, package: str, arguments: list[str], files: dict[str, str]) -> None:
    """Without a warning. `files` are what is there, by name; those that are not headers are compiled."""
    names = [name for name in files if not name.endswith(".h")]
    compiler = tool.Tool(program, f"apt-get install -y --no-install-recommends {package}")
    with needed(program):
        done = compiler.run([*arguments, *names], {name: code.encode("ascii") for name, code in files.items()})
    assert done.ok and not done.messages, done.messages


CSHARP = {
    "unity": (STUBS / "unity/Unity.cs", *sorted(UNITY.glob("*.cs"))),
    "unreal": (STUBS / "unreal/UnrealBuildTool.cs", MODULE / "BokehDepthOfField.Build.cs"),
}


@pytest.mark.parametrize("engine", CSHARP)
def test_csharp(engine):
    """The classes of Unity's sample, and the plug-in's Build.cs."""
    files = {path.name: text(path) for path in CSHARP[engine]}
    check_compiled("mcs", "mono-mcs", ["-target:library", "-warnaserror", "-out:out.dll"], files)


def test_unreal_classes():
    """Both C++ files of the plug-in, syntax and types only, with one stand-in for all headers of the engine."""
    own = [path for path in MODULE.rglob("*") if path.suffix in (".h", ".cpp")]
    files = {path.name: re.sub('#include "(?!Bokeh).*', "", text(path)) for path in own}
    files["Unreal.h"] = text(STUBS / "unreal/Unreal.h")
    warnings = ["-Wall", "-Wextra", "-Wno-unused-parameter", "-Werror"]
    arguments = ["-std=c++20", "-fsyntax-only", *warnings, "-include", "Unreal.h"]
    check_compiled("x86_64-w64-mingw32-g++", "g++-mingw-w64-x86-64-posix", arguments, files)


# ---- what the two languages of a sample must agree on ----


def test_unreal():
    """The .uplugin names the module and loads it before shaders are looked for; the classes have the shader's passes,
    and its uniforms by name and type in the parameter struct.
    """
    (module,) = json.loads(text(PLUGIN / "BokehDepthOfField.uplugin"))["Modules"]
    assert module["Name"] == MODULE.name and module["LoadingPhase"] == "PostConfigInit"
    assert re.findall(r"^BOKEH_SHADER\((\w+)\);", text(EXTENSION), re.MULTILINE) == list(PASSES)
    types = {"FIntPoint": "int2", "FVector2f": "float2"}
    given = re.findall(r"SHADER_PARAMETER(?:_RDG_TEXTURE|_SAMPLER)?\((\w+), (\w+)\)", text(EXTENSION))
    declared = re.findall(r"^(\w+) (Bokeh\w+);", code("unreal"), re.MULTILINE)
    assert [(types.get(kind, kind), name) for kind, name in given] == declared


def test_unity():
    """All that the class sets is declared in the shader, and all that is declared is set; the passes are the same."""
    names = set(re.findall(r'PropertyToID\("(\w+)"\)', text(FEATURE)))
    declared = re.findall(r"^    (?:float2?|TEXTURE2D)[ (](_Bokeh[^;()]+)\)?;", code("unity"), re.MULTILINE)
    assert names == {"_BlitTexture", "_BlitScaleBias", *", ".join(declared).split(", ")}
    (names,) = re.findall(r"enum ShaderPass\s*\{(.*?)\}", text(FEATURE), re.DOTALL)
    passes = re.findall(r'Pass \{ Name "(\w+)".*?#pragma fragment (\w+)', text(SAMPLES["unity"].shader), re.DOTALL)
    assert passes == [(name, f"{name}Fragment") for name in re.findall(r"\w+", names)]


@pytest.mark.parametrize("engine", SAMPLES)
def test_passes(engine):
    """They write as many targets as are bound: two for the hexagon, three for the octagon."""
    pattern = rf"\b\w+ (\w+){SAMPLES[engine].suffix}\(([^{{}}]*?)\n\s*\{{"
    assert {name: words.count("SV_Target") for name, words in re.findall(pattern, code(engine))} == PASSES
