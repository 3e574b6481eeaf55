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
from test_render import refused, run

from bokeh_validation import exr, exr_header, paths, render
from bokeh_validation.errors import UserError

LOSSLESS = ("NO", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "HTJ2K256", "HTJ2K32", "ZSTD")
LOSSY = ("B44", "B44A", "DWAA", "DWAB", "LJ2K")
SCAN, TILED = OpenEXR.scanlineimage, OpenEXR.tiledimage
MEMORY = 2 << 30


def tile_description(width: int = 32, height: int = 16) -> OpenEXR.TileDescription:
    """Tiles of one level."""
    tiles = OpenEXR.TileDescription()
    tiles.xSize, tiles.ySize = width, height
    return tiles


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


def refusal(path: Path, *words: str, **options) -> str:
    """The one line with which a file is refused; it names the file and has these words."""
    with pytest.raises(UserError) as caught:
        exr.read(path, **options)
    line = str(caught.value)
    assert line.startswith(str(path)) and line.isprintable() and len(line) < 1500
    for word in words:
        assert word in line, line
    return line


@pytest.mark.parametrize("kind", (SCAN, TILED), ids=("scan lines", "tiles"))
@pytest.mark.parametrize("compression", LOSSLESS)
def test_lossless(compression, kind, tmp_path):
    """Every pixel as it was, R as R: 70 rows and 41 columns fill no block, tile or chunk of any compression."""
    channels = scene()
    header = {"compression": getattr(OpenEXR, f"{compression}_COMPRESSION"), "type": kind}
    path = save(tmp_path / "in.exr", channels, **header, **({"tiles": tile_description()} if kind == TILED else {}))
    same(exr.read(path), channels)


@pytest.mark.parametrize("kind", (SCAN, TILED), ids=("scan lines", "tiles"))
@pytest.mark.parametrize("compression", LOSSY)
def test_lossy(compression, kind, tmp_path):
    """R, G, B are 0.25, 0.5 and 1: within 1/8, half of their least distance, none is taken for another; Z is whole."""
    levels = {"R": 0.25, "G": 0.5, "B": 1.0}
    channels = {**{n: np.full((70, 41), v, np.float16) for n, v in levels.items()}, "Z": scene()["Z"]}
    header = {"compression": getattr(OpenEXR, f"{compression}_COMPRESSION"), "type": kind}
    path = save(tmp_path / "in.exr", channels, **header, **({"tiles": tile_description()} if kind == TILED else {}))
    got = exr.read(path)
    for k, level in enumerate(levels.values()):
        assert np.abs(got.color[..., k].astype(float) - level).max() < 0.125
    assert got.depth.shape == (70, 41) and np.isfinite(got.depth).all()


@pytest.mark.parametrize("compression", LOSSLESS + LOSSY)
def test_chunks_of_parts(compression, tmp_path):
    """As many rows in a chunk as the library makes: with parts it writes how many chunks there are."""
    tall = {name: np.zeros((600, 3), np.float16) for name in "RGBZ"}
    header = {"compression": getattr(OpenEXR, f"{compression}_COMPRESSION"), "displayWindow": windows(0, 0, 3, 600)}
    assert exr.read(save_parts(tmp_path / "in.exr", {"a": tall, "b": tall}, a=header, b=header)).size == (3, 600)


@pytest.mark.parametrize("mode", (0, 1, 2, 17, 18), ids=("one", "mipmaps", "ripmaps", "mipmaps up", "ripmaps up"))
@pytest.mark.parametrize("side", ((5, 7), (128, 128), (2048, 2048)), ids=str)
def test_levels_of_tiles(mode, side, tmp_path):
    """Level 0 of tiles with every kind of levels, rounded down and up, and of tiles larger than the image.

    2048 x 2048 is exactly the most that tiles of an image as small as this may cover.
    """
    channels = scene()
    same(exr.read(exr_bytes.tiled(tmp_path / "in.exr", channels, side, mode)), channels)


