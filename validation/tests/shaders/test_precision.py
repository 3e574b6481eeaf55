"""Half precision: evaluator against reference and device, error budget, validation/precision.md, compilers."""

import re
import struct

import numpy as np
import pytest
from support import load
from test_drivers import noise_case

from bokeh_validation import methods, metrics, paths, shaders
from bokeh_validation.compilers import fxc, glslang
from bokeh_validation.entries import ENTRIES
from bokeh_validation.half import budget, domain, frames, program, table
from bokeh_validation.half.choice import ALLOWED, LIMITS, MAY_BE_HALF, WHOLE
from bokeh_validation.half.emulator import Emulator, stored
from bokeh_validation.half.evaluate import ALL_FLOAT, ALL_HALF, FETCHES, RETURNED, Choice, Evaluator
from bokeh_validation.half.numbers import HALF, Rounded
from bokeh_validation.patterns.model import Case, expected
from bokeh_validation.reference import device, listings, segments

EXACT = 1e-12
SIZE = (53, 41)
PLANS = {
    "paper hexagon": methods.Settings("paper", "hexagon"),
    "paper octagon, CoC kept": methods.Settings("paper", "octagon", blur_coc=False, samples=6),
    "paper star, adaptive": methods.Settings("paper", "star", spacing=1.0, max_samples=17, squeeze=0.7),
    "paper pentagon": methods.Settings("paper", "pentagon", samples=6),
    "exact square": methods.Settings("exact", "square", spacing=0.5, max_samples=9, jitter=0.5),
    "exact decagon": methods.Settings("exact", "decagon", rotation=11.0),
    "exact octagon, one target": methods.Settings("exact", "octagon", targets=False, spacing=1.0, max_samples=9),
    "naive hexagon": methods.Settings("naive", "hexagon", samples=5),
    "naive grid": methods.Settings("naive-grid", "square", samples=4, leak_fix=False),
}
RELAXED_PRECISION, DECORATE, MEMBER_DECORATE = 0, 71, 72
PARTIAL_PRECISION = 0x20  # D3DCOMPILE_PARTIAL_PRECISION
# D3DSPDM_PARTIALPRECISION in a destination parameter token of Direct3D 9
PP_BIT = 0x200000


@pytest.fixture(scope="module")
def findings() -> table.Findings:
    """Everything that `validation/run precision` measures, once."""
    return table.measured()


def exactly(name: str, *arguments) -> np.ndarray:
    """A function of the shaders in float64."""
    return Evaluator(Rounded(np.float64), ALL_FLOAT).call(name, *arguments)


def inputs(name: str) -> list:
    """Arguments of a function from its domain."""
    item = next(item for item in domain.DOMAINS if item.function == name)
    return item.arguments(np.random.default_rng(7), 500)


# ------------------------------------------------------------------------------------------------------- the evaluator


def test_every_function_is_measured():
    """The budget or a method runs every function of sections [3] to [9]; MAY_BE_HALF names variables and members."""
    library = program.library()
    reached = {item.function for item in domain.DOMAINS} | {"BokehMakePolygon"}
    entries = {item.entry for settings in PLANS.values() for item in methods.plan(settings, SIZE).passes}
    waiting = [program.main(entry).body for entry in entries]
    while waiting:
        new = _calls(waiting.pop()) & {*library, *program.helpers()} - reached
        reached |= new
        waiting += [(library.get(name) or program.helpers()[name]).body for name in new]
    assert set(library) <= reached, set(library) - reached
    for name, variables in MAY_BE_HALF.items():
        if name in program.structs():
            assert set(variables) <= set(program.structs()[name]), name
            continue
        known = {*library[name].parameters, *library[name].locals, RETURNED, *WHOLE}
        assert set(variables) <= known, f"{name}: {set(variables) - known}"


def _calls(node) -> set[str]:
    """Names of what a syntax tree calls."""
    own = {node.name.name} if type(node).__name__ == "FuncCall" else set()
    return own.union(*(_calls(child) for _, child in node.children()))


