"""The lens of every integration: the formula in its source gives the focal length and aperture of docs/lens.md.

Each is read from the source and evaluated as Python, so a factor that is lost shows without the engine.
"""

import re
from math import pi, radians, tan

import pytest

from bokeh_validation import paths

# Vertical field of view in radians, f-stop
LENSES = ((0.3, 0.2), (0.9, 2.8), (1.6, 11.0))
SENSOR = 0.024
NUMBERS = r"(?<=\d)[fF]\b"
# source -> what the focal length and the aperture are there (a group each), and what its names stand for: fovy, the
# camera's element of the projection matrix (zoom), the sensor (h), the focal length (f), the f-stop (n)
SOURCES = {
    "unity/Runtime/BokehRendererFeature.cs": (
        r"values\.focalLength = (.*?);", r"values\.apertureDiameter = (.*?);",
        {r"Mathf\.Tan": "tan", r"values\.sensorHeight": "h", r"volume\.strength\.value": "1.0",
         r"values\.focalLength": "f", r"volume\.fStop\.value": "n"},
    ),
    "unreal/BokehDepthOfField/Source/BokehDepthOfField/Private/BokehViewExtension.cpp": (
        r"BokehFocalLength = (.*?);", r"BokehApertureDiameter = (.*?);",
        {r"SettingSensorHeight\.GetValueOnRenderThread\(\)": "h", r"Given->BokehFocalLength": "f", "Zoom": "zoom",
         r"SettingFStop\.GetValueOnRenderThread\(\)": "n"},
    ),
    "bevy/src/lib.rs": (
        r"let focal_length = (.*?);", r"aperture_diameter: (focal_length / f_stop), \.\.lens",
        {r"lens\.sensor_height": "h", r"\(0\.5 \* fov\)\.tan\(\)": "tan(0.5 * fovy)", "focal_length": "f",
         "f_stop": "n"},
    ),
    "wgpu/src/lens.rs": (
        r"fn focal_length.*?\{\s+(.*?)\n", r"fn aperture_diameter.*?\{\s+(.*?)\n",
        {r"self\.sensor_height": "h", r"\(0\.5 \* self\.fov_y\)\.tan\(\)": "tan(0.5 * fovy)",
         r"self\.focal_length\(\)": "f", r"self\.f_stop": "n", r"self\.bokeh_scale": "1.0"},
    ),
    "godot/addons/polygon_bokeh/polygon_bokeh.gd": (
        r"\tfocal_length = (.*)", r"aperture_diameter = (.*?),",
        {r"absf\(_camera\.get_camera_projection\(\)\.y\.y\)": "zoom", "sensor_height": "h", "focal_length": "f",
         "f_stop": "n"},
    ),
    "ogre/PolygonBokeh.h": (
        r"const float focal = (.*?);", r"uniforms\[\"BokehApertureDiameter\"\] = (.*?);",
        {r"uniforms\[\"BokehSensorHeight\"\]": "h", r"std::tan": "tan",
         r"camera->getFOVy\(\)\.valueRadians\(\)": "fovy", r"\bfocal\b": "f", "fStop": "n"},
    ),
    "love/polygon_bokeh.lua": (
        r"uniforms\.focalLength = (.*)", r"uniforms\.apertureDiameter = (.*)",
        {r"uniforms\.sensorHeight": "h", r"math\.tan": "tan", "fieldOfView": "fovy", r"uniforms\.focalLength": "f",
         "fStop": "n"},
    ),
    "jmonkeyengine/BokehFilter.java": (
        r"float focalLength = (.*?);", r"\"ApertureDiameter\", (.*?)\);",
        {"SENSOR_HEIGHT": "h", r"Math\.abs\(camera\.getProjectionMatrix\(\)\.m11\)": "zoom", "focalLength": "f",
         "fStop": "n"},
    ),
    "panda3d/bokeh_panda3d/__init__.py": (
        r"focal_length = (self.*)", r"\"BokehApertureDiameter\": (.*?),",
        {r"self\.sensor_height": "h", r"radians\(lens\.getVfov\(\)\)": "fovy", "focal_length": "f",
         r"self\.f_stop": "n"},
    ),
    "web/three-common.js": (
        r"focalLength\.value = (.*?);", r"apertureDiameter\.value = (.*?);",
        {r"sensorHeight\.value": "h", r"Math\.tan": "tan", r"Math\.PI": "pi", r"camera\.getEffectiveFOV\(\)": "degrees",
         r"diameter\(focalLength\.value, fStop\)": "f / n"},
    ),
    "web/babylon.js": (
        r"uniforms\.focalLength = (.*?);", r"uniforms\.apertureDiameter = (.*?);",
        {r"uniforms\.sensorHeight": "h", r"Math\.abs\(camera\.getProjectionMatrix\(true\)\.m\[5\]\)": "zoom",
         r"diameter\(uniforms\.focalLength, fStop\)": "f / n"},
    ),
    "web/playcanvas.js": (
        r"uniforms\.focalLength = (.*?);", r"uniforms\.apertureDiameter = (.*?);",
        {r"uniforms\.sensorHeight": "h", r"projectionMatrix\.data\[5\]": "zoom",
         r"diameter\(uniforms\.focalLength, fStop\)": "f / n"},
    ),
    "direct3d9/scene.h": (
        r"return (SENSOR_HEIGHT .*?);", None, {"SENSOR_HEIGHT": "h", "tanf": "tan", "FIELD_OF_VIEW": "fovy"},
    ),
    "opengl/sample.py": (r"FOCAL_LENGTH = (.*)", None, {"FIELD_OF_VIEW": "fovy"}),
    "raylib/sample.py": (r"FOCAL_LENGTH = (.*)", None, {r"radians\(FIELD_OF_VIEW\)": "fovy"}),
}  # fmt: skip
# The aperture of what the tables above leave to another file
DIAMETERS = {
    "web/common.js": (r"if \(fStop > 0\) return (.*?);", {"focalLength": "f", "fStop": "n"}),
    "direct3d9/main.c": (r"parameters\.ApertureDiameter = (.*?);", {r"parameters\.FocalLength": "f", "F_STOP": "n"}),
    "direct3d11/main.cpp": (r"parameters\.ApertureDiameter = (.*?);", {r"parameters\.FocalLength": "f", "F_STOP": "n"}),
    "opengl/sample.py": (r"BokehApertureDiameter=(.*?),", {"FOCAL_LENGTH": "f", r"1\.4": "n"}),
    "raylib/sample.py": (r"\"BokehApertureDiameter\": (.*?),", {"FOCAL_LENGTH": "f", r"0\.2$": "n"}),
    "reshade/PolygonalBokeh.fx": (
        r"BokehMakeLens\((0\.001 \* FocalLength / FStop),", {r"0\.001 \* FocalLength": "f", "FStop": "n"},
    ),
}  # fmt: skip


