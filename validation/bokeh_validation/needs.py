"""List what each command needs in addition to the checkout, with its source, its size, and how to install it.

This is the only such table: setup.py installs from it, doctor prints it, error messages quote it, and a test checks
CONTRIBUTING.md against it. Only the standard library is used here, since setup.py runs before anything is installed.
"""

from collections.abc import Sequence
from dataclasses import dataclass

APT = "apt-get install -y --no-install-recommends"


@dataclass(frozen=True)
class Need:
    """Describe something to be installed or downloaded before some commands can run.

    what       a short description
    megabytes  to download; Debian packages: what they add to the rows above, on Debian 12, amd64
    packages   of Debian and Ubuntu
    extra      of pyproject.toml, if it is one
    elsewhere  how to get it without apt-get, or an alternative
    """

    what: str
    megabytes: int
    packages: tuple[str, ...] = ()
    extra: str = ""
    elsewhere: str = ""

    @property
    def source(self) -> str:
        """Return who publishes it."""
        if self.extra:
            return "PyPI"
        return "Debian" if self.packages else self.elsewhere


def _debian(what: str, megabytes: int, packages: str, elsewhere: str = "") -> Need:
    return Need(what, megabytes, tuple(packages.split()), elsewhere=elsewhere)


NEEDS = {
    "core": Need("Python packages, with glslang and SPIRV-Tools", 72, extra="core"),
    "web": Need("Playwright, which drives Chromium", 54, extra="web"),
    "lab": Need("Vulkan for Python", 1, extra="lab"),
    "opengl": _debian("Mesa's OpenGL", 54, "libosmesa6 libgl1-mesa-dri libegl1 libgl1"),
    "vulkan": _debian("Mesa's Vulkan, for wgpu", 8, "mesa-vulkan-drivers libvulkan1 libatomic1"),
    "spirv-cross": _debian("SPIR-V to Metal's language", 1, "spirv-cross", "Vulkan SDK"),
    "wine": _debian("Wine, MinGW, a display", 205, "wine wine64 g++-mingw-w64-x86-64-posix xvfb xauth"),
    "chromium": _debian("Chromium", 137, "chromium", "Ubuntu, where that is a snap: install google-chrome"),
    "npm": _debian("npm", 26, "npm", "https://nodejs.org"),
    "mono": _debian("C# compiler", 11, "mono-mcs"),
    "love": _debian("LÖVE", 4, "love"),
    "java": _debian("Java, and Ivy, which fetches jMonkeyEngine", 45, "default-jre-headless ivy"),
    "ogre": _debian("Ogre and a C++ compiler", 62, "g++ pkg-config libogre-1.12-dev"),
    "vulkan-sdk": _debian(
        "Vulkan's headers, validation layers, glslangValidator", 11,
        "g++ libvulkan-dev glslang-tools vulkan-validationlayers",
    ),
    "reshade": _debian("ReShade's effects on Vulkan", 1, "vkbasalt vulkan-tools xvfb xauth mesa-vulkan-drivers"),
    # setup.py installs none of the following: a wheel in core has the first, commands download DXC, fxc and Slang, and
    # you install the last yourself
    "glslang": _debian("shader compilers, where no wheel has them", 6, "glslang-tools spirv-tools", "Vulkan SDK"),
    "window": _debian("a display for samples with a window", 1, "xvfb xauth libgl1 libgl1-mesa-dri"),
    "dxc": Need("Microsoft's DXC, into the cache folder", 67, elsewhere="PyPI, compushady"),
    "fxc": Need("Microsoft's d3dcompiler_47, into the cache folder", 9, elsewhere="PyPI, kivy-deps-angle"),
    "slang": Need("Slang's compiler, into the cache folder", 88, elsewhere="PyPI, slangpy"),
    "cargo": Need("Rust 1.97.1 or later, and Bevy's crates", 210, elsewhere="https://rustup.rs"),
}  # fmt: skip

DRAWN = ("core", "opengl", "vulkan")
BROWSER = ("web", "chromium", "npm")
ENGINES = ("mono", "love", "java", "ogre", "vulkan-sdk", "reshade")
EVERYTHING = (*DRAWN, "spirv-cross", "lab", "wine", *BROWSER, *ENGINES, "dxc", "fxc", "slang")

# Needs of each command; '' is validation/run alone, 'test' is validation/test.
COMMANDS = {
    **dict.fromkeys(("parity", "plan", "generate", "aperture", "doctor"), ("core",)),
    **dict.fromkeys(("render", "compare", "truth", "pictures"), ("core", "opengl")),
    **dict.fromkeys(("check", "bench", "mutants"), (*DRAWN, "dxc")),
    "probes": DRAWN,
    "isa": (*DRAWN, "lab", "dxc"),
    "peers": (*DRAWN, *BROWSER),
    "demo": ("core", "opengl", *BROWSER),
    "compile": (*DRAWN, "spirv-cross", "wine", *BROWSER, "dxc", "fxc", "slang"),
    "": (*DRAWN, "spirv-cross", "wine", "dxc", "fxc"),
    "engines": EVERYTHING,
    "test": EVERYTHING,
}
# Words of a command line that add needs, by how the words begin
WORDS = {
    **dict.fromkeys(("d3d9", "--driver=d3d"), ("wine", "fxc")),
    **dict.fromkeys(("webgl2", "webgpu", "--driver=web"), BROWSER),
    "--full": EVERYTHING,
}
QUIET = {"-h", "--help", "--version"}


def of(arguments: Sequence[str]) -> tuple[str, ...]:
    """Return the names of what a command line of validation/run needs, so that asking for the version installs no
    Wine.
    """
    if QUIET & set(arguments):
        return ("core",)
    command = next((word for word in arguments if word in COMMANDS), "")
    words = (names for word in arguments for start, names in WORDS.items() if word.startswith(start))
    return tuple(dict.fromkeys([*COMMANDS[command], *(name for names in words for name in names)]))


def megabytes(*commands: str) -> int:
    """Return the size of the downloads for these commands together on a fresh machine, MB."""
    return sum(NEEDS[name].megabytes for name in {name for command in commands for name in COMMANDS[command]})


def install(name: str) -> str:
    """Return how to install a need, worded as the end of a message about what is missing."""
    need = NEEDS[name]
    if need.extra:
        return f'commands that need it fetch it, or pip install -e "validation[{need.extra}]"'
    debian = f"{APT} {' '.join(need.packages)}" if need.packages else ""
    return f"{debian} ({need.elsewhere})" if debian and need.elsewhere else debian or need.elsewhere


def packages(names: Sequence[str]) -> tuple[str, ...]:
    """Return the Debian and Ubuntu packages of these needs, without duplicates."""
    return tuple(dict.fromkeys(package for name in names for package in NEEDS[name].packages))


def extras(names: Sequence[str]) -> tuple[str, ...]:
    """Return the extras of pyproject.toml among these needs, core first."""
    return tuple(extra for extra in ("core", "lab", "web") if any(NEEDS[name].extra == extra for name in names))
