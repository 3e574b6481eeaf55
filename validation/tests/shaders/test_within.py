"""Settings on random patches of colour and depth: every driver is within the interval of the reference."""

from dataclasses import replace

import pytest
from support import LANGUAGES, NIGHTLY, load, nightly, spread
from support_cases import CAMERA, noise_case, within

from bokeh_validation.frame import methods
from bokeh_validation.frame.methods import Settings
from bokeh_validation.probes import judges, small_frames
from bokeh_validation.probes.small_frames import ALL, ENTRY_SETTINGS, FOCUS
from bokeh_validation.shaders.entries import ENTRIES

PLAIN = ("paper", "exact", "naive", "naive-grid")
# What the lens's character and the focus controls need of a compiler
LENS = {
    **{f"cat's eye {k}": Settings("exact", k, cats_eye=0.7, roundness=0.5, **ALL) for k in methods.EXACT},
    "focus": Settings("exact", "hexagon", camera=CAMERA, focus=FOCUS),
    "lateral colour": Settings("exact", "hexagon", camera=CAMERA, lateral=0.02),
}


@pytest.mark.parametrize("method", ["paper", "naive", "exact", "layered"])
def test_every_entry(method, driver):
    """Every program of the package on every driver, everything away from its default."""
    for settings in ENTRY_SETTINGS.values():
        if settings.method.startswith(method):
            within(driver, noise_case((45, 29), settings))


def test_every_entry_is_there():
    """In those frames, but for the entries of test_inputs.py, test_drivers.py and test_steady.py."""
    drawn = {item.entry for settings in ENTRY_SETTINGS.values() for item in methods.plan(settings, (61, 37)).passes}
    assert drawn | {"BokehLinearDepth", "BokehDebug", "BokehStableMap"} == set(ENTRIES)


@pytest.mark.parametrize("name", [pytest.param(name, marks=nightly) for name in NIGHTLY])
def test_character(name):
    """The lens's character on the drivers that the tables below leave out."""
    for settings in LENS.values():
        within(load(name), noise_case((61, 48), settings))


@spread("size", [(61, 37), (1, 1), (3, 2), (1, 2048), (2048, 1), (257, 33)], [(61, 37)])
def test_sizes(size, driver):
    """Odd, tiny and thin images; of layered, targets of half, a quarter and an eighth that are not filled.

    A CoC of 0.02 is 41 texels high in the longest column.
    """
    camera = replace(CAMERA, max_coc=0.02) if max(size) > 1000 else CAMERA
    for method in PLAIN:
        within(driver, noise_case(size, Settings(method, "hexagon", camera=camera)))
    within(driver, noise_case(size, Settings("exact", "hexagon", 5, camera=camera, spacing=1.0, jitter=1.0)))
    within(driver, noise_case(size, Settings("layered", "hexagon", 7, camera=camera, targets=min(size) > 2)))


# ----------------------------------------------------------------------------------------------------------------------
# tables of settings, in each language
# ----------------------------------------------------------------------------------------------------------------------

# of every method but layered
COMMON = [
    {"samples": 2},
    {"samples": 3},
    {"samples": 8},
    {"samples": 40},
    {"rotation": 17.0},
    {"blur_coc": False},
    {"leak_fix": False},
    {"bleeding_bias": 0.0},
    {"bleeding_bias": 0.1},
    {"bleeding_mult": 2.0},
    {"coc": 0.2},
    {"coc": 0.9},
    {"coc": 0.0},
    {"squeeze": 0.5, "rotation": 20.0},
    {"aperture": "star", "rotation": -30.0},
    {"aperture": "octagon", "blur_coc": False},
    {"aperture": "square", "samples": 4, "leak_fix": False},
]
LINES = [
    {"spacing": 1.0},
    {"spacing": 0.7, "samples": 8},
    {"spacing": 1.5, "samples": 4, "jitter": 1.0, "frame": 61},
    {"spacing": 1.0, "squeeze": 0.5, "rotation": 12.0},
    {"spacing": 1.0, "blur_coc": False},
]
POLYGONS = [
    {"targets": False},
    {"samples": 4, "jitter": 0.5},
    {"spacing": 1.0, "targets": False, "jitter": 1.0, "samples": 6},
    # squeezed edges have different lengths and numbers of samples: each line is worth its area all the same
    {"coc": 0.5, "camera": methods.Camera(max_coc=1.0), "spacing": 1.0, "squeeze": 0.3, "rotation": 20.0},
]
CUT = [
    {},
    {"targets": False},
    {"rotation": 17.0, "squeeze": 0.6},
    {"spacing": 1.0, "samples": 5, "jitter": 1.0, "frame": 3},
    {"cats_eye": 0.3, "spacing": 1.0},
    {"cats_eye": 5.0},
]
# far layers of 25 pixels, where the lengths of the edges show
WIDE = methods.Camera(0.4, 0.05, 4.0, max_coc=0.5)
CUT_LAYERS = [
    {"rotation": 17.0},
    {"aperture": "square", "squeeze": 0.5},
    {"aperture": "octagon", "targets": False, "rotation": 5.0},
    {"aperture": "decagon", "jitter": 1.0, "frame": 3},
    {"camera": WIDE, "rotation": 17.0, "cats_eye": 0.9},
    {"camera": WIDE, "aperture": "decagon", "targets": False, "cats_eye": 0.9},
]
# A focus between the depths: near CoC up to 25 pixels of 50 rows, far ones up to 17, so that both layers are full
FULL = methods.Camera(1.8, 0.05, 8.0, max_coc=0.5)
FULL_LAYERS = [
    {"jitter": 1.0, "squeeze": 0.7},
    {"aperture": "decagon", "preset": "low", "jitter": 0.5, "rotation": 20.0},
    {"aperture": "decagon", "preset": "ultra", "targets": False},
    {"aperture": "square", "preset": "high", "targets": False, "rotation": 5.0},
    {"camera": CAMERA, "preset": "high", "jitter": 1.0, "frame": 3},
    {"camera": CAMERA, "coc": 0.25, "squeeze": 1.5, "rotation": -30.0},
    {"camera": CAMERA, "coc": 0.05, "preset": "low"},
    {"camera": CAMERA, "coc": 0.0},
    # edges with fewer samples than texels
    {"aperture": "square", "preset": "low", "jitter": 1.0, "camera": replace(FULL, max_coc=1.0)},
]


