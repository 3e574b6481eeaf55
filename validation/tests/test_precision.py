"""Half precision: the evaluator against the reference and a device, the error budget, docs/inputs.md, compilers."""

import re
import struct

import numpy as np
import pytest
from conftest import load
from test_drivers import noise_case

from bokeh_validation import methods, metrics, paths, shaders
from bokeh_validation.compilers import fxc, glslang
from bokeh_validation.drivers import reference
from bokeh_validation.half import domain, frames, program, table
from bokeh_validation.half.choice import ALLOWED, LIMITS, MAY_BE_HALF, WHOLE
from bokeh_validation.half.emulator import Emulator, stored
from bokeh_validation.half.evaluate import ALL_FLOAT, ALL_HALF, FETCHES, RETURNED, Choice, Evaluator
from bokeh_validation.half.numbers import HALF, Bounds, Rounded
from bokeh_validation.patterns.model import Case, expected
from bokeh_validation.reference import listings, segments
from bokeh_validation.reference.precision import FLOAT_STEP

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
    """The budget, the noise or a method runs every function of sections [3] to [9]; MAY_BE_HALF names variables."""
    library = program.library()
    reached = {item.function for item in domain.DOMAINS} | {"BokehNoise"}
    entries = {item.entry for settings in PLANS.values() for item in methods.plan(settings, SIZE).passes}
    waiting = [program.main(entry).body for entry in entries]
    while waiting:
        new = _calls(waiting.pop()) & set(library) - reached
        reached |= new
        waiting += [library[name].body for name in new]
    assert reached == set(library), set(library) - reached
    for name, variables in MAY_BE_HALF.items():
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
    "BokehLeakageWeight": lambda sd, sc, cd, cc, bias, mult: listings.leakage_weight(sd, sc, cd, cc, bias, mult),
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
                axis = np.array([[np.cos(0.3), np.sin(0.3)]])
                found = exactly("BokehPolygonEdge", float(k), float(sides), axis, 0.7, second)[0]
                assert np.allclose(found, [*wanted.middle, *wanted.half], atol=10 * 3.6e-9)
            assert np.isclose(
                exactly("BokehExactWeight", float(k), float(sides))[0, 0], segments.weight(k, sides), atol=10 * 3.6e-9
            )
    wanted = segments.line_segment(0.4, 0.8, (0.1, -0.2), 0.7)
    found = exactly("BokehSegment", 0.4, 0.8, np.array([[0.1, -0.2]]), 0.7)[0]
    assert np.allclose(found, [*wanted.middle, *wanted.half], atol=EXACT)
    y, x = np.mgrid[0 : SIZE[1], 0 : SIZE[0]] + 0.5
    uv = np.stack([x.ravel() / SIZE[0], y.ravel() / SIZE[1]], axis=1)
    noise = exactly("BokehNoise", uv, float(SIZE[0]), float(SIZE[1]), 70.0)
    assert np.allclose(noise[:, 0], segments.noise(SIZE, 70.0)[0].ravel(), atol=1e-11)


@pytest.mark.parametrize("name", PLANS)
def test_float64_passes_are_the_reference(name, monkeypatch):
    """Whole methods, nothing rounded between the passes, to 1e-12 of the largest value.

    Along segments to 3.4e-7, by the steepest slope, twice the largest value a texel. The shaders' pi of 9 digits is
    off by 3.6e-9 of the CoC (0.1 of 41 rows), times 3 edges and 2 passes: 1e-7. The reference counts in pixels, the
    shaders in uv with an aspect ratio given in float32: 2^-24 of half a CoC, 2 pixels: 2.4e-7.
    """
    monkeypatch.setattr(reference, "stored", lambda image, dtype, rounding: image)
    case = noise_case(SIZE, PLANS[name])
    wanted = reference.Reference().images(case.plan.passes, case.textures(), case.size)["result"].value
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


def test_errors_are_within_the_derived_bound(findings):
    """Input by input, half and float32: measured <= the bound of the running error analysis (numbers.Bounds)."""
    for row in findings.budget:
        assert (row.half.each <= row.bound.each).all(), row.domain
        assert (row.float32.each <= row.float_bound.each).all(), row.domain


@pytest.mark.parametrize("item", domain.DOMAINS, ids=lambda item: f"{item.function} {item.note}".strip())
def test_flushed_errors_are_within_the_derived_bound(item):
    """The same with subnormals flushed, where every operation may lose 2^-14."""
    arguments = item.arguments(np.random.default_rng(3), 500)
    exact = exactly(item.function, *arguments)
    found = Evaluator(Rounded(flush=True), ALL_HALF).call(item.function, *arguments).astype(np.float64)
    bound = Evaluator(Bounds(HALF, flush=True), ALL_HALF).call(item.function, *arguments).error
    off = np.abs(found - exact)
    assert (np.where(np.isfinite(off), off, np.inf) <= bound).all()


def test_a_bound_of_one_rounding_is_one_rounding(findings):
    """BokehSafeChannel passes a colour on: off by 2^-11 or 2^-24 of it at most, and the bound says no more."""
    (row,) = (row for row in findings.budget if row.domain.function == "BokehSafeChannel")
    assert row.bound.largest <= 2.0**-11 * (1 + 1e-9)
    assert row.half.largest >= 0.9 * 2.0**-11
    assert row.float_bound.largest <= FLOAT_STEP * (1 + 1e-9)


