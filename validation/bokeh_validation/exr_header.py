"""What an OpenEXR file says of itself, checked before the library is asked to make room for its pixels.

The layout is that of the OpenEXR File Layout document (openexr.com): magic number, version and flags, the attributes of
each part, then for each part a table with the place of every chunk of pixels.
"""

import itertools
import math
import stat
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bokeh_validation.errors import UserError

# The largest texture of common devices.
MAX_PIXELS = 16384 * 16384
# All channels of all parts, unpacked: 16384 x 16384 pixels of R G B in half and Z in float are 2.5 GiB.
MAX_BYTES = 4 << 30
# An attribute can be as long as a list of object names; a header is not an image.
MAX_HEADER = 16 << 20
# Attributes and channels of all parts together; the library keeps some hundred bytes for each.
MAX_ENTRIES = 1 << 16
MAX_CHUNKS = 1 << 22
# The library makes room for whole tiles. Those that are no larger than the image in either direction cover less than
# ROOM times its pixels: so much is let pass, and as much of SMALL, as small images come in tiles larger than they are.
ROOM, SMALL = 4, 1024 * 1024

MAGIC = 20000630
TILED, DEEP, MULTI_PART = 0x200, 0x800, 0x1000
# Rows in a chunk, by the number of the compression in the file: none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA,
# DWAB, HTJ2K256, HTJ2K32, LJ2K, ZSTD.
ROWS = (1, 1, 1, 16, 32, 16, 32, 32, 32, 256, 256, 32, 256, 1)
KINDS = ("uint", "half", "float")
SIZES = {"uint": 4, "half": 2, "float": 4}


@dataclass(frozen=True)
class Window:
    """A rectangle of pixels; right and bottom belong to it."""

    left: int
    top: int
    right: int
    bottom: int

    @property
    def width(self) -> int:
        """Pixels; 0 or less where the window is empty."""
        return self.right - self.left + 1

    @property
    def height(self) -> int:
        """Pixels; 0 or less where the window is empty."""
        return self.bottom - self.top + 1

    def within(self, other: "Window") -> "Window":
        """What both have; empty where they do not meet."""
        return Window(
            max(self.left, other.left),
            max(self.top, other.top),
            min(self.right, other.right),
            min(self.bottom, other.bottom),
        )

    def __str__(self) -> str:
        return f"{self.width} x {self.height} at {self.left},{self.top}"


@dataclass(frozen=True)
class Channel:
    """One channel of a part; `kind` is uint, half or float, `sampled` its distance of samples in x and y."""

    name: str
    kind: str
    sampled: tuple[int, int]


@dataclass(frozen=True)
class Part:
    """One image of the file.

    name    empty in a file of one part
    chunks  length of its table
    room    (columns, rows) that the library makes room for: the data window, or its tiles as a whole
    """

    name: str
    channels: tuple[Channel, ...]
    data: Window
    display: Window
    chunks: int
    room: tuple[int, int]


def read(path: Path) -> tuple[Part, ...]:
    """The parts of a file that can hold what its header says, within the limits above.

    Raises UserError for what is no readable regular file, no OpenEXR, deep, empty, too large, or cut off.
    """
    try:
        # not opened before it is known to be a file: a pipe would wait for a writer
        mode = path.stat().st_mode
        if stat.S_ISDIR(mode):
            raise UserError(f"{path}: is a folder. Name an EXR file in it.")
        if not stat.S_ISREG(mode):
            raise UserError(f"{path}: is a pipe or a device. Save it to a file first.")
        with path.open("rb") as file:
            size = path.stat().st_size
            return _checked(path, file, size)
    except (FileNotFoundError, NotADirectoryError) as error:
        raise UserError(f"{path}: no such file. Check the path.") from error
    except PermissionError as error:
        raise UserError(f"{path}: may not be read. Check its permissions.") from error
    except (OSError, ValueError) as error:
        raise UserError(f"{path}: cannot be read ({printable(str(error))}). Check the path.") from error
    except _Broken as error:
        raise UserError(f"{path}: cannot be read as OpenEXR ({error}). Save it again.") from error


