"""OpenEXR files byte by byte, for what the library does not write: mipmaps, deep and broken headers."""

import math
import struct
import zlib
from pathlib import Path

import numpy as np

MAGIC = 20000630
TILED, DEEP, MULTI_PART = 0x200, 0x800, 0x1000
KINDS = {"uint32": 0, "float16": 1, "float32": 2}
Corner = tuple[int, int, int, int]


def attribute(name: str, kind: str, data: bytes, size: int | None = None) -> bytes:
    """One attribute; `size` is what it says of its length, if that is not to be the truth."""
    return b"%s\0%s\0" % (name.encode(), kind.encode()) + struct.pack("<i", len(data) if size is None else size) + data


def channel_list(channels: dict[str, str], sampled: dict[str, tuple[int, int]] | None = None) -> bytes:
    """The value of `channels`: data types by name, in their order (the format asks for that of the alphabet)."""
    entries = b""
    for name, kind in channels.items():
        entries += name.encode() + b"\0" + struct.pack("<iiii", KINDS[kind], 0, *(sampled or {}).get(name, (1, 1)))
    return entries + b"\0"


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
        "channels": attribute("channels", "chlist", channel_list(kinds)),
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


def tiles_attribute(width: int, height: int, mode: int = 0) -> bytes:
    """mode: 0 one level, 1 mipmaps, 2 ripmaps; + 16 rounds the sizes of levels up."""
    return attribute("tiles", "tiledesc", struct.pack("<IIB", width, height, mode))


def rgbz(names: str = "BGRZ") -> dict[str, str]:
    """Half colour and float depth."""
    return {name: "float32" if name == "Z" else "float16" for name in names}


def with_table(head: bytes, chunks: list[bytes]) -> bytes:
    """The header, the table of the chunks' places, the chunks."""
    at, table = len(head) + 8 * len(chunks), []
    for chunk in chunks:
        table.append(struct.pack("<Q", at))
        at += len(chunk)
    return head + b"".join(table) + b"".join(chunks)


def tiled(path: Path, channels: dict[str, np.ndarray], side: tuple[int, int], mode: int) -> Path:
    """An uncompressed tiled image with all of its levels; those behind the first hold 77 everywhere.

    Its header has the number of its chunks, so that whoever counts them from the sizes can be wrong.
    """
    channels = dict(sorted(channels.items()))
    height, width = next(iter(channels.values())).shape
    kinds = {name: plane.dtype.name for name, plane in channels.items()}
    chunks = []
    for lx, ly, columns, rows in _levels(width, height, mode):
        planes = channels if lx == ly == 0 else {n: np.full((rows, columns), 77, p.dtype) for n, p in channels.items()}
        for ty in range(math.ceil(rows / side[1])):
            for tx in range(math.ceil(columns / side[0])):
                cut = [p[ty * side[1] :, tx * side[0] :][: side[1], : side[0]] for p in planes.values()]
                data = b"".join(plane[row].tobytes() for row in range(cut[0].shape[0]) for plane in cut)
                chunks.append(struct.pack("<iiiii", tx, ty, lx, ly, len(data)) + data)
    more = tiles_attribute(*side, mode) + attribute("chunkCount", "int", struct.pack("<i", len(chunks)))
    head = header(kinds, (0, 0, width - 1, height - 1), flags=TILED, more=more)
    path.write_bytes(with_table(head, chunks))
    return path


def wide_tile(width: int, across: int, down: int) -> bytes:
    """A whole file: an image of one row of zeros in one zipped tile, across >= width; 1045 bytes for a width of 65536.

    The compression stores differences plus 128.
    """
    kinds = rgbz()
    size = width * sum(np.dtype(kind).itemsize for kind in kinds.values())
    packed = zlib.compress(b"\0" + b"\x80" * (size - 1))
    head = header(kinds, (0, 0, width - 1, 0), flags=TILED, compression=3, more=tiles_attribute(across, down))
    return with_table(head, [struct.pack("<iiiii", 0, 0, 0, 0, len(packed)) + packed])


def _levels(width: int, height: int, mode: int) -> list[tuple[int, int, int, int]]:
    """(level in x, level in y, width, height), in the order of the table."""

    def half(length: int, times: int) -> int:
        for _ in range(times):
            length = (length + 1) // 2 if mode & 16 else length // 2
        return max(1, length)

    def count(length: int) -> int:
        return next(k for k in range(32) if half(length, k) == 1) + 1

    if mode & 15 == 0:
        return [(0, 0, width, height)]
    if mode & 15 == 1:
        return [(k, k, half(width, k), half(height, k)) for k in range(count(max(width, height)))]
    return [(i, j, half(width, i), half(height, j)) for j in range(count(height)) for i in range(count(width))]
