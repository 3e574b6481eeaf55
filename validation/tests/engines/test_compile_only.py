"""The Unity and Unreal samples, which cannot run here: compiled against the stand-ins of validation/stubs.

Nothing is run, and a stand-in that is wrong is not found. What two languages of a sample must agree on, names and
order, no compiler sees; that is compared here.
"""

import json
import re
import struct
from functools import cache
from pathlib import Path

import pytest
from support import needed

from bokeh_validation import paths
from bokeh_validation.compilers import dxc, fxc, tool
from bokeh_validation.compilers.tool import CompileResult

STUBS = paths.VALIDATION / "stubs"
UNITY = paths.ROOT / "integration/unity"
SHADER = UNITY / "BokehDepthOfField.shader"
FEATURE = UNITY / "BokehRendererFeature.cs"
PLUGIN = paths.ROOT / "integration/unreal/BokehDepthOfField"
MODULE = PLUGIN / "Source/BokehDepthOfField"
USF = PLUGIN / "Shaders/BokehDepthOfField.usf"
EXTENSION = MODULE / "Private/BokehViewExtension.cpp"
CSHARP = "apt-get install -y --no-install-recommends mono-mcs"
CPLUSPLUS = "apt-get install -y --no-install-recommends g++-mingw-w64-x86-64-posix"
WARNINGS = ("-Wall", "-Wextra", "-Wno-unused-parameter", "-Werror")

# What shaders are compiled to: by fxc, by DXC
TARGETS = ("ps_4_0", "ps_5_0", "SPIR-V", "DXIL")
# The passes of both samples, and the targets that each writes
PASSES = {
    "Depth": 1,
    "SignedCoCMap": 1,
    "CoCMap": 1,
    "HexagonFirst": 2,
    "HexagonSecond": 1,
    "OctagonFirst": 3,
    "OctagonSecond": 1,
    "Line": 1,
    "LineFinal": 1,
    "Debug": 1,
}


def text(path: Path) -> str:
    """A sample's file."""
    return path.read_text(encoding="ascii")


# ---- shaders ----


def inlined(source: str, files: dict[str, Path], seen: set[str] | None = None) -> str:
    """A shader's text with all that it includes, each file once. `files` has them by name."""
    seen = set() if seen is None else seen

    def replacement(match: re.Match) -> str:
        name = match["name"]
        if not name or name in seen:
            return ""
        seen.add(name)
        return inlined(text(files[name]), files, seen)

    line = r'^[ \t]*#[ \t]*(?:include[ \t]+"(?P<name>[^"]+)"|pragma[ \t]+once)[^\n]*$'
    return re.sub(line, replacement, source, flags=re.MULTILINE)


def stubs(engine: str, library: str) -> dict[str, Path]:
    """Name in an #include -> file; `library`: how bokeh.hlsl is named."""
    folder = STUBS / engine
    found = {path.relative_to(folder).as_posix(): path for path in folder.rglob("*") if path.is_file()}
    return found | {f"/{name}": path for name, path in found.items()} | {library: paths.library("hlsl")}


@cache
def unity_source() -> str:
    """The code that all passes of the Unity shader share, with what it includes."""
    (code,) = re.findall(r"HLSLINCLUDE\n(.*?)ENDHLSL", text(SHADER), re.DOTALL)
    return inlined(code, stubs("unity", "bokeh.hlsl"))


@cache
def unreal_source() -> str:
    """The Unreal shader file with what it includes."""
    return inlined(text(USF), stubs("unreal", "/Plugin/BokehDepthOfField/bokeh.ush"))


def compiled(source: str, target: str, entry: str, stage: str = "frag") -> CompileResult:
    """By one of TARGETS."""
    with needed(target):
        if target.startswith("ps_"):
            return fxc.build(source, stage, entry, int(target[3]))
        return dxc.build(source, stage, entry, target == "SPIR-V")


def unity_passes() -> list[tuple[str, str, str]]:
    """(name, vertex entry, fragment entry) of the passes of the Unity shader, in their order."""
    found = re.findall(r'Pass \{ Name "(\w+)" HLSLPROGRAM\n(.*?)ENDHLSL \}', text(SHADER), re.DOTALL)
    entries = [(name, dict(re.findall(r"#pragma (\w+) (\S+)", code))) for name, code in found]
    return [(name, pragmas["vertex"], pragmas["fragment"]) for name, pragmas in entries]


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("half", ["float", "min16float"])
def test_unity_shader(target, half):
    """Every pass, whichever type the project's precision makes of `half`."""
    source = f"#define STUB_HALF {half}\n{unity_source()}"
    passes = unity_passes()
    assert [name for name, _, _ in passes] == list(PASSES)
    for name, vertex, fragment in passes:
        for entry, stage in ((vertex, "vert"), (fragment, "frag")):
            result = compiled(source, target, entry, stage)
            assert result.ok and not result.messages, f"{name}, {entry}: {result.messages}"


