"""The GPUs that `validation/run isa` compiles for: how their compilers are run, and how their code is counted."""

import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from bokeh_validation import paths
from bokeh_validation.errors import Unavailable
from bokeh_validation.isa import trees

PIPELINES, GLES_PROGRAMS = (Path(__file__).with_name(name) for name in ("pipelines.py", "gles_programs.py"))
TIMEOUT_S = 300
STOCK_ICD = Path("/usr/share/vulkan/icd.d/radeon_icd.x86_64.json")


@dataclass(frozen=True)
class Family:
    """What the compilers of one vendor tell.

    statistics  'instructions', 'registers', 'waves', 'spills' -> the driver's name of it; 'waves' may be missing
    texture     pattern of a line of code that fetches from a texture
    slow        pattern of a line of the special functions: square roots, sines, logarithms. Their unit works beside the
                others and takes `slow_slots` of their issue slots for one
    slots       pattern of a line that takes one issue slot
    """

    statistics: Mapping[str, str]
    texture: re.Pattern
    slow: re.Pattern
    slots: re.Pattern
    slow_slots: int


# Scalar instructions are issued beside the vector ones. Special functions: a quarter of the rate.
AMD = Family(
    {"instructions": "Instructions", "registers": "VGPRs", "waves": "Subgroups per SIMD", "spills": "Spilled VGPRs"},
    re.compile(r"^\timage_"),
    re.compile(r"^\tv_(rcp|rsq|sqrt|sin|cos|exp|log)_"),
    re.compile(r"^\tv_"),
    4,
)
# An SM of Ampere issues four warps of 32 a cycle; its special functions and conversions: 16 lanes a cycle.
NVIDIA = Family(
    {"instructions": "Instruction count", "registers": "Number of GPRs", "spills": "SLM Size"},
    re.compile(r"= (tex|tld|tld4|txd)\b"),
    re.compile(r"= (mufu|f2i|i2f|f2f)\b"),
    re.compile(r"delay="),
    8,
)
# A line stands for as many repetitions as (rptN) says; other waves run while one waits, so nop is free. What comes
# before `shpe` is executed once a draw.
ADRENO = Family(
    {
        "instructions": "Instruction Count",
        "registers": "Registers used",
        "waves": "Max Waves Per Core",
        "spills": "STP Count",
    },
    re.compile(r"^(?:\([^)]*\)\s*)*(sam|isam|gather4)"),
    re.compile(r"^(?:\([^)]*\)\s*)*(rcp|rsq|sqrt|sin|cos|exp2|log2|hrsq|hlog2|hexp2)\b"),
    re.compile(r"^(?!;|@|\s*$|(\([^)]*\)\s*)*nop)"),
    4,
)


@dataclass(frozen=True)
class Count:
    """A program on one GPU. All but the last are of the whole program, a loop counted once.

    texture  instructions that fetch
    slots    issue slots of a pixel: of its vector instructions, or of its special functions where those take longer
    waves    that a unit holds at a time, 0 where the compiler does not tell
    """

    instructions: int
    texture: int
    slots: int
    registers: int
    waves: int
    spills: int


