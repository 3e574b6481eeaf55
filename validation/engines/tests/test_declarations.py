"""Check that the .d.ts files of the npm package declare exactly the options and uniforms of its JavaScript."""

import re

from bokeh_validation import paths

WEB = paths.ROOT / "integration/web"


def members(file: str, interface: str) -> set[str]:
    """Return the names that an interface itself declares, ignoring comments."""
    text = re.sub(r"/\*.*?\*/", "", (WEB / file).read_text(encoding="utf-8"), flags=re.DOTALL)
    body = re.search(rf"interface {interface}\b[^{{]*\{{\n(.*?)^\}}", text, re.MULTILINE | re.DOTALL)[1]
    return set(re.findall(r"^  (\w+)\??: ", body, re.MULTILINE))


def keys(file: str, name: str) -> set[str]:
    """Return the names in an object `const NAME = { .. }`, including those one level deeper."""
    text = re.sub(r"//.*", "", (WEB / file).read_text(encoding="utf-8"))
    body = re.search(rf"const {name} = \{{(.*?)\}};", text, re.DOTALL)[1]
    return set(re.findall(r"(\w+):", body))


def extras() -> set[str]:
    """Return the uniforms in EXTRAS, without the names of the extras."""
    text = (WEB / "common.js").read_text(encoding="utf-8")
    body = re.search(r"const EXTRAS = \{\n(.*?)^\};", text, re.MULTILINE | re.DOTALL)[1]
    return {name for inner in re.findall(r"\{(.*?)\}", body) for name in re.findall(r"(\w+):", inner)}


def test_options():
    """Check the options of all engines against CHOICES, and three.js's own options against THREE_CHOICES."""
    assert members("common.d.ts", "Options") == keys("common.js", "CHOICES")
    assert members("three-common.d.ts", "ThreeOptions") == keys("three-common.js", "THREE_CHOICES")


def test_uniforms():
    """Check the uniforms that users set."""
    assert members("common.d.ts", "Lens") == keys("common.js", "LENS") | extras()


def strings(file: str, name: str) -> set[str]:
    """Return the strings in a list `const NAME = [ .. ];`."""
    text = (WEB / file).read_text(encoding="utf-8")
    return set(re.findall(r"'(\w+)'", re.search(rf"const {name} = \[(.*?)\];", text)[1]))


def test_react():
    """Check the properties that the React components take in addition to uniforms: options, properties of the lens,
    and their own.
    """
    options = members("common.d.ts", "Options") | members("three-common.d.ts", "ThreeOptions")
    lens, react = strings("react-common.js", "OTHERS"), {"ref"}
    assert strings("react.js", "OPTIONS") == options
    # a uniform of the pass, like every property that is left over
    assert members("react.d.ts", "PolygonBokehProps") - {"debugMode"} == lens | react
    node = members("three-webgpu.d.ts", "NodeOptions")
    assert strings("react-webgpu.js", "OPTIONS") == options | node
    own = {"before", "after"}
    assert f"OPTIONS, {sorted(own, reverse=True)})" in (WEB / "react-webgpu.js").read_text(encoding="utf-8")
    assert members("react-webgpu.d.ts", "PolygonBokehProps") == node | react | own
    omitted = re.search(r"Omit<Lens, (.*?)>", (WEB / "react.d.ts").read_text(encoding="utf-8"))[1]
    assert strings("react-common.js", "OF_LENS") == set(re.findall(r"\w+", omitted))


def test_engine_options():
    """Check that Babylon.js's additional options are in its JavaScript's list, and that PlayCanvas has only the common
    ones.
    """
    text = (WEB / "babylon.js").read_text(encoding="utf-8")
    choices = re.search(r"\{\s*\.\.\.CHOICES,(.*?)\}", text, re.DOTALL)[1]
    assert members("babylon.d.ts", "BabylonOptions") == set(re.findall(r"(\w+):", choices))
    assert "options?: Options)" in (WEB / "playcanvas.d.ts").read_text(encoding="utf-8")
    assert "...CHOICES" not in (WEB / "playcanvas.js").read_text(encoding="utf-8")
