"""Archives that are the same to the byte whenever and wherever they are made of the same files."""

import gzip
import io
import tarfile
import zipfile
from collections.abc import Mapping

# 1980-01-01, the first day that a zip knows
SECONDS, DATE = 315532800, (1980, 1, 1, 0, 0, 0)
MODE = 0o644


def packed(name: str, files: Mapping[str, bytes]) -> bytes:
    """The archive `name` (.zip, .whl: zip; .tgz, .crate: tar and gzip) of path -> content, ordered by path."""
    ordered = dict(sorted(files.items()))
    return _zip(ordered) if name.endswith((".zip", ".whl")) else _tar(ordered)


def _zip(files: Mapping[str, bytes]) -> bytes:
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as writer:
        for path, content in files.items():
            entry = zipfile.ZipInfo(path, DATE)
            entry.create_system = 3  # Unix on every system, or the mode would not count
            entry.external_attr = MODE << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            writer.writestr(entry, content)
    return target.getvalue()


def _tar(files: Mapping[str, bytes]) -> bytes:
    target = io.BytesIO()
    with (
        gzip.GzipFile("", "wb", 9, target, mtime=0) as compressed,
        tarfile.open(fileobj=compressed, mode="w", format=tarfile.USTAR_FORMAT) as writer,
    ):
        for path, content in files.items():
            entry = tarfile.TarInfo(path)
            entry.size, entry.mtime, entry.mode = len(content), SECONDS, MODE
            writer.addfile(entry, io.BytesIO(content))
    return target.getvalue()
