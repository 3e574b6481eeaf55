"""What an OpenEXR file says of itself, read before the library makes room for its pixels.

Only what the library does not see to: its time grows with the square of the number of channels and attributes, it makes
room for whole tiles, and a window that is missing is 64 x 64 to it. The layout is that of the OpenEXR File Layout
document (openexr.com): magic number, version and flags, then the attributes of each part.
"""

import math
import stat
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from bokeh_validation.errors import UserError

# The largest texture of common devices.
MAX_PIXELS = 16384 * 16384
# All channels of all parts, unpacked: 16384 x 16384 pixels of R G B in half and Z in float are 2.5 GiB.
MAX_BYTES = 4 << 30
# An attribute can be as long as a list of object names; a header is not an image.
MAX_HEADER = 16 << 20
# Attributes and channels of all parts together.
MAX_ENTRIES = 1 << 16
# Tiles that are no larger than the image in either direction cover less than ROOM times its pixels: so much is let
# pass, and as much of SMALL, as small images come in tiles larger than they are.
ROOM, SMALL = 4, 1024 * 1024

MAGIC = 20000630
TILED, DEEP, MULTI_PART = 0x200, 0x800, 0x1000
KINDS = ("uint", "half", "float")
SIZES = (4, 2, 4)


class Window(NamedTuple):
    """A rectangle of pixels; right and bottom belong to it."""

    left: int
    top: int
    right: int
    bottom: int

    # pixels; 0 or less where the window is empty
    width = property(lambda self: self.right - self.left + 1)
    height = property(lambda self: self.bottom - self.top + 1)

    def within(self, other: "Window") -> "Window":
        """What both have; empty where they do not meet."""
        corner = min(self.right, other.right), min(self.bottom, other.bottom)
        return Window(max(self.left, other.left), max(self.top, other.top), *corner)

    def __str__(self) -> str:
        return f"{self.width} x {self.height} at {self.left},{self.top}"


class Part(NamedTuple):
    """One image of the file."""

    data: Window
    display: Window


@dataclass(frozen=True)
class Channel:
    """A channel `layer.last` of a part.

    part     its number
    name     as the file has it
    path     the layer, with the part's name before it
    full     what a user may call the channel
    words    those of the path
    kind     uint, half or float
    sampled  distance of its samples in x and y
    """

    part: int
    name: str
    path: str
    kind: str
    sampled: tuple[int, int]

    @property
    def layer(self) -> str:
        return self.name.rpartition(".")[0]

    @property
    def last(self) -> str:
        return self.name.rpartition(".")[2]

    @property
    def full(self) -> str:
        return f"{self.path}.{self.last}" if self.path else self.last

    @property
    def words(self) -> list[str]:
        return [word.casefold() for word in self.path.split(".") if word]


def read(path: Path) -> tuple[list[Part], list[Channel]]:
    """Parts and channels of a file whose header is within the limits above.

    Raises UserError for what is no readable regular file, no OpenEXR, deep, empty, or too large.
    """
    try:
        # not opened before it is known to be a file: a pipe would wait for a writer
        mode = path.stat().st_mode
        if stat.S_ISDIR(mode):
            raise UserError(f"{path}: is a folder. Name an EXR file in it.")
        if not stat.S_ISREG(mode):
            raise UserError(f"{path}: is a pipe or a device. Save it to a file first.")
        with path.open("rb") as file:
            return _parts(path, file.read(MAX_HEADER))
    except (FileNotFoundError, NotADirectoryError) as error:
        raise UserError(f"{path}: no such file. Check the path.") from error
    except PermissionError as error:
        raise UserError(f"{path}: may not be read. Check its permissions.") from error
    except _Broken as error:
        raise UserError(f"{path}: cannot be read as OpenEXR ({error}). Save it again.") from error
    except (OSError, ValueError) as error:
        raise UserError(f"{path}: cannot be read ({printable(str(error))}). Check the path.") from error


def printable(text: str) -> str:
    """Text from a file or a library as part of one line, of bounded length."""
    line = "".join(c if c.isprintable() else "?" for c in " ".join(text.split()))
    return line if len(line) <= 200 else f"{line[:200]} ..."


class _Broken(Exception):
    """Why this is not a whole OpenEXR file."""


class _Cursor:
    """Bytes of a header, read from the front."""

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
        length = self.data.find(b"\0", self.at, self.at + 256) - self.at
        if length < 0:
            self.take(256)
            raise _Broken("it has a name longer than 255 bytes")
        return self.take(length + 1)[:-1].decode(errors="replace")


