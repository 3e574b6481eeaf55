"""List the inputs of tests that take long: with these marks they are skipped until an input changes."""

import pytest

from bokeh_validation import compile_matrix, paths

# Folders with the code that makes the frame, runs a sample and judges its result
HARNESS = ("browser", "drivers", "frame", "numerics", "plan", "probes", "reference", "shaders", "windows")
SHARED = (
    *paths.LANGUAGES,
    *(f"validation/bokeh_validation/{name}" for name in HARNESS),
    *(str(path.relative_to(paths.ROOT)) for path in sorted(paths.VALIDATION.glob("bokeh_validation/*.py"))),
    "validation/engines",
    "integration/README.md",
    "integration/parameters",
)
# Additional folders of integration/ that a sample reads
FOLDERS = {
    "direct3d11": ("direct3d9",),
    **dict.fromkeys(("threejs", "babylonjs", "playcanvas"), ("web",)),
}
# The text of the shaders, in the repository and in the integrations. `generate` writes what integrations know of it
# into other files: parameters, passes, sizes.
SHADER_TEXT = (
    "glsl/*", "hlsl/*", "wgsl/*", "integration/*/bokeh*.hlsl", "integration/*/bokeh*.ush", "integration/*/bokeh.wgsl",
    "integration/*/bokeh*.gdshaderinc", "integration/web/shaders.js", "integration/panda3d/*/shaders.py",
)  # fmt: skip
# A sample for each API and language with which the tests of the shaders do not draw by default; after an edit of the
# shaders these are drawn again. Those tests draw on OpenGL, and on Vulkan with wgpu.
DRAWN_AGAIN = ("direct3d9", "direct3d11", "threejs-webgl", "threejs-webgpu", "godot", "reshade")
# Inputs of the compilation of the shaders
COMPILED = (
    *paths.LANGUAGES,
    *(f"validation/{name}" for name in compile_matrix.CODE),
    "validation/tests/harness/test_compile.py",
)
# Inputs of every test of the shaders: they draw on drivers, and compare with the reference and with ray-traced images
DRAWN = (
    *paths.LANGUAGES,
    "validation/bokeh_validation",
    "validation/tests/shaders",
    *(str(path.relative_to(paths.ROOT)) for path in sorted(paths.VALIDATION.glob("tests/*.py"))),
    "validation/scenes",
    "docs/data",
)
# and of every test of the lab, which also draws the documents' images and other effects
OF_LAB = (
    *DRAWN,
    "validation/engines",
    "validation/lab",
    "validation/requirements.txt",
    "integration",
    "docs",
    "README.md",
)


def inputs(*names: str, of_code: bool = False) -> pytest.MarkDecorator:
    """Mark a test with these folders and files of the repository, the shaders, and the code that runs and judges a
    sample.

    of_code  the test is about a sample's or the page's own code: an edit of the shaders that changes neither parameters
             nor passes does not repeat it, except with --all
    """
    return pytest.mark.inputs(*SHARED, *names, leave_out=SHADER_TEXT if of_code else ())


def of_sample(name: str, of_code: bool = False) -> pytest.MarkDecorator:
    """Mark a test with the inputs of a sample of integration/, such as 'threejs-webgl'; `of_code` as for inputs()."""
    folder = name.partition("-")[0]
    more = ["validation/godot"] if folder == "godot" else []
    folders = (f"integration/{each}" for each in (folder, *FOLDERS.get(folder, ())))
    return inputs(*folders, *more, of_code=of_code)


def samples(names, drawn_again: tuple[str, ...] = ()) -> list:
    """Return samples as parameters of a test, each marked with its inputs.

    drawn_again  samples whose test is repeated after every edit of the shaders
    """
    return [pytest.param(name, marks=of_sample(name, of_code=name not in drawn_again)) for name in names]
