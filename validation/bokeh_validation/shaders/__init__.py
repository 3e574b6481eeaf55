"""Concatenate the package's files into complete programs, as its users do."""

import re
from collections.abc import Mapping
from functools import cache

from bokeh_validation import paths

COMMENT = re.compile(r"//[^\n]*")
FUNCTION = re.compile(
    r"^(?P<doc>(?://[^\n]*\n)*)(?P<head>(?:@\w+ )?\w+ (?P<name>\w+)\([^{};]*)\n(?P<body>\{\n.*?^\})$",
    re.MULTILINE | re.DOTALL,
)
# A constant of the configuration: in HLSL and GLSL, then in WGSL
SETTING = r"^#ifndef (\w+)\n#define \1 ([^\s/]+)\n#endif$"
WGSL_SETTING = r"^(?:const|override) (\w+): (?:i32 = (-?\d+)|f32 = (-?\d+\.\d+));$"
# Name of a constant that is not part of the configuration
FIXED = r"BOKEH_(?:M\w+_DEPTH|TUNED_\w+)"

# GLSL profile -> version line
GLSL_VERSIONS = {"330": "#version 330", "300es": "#version 300 es", "450": "#version 450"}


def glsl_pass(entry: str) -> str:
    """Return the value of BOKEH_PASS for an entry: BokehDepthOfField -> BOKEH_DEPTH_OF_FIELD."""
    if entry == "BokehFullScreen":
        return "BOKEH_FULL_SCREEN"
    words = entry.removeprefix("Bokeh").replace("CoC", "Coc")
    return "BOKEH" + re.sub(r"([A-Z])", r"_\1", words).upper()


@cache
def text(language: str) -> str:
    """Return all files of a language as one text, in the order of paths.STEMS."""
    return "".join(file_text(language, stem) for stem in paths.STEMS)


def file_text(language: str, stem: str = "bokeh") -> str:
    """Return the text of one file."""
    return paths.shader(language, stem).read_text(encoding="ascii")


def presets(source: str) -> dict[str, dict[str, str]]:
    """Return preset -> name -> value from HLSL or GLSL; '' is the key for no preset."""
    pattern = r"(?:defined\(BOKEH_PRESET_(\w+)\)|^#else)\n((?:#define BOKEH_PRESET_\w+ \S+\n)+)"
    values: dict[str, dict[str, str]] = {}
    for name, lines in re.findall(pattern, source, re.MULTILINE):
        # the text may contain several files, each with its own presets
        values.setdefault(name, {}).update(re.findall(r"(\w+) (\S+)\n", lines))
    return values


def settings(language: str, source: str) -> dict[str, str]:
    """Return name -> value of the configuration in a text, without a preset, and of the tuned constants."""
    rows = re.findall(WGSL_SETTING if language == "wgsl" else SETTING, source, re.MULTILINE)
    plain = presets(source).get("", {})
    fixed = dict(re.findall(rf"^#define ({FIXED}) (\S+)$", source, re.MULTILINE))
    return {name: plain.get("".join(value), "".join(value)) for name, *value in rows} | fixed


def defines(values: Mapping[str, object]) -> str:
    """Return `#define` lines for HLSL and GLSL."""
    return "".join(f"#define {name} {value}\n" for name, value in values.items())


def glsl(entry: str, profile: str = "330", values: Mapping[str, object] | None = None) -> str:
    """Return a complete GLSL shader.

    entry    one of entries.ENTRIES or BokehFullScreen
    profile  one of GLSL_VERSIONS
    values   constants to define
    """
    head = GLSL_VERSIONS[profile] + "\n"
    if profile == "450" and _is_half(values):
        head += "#extension GL_EXT_shader_explicit_arithmetic_types_float16 : require\n"
    head += defines({"BOKEH_PASS": glsl_pass(entry), **(values or {})})
    return head + text("glsl")


def hlsl(shader_model: int | None, values: Mapping[str, object] | None = None) -> str:
    """Return a complete HLSL file with every entry point.

    shader_model  3 to 6; None: what the compiler reports
    values        constants to define
    """
    model = {"BOKEH_HLSL_SM": shader_model} if shader_model else {}
    return defines({**model, **(values or {})}) + text("hlsl")


def wgsl(values: Mapping[str, object] | None = None) -> str:
    """Return a complete WGSL module with every entry point.

    values  constants, which are set when a pipeline is created; half precision changes the text too, see section [2]
    """
    if not _is_half(values):
        return text("wgsl")
    return "enable f16;\n" + text("wgsl").replace("alias BokehHalf = f32;", "alias BokehHalf = f16;")


def _is_half(values: Mapping[str, object] | None) -> bool:
    return bool((values or {}).get("BOKEH_HALF_PRECISION"))
