"""Compile the Unity and Unreal packages, which cannot run here, against the stand-ins of validation/stubs.

Nothing is run, and a wrong stand-in goes unnoticed. No compiler checks what two languages of a package must agree on;
the parts of that which `generate` does not write are compared here.
"""

import json
import posixpath
import re
from functools import cache
from pathlib import Path

import pytest
from support import needed, nightly
from support_inputs import inputs

from bokeh_validation import needs, paths
from bokeh_validation.compilers import dxc, fxc, tool
from bokeh_validation.compilers.tool import CompileResult
from bokeh_validation.generate import copies
from bokeh_validation.shaders.entries import ENTRIES

pytestmark = inputs(
    copies.UNITY,
    copies.UNREAL,
    "validation/stubs",
    *(f"validation/bokeh_validation/{name}" for name in ("compilers", "generate")),
)

STUBS = paths.VALIDATION / "stubs"
UNITY, PLUGIN = paths.ROOT / copies.UNITY, paths.ROOT / copies.UNREAL
MODULE = PLUGIN / "Source/BokehDepthOfField"
EXTENSION = MODULE / "Private/BokehViewExtension.cpp"
SHADERS = {
    "unity": UNITY / "Shaders/BokehDepthOfField.shader",
    "unreal": PLUGIN / "Shaders/BokehDepthOfField.usf",
}
# Targets of fxc and DXC for the shaders; and the presets, with the quicker compiler and with --all
BUILDS = [(target, "") for target in ("ps_4_0", "ps_5_0", "SPIR-V", "DXIL")]
BUILDS += [pytest.param("SPIR-V", preset, marks=nightly) for preset in ("MOBILE", "LOW", "HIGH", "ULTRA")]
INCLUDE = re.compile(r'^[ \t]*#[ \t]*(?:include[ \t]+"([^"]+)"|pragma[ \t]+once)[^\n]*$', re.MULTILINE)


def text(path: Path) -> str:
    """Return the text of a file of a package."""
    return path.read_text(encoding="ascii")


# ---- shaders ----


@cache
def source(engine: str) -> str:
    """Return what all entries of a package share, with each included file once; of Unity's shader, the HLSL part."""
    shader, stubs = text(SHADERS[engine]), STUBS / engine
    found = {path.relative_to(stubs).as_posix(): path for path in stubs.rglob("*") if path.is_file()}
    found |= {f"/{name}": path for name, path in found.items()}
    for path in SHADERS[engine].parent.glob("bokeh*"):
        found |= {path.name: path, f"/Plugin/BokehDepthOfField/{path.name}": path}
    result, count = shader.partition("HLSLINCLUDE\n")[2].partition("ENDHLSL")[0] or shader, 1
    while count:
        result, count = INCLUDE.subn(lambda line: text(found.pop(line[1])) if line[1] else "", result, count=1)
    return re.sub(r"^ *#pragma (target|shader_feature).*", "", result, flags=re.MULTILINE)


@cache
def entries(engine: str) -> list[str]:
    """Return the pixel shaders that a package names."""
    named = (
        text(SHADERS["unity"]) if engine == "unity" else text(EXTENSION) + text(EXTENSION.with_name("BokehFrames.h"))
    )
    return re.findall(r'(?:#pragma fragment |^BOKEH_SHADER\(\w+, ")(\w+)', named, re.MULTILINE)


def compiled(source: str, target: str, entry: str, stage: str = "frag") -> CompileResult:
    """Compile an entry for a target of BUILDS."""
    with needed(target):
        if target.startswith("ps_"):
            return fxc.build(source, stage, entry, int(target[3]))
        return dxc.build(source, stage, entry, target == "SPIR-V")


@pytest.mark.parametrize(("target", "preset"), BUILDS)
@pytest.mark.parametrize("engine", SHADERS)
def test_shader(engine, target, preset):
    """Compile every pass without a warning."""
    quality = ["LOW", "", "HIGH", "ULTRA", "MOBILE"].index(preset)
    define = (
        f"#define BOKEH_PRESET_{preset} 1\n" if preset and engine == "unity" else f"#define BOKEH_QUALITY {quality}\n"
    )
    for entry in entries(engine):
        result = compiled(define + source(engine), target, entry)
        assert result.ok and not result.messages, f"{entry}: {result.messages}"


def test_unity_vertex():
    """Compile the vertex shader of the triangle that all passes draw."""
    result = compiled(source("unity"), "ps_5_0", "FullScreenVertex", "vert")
    assert result.ok and not result.messages


def test_unity_shader_refuses_texture_arrays():
    """Check that single-pass instanced stereo, where the camera's textures are arrays, gives an error with advice."""
    result = compiled(f"#define STUB_STEREO\n{source('unity')}", "ps_5_0", "BokehDebug_PS")
    assert not result.ok and "multi-pass" in result.messages


