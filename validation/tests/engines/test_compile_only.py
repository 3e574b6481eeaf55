"""The Unity and Unreal samples, which cannot run here: compiled against the stand-ins of validation/stubs.

Nothing is run, and a stand-in that is wrong is not found. What two languages of a sample must agree on, names and
order, no compiler sees; that is compared here.
"""

import json
import os
import re
import struct
from functools import cache
from pathlib import Path

import pytest

from bokeh_validation import paths
from bokeh_validation.compilers import dxc, fxc, includes, tool
from bokeh_validation.compilers.result import CompileResult
from bokeh_validation.errors import Unavailable

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


def missing(error: Unavailable) -> None:
    """A compiler that is not here: a failure under CI, else a skip with the line that installs it."""
    if os.environ.get("CI"):
        pytest.fail(str(error))
    pytest.skip(str(error))


# ---- shaders ----


@cache
def unity_source() -> str:
    """The code that all passes of the Unity shader share, with what it includes."""
    (code,) = re.findall(r"HLSLINCLUDE\n(.*?)ENDHLSL", text(SHADER), re.DOTALL)

    def find(name: str) -> Path:
        return paths.library("hlsl") if name == "bokeh.hlsl" else STUBS / "unity" / name

    return includes.inlined(code, find)


@cache
def unreal_source() -> str:
    """The Unreal shader file with what it includes."""

    def find(name: str) -> Path:
        if name == "/Plugin/BokehDepthOfField/bokeh.ush":
            return paths.library("hlsl")
        return STUBS / "unreal" / name.removeprefix("/")

    return includes.inlined(text(USF), find)


def compiled(source: str, target: str, entry: str, stage: str = "frag") -> CompileResult:
    """By one of TARGETS."""
    try:
        if target.startswith("ps_"):
            return fxc.build(source, stage, entry, int(target[3]))
        return dxc.build(source, stage, entry, spirv=target == "SPIR-V")
    except Unavailable as error:
        missing(error)


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


@pytest.mark.parametrize("target", TARGETS[1:])
@pytest.mark.parametrize("source", [unity_source, unreal_source])
def test_shader_mistakes_are_seen(target, source):
    """A name that is misspelled, an argument too few."""
    entry = "LineFragment" if source is unity_source else "LinePS"
    for right, wrong in ((r"BokehSegment\(_?BokehAngle, ", "BokehSegment("), (r"([Ss]ettings), true", r"\1s, true")):
        broken, changes = re.subn(right, wrong, source())
        assert changes
        assert not compiled(broken, target, entry).ok


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


@pytest.mark.parametrize("source", [unity_source, unreal_source])
def test_shader_includes_the_library_itself(source):
    """The sample has no copy of its own."""
    assert text(paths.library("hlsl")) in source()
    folder = UNITY if source is unity_source else PLUGIN
    for path in folder.rglob("*"):
        assert path.is_dir() or "float BokehCoC(" not in path.read_text(encoding="utf-8"), path


# ---- C# and C++ ----


def csharp(files: dict[str, str]) -> tool.Finished:
    """C# files, by name, to a library that is thrown away."""
    try:
        program = tool.find("mcs", CSHARP)
    except Unavailable as error:
        missing(error)
    inputs = {name: code.encode("ascii") for name, code in files.items()}
    return tool.run(program, ["-target:library", "-warnaserror", "-out:out.dll", *files], inputs)


def unity_classes() -> dict[str, str]:
    """The sample's C# files and what stands for Unity."""
    return {path.name: text(path) for path in (STUBS / "unity/Unity.cs", *sorted(UNITY.glob("*.cs")))}


def test_unity_classes():
    """Both C# files of the sample, without a warning."""
    done = csharp(unity_classes())
    assert done.ok and not done.output, done.output


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("builder.UseTexture(texture)", "builder.UseTextures(texture)"),
        ("RecordRenderGraph(RenderGraph graph, ContextContainer frameData)", "RecordRenderGraph(RenderGraph graph)"),
        ("builder.SetRenderAttachment(targets[index], index)", "builder.SetRenderAttachment(index, targets[index])"),
    ],
)
def test_unity_class_mistakes_are_seen(right, wrong):
    files = unity_classes()
    assert right in files[FEATURE.name]
    files[FEATURE.name] = files[FEATURE.name].replace(right, wrong)
    assert "error CS" in csharp(files).output


def test_unreal_build_rules():
    """The plug-in's Build.cs, and its .uplugin names the module and loads it before shaders are looked for."""
    rules = MODULE / "BokehDepthOfField.Build.cs"
    stubs = STUBS / "unreal/UnrealBuildTool.cs"
    done = csharp({stubs.name: text(stubs), rules.name: text(rules)})
    assert done.ok and not done.output, done.output
    (module,) = json.loads(text(PLUGIN / "BokehDepthOfField.uplugin"))["Modules"]
    assert module["Name"] == MODULE.name and module["LoadingPhase"] == "PostConfigInit"