def test_unity_shader_refuses_texture_arrays():
    """Single-pass instanced stereo, where the camera's textures are arrays: told in one line."""
    result = compiled(f"#define STUB_STEREO\n{unity_source()}", "ps_5_0", "DepthFragment")
    assert not result.ok and "multi-pass" in result.messages


@pytest.mark.parametrize("target", TARGETS[1:])
def test_unreal_shader(target):
    """Every entry point, shader models 5 and 6."""
    for name in PASSES:
        result = compiled(unreal_source(), target, f"{name}PS")
        assert result.ok and not result.messages, f"{name}: {result.messages}"


# What a sample leaves out of the package's own passes: it has no noise, the default leakage test, lines of length 1
# that are centred, blurs the CoC with the colour, combines by min; its aspect ratio is that of the image
LEFT_OUT = {
    "BokehJitter": "0.0",
    "= BokehAspectRatio;": "= imageSize.x / imageSize.y;",
    "BokehBleedingBias": "BOKEH_BLEEDING_BIAS",
    "BokehBleedingMult": "BOKEH_BLEEDING_MULT",
    "BokehBlurCoC > 0.5": "true",
    "BokehUseMax > 0.5": "false",
    "BokehLineLength": "1.0",
    "BokehLineCenterX": "0.0",
    "BokehLineCenterY": "0.0",
}
# The samples' names for what the package's passes have; alpha is the CoC there
UNITY_NAMES = {
    "float4(color.rgb, 1.0)": "color",
    "_BlitTexture": "BokehColorSamp",
    "_BokehDepth": "BokehDepthSamp",
    "_BokehColorB": "BokehColorSampB",
    "_BokehColorC": "BokehColorSampC",
    "sampler_LinearClamp": "BokehLinearClamp",
    "_BokehImageSize": "float2(BokehImageWidth, BokehImageHeight)",
    "_Bokeh": "Bokeh",
}
UNREAL_NAMES = {
    "float4(Color.rgb, 0.0)": "Color",
    "LinePS(SvPosition)": "LinePS(SvPosition, uv)",
    "float4 SvPosition : SV_POSITION": "float4 SvPosition : SV_POSITION, float2 uv : TEXCOORD0",
    "ImageUV(SvPosition)": "uv",
    "BokehImageSize": "float2(BokehImageWidth, BokehImageHeight)",
    "BokehColorB,": "BokehColorSampB,",
    "BokehColorC,": "BokehColorSampC,",
    "BokehColor,": "BokehColorSamp,",
    "BokehDepth,": "BokehDepthSamp,",
    "BokehLinear,": "BokehLinearClamp,",
}
PACKAGE_ENTRIES = {name: f"Bokeh{name}_PS" for name in PASSES if name != "Depth"}
PACKAGE_ENTRIES |= {"Line": "BokehAdaptive_PS", "LineFinal": "BokehAdaptiveFinal_PS"}
# In Unreal, these read the engine's own textures
READ_UNREAL = ("SignedCoCMap", "CoCMap")


def replaced(source: str, names: dict[str, str]) -> str:
    """Each in turn; all must occur."""
    for before, after in names.items():
        assert before in source, before
        source = source.replace(before, after)
    return source


def program(source: str, entry: str) -> bytes:
    """The instructions of a pixel shader: the chunk of the compiled file that has no names in it."""
    binary = compiled(source, "ps_5_0", entry)
    assert binary.ok, f"{entry}: {binary.messages}"
    (count,) = struct.unpack_from("<I", binary.binary, 28)
    for offset in struct.unpack_from(f"<{count}I", binary.binary, 32):
        name, size = struct.unpack_from("<4sI", binary.binary, offset)
        if name == b"SHEX":
            return binary.binary[offset + 8 : offset + 8 + size]
    raise AssertionError("no SHEX chunk")


def unity_functions() -> str:
    """The fragment functions alone, with the package's names for their textures and parameters."""
    (code,) = re.findall(r"HLSLINCLUDE\n(.*?)ENDHLSL", text(SHADER), re.DOTALL)
    code = replaced(code[code.index("    float4 SignedCoCMapFragment") :], UNITY_NAMES)
    return f"struct Varyings {{ float4 positionCS : SV_POSITION; float2 texcoord : TEXCOORD0; }};\n{code}"


def unreal_functions() -> str:
    """The same of the Unreal shader, without the passes that read the engine's own textures."""
    code = text(USF)
    return replaced(code[code.index("BokehFilter BokehSettings()") :], UNREAL_NAMES)


