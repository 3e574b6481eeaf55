"""Read EXR files as renderers write them, and invalid ones, which must be refused in one line within bounded memory."""

import json
import os
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from support import HANG

from bokeh_validation import exr, paths, render
from bokeh_validation.errors import UserError

COMPRESSIONS = ("NO", "ZIP", "PIZ", "DWAA")
KINDS = {"scan lines": OpenEXR.scanlineimage, "tiles": OpenEXR.tiledimage}
SIZE = 70, 41  # a multiple of no compression's block, tile or chunk


def scene() -> dict[str, np.ndarray]:
    """Return R, G, B and Z with different values in every pixel; lossless compression preserves Z and half floats."""
    random = np.random.default_rng(5)
    planes = {name: (random.integers(0, 2048, SIZE) / 256).astype(np.float16) for name in "RGB"}
    return {**planes, "Z": random.integers(1, 200, SIZE).astype(np.float32)}


def save(path: Path, channels: dict, **header) -> Path:
    """Write one part, as zipped scan lines unless the header says otherwise."""
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **header}
    if header["type"] == OpenEXR.tiledimage:
        header["tiles"] = OpenEXR.TileDescription()
        header["tiles"].xSize, header["tiles"].ySize = 32, 16
    OpenEXR.File(header, dict(channels)).write(str(path))
    return path


def numbered(names: str) -> dict[str, np.ndarray]:
    """Return channels that each hold their own number."""
    return {name: np.full((3, 4), number + 1, np.float32) for number, name in enumerate(names.split())}


def assert_same(got: exr.Scene, channels: dict[str, np.ndarray], *names: str) -> None:
    """Check that the scene holds exactly the channels of these names: R, G, B and Z."""
    for k, name in enumerate(names[:3] or "RGB"):
        np.testing.assert_array_equal(got.color[..., k], channels[name])
    np.testing.assert_array_equal(got.depth, channels[names[3] if names else "Z"])
    assert (got.color[..., 3] == 1).all() and got.depth.dtype == np.float32


def assert_refused(path: Path, *words: str, **options) -> None:
    """Check that a file is refused in one line with its name and these words."""
    with pytest.raises(UserError) as caught:
        exr.read(path, **options)
    line = str(caught.value)
    assert line.startswith(f"{path}: ") and line.isprintable() and len(line) < 1000
    assert [word for word in words if word not in line] == [], line


def written(folder: Path) -> dict[str, Path]:
    """Write the same scene with every compression and kind; returns name -> path."""
    files = {}
    for compression in COMPRESSIONS:
        for kind, image in KINDS.items():
            header = {"compression": getattr(OpenEXR, f"{compression}_COMPRESSION"), "type": image}
            files[f"{compression}, {kind}"] = save(folder / f"{compression}-{kind}.exr", scene(), **header)
    return files


def test_compressions(tmp_path):
    """Check scan lines and tiles: every pixel unchanged, channels not swapped; lossy compression is
    close on average.
    """
    for name, path in written(tmp_path).items():
        got = exr.read(path)
        if "DWAA" not in name:
            assert_same(got, scene())
        for index, channel in enumerate("RGB"):
            assert np.abs(got.color[..., index].astype(float) - scene()[channel]).mean() < 0.08, name


def test_kinds(tmp_path):
    """Check formats: half stays half; float, or half mixed with float, becomes float; half depth; infinite sky; uint
    is refused.
    """
    channels = scene()
    channels["Z"][3, 4] = np.inf
    ids = np.ones(SIZE, np.uint32)
    got = exr.read(save(tmp_path / "half.exr", {**channels, "id": ids, "Z": channels["Z"].astype(np.float16)}))
    assert got.storage == "half"
    assert_same(got, channels)
    mixed = {**channels, "G": channels["G"].astype(np.float32) / 3}
    got = exr.read(save(tmp_path / "mixed.exr", mixed))
    assert got.storage == "float"
    assert_same(got, mixed)
    assert_refused(save(tmp_path / "uint.exr", {**channels, "Z": ids}), "channel 'Z'", "whole numbers")


