"""What commands write: whole or not at all, and never in the place of something that is no plain file."""

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
    """A pipe is refused and is still there: renaming over it would replace it, as it would replace a device."""
    os.mkfifo(tmp_path / "pipe")
    refused(called("truth", "--json", tmp_path / "pipe"), ["pipe", "no plain file"])
    with pytest.raises(UserError, match="no plain file"):
        write(tmp_path / "pipe")
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode) and len(list(tmp_path.iterdir())) == 1


def test_a_link_leads_on(tmp_path):
    """The file that a link leads to is written, in its own folder; the link stays."""
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder/file").write_text("old")
    for target in ("folder/file", "folder/new"):
        (tmp_path / "link").symlink_to(target)
        write(tmp_path / "link")
        assert (tmp_path / "link").is_symlink() and (tmp_path / target).read_text() == "new"
        (tmp_path / "link").unlink()
    assert sorted(path.name for path in (tmp_path / "folder").iterdir()) == ["file", "new"]


def test_long_names(tmp_path):
    """As long as the system allows: written. Longer: one line."""
    write(tmp_path / ("x" * 255))
    refused(called("truth", "--json", tmp_path / ("x" * 256)), ["cannot be written", "too long"])


def test_what_fails_leaves_nothing(tmp_path):
    """The file that was there stays, and nothing is beside it."""
    (tmp_path / "file").write_text("old")

    def save(partial):
        partial.write_text("half")
        raise ValueError("no more room")

    with pytest.raises(UserError, match="no more room"):
        files.whole(tmp_path / "file", save)
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("file", "old")]
