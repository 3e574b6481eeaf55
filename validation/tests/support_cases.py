"""Share images between tests, and compare a driver's result with the reference's."""

import re
from dataclasses import replace

import numpy as np
from support import load

from bokeh_validation import drivers, metrics, probes, shaders
from bokeh_validation.errors import Unavailable
from bokeh_validation.frame import methods
from bokeh_validation.probes import judges
from bokeh_validation.probes.model import Case
from bokeh_validation.shaders.passes import Pass

CAMERA = methods.Camera(0.1, 0.05, 4.0, max_coc=0.3)


def noise_case(size: tuple[int, int], settings: methods.Settings, seed: int = 1) -> Case:
    """Return random patches of HDR colour over random patches of depth: every comparison of Listing 3
    goes both ways.
    """
    random = np.random.default_rng(seed)
    width, height = size
    coarse = (height // 6 + 1, width // 6 + 1)

    def patches(values: np.ndarray) -> np.ndarray:
        return np.kron(values, np.ones((6, 6)))[:height, :width]

    color = np.ones((height, width, 4), np.float16)
    for channel in range(3):
        color[..., channel] = patches(random.lognormal(0.0, 1.0, coarse)) + 0.1 * random.random((height, width))
    depth = patches(random.uniform(1.0, 30.0, coarse)).astype(np.float32)
    return Case(f"noise {size}", settings, color, depth)


def result(driver: drivers.Driver, case: Case, storage: str = "half") -> np.ndarray:
    """Draw a case; returns the result, (H, W, 4)."""
    return driver.run(case.plan.passes, case.textures(), case.size, storage)["result"]


def float_result(driver: drivers.Driver, case: Case) -> np.ndarray:
    """Draw a case on float32 targets; returns float64. Targets are drawn one by one if the device cannot
    take several.
    """
    try:
        return result(driver, case, "float").astype(np.float64)
    except Unavailable:
        alone = replace(case, settings=replace(case.settings, use_mrt=False))
        return result(driver, alone, "float").astype(np.float64)


def everything(driver: drivers.Driver, case: Case, **changes: float) -> dict[str, np.ndarray]:
    """Draw a case with some parameters changed in every pass, but the same programs; returns all textures that are
    written.
    """
    passes = case.plan.passes
    passes = [
        replace(unchanged, parameters={**unchanged.parameters, **changes}, defines=unchanged.constants)
        for unchanged in passes
    ]
    names = [name for render_pass in passes for name in render_pass.outputs]
    return driver.run(passes, case.textures(), case.size, keep=names)


def within(driver: drivers.Driver, case: Case) -> tuple[np.ndarray, metrics.Comparison]:
    """Return the result and its comparison with the reference; fails if any target of a pass is outside
    its interval.
    """
    case_result = judges.compared(case, driver)
    outside = {name: str(comparison) for name, comparison in case_result.comparisons.items() if comparison.outside}
    assert not outside, (driver.name, outside, case.settings)
    assert np.isfinite(case_result.outputs["result"]).all()
    return case_result.outputs["result"], case_result.comparisons["result"]


def judged(probe: probes.Probe, **changes) -> list[probes.Check]:
    """Return the checks of a probe drawn with other settings than its own."""
    outputs, driver = {}, load("egl")
    for case in probe.cases:
        changed = replace(case, settings=replace(case.settings, **changes))
        pixels_by_name = driver.run(changed.plan.passes, changed.textures(), changed.size, keep=case.keep)
        outputs[case.label] = {name: pixels.astype(np.float64) for name, pixels in pixels_by_name.items()}
    return probe.judge(outputs)


def evaluated(body: str, **values: object) -> np.ndarray:
    """Run GLSL statements that write BokehResult, with the library's functions; returns RGBA. `values` are defines."""
    library = re.sub(r"\bvoid main\(\)", "void unused()", shaders.glsl("BokehConstantCoC", "330", values))
    render_pass = Pass("BokehConstantCoC", {}, "value", sources={"glsl": f"{library}void main()\n{{\n{body}\n}}\n"})
    return load("egl").run([render_pass], {}, (8, 8), "float", keep=("value",))["value"][0, 0]
