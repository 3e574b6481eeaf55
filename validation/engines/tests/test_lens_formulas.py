"""Check that the lens formula in every integration's source gives the focal length and aperture of docs/lens.md.

Each formula is read from the source and evaluated as Python, so a lost factor shows without running the engine.
"""

import re
from math import pi, radians, tan

import pytest

from bokeh_validation import paths

# Vertical field of view in radians, f-stop, bokeh scale
LENSES = ((0.3, 0.2, 1.0), (0.9, 2.8, 10.0), (1.6, 11.0, 0.0))
SENSOR = 0.024
NUMBERS = r"(?<=\d)[fF]\b"
# source -> patterns for the focal length and the aperture (one group each), and what the names in them mean: fovy, the
# camera's element of the projection matrix (zoom), the sensor (h), the focal length (f), the f-stop (n), and the bokeh
# scale (k)
SOURCES = {
    "unity/Runtime/BokehRendererFeature.cs": (
        r"values\.focalLength = (.*?);", r"values\.apertureDiameter = (.*?);",
        {r"Mathf\.Tan": "tan", r"values\.sensorHeight": "h", r"volume\.strength\.value": "1.0",
         r"volume\.bokehScale\.value": "k", r"values\.focalLength": "f", "fStop": "n"},
    ),
    "unreal/BokehDepthOfField/Source/BokehDepthOfField/Private/BokehViewExtension.cpp": (
        r"BokehFocalLength = (.*?);", r"BokehApertureDiameter = (.*?);",
        {r"Lens\.SensorHeight": "h", r"Given->BokehFocalLength": "f", "Zoom": "zoom",
         r"Lens\.FStop": "n", r"SettingBokehScale\.GetValueOnRenderThread\(\)": "k"},
    ),
    "bevy/src/lib.rs": (
        r"let focal_length = (.*?);", r"aperture_diameter: (focal_length / f_stop \* bokeh_scale), \.\.lens",
        {r"lens\.sensor_height": "h", r"\(0\.5 \* fov\)\.tan\(\)": "tan(0.5 * fovy)", "focal_length": "f",
         "f_stop": "n", "bokeh_scale": "k"},
    ),
    "wgpu/src/lens.rs": (
        r"fn focal_length.*?\{\s+(.*?)\n", r"fn aperture_diameter.*?\{\s+(.*?)\n",
        {r"self\.sensor_height": "h", r"\(0\.5 \* self\.fov_y\)\.tan\(\)": "tan(0.5 * fovy)",
         r"self\.focal_length\(\)": "f", r"self\.f_stop": "n", r"self\.bokeh_scale": "k"},
    ),
    "godot/addons/polygon_bokeh/polygon_bokeh.gd": (
        r"\tfocal_length = (.*)", r"aperture_diameter = (.*?),",
        {r"absf\(_camera\.get_camera_projection\(\)\.y\.y\)": "zoom", "sensor_height": "h", "focal_length": "f",
         "f_stop": "n", "bokeh_scale": "k"},
    ),
    "ogre/PolygonBokeh.h": (
        r"const float focal = (.*?);", r"uniforms\[\"BokehApertureDiameter\"\] = (.*?);",
        {r"uniforms\[\"BokehSensorHeight\"\]": "h", r"std::tan": "tan",
         r"camera->getFOVy\(\)\.valueRadians\(\)": "fovy", r"\bfocal\b": "f", "fStop": "n",
         "bokehScale": "k"},
    ),
    "love/polygon_bokeh.lua": (
        r"uniforms\.focalLength = (.*)", r"uniforms\.apertureDiameter = (.*)",
        {r"uniforms\.sensorHeight": "h", r"math\.tan": "tan", "fieldOfView": "fovy", r"uniforms\.focalLength": "f",
         r"\(fStop or 2\.8\)": "n", r"\(bokehScale or 10\)": "k"},
    ),
    "jmonkeyengine/BokehFilter.java": (
        r"float focalLength = (.*?);", r"\"ApertureDiameter\", (.*?)\);",
        {"SENSOR_HEIGHT": "h", r"Math\.abs\(camera\.getProjectionMatrix\(\)\.m11\)": "zoom", "focalLength": "f",
         "fStop": "n", "bokehScale": "k"},
    ),
    "panda3d/bokeh_panda3d/__init__.py": (
        r"focal_length = (self.*)", r"\"BokehApertureDiameter\": (.*?),",
        {r"self\.sensor_height": "h", r"radians\(lens\.getVfov\(\)\)": "fovy", "focal_length": "f",
         r"self\.f_stop": "n", r"self\.bokeh_scale": "k"},
    ),
    "web/three-common.js": (
        r"focalLength\.value = (.*?);", r"apertureDiameter\.value = (.*?);",
        {r"sensorHeight\.value": "h", r"Math\.tan": "tan", r"Math\.PI": "pi", r"camera\.getEffectiveFOV\(\)": "degrees",
         r"diameter\(focalLength\.value, fStop, bokehScale\)": "f / n * k"},
    ),
    "web/babylon.js": (
        r"uniforms\.focalLength = (.*?);", r"uniforms\.apertureDiameter = (.*?);",
        {r"uniforms\.sensorHeight": "h", r"Math\.abs\(camera\.getProjectionMatrix\(true\)\.m\[5\]\)": "zoom",
         r"diameter\(uniforms\.focalLength, fStop, bokehScale\)": "f / n * k"},
    ),
    "web/playcanvas.js": (
        r"uniforms\.focalLength = (.*?);", r"uniforms\.apertureDiameter = (.*?);",
        {r"uniforms\.sensorHeight": "h", r"projectionMatrix\.data\[5\]": "zoom",
         r"diameter\(uniforms\.focalLength, fStop, bokehScale\)": "f / n * k"},
    ),
    "direct3d9/scene.h": (
        r"return (SENSOR_HEIGHT .*?);", None, {"SENSOR_HEIGHT": "h", "tanf": "tan", "FIELD_OF_VIEW": "fovy"},
    ),
    "opengl/sample.py": (r"FOCAL_LENGTH = (.*)", None, {"FIELD_OF_VIEW": "fovy"}),
    "raylib/sample.py": (r"FOCAL_LENGTH = (.*)", None, {r"radians\(FIELD_OF_VIEW\)": "fovy"}),
}  # fmt: skip
# Formulas of the aperture for sources above that leave it to another file
DIAMETERS = {
    "web/common.js": (r"  return (\(focalLength / .*?);", {"focalLength": "f", "fStop": "n", "bokehScale": "k"}),
    "direct3d9/window.h": (r"parameters\.ApertureDiameter = (.*?);", {r"parameters\.FocalLength": "f", "F_STOP": "n"}),
    "opengl/sample.py": (r"BokehApertureDiameter=(.*?),", {"FOCAL_LENGTH": "f", r"1\.4": "n"}),
    "raylib/sample.py": (r"\"BokehApertureDiameter\": (.*?),", {r"10\.0": "k", "FOCAL_LENGTH": "f", r"2\.0$": "n"}),
    "reshade/Shaders/PolygonalBokeh.fx": (
        r"BokehMakeLens\((0\.001 \* FocalLength / FStop \* BokehScale),",
        {r"0\.001 \* FocalLength": "f", "FStop": "n", "BokehScale": "k"},
    ),
}  # fmt: skip


