"""Run the samples that are programs on this machine's OpenGL: in Python, Lua, C++ and Java.

Most of them need a window; it is opened on a virtual display.
"""

import shlex
import sys
from pathlib import Path

from bokeh_validation import locks, needs, paths, process
from bokeh_validation.drivers import gl
from bokeh_validation.errors import Unavailable
from bokeh_validation.process import find

SAMPLES = paths.ROOT / "integration"
SECONDS, INSTALL_SECONDS = 120, 400  # on two cores a sample takes 5
WINDOW = ("raylib", "love", "ogre", "jmonkeyengine")

# Run by a shell in the sample's folder; ' -o PROGRAM' is appended. It takes 4 s of one core.
BUILD_OGRE = (
    "g++ -std=c++17 -O1 -Wall sample.cpp $(pkg-config --cflags --libs OGRE) "
    '-DOGRE_PLUGINS="\\"$(pkg-config --variable=plugindir OGRE)\\""'
)
OGRE = needs.install("ogre")
# Ivy downloads the jars once; it needs a fifteenth of the packages that Maven does
IVY = "/usr/share/java/ivy.jar"
JAVA = needs.install("java")
# A Java runtime has the compiler as a module, though not as a command
JAVAC = ("-m", "jdk.compiler/com.sun.tools.javac.Main", "-Xlint:all", "-Werror")


def run(name: str, folder: Path) -> None:
    """Run a sample, which writes its capture to `folder`. Raises errors.Unavailable, RuntimeError."""
    process.run([*command(name, capture=True), folder], SECONDS, SAMPLES / name)


def command(name: str, capture: bool = False) -> list[str | Path]:
    """Return the command that runs a sample in its folder, without its last argument: an image, or the folder of the
    capture.

    Raises errors.Unavailable, also if there is no OpenGL 3.3, and RuntimeError.
    """
    gl.EGL().context.release()
    window = []
    if name in WINDOW:
        window = [find("xvfb-run", needs.install("window")), "-a"]
    if name == "jmonkeyengine":
        return [*window, *_java(), "Capture" if capture else "Sample"]
    if name in ("love", "ogre"):
        program = [find("love", needs.install("love")), "."] if name == "love" else [_ogre()]
        return [*window, *program, *(["--capture"] if capture else [])]
    return [*window, python(name), "capture.py" if capture else "sample.py"]


def python(name: str) -> Path:
    """Return a Python with the packages of a sample's requirements.txt, if it has one. Raises Unavailable."""
    requirements = SAMPLES / name / "requirements.txt"
    if not requirements.exists():
        return Path(sys.executable)

    def install(folder: Path) -> None:
        pip = [folder / "bin/python", "-I", "-m", "pip", "install", "--disable-pip-version-check", "--no-input"]
        cache = {"PIP_CACHE_DIR": str(paths.cache_folder() / "pip")}
        process.run([sys.executable, "-I", "-m", "venv", folder], INSTALL_SECONDS)
        process.run([*pip, "--require-hashes", "-r", requirements], INSTALL_SECONDS, extra=cache)

    return built(name, "venv", [requirements, sys.version, sys.base_prefix], install) / "bin/python"


def built(name: str, what: str, ingredients: list[str | Path], build) -> Path:
    """Call locks.built_once() for a part of a sample. Raises Unavailable if it cannot be downloaded or built."""
    try:
        return locks.built_once(f"engines/{name}/{what}", ingredients, build)
    except RuntimeError as error:
        raise Unavailable(f"{name}: its {what} is not to be had here ({str(error).splitlines()[-1]})") from error


def _ogre() -> Path:
    """Return Ogre's sample program, rebuilt if a source has changed."""
    sample = SAMPLES / "ogre"

    def build(folder: Path) -> None:
        find("g++", OGRE)
        try:
            process.run([find("pkg-config", OGRE), "--exists", "OGRE >= 1.12", "OGRE < 1.13"], SECONDS)
        except RuntimeError as error:
            raise Unavailable(f"Ogre 1.12 is not installed; {OGRE}") from error
        process.run(["sh", "-c", f"{BUILD_OGRE} -o {shlex.quote(str(folder / 'sample'))}"], SECONDS, sample)

    return locks.built_once("engines/ogre/program", [BUILD_OGRE, *sorted(sample.glob("*.[hc]*"))], build) / "sample"


def _java() -> list[str]:
    """Return the Java command with the sample's classes, recompiled if a source has changed, and the jars of its
    ivy.xml.
    """
    java, sample = find("java", JAVA), SAMPLES / "jmonkeyengine"
    description, sums, sources = sample / "ivy.xml", sample / "jars.sha256", sorted(sample.glob("*.java"))
    cache = paths.ensured(paths.cache_folder() / "engines" / "jmonkeyengine")

    def fetch(folder: Path) -> None:
        if not Path(IVY).exists():
            raise Unavailable(f"Ivy, which fetches the engine, is missing; {JAVA}")
        pattern = folder / "[artifact]-[revision](-[classifier]).[ext]"
        ivy = [java, "-jar", IVY, "-warn", "-ivy", description, "-cache", cache / "ivy", "-retrieve", pattern]
        process.run(ivy, INSTALL_SECONDS)
        process.run(["sha256sum", "--quiet", "--check", sums], SECONDS, folder)

    jars = ":".join(map(str, built("jmonkeyengine", "jars", [description, sums], fetch).glob("*.jar")))

    def build(folder: Path) -> None:
        process.run([java, *JAVAC, "-d", folder, "-cp", jars, *sources], SECONDS)

    classes = locks.built_once("engines/jmonkeyengine/classes", [description, *sources], build)
    natives = f"-Dorg.lwjgl.system.SharedLibraryExtractPath={paths.ensured(cache / 'native')}"
    return [java, "-Djava.awt.headless=true", natives, "-cp", f"{classes}:{jars}"]
