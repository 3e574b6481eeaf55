"""Draw the WGSL that Slang compiles from the HLSL: it must be within the reference's interval in every pass.

WGSL is used, because naga misreads the nested loops in Slang's SPIR-V; DXC's SPIR-V has different ones.
"""

import re
from dataclasses import replace

import pytest
from support import needed
from support_cases import within
from support_inputs import COMPILED, inputs

from bokeh_validation.compilers import dxc, slang, spirv
from bokeh_validation.drivers.webgpu import DXC
from bokeh_validation.truth import ray_traced

pytestmark = inputs(*COMPILED, "validation/tests/shaders/test_slang.py")

# a part of the ray-traced scene with something in focus, near and far
PART = (slice(206, 270), slice(264, 344))
# Slang's bindings -> the package's, which have the sampler between the textures
PLACES = {0: spirv.REGISTERS["b0"], 9: spirv.REGISTERS["s0"]}
PLACES |= {1 + register: spirv.REGISTERS[f"t{register}"] for register in range(8)}


def of_slang(source: str, stage: str, entry: str) -> str:
    """Return the WGSL of a program that must compile, with the package's bindings."""
    result = slang.build(source, stage, entry, "wgsl")
    assert result.ok, result.messages
    return re.sub(r"@binding\((\d+)\)", lambda found: f"@binding({PLACES[int(found[1])]})", result.binary.decode())


@pytest.fixture(scope="module")
def driver():
    """Return the driver of DXC's SPIR-V, using Slang's WGSL instead."""
    with pytest.MonkeyPatch.context() as patch, needed("Slang"):
        slang.load()
        patch.setattr(dxc, "kept_spirv", of_slang)
        yield DXC()


@pytest.mark.parametrize(
    ("method", "aperture"), [("layered", "hexagon"), ("layered", "decagon"), ("exact", "hexagon"), ("paper", "octagon")]
)
def test_scene(driver, method, aperture):
    """Compare a part of a ray-traced scene with the reference."""
    case = ray_traced.scene_case(ray_traced.DRIVER_SCENES[0], method, aperture)
    case = replace(case, color=case.color[PART].copy(), depth=case.depth[PART].copy())
    _, comparison = within(driver, case)
    assert comparison.ok, comparison
