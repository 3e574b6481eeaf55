"""Half precision: the interpreter against the reference and a device, what may be half, precision.md, compilers."""

import re
import struct

import numpy as np
import pytest
from support import load
from support_cases import noise_case

from bokeh_validation import metrics, paths, shaders
from bokeh_validation.compilers import fxc, glslang
from bokeh_validation.frame import methods
from bokeh_validation.half import domain, frames, program, table
from bokeh_validation.half.choice import ALLOWED, LIMITS, MAY_BE_HALF, WHOLE
from bokeh_validation.half.interpreter import ALL_HALF, FETCHES, RETURNED, Evaluator, convert, is_half, operate
from bokeh_validation.probes.model import expected
from bokeh_validation.reference import device, listings, segments
from bokeh_validation.shaders.entries import ENTRIES

EXACT = 1e-12
SIZE = (53, 41)
PLANS = {
    "paper hexagon": methods.Settings("paper", "hexagon"),
    "paper octagon, CoC kept": methods.Settings("paper", "octagon", blur_coc=False, samples=6),
    "paper star, adaptive": methods.Settings("paper", "star", spacing=1.0, max_samples=17, squeeze=0.7),
    "paper pentagon": methods.Settings("paper", "pentagon", samples=6),
    "exact square": methods.Settings("exact", "square", spacing=0.5, max_samples=9, jitter=0.5),
    "exact decagon": methods.Settings("exact", "decagon", rotation=11.0, lateral=0.01),
    "exact octagon, one target": methods.Settings("exact", "octagon", targets=False, spacing=1.0, max_samples=9),
    "naive hexagon": methods.Settings("naive", "hexagon", samples=5),
    "naive grid": methods.Settings("naive-grid", "square", samples=4, leak_fix=False),
}
RELAXED_PRECISION, DECORATE, MEMBER_DECORATE = 0, 71, 72
PARTIAL_PRECISION = 0x20  # D3DCOMPILE_PARTIAL_PRECISION
# D3DSPDM_PARTIALPRECISION in a destination parameter token of Direct3D 9
PP_BIT = 0x200000


@pytest.fixture(scope="module")
def findings() -> tuple[list, list, list]:
    """Everything that `validation/run precision` measures, once."""
    return table.measured()


# ----------------------------------------------------------------------------------------------------- the interpreter


def test_every_function_is_measured():
    """The budget or a method runs every function of sections [3] to [9]; MAY_BE_HALF names variables and members."""
    library = program.library()
    reached = {*domain.UNITS} | {"BokehMakePolygon"}
    entries = {item.entry for settings in PLANS.values() for item in methods.plan(settings, SIZE).passes}
    waiting = [program.main(entry).body for entry in entries] + [library[name].body for name in domain.UNITS]
    while waiting:
        new = {called.name for called in _names(waiting.pop(), "FuncCall")} & {*library, *program.helpers()} - reached
        reached |= new
        waiting += [(library.get(name) or program.helpers()[name]).body for name in new]
    assert set(library) <= reached, set(library) - reached
    for name, variables in MAY_BE_HALF.items():
        if name in program.structs():
            known = set(program.structs()[name])
        else:
            known = {*library[name].parameters, *_names(library[name].body, "Decl"), RETURNED, *WHOLE}
        assert set(variables) <= known, f"{name}: {set(variables) - known}"


def _names(node, kind: str) -> set:
    """Those of all nodes of a kind in a syntax tree."""
    own = {node.name} if type(node).__name__ == kind else set()
    return own.union(*(_names(child, kind) for _, child in node.children()))


def each(function):
    """A function of scalars, for every row of the arguments."""
    return lambda *arguments: np.array([function(*row) for row in zip(*arguments, strict=True)])


# window and clip depth near 1 lose what far / near is worth: that many roundings more
COUNTERPARTS = {
    "BokehCoC": (each(listings.circle_of_confusion), EXACT),
    "BokehLinearDepth": (each(lambda depth, kind, *planes: listings.linear_depth(depth, int(kind), *planes)), 1e-9),
    "BokehFilterCoC": (
        lambda coc, rows, spacing: np.where(spacing > 0, segments.filter_coc(coc, rows, 1.0), coc),
        EXACT,
    ),
}