def test_what_may_be_half_is_within_the_limits(findings):
    """choice.LIMITS: every function with its allowed variables half, at MaxCoC 0.1; nothing overflows."""
    for row in findings.budget:
        if row.domain.function in MAY_BE_HALF and not row.domain.note.startswith("MaxCoC"):
            assert row.chosen.lost == 0.0, row.domain
            assert row.chosen.largest <= LIMITS[row.domain.unit], row.domain


def test_what_must_be_float_exceeds_them(findings):
    """A function that is not allowed as a whole overflows or is over its limit when half as a whole.

    But the two whose places are good enough by themselves: choice.py says why, and the last line shows it. And
    BokehLeakageWeight, whose threshold the drawn inputs do not hit: its bound is the whole weight.
    """
    within = set()
    for row in findings.budget:
        name = row.domain.function
        if MAY_BE_HALF.get(name) != WHOLE and row.half.lost == 0.0 and row.half.largest <= LIMITS[row.domain.unit]:
            within.add(name)
    assert within == {"BokehMakeOffsets", "BokehCell", "BokehLeakageWeight"}
    assert next(r for r in findings.budget if r.domain.function == "BokehLeakageWeight").bound.largest > 0.9
    assert frames.frame("paper, adaptive").outcome(Choice({"BokehCell": frozenset(WHOLE)})).moved > 0.5


def test_noise(findings):
    """float32 is the noise of float64, half is not: in the last corner uv has 67 columns and 59 rows of a block's 128,
    and a seed of 256 and more has steps of 1/4, so that at most 4 values are left.
    """
    by = {(row.where, row.precision): row for row in findings.noise}
    for where in ("first", "last"):
        assert by[where, "float32"].correlation > 0.99
        assert by[where, "half"].correlation < 0.9
    assert by["last", "half"].values <= 4


# ---------------------------------------------------------------------------------------------------------- the frames


def test_allowed_halves_keep_the_picture(findings):
    """Whole methods with all that is allowed half at once: no sample a quarter of a pixel off, nothing lost, and 60 dB:
    an rms error of 0.001, a quarter of an 8-bit step. All half: off by a pixel and more, below 40 dB.
    """
    for name, half, chosen in findings.methods:
        assert chosen.lost == 0.0 and chosen.moved <= 0.25 and chosen.psnr >= 60.0, name
        assert half.moved > 1.0 and half.psnr < 40.0, name
    assert sum(half.lost > 0.0 for _, half, _ in findings.methods) >= 3


def test_no_allowed_variable_is_harmful(findings):
    """Each allowed variable half by itself is harmless; uv and every place in uv are not."""
    assert [f"{row.function} {row.name}" for row in findings.variables if row.allowed and not row.harmless] == []
    harmful = {row.name for row in findings.variables if not row.harmless}
    assert {"BokehUV", "uv", "sampleCoords", "middle", "rowCoords", "color"} <= harmful


def test_uv_is_off_by_half_a_step(findings):
    """BokehLineMean's uv reads no pixel itself: a half there moves samples by 2^-12 of 3840 pixels, 0.94, at most."""
    moved = next(r.outcome.moved for r in findings.variables if (r.function, r.name) == ("BokehLineMean", "uv"))
    assert 0.5 < moved <= 2.0**-12 * frames.FRAME[0] + 1e-3


def test_flushing_changes_no_frame():
    """Colours of lamps and CoC of pixels are far above 2^-14: flushed or kept, the allowed halves do the same."""
    frame = frames.frame("exact", frames.SMALL)
    assert frame.outcome(ALLOWED, flush=True).psnr == pytest.approx(frame.outcome(ALLOWED).psnr, abs=1.0)


# --------------------------------------------------------------------------------------------------------- the targets


def test_step_of_a_stored_coc():
    """docs/inputs.md: a half step of the CoC is 2^-10 of it at most, and moves the farthest sample by less than 1/1200
    of the CoC; the farthest samples are where it says.
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
    up to 5 %, and sin and cos of another processor may turn a last bit.
    """
    text = (paths.ROOT / "docs/inputs.md").read_text(encoding="utf-8")
    section = text[text.index("## Precision") :]
    shown = [line for line in section.splitlines() if line.startswith("|")]
    printed = [line for line in table.markdown(findings) if line]
    assert len(shown) == len(printed)
    number = re.compile(r"(?<![\w`])-?\d+(?:\.\d+)?(?:e-?\d+)?(?!\w)")
    for line, wanted in zip(shown, printed, strict=True):
        assert number.sub("#", line) == number.sub("#", wanted)
        values = [np.array(number.findall(each), float) for each in (line, wanted)]
        assert np.allclose(*values, rtol=0.1, atol=0.01 if "corner" in shown[0] else 0.0), (line, wanted)


# ------------------------------------------------------------------------------------------------------- the compilers


def test_libraries_have_no_half():
    """No word in any of the three that makes a variable 16 bits; comments may have it."""
    for language in paths.LANGUAGES:
        for file in (paths.library(language), paths.passes(language)):
            code = re.sub(r"//.*", "", file.read_text(encoding="ascii"))
            found = re.findall(r"\b(?:half\d?|min\w+float\d?|float16_t\d?|mediump|lowp|f16|vec\dh)\b", code)
            assert not found, f"{file.name}: {found}"


@pytest.mark.parametrize("entry", shaders.ENTRIES)
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