def value(source: str, pattern: str, names: dict[str, str], **known: float) -> float:
    """The one expression of a source that a pattern finds, with these names, evaluated."""
    text = (paths.ROOT / "integration" / source).read_text(encoding="utf-8")
    (expression,) = set(re.findall(pattern, text))
    for name, ours in names.items():
        expression = re.sub(name, ours, expression)
    return eval(re.sub(NUMBERS, "", expression), {"__builtins__": {}}, {"tan": tan, "pi": pi, **known})


@pytest.mark.parametrize(("fovy", "f_stop"), LENSES)
@pytest.mark.parametrize("source", SOURCES)
def test_focal_length_and_aperture(source, fovy, f_stop):
    """f = h / (2 tan(fovy / 2)), A = f / N."""
    focal, aperture, names = SOURCES[source]
    wanted = SENSOR / (2.0 * tan(0.5 * fovy))
    known = {"fovy": fovy, "degrees": fovy * 180.0 / pi, "zoom": 1.0 / tan(0.5 * fovy), "h": SENSOR, "n": f_stop}
    assert radians(known["degrees"]) == pytest.approx(fovy)
    assert value(source, focal, names, **known) == pytest.approx(wanted)
    if aperture is not None:
        assert value(source, aperture, names, f=wanted, **known) == pytest.approx(wanted / f_stop)


@pytest.mark.parametrize("source", DIAMETERS)
def test_aperture(source):
    """A = f / N."""
    pattern, names = DIAMETERS[source]
    assert value(source, pattern, names, f=0.05, n=2.8) == pytest.approx(0.05 / 2.8)


def test_unity_takes_degrees():
    """Camera.fieldOfView is in degrees and vertical, the sensor's height in millimetres."""
    text = (paths.ROOT / "integration/unity/Runtime/BokehRendererFeature.cs").read_text(encoding="utf-8")
    assert "float fovy = Mathf.Deg2Rad * camera.fieldOfView;" in text
    assert "values.sensorHeight = 0.001f * volume.sensorHeight.value;" in text