def test_float64_is_the_reference():
    """What whole passes do not reach in all its cases: relative, both being float64 with a few roundings of 1e-16."""
    evaluator = Evaluator(np.float64)
    for name, (wanted, tolerance) in COUNTERPARTS.items():
        arguments = domain.arguments(name, np.random.default_rng(7), 500)
        found = evaluator.call(name, *arguments)[:, 0]
        assert np.allclose(found, wanted(*arguments), rtol=tolerance, atol=EXACT if tolerance == EXACT else 0.0), name
    found = evaluator.call("BokehDefaultFilter", np.array([[1920.0, 1080.0]]))
    given = methods.Settings()
    wanted = {"aspectRatio": 1920.0 / 1080.0, "imageHeight": 1080.0, "spacing": 1.0, "jitter": 0.0}
    wanted |= {"bleedingBias": given.bleeding_bias, "bleedingMult": given.bleeding_mult}
    assert {name: float(np.squeeze(value)) for name, value in found.items()} == wanted


@pytest.mark.parametrize("name", PLANS)
def test_float64_passes_are_the_reference(name, monkeypatch):
    """Whole methods, nothing rounded between the passes, to 1e-12 of the largest value.

    Along segments to 3.4e-7, by the steepest slope, twice the largest value a texel. The shaders' pi of 9 digits is
    off by 3.6e-9 of the CoC (0.1 of 41 rows), times 3 edges and 2 passes: 1e-7. The reference counts in pixels, the
    shaders in uv with an aspect ratio given in float32: 2^-24 of half a CoC, 2 pixels: 2.4e-7.
    """
    monkeypatch.setattr(device, "stored", lambda image, dtype, rounding: image)
    case = noise_case(SIZE, PLANS[name])
    wanted = device.Reference().images(case.plan.passes, case.textures(), case.size)["result"].value
    found, _ = frames.run(case.plan.passes, case.textures(), case.size, np.float64)
    tolerance = 3.4e-7 if any("BokehImageWidth" in item.parameters for item in case.plan.passes) else EXACT
    assert np.abs(found - wanted).max() <= tolerance * np.abs(wanted).max()


@pytest.mark.parametrize("name", PLANS)
def test_float32_is_the_device(name):
    """Whole methods on egl: both are within the derived interval of float32 around float64, and the two are no
    farther from each other than two such intervals.
    """
    driver = load("egl")
    case = noise_case(SIZE, PLANS[name])
    drawn = driver.run(case.plan.passes, case.textures(), case.size)["result"]
    given = case.plan.passes, case.textures(), case.size, np.float32
    found, _ = frames.run(*given, storage="half", rounding=driver.rounding)
    wanted = expected(case, driver.precision, driver.rounding)["result"]
    for image in (drawn, found.astype(np.float16)):
        comparison = metrics.compare(image, wanted, driver.software)
        assert comparison.ok, comparison
    apart = np.abs(drawn.astype(np.float64) - found)
    assert (apart <= 2.0 * wanted.error).all()
    # as close to each other as any two software devices: on flat patches a target that cuts off is a step off in
    # every pass where one float32 rounding differs
    steps = metrics.steps(found.astype(np.float16), drawn)[~wanted.undecided]
    assert steps.max() <= metrics.FAR_STEPS and (steps <= metrics.CLOSE_STEPS).mean() >= metrics.CLOSE_SHARE


def test_rounding_is_binary16():
    """Every operation of two half floats is the exact result rounded to nearest even once: 65519 is 65504, 65520 is
    infinite, 1 + 2^-11 is 1, three quarters of the smallest subnormal are that.
    """
    one = convert(1.0, np.float16)
    with np.errstate(over="ignore"):
        assert convert(65519.0, np.float16)[0, 0] == 65504.0
        assert np.isinf(convert(65520.0, np.float16)[0, 0])
        assert np.isinf(operate("*", convert(300.0, np.float16), convert(300.0, np.float16))[0, 0])
    assert operate("+", one, 2.0**-11)[0, 0] == 1.0
    assert operate("+", one, 2.0**-10)[0, 0] == 1.0 + 2.0**-10
    assert convert(0.75 * 2.0**-24, np.float16)[0, 0] == 2.0**-24
    # what two precisions meet in is the wider one
    assert operate("*", one, convert(0.1, np.float32)).dtype == np.float32
    assert operate("*", one, 0.1).dtype == np.float16