def test_layers_and_parts(tmp_path):
    """Check names of layers and parts: CHANNEL or PART.CHANNEL, where the latter is required if several
    parts have it.
    """
    blender = "V.Combined.R V.Combined.G V.Combined.B V.Depth.Z V.Normal.X V.Normal.Y V.Normal.Z"
    channels, path = numbered(blender), tmp_path / "in.exr"
    got = exr.read(save(path, channels), "V.Depth.Z", "V.Combined")
    assert_same(got, channels, *blender.split()[:4])
    assert_refused(path, "no channel 'R' (it has", "V.Combined.R", "--layer")
    render.render(path, tmp_path / "out.exr", layer="V.Combined", depth_channel="V.Depth.Z", driver="reference")
    np.testing.assert_allclose(exr.read(tmp_path / "out.exr", None).color[..., 0], channels["V.Combined.R"], rtol=1e-6)
    picture, other = numbered("R G B"), {name: plane + 7 for name, plane in numbered("R G B").items()}
    far, near = {"Z": np.full((3, 4), 50, np.float32)}, {"Z": np.full((3, 4), 2, np.float32)}
    parts = {"extra": other, "beauty": picture, "far": far, "near": near}.items()
    OpenEXR.File([OpenEXR.Part({"type": KINDS["scan lines"]}, dict(c), n) for n, c in parts]).write(str(path))
    assert_refused(path, "several parts have channel 'R'", "beauty.R", "--layer")
    assert_refused(path, "several parts have depth channel 'Z'", "far.Z", "near.Z", layer="beauty")
    assert_same(exr.read(path, "near.Z", "beauty"), picture | near)
    assert_refused(path, "no depth channel 'Z\\n\\x1b'", depth_channel="Z\n\x1b", layer="beauty")


def test_no_image_to_blur(tmp_path):
    """Refuse pipes without waiting, deep and cropped images, invalid channel names, and images too large for memory."""
    os.mkfifo(tmp_path / "pipe.exr")
    assert_refused(tmp_path / "pipe.exr", "no such file", "a pipe")
    samples = np.empty((3, 4), object)
    samples[...] = [[np.ones(2, np.float32)] * 4] * 3
    deep = {name: samples.copy() for name in "RGBZ"}
    save(tmp_path / "deep.exr", deep, type=OpenEXR.deepscanline, compression=OpenEXR.ZIPS_COMPRESSION)
    assert_refused(tmp_path / "deep.exr", "is a deep image", "Save it flattened")
    path = save(tmp_path / "in.exr", scene(), displayWindow=((0, 0), (99, 99)))
    assert_refused(path, "channel 'R'", "[99, 99]", "the whole picture")
    save(path, numbered("R G B name"))
    path.write_bytes(path.read_bytes().replace(b"name\0", b"\xff\n\xff\xff\0"))
    assert_refused(path, "UnicodeDecodeError")
    window = b"dataWindow\0box2i\0\x10\0\0\0"
    before, after = save(path, scene()).read_bytes().split(window)
    path.write_bytes(before + window + struct.pack("<iiii", 0, 0, 40000, 40000) + after[16:])
    assert_refused(path, "40001 x 40001 pixels", "scale")


READ_ALL = """
import json, resource, sys
from pathlib import Path
from bokeh_validation import exr
from bokeh_validation.errors import UserError

resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30))
lines = {}
for path in sorted(Path(sys.argv[1]).iterdir()):
    try:
        lines[path.name] = str(exr.read(path).size)
    except UserError as error:
        lines[path.name] = str(error)
print(json.dumps(lines))
"""


def test_cut_off_and_flipped_bytes(tmp_path):
    """Check that damaged files are refused in one line or, if other bytes are changed, read, within 2 GiB and without
    other output.

    Each file is truncated after k sixteenths of its bytes, and before its last byte. 300 files have 1 to 11 bytes
    changed, in the header or anywhere; the number in their names is the random seed.
    """
    folder, good = tmp_path / "damaged", {name: path.read_bytes() for name, path in written(tmp_path).items()}
    folder.mkdir()
    for name, data in good.items():
        for length in (*(len(data) * k // 16 for k in range(16)), len(data) - 1):
            (folder / f"cut-{name}-{length}.exr").write_bytes(data[:length])
    for seed in range(300):
        name, data = list(good.items())[seed % len(good)]
        random, changed = np.random.default_rng(seed), bytearray(data)
        for at in random.integers(0, len(data) if seed // len(good) % 2 else 700, random.integers(1, 12)):
            changed[at] = random.choice([0, 1, 0x7F, 0x80, 0xFF, random.integers(256)])
        (folder / f"flipped-{seed}-{name}.exr").write_bytes(changed)
    command = [sys.executable, "-c", READ_ALL, str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=HANG, cwd=paths.VALIDATION)
    assert done.returncode == 0 and not done.stderr, (done.returncode, done.stderr[-2000:])
    lines = json.loads(done.stdout)
    for name, line in lines.items():
        refused = line.startswith(f"{folder}/{name}: ") and line.isprintable()
        assert refused or name.startswith("flipped") and line.startswith("("), (name, line)
    assert 15 < sum(line.startswith("(") for line in lines.values()) < 200
