"""Check the documents against the code: their tables and names match it, and links lead somewhere.

test_paste.py runs the README's snippets.
"""

import re
from itertools import product, starmap
from math import atan, exp, inf, tan
from pathlib import Path

import pytest

from bokeh_validation import paths, plan
from bokeh_validation.frame import methods
from bokeh_validation.generate import results
from bokeh_validation.plan import fetches
from bokeh_validation.shaders.entries import EXACT


def prose(document: Path) -> str:
    """Return the text of a document without its code blocks."""
    return re.sub(r"^ *```.*?^ *```", "", document.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)


def anchors(document: Path) -> set[str]:
    """Return the anchors of a document's headings, as GitHub forms them."""
    heads = re.findall(r"^#+ (.*)$", prose(document), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


def test_links_exist():
    """Check that every relative link leads to a file, and its anchor to a heading; links in code are ignored."""
    documents = [
        path for folder in ("docs", "integration", "validation") for path in (paths.ROOT / folder).rglob("*.md")
    ]
    documents += [paths.ROOT / f"{name}.md" for name in ("README", "CHANGELOG", "CONTRIBUTING")]
    for document in documents:
        for target, anchor in re.findall(r"\]\(([^)#]*)#?([^)]*)\)", prose(document)):
            if not re.match(r"[a-z]+:", target):
                file = document.parent / target if target else document
                assert file.exists(), f"{document.name}: {target}"
                assert not anchor or anchor in anchors(file), f"{document.name}: {target}#{anchor}"


def test_fetches_of_the_readme():
    """Compare the README's fetches with the frames of a hexagon at 1920 x 1080, for each method and preset."""
    readme = (paths.ROOT / "README.md").read_text(encoding="utf-8")
    shown = re.findall(r"^\| `BOKEH_PRESET_(\w+)` \| (\d+) \| (\d+) \|$", readme, re.MULTILINE)
    assert [name.lower() for name, *_ in shown] == list(methods.PRESETS)
    for name, *numbers in shown:
        for number, method in zip(numbers, ("exact", "layered"), strict=True):
            settings = methods.Settings(method, preset=name.lower())
            counts = fetches.of_frame(methods.plan(settings, (1920, 1080)).passes)
            assert int(number) == round(counts["color"] + counts["depth"]), (name, settings.method)


def costs(method: str, aperture: str = "hexagon", preset: str = "medium", targets: bool = True) -> tuple[int, int]:
    """Return the passes of a frame as `plan` prints it, and its fetches of colour and depth per pixel."""
    planned = plan.frame(methods.Settings(method, aperture, preset=preset, use_mrt=targets), (1920, 1080))
    return len(planned["passes"]), round(sum(planned["fetches"].values()))


def test_counts_of_all_pages():
    """Check the numbers of passes and fetches on all pages.

    docs/start.md shows the counts of a frame. Elsewhere, a number of passes or fetches must belong to some frame, or to
    a pass of bokeh_lens.
    """
    start = (paths.ROOT / "docs/start.md").read_text(encoding="utf-8")
    shown = re.findall(r"^\| [^|]+ \| \*\*`(\w+)`\*\* \| (\d+) \| (\d+) \|$", start, re.MULTILINE)
    assert len(shown) == 2 and all((int(a), int(b)) == costs(method) for method, a, b in shown)
    kinds = product(("exact", "layered"), EXACT, methods.PRESETS, (True, False))
    known = [*starmap(costs, kinds), *(costs(name) for name in ("paper", "naive"))]
    allowed = {"passes": {passes for passes, _ in known}, "fetches": {12, 3} | {number for _, number in known}}
    folders = (paths.ROOT / name for name in ("docs", "integration"))
    for page in (paths.ROOT / "README.md", *(path for folder in folders for path in folder.rglob("*.md"))):
        for number, kind in re.findall(r"(?<![/.\d])(\d+) (passes|fetches)\b", prose(page)):
            assert int(number) in allowed[kind], f"{page.name}: {number} {kind}"


def test_results_of_the_readme():
    """Compare the README's FLIP and light kept with docs/data, and its fetches with the presets."""

    def rows(text: str, after: str) -> dict[str, list[str]]:
        lines = re.findall(r"^\| ?([^| -].*?) ?\|$", text.split(after, 1)[1].split("\n## ")[0], re.MULTILINE)
        cells = [re.split(r" ?\| ?", line) for line in lines]
        return {label: others for label, *others in cells}

    text = (paths.ROOT / "README.md").read_text(encoding="utf-8")
    readme, measured = rows(text, "## Compared with other effects"), results.ray_traced()
    *scenes, lit = re.search(
        r"^\| \| fetches per pixel \| FLIP, (\w+) \| FLIP, (\w+) \| light kept, (\w+) \|$", text, re.MULTILINE
    ).groups()
    assert len(readme) == 9
    for preset in ("medium", "mobile"):
        assert rows(text, "## Presets")[f"`BOKEH_PRESET_{preset.upper()}`"][1] == readme[f"layered {preset}"][0]
    for label, (_, *numbers) in readme.items():
        flips = [f"{measured[label][scene]['flip']:.4f}" for scene in scenes]
        assert numbers == [*flips, f"{measured[label][lit]['light']:.3f}"], label


def test_engines_of_the_readme():
    """Check that the README lists the engines of integration/README.md with the same methods, and says which were
    never run.
    """
    text = (paths.ROOT / "README.md").read_text(encoding="utf-8")
    table = (paths.ROOT / "integration/README.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| \[.+?\]\((\w+/README\.md)\)[^|]*\| ([^|]*) \| ([^|]*) \|$", table, re.MULTILINE)
    shown = re.findall(r"^\| \[.+?\]\(integration/(\w+/README\.md)\)([^|]*)\| ([^|]*) \|", text, re.MULTILINE)
    expected = {guide: (methods, "compile-checked" in version) for guide, version, methods in rows}
    assert {guide: (methods, "compile-checked" in more) for guide, more, methods in shown} == expected
    assert len(expected) >= 18


def test_readme_shows_the_sample():
    """Check that the README's lines for three.js are in the sample that test_engines.py runs."""
    text = (paths.ROOT / "README.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"^```js\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    assert block in (paths.ROOT / "integration/threejs/webgl.js").read_text(encoding="utf-8")


# Symptom in docs/troubleshooting.md -> the tests that prevent it in this package. Problems without an entry
# can only be caused by a user's own engine.
KEPT = {
    "The image is upside down, or": "test_drivers::test_scenes, test_viewport::test_nothing_leaks_in",
    "Everything is soft, even in focus": "test_invalid_input::test_in_focus_nothing_changes",
    "Everything is soft in D": "test_invalid_input::test_in_focus_nothing_changes, test_within::test_every_entry",
    "`layered` blurs near objects but not far ones": "test_engines::test_sample",
    "Everything is blurred by the same amount": "test_inputs::test_same_depth_from_every_convention",
    "Focus and blur are swapped": "test_inputs::test_same_depth_from_every_convention, "
    "test_inputs::test_ends_of_the_range",
    "The sky is a wall of light": "test_invalid_input::test_bad_pixels_count_as_documented",
    "Highlights are wider": "test_within::test_sizes, test_apertures::test_highlight_on_a_driver",
    "The polygon is rotated": "test_apertures::test_regular, test_character::test_tiling",
    "The blur has another size at another resolution": "test_invariance::test_resolution_and_aspect_ratio",
    "There are copies": "test_continuity::test_coc_sweep, test_continuity::test_a_small_highlight_keeps_its_light",
    "There are blocks around highlights": "test_engines::test_sample",
    "There are [stars": "test_exact::test_light_on_float_targets, "
    "test_pictures::test_pictures_are_those_of_the_document",
    "Bokeh is dull, no brighter than a wall": "test_engines::test_sample",
    "There is a black or white square, and it may grow": "test_invalid_input::test_damage_is_confined",
    "There are white squares": "test_highp::test_highp_wins_over_mediump, test_highp::test_libraries_have_no_half",
    "Outlines tremble though nothing moves": "test_steady::test_stands_still",
    "A sharp object has": "test_probes::test_probes_notice",
    "In `exact` with your own CoC map, a blurred near object is opaque": "test_paste::test_the_chain_runs",
    "A blurred object has [a hard edge": (
        "test_probes::test_probes_notice, test_layers::test_layered_aspect_and_presets"
    ),
    "A contour shows where the blur begins": "test_continuity::test_coc_sweep",
    "WebGPU expects a filterable float": "test_paste::test_the_chain_runs",
    "`#error BOKEH_NUM_SAMPLES must": "test_configuration::test_hlsl, test_configuration::test_glsl",
    "It compiles, but a loop never stops early": "test_windows::test_a_break_that_is_never_taken",
    "Garbage appears": "test_viewport::test_nothing_leaks_in",
    "The blur pops while the focus is pulled": "test_continuity::test_coc_sweep",
    "Small moving lights flicker": "test_continuity::test_a_small_highlight_keeps_its_light",
    "Noise stands still": "test_exact::test_every_frame_and_pass_has_its_own_noise",
}
# Problems of other packages that this one cannot show -> the tests that prevent them
KEPT_AWAY = {
    "a bright Y in the hexagon, from double seams or wrong weights": "test_exact::test_light_on_float_targets",
    "another size at another quality": "test_invariance::test_presets_never_change_the_size",
    "gradients in branches or loops": "test_compile::test_no_sample_takes_its_level_from_derivatives",
    "more samplers than shader model 3 has": "test_compile::test_accepted",
    "helpers whose names clash, comments that end in a backslash": "test_parity::test_the_checkout_passes",
    "black pixels where every sample is rejected, 0 / 0": "test_drivers::test_every_sample_rejected",
}


def test_pitfalls_have_tests():
    """Check that the page has every entry of KEPT, and that the tests named in both tables exist."""
    text = (paths.ROOT / "docs/troubleshooting.md").read_text(encoding="utf-8")
    for seen in KEPT:
        assert re.search(rf"^\* \*\*\[?{re.escape(seen)}", text, re.MULTILINE), seen
    for names in (KEPT | KEPT_AWAY).values():
        for file, name in (named.split("::") for named in names.split(", ")):
            source = next(paths.VALIDATION.rglob(f"{file}.py")).read_text(encoding="utf-8")
            assert re.search(rf"^(?:    )?def {name}\(", source, re.MULTILINE), f"{file}::{name}"


# ----------------------------------------------------------------------------------------------------------------------
# docs/lens.md: its code, run
# ----------------------------------------------------------------------------------------------------------------------

LENS_PAGE = (paths.ROOT / "docs/lens.md").read_text(encoding="utf-8")
SENSOR = 0.024


def run(code: str, **names: float) -> dict[str, float]:
    """Run a code block of the page and return its variables; it is C, and Python without types and semicolons."""
    names |= {"tan": tan, "exp": exp, "max": max}
    exec(code.replace("float ", "").replace(";", ""), names)
    return names


LENS, PULL = re.findall(r"^```c\n(.*?)^```", LENS_PAGE, re.MULTILINE | re.DOTALL)


def test_formulas():
    """Check that f gives the field of view back, that A / f is 10 / N at a bokeh scale of 10, and that the matrix
    gives the same f.
    """
    lens = run(LENS, fovy=1.0, fStop=2.8, bokehScale=10.0, sensorHeight=SENSOR)
    assert 2.0 * atan(0.5 * SENSOR / lens["focalLength"]) == pytest.approx(1.0)
    assert lens["apertureDiameter"] * 2.8 == pytest.approx(10.0 * lens["focalLength"])
    assert "0.5 * sensorHeight * abs(P[1][1])" in LENS_PAGE
    assert 0.5 * SENSOR / tan(0.5) == pytest.approx(lens["focalLength"])


@pytest.mark.parametrize("rate", [24, 60, 144])
def test_pull(rate):
    """Check that the remaining distance is exp(-t / tau) at any frame rate, that the nearest depth is used, and that
    the sky does no harm.
    """
    pulled, tau = 1 / 10.0, 0.25
    for _ in range(rate):
        pulled = run(PULL, dt=1 / rate, tau=tau, d0=inf, d1=2.0, d2=5.0, pulled=pulled)["pulled"]
    assert 1 / 2.0 - pulled == pytest.approx((1 / 2.0 - 1 / 10.0) * exp(-1 / tau))
    assert f"After 3 tau, {100 * exp(-3):.0f} % of the way to the target remains" in LENS_PAGE