def test_decreasing_line_order(tmp_path):
    """The last row first in the file is the last row all the same."""
    channels = scene()
    same(exr.read(save(tmp_path / "in.exr", channels, lineOrder=OpenEXR.DECREASING_Y)), channels)


def test_kinds(tmp_path):
    """Half stays half; float, or half mixed with float, is float; half depth; uint beside them is let lie."""
    channels = scene()
    ids = np.arange(70 * 41, dtype=np.uint32).reshape(70, 41)
    path = save(tmp_path / "half.exr", {**channels, "id": ids, "Z": channels["Z"].astype(np.float16)})
    assert exr.read(path).storage == "half"
    same(exr.read(path), channels)
    mixed = {**channels, "G": channels["G"].astype(np.float32) / 3}
    got = exr.read(save(tmp_path / "mixed.exr", mixed))
    assert got.storage == "float"
    same(got, mixed)
    refusal(save(tmp_path / "uint.exr", {**channels, "G": ids}), "channel G", "whole numbers", "half or float")
    refusal(save(tmp_path / "uintz.exr", {**channels, "Z": ids}), "depth channel 'Z'", "whole numbers", "in metres")
    assert exr.read(tmp_path / "uintz.exr", None).depth is None


# channels of the file -> where colour and depth are; each channel holds its own number
LAYERS = {
    "blender": (
        "ViewLayer.Combined ViewLayer.Depth:Z ViewLayer.Mist:Z",
        None,
        "ViewLayer.Combined",
        "ViewLayer.Depth.Z",
    ),
    "blender, old": ("RenderLayer.Combined RenderLayer.Depth:Z", None, "RenderLayer.Combined", "RenderLayer.Depth.Z"),
    "blender, a space": ("View Layer.Combined View Layer.Depth:Z", None, "View Layer.Combined", "View Layer.Depth.Z"),
    "blender, V": ("ViewLayer.Combined ViewLayer.Depth:V", None, "ViewLayer.Combined", "ViewLayer.Depth.V"),
    "blender, passes": (
        "ViewLayer.DiffCol ViewLayer.Combined ViewLayer.Emit ViewLayer.Normal:XYZ ViewLayer.Position:XYZ "
        "ViewLayer.Depth:Z ViewLayer.Vector:XYZW",
        None,
        "ViewLayer.Combined",
        "ViewLayer.Depth.Z",
    ),
    "blender, composited": (
        "Composite.Combined V.Combined V.Depth:Z",
        "Composite.Combined",
        "Composite.Combined",
        "V.Depth.Z",
    ),
    "view layers": ("A.Combined A.Depth:Z B.Combined B.Depth:Z", "B.Combined", "B.Combined", "B.Depth.Z"),
    "views": (
        "V.Combined.left V.Combined.right V.Depth.left:Z V.Depth.right:Z",
        "V.Combined.right",
        "V.Combined.right",
        "V.Depth.right.Z",
    ),
    "beauty": ("beauty depth:Z", None, "beauty", "depth.Z"),
    "beauty among others": ("albedo beauty :Z", None, "beauty", "Z"),
    "rgba": ("diffuse rgba rgba:Z depth:Z", None, "rgba", "rgba.Z"),
    "plain first": (":RGBA beauty beauty:Z :Z", None, "", "Z"),
    "plain, layer asked": (":RGBA beauty beauty:Z :Z", "beauty", "beauty", "beauty.Z"),
    "plain with a depth layer": (":RGB depth:Z N:XYZ", None, "", "depth.Z"),
    "only one": ("shot7.light depth:Z", None, "shot7.light", "depth.Z"),
}


def numbered(spec: str) -> dict[str, np.ndarray]:
    """ "layer:NAMES layer" (names RGB where none are given) to channels that hold 1, 2, 3 ..."""
    layers = [item for item in spec.replace("View Layer", "View_Layer").split()]
    names = []
    for item in layers:
        layer, _, lasts = item.replace("View_Layer", "View Layer").partition(":")
        names += [f"{layer}.{last}" if layer else last for last in lasts or "RGB"]
    return {name: np.full((3, 4), number + 1, np.float32) for number, name in enumerate(names)}


