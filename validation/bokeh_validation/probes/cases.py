"""Named settings of a frame, tagged with what uses them.

Tests and commands choose by tag. Images are another matter: coverage_frames.py, and each test's own.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from bokeh_validation.frame import methods
from bokeh_validation.frame.methods import Camera, Settings
from bokeh_validation.probes import near_edges

# Every entry but BokehLinearDepth, BokehDebug and BokehStableMap, with the parameters away from their defaults
ENTRIES = "entries"
# Drawn by `check` and by mutants: the entries, and every switch and branch that settings reach
COVERAGE = "coverage"
# Drawn by `check` and mutants as a part of larger textures too
PART = "part"
# Drawn with NaN around a part of the textures: test_viewport.py
VIEWPORT = "viewport"
# Given colour and depth that no renderer should hand over: test_invalid_input.py
BAD_INPUT = "bad input"
# Held pass by pass to pictures in the repository: test_expected.py
EXPECTED = "expected"
# Drawn by an engine of the test's own from the frame as JSON: test_frame.py
JSON = "json"


@dataclass(frozen=True)
class NamedSettings:
    """Settings with a name and the tags that they are chosen by."""

    name: str
    settings: Settings
    tags: frozenset[str]


# Away from every default
ALL = {
    "rotation": 17.0,
    "squeeze": 0.7,
    "bleeding_bias": 0.03,
    "bleeding_mult": 30.0,
    "camera": Camera(0.12, 0.05, 4.0, sensor_height=0.02, max_coc=0.25),
}
# The spacing is no preset's: with one of those it would not show that nobody reads the parameter
ADAPTIVE = {"spacing": 1.25, "jitter": 1.0, "frame": 61}
CUT = {"cats_eye": 0.7, "roundness": 0.5}
FOCUS = methods.Focus((0.5, 1.0), (0.75, 0.5), (0.0625, 0.03125))
WIDE = {"camera": Camera(1.8, 0.05, 8.0, max_coc=0.5)}  # near and far layers of up to 25 pixels of 50
WIDEST = {"camera": Camera(1.8, 0.05, 8.0, max_coc=1.0)}
PAPER, EXACT = Settings("paper", "hexagon", 5, **ALL), Settings("exact", "hexagon", 5, **ALL)
LAYERED = Settings("layered", "hexagon", 5, jitter=0.5, frame=3, **ALL)
CAMERA = Camera(0.1, 0.05, 4.0, max_coc=0.3)
# both layers full: near CoC of up to 25 pixels, far ones of up to 17
BOTH_FULL = Camera(3.3, 0.05, 8.0, max_coc=0.9)
# a CoC that is in part in a layer, or spreads a little, pixels: a near layer sets in from 6 to 12, its share is between
# none and all from 8.4 to 9.6; a far one sets in from 10 to 16, its share from 12.4 to 13.6. One in the middle of each.
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
    _named("lateral", [ENTRIES, PART, VIEWPORT, JSON], EXACT, lateral=0.02),
    # wide first: what blurs a layer runs only where there is one
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
    _named("exact square, cut", [COVERAGE], EXACT, aperture="square", **CUT, **ADAPTIVE),
    _named("exact hexagon, cut", [COVERAGE, VIEWPORT], EXACT, **CUT, **ADAPTIVE),
    _named("exact octagon, cut", [COVERAGE, JSON], EXACT, aperture="octagon", **CUT, **ADAPTIVE),
    _named("exact decagon, cut", [COVERAGE], EXACT, aperture="decagon", **CUT, **ADAPTIVE),
    _named("exact, focus", [COVERAGE], EXACT, focus=FOCUS),
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
    _named("layered, wide", [COVERAGE], LAYERED, jitter=1.0, **WIDE),
    _named("layered, far", [COVERAGE], LAYERED, focus=methods.Focus(scale=(0.0, 1.0)), **WIDE),
    _named("layered, low", [COVERAGE, BAD_INPUT], LAYERED, aperture="decagon", preset="low", **WIDE),
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
    """Return the settings with a tag by name, with another camera where one is given."""
    found = {case.name: case.settings for case in CASES if tag in case.tags}
    return {name: replace(settings, camera=camera) for name, settings in found.items()} if camera else found


# ----------------------------------------------------------------------------------------------------------------------
# one or two parameters at a time: test_within.py
# ----------------------------------------------------------------------------------------------------------------------

PLAIN = ("paper", "exact", "naive", "naive-grid")
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
    {"use_mrt": False},
    {"samples": 4, "jitter": 0.5},
    {"spacing": 1.0, "use_mrt": False, "jitter": 1.0, "samples": 6},
    # squeezed edges have different lengths and numbers of samples: each line is worth its area all the same
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
# far layers of 25 pixels, where the lengths of the edges show
WIDE_FAR = Camera(0.4, 0.05, 4.0, max_coc=0.5)
CUT_LAYERS = [
    {"rotation": 17.0},
    {"aperture": "square", "squeeze": 0.5},
    {"aperture": "octagon", "use_mrt": False, "rotation": 5.0},
    {"aperture": "decagon", "jitter": 1.0, "frame": 3},
    {"camera": WIDE_FAR, "rotation": 17.0, "cats_eye": 0.9},
    {"camera": WIDE_FAR, "aperture": "decagon", "use_mrt": False, "cats_eye": 0.9},
]
# A focus between the depths: near CoC up to 25 pixels of 50 rows, far ones up to 17, so that both layers are full
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
    """A method with each of the changes; exact has no star."""
    shapes = [{k: "decagon" if v == "star" and base.method == "exact" else v for k, v in c.items()} for c in changes]
    return [replace(base, **change) for change in shapes]


def _of_polygons(changes: list[dict], **common) -> list[Settings]:
    """The exact method in every polygon with each of the changes."""
    bases = (Settings("exact", aperture, **{"camera": CAMERA, **common}) for aperture in methods.EXACT)
    return [settings for base in bases for settings in _settings_of(base, changes)]


def _exact_and_layered(**common) -> list[Settings]:
    """Both, in an octagon, which is what blades can be curved of."""
    return [Settings(method, "octagon", 7, camera=CAMERA, rotation=10.0, **common) for method in ("exact", "layered")]


NOISY = {"coc": 0.5, "camera": Camera(max_coc=1.0), "samples": 3, "spacing": 1.0, "jitter": 1.0, "frame": 5}
# Group -> settings on random patches of colour and depth, each with some parameters away from their defaults
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
    # few samples on a wide blur, so that the noise acts in every pass
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
    # a side that is turned off, and what layers are made of
    "focus": [
        Settings(method, "hexagon", 7, camera=CAMERA, spacing=0.0, focus=focus)
        for method in ("paper", "exact", "layered")
        for focus in (FOCUS, replace(FOCUS, scale=(0.0, 2.0)), replace(FOCUS, scale=(2.0, 0.0)))
    ],
    # too large amounts are 0.1
    "lateral colour": _settings_of(
        Settings("exact", "hexagon", camera=CAMERA), [{"lateral": 0.02}, {"lateral": -0.1}, {"lateral": 5.0}]
    ),
    "lateral colour, layered": [Settings("layered", "hexagon", 7, camera=CAMERA, lateral=0.03)],
    "full layers": _settings_of(Settings("layered", "hexagon", 7, camera=FULL), FULL_LAYERS),
}
