"""EXR files as renderers write them, and as nobody should: read right, or refused in one line within bounded memory."""

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
from exr_bytes import RGBZ

from bokeh_validation import exr, paths, render
from bokeh_validation.errors import UserError

LOSSLESS = ("NO", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "HTJ2K256", "HTJ2K32", "ZSTD")
LOSSY = ("B44", "B44A", "DWAA", "DWAB", "LJ2K")
SCAN, TILED = OpenEXR.scanlineimage, OpenEXR.tiledimage
MEMORY = 2 << 30


def scene(size: tuple[int, int] = (70, 41), dtype=np.float16) -> dict[str, np.ndarray]:
    """R G B and Z with another value in each pixel; Z and half floats keep theirs in every lossless compression."""
    random = np.random.default_rng(5)
    planes = {name: (random.integers(0, 2048, size) / 256).astype(dtype) for name in "RGB"}
    return {**planes, "Z": random.integers(1, 200, size).astype(np.float32)}


def windows(left: int, top: int, width: int, height: int) -> tuple[tuple[int, int], tuple[int, int]]:
    """A window as the library takes it."""
    return (left, top), (left + width - 1, top + height - 1)


def save(path: Path, channels: dict[str, np.ndarray], **header) -> Path:
    """One part, zipped scan lines unless the header says otherwise."""
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": SCAN, **header}
    if header["type"] == TILED:
        header["tiles"] = OpenEXR.TileDescription()
        header["tiles"].xSize, header["tiles"].ySize = 32, 16
    with OpenEXR.File(header, {name: plane.copy() for name, plane in channels.items()}) as file:
        file.write(str(path))
    return path


def save_parts(path: Path, parts: dict[str, dict[str, np.ndarray]], **headers: dict) -> Path:
    """Several parts by name, scan lines, all with the display window of 41 x 70 pixels, as the format asks."""
    shared = {"type": SCAN, "displayWindow": windows(0, 0, 41, 70)}
    made = [OpenEXR.Part({**shared, **headers.get(name, {})}, dict(c), name) for name, c in parts.items()]
    with OpenEXR.File(made) as file:
        file.write(str(path))
    return path


def same(got: exr.Scene, channels: dict[str, np.ndarray]) -> None:
    """The scene holds exactly these R G B Z."""
    for k, name in enumerate("RGB"):
        np.testing.assert_array_equal(got.color[..., k], channels[name])
    np.testing.assert_array_equal(got.depth, channels["Z"])
    assert (got.color[..., 3] == 1).all() and got.depth.dtype == np.float32


def refusal(path: Path, *words: str, **options) -> None:
    """A file is refused in one line that names it and has these words."""
    with pytest.raises(UserError) as caught:
        exr.read(path, **options)
    line = str(caught.value)
    assert line.startswith(str(path)) and line.isprintable() and len(line) < 1500
    assert [word for word in words if word not in line] == [], line


# ------------------------------------------------------------------------------------------------------------- formats


@pytest.mark.parametrize("kind", (SCAN, TILED), ids=("scan lines", "tiles"))
@pytest.mark.parametrize("compression", LOSSLESS + LOSSY)
def test_compressions(compression, kind, tmp_path):
    """Every pixel as it was, R as R: 70 rows and 41 columns fill no block, tile or chunk of any compression.

    Lossy ones get R, G, B of 0.25, 0.5 and 1: within 1/8, half of their least distance, none is taken for another.
    """
    channels = scene()
    if compression in LOSSY:
        channels |= {n: np.full((70, 41), v, np.float16) for n, v in {"R": 0.25, "G": 0.5, "B": 1.0}.items()}
    header = {"compression": getattr(OpenEXR, f"{compression}_COMPRESSION"), "type": kind}
    got = exr.read(save(tmp_path / "in.exr", channels, **header))
    if compression in LOSSLESS:
        same(got, channels)
        return
    for k, name in enumerate("RGB"):
        assert np.abs(got.color[..., k].astype(float) - channels[name]).max() < 0.125
    assert got.depth.shape == (70, 41) and np.isfinite(got.depth).all()


def test_tiles_and_line_order(tmp_path):
    """Level 0 of tiles with every kind of levels, of tiles larger than the image; the last row first in the file.

    2048 x 2048 is exactly the most that tiles of an image as small as this may cover.
    """
    channels, path = scene(), tmp_path / "in.exr"
    for mode in (0, 1, 2):
        for side in ((5, 7), (2048, 2048)):
            same(exr.read(exr_bytes.tiled(path, channels, side, mode)), channels)
    same(exr.read(save(path, channels, lineOrder=OpenEXR.DECREASING_Y)), channels)


