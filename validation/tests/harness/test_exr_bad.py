"""Files that nobody should hand in: refused in one line, within bounded memory and time."""

import json
import os
import struct
import subprocess
import sys
from pathlib import Path

import exr_bytes
import numpy as np
import OpenEXR
import pytest
from exr_bytes import LOSSLESS, LOSSY, RGBZ, SCAN, TILED_IMAGE, refusal, save, save_parts, scene

from bokeh_validation import paths

MEMORY = 2 << 30


@pytest.mark.timeout(20)
def test_no_file(tmp_path):
    """What is no readable file: at once, without waiting for a pipe's writer or reading a device to its end."""
    os.mkfifo(tmp_path / "pipe.exr")
    (tmp_path / "loop.exr").symlink_to(tmp_path / "loop.exr")
    (tmp_path / "closed.exr").write_bytes(b"")
    (tmp_path / "closed.exr").chmod(0)
    refusal(tmp_path / "missing" / "in.exr", "no such file", "Check the path")
    refusal(tmp_path, "is a folder", "Name an EXR file")
    refusal(tmp_path / "pipe.exr", "a pipe or a device")
    refusal(Path("/dev/zero"), "a pipe or a device")
    refusal(tmp_path / "loop.exr", "cannot be read")
    user = os.geteuid()
    # root may read everything: be nobody for as long as it takes
    os.seteuid(user or 65534)
    try:
        refusal(tmp_path / "closed.exr", "may not be read", "permissions")
    finally:
        os.seteuid(user)


READ_ALL = """
import json, re, resource, sys, time
from pathlib import Path
from bokeh_validation import exr
from bokeh_validation.errors import UserError

def resident(line):
    return int(re.search(line + r":\\s+(\\d+) kB", Path("/proc/self/status").read_text())[1]) << 10

resource.setrlimit(resource.RLIMIT_AS, (int(sys.argv[1]),) * 2)
results = {}
for path in sorted(Path(sys.argv[2]).iterdir()):
    # the peak starts again from here; that of getrusage would be the parent's, where it is larger
    Path("/proc/self/clear_refs").write_text("5")
    before, began = resident("VmHWM"), time.monotonic()
    try:
        said = str(exr.read(path).size)
    except UserError as error:
        said = str(error)
    results[path.name] = said, time.monotonic() - began, resident("VmHWM") - before
print(json.dumps(results))
"""


def read_all(folder: Path) -> dict[str, tuple[str, float, int]]:
    """Every file of a folder, read in one process that may take MEMORY: what was said, seconds, bytes at the peak.

    Fails where the process dies or prints what it was not told to, and where a refusal is no line that names the file.
    """
    environment = {**os.environ, "PYTHONPATH": str(paths.VALIDATION)}
    command = [sys.executable, "-P", "-c", READ_ALL, str(MEMORY), str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, env=environment)
    assert done.returncode == 0 and not done.stderr, (done.returncode, done.stderr[-2000:])
    results = json.loads(done.stdout)
    for name, (said, _, _) in results.items():
        assert said.startswith("(") or (f"{folder}/{name}: " in said and said.isprintable()), (name, said)
    return results


FLIPPED = 600