@dataclass(frozen=True)
class Target:
    """A GPU.

    run       the input of PIPELINES or GLES_PROGRAMS -> its finished process; raises Unavailable
    profile   of the GLSL that its compiler takes: 450 as SPIR-V, or 300es
    """

    name: str
    title: str
    family: Family | None
    run: Callable[[str], subprocess.CompletedProcess]
    profile: str = "450"

    def counts(self, vertex: bytes, fragments: Mapping[str, tuple[bytes, int]]) -> tuple[str, dict[str, Count]]:
        """(version of Mesa, what its compiler makes of programs): name -> (SPIR-V or text, number of targets).

        Raises Unavailable.
        """
        with tempfile.TemporaryDirectory(prefix="bokeh-isa-") as folder:
            files = {name: Path(folder, f"{index}.spv") for index, name in enumerate(["", *fragments])}
            files[""].write_bytes(vertex)
            for name, (code, _) in fragments.items():
                files[name].write_bytes(code)
            listed = [[name, str(files[name]), targets] for name, (_, targets) in fragments.items()]
            try:
                done = self.run(json.dumps({"vertex": str(files[""]), "fragments": listed}))
            except (OSError, subprocess.TimeoutExpired) as error:
                raise Unavailable(f"its compiler did not run: {error}") from error
        if self.profile == "300es":
            return trees.MESA, self._told(done.stderr)
        try:
            found = json.loads(done.stdout)
        except ValueError:
            said = done.stderr.strip().splitlines()
            raise Unavailable(f"its compiler told nothing: {said[-1] if said else 'no message'}") from None
        return found["version"], {name: self._count(*told) for name, told in found["pipelines"].items()}

    def _told(self, text: str) -> dict[str, Count]:
        """From the lines that a driver writes: those of a program come before its name."""
        found = {}
        for part in re.split(r"^(?=## )", text, flags=re.MULTILINE):
            name = part.partition("\n")[0].removeprefix("## ")
            found[name] = part
        before, counts = next(iter(found.values()), ""), {}
        for name, part in list(found.items())[1:]:
            told = re.findall(r"MESA_SHADER_FRAGMENT shader: (.*)", before)
            if not told:
                raise Unavailable(f"its compiler told nothing of {name}")
            counts[name] = _of_line(told[-1])
            before = part
        if not counts:
            raise Unavailable(f"its compiler told nothing: {text.strip().splitlines()[-1:]}")
        return counts

    def _count(self, statistics: Mapping[str, float], code: str) -> Count:
        found = {key: int(statistics[name]) for key, name in self.family.statistics.items()}
        texture = slots = slow = 0
        for line in code.rpartition("shpe\n")[2].splitlines():
            repeated = re.search(r"\(rpt(\d)\)", line)
            times = 1 + (int(repeated[1]) if repeated else 0)
            texture += bool(self.family.texture.search(line))
            slow += times * bool(self.family.slow.search(line))
            slots += times * bool(self.family.slots.search(line))
        return Count(texture=texture, slots=max(slots, slow * self.family.slow_slots), **{"waves": 0, **found})


def _of_line(line: str) -> Count:
    """A line such as '637 inst, 4.75 t, 1 threads, 0 loops, 0:0 spills:fills'; what it does not tell is 0."""
    told = {name: float(number) for number, name in re.findall(r"([\d.]+) ([a-z][\w-]*)", line)}
    # a fetch takes a quarter of a cycle on Valhall, half of one on Bifrost
    fetches = 4.0 * told.get("t", 0.0) + 2.0 * told.get("texture", 0.0)
    spills = int(re.search(r"(\d+):\d+ spills", line)[1])
    return Count(int(told["inst"]), round(fetches), 0, int(told.get("max-temps", 0)), int(told["threads"]), spills)


def _run(command: list[str], given: str, **variables: str) -> subprocess.CompletedProcess:
    environment = {**os.environ, "MESA_SHADER_CACHE_DISABLE": "true", **variables}
    return subprocess.run(
        command, input=given, env=environment, capture_output=True, text=True, timeout=TIMEOUT_S, cwd="/"
    )


def _stock(family: str) -> Callable[[str], subprocess.CompletedProcess]:
    """RADV of the system's own Mesa, without a device."""

    def run(given: str) -> subprocess.CompletedProcess:
        if not STOCK_ICD.is_file():
            raise Unavailable("needs RADV: sudo apt-get install -y mesa-vulkan-drivers")
        return _run([sys.executable, str(PIPELINES)], given, RADV_FORCE_FAMILY=family, VK_ICD_FILENAMES=str(STOCK_ICD))

    return run


def _unpacked(driver: str, shim: str = "", **variables: str) -> Callable[[str], subprocess.CompletedProcess]:
    """A driver of the unpacked system, through its own loader; `shim` stands in for the kernel's driver."""

    def run(given: str) -> subprocess.CompletedProcess:
        root = trees.tree("amd64")
        libraries = root / trees.LIBRARIES["amd64"]
        icd = paths.ensured(root / "icd") / f"{driver}.json"
        icd.write_text(json.dumps({"file_format_version": "1.0.0", "ICD": {
            "api_version": "1.1", "library_path": str(libraries / f"libvulkan_{driver}.so")}}))  # fmt: skip
        preload = ["--preload", str(libraries / f"lib{shim}_noop_drm_shim.so")] if shim else []
        loader = [str(root / "lib64/ld-linux-x86-64.so.2"), "--library-path", str(libraries), *preload]
        python = [str(root / "usr/bin/python3"), str(PIPELINES)]
        where = {"PYTHONHOME": str(root / "usr"), "PYTHONPATH": _binding(root), "VK_ICD_FILENAMES": str(icd)}
        return _run([*loader, *python], given, **where, **variables)

    return run


