"""What tests that take long are made of: with these marks they are skipped while nothing of it has changed."""

import pytest

from bokeh_validation import paths

# Makes the frame, runs a sample and judges what it drew
HARNESS = ("browser", "drivers", "engines", "frame", "numerics", "plan", "probes", "reference", "shaders", "windows")
SHARED = (
    *paths.LANGUAGES,
    *(f"validation/bokeh_validation/{name}" for name in HARNESS),
    *(str(path.relative_to(paths.ROOT)) for path in sorted(paths.VALIDATION.glob("bokeh_validation/*.py"))),
    "validation/tests/engines",
    "integration/README.md",
    "integration/parameters",
)
# Further folders of integration/ that a sample reads
FOLDERS = {
    "direct3d11": ("direct3d9",),
    **dict.fromkeys(("threejs", "babylonjs", "playcanvas"), ("web",)),
}
# What a compiler says of the shaders depends on
COMPILERS = ("browser", "compile_matrix", "compilers", "shaders", "windows", "needs.py")
COMPILED = (
    *paths.LANGUAGES,
    *(f"validation/bokeh_validation/{name}" for name in COMPILERS),
    "validation/requirements.txt",
    "validation/tests/harness/test_compile.py",
)


def inputs(*names: str) -> pytest.MarkDecorator:
    """Folders and files of the repository, the shaders, and what runs a sample and judges it."""
    return pytest.mark.inputs(*SHARED, *names)


def of_sample(name: str) -> pytest.MarkDecorator:
    """The inputs of a sample of integration/, such as 'threejs-webgl'."""
    folder = name.partition("-")[0]
    more = ["validation/godot"] if folder == "godot" else []
    return inputs(*(f"integration/{each}" for each in (folder, *FOLDERS.get(folder, ()))), *more)


def samples(names) -> list:
    """Parameters of a test: samples, each with its inputs."""
    return [pytest.param(name, marks=of_sample(name)) for name in names]
