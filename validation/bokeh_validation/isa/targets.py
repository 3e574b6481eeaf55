"""The GPUs that `validation/run isa` compiles for: how their compilers are run, and how their code is counted."""

import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from bokeh_validation import paths
from bokeh_validation.errors import Unavailable
from bokeh_validation.isa import trees
from bokeh_validation.isa.compiled import Code

PIPELINES, GLES_PROGRAMS = (Path(__file__).with_name(name) for name in ("pipelines.py", "gles_programs.py"))
TIMEOUT_S = 300
STOCK_ICD = Path("/usr/share/vulkan/icd.d/radeon_icd.x86_64.json")


@dataclass(frozen=True)
class Family:
    """What the compilers of one vendor say.

    statistics  field of Count -> the driver's name of it; 'waves' and 'latency' may be missing
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
    {
        "instructions": "Instructions",
        "registers": "VGPRs",
        "waves": "Subgroups per SIMD",
        "spills": "Spilled VGPRs",
        "latency": "Latency",
    },
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
    """A program on one GPU, a loop counted once.

    texture  instructions that fetch
    slots    issue slots of a pixel: of its vector instructions, or of its special functions where those take longer
    waves    that a unit holds at a time, 0 where the compiler does not say
    latency  cycles of a wave by AMD's compiler, which takes a loop as eight iterations; 0 of others
    """

    instructions: int
    texture: int
    slots: int
    registers: int
    waves: int
    spills: int
    latency: int = 0


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

    @property
    def languages(self) -> tuple[str, ...]:
        """Those that its compiler takes."""
        return ("glsl", "hlsl") if self.profile == "450" else ("glsl",)

    def counts(self, code: Code) -> tuple[str, dict[str, Count]]:
        """(version of Mesa, what its compiler makes of programs by their names). Raises Unavailable."""
        with tempfile.TemporaryDirectory(prefix="bokeh-isa-") as folder:

            def file(index: int, content: bytes) -> str:
                Path(folder, f"{index}.spv").write_bytes(content)
                return str(Path(folder, f"{index}.spv"))

            fragments = [
                (name, file(index, content), entry, targets)
                for index, (name, (content, entry, targets)) in enumerate(code.fragments.items(), 1)
            ]
            vertex = file(0, code.vertex[0]), code.vertex[1]
            try:
                done = self.run(json.dumps({"bindings": code.bindings, "vertex": vertex, "fragments": fragments}))
            except (OSError, subprocess.TimeoutExpired) as error:
                raise Unavailable(f"its compiler did not run: {error}") from error
        try:
            if self.profile == "300es":
                return trees.MESA, _of_lines(done.stderr)
            answer = json.loads(done.stdout)
        except ValueError:
            last = done.stderr.strip().splitlines()[-1:]
            raise Unavailable(f"its compiler said nothing of a program: {''.join(last) or 'no message'}") from None
        return answer["version"], {name: self._count(*counted) for name, counted in answer["pipelines"].items()}

    def _count(self, statistics: Mapping[str, float], code: str) -> Count:
        numbers = {key: int(statistics[name]) for key, name in self.family.statistics.items()}
        texture = slots = slow = 0
        for line in code.rpartition("shpe\n")[2].splitlines():
            repeated = re.search(r"\(rpt(\d)\)", line)
            times = 1 + (int(repeated[1]) if repeated else 0)
            texture += bool(self.family.texture.search(line))
            slow += times * bool(self.family.slow.search(line))
            slots += times * bool(self.family.slots.search(line))
        return Count(texture=texture, slots=max(slots, slow * self.family.slow_slots), **{"waves": 0, **numbers})


def _of_lines(text: str) -> dict[str, Count]:
    """From the lines that a driver writes: those of a program come before its name. Raises ValueError."""
    counts, last = {}, ""
    for line in text.splitlines():
        if line.startswith("## "):
            counts[line.removeprefix("## ")], last = _of_line(last), ""
        elif "MESA_SHADER_FRAGMENT shader: " in line:
            last = line.partition("shader: ")[2]
    if not counts:
        raise ValueError("no program")
    return counts


def _of_line(line: str) -> Count:
    """A line such as '637 inst, 4.75 t, 1 threads, 0 loops, 0:0 spills:fills'; what it does not say is 0."""
    numbers = {name: float(number) for number, name in re.findall(r"([\d.]+) ([a-z][\w-]*)", line)}
    spills = re.search(r"(\d+):\d+ spills", line)
    if not spills:
        raise ValueError("nothing of a program")
    # a fetch takes a quarter of a cycle on Valhall, half of one on Bifrost
    fetches = round(4.0 * numbers.get("t", 0.0) + 2.0 * numbers.get("texture", 0.0))
    registers, waves = int(numbers.get("max-temps", 0)), int(numbers["threads"])
    return Count(int(numbers["inst"]), fetches, 0, registers, waves, int(spills[1]))


def _run(command: Sequence[object], given: str, **variables: str) -> subprocess.CompletedProcess:
    environment = {**os.environ, "MESA_SHADER_CACHE_DISABLE": "true", **variables}
    options = {"capture_output": True, "text": True, "timeout": TIMEOUT_S, "cwd": "/"}
    return subprocess.run(list(map(str, command)), input=given, env=environment, **options)


def _stock(family: str, given: str) -> subprocess.CompletedProcess:
    """RADV of the system's own Mesa, without a device."""
    if not STOCK_ICD.is_file():
        raise Unavailable("needs RADV: sudo apt-get install -y mesa-vulkan-drivers")
    return _run([sys.executable, PIPELINES], given, RADV_FORCE_FAMILY=family, VK_ICD_FILENAMES=str(STOCK_ICD))


