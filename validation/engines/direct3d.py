"""Build integration/direct3d9 and direct3d11 with mingw-w64 and run them under Wine.

The samples compile their shaders at run time with d3dcompiler_47.dll. Windows includes it; this Wine prefix has
Microsoft's own DLL, because it is the compiler that users have.
"""

import json
from pathlib import Path

import numpy as np
from PIL import Image

from bokeh_validation import paths, pictures, process
from bokeh_validation.numerics.precision import SHADER_MODEL_3
from bokeh_validation.windows import programs, wine

SAMPLES = paths.ROOT / "integration"
# Both samples draw the scene, and write the files, of this one
SHARED = SAMPLES / "direct3d9"
RUN_S = 300.0  # seconds; it takes 5 to 10 on two cores

# Commands that build the samples in their folders; '-o PROGRAM' is appended
BUILDS = {
    "direct3d9": (
        "x86_64-w64-mingw32-gcc", "-std=c11", "-O2", "-Wall", "-static", "main.c", "-ld3d9", "-ld3dcompiler_47",
    ),
    "direct3d11": (
        "x86_64-w64-mingw32-g++", "-std=c++20", "-O2", "-Wall", "-static", "main.cpp", "-ld3d11", "-ldxguid",
        "-ld3dcompiler_47",
    ),
}  # fmt: skip


def run(name: str, folder: Path) -> None:
    """Build the sample `name` and run it, which writes its capture and picture.png to `folder`.

    Raises errors.Unavailable, with the install line, without a compiler, Wine or a display, and RuntimeError.
    """
    program, owner = build(name), wine.get()
    # Wine's drive Z: is the root of the file system
    process.run(owner.command(program, f"Z:{folder}"), RUN_S, SAMPLES / name, owner.environment)
    # the sample itself only sees the graphics card that Wine imitates
    capture = folder / "capture.json"
    constants = dict(SHADER_MODEL_3) if name == "direct3d9" else {}
    data = json.loads(capture.read_text()) | {"device": owner.device, "constants": constants}
    capture.write_text(json.dumps(data))
    with Image.open(folder / "picture.bmp") as picture:
        pictures.write_png(folder / "picture.png", np.asarray(picture.convert("RGB")))


def build(name: str) -> Path:
    """Return NAME.exe in the cache folder, rebuilt if a source or the command has changed; see programs.compiled()."""
    return programs.compiled(name, BUILDS[name], sources(name), SAMPLES / name)


def sources(name: str) -> list[Path]:
    """Return the sources that a sample compiles, shared ones included, without the package's own."""
    files = [*(SAMPLES / name).iterdir(), *SHARED.glob("*.h"), *(SAMPLES / "parameters").glob("*.h")]
    return sorted({file for file in files if file.suffix in (".c", ".cpp", ".h", ".hlsl")})