def test_a_variable_alone_is_half():
    """A choice rounds what it names: `t` of BokehMakeOffsets at 1/3 is off by half of 2^-12, all others are float."""
    chosen = Evaluator(choice={"BokehMakeOffsets": ("t",), "BokehPolygon": ("squeeze",)})
    found = chosen.call("BokehMakeOffsets", np.array([[1.0, 0.0]]), 2, 4)[0, 0]
    assert found == np.float32(np.float16(1.0 / 3.0)) and found != np.float32(1.0 / 3.0)
    member = chosen.call("BokehMakePolygon", 6, 0.1, 0.1)
    assert member["squeeze"].dtype == np.float16 and member["rotation"].dtype == np.float32


# --------------------------------------------------------------------------------------------------- what may be half


def test_the_budget_keeps_the_limits(findings):
    """choice.LIMITS: every function with its allowed variables half, and nothing overflows. One that is
    not allowed as a whole overflows or is over its limit when half as a whole.

    But BokehMakeOffsets, whose places are good enough by themselves: choice.py says why.
    """
    within = set()
    for name, off in findings[0]:
        limit = LIMITS[domain.UNITS[name]]
        if name in MAY_BE_HALF:
            assert off["allowed"].max() <= limit, name
        if MAY_BE_HALF.get(name) != WHOLE and off["half"].max() <= limit:
            within.add(name)
    assert within == {"BokehDefaultFilter", "BokehMakeOffsets"}


# function, variable, method: uv, a sum of uv and something, a sum of colours, a threshold
MUST_BE_FLOAT = [
    ("main", "BokehUV", "exact"),
    ("BokehDepthOfField", "sampleCoords", "paper"),
    ("BokehDepthOfField", "color", "paper"),
    ("BokehFilter", "bleedingBias", "paper, adaptive"),
]


def test_half_alone_is_seen_in_the_picture():
    """Each by itself moves a sample by more than an eighth of a pixel or loses pixels; choice.py allows none."""
    for function, name, method in MUST_BE_FLOAT:
        outcome = frames.outcome(method, {function: (name,)})
        assert outcome.moved > 0.125 or outcome.lost > 0.0, (function, name, outcome)
        assert not is_half(ALLOWED, function, name)


def test_allowed_halves_keep_the_picture(findings):
    """Whole methods with all that is allowed half at once: no sample a quarter of a pixel off, nothing lost, and 60 dB:
    an rms error of 0.001, a quarter of an 8-bit step. All half: off by a pixel and more, below 40 dB.
    """
    for name, half, chosen in findings[1]:
        assert chosen.lost == 0.0 and chosen.moved <= 0.25 and chosen.psnr >= 60.0, name
        assert half.moved > 1.0 and half.psnr < 40.0, name
    assert sum(half.lost > 0.0 for _, half, _ in findings[1]) >= 3


def test_reads_of_depth_must_be_float():
    """Depth beyond 65504 m is infinite as a half: that of the sky, which BokehCoCMap has at 1000000000 m."""
    assert is_half(ALLOWED, FETCHES[0], RETURNED) and not is_half(ALLOWED, FETCHES[1], RETURNED)
    found = Evaluator(choice=ALL_HALF).call("BokehCoC", np.array([1e9]), 0.05, 0.05, 5.0, 0.024, 0.1)
    assert np.isnan(found).all()