def printable(text: str) -> str:
    """Text from a file or a library as part of one line, of bounded length."""
    line = "".join(c if c.isprintable() else "?" for c in " ".join(text.split()))
    return line if len(line) <= 200 else f"{line[:200]} ..."


class _Broken(Exception):
    """Why this is not a whole OpenEXR file."""


class _Cursor:
    """The header's bytes, read from the front."""

    def __init__(self, data: bytes):
        self.data, self.at, self.entries = data, 0, 0

    def take(self, count: int) -> bytes:
        if count < 0 or self.at + count > len(self.data):
            long = len(self.data) == MAX_HEADER
            raise _Broken(f"its header is longer than {MAX_HEADER >> 20} MiB" if long else "its header is cut off")
        self.at += count
        return self.data[self.at - count : self.at]

    def numbers(self, layout: str) -> tuple[int, ...]:
        return struct.unpack("<" + layout, self.take(struct.calcsize("<" + layout)))

    def name(self) -> str:
        """A zero-terminated name; each counts as an entry."""
        self.entries += 1
        if self.entries > MAX_ENTRIES:
            raise _Broken(f"it has more than {MAX_ENTRIES} attributes and channels")
        end = self.data.find(b"\0", self.at, self.at + 256)
        if end < 0:
            self.take(min(256, len(self.data) - self.at + 1))
            raise _Broken("it has a name longer than 255 bytes")
        text = self.data[self.at : end].decode(errors="replace")
        self.at = end + 1
        return text


def _checked(path: Path, file, size: int) -> tuple[Part, ...]:
    cursor = _Cursor(file.read(MAX_HEADER))
    if size == 0:
        raise _Broken("it is empty")
    if size < 8 or cursor.numbers("I")[0] != MAGIC:
        raise _Broken("it does not begin like one")
    (flags,) = cursor.numbers("I")
    parts = []
    for attributes in _headers(cursor, bool(flags & MULTI_PART)):
        kind = attributes.get("type", b"").rstrip(b"\0")
        if flags & DEEP or kind.startswith(b"deep"):
            raise UserError(f"{path}: is a deep image, with many samples in a pixel. Save it flattened.")
        tiled = kind == b"tiledimage" if flags & MULTI_PART else bool(flags & TILED)
        parts.append(_part(path, attributes, tiled))
    total = sum(_unpacked(part) for part in parts)
    if total > MAX_BYTES:
        raise UserError(
            f"{path}: its channels are {total / 2**30:.1f} GiB unpacked, more than {MAX_BYTES >> 30}. "
            "Save only R G B and depth, or scale it."
        )
    _check_chunks(file, cursor.at, sum(part.chunks for part in parts), size)
    return tuple(parts)


def _headers(cursor: _Cursor, several: bool):
    """The attributes of each part, as bytes by name; those of channels stay in one piece."""
    while True:
        attributes = {}
        while name := cursor.name():
            cursor.name()
            attributes[name] = cursor.take(cursor.numbers("i")[0])
            if name == "channels":
                attributes[name] = _channels(attributes[name], cursor)
        if attributes:
            yield attributes
        # a file of several parts ends its headers with an empty one
        if not several or not attributes:
            return


def _channels(data: bytes, header: _Cursor) -> tuple[Channel, ...]:
    cursor = _Cursor(data)
    cursor.entries = header.entries
    channels = []
    while name := cursor.name():
        kind, _, across, down = cursor.numbers("iiii")
        if not 0 <= kind < len(KINDS) or across < 1 or down < 1:
            raise _Broken(f"channel {printable(name)} is of no known type or sampling")
        channels.append(Channel(name, KINDS[kind], (across, down)))
    header.entries = cursor.entries
    return tuple(channels)