def _unpacked(driver: str, shim: str, given: str, **variables: str) -> subprocess.CompletedProcess:
    """A driver of the unpacked system, through its own loader; `shim`, if any, stands in for the kernel's driver."""
    root = trees.tree("amd64")
    libraries = root / trees.LIBRARIES["amd64"]
    icd = paths.ensured(root / "icd") / f"{driver}.json"
    library = {"api_version": "1.1", "library_path": str(libraries / f"libvulkan_{driver}.so")}
    icd.write_text(json.dumps({"file_format_version": "1.0.0", "ICD": library}))
    loader = [root / "lib64/ld-linux-x86-64.so.2", "--library-path", libraries]
    preload = ["--preload", libraries / f"lib{shim}_noop_drm_shim.so"] if shim else []
    where = {"PYTHONHOME": str(root / "usr"), "PYTHONPATH": _binding(root), "VK_ICD_FILENAMES": str(icd)}
    return _run([*loader, *preload, root / "usr/bin/python3", PIPELINES], given, **where, **variables)


def _emulated(driver: str, program: Path, given: str, **variables: str) -> subprocess.CompletedProcess:
    """A driver of the unpacked system for ARM, under qemu."""
    host, root = trees.tree("amd64"), trees.tree("arm64")
    libraries = "/" + trees.LIBRARIES["arm64"]
    qemu = [host / "usr/bin/qemu-aarch64", "-L", root, "-E", f"LD_PRELOAD={libraries}/lib{driver}_noop_drm_shim.so"]
    where = {
        "PYTHONPATH": _binding(root),
        "VK_ICD_FILENAMES": f"/usr/share/vulkan/icd.d/{driver}_icd.json",
        "GBM_BACKENDS_PATH": f"{libraries}/gbm",
        "LIBGL_DRIVERS_PATH": f"{libraries}/dri",
        "__EGL_VENDOR_LIBRARY_FILENAMES": "/usr/share/glvnd/egl_vendor.d/50_mesa.json",
    }
    return _run([*qemu, root / "usr/bin/python3", program], given, **where, **variables)


def _binding(root: Path) -> str:
    """A folder that holds the package `vulkan` of this environment and nothing else of it."""
    import vulkan

    link = paths.ensured(root / "binding") / "vulkan"
    link.unlink(missing_ok=True)
    link.symlink_to(Path(vulkan.__file__).parent)
    return str(link.parent)


SHADERDB = {"PAN_MESA_DEBUG": "shaderdb", "BIFROST_MESA_DEBUG": "shaderdb", "V3D_DEBUG": "shaderdb"}
NVK = partial(_unpacked, "nouveau", "nouveau")
TURNIP = partial(_emulated, "freedreno", PIPELINES)
PANFROST = partial(_emulated, "panfrost", GLES_PROGRAMS, **SHADERDB)
V3D = partial(_emulated, "v3d", GLES_PROGRAMS, **SHADERDB)
# Part of every run: these three take a few seconds
STOCK = (
    Target("polaris10", "AMD GCN 4, Radeon RX 480", AMD, partial(_stock, "polaris10")),
    Target("vega10", "AMD GCN 5, Radeon RX Vega", AMD, partial(_stock, "vega10")),
    Target("navi21", "AMD RDNA 2, Radeon RX 6800 XT", AMD, partial(_stock, "navi21")),
)
# Not to be had this way: NVIDIA Ada, whose driver of Mesa 25.0.7 does not start without the hardware, and Intel, for
# which Debian ships no stand-in for the kernel's driver
OTHERS = (
    Target("navi31", "AMD RDNA 3, Radeon RX 7900", AMD, partial(_unpacked, "radeon", "", RADV_FORCE_FAMILY="navi31")),
    Target("gfx1201", "AMD RDNA 4, Radeon RX 9070", AMD, partial(_unpacked, "radeon", "", RADV_FORCE_FAMILY="gfx1201")),
    Target("tu106", "NVIDIA Turing, RTX 2070", NVIDIA, partial(NVK, NOUVEAU_CHIPSET="166")),
    Target("ga102", "NVIDIA Ampere, RTX 3080", NVIDIA, partial(NVK, NOUVEAU_CHIPSET="172")),
    Target("a660", "Adreno 660", ADRENO, partial(TURNIP, FD_GPU_ID="660")),
    Target("a740", "Adreno 740", ADRENO, partial(TURNIP, FD_GPU_ID="740")),
    Target("g52", "Mali G52", None, partial(PANFROST, PAN_GPU_ID="0x7212"), "300es"),
    Target("g610", "Mali G610", None, partial(PANFROST, PAN_GPU_ID="0xa867"), "300es"),
    Target("vc6", "VideoCore VI", None, V3D, "300es"),
)
TARGETS = {target.name: target for target in (*STOCK, *OTHERS)}