# ---- C# and C++ ----


def check_compiled(program: str, package: str, arguments: list[str], files: dict[str, str]) -> None:
    """Compile without a warning.

    program    command of the compiler
    package    Debian package that has it
    files      name -> text of the available files; all except headers are compiled
    """
    names = [name for name in files if not name.endswith(".h")]
    compiler = tool.Tool(program, f"{needs.APT} {package}")
    with needed(program):
        done = compiler.run([*arguments, *names], {name: code.encode("ascii") for name, code in files.items()})
    assert done.ok and not done.messages, done.messages


CSHARP = {
    "unity": (STUBS / "unity/Unity.cs", *sorted(UNITY.rglob("*.cs"))),
    "unreal": (STUBS / "unreal/UnrealBuildTool.cs", MODULE / "BokehDepthOfField.Build.cs"),
}


@pytest.mark.parametrize("engine", CSHARP)
def test_csharp(engine):
    """Compile the classes of Unity's package and its samples, and the plug-in's Build.cs."""
    files = {path.name: text(path) for path in CSHARP[engine]}
    options = ["-target:library", "-warnaserror", "-out:out.dll"]
    for editor in ([], ["-define:UNITY_EDITOR"]):
        check_compiled("mcs", "mono-mcs", [*options, *editor], files)


@pytest.mark.parametrize("minor", [6, 8])
def test_unreal_classes(minor):
    """Check syntax and types of the plug-in's C++ files, with one stand-in for all headers of Unreal Engine 5.x."""
    own = [path for path in MODULE.rglob("*") if path.suffix in (".h", ".cpp")]
    files = {path.name: re.sub('#include "(?!Bokeh).*', "", text(path)) for path in own}
    files["Unreal.h"] = text(STUBS / "unreal/Unreal.h")
    warnings = ["-Wall", "-Wextra", "-Wno-unused-parameter", "-Werror"]
    arguments = ["-std=c++20", "-fsyntax-only", *warnings, f"-DSTUB_ENGINE_MINOR={minor}", "-include", "Unreal.h"]
    check_compiled("x86_64-w64-mingw32-g++", "g++-mingw-w64-x86-64-posix", arguments, files)


# ---- what the languages of a package must agree on ----


def test_unreal():
    """Compare the parts of the plug-in.

    The .uplugin names the module and loads it before the engine looks for shaders. The classes have all passes, and
    the parameter struct has the shader's own uniforms by name and type.
    """
    (module,) = json.loads(text(PLUGIN / "BokehDepthOfField.uplugin"))["Modules"]
    assert module["Name"] == MODULE.name and module["LoadingPhase"] == "PostConfigInit"
    assert len(entries("unreal")) == len(copies.drawn())
    types = {"FIntPoint": "int2", "FVector2f": "float2"}
    given = re.findall(r"^    SHADER_PARAMETER\((\w+), (\w+)\)", text(EXTENSION), re.MULTILINE)
    declared = re.findall(r"^(\w+) (Bokeh\w+);", text(SHADERS["unreal"]), re.MULTILINE)
    assert [(types.get(kind, kind), name) for kind, name in given] == declared
    read = {slot for name in copies.drawn() for slot in ENTRIES[f"Bokeh{name}"].textures}
    textures = re.findall(r"SHADER_PARAMETER_RDG_TEXTURE\(Texture2D, Bokeh(\w+)\)", text(EXTENSION))
    assert set(textures) == read == set(re.findall(r'"Bokeh(\w+Samp\w*)"', text(UNITY / "Runtime/BokehFrames.cs")))


def test_unity_package():
    """Check that every file and folder has a .meta with a unique GUID, and that samples are where the package says.

    Unity ignores files without a .meta in a package that it may not write to.
    """
    names = [path.relative_to(UNITY).as_posix() for path in UNITY.rglob("*")]
    metas = {name for name in names if name.endswith(".meta")}
    assert {f"{name}.meta" for name in names if "~" not in name} - {f"{name}.meta" for name in metas} == metas
    assert len({re.search(r"^guid: ([0-9a-f]{32})$", text(UNITY / name), re.MULTILINE)[1] for name in metas}) == len(
        metas
    )
    samples = [posixpath.normpath(sample["path"]) for sample in json.loads(text(UNITY / "package.json"))["samples"]]
    assert samples == [name for name in names if re.fullmatch(r"Samples~/[^/]+", name)]