def test_kinds(tmp_path):
    """Half stays half; float, or half mixed with float, is float; half depth; uint beside them is let lie."""
    channels = scene()
    ids = np.arange(70 * 41, dtype=np.uint32).reshape(70, 41)
    got = exr.read(save(tmp_path / "half.exr", {**channels, "id": ids, "Z": channels["Z"].astype(np.float16)}))
    assert got.storage == "half"
    same(got, channels)
    mixed = {**channels, "G": channels["G"].astype(np.float32) / 3}
    got = exr.read(save(tmp_path / "mixed.exr", mixed))
    assert got.storage == "float"
    same(got, mixed)
    refusal(save(tmp_path / "uint.exr", {**channels, "G": ids}), "channel 'G'", "whole numbers", "half or float")
    refusal(save(tmp_path / "uintz.exr", {**channels, "Z": ids}), "depth channel 'Z'", "whole numbers", "in metres")
    assert exr.read(tmp_path / "uintz.exr", None).depth is None


def test_aces_container(tmp_path):
    """An ACES container is an uncompressed half image with a flag: read as any other."""
    flag = exr_bytes.attribute("acesImageContainerFlag", "int", struct.pack("<i", 1))
    head = exr_bytes.header(dict.fromkeys("BGR", "float16"), (0, 0, 3, 1), more=flag)
    rows = [struct.pack("<ii", y, 24) + np.repeat([3, 2, 1], 4).astype("<f2").tobytes() for y in range(2)]
    (tmp_path / "aces.exr").write_bytes(exr_bytes.with_table(head, rows))
    assert (exr.read(tmp_path / "aces.exr", None).color == np.array([1, 2, 3, 1], np.float16)).all()


# ---------------------------------------------------------------------------------------------------- layers and parts

# channels of the file, "layer:NAMES layer" (RGB where none are given) -> where colour and depth are
LAYERS = {
    "ViewLayer.Combined ViewLayer.Depth:Z ViewLayer.Mist:Z": ("ViewLayer.Combined", "ViewLayer.Depth.Z"),
    "View_Layer.Combined View_Layer.Depth:Z": ("View Layer.Combined", "View Layer.Depth.Z"),
    "ViewLayer.Combined ViewLayer.Depth:V": ("ViewLayer.Combined", "ViewLayer.Depth.V"),
    "V.DiffCol V.Combined V.Emit V.Normal:XYZ V.Position:XYZ V.Depth:Z V.Vector:XYZW": ("V.Combined", "V.Depth.Z"),
    "beauty depth:Z": ("beauty", "depth.Z"),
    "albedo beauty :Z": ("beauty", "Z"),
    "diffuse rgba rgba:Z depth:Z": ("rgba", "rgba.Z"),
    ":RGBA beauty beauty:Z :Z": ("", "Z"),
    ":RGB depth:Z N:XYZ": ("", "depth.Z"),
    "shot7.light depth:Z": ("shot7.light", "depth.Z"),
}
LAYERS_ASKED = {
    "Composite.Combined V.Combined V.Depth:Z": ("Composite.Combined", "V.Depth.Z"),
    "A.Combined A.Depth:Z B.Combined B.Depth:Z": ("B.Combined", "B.Depth.Z"),
    "V.Combined.left V.Combined.right V.Depth.left:Z V.Depth.right:Z": ("V.Combined.right", "V.Depth.right.Z"),
    ":RGBA beauty beauty:Z :Z": ("beauty", "beauty.Z"),
}


def numbered(spec: str) -> dict[str, np.ndarray]:
    """Channels of a text as in LAYERS, each holding its own number; _ is a space."""
    items = [item.replace("_", " ").partition(":") for item in spec.split()]
    names = [f"{layer}.{last}" if layer else last for layer, _, lasts in items for last in lasts or "RGB"]
    return {name: np.full((3, 4), number + 1, np.float32) for number, name in enumerate(names)}


def test_layers(tmp_path):
    """Colour and depth from the layers that are meant, told by the numbers in them."""
    cases = [(spec, False, *found) for spec, found in LAYERS.items()]
    for spec, asked, layer, depth in cases + [(spec, True, *found) for spec, found in LAYERS_ASKED.items()]:
        channels = numbered(spec)
        got = exr.read(save(tmp_path / "in.exr", channels), layer=layer if asked else None)
        wanted = {name: channels[f"{layer}.{name}" if layer else name] for name in "RGB"}
        same(got, {**wanted, "Z": channels[depth]})
    channels = numbered("beauty depth:Z N:XYZ")
    assert (exr.read(save(tmp_path / "in.exr", channels), "N.Z").depth == channels["N.Z"]).all()