@pytest.mark.parametrize("case", LAYERS)
def test_layers(case, tmp_path):
    """Colour and depth from the layers that are meant, told by the numbers in them."""
    spec, asked, layer, depth = LAYERS[case]
    channels = numbered(spec)
    got = exr.read(save(tmp_path / "in.exr", channels), layer=asked)
    wanted = {name: channels[f"{layer}.{name}" if layer else name] for name in "RGB"}
    same(got, {**wanted, "Z": channels[depth]})


@pytest.mark.parametrize(
    ("spec", "options", "words"),
    [
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
    ],
    ids=lambda value: value if isinstance(value, str) and len(value) < 40 else "",
)
def test_layers_refused(spec, options, words, tmp_path):
    """Nothing there, or several: one line that says what there is and which option chooses."""
    refusal(save(tmp_path / "in.exr", numbered(spec)), *words, **options)


def test_depth_channel_by_its_full_name(tmp_path):
    """--depth-channel takes any channel by its full name, a vector's too."""
    channels = numbered("beauty depth:Z N:XYZ")
    path = save(tmp_path / "in.exr", channels)
    assert (exr.read(path, "N.Z").depth == channels["N.Z"]).all()


def test_chroma_subsampling(tmp_path):
    """Y RY BY has no R G B; R and B at half the columns, or depth, are refused as well."""
    halves = {
        "BY RY Y": ({"BY": (2, 2), "RY": (2, 2)}, ["no channel R, G, B", "BY RY Y: luminance and chroma"]),
        "B G R": ({"B": (2, 1), "R": (2, 1)}, ["R, G and B differ in size", "subsampling"]),
        "B G R Z": ({"Z": (2, 2)}, ["depth channel 'Z' differs in size", "Save both at one size"]),
    }
    for names, (sampled, words) in halves.items():
        kinds = dict.fromkeys(names.split(), "float16")
        channels = exr_bytes.attribute("channels", "chlist", exr_bytes.channel_list(kinds, sampled))
        head = exr_bytes.header(kinds, (0, 0, 5, 3), channels=channels)
        (tmp_path / "in.exr").write_bytes(exr_bytes.with_table(head, [bytes(64)] * 4))
        refusal(tmp_path / "in.exr", *words)


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
    save_parts(
        path, {"all": {**{f"beauty.{n}": p for n, p in colour.items()}, "Z": channels["Z"]}, "b": {"Z": other["Z"]}}
    )
    same(exr.read(path), channels)
    # two that may be meant, and each by its name
    save_parts(path, {"rgba": colour, "front": {"Z": channels["Z"]}, "back": {"Z": other["Z"]}})
    refusal(path, "several depth channels", "front.Z, back.Z", "--depth-channel")
    same(exr.read(path, "front.Z"), channels)
    save_parts(path, {"rgba": colour, "depth": preview})
    refusal(path, "'depth.Z' differs in size", "5 x 7", "41 x 70")
    assert exr.read(path, None).size == (41, 70)
    save_parts(path, {"rgba": colour, "depth": {"Z": channels["Z"]}}, depth={"dataWindow": windows(1, 0, 41, 70)})
    refusal(path, "'depth.Z' differs in size", "at 1,0")


