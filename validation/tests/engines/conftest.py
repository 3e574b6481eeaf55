"""A sample is run where something of it has changed since the test last passed here; some always, all with --all."""

from functools import cache

import pytest

from bokeh_validation import locks, paths

ALWAYS = ("opengl", "threejs-webgl", "direct3d11")
# Of the package: what makes the frame, runs a sample and judges what it drew
PACKAGE = ("browser", "drivers", "engines", "frame", "numerics", "plan", "probes", "reference", "shaders", "windows")


@cache
def _state(engine: str) -> str:
    """A digest of a sample's folder and those that it shares, of the shaders, and of what tests it."""
    integration, package = paths.ROOT / "integration", paths.VALIDATION / "bokeh_validation"
    others = {"direct3d11": "direct3d9", "threejs": "web", "babylonjs": "web", "playcanvas": "web"}
    shared = ("parameters", others.get(engine, engine))
    folders = [integration / name for name in (engine, *shared)] + [paths.ROOT / name for name in paths.LANGUAGES]
    folders += [package / name for name in PACKAGE] + [paths.VALIDATION / "tests/engines", paths.VALIDATION / "godot"]
    files = {*integration.glob("*.*"), *package.glob("*.py")}.union(*(folder.rglob("*.*") for folder in folders))
    named = sorted((path.relative_to(paths.ROOT).as_posix(), path) for path in files if path.is_file())
    return locks.digest(part for name, path in named if path.suffix != ".pyc" for part in (name, path))


def _sample(item) -> str | None:
    """Of a marked test: named by the mark, or by the test's parameters."""
    mark, given = item.get_closest_marker("sample"), getattr(item, "callspec", None)
    return mark and (*mark.args, *(given.params[key] for key in ("sample", "name") if given and key in given.params))[0]


def pytest_collection_modifyitems(config, items):
    """Those of which nothing has changed are skipped."""
    for item in [] if config.getoption("--all") else items:
        name = _sample(item)
        if name and name not in ALWAYS and config.cache.get(f"samples/{item.nodeid}", "") == _state(name.split("-")[0]):
            item.add_marker(pytest.mark.skip(f"{name}: nothing has changed since it passed; --all runs it"))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    """What a sample was made of when it passed."""
    report = yield
    if call.when == "call" and report.passed and (name := _sample(item)):
        item.config.cache.set(f"samples/{item.nodeid}", _state(name.split("-")[0]))
    return report