# Where the engine's documentation says that each header is: module, then what follows Public/ or Classes/
UNREAL_HEADERS = {
    "CoreMinimal.h": "Core",
    "HAL/IConsoleManager.h": "Core",
    "Misc/CoreDelegates.h": "Core",
    "Misc/Paths.h": "Core",
    "Modules/ModuleManager.h": "Core",
    "Engine/HitResult.h": "Engine",
    "GameFramework/PlayerController.h": "Engine",
    "SceneTexturesConfig.h": "Engine",
    "SceneView.h": "Engine",
    "SceneViewExtension.h": "Engine",
    "Interfaces/IPluginManager.h": "Projects",
    "GlobalShader.h": "RenderCore",
    "PixelShaderUtils.h": "RenderCore",
    "RenderGraphUtils.h": "RenderCore",
    "ShaderCore.h": "RenderCore",
    "ShaderParameterStruct.h": "RenderCore",
    "PostProcess/PostProcessMaterialInputs.h": "Renderer",
    "ScreenPass.h": "Renderer",
}


def cplusplus(folder: Path, edit: tuple[str, str] = ("", "")) -> list[tool.Finished]:
    """Both files of the plug-in, syntax and types only. `folder` gets the headers that stand for the engine's."""
    try:
        program = tool.find("x86_64-w64-mingw32-g++", CPLUSPLUS)
    except Unavailable as error:
        missing(error)
    for name in UNREAL_HEADERS:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(f'#include "{(STUBS / "unreal/Unreal.h").as_posix()}"\n')
    options = ["-std=c++20", "-fsyntax-only", *WARNINGS]
    search = [f"-I{path}" for path in (folder, MODULE / "Public", MODULE / "Private")]
    files = sorted((MODULE / "Private").glob("*.cpp"))
    return [
        tool.run(program, [*options, *search, path.name], {path.name: text(path).replace(*edit).encode("ascii")})
        for path in files
    ]


def test_unreal_classes(tmp_path):
    """Both C++ files of the plug-in, without a warning."""
    for done in cplusplus(tmp_path):
        assert done.ok and not done.output, done.output


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("Given->BokehColor = Color;", "Given->BokehColour = Color;"),
        ("SceneColor.ViewRect};", "SceneColor};"),
        ("CreateRaw(this, &FBokehViewExtension::Draw)", "CreateRaw(this, &FBokehViewExtension::SetupView)"),
    ],
)
def test_unreal_class_mistakes_are_seen(tmp_path, right, wrong):
    assert right in text(EXTENSION)
    assert any("error: " in done.output for done in cplusplus(tmp_path, (right, wrong)))


def test_unreal_modules():
    """Each header that the plug-in includes is of a module that its Build.cs depends on."""
    sources = "".join(text(path) for path in MODULE.rglob("*") if path.suffix in (".h", ".cpp"))
    used = {name for name in re.findall(r'#include "([^"]+)"', sources) if not name.startswith("Bokeh")}
    assert used == set(UNREAL_HEADERS)
    rules = text(MODULE / "BokehDepthOfField.Build.cs")
    assert set(UNREAL_HEADERS.values()) <= set(re.findall(r'"(\w+)"', rules))


# ---- what the two languages of a sample must agree on ----


def test_unity_passes_have_the_numbers_of_the_class():
    (names,) = re.findall(r"enum ShaderPass\s*\{(.*?)\}", text(FEATURE), re.DOTALL)
    assert re.findall(r"\w+", names) == [name for name, _, _ in unity_passes()]


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


def test_unreal_entries_are_the_shader_s():
    shaders = re.findall(r"^BOKEH_SHADER\((\w+)\);", text(EXTENSION), re.MULTILINE)
    assert shaders == list(PASSES)
    assert re.findall(r"^\w+ (\w+)PS\(", text(USF), re.MULTILINE) == shaders


@pytest.mark.parametrize("path", [SHADER, USF])
def test_targets(path):
    """Passes with several targets write as many as are bound: two for the hexagon, three for the octagon."""
    for name, count in PASSES.items():
        (signature,) = re.findall(rf"\b\w+ {name}(?:Fragment|PS)\((.*?)\n\s*\{{", text(path), re.DOTALL)
        assert len(re.findall(r"SV_Target", signature)) == count, name


def test_stubs_are_all_used():
    """No stand-in is left over."""
    used = {"README.md", "Unity.cs", "Unreal.h", "UnrealBuildTool.cs"}
    used |= {Path(name).name for name in re.findall(r'#include "([^"]+)"', text(SHADER) + text(USF))}
    assert {path.name for path in STUBS.rglob("*") if path.is_file()} <= used
