"""Fetch libraries from packages of PyPI once into the cache folder, pinned by version and hash."""

import shutil
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from bokeh_validation import locks, process
from bokeh_validation.errors import Unavailable

DOWNLOAD_S = 540


@dataclass(frozen=True)
class Package:
    """Name one file in a package's archive.

    compiler       the compiler that it belongs to, for messages and the cache folder
    name, version  of the package
    sha256         of the archive
    options        for pip, to choose the archive
    member         path of the file in the archive
    """

    compiler: str
    name: str
    version: str
    sha256: str
    options: tuple[str, ...]
    member: str

    def fetch(self) -> Path:
        """Return the file's path in the cache folder, downloading it first if necessary. Raises Unavailable."""
        name = Path(self.member).name

        def download(folder: Path) -> None:
            print(f"fetching {self.compiler} (the {self.name} package, once)", file=sys.stderr)
            with tempfile.TemporaryDirectory(prefix="bokeh-") as temporary:
                archive = self._downloaded(Path(temporary))
                shutil.unpack_archive(archive, temporary, "zip" if archive.suffix == ".whl" else "gztar")
                shutil.copyfile(Path(temporary, self.member), folder / name)

        return locks.built_once(f"libraries/{self.compiler}", [self.version, self.sha256, self.member], download) / name

    def _downloaded(self, folder: Path) -> Path:
        """Download the archive into a folder and return its path; pip refuses one with another hash."""
        requirements = folder / "requirements.txt"
        requirements.write_text(f"{self.name}=={self.version} --hash=sha256:{self.sha256}\n", encoding="ascii")
        command = [sys.executable, "-m", "pip", "download", "-q", "--no-deps", *self.options, "--require-hashes"]
        command += ["-r", str(requirements), "-d", str(folder)]
        try:
            process.run(command, DOWNLOAD_S)
        except RuntimeError as error:
            problem = f"could not download {self.name} {self.version} for {self.compiler}"
            raise Unavailable(f"{problem}: {str(error).splitlines()[-1]}") from error
        return next(path for path in folder.iterdir() if path != requirements)
