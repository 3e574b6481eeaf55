"""integration/jmonkeyengine: compiled by the Java that runs it, off screen, with the jars of its jars.txt.

Ivy fetches them once; it gets by with a fifteenth of what Maven brings along.
"""

import hashlib
import shutil
import tempfile
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

from bokeh_validation import locks, paths
from bokeh_validation.engines import process, scripts
from bokeh_validation.errors import Unavailable

SAMPLE = paths.ROOT / "integration/jmonkeyengine"
IVY = Path("/usr/share/java/ivy.jar")
INSTALL = "apt-get install -y --no-install-recommends default-jre-headless ivy"
# A runtime has the compiler as a module, though not as a command
COMPILER = ("-m", "jdk.compiler/com.sun.tools.javac.Main", "-Xlint:all", "-Werror")
FETCH_S, RUN_S = 300.0, 120.0  # take 10 and 5 on two cores


class Jar(NamedTuple):
    """A line of jars.txt; `classifier` is '' where it has none."""

    group: str
    name: str
    version: str
    classifier: str
    sha256: str

    @property
    def file(self) -> str:
        """As Ivy is told to name it."""
        return f"{self.name}-{self.version}{self.classifier and '-'}{self.classifier}.jar"


def run(name: str, folder: Path) -> None:
    """Leave the capture of the sample in `folder`. Raises errors.Unavailable, RuntimeError."""
    run_class("Capture", folder)


def run_class(name: str, argument: Path) -> None:
    """Compile the sample, and run a class of it with a file or folder to write. Raises as run() does."""
    java = shutil.which("java")
    if java is None:
        raise Unavailable(f"Java is missing; {INSTALL}")
    jars = ":".join(str(path) for path in fetched(java))
    native = paths.ensured(paths.cache_folder() / "engines" / "jmonkeyengine" / "native")
    with tempfile.TemporaryDirectory(prefix="bokeh-") as classes:
        process.run([java, *COMPILER, "-d", classes, "-cp", jars, *sorted(SAMPLE.glob("*.java"))], RUN_S)
        options = ["-Djava.awt.headless=true", f"-Dorg.lwjgl.system.SharedLibraryExtractPath={native}"]
        command = [*scripts.display(), java, *options, "-cp", f"{classes}:{jars}", name, argument]
        process.run(command, RUN_S, SAMPLE)


def pinned() -> list[Jar]:
    """What jars.txt has."""
    lines = (SAMPLE / "jars.txt").read_text(encoding="ascii").splitlines()
    rows = [line.split() for line in lines if not line.startswith("#")]
    return [Jar(*place.split(":"), classifier.strip("-"), sha256) for place, classifier, sha256 in rows]


@locks.held("jmonkeyengine")
def fetched(java: str) -> list[Path]:
    """The jars in the cache folder. Raises Unavailable, and RuntimeError where one is another than the pinned."""
    jars = pinned()
    key = hashlib.sha256("".join(jar.sha256 for jar in jars).encode()).hexdigest()[:16]
    target = paths.cache_folder() / "engines" / "jmonkeyengine" / f"jars-{key}"
    if not target.exists():
        if not IVY.exists():
            raise Unavailable(f"Ivy, which fetches the engine, is missing; {INSTALL}")
        folder = Path(tempfile.mkdtemp(dir=paths.ensured(target.parent)))
        try:
            _fetch(java, jars, folder)
            for jar in jars:
                if hashlib.sha256((folder / jar.file).read_bytes()).hexdigest() != jar.sha256:
                    raise RuntimeError(f"{jar.file}: not the one that jars.txt pins")
            # in place only when complete
            folder.rename(target)
        finally:
            shutil.rmtree(folder, ignore_errors=True)
    return [target / jar.file for jar in jars]


def _artifact(jar: Jar) -> str:
    classifier = jar.classifier and f' m:classifier="{jar.classifier}"'
    return f'<artifact name="{jar.name}" type="jar" ext="jar"{classifier}/>'


def _fetch(java: str, jars: list[Jar], folder: Path) -> None:
    """Have Ivy put the jars, and nothing that they depend on, into `folder`."""
    # a module is named once, with all its jars
    modules = [list(rows) for _, rows in groupby(jars, key=lambda jar: jar[:3])]
    wanted = "".join(
        f'<dependency org="{first.group}" name="{first.name}" rev="{first.version}" transitive="false">'
        f"{''.join(map(_artifact, [first, *others]))}</dependency>"
        for first, *others in modules
    )
    text = (
        '<ivy-module version="2.0" xmlns:m="http://ant.apache.org/ivy/maven">'
        f'<info organisation="bokeh" module="sample"/><dependencies>{wanted}</dependencies></ivy-module>'
    )
    with tempfile.TemporaryDirectory(prefix="bokeh-") as work:
        description = Path(work) / "ivy.xml"
        description.write_text(text, encoding="ascii")
        pattern = folder / "[artifact]-[revision](-[classifier]).[ext]"
        command = [
            java,
            "-jar",
            IVY,
            "-warn",
            "-ivy",
            description,
            "-cache",
            Path(work) / "cache",
            "-retrieve",
            pattern,
        ]
        try:
            process.run(command, FETCH_S)
        except RuntimeError as error:
            raise Unavailable(f"jMonkeyEngine is not to be had here ({str(error).splitlines()[-1]})") from error