@pytest.mark.parametrize(
    ("data", "display"),
    [
        ((10, 20), (0, 0, 100, 120)),
        ((-5, -7), (0, 0, 20, 30)),
        ((-5, 9), (0, 0, 30, 60)),
        ((100, 200), (100, 200, 41, 70)),
        ((-41, 0), (-41, 0, 60, 70)),
    ],
    ids=("crop", "overscan", "both", "moved", "negative"),
)
def test_windows(data, display, tmp_path):
    """The scene covers the display window: the file's pixels where it has any, else the nearest; the rest is cut off.

    NaN in the overscan, which is cut off, is let pass; a NaN that is seen is not.
    """
    channels = scene()
    left, top, width, height = display
    columns, rows = np.arange(width) + left - data[0], np.arange(height) + top - data[1]
    for plane in channels.values():
        plane[~np.isin(np.arange(70), rows)] = np.nan
        plane[:, ~np.isin(np.arange(41), columns)] = np.nan
    header = {"dataWindow": windows(*data, 41, 70), "displayWindow": windows(*display)}
    got = exr.read(save(tmp_path / "in.exr", channels, **header))
    assert got.size == (width, height)
    inside = np.flatnonzero((columns >= 0) & (columns < 41)), np.flatnonzero((rows >= 0) & (rows < 70))
    near = (
        np.clip(np.arange(width), inside[0][0], inside[0][-1]),
        np.clip(np.arange(height), inside[1][0], inside[1][-1]),
    )
    same(got, {name: plane[rows[near[1]]][:, columns[near[0]]] for name, plane in channels.items()})
    assert got.with_data(got.depth).shape == (len(inside[1]), len(inside[0]))
    channels["G"][rows[inside[1][0]], columns[inside[0][0]]] = np.nan
    place = f"column {max(data[0], left)}, row {max(data[1], top)}. "
    refusal(save(tmp_path / "nan.exr", channels, **header), "1 pixels of channel G", place)


def test_the_first_bad_pixel(tmp_path):
    """By rows, in the file's coordinates, which begin at the corner of its data window."""
    channels = scene()
    channels["Z"][[5, 4, 4], [1, 30, 31]] = np.nan
    header = {"dataWindow": windows(100, -200, 41, 70), "displayWindow": windows(90, -199, 60, 80)}
    refusal(save(tmp_path / "in.exr", channels, **header), "3 pixels of channel Z", "column 130, row -196. ")


def test_without_a_c_library_to_ask(tmp_path, monkeypatch):
    """On Windows, where ctypes takes no None for the process itself, what C prints is let be."""

    def refused_none(name):
        raise TypeError(name)

    channels = scene()
    path = save(tmp_path / "in.exr", channels)
    monkeypatch.setattr(exr.ctypes, "CDLL", refused_none)
    monkeypatch.setattr(sys, "platform", "win32")
    same(exr.read(path), channels)


def test_a_broken_part_is_not_skipped(tmp_path):
    """The library leaves out a part that it cannot decode; the next must not be taken for it."""
    other = {name: plane + 1 for name, plane in scene().items()}
    data = bytearray(save_parts(tmp_path / "in.exr", {"first": scene(), "second": other}).read_bytes())
    # 70 rows zipped by 16 are 5 chunks a part: the table is where the first of 10 places is the table's own end
    first = next(at + 80 for at in range(len(data)) if data[at : at + 8] == struct.pack("<Q", at + 80))
    data[first + 12 : first + 60] = bytes(48)
    (tmp_path / "in.exr").write_bytes(data)
    refusal(tmp_path / "in.exr", "cannot be read as OpenEXR")


def test_windows_apart(tmp_path):
    """Data beside the display window are no image."""
    header = {"dataWindow": windows(50, 0, 41, 70), "displayWindow": windows(0, 0, 50, 70)}
    refusal(save(tmp_path / "in.exr", scene(), **header), "41 x 70 at 50,0", "outside of the display window", "50 x 70")


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


def test_aces_container(tmp_path):
    """An ACES container is an uncompressed half image with a flag: read as any other."""
    flag = exr_bytes.attribute("acesImageContainerFlag", "int", struct.pack("<i", 1))
    head = exr_bytes.header(exr_bytes.rgbz("BGR"), (0, 0, 3, 1), more=flag)
    rows = [struct.pack("<ii", y, 24) + np.repeat([3, 2, 1], 4).astype("<f2").tobytes() for y in range(2)]
    (tmp_path / "aces.exr").write_bytes(exr_bytes.with_table(head, rows))
    assert (exr.read(tmp_path / "aces.exr", None).color == np.array([1, 2, 3, 1], np.float16)).all()


