"""integration/jmonkeyengine: compiled by the Java that runs it, off screen, with the jars of its jars.txt.

Ivy fetches them once; it gets by with a fifteenth of what Maven brings along.
"""

import hashlib
import shutil
import tempfile
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from bokeh_validation import locks, paths, process
from bokeh_validation.engines import scripts
from bokeh_validation.errors import Unavailable

SAMPLE = paths.ROOT / "integration/jmonkeyengine"
JARS = SAMPLE / "jars.txt"
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
    lines = JARS.read_text(encoding="ascii").splitlines()
    rows = [line.split() for line in lines if not line.startswith("#")]
    return [Jar(*place.split(":"), classifier.strip("-"), sha256) for place, classifier, sha256 in rows]


def fetched(java: str) -> list[Path]:
    """The jars in the cache folder. Raises Unavailable, and RuntimeError where one is another than the pinned."""
    jars = pinned()
    folder = locks.built_once("engines/jmonkeyengine/jars", [JARS], partial(_fetch, java, jars))
    return [folder / jar.file for jar in jars]


def _fetch(java: str, jars: list[Jar], folder: Path) -> None:
    """Have Ivy put the jars, and nothing that they depend on, into `folder`."""
    if not IVY.exists():
        raise Unavailable(f"Ivy, which fetches the engine, is missing; {INSTALL}")
    with tempfile.TemporaryDirectory(prefix="bokeh-") as work:
        description = Path(work) / "ivy.xml"
        description.write_text(_module(jars), encoding="ascii")
        options = ["-warn", "-ivy", description, "-cache", Path(work) / "cache"]
        pattern = folder / "[artifact]-[revision](-[classifier]).[ext]"
        try:
            process.run([java, "-jar", IVY, *options, "-retrieve", pattern], FETCH_S)
        except RuntimeError as error:
            raise Unavailable(f"jMonkeyEngine is not to be had here ({str(error).splitlines()[-1]})") from error
    for jar in jars:
        if hashlib.sha256((folder / jar.file).read_bytes()).hexdigest() != jar.sha256:
            raise RuntimeError(f"{jar.file}: not the one that jars.txt pins")


def _module(jars: list[Jar]) -> str:
    """The jars as Ivy's dependencies: those of one module, with and without a classifier, are named together."""
    module = ElementTree.Element("ivy-module", {"version": "2.0", "xmlns:m": "http://ant.apache.org/ivy/maven"})
    ElementTree.SubElement(module, "info", organisation="bokeh", module="sample")
    dependencies = ElementTree.SubElement(module, "dependencies")
    for (group, name, version), same in groupby(jars, key=lambda jar: jar[:3]):
        place = {"org": group, "name": name, "rev": version, "transitive": "false"}
        dependency = ElementTree.SubElement(dependencies, "dependency", place)
        for jar in same:
            classifier = {"m:classifier": jar.classifier} if jar.classifier else {}
            ElementTree.SubElement(dependency, "artifact", {"name": name, "type": "jar", "ext": "jar", **classifier})
    return ElementTree.tostring(module, encoding="unicode")