def test_unity_presets():
    """Check that each preset has a material with the shader's GUID and its keyword, so that builds include its
    variant.
    """
    shader = text(SHADERS["unity"])
    (keywords,) = re.findall(r"#pragma shader_feature_local_fragment _ (.*)", shader)
    assert "multi_compile" not in shader and shader.count("#pragma fragment") == len(copies.drawn()) == 36
    guid = re.search("^guid: (.*)$", text(SHADERS["unity"].with_name("BokehDepthOfField.shader.meta")), re.MULTILINE)[1]
    actual = {}
    for path in (UNITY / "Materials").glob("*.mat"):
        assert f"m_Shader: {{fileID: 4800000, guid: {guid}, type: 3}}" in text(path)
        assert f"m_Name: {path.stem}\n" in text(path)
        actual[path.stem] = re.findall(r"^  - (BOKEH_\w+)$", text(path), re.MULTILINE)
    expected = {f"Bokeh {name}": [f"BOKEH_PRESET_{name.upper()}"] for name in ("Mobile", "Low", "High", "Ultra")}
    assert actual == {**expected, "Bokeh Medium": []}
    assert sorted(sum(actual.values(), [])) == sorted(keywords.split())
    feature = text(UNITY / "Runtime/BokehRendererFeature.cs")
    (named,) = re.findall(r'"Packages/com\.polygonal-bokeh\.urp/(.*?)"', feature)
    assert (UNITY / named).is_file()


def test_unity_waits_for_a_volume():
    """Check that strength is 0 unless a volume overrides it, and that nothing is drawn without the camera's
    post-processing.
    """
    volume, feature = (text(UNITY / f"Runtime/{name}.cs") for name in ("BokehVolume", "BokehRendererFeature"))
    assert "strength = new ClampedFloatParameter(0.0f, 0.0f, 1.0f);" in volume
    assert "return strength.value > 0.0f && bokehScale.value > 0.0f;" in volume
    entered = feature.partition("override void AddRenderPasses")[2].partition("renderer.EnqueuePass")[0]
    for condition in ("material == null", "!renderingData.cameraData.postProcessEnabled", "!volume.IsActive()"):
        assert condition in entered
    for path in (UNITY / "Runtime").glob("*.cs"):
        assert re.search(r"^namespace PolygonalBokeh\n\{", text(path), re.MULTILINE), path


@pytest.mark.parametrize(("blades", "sides"), [(3, 4), (4, 4), (5, 6), (6, 6), (7, 8), (8, 8), (9, 10), (11, 10)])
def test_unity_blades(blades, sides):
    """Check the formula in the source that maps a physical camera's blades to the polygon's sides."""
    feature = text(UNITY / "Runtime/BokehRendererFeature.cs")
    (lowest, highest, formula) = re.search(r"Mathf\.Clamp\((.*), (\d+), (\d+)\);", feature).group(2, 3, 1)
    value = eval(formula.replace("camera.bladeCount", str(blades)).replace("/", "//"), {"__builtins__": {}})
    assert min(max(value, int(lowest)), int(highest)) == sides


def test_unreal_camera():
    """Check the lens: the camera's values in metres if its depth of field is on; a console variable above 0 overrides
    them.
    """
    source = text(EXTENSION)
    lens = source.partition("struct FBokehLens")[2].partition("\n};")[0]
    taken = dict(re.findall(r"^            (\w+) = (.*);$", lens, re.MULTILINE))
    settings = {
        "Settings.DepthOfFieldFstop": 4.0,
        "Settings.DepthOfFieldFocalDistance": 250.0,
        "Settings.DepthOfFieldSensorWidth": 36.0,
        "Settings.DepthOfFieldSqueezeFactor": 2.0,
        "Settings.DepthOfFieldBladeCount": 7,
        "ViewRect.Height()": 720.0,
        "ViewRect.Width()": 1280.0,
    }
    found = {}
    for name, expression in taken.items():
        for words, value in settings.items():
            expression = expression.replace(words, repr(value))
        expression = re.sub(r"static_cast<float>", "", re.sub(r"(?<=\d)f\b", "", expression))
        expression = expression.replace("FMath::", "").replace(" / 2 ", " // 2 ")
        known = {"Max": max, "Clamp": lambda value, low, high: min(max(value, low), high)}
        found[name] = eval(expression, {"__builtins__": {}}, known)
    assert found == pytest.approx(
        {"FStop": 4.0, "FocusDistance": 2.5, "SensorHeight": 0.02025, "Squeeze": 0.5, "Sides": 8}
    )
    overridden = re.findall(r"Override\((\w+), Setting(\w+)\.GetValueOnRenderThread\(\)\);", lens)
    assert dict(overridden) == {name: name for name in found}
    # 0 means that the console variable was not set
    assert all(re.search(rf"^BOKEH_SETTING\(\w+, {name}, 0(\.0f)?, ", source, re.MULTILINE) for name in found)
