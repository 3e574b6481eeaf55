"""List the inputs of tests that take long: with these marks they are skipped until an input changes."""

import pytest

from bokeh_validation import paths

# Folders with the code that makes the frame, runs a sample and judges its result
HARNESS = ("browser", "drivers", "engines", "frame", "numerics", "plan", "probes", "reference", "shaders", "windows")
SHARED = (
    *paths.LANGUAGES,
    *(f"validation/bokeh_validation/{name}" for name in HARNESS),
    *(str(path.relative_to(paths.ROOT)) for path in sorted(paths.VALIDATION.glob("bokeh_validation/*.py"))),
    "validation/tests/engines",
    "integration/README.md",
    "integration/parameters",
)
# Additional folders of integration/ that a sample reads
FOLDERS = {
    "direct3d11": ("direct3d9",),
    **dict.fromkeys(("threejs", "babylonjs", "playcanvas"), ("web",)),
}
# Inputs of the compilation of the shaders
COMPILERS = ("browser", "compile_matrix", "compilers", "shaders", "windows", "needs.py")
COMPILED = (
    *paths.LANGUAGES,
    *(f"validation/bokeh_validation/{name}" for name in COMPILERS),
    "validation/requirements.txt",
    "validation/tests/harness/test_compile.py",
)


def inputs(*names: str) -> pytest.MarkDecorator:
    """Mark a test with these folders and files of the repository, the shaders, and the code that runs and judges a
    sample.
    """
    return pytest.mark.inputs(*SHARED, *names)


def of_sample(name: str) -> pytest.MarkDecorator:
    """Mark a test with the inputs of a sample of integration/, such as 'threejs-webgl'."""
    folder = name.partition("-")[0]
    more = ["validation/godot"] if folder == "godot" else []
    return inputs(*(f"integration/{each}" for each in (folder, *FOLDERS.get(folder, ()))), *more)


def samples(names) -> list:
    """Return samples as parameters of a test, each marked with its inputs."""
    return [pytest.param(name, marks=of_sample(name)) for name in names]