COUNTERPARTS = {
    "BokehCoC": lambda s2, a, f, s1, sensor, most: np.array(
        [listings.circle_of_confusion(*row) for row in zip(s2, a, f, s1, sensor, most, strict=True)]
    ),
    "BokehSafeChannel": listings.safe_color,
    "BokehSafeDepth": listings.safe_depth,
    "BokehLeakageWeight": lambda sd, sc, cd, cc, given: listings.leakage_weight(
        sd, sc, cd, cc, given["bleedingBias"], given["bleedingMult"]
    ),
    "BokehFilterCoC": lambda coc, rows, spacing: np.where(spacing > 0.0, segments.filter_coc(coc, rows, 1.0), coc),
    "BokehLinearDepth": lambda depth, kind, near, far: np.array(
        [listings.linear_depth(d, int(k), n, f) for d, k, n, f in zip(depth, kind, near, far, strict=True)]
    ),
}


@pytest.mark.parametrize("name", COUNTERPARTS)
def test_float64_is_the_reference(name):
    """One function at a time, to 1e-12 relative: both are float64, with a few roundings of 1e-16 each."""
    arguments = inputs(name)
    found = exactly(name, *arguments)[:, 0]
    if name == "BokehLinearDepth":
        # window and clip depth near 1 lose what far / near is worth: that many roundings more
        assert np.allclose(found, COUNTERPARTS[name](*arguments), rtol=1e-9, atol=0.0)
    else:
        assert np.allclose(found, COUNTERPARTS[name](*arguments), rtol=EXACT, atol=EXACT)