def _emulated(
    driver: str, shim: str, program: Path = PIPELINES, **variables: str
) -> Callable[[str], subprocess.CompletedProcess]:
    """A driver of the unpacked system for ARM, under qemu."""

    def run(given: str) -> subprocess.CompletedProcess:
        host, root = trees.tree("amd64"), trees.tree("arm64")
        libraries = "/" + trees.LIBRARIES["arm64"]
        qemu = [str(host / "usr/bin/qemu-aarch64"), "-L", str(root)]
        preload = ["-E", f"LD_PRELOAD={libraries}/lib{shim}_noop_drm_shim.so"]
        where = {
            "PYTHONPATH": _binding(root),
            "VK_ICD_FILENAMES": f"/usr/share/vulkan/icd.d/{driver}_icd.json",
            "GBM_BACKENDS_PATH": f"{libraries}/gbm",
            "LIBGL_DRIVERS_PATH": f"{libraries}/dri",
            "__EGL_VENDOR_LIBRARY_FILENAMES": "/usr/share/glvnd/egl_vendor.d/50_mesa.json",
        }
        return _run([*qemu, *preload, str(root / "usr/bin/python3"), str(program)], given, **where, **variables)

    return run


def _binding(root: Path) -> str:
    """A folder that holds the package `vulkan` of this environment and nothing else of it."""
    import vulkan

    link = paths.ensured(root / "binding") / "vulkan"
    if not link.exists():
        link.symlink_to(Path(vulkan.__file__).parent)
    return str(link.parent)


def _mali(name: str, title: str, number: str) -> Target:
    told = {"PAN_MESA_DEBUG": "shaderdb", "BIFROST_MESA_DEBUG": "shaderdb"}
    run = _emulated("panfrost", "panfrost", GLES_PROGRAMS, PAN_GPU_ID=number, **told)
    return Target(name, title, None, run, "300es")


# Part of every run: these three take a few seconds
STOCK = (
    Target("polaris10", "AMD GCN 4, Radeon RX 480", AMD, _stock("polaris10")),
    Target("vega10", "AMD GCN 5, Radeon RX Vega", AMD, _stock("vega10")),
    Target("navi21", "AMD RDNA 2, Radeon RX 6800 XT", AMD, _stock("navi21")),
)
OTHERS = (
    Target("navi31", "AMD RDNA 3, Radeon RX 7900", AMD, _unpacked("radeon", RADV_FORCE_FAMILY="navi31")),
    Target("gfx1201", "AMD RDNA 4, Radeon RX 9070", AMD, _unpacked("radeon", RADV_FORCE_FAMILY="gfx1201")),
    Target("tu106", "NVIDIA Turing, RTX 2070", NVIDIA, _unpacked("nouveau", "nouveau", NOUVEAU_CHIPSET="166")),
    Target("ga102", "NVIDIA Ampere, RTX 3080", NVIDIA, _unpacked("nouveau", "nouveau", NOUVEAU_CHIPSET="172")),
    Target("a660", "Adreno 660", ADRENO, _emulated("freedreno", "freedreno", FD_GPU_ID="660")),
    Target("a740", "Adreno 740", ADRENO, _emulated("freedreno", "freedreno", FD_GPU_ID="740")),
    _mali("g52", "Mali G52", "0x7212"),
    _mali("g610", "Mali G610", "0xa867"),
    Target("vc6", "VideoCore VI", None, _emulated("v3d", "v3d", GLES_PROGRAMS, V3D_DEBUG="shaderdb"), "300es"),
)
# What was looked for and is not to be had this way
MISSING = {
    "NVIDIA Ada": f"the driver of Mesa {trees.MESA} does not start without the hardware",
    "Intel": "Debian does not ship the stand-in for the kernel's driver (libintel_noop_drm_shim)",
}
TARGETS = {target.name: target for target in (*STOCK, *OTHERS)}