def test_small_formats():
    """R11G11B10F keeps 6, 6 and 5 bits of mantissa: rounded to nearest, off by 2^-7, 2^-7 and 2^-6 at most; no sign.
    RGBA8 has 255 steps, so that a CoC is off by 1/510 of the height, half a step of 8.5 pixels at 2160 rows.
    """
    values = np.random.default_rng(1).uniform(0.01, 60000.0, (20, 30, 4))
    off = np.abs(frames.stored(values, "r11g11b10") / values - 1.0)[..., :3].max(axis=(0, 1))
    # half a step of the half float that it is rounded to before
    assert (off <= np.array([2.0**-7, 2.0**-7, 2.0**-6]) + 2.0**-11).all()
    assert (off > np.array([2.0**-8, 2.0**-8, 2.0**-7])).all()
    assert (frames.stored(-values, "r11g11b10")[..., :3] == 0.0).all()
    assert np.abs(frames.stored(values / 60000.0, "rgba8") - values / 60000.0).max() <= 1 / 510


def test_document_says_what_is_measured(findings):
    """Every table of precision.md is what the command prints: words alike, numbers to 10 %: two digits are rounded by
    up to 5 %, and sin and cos of another processor may differ in a last bit.
    """
    text = (paths.ROOT / "validation/precision.md").read_text(encoding="utf-8")
    shown = [line for line in text[text.index("| function |") :].splitlines() if line.startswith("|")]
    printed = [line for line in table.markdown(*findings) if line]
    number = re.compile(r"(?<![\w`])-?\d+(?:\.\d+)?(?:e-?\d+)?(?!\w)")
    for line, wanted in zip(shown, printed, strict=True):
        assert number.sub("#", line) == number.sub("#", wanted)
        values = [np.array(number.findall(item), float) for item in (line, wanted)]
        assert np.allclose(*values, rtol=0.1), (line, wanted)


# ------------------------------------------------------------------------------------------------------- the compilers


def test_libraries_have_no_half():
    """No word in any of the three that makes a variable 16 bits; comments may have it."""
    for language in paths.LANGUAGES:
        for file in (paths.library(language), paths.layers(language), paths.passes(language)):
            code = re.sub(r"//.*", "", file.read_text(encoding="ascii"))
            found = re.findall(r"\b(?:half\d?|min\w+float\d?|float16_t\d?|mediump|lowp|f16|vec\dh)\b", code)
            assert not found, f"{file.name}: {found}"


@pytest.mark.parametrize("entry", ENTRIES)
def test_highp_wins_over_mediump(entry):
    """`precision mediump float;` in front of the library relaxes nothing; without the library's own line it would."""
    head = f"#version 310 es\nprecision mediump float;\n#define BOKEH_PASS {shaders.glsl_pass(entry)}\n"
    own = r"^precision highp \w+;\n"
    as_is = glslang.spirv(head + shaders.text("glsl"), "frag", glslang.VULKAN)
    assert as_is.ok and relaxed(as_is.binary) == 0, as_is.messages
    if entry == "BokehDepthOfField":
        text = re.sub(own, "", shaders.text("glsl"), flags=re.MULTILINE)
        without = glslang.spirv(head + text, "frag", glslang.VULKAN)
        assert without.ok and relaxed(without.binary) > 0, without.messages


def relaxed(binary: bytes) -> int:
    """RelaxedPrecision decorations of a SPIR-V module."""
    words = struct.unpack(f"<{len(binary) // 4}I", binary)
    index, found = 5, 0
    while index < len(words):
        length, opcode = words[index] >> 16, words[index] & 0xFFFF
        place = {DECORATE: 2, MEMBER_DECORATE: 3}.get(opcode)
        found += place is not None and words[index + place] == RELAXED_PRECISION
        index += length
    return found


def test_partial_precision_of_fxc_does_reach_the_library():
    """/Gpp marks float instructions of shader model 3 _pp, and nothing else of the code changes."""
    compiler = fxc.load()
    source, entry = shaders.hlsl(3), "BokehHexagonFirst_PS"
    plain, partial = (compiler.compile(source, "ps_3_0", entry, flags=flags) for flags in (0, PARTIAL_PRECISION))
    assert plain.ok and partial.ok
    words = [np.frombuffer(item.binary, np.uint32) for item in (plain, partial)]
    changed = (words[0] ^ words[1])[words[0] != words[1]]
    # one word more: the flags themselves, which fxc keeps in a comment
    assert sorted(set(changed.tolist())) == [PARTIAL_PRECISION, PP_BIT]
    assert (changed == PP_BIT).sum() > 100
