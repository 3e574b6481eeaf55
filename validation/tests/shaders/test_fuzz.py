"""Random parameters and images on every driver: finite, not negative, and within the interval of the reference.

10,000 cases are drawn for the fast drivers. Each runs on two of them, in two languages: one half in GLSL (osmesa) and
WGSL (wgpu), the other in GLSL (egl) and HLSL (dxc). The slow drivers get SLOW_CASES each.

The seed is SEED unless `validation/test validation/tests/shaders/test_fuzz.py --hypothesis-seed N` gives another
('random' is not taken: a failure could not be had again). A failure names the seed and prints the smallest case
that fails, as Python; `agrees(load(driver), Drawn(...))` runs it alone.
"""

from dataclasses import dataclass, field, replace

import hypothesis
import numpy as np
import pytest
from hostile import COLOR, DEPTH, sprinkled
from hypothesis import strategies as st
from hypothesis.configuration import set_hypothesis_home_dir
from support import load

from bokeh_validation import apertures, drivers, methods, metrics, paths
from bokeh_validation.patterns.model import Case
from bokeh_validation.reference import precision
from bokeh_validation.reference.device import Reference
from bokeh_validation.reference.images import Image
from bokeh_validation.reference.listings import MAX_COLOR

# what it keeps goes beside everything else that is kept, not into the checkout
set_hypothesis_home_dir(paths.cache_folder() / "hypothesis")

SEED = 2012
# Cases of each method for each pair of fast drivers: together 10,000
CASES = {"paper": 1800, "exact": 1900, "naive": 600, "naive-grid": 700}
PAIRS = [("osmesa", "wgpu"), ("egl", "dxc")]
SLOW = ("webgl2", "webgpu", "d3d9", "d3d11")
SLOW_CASES = 50
# Each number of samples is another program of each entry, so few: an even one, and odd ones
SAMPLES = {"paper": (2, 3, 7, 13), "exact": (2, 7), "naive": (2, 7), "naive-grid": (2, 3, 7)}
SLOW_SAMPLES = (3,)
APERTURES = {
    "paper": apertures.NAMES,
    "exact": tuple(methods.EXACT),
    "naive": ("square", "hexagon", "star", "pentagon"),
    "naive-grid": ("square", "diamond"),
}
MOST_SIDE = 24


@dataclass(frozen=True)
class Drawn:
    """A case as few numbers, so that it is drawn and printed quickly; the pixels come from the seed.

    size                  (width, height)
    spread                standard deviation of the colour's logarithm: 6 clips one in thirty at the largest half float
    bad_color, bad_depth  share of bad numbers among them
    """

    settings: methods.Settings
    size: tuple[int, int]
    seed: int
    spread: float
    bad_color: float
    bad_depth: float

    def case(self) -> Case:
        """With its pixels."""
        random = np.random.default_rng(self.seed)
        width, height = self.size
        color = np.minimum(random.lognormal(0.0, self.spread, (height, width, 4)), MAX_COLOR).astype(np.float16)
        # in focus and nearly, or nothing would be sharp enough to leak
        focus = self.settings.camera.focus_distance * np.array([1.0, random.uniform(0.9, 1.1)])
        levels = np.concatenate([random.uniform(0.2, 30.0, 3), focus])
        depth = random.choice(levels, (height, width)).astype(np.float32)
        color = sprinkled(random, color, COLOR, self.bad_color)
        return Case("drawn", self.settings, color, sprinkled(random, depth, DEPTH, self.bad_depth))


# Hypothesis likes 0, the smallest and the largest, so that most pictures would be in focus, of one pixel, or both.
# Its numbers are scattered: times an odd number, modulo 2^32, which maps the numbers below 2^32 onto themselves.
RANGE = 2**32
SCATTER = 2654435761
UNIFORM = st.integers(0, RANGE - 1).map(lambda number: number * SCATTER % RANGE / RANGE)
SPECIAL_SHARE = 1 / 8


def number(low: float, high: float, *special: float) -> st.SearchStrategy[float]:
    """A float32, as the shaders get it, evenly spread from low to high; or in one case of eight a special one."""

    def found(place: float) -> float:
        if special and place < SPECIAL_SHARE:
            return special[int(place / SPECIAL_SHARE * len(special))]
        return float(np.float32(low + (high - low) * place))

    return UNIFORM.map(found)