def _parts(path: Path, data: bytes) -> tuple[list[Part], list[Channel]]:
    if not data.startswith(struct.pack("<I", MAGIC)):
        raise _Broken("it does not begin like one" if data else "it is empty")
    cursor = _Cursor(data)
    _, flags = cursor.numbers("II")
    several = bool(flags & MULTI_PART)
    parts, channels, total = [], [], 0
    for attributes, found in _headers(cursor, several):
        kind = attributes.get("type", b"").rstrip(b"\0")
        if flags & DEEP or kind.startswith(b"deep"):
            raise UserError(f"{path}: is a deep image, with many samples in a pixel. Save it flattened.")
        part = Part(_window(path, attributes, "dataWindow"), _window(path, attributes, "displayWindow"))
        tiled = kind == b"tiledimage" if several else flags & TILED
        columns, rows = _whole_tiles(path, part.data, attributes) if tiled else (part.data.width, part.data.height)
        for name, number, _, across, down in found:
            if not 0 <= number < len(KINDS) or across < 1 or down < 1:
                raise _Broken(f"channel {printable(name)} is of no known type or sampling")
            full = _path(name, attributes) if several else name.rpartition(".")[0]
            channels.append(Channel(len(parts), name, full, KINDS[number], (across, down)))
            total += math.ceil(columns / across) * math.ceil(rows / down) * SIZES[number]
        parts.append(part)
    if cursor.at == len(data):
        raise _Broken("it is cut off behind its header")
    if total > MAX_BYTES:
        size = f"{total / 2**30:.1f} GiB unpacked, more than {MAX_BYTES >> 30}"
        raise UserError(f"{path}: its channels are {size}. Save only R G B and depth, or scale it.")
    return parts, channels


def _path(channel: str, attributes: dict[str, bytes]) -> str:
    """Its layer, with the part's name before it unless the layer begins like that."""
    layer = channel.rpartition(".")[0]
    name = attributes.get("name", b"").rstrip(b"\0").decode(errors="replace")
    return layer if f"{layer}.".startswith(f"{name}.") or not name else f"{name}.{layer}".rstrip(".")


def _headers(cursor: _Cursor, several: bool) -> Iterator[tuple[dict[str, bytes], list[tuple]]]:
    """Of each part: its attributes by name, and (name, kind, not used, distance in x, in y) of its channels."""
    while True:
        attributes, channels = {}, []
        while name := cursor.name():
            cursor.name()
            (size,) = cursor.numbers("i")
            if name != "channels":
                attributes[name] = cursor.take(size)
                continue
            end = cursor.at + size
            while channel := cursor.name():
                channels.append((channel, *cursor.numbers("iiii")))
            if cursor.at != end:
                raise _Broken("its list of channels is not as long as it says")
        # a file of several parts ends its headers with an empty one
        if several and not attributes and not channels:
            return
        if not channels:
            raise _Broken("its header has no channels")
        yield attributes, channels
        if not several:
            return


def _numbers(attributes: dict[str, bytes], name: str, layout: str) -> tuple[int, ...]:
    try:
        return struct.unpack(layout, attributes.get(name, b""))
    except struct.error as error:
        raise _Broken(f"its header has no valid {name}") from error


def _window(path: Path, attributes: dict[str, bytes], name: str) -> Window:
    window = Window(*_numbers(attributes, name, "<iiii"))
    size = f"{window.width} x {window.height}"
    if window.width <= 0 or window.height <= 0:
        raise UserError(f"{path}: the image is empty ({size} pixels). Save it with at least one pixel.")
    if window.width * window.height > MAX_PIXELS:
        raise UserError(f"{path}: {size} pixels are more than {MAX_PIXELS}. Crop or scale it.")
    return window


def _whole_tiles(path: Path, data: Window, attributes: dict[str, bytes]) -> tuple[int, int]:
    """(columns, rows) of the tiles of the first level, however little of them the image fills."""
    across, down, _ = _numbers(attributes, "tiles", "<IIB")
    if not across or not down:
        raise _Broken(f"it has tiles of {across} x {down} pixels")
    columns, rows = math.ceil(data.width / across) * across, math.ceil(data.height / down) * down
    if columns * rows > ROOM * max(SMALL, data.width * data.height):
        raise UserError(
            f"{path}: its tiles of {across} x {down} pixels cover {columns} x {rows} for an image of {data.width} x "
            f"{data.height}. Save it in smaller tiles or as scan lines."
        )
    return columns, rows
