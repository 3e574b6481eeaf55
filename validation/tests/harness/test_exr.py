"""EXR files as renderers write them, and as nobody should: read right, or refused in one line within bounded memory."""

import struct
from pathlib import Path

import exr_bytes
import numpy as np
import OpenEXR
import pytest
from exr_bytes import LOSSLESS, LOSSY, SCAN, TILED_IMAGE, refusal, save, save_parts, scene, windows

from bokeh_validation import exr, render


def same(got: exr.Scene, channels: dict[str, np.ndarray]) -> None:
    """The scene holds exactly these R G B Z."""
    for k, name in enumerate("RGB"):
        np.testing.assert_array_equal(got.color[..., k], channels[name])
    np.testing.assert_array_equal(got.depth, channels["Z"])
    assert (got.color[..., 3] == 1).all() and got.depth.dtype == np.float32


# ------------------------------------------------------------------------------------------------------------- formats


@pytest.mark.parametrize("kind", (SCAN, TILED_IMAGE), ids=("scan lines", "tiles"))
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


def test_render_takes_a_layer(tmp_path):
    """A channel that is the same everywhere stays so."""
    channels = numbered("A.Combined A.Depth:Z B.Combined B.Depth:Z")
    source, target = save(tmp_path / "in.exr", channels), tmp_path / "out.exr"
    render.render(source, target, layer="B.Combined", driver="reference")
    np.testing.assert_allclose(exr.read(target, None).color[..., 0], channels["B.Combined.R"][0, 0], rtol=1e-6)
