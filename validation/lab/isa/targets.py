"""The GPUs that `validation/run isa` compiles for: how their compilers are run, and what these say."""

import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path

from bokeh_validation import paths
from bokeh_validation.errors import Unavailable
from lab.isa import trees
from lab.isa.compiled import Code

PIPELINES, GLES_PROGRAMS = (Path(__file__).with_name(name) for name in ("pipelines.py", "gles_programs.py"))
TIMEOUT_S = 300
STOCK_ICD = Path("/usr/share/vulkan/icd.d/radeon_icd.x86_64.json")
# Field of Count -> the name that a vendor's drivers give it
AMD = {
    "instructions": "Instructions",
    "registers": "VGPRs",
    "waves": "Subgroups per SIMD",
    "spills": "Spilled VGPRs",
    "latency": "Latency",
}
NVIDIA = {"instructions": "Instruction count", "registers": "Number of GPRs", "spills": "SLM Size"}
ADRENO = {
    "instructions": "Instruction Count",
    "registers": "Registers used",
    "waves": "Max Waves Per Core",
    "spills": "STP Count",
}


@dataclass(frozen=True)
class Count:
    """A pass on one GPU, as its compiler says; it counts a loop once. 0 is what it does not say.

    waves    that a unit holds at a time
    latency  cycles of a wave; AMD's takes a loop as eight iterations
    """

    instructions: int
    registers: int
    waves: int
    spills: int
    latency: int


@dataclass(frozen=True)
class Target:
    """A GPU.

    statistics  field of Count -> the driver's name of it; None where the driver writes lines instead
    run         the input of PIPELINES or GLES_PROGRAMS -> its finished process; raises Unavailable
    profile     of the GLSL that its compiler takes: 450 as SPIR-V, or 300es
    """

    title: str
    statistics: Mapping[str, str] | None
    run: Callable[[str], subprocess.CompletedProcess]
    profile: str = "450"

    @property
    def languages(self) -> tuple[str, ...]:
        """Those that its compiler takes, HLSL and WGSL as SPIR-V."""
        return ("glsl", "hlsl", "wgsl") if self.profile == "450" else ("glsl",)

    def counts(self, code: Code) -> tuple[str, dict[str, Count]]:
        """(version of Mesa, name of a pass -> what its compiler makes of it). Raises Unavailable."""
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
        counts = {
            name: _filled({field: said[key] for field, key in self.statistics.items()})
            for name, said in answer["pipelines"].items()
        }
        return answer["version"], counts


def _filled(numbers: Mapping[str, float]) -> Count:
    return Count(**{field.name: int(numbers.get(field.name, 0)) for field in fields(Count)})


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
    spills = re.search(r"(\d+):\d+ spills", line)
    if not spills:
        raise ValueError("nothing of a program")
    said = {name: float(number) for number, name in re.findall(r"([\d.]+) ([a-z][\w-]*)", line)}
    names = {"instructions": "inst", "registers": "max-temps", "waves": "threads"}
    return _filled({field: said.get(name, 0) for field, name in names.items()} | {"spills": int(spills[1])})


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
RADV = partial(_unpacked, "radeon", "")
NVK = partial(_unpacked, "nouveau", "nouveau")
TURNIP = partial(_emulated, "freedreno", PIPELINES)
PANFROST = partial(_emulated, "panfrost", GLES_PROGRAMS, **SHADERDB)
V3D = partial(_emulated, "v3d", GLES_PROGRAMS, **SHADERDB)
SYSTEM = "navi21"  # the one whose compiler comes with the system's Mesa, and takes a second
# Not to be had this way: NVIDIA Ada, whose driver of Mesa 25.0.7 does not start without the hardware, and Intel, for
# which Debian ships no stand-in for the kernel's driver
TARGETS = {
    SYSTEM: Target("AMD RDNA 2, Radeon RX 6800 XT", AMD, partial(_stock, SYSTEM)),
    "polaris10": Target("AMD GCN 4, Radeon RX 480", AMD, partial(_stock, "polaris10")),
    "vega10": Target("AMD GCN 5, Radeon RX Vega", AMD, partial(_stock, "vega10")),
    "navi31": Target("AMD RDNA 3, Radeon RX 7900", AMD, partial(RADV, RADV_FORCE_FAMILY="navi31")),
    "gfx1201": Target("AMD RDNA 4, Radeon RX 9070", AMD, partial(RADV, RADV_FORCE_FAMILY="gfx1201")),
    "tu106": Target("NVIDIA Turing, RTX 2070", NVIDIA, partial(NVK, NOUVEAU_CHIPSET="166")),
    "ga102": Target("NVIDIA Ampere, RTX 3080", NVIDIA, partial(NVK, NOUVEAU_CHIPSET="172")),
    "a660": Target("Adreno 660", ADRENO, partial(TURNIP, FD_GPU_ID="660")),
    "a740": Target("Adreno 740", ADRENO, partial(TURNIP, FD_GPU_ID="740")),
    "g52": Target("Mali G52", None, partial(PANFROST, PAN_GPU_ID="0x7212"), "300es"),
    "g610": Target("Mali G610", None, partial(PANFROST, PAN_GPU_ID="0xa867"), "300es"),
    "vc6": Target("VideoCore VI", None, V3D, "300es"),
}
