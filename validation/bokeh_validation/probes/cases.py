"""Name settings of a frame and tag them with the tests and commands that use them.

Tests and commands choose settings by tag. The images come from elsewhere: coverage_frames.py, or the test itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from bokeh_validation.frame import methods
from bokeh_validation.frame.methods import Camera, Settings
from bokeh_validation.probes import near_edges

# Every entry except BokehLinearDepth, BokehDebug and BokehStableMap, with parameters away from their defaults
ENTRIES = "entries"
# Drawn by `check` and by mutants: every entry, and every switch and branch that settings can reach
COVERAGE = "coverage"
# Also drawn by `check` and mutants as an image inside larger textures
PART = "part"
# Drawn as an image inside textures of NaN: test_viewport.py
VIEWPORT = "viewport"
# The lens's character and the focus controls, drawn on every driver: test_within.py
LENS = "lens"
# Given colour and depth that no renderer should supply: test_invalid_input.py
BAD_INPUT = "bad input"
# Compared pass by pass with images in the repository: test_expected.py
EXPECTED = "expected"
# Drawn by the test's own small engine from the frame's JSON: test_frame.py
JSON = "json"


@dataclass(frozen=True)
class NamedSettings:
    """Hold settings with their name and tags."""

    name: str
    settings: Settings
    tags: frozenset[str]


# Every parameter away from its default
ALL = {
    "rotation": 17.0,
    "squeeze": 0.7,
    "bleeding_bias": 0.03,
    "bleeding_mult": 30.0,
    "camera": Camera(0.12, 0.05, 4.0, sensor_height=0.02, max_coc=0.25),
}
# The spacing differs from every preset's; otherwise an unread parameter would go unnoticed
ADAPTIVE = {"spacing": 1.25, "jitter": 1.0, "frame": 61}
CUT = {"cats_eye": 0.7, "roundness": 0.5}
FOCUS = methods.Focus((0.5, 1.0), (0.75, 0.5), (0.0625, 0.03125))
WIDE = {"camera": Camera(1.8, 0.05, 8.0, max_coc=0.5)}  # near and far layers of up to 25 pixels in 50 rows
WIDEST = {"camera": Camera(1.8, 0.05, 8.0, max_coc=1.0)}
# far CoC of at most 9.5 pixels in 50 rows: no layer, and one more ring than the preset has
MODERATE = {"camera": Camera(1.8, 0.05, 8.0, max_coc=0.19), "focus": methods.Focus(scale=(0.0, 1.0))}
PAPER, EXACT = Settings("paper", "hexagon", 5, **ALL), Settings("exact", "hexagon", 5, **ALL)
# layered does not read the number of samples, but a driver compiles its programs again for each: always give 7
LAYERED = Settings("layered", "hexagon", 7, jitter=0.5, frame=3, **ALL)
CAMERA = Camera(0.1, 0.05, 4.0, max_coc=0.3)
# fills both layers: near CoC of up to 25 pixels, far CoC of up to 17
BOTH_FULL = Camera(3.3, 0.05, 8.0, max_coc=0.9)
# CoC in pixels with a layer weight between 0 and 1, or that barely spread. A near layer begins between 6 and 12
# pixels, with its weight ramping from 8.4 to 9.6; a far layer between 10 and 16, ramping from 12.4 to 13.6. -9 and 13
# are in the middle of the ramps.
PLANES = (-11.0, -9.0, 3.0, 11.0, 13.0, 14.0)
WIDE_PLANES = (-90.0, 60.0, 90.0)


def _named(name: str, tags: Sequence[str], base: Settings, **changes: object) -> NamedSettings:
    tags = {*tags, *([COVERAGE] if ENTRIES in tags else [])}
    return NamedSettings(name, replace(base, **changes), frozenset(tags))


CASES = (
    _named("paper hexagon", [ENTRIES, PART, VIEWPORT, BAD_INPUT], PAPER),
    _named("paper star", [ENTRIES, BAD_INPUT, JSON], PAPER, aperture="star", blur_coc=False),
    _named("paper pentagon", [ENTRIES, PART, VIEWPORT, BAD_INPUT], PAPER, aperture="pentagon", **ADAPTIVE),
    _named("paper triangle", [BAD_INPUT], PAPER, aperture="triangle"),
    _named("constant CoC", [ENTRIES, PART, VIEWPORT], PAPER, coc=0.2),
    _named("naive", [ENTRIES, PART, VIEWPORT, BAD_INPUT, JSON], PAPER, method="naive", aperture="triangle", samples=6),
    _named("naive grid", [ENTRIES, PART, VIEWPORT, BAD_INPUT], PAPER, method="naive-grid", aperture="square"),
    _named("exact square", [ENTRIES], EXACT, aperture="square", **ADAPTIVE),
    _named("exact hexagon", [ENTRIES, VIEWPORT, BAD_INPUT], EXACT, **ADAPTIVE),
    _named("exact octagon", [ENTRIES, VIEWPORT], EXACT, aperture="octagon", **ADAPTIVE),
    _named("exact decagon", [ENTRIES, PART, VIEWPORT, BAD_INPUT], EXACT, aperture="decagon", **ADAPTIVE),
    _named(
        "exact decagon, one target",
        [ENTRIES, PART, VIEWPORT, BAD_INPUT, JSON],
        EXACT,
        aperture="decagon",
        use_mrt=False,
        **ADAPTIVE,
    ),
    _named("exact, preset", [ENTRIES, VIEWPORT, BAD_INPUT], EXACT, samples=None),
    _named("lateral", [ENTRIES, PART, VIEWPORT, JSON, LENS], EXACT, lateral=0.02),
    # wide settings first: the passes that blur a layer run only if there is one
    _named("layered square", [ENTRIES, VIEWPORT], LAYERED, aperture="square", **WIDE),
    _named("layered hexagon", [ENTRIES, PART, VIEWPORT, BAD_INPUT], LAYERED, **WIDE),
    _named("layered octagon", [ENTRIES], LAYERED, aperture="octagon", **WIDE),
    _named("layered decagon", [ENTRIES, VIEWPORT, JSON], LAYERED, aperture="decagon", **WIDE),
    _named(
        "layered, one target",
        [ENTRIES, VIEWPORT, BAD_INPUT, JSON],
        LAYERED,
        aperture="octagon",
        preset="ultra",
        use_mrt=False,
        **WIDE,
    ),
    _named("naive, many", [COVERAGE], PAPER, method="naive", aperture="square", samples=12),
    # lines whose samples reach only a part of them
    _named("exact square, wide", [COVERAGE], EXACT, aperture="square", samples=9, **WIDE),
    _named("exact hexagon, wide", [COVERAGE], EXACT, samples=9, **WIDE),
    _named("exact square, cut", [COVERAGE, LENS], EXACT, aperture="square", **CUT, **ADAPTIVE),
    _named("exact hexagon, cut", [COVERAGE, VIEWPORT, LENS], EXACT, **CUT, **ADAPTIVE),
    _named("exact octagon, cut", [COVERAGE, JSON, LENS], EXACT, aperture="octagon", **CUT, **ADAPTIVE),
    _named("exact decagon, cut", [COVERAGE, LENS], EXACT, aperture="decagon", **CUT, **ADAPTIVE),
    _named("exact, focus", [COVERAGE, LENS], EXACT, focus=FOCUS),
    _named("exact octagon, cut too far", [COVERAGE], EXACT, aperture="octagon", cats_eye=5.0, roundness=-1.0),
    _named("exact decagon, cut, one target", [COVERAGE], EXACT, aperture="decagon", use_mrt=False, **CUT, **ADAPTIVE),
    _named("lateral, too much", [COVERAGE], EXACT, lateral=5.0),
    _named("lateral, too little", [COVERAGE], EXACT, lateral=-5.0),
    _named("constant CoC, too large", [COVERAGE], PAPER, coc=0.4),
    _named("constant CoC, negative", [COVERAGE], EXACT, coc=-0.1),
    _named("layered square, narrow", [COVERAGE], LAYERED, aperture="square"),
    _named("layered hexagon, narrow", [COVERAGE], LAYERED),
    _named("layered octagon, narrow", [COVERAGE], LAYERED, aperture="octagon"),
    _named("layered decagon, narrow", [COVERAGE], LAYERED, aperture="decagon"),
    _named("layered, moderate", [COVERAGE], LAYERED, preset="ultra", **MODERATE),
    # without BOKEH_SIDES, so that one loop gathers all rings
    _named("layered, moderate, cut", [COVERAGE], LAYERED, preset="high", cats_eye=0.9, **MODERATE),
    _named("layered, wide", [COVERAGE], LAYERED, jitter=1.0, **WIDE),
    _named("layered, far", [COVERAGE], LAYERED, focus=methods.Focus(scale=(0.0, 1.0)), **WIDE),
    _named("layered, low", [COVERAGE, BAD_INPUT], LAYERED, aperture="decagon", preset="low", **WIDE),
    # a square, where a ring without a density would have fewer samples; by unrolled rings, and by the loop
    _named("layered, mobile", [COVERAGE, BAD_INPUT], LAYERED, aperture="square", preset="mobile", **WIDE),
    _named("layered, mobile, cut", [COVERAGE], LAYERED, aperture="square", preset="mobile", cats_eye=0.9, **MODERATE),
    _named("layered, widest", [COVERAGE], LAYERED, aperture="square", preset="low", **WIDEST),
    _named("layered, cut", [COVERAGE, PART, VIEWPORT, JSON], LAYERED, aperture="octagon", **CUT, **WIDE),
    _named("layered decagon, cut", [COVERAGE], LAYERED, aperture="decagon", cats_eye=0.9, **WIDE),
    _named("layered, cut, one target", [COVERAGE], LAYERED, aperture="octagon", use_mrt=False, **CUT, **WIDE),
    _named(
        "hexagon", [EXPECTED], Settings("layered", "hexagon", camera=BOTH_FULL, jitter=1.0, squeeze=0.7, rotation=10.0)
    ),
    _named("less", [EXPECTED], Settings("layered", "hexagon", camera=replace(BOTH_FULL, aperture_diameter=1.8))),
    _named("little", [EXPECTED], Settings("layered", "hexagon", camera=CAMERA)),
    _named("square", [EXPECTED], Settings("layered", "square", camera=BOTH_FULL, preset="low", jitter=1.0)),
    _named(
        "octagon cut",
        [EXPECTED],
        Settings("layered", "octagon", camera=BOTH_FULL, cats_eye=0.7, roundness=0.5, preset="high"),
    ),
    _named(
        "decagon",
        [EXPECTED],
        Settings("layered", "decagon", camera=BOTH_FULL, preset="low", rotation=20.0, frame=3, jitter=0.5),
    ),
    _named(
        "decagon, one target",
        [EXPECTED],
        Settings("layered", "decagon", camera=BOTH_FULL, preset="ultra", use_mrt=False),
    ),
    _named(
        "octagon, cut, one target",
        [EXPECTED],
        Settings("layered", "octagon", camera=BOTH_FULL, use_mrt=False, cats_eye=0.9),
    ),
    _named("slope", [EXPECTED], near_edges.settings(rotation=10.0)),
    *(_named(f"plane {coc}", [EXPECTED], near_edges.settings(rotation=10.0)) for coc in PLANES),
    *(_named(f"wide {coc}", [EXPECTED], near_edges.settings()) for coc in WIDE_PLANES),
    _named("wide square", [EXPECTED], near_edges.settings("square", jitter=1.0)),
)


def tagged(tag: str, camera: Camera | None = None) -> dict[str, Settings]:
    """Return name -> settings with a tag, optionally with another camera."""
    found = {case.name: case.settings for case in CASES if tag in case.tags}
    return {name: replace(settings, camera=camera) for name, settings in found.items()} if camera else found


# ----------------------------------------------------------------------------------------------------------------------
# one or two parameters at a time: test_within.py
# ----------------------------------------------------------------------------------------------------------------------

PLAIN = ("paper", "exact", "naive", "naive-grid")
# for every method except layered
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
    {"use_mrt": False},
    {"samples": 4, "jitter": 0.5},
    {"spacing": 1.0, "use_mrt": False, "jitter": 1.0, "samples": 6},
    # squeezed edges differ in length and sample count, but each line must still be weighted by its area
    {"coc": 0.5, "camera": Camera(max_coc=1.0), "spacing": 1.0, "squeeze": 0.3, "rotation": 20.0},
]
CUTS = [
    {},
    {"use_mrt": False},
    {"rotation": 17.0, "squeeze": 0.6},
    {"spacing": 1.0, "samples": 5, "jitter": 1.0, "frame": 3},
    {"cats_eye": 0.3, "spacing": 1.0},
    {"cats_eye": 5.0},
]
# far layers of 25 pixels, wide enough for the lengths of the edges to show
WIDE_FAR = Camera(0.4, 0.05, 4.0, max_coc=0.5)
CUT_LAYERS = [
    {"rotation": 17.0},
    {"aperture": "square", "squeeze": 0.5},
    # Mesa takes half a minute to compile these passes; with jitter they are the programs of "layered, cut, one target"
    {"aperture": "octagon", "use_mrt": False, "rotation": 5.0, "jitter": 1.0, "frame": 3},
    {"aperture": "decagon"},
    {"camera": WIDE_FAR, "rotation": 17.0, "cats_eye": 0.9},
    {"camera": WIDE_FAR, "aperture": "decagon", "use_mrt": False, "cats_eye": 0.9},
]
# A focus between the depths: near CoC up to 25 pixels in 50 rows, far CoC up to 17, so that both layers are full
FULL = Camera(1.8, 0.05, 8.0, max_coc=0.5)
FULL_LAYERS = [
    {"jitter": 1.0, "squeeze": 0.7},
    {"aperture": "decagon", "preset": "low", "jitter": 0.5, "rotation": 20.0},
    {"aperture": "decagon", "preset": "ultra", "use_mrt": False},
    {"aperture": "square", "preset": "high", "use_mrt": False, "rotation": 5.0},
    {"camera": CAMERA, "preset": "high", "jitter": 1.0, "frame": 3},
    {"camera": CAMERA, "coc": 0.25, "squeeze": 1.5, "rotation": -30.0},
    {"camera": CAMERA, "coc": 0.05, "preset": "low"},
    {"camera": CAMERA, "coc": 0.0},
    # edges with fewer samples than texels
    {"aperture": "square", "preset": "low", "jitter": 1.0, "camera": replace(FULL, max_coc=1.0)},
]


def _settings_of(base: Settings, changes: list[dict]) -> list[Settings]:
    """Return the base settings with each of the changes; exact has no star and takes a decagon instead."""
    shapes = [{k: "decagon" if v == "star" and base.method == "exact" else v for k, v in c.items()} for c in changes]
    return [replace(base, **change) for change in shapes]


def _of_polygons(changes: list[dict], **common) -> list[Settings]:
    """Return the exact method for every polygon with each of the changes."""
    bases = (Settings("exact", aperture, **{"camera": CAMERA, **common}) for aperture in methods.EXACT)
    return [settings for base in bases for settings in _settings_of(base, changes)]


def _exact_and_layered(**common) -> list[Settings]:
    """Return settings of both methods for an octagon, the polygon whose roundness can be changed."""
    return [Settings(method, "octagon", 7, camera=CAMERA, rotation=10.0, **common) for method in ("exact", "layered")]


NOISY = {"coc": 0.5, "camera": Camera(max_coc=1.0), "samples": 3, "spacing": 1.0, "jitter": 1.0, "frame": 5}
# Group -> settings to draw on random patches of colour and depth, each with some parameters away from their defaults
SWEEPS = {
    **{method: _settings_of(Settings(method, "hexagon", camera=ALL["camera"]), COMMON) for method in PLAIN},
    **{
        f"lines of paper {shape}": _settings_of(Settings("paper", shape, camera=CAMERA), [*LINES, {"squeeze": 0.5}])
        for shape in ("hexagon", "star", "triangle", "pentagon")
    },
    **{
        f"lines of exact {shape}": _settings_of(Settings("exact", shape, camera=CAMERA), [*LINES, *POLYGONS])
        for shape in ("hexagon", "decagon")
    },
    # few samples on a wide blur, so that the random offsets matter in every pass
    "jitter": _of_polygons([{}, {"use_mrt": False}], **NOISY),
    "cat's eye": _of_polygons(CUTS, cats_eye=0.7),
    "cat's eye, layered": _settings_of(Settings("layered", "hexagon", 7, camera=CAMERA, cats_eye=0.7), CUT_LAYERS),
    "curved blades": [
        settings
        for roundness in (0.5, 0.0, -1.0)
        for amount in (0.0, 0.7)
        for settings in _exact_and_layered(roundness=roundness, cats_eye=amount)
        if settings.method == "exact" or amount > 0.0
    ],
    # blur on both sides of the focus, then only behind it, then only in front of it; last, everything that layers need
    "focus": [
        Settings(method, "hexagon", 7, camera=CAMERA, spacing=0.0, focus=focus)
        for method in ("paper", "exact", "layered")
        for focus in (FOCUS, replace(FOCUS, scale=(0.0, 2.0)), replace(FOCUS, scale=(2.0, 0.0)))
    ],
    # amounts beyond 0.1 are clamped to it
    "lateral colour": _settings_of(
        Settings("exact", "hexagon", camera=CAMERA), [{"lateral": 0.02}, {"lateral": -0.1}, {"lateral": 5.0}]
    ),
    "lateral colour, layered": [Settings("layered", "hexagon", 7, camera=CAMERA, lateral=0.03)],
    "full layers": _settings_of(Settings("layered", "hexagon", 7, camera=FULL), FULL_LAYERS),
}


# ----------------------------------------------------------------------------------------------------------------------
# an image inside larger textures: test_viewport.py
# ----------------------------------------------------------------------------------------------------------------------

IN_VIEWPORT = Camera(0.12, 0.05, 4.0, max_coc=0.3)
# Size of the textures, and the rectangle: off-centre and with another aspect ratio, so that a wrong corner, size or row
# order shows
SIZE, RECTANGLE = (90, 74), (24, 8, 48, 37)
WIDE_EXACT = Settings("exact", "hexagon", camera=replace(IN_VIEWPORT, max_coc=1.0))
IN_RECTANGLE = tagged(VIEWPORT, IN_VIEWPORT)
# Name -> settings, size of the textures, and the image's rectangle in them
VIEWPORTS = {
    **{name: (settings, SIZE, RECTANGLE) for name, settings in IN_RECTANGLE.items()},
    # The whole texture, a corner, and each polygon, so that every entry of layered draws into one. The smallest is
    # more than 8 pixels wide and high, because a target of one eighth that is one texel wide has no room for the inset
    **{
        name: (replace(IN_RECTANGLE["layered hexagon"], **changes), SIZE, rectangle)
        for name, changes, rectangle in (
            ("layered, whole", {}, (0, 0, 90, 74)),
            ("layered square, a corner", {"aperture": "square"}, (8, 24, 40, 30)),
            ("layered octagon, last corner", {"aperture": "octagon", "use_mrt": False}, (40, 16, 50, 58)),
            ("layered decagon, smallest", {"aperture": "decagon"}, (72, 56, 11, 9)),
        )
    },
    # The smallest image, the whole texture, its last corner, and positions far from uv 0, where float32 is coarsest
    "smallest": (WIDE_EXACT, (9, 7), (3, 2, 2, 2)),
    "whole": (WIDE_EXACT, (9, 7), (0, 0, 9, 7)),
    "last corner": (WIDE_EXACT, (9, 7), (8 - 3, 7 - 5, 3, 5)),
    "far right": (WIDE_EXACT, (4096, 5), (4096 - 40, 1, 33, 3)),
    "far down": (WIDE_EXACT, (5, 4096), (1, 4096 - 40, 3, 33)),
    "farthest": (WIDE_EXACT, (8192, 4), (8192 - 33, 0, 33, 3)),
}
