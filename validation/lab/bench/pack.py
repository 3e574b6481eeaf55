"""Write a folder that times the methods on any machine with Python and a GPU: `validation/run bench --pack DIR`.

See script.py.
"""

import json
import re
import shutil
import sys
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path

from bokeh_validation import __version__, paths, plan, process
from bokeh_validation.errors import UserError
from bokeh_validation.frame import methods
from bokeh_validation.numerics.images import Textures
from lab.bench import script

# wgpu and the packages that it imports, from the lock file; the lock was made on Linux, so what macOS needs is added
NEEDED = r"(?m)^(?:cffi|pycparser|wgpu)==.*\n(?: +--hash.*\n)+"
MACOS = "--hash=sha256:3dc76bc29f300ee6b9a4f408748099f70f8472ca59fe70cca42dfa1f2f1bfe3f"
MACOS = f'rubicon-objc==0.5.7 ; sys_platform == "darwin" {MACOS}\n'
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
PIP = "pip download -q --require-hashes --retries 1 --timeout 20 --no-deps --only-binary :all:".split()
PIP += ["--implementation", "cp", "--platform", "manylinux_2_28_x86_64", "--platform", "manylinux_2_17_x86_64"]
LOADER = Path("/usr/lib/x86_64-linux-gnu/libvulkan.so.1")  # containers with NVIDIA's driver often lack it


def fill(folder: Path, settings: Mapping[str, methods.Settings], pictures: Sequence[Textures], wheels: bool) -> None:
    """Write everything to a folder. Raises UserError.

    settings  name -> settings of a frame
    pictures  for each size, 'color' (H, W, 4) float16 and 'depth' (H, W) float32, metres
    wheels    whether to include what Linux x86-64 needs
    """
    sizes = {}
    for color, depth in ((images["color"], images["depth"]) for images in pictures):
        high, wide = depth.shape
        sizes[f"{wide}x{high}"] = {key: plan.frame(one, (wide, high)) for key, one in settings.items()}
        for name, pixels in zip(script.PICTURES, (color, depth), strict=True):
            (folder / f"{name}-{wide}x{high}.bin").write_bytes(zlib.compress(pixels.tobytes()))
    program = [f"wgsl/{stem}.wgsl" for stem in paths.STEMS]
    (folder / "frames.json").write_text(json.dumps({"version": __version__, "files": program, "sizes": sizes}))
    shutil.copyfile(script.__file__, folder / "bench.py")
    shutil.copytree(paths.shaders() / "wgsl", folder / "wgsl")
    lock = (paths.VALIDATION / "requirements.txt").read_text(encoding="ascii")
    (folder / "requirements.txt").write_text("".join(re.findall(NEEDED, lock)) + MACOS)
    for version in PYTHONS if wheels else ():
        into = ["-r", folder / "requirements.txt", "-d", folder / "wheels", "--python-version", version]
        try:
            process.run([sys.executable, "-I", "-m", *PIP, *into], 300)
        except RuntimeError as error:
            reason = str(error).splitlines()[-1]
            raise UserError(f"--wheels: pip failed ({reason}). Needs a network; or leave it out.") from None
    if wheels and LOADER.exists():
        shutil.copyfile(LOADER, folder / "wheels" / LOADER.name)