@pytest.mark.parametrize("how", ("flag", "type"))
def test_deep(how, tmp_path):
    """Deep images, told by the flag or by the part's type."""
    kind = exr_bytes.attribute("type", "string", b"deepscanline")
    flags = exr_bytes.DEEP if how == "flag" else exr_bytes.MULTI_PART
    head = exr_bytes.header(exr_bytes.rgbz(), (0, 0, 3, 1), flags=flags, more=kind if how == "type" else b"")
    (tmp_path / "deep.exr").write_bytes(head + bytes(200))
    refusal(tmp_path / "deep.exr", "deep image", "Save it flattened")


@pytest.mark.timeout(20)
def test_no_file(tmp_path):
    """What is no readable file: at once, without waiting for a pipe's writer or reading a device to its end."""
    refusal(tmp_path / "missing.exr", "no such file", "Check the path")
    refusal(tmp_path / "missing" / "in.exr", "no such file")
    refusal(tmp_path, "is a folder", "Name an EXR file")
    os.mkfifo(tmp_path / "pipe.exr")
    refusal(tmp_path / "pipe.exr", "a pipe or a device")
    refusal(Path("/dev/zero"), "a pipe or a device")
    (tmp_path / "loop.exr").symlink_to(tmp_path / "loop.exr")
    refusal(tmp_path / "loop.exr", "cannot be read")
    for content, word in (
        (b"", "it is empty"),
        (b"\x89PNG\r\n\x1a\n" * 9, "does not begin"),
        (b"v/1", "does not begin"),
    ):
        (tmp_path / "in.exr").write_bytes(content)
        refusal(tmp_path / "in.exr", "cannot be read as OpenEXR", word)
    (tmp_path / "in.exr").chmod(0)
    user = os.geteuid()
    # root may read everything: be nobody for as long as it takes
    os.seteuid(user or 65534)
    try:
        refusal(tmp_path / "in.exr", "may not be read", "permissions")
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

    Fails where the process dies or prints what it was not told to.
    """
    environment = {**os.environ, "PYTHONPATH": str(paths.VALIDATION)}
    command = [sys.executable, "-P", "-c", READ_ALL, str(MEMORY), str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, env=environment)
    assert done.returncode == 0 and not done.stderr, (done.returncode, done.stderr[-2000:])
    return json.loads(done.stdout)


def formats(folder: Path) -> dict[str, bytes]:
    """A small valid file of each compression, scan lines and tiles, of several parts, and with mipmaps."""
    channels, made = scene(), {}
    for compression in LOSSLESS + LOSSY:
        for kind in (SCAN, TILED):
            header = {"compression": getattr(OpenEXR, f"{compression}_COMPRESSION"), "type": kind}
            if kind == TILED:
                header["tiles"] = tile_description()
            made[f"{compression}-{kind.name}"] = save(folder / "x", channels, **header).read_bytes()
    parts = {"rgba": {n: channels[n] for n in "RGB"}, "depth": {"Z": channels["Z"]}}
    made["parts"] = save_parts(folder / "x", parts).read_bytes()
    made["mipmaps"] = exr_bytes.tiled(folder / "x", channels, (16, 16), 1).read_bytes()
    (folder / "x").unlink()
    return made


def test_cut_off(tmp_path):
    """A file that ends after k sixteenths of its bytes, k = 0 .. 15, or lacks its last byte, is refused in one line."""
    whole = formats(tmp_path)
    for name, data in whole.items():
        # the last byte of mipmaps is one of a level that is not read
        last = [len(data) - 1] if name != "mipmaps" else []
        for length in (*(len(data) * k // 16 for k in range(16)), *last):
            (tmp_path / f"{name}-{length}.exr").write_bytes(data[:length])
    results = read_all(tmp_path)
    assert len(results) == 17 * len(whole) - 1
    for name, (said, _, _) in results.items():
        assert "cannot be read as OpenEXR" in said and said.isprintable(), (name, said)


FLIPPED = 600


def test_flipped_bytes(tmp_path):
    """600 files with 1 to 11 bytes changed, in the header or anywhere: read, or refused in one line, within MEMORY.

    The number in a file's name is the seed that made it.
    """
    whole = list(formats(tmp_path).items())
    for seed in range(FLIPPED):
        name, data = whole[seed % len(whole)]
        random, changed = np.random.default_rng(seed), bytearray(data)
        reach = len(data) if seed // len(whole) % 2 else min(700, len(data))
        for at in random.integers(0, reach, random.integers(1, 12)):
            changed[at] = random.choice([0, 1, 0x7F, 0x80, 0xFF, random.integers(256)])
        (tmp_path / f"{seed}-{name}.exr").write_bytes(changed)
    results = read_all(tmp_path)
    read = sum(said.startswith("(") for said, _, _ in results.values())
    assert len(results) == FLIPPED and FLIPPED / 20 < read < FLIPPED / 2
    for name, (said, _, _) in results.items():
        assert said.startswith("(") or (name in said and said.isprintable()), (name, said)


NAMES, LARGE, SMALL = exr_bytes.rgbz(), (0, 0, 16383, 16383), (0, 0, 7, 7)
HEAD = exr_bytes.header(NAMES, LARGE)


def tiles_of(window: tuple[int, int, int, int], width: int, height: int) -> bytes:
    """The header of a tiled image."""
    return exr_bytes.header(NAMES, window, flags=exr_bytes.TILED, more=exr_bytes.tiles_attribute(width, height))


def with_attribute(data: bytes, size: int | None = None) -> bytes:
    """HEAD with one attribute more, which says that it has `size` bytes."""
    return HEAD[:-1] + exr_bytes.attribute("a", "string", data, size) + b"\0"


def many_channels() -> bytes:
    """A header with as many channels as fit into 8 MB: 300,000."""
    entry = struct.pack("<iiii", 1, 0, 1, 1)
    channels = b"".join(b"c%06d\0" % number + entry for number in range((1 << 23) // 24)) + b"\0"
    return exr_bytes.header({}, SMALL, channels=exr_bytes.attribute("channels", "chlist", channels))


def many_parts() -> bytes:
    """20,000 headers."""
    start = struct.pack("<II", exr_bytes.MAGIC, 2 | exr_bytes.MULTI_PART)
    return start + exr_bytes.header(NAMES, SMALL)[8:] * 20_000 + b"\0"


def many_channels_in_parts() -> bytes:
    """40 headers of 2,000 channels."""
    kinds = {f"c{number:04}": "float16" for number in range(2000)}
    start = struct.pack("<II", exr_bytes.MAGIC, 2 | exr_bytes.MULTI_PART)
    return start + exr_bytes.header(kinds, SMALL)[8:] * 40 + b"\0"


def many_channels_in_a_tile() -> bytes:
    """300 channels of 8 x 8 pixels, in a tile of 2048 x 2048."""
    kinds = {f"c{number:03}": "float32" for number in range(300)}
    return exr_bytes.header(kinds, SMALL, flags=exr_bytes.TILED, more=exr_bytes.tiles_attribute(2048, 2048))


def many_passes() -> bytes:
    """60 layers of 16k x 16k."""
    kinds = {f"p{number:02}.{name}": "float16" for number in range(60) for name in "BGR"}
    return exr_bytes.header(kinds, LARGE) + bytes(8 * 16384)


def chunks_without_pixels() -> bytes:
    """A 16k x 16k image whose table is in order, each chunk of 16 rows 4 bytes long."""
    chunks = [struct.pack("<ii", 16 * number, 4) + bytes(4) for number in range(1024)]
    return exr_bytes.with_table(exr_bytes.header(NAMES, LARGE, compression=3), chunks)


TOO_MANY = "are more than 268435456"
# Files of at most 16 MB that ask for more than they hold, and words of their refusals.
HOSTILE = {
    "header": (HEAD, "is cut off"),
    "header and table of zeros": (HEAD + bytes(8 * 16384), "16384 of 16384 chunks are missing"),
    "table that points outside": (HEAD + b"\x7f" * (8 * 16384), "16384 of 16384 chunks are missing"),
    "chunks without pixels": (chunks_without_pixels(), "not enough memory"),
    "2^31": (exr_bytes.header(NAMES, (0, 0, 2**31 - 1, 2**31 - 1)), TOO_MANY),
    "2^32": (exr_bytes.header(NAMES, (-(2**31), -(2**31), 2**31 - 1, 2**31 - 1)), TOO_MANY),
    "display 2^31": (exr_bytes.header(NAMES, SMALL, (0, 0, 2**31 - 1, 9)), TOO_MANY),
    "one long row": (exr_bytes.header(NAMES, (0, 0, 2**28, 0)), TOO_MANY),
    "negative": (exr_bytes.header(NAMES, (5, 5, -900, -900)), "the image is empty (-904 x -904"),
    "many channels": (many_channels(), "more than 65536 attributes and channels"),
    "channels without end": (many_channels()[: 1 << 20], "header is cut off"),
    "many parts": (many_parts(), "more than 65536 attributes and channels"),
    "many channels in parts": (many_channels_in_parts(), "more than 65536 attributes and channels"),
    "many passes": (many_passes(), "90.0 GiB unpacked"),
    "tiles of 1 x 1": (tiles_of(LARGE, 1, 1), "more than 4194304 chunks"),
    "tiles of nothing": (tiles_of(LARGE, 0, 0), "tiles of 0 x 0"),
    "a wide tile": (exr_bytes.wide_tile(65536, 65536, 1024), "cover 65536 x 1024 for an image of 65536 x 1"),
    "wide tiles": (tiles_of((0, 0, 65535, 0), 1024, 1024) + bytes(99), "cover 65536 x 1024"),
    "a tile a pixel too large": (exr_bytes.wide_tile(2048, 2048, 2049), "cover 2048 x 2049"),
    "many channels in a tile": (many_channels_in_a_tile(), "4.7 GiB unpacked"),
    "tiles of 2^31": (tiles_of(LARGE, 2**31 - 1, 2**31 - 1), "tiles of 2147483647"),
    "a tall tile": (tiles_of(SMALL, 8, 2**24) + bytes(99), "tiles of 8 x 16777216"),
    "an attribute of 2 GB": (with_attribute(b"", 2**31 - 1), "header is cut off"),
    "an attribute of -1": (with_attribute(b"", -1), "header is cut off"),
    "an attribute of 16 MB": (with_attribute(bytes(1 << 24)), "longer than 16 MiB"),
    "a name without end": (HEAD[:-1] + b"n" * 9999, "name longer than 255 bytes"),
    "no data window": (exr_bytes.header(NAMES, SMALL, dataWindow=b""), "no valid dataWindow"),
    "no compression": (exr_bytes.header(NAMES, SMALL, compression=99), "compression 99 is unknown"),
}


def test_no_room(tmp_path):
    """Headers that promise what is not there: refused in one line, before memory is taken.

    One process reads them all with MEMORY of addresses, of which a 16k x 16k image alone would need more. What it takes
    is the header's 16 MB and what Python makes of 65536 channels, some 500 bytes each: less than 64 MB.
    """
    for name, (data, _) in HOSTILE.items():
        (tmp_path / name).write_bytes(data)
    results = read_all(tmp_path)
    for name, (_, word) in HOSTILE.items():
        said, seconds, growth = results[name]
        assert word in said and said.isprintable(), (name, said)
        assert seconds < 10 and growth < 64 << 20, (name, seconds, growth)


def test_a_bomb_takes_what_it_unpacks_to(tmp_path):
    """A file may be a thousandth of its pixels: its channels, 10 bytes a pixel, the scene, 12, and little more.

    More are two masks of a byte a pixel in the search for NaN, and the library's own buffers: 32 MB are allowed for.
    """
    size = 3000
    channels = {**{name: np.zeros((size, size), np.float16) for name in "RGB"}, "Z": np.ones((size, size), np.float32)}
    path = save(tmp_path / "bomb", channels)
    assert path.stat().st_size * 500 < 10 * size**2
    said, _, growth = read_all(tmp_path)["bomb"]
    assert said == f"({size}, {size})"
    assert 20 * size**2 < growth < (10 + 12 + 2) * size**2 + (32 << 20)


def test_a_bad_bomb_takes_no_more(tmp_path):
    """NaN everywhere is refused with the channels and the two masks in memory; 32 MB for the library as above."""
    size = 3000
    channels = {name: np.full((size, size), np.nan, np.float32 if name == "Z" else np.float16) for name in "RGBZ"}
    save(tmp_path / "bomb", channels)
    said, _, growth = read_all(tmp_path)["bomb"]
    assert f"{size**2} pixels of channel R are NaN or infinite, the first at column 0, row 0" in said
    assert 10 * size**2 < growth < (10 + 2) * size**2 + (32 << 20)


def test_a_tile_takes_what_it_covers(tmp_path):
    """The widest tiles that are let pass: 4 x 1024 x 1024 pixels of 10 bytes, the scene's 12 for each that is seen.

    32 MB are allowed for the library as above.
    """
    for width, down in ((65536, 64), (2048, 2048)):
        (tmp_path / f"{width}").write_bytes(exr_bytes.wide_tile(width, width, down))
    for width, (said, _, growth) in read_all(tmp_path).items():
        assert said == f"({width}, 1)"
        assert growth < 10 * 4 * 1024**2 + 12 * int(width) + (32 << 20)


def test_names_stay_in_one_line(tmp_path):
    """Line ends and terminal codes in a channel's name do not reach the message."""
    head = exr_bytes.header({"a\nb\x1b[31m": "float16"}, (0, 0, 3, 0))
    (tmp_path / "in.exr").write_bytes(exr_bytes.with_table(head, [struct.pack("<ii", 0, 8) + bytes(8)]))
    refusal(tmp_path / "in.exr", "no channel R, G, B", "a b?[31m")