def value(source: str, pattern: str, names: dict[str, str], **known: float) -> float:
    """Evaluate the one expression of a source that a pattern finds, with its names replaced."""
    text = (paths.ROOT / "integration" / source).read_text(encoding="utf-8")
    (expression,) = set(re.findall(pattern, text))
    for name, ours in names.items():
        expression = re.sub(name, ours, expression)
    return eval(re.sub(NUMBERS, "", expression), {"__builtins__": {}}, {"tan": tan, "pi": pi, **known})


@pytest.mark.parametrize(("fovy", "f_stop", "scale"), LENSES)
@pytest.mark.parametrize("source", SOURCES)
def test_focal_length_and_aperture(source, fovy, f_stop, scale):
    """Check f = h / (2 tan(fovy / 2)) and A = k f / N."""
    focal, aperture, names = SOURCES[source]
    expected = SENSOR / (2.0 * tan(0.5 * fovy))
    known = {
        "fovy": fovy,
        "degrees": fovy * 180.0 / pi,
        "zoom": 1.0 / tan(0.5 * fovy),
        "h": SENSOR,
        "n": f_stop,
        "k": scale,
    }
    assert radians(known["degrees"]) == pytest.approx(fovy)
    assert value(source, focal, names, **known) == pytest.approx(expected)
    if aperture is not None:
        assert value(source, aperture, names, f=expected, **known) == pytest.approx(scale * expected / f_stop)


@pytest.mark.parametrize("source", DIAMETERS)
def test_aperture(source):
    """Check A = k f / N; k is 1 for a real lens."""
    pattern, names = DIAMETERS[source]
    scale = 10.0 if "k" in names.values() else 1.0
    assert value(source, pattern, names, f=0.05, n=2.8, k=scale) == pytest.approx(scale * 0.05 / 2.8)


