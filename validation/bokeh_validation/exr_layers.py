"""Which channels of an OpenEXR file are the colour and the depth: layers and parts as renderers name them."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from bokeh_validation.errors import UserError
from bokeh_validation.exr_header import Channel, Part, printable

# Parts of a name that mark the picture among its layers (Blender: Combined; other renderers: beauty; Nuke: rgba).
MAIN = ("combined", "beauty", "rgba")
DEPTH = ("depth", "z", "zdepth")
# Blender's compositor writes a single value as V, its render layers write depth as Z.
DEFAULT_DEPTH, BLENDER_VALUE = "Z", "V"
MAX_LISTED = 12


@dataclass(frozen=True)
class Choice:
    """Where colour and depth are: the numbers of their parts and the full names of their channels."""

    part: int
    color: tuple[str, str, str]
    depth_part: int
    depth: str | None


@dataclass(frozen=True)
class _Entry:
    """A channel `Layer.Name`: `layer` as the file has it, `path` with the part's name before it."""

    part: int
    channel: Channel
    layer: str
    last: str
    path: str

    @property
    def full(self) -> str:
        return f"{self.path}.{self.last}" if self.path else self.last


def pick(path: Path, parts: tuple[Part, ...], layer: str | None, depth: str | None) -> Choice:
    """Colour of `layer`, or of the layer that is the picture; its depth channel, `depth=None` for none.

    Raises UserError where there is none, where there are several, and where the channels cannot be used: subsampled,
    whole numbers, another window.
    """
    entries = list(_entries(parts))
    names = _names(entries)
    group = _colour(path, parts, entries, layer)
    colour = tuple(_only(group, name) for name in "RGB")
    _usable(path, colour)
    found = None if depth is None else _depth(path, parts, entries, group[0], depth, names)
    part, name = (group[0].part, None) if found is None else (found.part, found.channel.name)
    return Choice(group[0].part, tuple(entry.channel.name for entry in colour), part, name)


def _entries(parts: tuple[Part, ...]) -> Iterator[_Entry]:
    for number, part in enumerate(parts):
        for channel in part.channels:
            layer, _, last = channel.name.rpartition(".")
            path = layer
            # a file of several parts may name the layer twice
            if len(parts) > 1 and part.name and layer != part.name and not layer.startswith(part.name + "."):
                path = f"{part.name}.{layer}".rstrip(".")
            yield _Entry(number, channel, layer, last, path)


def _colour(path: Path, parts: tuple[Part, ...], entries: list[_Entry], wanted: str | None) -> list[_Entry]:
    """The entries of one layer that has R, G and B."""
    groups: dict[tuple[int, str], list[_Entry]] = {}
    for entry in entries:
        groups.setdefault((entry.part, entry.layer), []).append(entry)
    full = [group for group in groups.values() if {"R", "G", "B"} <= {entry.last for entry in group}]
    if wanted is not None:
        return _named(path, list(groups.values()), full, wanted)
    plain = [group for group in full if not group[0].layer]
    marked = [group for group in plain or full if any(word in MAIN for word in _words(group[0].path))]
    if len(marked) == 1:
        return marked[0]
    # the first part is what a reader that knows nothing of parts shows
    if plain or len(full) == 1:
        return (plain or full)[0]
    if full:
        listed = _listed([group[0].path for group in full], ", ")
        raise UserError(f"{path}: several layers have R, G and B ({listed}). Name one with --layer.")
    have = {entry.last for entry in entries if not entry.layer}
    missing = [name for name in "RGB" if name not in have]
    luminance = ": luminance without colour" if "Y" in have and "RY" not in have else ""
    chroma = ": luminance and chroma" if {"Y", "RY"} <= have else ""
    raise UserError(
        f"{path}: no channel {', '.join(missing)} (it has {_names(entries)}{luminance}{chroma}). Save it as R G B."
    )