@pytest.mark.parametrize("functions", [unity_functions, unreal_functions])
def test_passes_are_those_of_the_package(functions):
    """The same instructions as the package's own passes, which the suite runs: no argument is in another's place."""
    head, bodies = text(paths.passes("hlsl")).split("// pixel shaders\n")
    model = f"#define BOKEH_HLSL_SM 5\n#define BOKEH_NUM_SAMPLES 33\n{text(paths.library('hlsl'))}{head}"
    package = model + replaced("// pixel shaders\n" + bodies, LEFT_OUT)
    sample = model + functions()
    suffix = "Fragment" if functions is unity_functions else "PS"
    for name, entry in PACKAGE_ENTRIES.items():
        if functions is unity_functions or name not in READ_UNREAL:
            assert program(sample, name + suffix) == program(package, entry), name


# ---- C# and C++ ----


def csharp(files: dict[str, str]) -> tool.Finished:
    """C# files, by name, to a library that is thrown away."""
    with needed("mcs"):
        program = tool.find("mcs", CSHARP)
    inputs = {name: code.encode("ascii") for name, code in files.items()}
    return tool.run(program, ["-target:library", "-warnaserror", "-out:out.dll", *files], inputs)


def test_unity_classes():
    """The C# files of the sample without a warning."""
    done = csharp({path.name: text(path) for path in (STUBS / "unity/Unity.cs", *sorted(UNITY.glob("*.cs")))})
    assert done.ok and not done.output, done.output


def test_unreal_build_rules():
    """The plug-in's Build.cs, and its .uplugin names the module and loads it before shaders are looked for."""
    rules = MODULE / "BokehDepthOfField.Build.cs"
    stubs = STUBS / "unreal/UnrealBuildTool.cs"
    done = csharp({stubs.name: text(stubs), rules.name: text(rules)})
    assert done.ok and not done.output, done.output
    (module,) = json.loads(text(PLUGIN / "BokehDepthOfField.uplugin"))["Modules"]
    assert module["Name"] == MODULE.name and module["LoadingPhase"] == "PostConfigInit"


def test_unreal_classes(tmp_path):
    """Both C++ files of the plug-in, syntax and types only, without a warning."""
    with needed("mingw"):
        program = tool.find("x86_64-w64-mingw32-g++", CPLUSPLUS)
    sources = "".join(text(path) for path in MODULE.rglob("*") if path.suffix in (".h", ".cpp"))
    for name in set(re.findall(r'#include "((?!Bokeh)[^"]+)"', sources)):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(f'#include "{(STUBS / "unreal/Unreal.h").as_posix()}"\n')
    search = [f"-I{path}" for path in (tmp_path, MODULE / "Public", MODULE / "Private")]
    files = {path.name: text(path).encode("ascii") for path in (MODULE / "Private").glob("*.cpp")}
    done = tool.run(program, ["-std=c++20", "-fsyntax-only", *WARNINGS, *search, *files], files)
    assert done.ok and not done.output, done.output


# ---- what the two languages of a sample must agree on ----


def test_unity_properties_are_the_shader_s():
    """All that the class sets is declared in the shader, and all that is declared is set."""
    names = set(re.findall(r'PropertyToID\("(\w+)"\)', text(FEATURE)))
    declared = set(re.findall(r"\b(_Bokeh\w+)[,;)]", text(SHADER)))
    of_blit = {"_BlitTexture", "_BlitScaleBias"}
    code = re.sub(r"//.*", "", text(SHADER))
    fields = re.findall(r"^    float2? ([^;()]+);", code, re.MULTILINE)
    uniforms = {name.strip() for line in fields for name in line.split(",")}
    uniforms |= set(re.findall(r"^    TEXTURE2D\((\w+)\);", code, re.MULTILINE))
    assert names - of_blit == uniforms
    assert uniforms <= declared
    assert of_blit <= names


def test_unreal_parameters_are_the_shader_s():
    """Names and types of the parameter struct, and of the shader's uniforms."""
    types = {"FIntPoint": "int2", "FVector2f": "float2"}
    given = re.findall(r"SHADER_PARAMETER(?:_RDG_TEXTURE|_SAMPLER)?\((\w+), (\w+)\)", text(EXTENSION))
    declared = re.findall(r"^(\w+) (Bokeh\w+);", text(USF), re.MULTILINE)
    assert [(types.get(kind, kind), name) for kind, name in given] == declared


def test_passes_have_the_numbers_and_names_of_the_classes():
    """And those with several targets write as many as are bound: two for the hexagon, three for the octagon."""
    (names,) = re.findall(r"enum ShaderPass\s*\{(.*?)\}", text(FEATURE), re.DOTALL)
    assert re.findall(r"\w+", names) == [name for name, _, _ in unity_passes()]
    assert re.findall(r"^BOKEH_SHADER\((\w+)\);", text(EXTENSION), re.MULTILINE) == list(PASSES)
    for path in (SHADER, USF):
        for name, count in PASSES.items():
            (signature,) = re.findall(rf"\b\w+ {name}(?:Fragment|PS)\((.*?)\n\s*\{{", text(path), re.DOTALL)
            assert len(re.findall(r"SV_Target", signature)) == count, name
