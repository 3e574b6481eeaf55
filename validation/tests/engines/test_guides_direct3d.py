"""The guides of the Direct3D samples: their code is that of the samples, their commands those that are run."""

import re

import guides
import pytest

from bokeh_validation.engines import direct3d
from bokeh_validation.passes import PARAMETERS

NAMES = tuple(direct3d.BUILDS)
WORDS = [name.removeprefix("Bokeh") for name in PARAMETERS]


@pytest.mark.parametrize("name", NAMES)
def test_guide(name):
    """Headings, links, picture, and code from files that are built and run."""
    folder = direct3d.SAMPLES / name
    guides.assert_guide(folder)
    guides.assert_quoted(folder / "README.md", direct3d.sources(name))


@pytest.mark.parametrize("name", NAMES)
def test_build_command(name):
    """The guide builds as the tests do."""
    shown = "\n".join(block.text for block in guides.blocks(direct3d.SAMPLES / name / "README.md"))
    assert f"{direct3d.BUILDS[name].command} -o {name}.exe" in shown


@pytest.mark.parametrize("name", NAMES)
def test_package_is_not_copied(name):
    """The shaders are included from hlsl/, and defined nowhere in the sample."""
    for file in direct3d.sources(name):
        text = file.read_text(encoding="ascii")
        assert "float4 Bokeh" not in text, f"{file} defines what the package has"
    shaders = (direct3d.SAMPLES / name / "dof.hlsl").read_text(encoding="ascii")
    layers = ["bokeh_layers.hlsl"] if name == "direct3d11" else []
    wanted = ["bokeh.hlsl", *layers, "bokeh_passes.hlsl"]
    assert re.findall(r'#include "../../hlsl/(.*)"', shaders) == wanted


@pytest.mark.parametrize("name", NAMES)
def test_parameters_are_in_order(name):
    """The samples' structs have the parameters of docs/inputs.md, in its order."""
    (source,) = (file for file in direct3d.sources(name) if file.stem == "main")
    text = source.read_text(encoding="ascii")
    struct = text[text.index("    float apertureDiameter") :].partition("}")[0]
    fields = re.findall(r"(\w+)(?: = [^,;]+)?[,;]", re.sub(r"//.*", "", struct))
    # near and far are macros of Windows' headers
    assert fields == [f"z{word}" if word in ("Near", "Far") else word[0].lower() + word[1:] for word in WORDS]