CAMERAS = st.builds(
    methods.Camera,
    aperture_diameter=number(0.0, 1.0, 0.0, 1e6),
    focal_length=number(0.01, 0.25),
    # before the focal length, at its largest, at infinity
    focus_distance=number(0.25, 20.0, 0.01, 0.25, 1e9),
    sensor_height=number(0.01, 0.05, 0.0),
    max_coc=number(0.0, 1.0, 0.0, 1.0),
)


def cases(method: str, samples: tuple[int, ...]) -> st.SearchStrategy[Drawn]:
    """Every setting of a method."""
    naive = method.startswith("naive")
    settings = st.builds(
        methods.Settings,
        method=st.just(method),
        aperture=st.sampled_from(APERTURES[method]),
        samples=st.sampled_from(samples),
        max_samples=st.sampled_from(samples),
        rotation=number(-360.0, 360.0),
        camera=CAMERAS,
        coc=st.one_of(st.none(), number(0.0, 1.0)),
        blur_coc=st.booleans(),
        leak_fix=st.booleans(),
        bleeding_bias=number(0.0, 0.25, 0.0),
        bleeding_mult=number(0.0, 60.0),
        spacing=st.just(0.0) if naive else st.one_of(st.just(0.0), number(0.25, 4.0)),
        jitter=st.just(0.0) if naive else st.one_of(st.just(0.0), number(0.0, 1.0)),
        frame=st.integers(0, 1000),
        squeeze=number(0.25, 2.0, 1.0),
        targets=st.booleans(),
    )
    side = UNIFORM.map(lambda place: 1 + int(MOST_SIDE * place))
    spread, share = st.sampled_from([0.5, 2.0, 6.0]), st.sampled_from([0.0, 0.02, 0.3])
    return st.builds(Drawn, settings, st.tuples(side, side), st.integers(0, 2**32 - 1), spread, share, share)


def interval(case: Case, software: bool, rounding: str) -> dict[str, Image]:
    """Every texture of the reference with the interval of a class of devices. Kept nowhere: no case comes twice."""
    kind = precision.SOFTWARE if software else precision.GPU
    return Reference().images(case.plan.passes, case.textures(), case.size, precision=kind, rounding=rounding)


def agrees(driver: drivers.Driver, drawn: Drawn, wanted: dict[str, Image] | None = None) -> None:
    """Raise AssertionError where a driver's result is not finite, negative or outside the interval."""
    case = drawn.case()
    wanted = wanted or interval(case, driver.software, driver.rounding)
    result = driver.run(case.plan.passes, case.textures(), case.size)["result"]
    # the CoC of exact is signed
    numbers = result[..., :3] if case.settings.method == "exact" else result
    assert np.isfinite(result).all() and (numbers >= 0).all(), driver.name
    comparison = metrics.compare(result, wanted["result"], driver.software)
    assert comparison.outside == 0, f"{driver.name}: {comparison}"


@dataclass
class Seen:
    """What the cases were, of each one number: or they might all be in focus, or allow anything."""

    blurred: list[bool] = field(default_factory=list)
    narrow: list[float] = field(default_factory=list)

    def add(self, wanted: dict[str, Image]) -> None:
        """A case: is some CoC above two texels, and how many intervals are below 1/16 of the brightest number?"""
        image = wanted["result"]
        self.blurred.append(bool((np.abs(wanted["coc"].value[..., 3]) * image.size[1] > 2.0).any()))
        self.narrow.append(float((image.error[..., :3] <= image.value[..., :3].max() / 16).mean()))

    def check(self) -> None:
        """At least half of the cases are blurred, and eight of ten intervals say something."""
        assert np.mean(self.blurred) > 0.5 and np.mean(self.narrow) > 0.8


