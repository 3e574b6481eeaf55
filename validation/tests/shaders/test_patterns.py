"""Every probe on every driver, and that the probes notice what they are there for."""

from dataclasses import replace

import numpy as np
import pytest
from support import load

from bokeh_validation import methods, patterns
from bokeh_validation.patterns import impulse, model
from bokeh_validation.reference.device import Reference


@pytest.mark.parametrize("probe", patterns.PROBES, ids=lambda p: p.name)
def test_probe(probe, driver):
    """Within the interval of the reference, and showing what it must."""
    result = patterns.run(probe, driver)
    assert not [f"{c.name}: {c.value:.5g}, allowed {c.low:.5g} .. {c.high:.5g}" for c in result.checks if not c.ok]
    assert not [str(c) for r in result.cases for c in r.comparisons.values() if not c.ok]


def test_quick_probes():
    """All probes under their names; the exact polygons, which have fewer rotations there, show what they must."""
    assert [probe.name for probe in patterns.QUICK_PROBES] == [probe.name for probe in patterns.PROBES]
    fewer = [probe for probe in patterns.QUICK_PROBES if probe not in patterns.PROBES]
    assert {probe.name for probe in fewer} == {f"exact-{aperture}" for aperture in methods.EXACT}
    for probe in fewer:
        assert patterns.run(probe, load("egl")).ok, probe.name


def judged(probe: patterns.Probe, **changes) -> list[patterns.Check]:
    """The checks of a probe rendered by the reference with other settings than its own."""
    outputs = {}
    for case in probe.cases:
        other = replace(case, settings=replace(case.settings, **changes))
        result = Reference().run(other.plan.passes, other.textures(), other.size, keep=case.keep)
        outputs[case.label] = {name: pixels.astype(np.float64) for name, pixels in result.items()}
    return probe.judge(outputs)


@pytest.mark.parametrize("aperture", ["square", "diamond", "hexagon", "octagon", "star"])
def test_impulse_probe_notices_a_wrong_shape(aperture):
    """Any other aperture, a turn by 5 degrees, and a CoC 10 % off are noticed."""
    probe = impulse.probe(aperture)
    others = {"square": "octagon", "diamond": "square", "hexagon": "octagon", "octagon": "hexagon", "star": "square"}
    assert not all(c.ok for c in judged(replace_keep(probe), aperture=others[aperture]))
    assert not all(c.ok for c in judged(replace_keep(probe), rotation=5.0))
    assert not all(c.ok for c in judged(replace_keep(probe), coc=1.1 * impulse.COC / impulse.SIZE[1]))
    assert all(c.ok for c in judged(replace_keep(probe), rotation=0.0)[:4])


def replace_keep(probe: patterns.Probe) -> patterns.Probe:
    """The probe with its cases as they are: other apertures name their first line the same."""
    return probe


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
        assert model.expected(case, True, "zero")["result"].size == (width, 2)
        del case