def settings_of(base: Settings, changes: list[dict]) -> list[Settings]:
    """A method with each of the changes; exact has no star."""
    shapes = [{k: "decagon" if v == "star" and base.method == "exact" else v for k, v in c.items()} for c in changes]
    return [replace(base, **change) for change in shapes]


def of_polygons(changes: list[dict], **common) -> list[Settings]:
    """The exact method in every polygon with each of the changes."""
    bases = (Settings("exact", aperture, **{"camera": CAMERA, **common}) for aperture in methods.EXACT)
    return [settings for base in bases for settings in settings_of(base, changes)]


def exact_and_layered(**common) -> list[Settings]:
    """Both, in an octagon, which is what blades can be curved of."""
    return [Settings(method, "octagon", 7, camera=CAMERA, rotation=10.0, **common) for method in ("exact", "layered")]


NOISY = {"coc": 0.5, "camera": methods.Camera(max_coc=1.0), "samples": 3, "spacing": 1.0, "jitter": 1.0, "frame": 5}
GROUPS = {
    **{method: settings_of(Settings(method, "hexagon", camera=ALL["camera"]), COMMON) for method in PLAIN},
    **{
        f"lines of paper {shape}": settings_of(Settings("paper", shape, camera=CAMERA), [*LINES, {"squeeze": 0.5}])
        for shape in ("hexagon", "star", "triangle", "pentagon")
    },
    **{
        f"lines of exact {shape}": settings_of(Settings("exact", shape, camera=CAMERA), [*LINES, *POLYGONS])
        for shape in ("hexagon", "decagon")
    },
    # few samples on a wide blur, so that the noise acts in every pass
    "jitter": of_polygons([{}, {"targets": False}], **NOISY),
    "cat's eye": of_polygons(CUT, cats_eye=0.7),
    "cat's eye, layered": settings_of(Settings("layered", "hexagon", 7, camera=CAMERA, cats_eye=0.7), CUT_LAYERS),
    "curved blades": [
        settings
        for roundness in (0.5, 0.0, -1.0)
        for amount in (0.0, 0.7)
        for settings in exact_and_layered(roundness=roundness, cats_eye=amount)
        if settings.method == "exact" or amount > 0.0
    ],
    # a side that is turned off, and what layers are made of
    "focus": [
        Settings(method, "hexagon", 7, camera=CAMERA, spacing=0.0, focus=focus)
        for method in ("paper", "exact", "layered")
        for focus in (FOCUS, replace(FOCUS, scale=(0.0, 2.0)), replace(FOCUS, scale=(2.0, 0.0)))
    ],
    # too large amounts are 0.1
    "lateral colour": settings_of(
        Settings("exact", "hexagon", camera=CAMERA), [{"lateral": 0.02}, {"lateral": -0.1}, {"lateral": 5.0}]
    ),
    "lateral colour, layered": [Settings("layered", "hexagon", 7, camera=CAMERA, lateral=0.03)],
    "full layers": settings_of(Settings("layered", "hexagon", 7, camera=FULL), FULL_LAYERS),
}


@pytest.mark.parametrize("group", GROUPS)
@pytest.mark.parametrize("driver", LANGUAGES, indirect=True)
def test_settings(group, driver, request):
    """Every parameter of the shaders away from its default: each setting in one language, in all of them with --all."""
    languages = 1 if request.config.getoption("--all") else len(LANGUAGES)
    first = (list(GROUPS).index(group) + LANGUAGES.index(driver.name)) % languages
    for settings in GROUPS[group][first::languages]:
        _, comparison = within(driver, noise_case((75, 50) if settings.method == "layered" else (61, 48), settings))
        if driver.software and group in PLAIN:
            assert comparison.close >= 0.98, (settings, comparison)


# Beside frames of settings: planes in part in a layer, near over far, black beside bright, many tiles, one pixel
IMAGES = ("plane", "near over far", "cones", "ragged", "black", "large", "layered, one pixel", "layered, not blurred")


@pytest.mark.parametrize("driver", LANGUAGES, indirect=True)
def test_images_of_layered(driver):
    """Images that take a branch of their own: those that check and mutants draw.

    And 1 / (1 / 122), which is more than 122 in float32: rounded up without a care, half of it would be 62 texels.
    """
    frames = small_frames.all_frames()
    for label in (label for label in frames if label.startswith(IMAGES)):
        for judge in judges.judges(label, frames[label], driver.precision, driver.rounding):
            assert not judge.objection(driver)
    within(driver, noise_case((122, 24), Settings("layered", "hexagon", 7, camera=CAMERA)))