def _named(path: Path, groups: list[list[_Entry]], full: list[list[_Entry]], wanted: str) -> list[_Entry]:
    """The layer that --layer names: by the file's own name, or with the part's before it."""
    exact = [group for group in groups if group[0].path == wanted]
    found = exact or [group for group in groups if group[0].layer == wanted]
    if len(found) == 1 and found[0] in full:
        return found[0]
    if len(found) > 1:
        listed = _listed([group[0].path for group in found], ", ")
        raise UserError(
            f"{path}: several layers are called {printable(wanted)!r} ({listed}). Give --layer one of them."
        )
    if found:
        have = {entry.last for entry in found[0]}
        missing = ", ".join(name for name in "RGB" if name not in have)
        raise UserError(f"{path}: layer {printable(wanted)!r} has no channel {missing}. Give --layer one with R G B.")
    listed = _listed([group[0].path for group in full if group[0].path], ", ")
    raise UserError(f"{path}: no layer {printable(wanted)!r} (with R G B it has {listed}). Give --layer one of them.")


def _depth(
    path: Path, parts: tuple[Part, ...], entries: list[_Entry], colour: _Entry, wanted: str, names: str
) -> _Entry:
    """The depth channel that is closest to the colour's layer."""
    window = parts[colour.part].data, parts[colour.part].display
    for tier in _tiers(entries, colour, wanted):
        if not tier:
            continue
        fitting = [entry for entry in tier if (parts[entry.part].data, parts[entry.part].display) == window]
        if not fitting:
            raise UserError(
                f"{path}: depth channel {printable(tier[0].full)!r} differs in size from the colour "
                f"({parts[tier[0].part].data}, not {window[0]}). Save both at one size."
            )
        if len(fitting) > 1:
            listed = _listed([entry.full for entry in fitting], ", ")
            raise UserError(f"{path}: several depth channels ({listed}). Name one with --depth-channel.")
        _usable_depth(path, fitting[0])
        return fitting[0]
    raise UserError(
        f"{path}: no depth channel {wanted!r} (it has {names}). Name one with --depth-channel, or give --coc."
    )


def _tiers(entries: list[_Entry], colour: _Entry, wanted: str) -> Iterator[list[_Entry]]:
    """Candidates, the closest first."""
    lasts = {wanted, BLENDER_VALUE} if wanted == DEFAULT_DEPTH else {wanted}
    # a Z beside X and Y is a direction or a place
    vectors = {(e.part, e.layer) for e in entries if e.last == "X"} & {
        (e.part, e.layer) for e in entries if e.last == "Y"
    }
    scalars = [entry for entry in entries if "." in wanted or (entry.part, entry.layer) not in vectors]
    words = _words(colour.path) or [""]
    beside = [[*words[:k], "depth", *words[k + 1 :]] for k in range(len(words))]
    yield [e for e in entries if (e.part, e.layer, e.last) == (colour.part, colour.layer, wanted)]
    yield [e for e in scalars if e.last in lasts and _words(e.path) in beside]
    yield [e for e in scalars if e.part == colour.part and e.channel.name == wanted]
    yield [e for e in scalars if wanted in (e.channel.name, e.full)]
    yield [e for e in scalars if e.last in lasts and any(word in DEPTH for word in _words(e.path))]


def _words(name: str) -> list[str]:
    return [word.casefold() for word in name.split(".") if word]


def _only(group: list[_Entry], name: str) -> _Entry:
    return next(entry for entry in group if entry.last == name)


def _usable(path: Path, colour: tuple[_Entry, ...]) -> None:
    if any(entry.channel.sampled != (1, 1) for entry in colour):
        raise UserError(f"{path}: R, G and B differ in size. Save it without chroma subsampling.")
    for entry in colour:
        if entry.channel.kind == "uint":
            raise UserError(
                f"{path}: channel {printable(entry.full)} holds whole numbers (uint), which are no light. "
                "Save it as half or float."
            )


def _usable_depth(path: Path, entry: _Entry) -> None:
    name = printable(entry.full)
    if entry.channel.sampled != (1, 1):
        raise UserError(f"{path}: depth channel {name!r} differs in size from the colour. Save both at one size.")
    if entry.channel.kind == "uint":
        raise UserError(
            f"{path}: depth channel {name!r} holds whole numbers (uint), whose unit the file does not say. "
            "Save it as float, in metres."
        )


def _names(entries: list[_Entry]) -> str:
    return _listed([entry.full for entry in entries], " ")


def _listed(names: list[str], between: str) -> str:
    """Names in a message: printable, and not a page of them."""
    shown = [printable(name) for name in dict.fromkeys(names)]
    more = f"{between}and {len(shown) - MAX_LISTED} more" if len(shown) > MAX_LISTED else ""
    return (between.join(shown[:MAX_LISTED]) or "none") + more