def _part(path: Path, attributes: dict, tiled: bool) -> Part:
    def numbers(name: str, layout: str) -> tuple[int, ...]:
        data = attributes.get(name)
        if data is None or len(data) != struct.calcsize("<" + layout):
            raise _Broken(f"its header has no valid {name}")
        return struct.unpack("<" + layout, data)

    if not attributes.get("channels"):
        raise _Broken("its header has no channels")
    data, display = (Window(*numbers(name, "iiii")) for name in ("dataWindow", "displayWindow"))
    for window in (data, display):
        size = f"{window.width} x {window.height}"
        if window.width <= 0 or window.height <= 0:
            raise UserError(f"{path}: the image is empty ({size} pixels). Save it with at least one pixel.")
        if window.width * window.height > MAX_PIXELS:
            raise UserError(f"{path}: {size} pixels are more than {MAX_PIXELS}. Crop or scale it.")
    (compression,) = numbers("compression", "B")
    if compression >= len(ROWS):
        raise _Broken(f"compression {compression} is unknown")
    if tiled:
        across, down, mode = numbers("tiles", "IIB")
        room = _whole_tiles(path, data, across, down)
        chunks = _tiles(data, across, down, mode)
    else:
        room = data.width, data.height
        chunks = math.ceil(data.height / ROWS[compression])
    if "chunkCount" in attributes and numbers("chunkCount", "i")[0] != chunks:
        raise _Broken(f"its header counts {numbers('chunkCount', 'i')[0]} chunks of pixels, its size says {chunks}")
    name = attributes.get("name", b"").rstrip(b"\0").decode(errors="replace")
    return Part(name, attributes["channels"], data, display, chunks, room)


def _whole_tiles(path: Path, data: Window, across: int, down: int) -> tuple[int, int]:
    """(columns, rows) of the tiles of the first level, however little of them the image fills."""
    if not across or not down:
        raise _Broken(f"it has tiles of {across} x {down} pixels")
    columns, rows = (-(-length // side) * side for length, side in ((data.width, across), (data.height, down)))
    if columns * rows > ROOM * max(SMALL, data.width * data.height):
        raise UserError(
            f"{path}: its tiles of {across} x {down} pixels cover {columns} x {rows} for an image of {data.width} x "
            f"{data.height}. Save it in smaller tiles or as scan lines."
        )
    return columns, rows


def _tiles(data: Window, across: int, down: int, mode: int) -> int:
    """Tiles of all levels: mode & 15 is 0 for one level, 1 for mipmaps, 2 for ripmaps; mode >> 4 is 1 to round up."""
    level, up = mode & 15, mode >> 4
    if level > 2 or up > 1:
        raise _Broken(f"its tiles have levels of an unknown kind, {mode}")

    def sizes(length: int, longest: int) -> list[int]:
        count = (longest - 1).bit_length() + 1 if up else longest.bit_length()
        return [max(1, -(-length >> k) if up else length >> k) for k in range(count)]

    longest = max(data.width, data.height)
    if level == 2:
        pairs = itertools.product(sizes(data.width, data.width), sizes(data.height, data.height))
    else:
        pairs = zip(sizes(data.width, longest), sizes(data.height, longest), strict=True)
    return sum(
        math.ceil(width / across) * math.ceil(height / down)
        for width, height in itertools.islice(pairs, None if level else 1)
    )


def _unpacked(part: Part) -> int:
    """Bytes of the part's pixels in memory."""
    columns, rows = part.room
    return sum(
        math.ceil(columns / c.sampled[0]) * math.ceil(rows / c.sampled[1]) * SIZES[c.kind] for c in part.channels
    )


def _check_chunks(file, start: int, count: int, size: int) -> None:
    """Every chunk must begin inside the file, behind the tables: in a file that was cut off one does not."""
    if count > MAX_CHUNKS:
        raise _Broken(f"it has more than {MAX_CHUNKS} chunks of pixels")
    end = start + 8 * count
    if end > size:
        raise _Broken(f"it is cut off: its table of pixels ends at byte {end}, the file at {size}")
    file.seek(start)
    places = np.frombuffer(file.read(8 * count), "<u8")
    outside = (places < end) | (places >= size)
    if outside.any():
        raise _Broken(f"it is cut off or was never finished: {int(outside.sum())} of {count} chunks are missing")
