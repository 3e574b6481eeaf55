"""Every probe in one of the languages, and that probes notice what they are there for."""

from itertools import cycle

import pytest
from support import LANGUAGES
from support_cases import judged

from bokeh_validation import probes as patterns
from bokeh_validation.frame import methods
from bokeh_validation.probes import impulse, model
from bokeh_validation.reference import precision

PROBES = {probe.name: probe for probe in patterns.QUICK_PROBES}


@pytest.mark.parametrize(("name", "driver"), list(zip(PROBES, cycle(LANGUAGES))), indirect=["driver"])
def test_probe(name, driver):
    """Within the interval of the reference, and showing what it must."""
    result = patterns.run(PROBES[name], driver)
    assert not [f"{c.name}: {c.value:.5g}, allowed {c.low:.5g} .. {c.high:.5g}" for c in result.checks if not c.ok]
    assert not [str(c) for r in result.cases for c in r.comparisons.values() if not c.ok]


@pytest.mark.parametrize("aperture", ["square", "diamond", "hexagon", "octagon", "star"])
def test_impulse_probe_notices_a_wrong_shape(aperture):
    """Any other aperture, a turn by 5 degrees, and a CoC 10 % off are noticed."""
    probe = impulse.probe(aperture)
    other = {"square": "octagon", "diamond": "square", "hexagon": "octagon", "octagon": "hexagon", "star": "square"}
    for changes in ({"aperture": other[aperture]}, {"rotation": 5.0}, {"coc": 1.1 * impulse.COC / impulse.SIZE[1]}):
        assert not all(c.ok for c in judged(probe, **changes)), changes
    assert all(c.ok for c in judged(probe, rotation=0.0)[:4])


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("leakage", {"leak_fix": False}),
        ("leakage", {"leak_fix": True}),
        ("silhouette", {"coc": 0.1}),
        ("coc-blur", {"blur_coc": True}),
        ("coc-blur", {"blur_coc": False}),
        ("coc", {"coc": 0.1}),
    ],
)
def test_scene_probes_notice(name, changes):
    """A switch that does nothing, and a CoC that does not follow depth."""
    probe = next(p for p in patterns.PROBES if p.name == name)
    assert not all(check.ok for check in judged(probe, **changes))


def test_reference_is_kept_by_content():
    """Images of another size or content must not share a kept reference, even where one is freed for the next."""
    for width in (3, 5, 3, 8):
        case = model.Case("", methods.Settings(coc=0.1), model.flat((width, 2), 1.0), model.depth_of((width, 2), 1.0))
        assert model.expected(case, precision.SOFTWARE, "zero")["result"].size == (width, 2)
        del case
