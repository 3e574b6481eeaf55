"""What Slang makes of the HLSL, drawn: its WGSL is within what the reference allows of every pass.

WGSL rather than SPIR-V, since naga reads the nested loops of Slang's SPIR-V wrongly; DXC's SPIR-V has other ones.
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
# Slang's bindings -> the package's, whose sampler stands between its textures
PLACES = {0: spirv.REGISTERS["b0"], 9: spirv.REGISTERS["s0"]}
PLACES |= {1 + register: spirv.REGISTERS[f"t{register}"] for register in range(8)}


def of_slang(source: str, stage: str, entry: str) -> str:
    """WGSL of a program that must compile, with the package's bindings."""
    result = slang.build(source, stage, entry, "wgsl")
    assert result.ok, result.messages
    return re.sub(r"@binding\((\d+)\)", lambda found: f"@binding({PLACES[int(found[1])]})", result.binary.decode())


@pytest.fixture(scope="module")
def driver():
    """The driver of DXC's SPIR-V, with Slang's WGSL instead."""
    with pytest.MonkeyPatch.context() as patch, needed("Slang"):
        slang.load()
        patch.setattr(dxc, "kept_spirv", of_slang)
        yield DXC()


@pytest.mark.parametrize(
    ("method", "aperture"), [("layered", "hexagon"), ("layered", "decagon"), ("exact", "hexagon"), ("paper", "octagon")]
)
def test_scene(driver, method, aperture):
    """A ray-traced scene."""
    case = ray_traced.scene_case(ray_traced.DRIVER_SCENES[0], method, aperture)
    case = replace(case, color=case.color[PART].copy(), depth=case.depth[PART].copy())
    _, comparison = within(driver, case)
    assert comparison.ok, comparison