def fuzz(strategy: st.SearchStrategy[Drawn], count: int, names: tuple[str, ...], seed: int) -> Seen:
    """Draw cases and run each on all the drivers. Raises AssertionError where one does not agree, or fewer ran."""
    devices = [load(name) for name in names]
    seen, ran = Seen(), 0

    @hypothesis.seed(seed)
    @hypothesis.settings(max_examples=count, deadline=None, database=None, print_blob=True)
    @hypothesis.given(strategy)
    def run(drawn: Drawn) -> None:
        nonlocal ran
        known: dict[tuple[bool, str], dict[str, Image]] = {}
        for driver in devices:
            kind = (driver.software, driver.rounding)
            if kind not in known:
                known[kind] = interval(drawn.case(), *kind)
                seen.add(known[kind])
            agrees(driver, drawn, known[kind])
        ran += 1

    try:
        run()
    except Exception as error:
        error.add_note(f"seed {seed}: again with --hypothesis-seed {seed}")
        raise
    # it stops without a word where it finds no more, and a profile or an option may have it draw fewer
    assert ran >= count, f"{ran} of {count} cases ran"
    return seen


@pytest.fixture
def seed(pytestconfig) -> int:
    """Of --hypothesis-seed, else SEED."""
    given = pytestconfig.getoption("hypothesis_seed")
    return SEED if given is None else int(given)


@pytest.mark.parametrize("names", PAIRS, ids="+".join)
@pytest.mark.parametrize("method", CASES)
def test_fast_drivers(method, names, seed):
    """10,000 cases over all methods, each on two drivers."""
    # another seed for each pair, or they would get the same cases
    seen = fuzz(cases(method, SAMPLES[method]), CASES[method], names, seed + PAIRS.index(names))
    seen.check()


@pytest.mark.parametrize("name", SLOW)
def test_slow_drivers(name, seed):
    """A few cases of every method on browsers and Direct3D."""
    strategy = st.sampled_from(list(CASES)).flatmap(lambda method: cases(method, SLOW_SAMPLES))
    fuzz(strategy, SLOW_CASES, (name,), seed + SLOW.index(name))


def test_there_are_ten_thousand():
    """What the text above says."""
    assert len(PAIRS) * sum(CASES.values()) == 10_000


def test_fewer_are_noticed(seed):
    """Hypothesis ends when there is no other case to draw: 1 is not 10."""
    settings = methods.Settings("paper", "hexagon", samples=2, max_samples=2)
    one = st.just(Drawn(settings, (1, 1), 0, 0.5, 0.0, 0.0))
    fuzz(one, 1, ("osmesa",), seed)
    with pytest.raises(AssertionError, match="1 of 10 cases ran"):
        fuzz(one, 10, ("osmesa",), seed)


# Slips of a shader, as other settings
SLIPS = {
    "angle": lambda s: {"rotation": s.rotation + 3.0},
    "squeeze": lambda s: {"squeeze": 1.05 * s.squeeze},
    "bias": lambda s: {"bleeding_bias": s.bleeding_bias + 0.2},
    "mult": lambda s: {"bleeding_mult": 0.3 * s.bleeding_mult},
    "a sample": lambda s: {"samples": s.samples + 1, "max_samples": s.max_samples + 1},
    "spacing": lambda s: {"spacing": 1.2 * s.spacing},
    "frame": lambda s: {"frame": s.frame + 1},
    "blur_coc": lambda s: {"blur_coc": not s.blur_coc},
    "leak_fix": lambda s: {"leak_fix": not s.leak_fix},
    "sensor": lambda s: {"camera": replace(s.camera, sensor_height=1.02 * s.camera.sensor_height)},
}


def test_slips_would_be_noticed(seed):
    """Each of the slips takes some of the first cases of the paper's method out of the interval."""
    noticed: set[str] = set()

    @hypothesis.seed(seed)
    @hypothesis.settings(max_examples=300, deadline=None, database=None)
    @hypothesis.given(cases("paper", SAMPLES["paper"]))
    def run(drawn: Drawn) -> None:
        case = drawn.case()
        wanted = interval(case, True, "nearest")["result"]
        for name, slip in SLIPS.items():
            if name not in noticed:
                other = replace(case, settings=replace(case.settings, **slip(case.settings)))
                result = Reference().run(other.plan.passes, other.textures(), other.size)["result"]
                if metrics.compare(result, wanted, True).outside:
                    noticed.add(name)

    run()
    assert noticed == set(SLIPS)