LAYERS_REFUSED = [
    ("A.Combined B.Combined :Z", {}, ["several layers", "A.Combined, B.Combined", "--layer"]),
    ("albedo light :Z", {}, ["several layers", "albedo, light", "--layer"]),
    ("albedo light :Z", {"layer": "lights"}, ["no layer 'lights'", "albedo, light", "--layer"]),
    ("albedo depth:Z", {"layer": "depth"}, ["layer 'depth' has no channel R, G, B"]),
    ("beauty N:XYZ", {}, ["no depth channel 'Z'", "N.X N.Y N.Z", "--depth-channel", "--coc"]),
    ("beauty a.depth:Z b.depth:Z", {}, ["several depth channels", "a.depth.Z, b.depth.Z", "--depth-channel"]),
    (":RG depth:Z", {}, ["no channel B", "it has G R depth.Z"]),
    ("depth:Z", {}, ["no channel R, G, B", "it has depth.Z"]),
    (":Y :Z", {}, ["no channel R, G, B", "luminance without colour"]),
    (":RGB", {"depth_channel": "Z\n\x1b"}, ["no depth channel 'Z\\n\\x1b'"]),
    (" ".join(f"layer{k}" for k in range(99)), {}, ["several layers", "and 87 more"]),
]


def test_layers_refused(tmp_path):
    """Nothing there, or several: one line that says what there is and which option chooses."""
    for spec, options, words in LAYERS_REFUSED:
        refusal(save(tmp_path / "in.exr", numbered(spec)), *words, **options)


def test_parts(tmp_path):
    """Colour and depth in parts of their own, behind others: by channel, by name, by --layer."""
    channels, other = scene(), {name: plane + 1 for name, plane in scene().items()}
    colour, alien = ({n: c[n] for n in "RGB"} for c in (channels, other))
    vector = {name: np.zeros((70, 41), np.float32) for name in "XYZ"}
    preview = {"Z": np.ones((7, 5), np.float32)}
    path = tmp_path / "in.exr"
    parts = {"small": preview, "N": vector, "picture": colour, "extra": alien, "far": {"Z": channels["Z"]}}
    same(exr.read(save_parts(path, parts)), channels)
    same(exr.read(path, layer="extra"), {**alien, "Z": channels["Z"]})
    refusal(path, "no layer 'lost'", "picture, extra", layer="lost")
    # beauty behind another part with R G B
    same(exr.read(save_parts(path, {"extra": alien, "beauty": colour, "depth": {"Z": channels["Z"]}})), channels)
    # the same names in the part and in the channel, as Blender and Nuke write them
    named = {"V.Combined": {f"V.Combined.{n}": p for n, p in colour.items()}, "V.Depth": {"V.Depth.Z": channels["Z"]}}
    same(exr.read(save_parts(path, named)), channels)
    # and twice, where the depth beside the colour is not the other's
    second = {"W.Combined": {f"W.Combined.{n}": p for n, p in alien.items()}, "W.Depth": {"W.Depth.Z": other["Z"]}}
    same(exr.read(save_parts(path, named | second), layer="W.Combined"), other)
    # Z in the colour's part comes before another part's
    first = {**{f"beauty.{n}": p for n, p in colour.items()}, "Z": channels["Z"]}
    same(exr.read(save_parts(path, {"all": first, "b": {"Z": other["Z"]}})), channels)
    # two that may be meant, and each by its name
    save_parts(path, {"rgba": colour, "front": {"Z": channels["Z"]}, "back": {"Z": other["Z"]}})
    refusal(path, "several depth channels", "front.Z, back.Z", "--depth-channel")
    same(exr.read(path, "front.Z"), channels)
    save_parts(path, {"rgba": colour, "depth": preview})
    refusal(path, "'depth.Z' differs in size", "5 x 7", "41 x 70")
    assert exr.read(path, None).size == (41, 70)
    save_parts(path, {"rgba": colour, "depth": {"Z": channels["Z"]}}, depth={"dataWindow": windows(1, 0, 41, 70)})
    refusal(path, "'depth.Z' differs in size", "at 1,0")


def test_a_broken_part_is_not_skipped(tmp_path):
    """The library leaves out a part that it cannot decode; the next must not be taken for it."""
    other = {name: plane + 1 for name, plane in scene().items()}
    data = bytearray(save_parts(tmp_path / "in.exr", {"first": scene(), "second": other}).read_bytes())
    # 70 rows zipped by 16 are 5 chunks a part: the table is where the first of 10 places is the table's own end
    first = next(at + 80 for at in range(len(data)) if data[at : at + 8] == struct.pack("<Q", at + 80))
    data[first + 12 : first + 60] = bytes(48)
    (tmp_path / "in.exr").write_bytes(data)
    refusal(tmp_path / "in.exr", "cannot be read as OpenEXR")


