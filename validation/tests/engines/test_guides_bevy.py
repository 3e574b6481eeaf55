"""The guide of integration/bevy, and its tables against the package. Needs no Bevy."""

import re

import guides
import pytest

from bokeh_validation import passes, paths, shaders
from bokeh_validation.engines import bevy

PLUGIN = bevy.SAMPLE / "src/lib.rs"


@pytest.fixture(scope="module")
def plugin():
    """The plugin's text."""
    return PLUGIN.read_text(encoding="utf-8")


def test_guide():
    """Headings, links, picture; every block is a piece of what is built."""
    guides.assert_guide(bevy.SAMPLE)
    guides.assert_picture(bevy.SAMPLE / "debug.png")
    guides.assert_quoted(bevy.SAMPLE / "README.md", bevy.sources())


def test_parameters(plugin):
    """The struct has the parameters of docs/inputs.md in their order."""
    (body,) = re.findall(r"^struct BokehParameters \{\n(.*?)^\}", plugin, re.MULTILINE | re.DOTALL)
    found = re.findall(r"(\w+): f32,", body)
    assert found == [_snake_case(name.removeprefix("Bokeh")) for name in passes.PARAMETERS]


def test_passes(plugin):
    """Every entry that the plugin names is there, and writes as many targets as it says."""
    found = re.findall(r'pass\("(\w+)_PS", &\[[^\]]*\], &\[([^\]]*)\]', plugin)
    assert len(found) > 10
    for entry, writes in found:
        assert entry in shaders.ENTRIES
        assert len(writes.split(",")) == shaders.targets(entry), entry


def test_number_of_samples(plugin):
    """The line that the plugin gives another value is in the library, once."""
    (line,) = re.findall(r'^const SAMPLES: &str = "(.*)";$', plugin, re.MULTILINE)
    assert paths.library("wgsl").read_text(encoding="ascii").count(line) == 1


def test_changed_without_a_run(monkeypatch, tmp_path):
    """Where nothing was built yet, the sample waits until somebody asks for it."""
    monkeypatch.setenv("BOKEH_CACHE", str(tmp_path))
    assert not bevy.changed()


def _snake_case(name: str) -> str:
    return re.sub(r"(?<=[a-z])([A-Z])", r"_\1", name.replace("CoC", "Coc")).lower()