def test_float64_geometry_is_the_reference():
    """Edges, weights, segments and noise. The shaders' pi has 9 digits: 3.14159265 is off by 3.6e-9, a relative 1.2e-9,
    and the edges and weights are that far from the reference's; they have slopes of at most 10.
    """
    for sides in (4, 6, 8, 10):
        for k in range(1, sides // 2 + 1):
            for second in (False, True):
                wanted = segments.polygon_edge(k, sides, 0.3, 0.7, second)
                polygon = {"sides": sides, "rotation": 0.3, "squeeze": 0.7}
                found = exactly("BokehPolygonEdge", k, polygon, second)[0]
                assert np.allclose(found, [*wanted.middle, *wanted.half], atol=10 * 3.6e-9)
            assert np.isclose(exactly("BokehExactWeight", k, sides)[0, 0], segments.weight(k, sides), atol=10 * 3.6e-9)
    wanted = segments.line_segment(0.4, 0.8, (0.1, -0.2), 0.7)
    found = exactly("BokehSegment", 0.4, 0.8, np.array([[0.1, -0.2]]), 0.7)[0]
    assert np.allclose(found, [*wanted.middle, *wanted.half], atol=EXACT)
    y, x = np.mgrid[0 : SIZE[1], 0 : SIZE[0]] + 0.5
    uv = np.stack([x.ravel() / SIZE[0], y.ravel() / SIZE[1]], axis=1)
    for index in range(3):
        noise = exactly("BokehNoise", uv, np.array([SIZE], float), 70.0, float(index))
        assert np.allclose(noise[:, 0], segments.noise(SIZE, 70.0, index)[0].ravel(), atol=1e-11)


def test_structs_are_values():
    """BokehMakePolygon returns what it was given; what a function does to its copy the caller does not see."""
    assert exactly("BokehMakePolygon", 6, 0.5, 0.25) == {"sides": 6, "rotation": 0.5, "squeeze": 0.25}
    given = {"sides": 8, "rotation": 0.5, "squeeze": 0.25}
    exactly("BokehPolygonEdge", 2, given, True)
    assert given == {"sides": 8, "rotation": 0.5, "squeeze": 0.25}
    rounded = Evaluator(Rounded(), Choice({"BokehPolygon": frozenset(["rotation"])})).call(
        "BokehMakePolygon", 6, 0.1, 0.1
    )
    assert rounded["rotation"].dtype == np.float16 and rounded["squeeze"].dtype == np.float32


def test_the_default_filter_is_section_1():
    size = np.array([[1920.0, 1080.0]])
    found = {name: float(np.squeeze(value)) for name, value in exactly("BokehDefaultFilter", size).items()}
    settings = methods.Settings()
    assert found == {
        "aspectRatio": 1920.0 / 1080.0,
        "imageHeight": 1080.0,
        "spacing": 1.0,
        "jitter": 0.0,
        "bleedingBias": settings.bleeding_bias,
        "bleedingMult": settings.bleeding_mult,
    }


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
    found = Emulator(Rounded(np.float64), ALL_FLOAT).run(case.plan.passes, case.textures(), case.size)["result"]
    tolerance = 3.4e-7 if any("BokehImageWidth" in item.parameters for item in case.plan.passes) else EXACT
    assert np.abs(found - wanted).max() <= tolerance * np.abs(wanted).max()


@pytest.mark.parametrize("name", PLANS)
def test_float32_is_the_device(name):
    """Whole methods on egl: both are within the derived interval of float32 around float64, and the two are no
    farther from each other than two such intervals.
    """
    driver = load("egl")
    case: Case = noise_case(SIZE, PLANS[name])
    drawn = driver.run(case.plan.passes, case.textures(), case.size)["result"]
    emulator = Emulator(Rounded(), ALL_FLOAT)
    found = emulator.run(case.plan.passes, case.textures(), case.size, "half", rounding=driver.rounding)["result"]
    wanted = expected(case, driver.software, driver.rounding)["result"]
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
    infinite, 1 + 2^-11 is 1, three quarters of the smallest subnormal are that; with flush, all below 2^-14 are 0.
    """
    kept, flushed = Rounded(), Rounded(flush=True)
    one = kept.convert(1.0, HALF)
    with np.errstate(over="ignore"):
        assert kept.convert(65519.0, HALF)[0, 0] == 65504.0
        assert np.isinf(kept.convert(65520.0, HALF)[0, 0])
        assert np.isinf(kept.binary("*", kept.convert(300.0, HALF), kept.convert(300.0, HALF))[0, 0])
    assert kept.binary("+", one, 2.0**-11)[0, 0] == 1.0
    assert kept.binary("+", one, 2.0**-10)[0, 0] == 1.0 + 2.0**-10
    assert kept.convert(0.75 * 2.0**-24, HALF)[0, 0] == 2.0**-24
    assert flushed.convert(2.0**-14, HALF)[0, 0] == 2.0**-14
    assert flushed.convert(0.99 * 2.0**-14, HALF)[0, 0] == 0.0
    assert flushed.binary("*", kept.convert(0.01, HALF), kept.convert(0.005, HALF))[0, 0] == 0.0
    # what two precisions meet in is the wider one
    assert kept.binary("*", one, kept.convert(0.1, "float")).dtype == np.float32
    assert kept.binary("*", one, 0.1).dtype == np.float16


def test_a_variable_alone_is_half():
    """A choice rounds what it names: `t` of BokehMakeOffsets at 1/3 is off by half of 2^-12, all others are float."""
    chosen = Evaluator(Rounded(), Choice({"BokehMakeOffsets": frozenset(["t"])}))
    end = np.array([[1.0, 0.0]])
    found = chosen.call("BokehMakeOffsets", end, 2, 4)[0, 0]
    assert found == np.float32(np.float16(1.0 / 3.0)) and found != np.float32(1.0 / 3.0)
    assert exactly("BokehMakeOffsets", end, 2, 4)[0, 0] == 1.0 / 3.0


# ---------------------------------------------------------------------------------------------------------- the budget


def test_one_rounding_is_one_rounding(findings):
    """BokehSafeChannel passes a colour on: off by 2^-11 or 2^-24 of it at most."""
    (row,) = (row for row in findings.budget if row.domain.function == "BokehSafeChannel")
    assert 0.9 * 2.0**-11 <= row.half.largest <= 2.0**-11 * (1 + 1e-9)
    assert row.float32.largest <= 2.0**-24 * (1 + 1e-9)


def test_what_may_be_half_is_within_the_limits(findings):
    """choice.LIMITS: every function with its allowed variables half, at MaxCoC 0.1; nothing overflows."""
    for row in findings.budget:
        if row.domain.function in MAY_BE_HALF and not row.domain.note.startswith("MaxCoC"):
            assert row.chosen.lost == 0.0, row.domain
            assert row.chosen.largest <= LIMITS[row.domain.unit], row.domain


def test_what_must_be_float_exceeds_them(findings):
    """A function that is not allowed as a whole overflows or is over its limit when half as a whole.

    But BokehMakeOffsets, whose places are good enough by themselves: choice.py says why. And the leakage weights, whose
    threshold the drawn inputs do not hit: half a bias of 0.02 and the weight is another one beside it.
    """
    within = set()
    for row in findings.budget:
        name = row.domain.function
        if MAY_BE_HALF.get(name) != WHOLE and row.half.lost == 0.0 and row.half.largest <= LIMITS[row.domain.unit]:
            within.add(name)
    assert within == {"BokehDefaultFilter", "BokehMakeOffsets", "BokehLeakageWeight", "BokehSignedLeakageWeight"}
    frame = frames.frame("paper, adaptive")
    assert frame.outcome(Choice({"BokehFilter": frozenset(["bleedingBias"])})).moved > 1.0


def test_half_noise_is_none():
    """In the last corner of a 4K frame a half uv has 67 columns and 59 rows of a block's 128, and a seed of 256 and
    more has steps of 1/4, so that at most 4 values are left: not noise.
    """
    y, x = np.mgrid[0:128, 0:128]
    corner = np.array(frames.FRAME) - 128
    uv = (np.stack([x.ravel(), y.ravel()], axis=1) + 0.5 + corner) / np.array(frames.FRAME)
    given = [uv, np.array([frames.FRAME], float), 1.0, 0.0]
    wanted, found, half = (
        budget.called(numbers, choice, "BokehNoise", given).ravel()
        for numbers, choice in ((Rounded(np.float64), ALL_FLOAT), (Rounded(), ALL_FLOAT), (Rounded(), ALL_HALF))
    )
    assert np.corrcoef(found, wanted)[0, 1] > 0.99
    assert len(np.unique(half)) <= 4 and np.corrcoef(half, wanted)[0, 1] < 0.1


# ---------------------------------------------------------------------------------------------------------- the frames


def test_allowed_halves_keep_the_picture(findings):
    """Whole methods with all that is allowed half at once: no sample a quarter of a pixel off, nothing lost, and 60 dB:
    an rms error of 0.001, a quarter of an 8-bit step. All half: off by a pixel and more, below 40 dB.
    """
    for name, half, chosen in findings.methods:
        assert chosen.lost == 0.0 and chosen.moved <= 0.25 and chosen.psnr >= 60.0, name
        assert half.moved > 1.0 and half.psnr < 40.0, name
    assert sum(half.lost > 0.0 for _, half, _ in findings.methods) >= 3


# (function, variable, method): what must be float, half by itself
HARMFUL = [
    ("main", "BokehUV", "exact"),
    ("BokehExactFirst", "uv", "exact"),
    ("BokehExactSecond", "uv", "exact"),
    ("BokehLineSum", "first", "exact"),
    ("BokehLineSum", "sum", "exact"),
    ("BokehDepthOfField", "sampleCoords", "paper"),
    ("BokehDepthOfField", "color", "paper"),
    ("BokehDepthOfFieldAdaptive", "sampleCoords", "paper, adaptive"),
    ("BokehNaiveGather", "sampleCoords", "naive"),
    ("BokehNaiveGrid", "sampleCoords", "naive-grid"),
]


@pytest.mark.parametrize(("function", "name", "method"), HARMFUL)
def test_what_is_said_to_be_float_must_be(function, name, method):
    """uv, every sum of uv and something, and the sums of colours: each alone moves a sample by more than an eighth of a
    pixel or loses pixels. choice.py allows none of them.
    """
    outcome = frames.frame(method, frames.SMALL).outcome(Choice({function: frozenset([name])}))
    assert outcome.moved > 0.125 or outcome.lost > 0.0, outcome
    assert ALLOWED.of(function, name) != HALF


def test_flushing_changes_no_frame():
    """Colours of lamps and CoC of pixels are far above 2^-14: flushed or kept, the allowed halves do the same."""
    frame = frames.frame("exact", frames.SMALL)
    assert frame.outcome(ALLOWED, flush=True).psnr == pytest.approx(frame.outcome(ALLOWED).psnr, abs=1.0)


# --------------------------------------------------------------------------------------------------------- the targets


def test_step_of_a_stored_coc():
    """validation/precision.md: a half step of the CoC is 2^-10 of it at most, and moves the farthest sample by less
    than 1/1200 of the CoC; the farthest samples are where it says.
    """
    coc = np.arange(2.0**-10, 1.0, 1e-5)
    assert (np.spacing(coc.astype(np.float16)).astype(float) / coc.astype(np.float16)).max() == 2.0**-10
    said = {6: 0.57, 8: 0.71, 10: 0.79}
    for sides, farthest in said.items():
        edges = [segments.polygon_edge(k, sides, 0.0, 1.0, True) for k in range(2, sides // 2 + 1)]
        found = max(np.hypot(*(edge.middle + end * edge.half)) for edge in edges for end in (-1, 1))
        assert found == pytest.approx(farthest, abs=0.005)
        assert found * 2.0**-10 < 1 / 1200


def test_small_formats():
    """R11G11B10F keeps 6, 6 and 5 bits of mantissa: rounded to nearest, off by 2^-7, 2^-7 and 2^-6 at most; no sign.
    RGBA8 has 255 steps, so that a CoC is off by 1/510 of the height, half a step of 8.5 pixels at 2160 rows.
    """
    values = np.random.default_rng(1).uniform(0.01, 60000.0, (20, 30, 4))
    off = np.abs(stored(values, "r11g11b10") / values - 1.0)[..., :3].max(axis=(0, 1))
    # half a step of the half float that it is rounded to before
    assert (off <= np.array([2.0**-7, 2.0**-7, 2.0**-6]) + 2.0**-11).all()
    assert (off > np.array([2.0**-8, 2.0**-8, 2.0**-7])).all()
    assert (stored(-values, "r11g11b10")[..., :3] == 0.0).all()
    assert np.abs(stored(values / 60000.0, "rgba8") - values / 60000.0).max() <= 1 / 510


# -------------------------------------------------------------------------------------------------------- the document


def test_document_says_what_is_measured(findings):
    """Every table of the section is what the command prints: words alike, numbers to 10 %: two digits are rounded by
    up to 5 %, and sin and cos of another processor may differ in a last bit.
    """
    text = (paths.ROOT / "validation/precision.md").read_text(encoding="utf-8")
    section = text[text.index("## Precision") :]
    shown = [line for line in section.splitlines() if line.startswith("|")]
    printed = [line for line in table.markdown(findings) if line]
    assert len(shown) == len(printed)
    number = re.compile(r"(?<![\w`])-?\d+(?:\.\d+)?(?:e-?\d+)?(?!\w)")
    for line, wanted in zip(shown, printed, strict=True):
        assert number.sub("#", line) == number.sub("#", wanted)
        values = [np.array(number.findall(each), float) for each in (line, wanted)]
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
    """`precision mediump float` in front of the library relaxes nothing; without the library's own line it would."""
    head = f"#version 310 es\nprecision mediump float;\n#define BOKEH_PASS {shaders.glsl_pass(entry)}\n"
    own = r"^precision highp \w+;\n"
    as_is = glslang.spirv(head + shaders.text("glsl"), "frag", glslang.VULKAN)
    without = glslang.spirv(head + re.sub(own, "", shaders.text("glsl"), flags=re.MULTILINE), "frag", glslang.VULKAN)
    assert as_is.ok and without.ok, as_is.messages + without.messages
    assert relaxed(as_is.binary) == 0
    assert relaxed(without.binary) > 0


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


def test_reads_of_depth_must_be_float():
    """Depth beyond 65504 m is infinite as a half: that of the sky, which BokehCoCMap has at 1000000000 m."""
    assert ALLOWED.of(FETCHES[0], RETURNED) == HALF and ALLOWED.of(FETCHES[1], RETURNED) != HALF
    found = Evaluator(Rounded(), ALL_HALF).call("BokehCoC", np.array([1e9]), 0.05, 0.05, 5.0, 0.024, 0.1)
    assert np.isnan(found).all()