def test_limits():
    """The limits that validation/precision.md states."""
    text = (paths.ROOT / "validation/precision.md").read_text(encoding="utf-8")
    assert exr_header.MAX_PIXELS == 16384**2 and "16384 x 16384 pixels" in text
    assert exr_header.MAX_BYTES == 4 * 2**30 and "4 GiB" in text
    assert (exr_header.ROOM, exr_header.SMALL) == (4, 1024**2) and "4 times the image's pixels, or 4 x 1024" in text


def test_command(tmp_path):
    """The command itself: --layer; one line, exit code 2 and no output for what is refused."""
    channels = numbered("A.Combined A.Depth:Z B.Combined B.Depth:Z")
    source, target = save(tmp_path / "in.exr", channels), tmp_path / "out.exr"
    refused(run("render", source, "-o", target), ["in.exr", "A.Combined, B.Combined", "--layer"])
    (tmp_path / "huge.exr").write_bytes(HEAD)
    refused(run("render", tmp_path / "huge.exr", "-o", target), ["huge.exr", "cut off"])
    os.mkfifo(tmp_path / "pipe.exr")
    refused(run("render", tmp_path / "pipe.exr", "-o", target), ["pipe.exr", "a pipe or a device"])
    assert not target.exists() and not list(tmp_path.glob(".*"))
    done = run("render", source, "-o", target, "--layer", "B.Combined", "--driver", "reference")
    assert done.returncode == 0, done.stderr
    # a channel that is the same everywhere stays so
    np.testing.assert_allclose(exr.read(target, None).color[..., 0], channels["B.Combined.R"][0, 0], rtol=1e-6)
