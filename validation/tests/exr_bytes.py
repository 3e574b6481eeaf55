"""OpenEXR files for tests, and byte by byte what the library does not write: mipmaps, deep and broken headers."""

import math
import struct
import zlib
from pathlib import Path

import numpy as np
import OpenEXR
import pytest

from bokeh_validation import exr
from bokeh_validation.errors import UserError

MAGIC = 20000630
TILED, DEEP, MULTI_PART = 0x200, 0x800, 0x1000
KINDS = {"uint32": 0, "float16": 1, "float32": 2}
RGBZ = {"B": "float16", "G": "float16", "R": "float16", "Z": "float32"}
Corner = tuple[int, int, int, int]


def attribute(name: str, kind: str, data: bytes, size: int | None = None) -> bytes:
    """One attribute; `size` is what it says of its length, if that is not to be the truth."""
    return b"%s\0%s\0" % (name.encode(), kind.encode()) + struct.pack("<i", len(data) if size is None else size) + data


def channels(kinds: dict[str, str], sampled: dict[str, tuple[int, int]] | None = None) -> bytes:
    """The attribute of that name: data types by name, in their order (the format asks for that of the alphabet)."""
    rate = sampled or {}
    entries = [
        name.encode() + b"\0" + struct.pack("<iiii", KINDS[kind], 0, *rate.get(name, (1, 1)))
        for name, kind in kinds.items()
    ]
    return attribute("channels", "chlist", b"".join(entries) + b"\0")


def tiles(width: int, height: int, mode: int = 0) -> bytes:
    """The attribute of that name; mode: 0 one level, 1 mipmaps, 2 ripmaps."""
    return attribute("tiles", "tiledesc", struct.pack("<IIB", width, height, mode))


def header(
    kinds: dict[str, str],
    data: Corner,
    display: Corner | None = None,
    flags: int = 0,
    compression: int = 0,
    more: bytes = b"",
    **changed: bytes,
) -> bytes:
    """Magic number to the end of the only header; windows are left, top, right, bottom; `changed` attributes, raw."""
    attributes = {
        "channels": channels(kinds),
        "compression": attribute("compression", "compression", bytes([compression])),
        "dataWindow": attribute("dataWindow", "box2i", struct.pack("<iiii", *data)),
        "displayWindow": attribute("displayWindow", "box2i", struct.pack("<iiii", *(display or data))),
        "lineOrder": attribute("lineOrder", "lineOrder", b"\0"),
        "pixelAspectRatio": attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
        "screenWindowCenter": attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)),
        "screenWindowWidth": attribute("screenWindowWidth", "float", struct.pack("<f", 1)),
    }
    attributes.update(changed)
    return struct.pack("<II", MAGIC, 2 | flags) + b"".join(attributes.values()) + more + b"\0"


def with_table(head: bytes, chunks: list[bytes]) -> bytes:
    """The header, the table of the chunks' places, the chunks."""
    at, table = len(head) + 8 * len(chunks), []
    for chunk in chunks:
        table.append(struct.pack("<Q", at))
        at += len(chunk)
    return head + b"".join(table) + b"".join(chunks)


def tiled(path: Path, planes: dict[str, np.ndarray], side: tuple[int, int], mode: int) -> Path:
    """An uncompressed tiled image with all of its levels; those behind the first hold 77 everywhere."""
    planes = dict(sorted(planes.items()))
    height, width = next(iter(planes.values())).shape
    columns = [width >> k for k in range(width.bit_length() if mode else 1)]
    rows = [height >> k for k in range(height.bit_length() if mode else 1)]
    levels = [(i, j) for j in range(len(rows)) for i in range(len(columns))]
    if mode == 1:
        levels = [(k, k) for k in range(max(len(rows), len(columns)))]
    chunks = []
    for lx, ly in levels:
        size = max(1, height >> ly), max(1, width >> lx)
        level = planes if lx == ly == 0 else {name: np.full(size, 77, p.dtype) for name, p in planes.items()}
        for ty in range(math.ceil(size[0] / side[1])):
            for tx in range(math.ceil(size[1] / side[0])):
                cut = [p[ty * side[1] :, tx * side[0] :][: side[1], : side[0]] for p in level.values()]
                data = b"".join(plane[row].tobytes() for row in range(cut[0].shape[0]) for plane in cut)
                chunks.append(struct.pack("<iiiii", tx, ty, lx, ly, len(data)) + data)
    kinds = {name: plane.dtype.name for name, plane in planes.items()}
    head = header(kinds, (0, 0, width - 1, height - 1), flags=TILED, more=tiles(*side, mode))
    path.write_bytes(with_table(head, chunks))
    return path


def wide_tile(width: int, across: int, down: int) -> bytes:
    """A whole file: an image of one row of zeros in one zipped tile, across >= width; 1045 bytes for a width of 65536.

    The compression stores differences plus 128.
    """
    size = width * sum(np.dtype(kind).itemsize for kind in RGBZ.values())
    packed = zlib.compress(b"\0" + b"\x80" * (size - 1))
    head = header(RGBZ, (0, 0, width - 1, 0), flags=TILED, compression=3, more=tiles(across, down))
    return with_table(head, [struct.pack("<iiiii", 0, 0, 0, 0, len(packed)) + packed])


LOSSLESS = ("NO", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "HTJ2K256", "HTJ2K32", "ZSTD")
LOSSY = ("B44", "B44A", "DWAA", "DWAB", "LJ2K")
SCAN, TILED_IMAGE = OpenEXR.scanlineimage, OpenEXR.tiledimage


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
    if header["type"] == TILED_IMAGE:
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


def refusal(path: Path, *words: str, **options) -> None:
    """A file is refused in one line that names it and has these words."""
    with pytest.raises(UserError) as caught:
        exr.read(path, **options)
    line = str(caught.value)
    assert line.startswith(str(path)) and line.isprintable() and len(line) < 1500
    assert [word for word in words if word not in line] == [], line