def test_cut_off_and_flipped_bytes(tmp_path):
    """Small valid files of every format, damaged: refused or, some with other bytes, read; all within MEMORY.

    Each is cut off after k sixteenths of its bytes, k = 0 .. 15, and before its last. 600 have 1 to 11 bytes changed,
    in the header or anywhere; the number in their names is the seed that made it.
    """
    channels, good, cut, flipped = scene(), {}, tmp_path / "cut", tmp_path / "flipped"
    for compression in LOSSLESS + LOSSY:
        for kind in (SCAN, TILED_IMAGE):
            header = {"compression": getattr(OpenEXR, f"{compression}_COMPRESSION"), "type": kind}
            good[f"{compression}-{kind.name}"] = save(tmp_path / "x", channels, **header).read_bytes()
    parts = {"rgba": {n: channels[n] for n in "RGB"}, "depth": {"Z": channels["Z"]}}
    good["parts"] = save_parts(tmp_path / "x", parts).read_bytes()
    good["mipmaps"] = exr_bytes.tiled(tmp_path / "x", channels, (16, 16), 1).read_bytes()
    cut.mkdir(), flipped.mkdir()
    for name, data in good.items():
        # the last byte of mipmaps is one of a level that is not read
        last = [len(data) - 1] if name != "mipmaps" else []
        for length in (*(len(data) * k // 16 for k in range(16)), *last):
            (cut / f"{name}-{length}.exr").write_bytes(data[:length])
    for seed in range(FLIPPED):
        name, data = list(good.items())[seed % len(good)]
        random, changed = np.random.default_rng(seed), bytearray(data)
        reach = len(data) if seed // len(good) % 2 else min(700, len(data))
        for at in random.integers(0, reach, random.integers(1, 12)):
            changed[at] = random.choice([0, 1, 0x7F, 0x80, 0xFF, random.integers(256)])
        (flipped / f"{seed}-{name}.exr").write_bytes(changed)
    said = [said for said, _, _ in read_all(cut).values()]
    assert len(said) == 17 * len(good) - 1 and all("cannot be read as OpenEXR" in line for line in said)
    read = sum(said.startswith("(") for said, _, _ in read_all(flipped).values())
    assert FLIPPED / 20 < read < FLIPPED / 2


LARGE, SMALL = (0, 0, 16383, 16383), (0, 0, 7, 7)
HEAD, HEAD_SMALL = exr_bytes.header(RGBZ, LARGE), exr_bytes.header(RGBZ, SMALL)
PARTS = struct.pack("<II", exr_bytes.MAGIC, 2 | exr_bytes.MULTI_PART)
THOUSANDS = {f"c{number:04}": "float16" for number in range(2000)}


def tiled_header(window: tuple[int, int, int, int], width: int, height: int, kinds=RGBZ) -> bytes:
    """The header of a tiled image."""
    return exr_bytes.header(kinds, window, flags=exr_bytes.TILED, more=exr_bytes.tiles(width, height))


def with_attribute(data: bytes, size: int | None = None) -> bytes:
    """HEAD with one attribute more, which says that it has `size` bytes."""
    return HEAD[:-1] + exr_bytes.attribute("a", "string", data, size) + b"\0"


def with_channels(kinds: dict[str, str], sampled: dict[str, tuple[int, int]] | None = None) -> bytes:
    """A whole file of 4 rows with channels at fewer pixels."""
    head = exr_bytes.header({}, (0, 0, 5, 3), channels=exr_bytes.channels(kinds, sampled))
    return exr_bytes.with_table(head, [bytes(64)] * 4)


TOO_MANY, DEEP = "are more than 268435456", ("deep image", "Save it flattened")
MANY = exr_bytes.header({f"c{number:06}": "float16" for number in range(100_000)}, SMALL)
DEEP_TYPE = exr_bytes.attribute("type", "string", b"deepscanline")
# files of at most 16 MB, and words of the line that refuses them
BAD = {
    "empty": (b"", "it is empty"),
    "a picture of another kind": (b"\x89PNG\r\n\x1a\n" * 9, "does not begin"),
    "deep by its flag": (exr_bytes.header(RGBZ, SMALL, flags=exr_bytes.DEEP) + bytes(200), *DEEP),
    "deep by its type": (PARTS + exr_bytes.header(RGBZ, SMALL, more=DEEP_TYPE)[8:] + bytes(200), *DEEP),
    "chroma": (
        with_channels(dict.fromkeys(("BY", "RY", "Y"), "float16"), {"BY": (2, 2), "RY": (2, 2)}),
        "no channel R, G, B (it has BY RY Y: luminance and chroma",
    ),
    "B and R in half the columns": (
        with_channels(dict.fromkeys("BGR", "float16"), {"B": (2, 1), "R": (2, 1)}),
        "R, G and B differ in size",
    ),
    "Z in a quarter": (
        with_channels(RGBZ, {"Z": (2, 2)}),
        "depth channel 'Z' differs in size",
        "Save both at one size",
    ),
    "terminal codes": (with_channels({"a\nb\x1b[31m": "float16"}), "no channel R, G, B", "a b?[31m"),
    "windows apart": (
        exr_bytes.header(RGBZ, (50, 0, 90, 69), (0, 0, 49, 69)) + bytes(8),
        "41 x 70 at 50,0",
        "outside of the display window",
    ),
    "header": (HEAD, "cut off behind its header"),
    "header and table of zeros": (HEAD + bytes(8 * 16384), "not enough memory"),
    "chunks without pixels": (
        exr_bytes.with_table(
            exr_bytes.header(RGBZ, LARGE, compression=3),
            [struct.pack("<ii", 16 * number, 4) + bytes(4) for number in range(1024)],
        ),
        "not enough memory",
    ),
    "table of zeros": (HEAD_SMALL + bytes(8 * 8), "cannot be read as OpenEXR"),
    "table that points outside": (HEAD_SMALL + b"\x7f" * (8 * 8), "cannot be read as OpenEXR"),
    "2^32": (exr_bytes.header(RGBZ, (-(2**31), -(2**31), 2**31 - 1, 2**31 - 1)), TOO_MANY),
    "display 2^31": (exr_bytes.header(RGBZ, SMALL, (0, 0, 2**31 - 1, 9)), TOO_MANY),
    "negative": (exr_bytes.header(RGBZ, (5, 5, -900, -900)), "the image is empty (-904 x -904"),
    "many channels": (MANY, "more than 65536 attributes and channels"),
    "many parts": (PARTS + HEAD_SMALL[8:] * 20_000 + b"\0", "more than 65536 attributes and channels"),
    "many passes": (
        exr_bytes.header(dict(list(THOUSANDS.items())[:180]), LARGE) + bytes(9),
        "90.0 GiB",
    ),
    "many channels in a tile": (tiled_header(SMALL, 2048, 2048, THOUSANDS) + bytes(9), "15.6 GiB unpacked"),
    "tiles of nothing": (tiled_header(LARGE, 0, 0), "tiles of 0 x 0"),
    "a tile a pixel too large": (exr_bytes.wide_tile(2048, 2048, 2049), "cover 2048 x 2049"),
    "a tall tile": (tiled_header(SMALL, 8, 2**24) + bytes(99), "tiles of 8 x 16777216"),
    "tiles of 1 x 1": (tiled_header((0, 0, 8191, 8191), 1, 1) + bytes(99), "cannot be read as OpenEXR"),
    "an attribute of -1": (with_attribute(b"", -1), "header is cut off"),
    "an attribute of 16 MB": (with_attribute(bytes(1 << 24)), "longer than 16 MiB"),
    "a name without end": (HEAD[:-1] + b"n" * 9999, "name longer than 255 bytes"),
    "no data window": (exr_bytes.header(RGBZ, SMALL, dataWindow=b""), "no valid dataWindow"),
    "no compression": (exr_bytes.header(RGBZ, SMALL, compression=99) + bytes(64), "cannot be read as OpenEXR"),
}


def test_bad_files(tmp_path):
    """What promises more than it holds, or what no scene is: refused before memory is taken.

    One process reads them all with MEMORY of addresses, of which a 16k x 16k image alone would need more. What it takes
    is the header's 16 MB and what Python makes of 65536 channels, some 500 bytes each: less than 64 MB.
    """
    for name, (data, *_) in BAD.items():
        (tmp_path / name).write_bytes(data)
    results = read_all(tmp_path)
    for name, (_, *words) in BAD.items():
        said, seconds, growth = results[name]
        assert [word for word in words if word not in said] == [], (name, said)
        assert seconds < 10 and growth < 64 << 20, (name, seconds, growth)


def test_memory(tmp_path):
    """A file may be a thousandth of its pixels: its channels, 10 bytes a pixel, the scene, 12, and little more.

    More are two masks of a byte a pixel in the search for NaN, and the library's own buffers: 32 MB are allowed for.
    The widest tiles that are let pass are 4 x 1024 x 1024 pixels.
    """
    size = 3000
    channels = {name: np.zeros((size, size), np.float32 if name == "Z" else np.float16) for name in "RGBZ"}
    save(tmp_path / "bomb", channels)
    save(tmp_path / "bad bomb", {name: plane + np.nan for name, plane in channels.items()})
    (tmp_path / "wide").write_bytes(exr_bytes.wide_tile(65536, 65536, 64))
    assert (tmp_path / "bomb").stat().st_size * 500 < 10 * size**2
    results = read_all(tmp_path)
    assert results["bomb"][0] == f"({size}, {size})" and results["wide"][0] == "(65536, 1)"
    assert f"{size**2} pixels of channel R are NaN or infinite, the first at column 0, row 0" in results["bad bomb"][0]
    assert 20 * size**2 < results["bomb"][2] < (10 + 12 + 2) * size**2 + (32 << 20)
    assert 10 * size**2 < results["bad bomb"][2] < (10 + 2) * size**2 + (32 << 20)
    assert results["wide"][2] < 10 * 4 * 1024**2 + 12 * 65536 + (32 << 20)