# ------------------------------------------------------------------------------------------------------------- windows


@pytest.mark.parametrize(
    ("data", "display"),
    [((10, 20), (0, 0, 100, 120)), ((-5, -7), (0, 0, 20, 30)), ((-5, 9), (0, 0, 30, 60)), ((-41, 0), (-41, 0, 60, 70))],
    ids=("crop", "overscan", "both", "negative"),
)
def test_windows(data, display, tmp_path):
    """The scene covers the display window: the file's pixels where it has any, else the nearest; the rest is cut off.

    NaN in the overscan, which is cut off, is let pass; one that is seen is not, and its place is the file's.
    """
    channels = scene()
    left, top, width, height = display
    columns, rows = np.arange(width) + left - data[0], np.arange(height) + top - data[1]
    for plane in channels.values():
        plane[~np.isin(np.arange(70), rows)] = np.nan
        plane[:, ~np.isin(np.arange(41), columns)] = np.nan
    header = {"dataWindow": windows(*data, 41, 70), "displayWindow": windows(*display)}
    got = exr.read(save(tmp_path / "in.exr", channels, **header))
    inside = rows[(rows >= 0) & (rows < 70)], columns[(columns >= 0) & (columns < 41)]
    near = np.clip(rows, inside[0][0], inside[0][-1]), np.clip(columns, inside[1][0], inside[1][-1])
    same(got, {name: plane[near[0]][:, near[1]] for name, plane in channels.items()})
    assert got.size == (width, height) and got.with_data(got.depth).shape == (len(inside[0]), len(inside[1]))
    channels["G"][inside[0][0], inside[1][0]] = np.nan
    place = f"column {max(data[0], left)}, row {max(data[1], top)}. "
    refusal(save(tmp_path / "nan.exr", channels, **header), "1 pixels of channel G", place)


def blurred(source: Path, target: Path) -> dict[str, np.ndarray]:
    """`render` with the float64 reference, CoC 0.1 of the height; the channels of its file."""
    render.render(source, target, coc=0.1, driver="reference")
    with OpenEXR.File(str(target), separate_channels=True) as file:
        return {**{n: np.asarray(c.pixels) for n, c in file.channels().items()}, "header": dict(file.header())}


def test_a_crop_is_blurred_as_the_whole(tmp_path):
    """A crop render gets the blur of the whole picture, and keeps its windows.

    The CoC is 0.1 of the display window's 60 rows: 6 pixels, which two passes gather from at most 6 pixels away, and
    one more for the linear filter in each. That far from the crop's border the result is the same to the last bit. A
    crop that is taken for the picture has a CoC of 4 pixels, and differs.
    """
    channels = scene((60, 80), np.float32)
    top, left, height, width, margin = 10, 20, 40, 50, 8
    cut = {name: np.ascontiguousarray(p[top : top + height, left : left + width]) for name, p in channels.items()}
    header = {"dataWindow": windows(left, top, width, height), "displayWindow": windows(0, 0, 80, 60)}
    whole = blurred(save(tmp_path / "whole.exr", channels), tmp_path / "a.exr")
    crop = blurred(save(tmp_path / "crop.exr", cut, **header), tmp_path / "b.exr")
    alone = blurred(save(tmp_path / "alone.exr", cut), tmp_path / "c.exr")
    inner = slice(margin, height - margin), slice(margin, width - margin)
    for name in "RGBA":
        wanted = whole[name][top : top + height, left : left + width][inner]
        np.testing.assert_array_equal(crop[name][inner], wanted)
        assert name == "A" or not np.allclose(alone[name][inner], wanted, rtol=0.01)
    for name, (low, high) in header.items():
        assert [tuple(corner) for corner in crop["header"][name]] == [low, high]
    # overscan: the display window of a larger picture is that picture
    header = {"dataWindow": windows(-left, -top, 80, 60), "displayWindow": windows(0, 0, width, height)}
    over = blurred(save(tmp_path / "over.exr", channels, **header), tmp_path / "d.exr")
    for name in "RGBA":
        np.testing.assert_array_equal(over[name], alone[name])


# ----------------------------------------------------------------------------------------------------------- bad files


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
        for kind in (SCAN, TILED):
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


def test_render_takes_a_layer(tmp_path):
    """A channel that is the same everywhere stays so."""
    channels = numbered("A.Combined A.Depth:Z B.Combined B.Depth:Z")
    source, target = save(tmp_path / "in.exr", channels), tmp_path / "out.exr"
    render.render(source, target, layer="B.Combined", driver="reference")
    np.testing.assert_allclose(exr.read(target, None).color[..., 0], channels["B.Combined.R"][0, 0], rtol=1e-6)
