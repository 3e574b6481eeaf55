"""Test that files are written whole or not at all, and never replace anything except a plain file."""

import os
import stat

import pytest
from support import called, refused

from bokeh_validation import files
from bokeh_validation.errors import UserError


def write(path) -> None:
    """Write a file of one word."""
    files.whole(path, lambda partial: partial.write_text("new"))


def test_a_pipe_stays(tmp_path):
    """Check that a pipe is refused and remains: renaming a file over it would replace it, or a device."""
    os.mkfifo(tmp_path / "pipe")
    refused(called("truth", "--json", tmp_path / "pipe"), ["pipe", "no plain file"])
    with pytest.raises(UserError, match="no plain file"):
        write(tmp_path / "pipe")
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode) and len(list(tmp_path.iterdir())) == 1


def test_a_link_leads_on(tmp_path):
    """Check that the target of a link is written, in its own folder, and that the link remains."""
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder/file").write_text("old")
    for target in ("folder/file", "folder/new"):
        (tmp_path / "link").symlink_to(target)
        write(tmp_path / "link")
        assert (tmp_path / "link").is_symlink() and (tmp_path / target).read_text() == "new"
        (tmp_path / "link").unlink()
    assert sorted(path.name for path in (tmp_path / "folder").iterdir()) == ["file", "new"]


def test_long_names(tmp_path):
    """Check that the longest names that the system allows work, and that longer ones give one line."""
    write(tmp_path / ("x" * 255))
    refused(called("truth", "--json", tmp_path / ("x" * 256)), ["cannot be written", "too long"])


def test_temporary_names_are_random(tmp_path):
    """Check that the temporary file of each write has another name, so that nobody can put a link there beforehand."""
    used = []

    def save(partial):
        used.append(partial.name)
        partial.write_text("new")

    for _ in range(3):
        files.whole(tmp_path / "file", save)
    assert len(set(used)) == 3 and not any(str(os.getpid()) == part for name in used for part in name.split("."))


def test_what_fails_leaves_nothing(tmp_path):
    """Check that after a failure the old file is intact and nothing is left next to it."""
    (tmp_path / "file").write_text("old")

    def save(partial):
        partial.write_text("half")
        raise ValueError("no more room")

    with pytest.raises(UserError, match="no more room"):
        files.whole(tmp_path / "file", save)
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("file", "old")]
