"""The archives of validation/run release, installed into an empty project: what is installed does what the sample does.

Unity, Unreal Engine and Godot cannot be installed here; for the first two, what is in the archive is compiled.
"""

import json
import re
import shutil
from collections.abc import Iterable
from pathlib import Path

import pytest
from support import needed
from test_compile_only import text
from test_release import unpacked

from bokeh_validation import __version__, engines, paths
from bokeh_validation.engines import bevy, pages, process, scripts
from bokeh_validation.errors import Unavailable
from bokeh_validation.release import archives, forms

INTEGRATION = paths.ROOT / "integration"


def written(form: tuple[str, dict], folder: Path) -> Path:
    """Write an archive's files below a folder, after they were packed."""
    name, files = form
    for path, content in unpacked(name, archives.packed(name, files)).items():
        target = folder / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)
    return folder


def within(capture: engines.Capture) -> None:
    """Every shot within the interval of the reference."""
    assert capture.shots
    for shot in capture.shots:
        assert shot.comparison.outside == 0, f"{shot.name}: {shot.comparison}, {shot.outside}"


# ---- npm ----


def own_files(engine: str, root: Path, without: Iterable[str], place: str) -> Path:
    """The sample's folder below `root`: its files, but some. One line of each page's import map finds the package."""
    folder = root / "integration" / engine
    folder.mkdir(parents=True)
    # what finds it in the checkout
    lines = re.compile(rf'"(bokeh-{engine}/|\./)[\w.]*": "[^"]*",\s*')
    for path in INTEGRATION.glob(f"{engine}/*"):
        if path.suffix in (".js", ".html") and path.name not in without:
            page = lines.sub("", path.read_text(encoding="utf-8"))
            page = page.replace('"imports": { ', f'"imports": {{ "bokeh-{engine}/": "{place}", ')
            (folder / path.name).write_text(page, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """(engine, folder with the sample's own files and its package from the archive, without the checkout's)."""
    engine, root = "threejs", tmp_path_factory.mktemp("threejs")
    name, files = forms.npm(engine)
    (root / name).write_bytes(archives.packed(name, files))
    manifest = json.loads(files["package/package.json"])
    folder = own_files(engine, root, manifest["files"], f"./node_modules/bokeh-{engine}/")
    (folder / "package.json").write_text("{}")
    ((engine_package, version),) = manifest["devDependencies"].items()
    with needed("npm"):
        pages.call_npm(folder, "install", root / name, f"{engine_package}@{version}")
    return engine, root


@pytest.mark.parametrize("kind", ["webgl", "webgpu"])
def test_npm_page(project, kind, tmp_path):
    """The sample's page on the installed package: every shot within the reference's interval."""
    engine, root = project
    with needed(engine):
        pages.run(f"{engine}-{kind}", tmp_path, root)
    within(engines.read(tmp_path))


def test_copied(project, tmp_path):
    """Without npm: what the guide names, in one folder, and its line of an import map; the page runs."""
    engine, root = project
    guide = INTEGRATION / engine / "README.md"
    (told,) = re.findall(r"^Without npm, .*?\n\n", text(guide), re.MULTILINE | re.DOTALL)
    copied = {guide.parent / name for name in re.findall(r"\]\((.*?)\)", told)}
    assert f'`"bokeh-{engine}/": "./that-folder/"`' in told
    folder = own_files(engine, tmp_path, {path.name for path in copied}, "./that-folder/")
    (folder / "that-folder").mkdir()
    for path in copied:
        shutil.copy(path, folder / "that-folder")
    for language in ("glsl", "wgsl"):
        shutil.copytree(paths.ROOT / language, folder / language)
    (folder / "node_modules").symlink_to(root / "integration" / engine / "node_modules")
    with needed(engine), pages.opened(f"{engine}-webgl", tmp_path) as page:
        said = page.call("interaction", "webgl")
    assert said["before"] != said["after"]


# ---- Python ----


def test_wheel(tmp_path):
    """pip installs it beside Panda3D, and the sample's own files run on it."""
    with needed("Panda3D"):
        (python,) = scripts.command("panda3d")
    name, files = forms.wheel()
    (tmp_path / name).write_bytes(archives.packed(name, files))
    pip = [python, "-I", "-m", "pip", "install", "--no-index", "--prefix", tmp_path / "prefix"]
    process.run([*pip, "--disable-pip-version-check", tmp_path / name], scripts.INSTALL_SECONDS)
    (package,) = tmp_path.glob("prefix/lib/*/site-packages")
    for path in INTEGRATION.glob("panda3d/*.py"):
        shutil.copy(path, tmp_path)
    (tmp_path / "out").mkdir()
    command = [python, tmp_path / "capture.py", tmp_path / "out"]
    process.run(command, scripts.SECONDS, tmp_path, {"PYTHONPATH": str(package)})
    within(engines.read(tmp_path / "out"))
    seen = [
        python,
        "-c",
        "import bokeh_panda3d, importlib.metadata as m; print(bokeh_panda3d.__file__, m.version('bokeh-panda3d'))",
    ]
    file, version = process.run(seen, scripts.SECONDS, tmp_path, {"PYTHONPATH": str(package)}).split()
    assert Path(file).is_relative_to(package) and version == __version__


# ---- Cargo ----


@pytest.mark.timeout(4000)
def test_crate(request, tmp_path):
    """`cargo package` of what is in the archive; with --all Cargo compiles it as well, which takes minutes at first."""
    name, files = forms.crate()
    folder = written((name, files), tmp_path) / name.removesuffix(".crate")
    full = request.config.getoption("--all")
    if full and bevy.locked().exists():
        shutil.copy(bevy.locked(), folder)
    options = ["--allow-dirty"] if full else ["--no-verify", "--exclude-lockfile", "--offline"]
    try:
        bevy.call_cargo(folder, "package", *options)
        listed = bevy.call_cargo(folder, "package", "--list").split()
    except Unavailable as error:
        if full:
            with needed("Cargo"):
                raise
        pytest.skip(str(error))
    assert {path.removeprefix(f"{folder.name}/") for path in files} <= set(listed)
