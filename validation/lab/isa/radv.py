"""Run RADV, AMD's compiler in the system's Mesa, for a GPU that is not present, and read its statistics."""

import json
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from bokeh_validation import needs
from bokeh_validation.errors import Unavailable
from lab.isa.compiled import Code

PIPELINES = Path(__file__).with_name("pipelines.py")
TIMEOUT_S = 300
DRIVER = Path("/usr/share/vulkan/icd.d/radeon_icd.x86_64.json")
FAMILY, TITLE = "navi21", "AMD RDNA 2, Radeon RX 6800 XT"
# Field of Count -> the driver's name for it
STATISTICS = {
    "instructions": "Instructions",
    "registers": "VGPRs",
    "waves": "Subgroups per SIMD",
    "spills": "Spilled VGPRs",
    "latency": "Latency",
}


@dataclass(frozen=True)
class Count:
    """Hold the compiler's statistics of a pass; instructions of a loop are counted once.

    waves    that a SIMD unit can hold at a time
    latency  cycles of a wave, with eight iterations assumed for a loop
    """

    instructions: int
    registers: int
    waves: int
    spills: int
    latency: int


def counts(code: Code) -> tuple[str, dict[str, Count]]:
    """Return (version of Mesa, name of a pass -> its statistics). Raises Unavailable."""
    if not DRIVER.is_file():
        raise Unavailable(f"needs RADV; {needs.install('vulkan')}")
    with tempfile.TemporaryDirectory(prefix="bokeh-isa-") as folder:

        def file(index: int, content: bytes) -> str:
            Path(folder, f"{index}.spv").write_bytes(content)
            return str(Path(folder, f"{index}.spv"))

        fragments = [
            (name, file(index, content), entry, targets)
            for index, (name, (content, entry, targets)) in enumerate(code.fragments.items(), 1)
        ]
        vertex = file(0, code.vertex[0]), code.vertex[1]
        done = _run(json.dumps({"bindings": code.bindings, "vertex": vertex, "fragments": fragments}))
    try:
        answer = json.loads(done.stdout)
    except ValueError:
        last = done.stderr.strip().splitlines()[-1:]
        raise Unavailable(f"RADV said nothing of a program: {''.join(last) or 'no message'}") from None
    return answer["version"], {
        name: Count(**{field: int(said[key]) for field, key in STATISTICS.items()})
        for name, said in answer["pipelines"].items()
    }


def _run(asked: str) -> subprocess.CompletedProcess:
    """Run PIPELINES in a new process, because the GPU family is chosen when the driver is loaded."""
    environment = {**os.environ, "MESA_SHADER_CACHE_DISABLE": "true", "RADV_FORCE_FAMILY": FAMILY}
    environment["VK_ICD_FILENAMES"] = str(DRIVER)
    options = {"capture_output": True, "text": True, "timeout": TIMEOUT_S, "cwd": "/", "env": environment}
    try:
        return subprocess.run([sys.executable, PIPELINES], input=asked, **options)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise Unavailable(f"RADV did not run: {error}") from error