# Source -> patterns for the default f-stop and bokeh scale
DEFAULTS = {
    "unity/Runtime/BokehVolume.cs": (r"fStop = new MinFloatParameter\(([\d.]+)f", r"bokehScale = .*\(([\d.]+)f, "),
    "unreal/BokehDepthOfField/Source/BokehDepthOfField/Private/BokehViewExtension.cpp": (
        r"float FStop = ([\d.]+)f", r"BokehScale, ([\d.]+)f"),
    "wgpu/src/lens.rs": (r"f_stop: ([\d.]+),", r"bokeh_scale: ([\d.]+),"),
    "bevy/src/lib.rs": (r"aperture_diameter: 0\.05 / ([\d.]+)", r"aperture_diameter: 0\.05 / 2\.8 \* ([\d.]+),"),
    "godot/addons/polygon_bokeh/polygon_bokeh_effect.gd": (r"f_stop := ([\d.]+)", r"bokeh_scale := ([\d.]+)"),
    "godot/addons/polygon_bokeh/polygon_bokeh.gd": (r"f_stop := ([\d.]+)", r"bokeh_scale := ([\d.]+)"),
    "ogre/PolygonBokeh.h": (r"float fStop = ([\d.]+)f", r"float bokehScale = ([\d.]+)f"),
    "love/polygon_bokeh.lua": (r"fStop or ([\d.]+)", r"bokehScale or ([\d.]+)"),
    "jmonkeyengine/BokehFilter.java": (r"float fStop = ([\d.]+)f", r"bokehScale = ([\d.]+)f"),
    "panda3d/bokeh_panda3d/__init__.py": (r"f_stop=([\d.]+)", r"bokeh_scale=([\d.]+)"),
    "web/common.js": (r"fStop = ([\d.]+)", r"bokehScale = ([\d.]+)"),
    "web/three-common.js": (r"fStop = ([\d.]+)", r"bokehScale = ([\d.]+)"),
    "web/babylon.js": (r"fStop = ([\d.]+)", r"bokehScale = ([\d.]+)"),
    "web/playcanvas.js": (r"fStop = ([\d.]+)", r"bokehScale = ([\d.]+)"),
    "web/react-common.js": (r"const \{ fStop = ([\d.]+)", r"2\.8, bokehScale = ([\d.]+)"),
    "reshade/Shaders/PolygonalBokeh.fx": (
        r"float FStop <(?:.*\n){3,5}?> = ([\d.]+);", r"float BokehScale <(?:.*\n){3,5}?> = ([\d.]+);"),
}  # fmt: skip


@pytest.mark.parametrize("source", DEFAULTS)
def test_defaults(source):
    """Check that every integration starts with f/2.8 and a bokeh scale of 10, so that all blur visibly and by the same
    amount.
    """
    text = (paths.ROOT / "integration" / source).read_text(encoding="utf-8")
    assert [{float(value) for value in re.findall(pattern, text)} for pattern in DEFAULTS[source]] == [{2.8}, {10.0}]


def test_unity_takes_degrees():
    """Check the units: Camera.fieldOfView is vertical and in degrees, the sensor's height in millimetres."""
    text = (paths.ROOT / "integration/unity/Runtime/BokehRendererFeature.cs").read_text(encoding="utf-8")
    assert "float fovy = Mathf.Deg2Rad * camera.fieldOfView;" in text
    assert "values.sensorHeight = 0.001f * volume.sensorHeight.value;" in text


# Source of an engine that is not run here -> the angle that the shaders get, and whether v grows downwards in it; the
# rotations of all other samples are drawn (test_engines.py)
ROTATIONS = {
    "unity/Runtime/BokehRendererFeature.cs": (r"BokehFrames\.Angle, (.*)\);", False),
    "unreal/BokehDepthOfField/Source/BokehDepthOfField/Private/BokehViewExtension.cpp": (r"BokehAngle = (.*);", True),
    "reshade/Shaders/PolygonalBokeh.fx": (r"BokehMakePolygon\(6, (.*), Squeeze\)", True),
}
ANGLES = {
    r"step\.Angle|Step\.Own\.Angle": "30.0",
    r"values\.rotation|SettingRotation\.GetValueOnRenderThread\(\)|\bRotation\b": "rotation",
    r"Mathf\.Deg2Rad \*|FMath::DegreesToRadians": "radians",
}


@pytest.mark.parametrize("source", ROTATIONS)
def test_rotation(source):
    """Check that the setting adds to the angle from +u to +v where v grows downwards, and is subtracted elsewhere."""
    pattern, downwards = ROTATIONS[source]
    for rotation in (0.0, 10.0):
        own = 0.0 if "reshade" in source else 30.0
        expected = radians(own + (rotation if downwards else -rotation))
        assert value(source, pattern, ANGLES, rotation=rotation, radians=radians) == pytest.approx(expected)
