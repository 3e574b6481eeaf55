"""Test how tests are distributed, and which are skipped because their inputs have not changed."""

import json

from bokeh_validation import paths
from bokeh_validation.run import schedule, unchanged

pytest_plugins = ("pytester",)
CONFTEST = """
pytest_plugins = ("bokeh_validation.run.schedule", "bokeh_validation.run.unchanged")
def pytest_addoption(parser):
    parser.addoption("--all", action="store_true")
"""


def test_units():
    """Check units: neighbours up to 20 s, tests that share a slow set-up stay together, and five of them without
    a record.
    """
    durations = {f"a.py::{n}": [0.0, 15.0] for n in range(4)} | {"b.py::0": [9.0, 30.0], "b.py::1": [0.0, 30.0]}
    durations |= {"c.py::0": [9.0, 30.0], "c.py::1": [8.0, 10.0]}
    found = schedule.units([*durations, *(f"d.py::{n}" for n in range(6))], durations)
    starts = {name for name in found.values()}
    assert starts == {"a.py::0", "a.py::2", "b.py::0", "c.py::0", "c.py::1", "d.py::0", "d.py::5"}


def test_longest_first(pytester):
    """Check that the test that took longest last time starts first, and that a run records how long tests took."""
    pytester.makeconftest(CONFTEST)
    names = ("quick", "slow", "slower")
    for name in names:
        pytester.makepyfile(**{f"test_{name}": "def test(): pass"})
    pytester.inline_run().assertoutcome(passed=3)
    record = pytester.path / ".pytest_cache/v" / schedule.KEY
    assert set(json.loads(record.read_bytes())) == {f"test_{name}.py::test" for name in names}
    record.write_text(json.dumps({f"test_{name}.py::test": [0.0, place] for place, name in enumerate(names)}))
    lines = [line for line in pytester.runpytest_subprocess("-n1", "-v").outlines if "PASSED" in line]
    assert [name for line in lines for name in names if f"test_{name}.py" in line] == ["slower", "slow", "quick"]


def test_unchanged(pytester, monkeypatch):
    """Check that a test runs once, is then skipped until a file in its folders changes, except a file that it leaves
    out, and is never skipped after a failure.
    """
    monkeypatch.setattr(paths, "ROOT", pytester.path)
    folder = pytester.mkdir("folder")
    (folder / "copies").mkdir()
    (folder / "value").write_text("1")
    pytester.makeconftest(CONFTEST)
    pytester.makepyfile(
        """
        import pathlib, pytest
        @pytest.mark.inputs("folder", leave_out=("folder/copies/*",))
        def test(): assert pathlib.Path("folder/value").read_text() != "0"
        """
    )

    for index, (value, arguments, expected) in enumerate(
        (
            ("1", (), "passed"),
            ("1", (), "skipped"),
            ("1", ("--all",), "passed"),
            ("0", (), "failed"),
            ("0", (), "failed"),
            ("1", (), "skipped"),
            ("2", (), "passed"),
        )
    ):
        (folder / "value").write_text(value)
        (folder / "copies/value").write_text(str(index))
        unchanged.digest_of.cache_clear()
        passed, skipped, failed = pytester.inline_run(*arguments).listoutcomes()
        assert {"passed": passed, "skipped": skipped, "failed": failed}[expected], (value, arguments)
