"""Which channels of an OpenEXR file are the colour and the depth: layers and parts as renderers name them."""

from collections.abc import Iterable, Iterator
from pathlib import Path

from bokeh_validation.errors import UserError
from bokeh_validation.exr_header import Channel, Part, printable

# Parts of a name that mark the picture among its layers (Blender: Combined; other renderers: beauty; Nuke: rgba).
MAIN = ("combined", "beauty", "rgba")
DEPTH = ("depth", "z", "zdepth")
# Blender's compositor writes a single value as V, its render layers write depth as Z.
DEFAULT_DEPTH, BLENDER_VALUE = "Z", "V"
MAX_LISTED = 12


def pick(path: Path, parts: list[Part], channels: list[Channel], layer: str | None, depth: str | None) -> list[Channel]:
    """R, G and B of `layer`, or of the layer that is the picture, and its depth channel; `depth=None` for none.

    Raises UserError where there is none, where there are several, and where the channels cannot be used: subsampled,
    whole numbers, another window.
    """
    try:
        group = _colour(channels, layer)
        colour = [next(entry for entry in group if entry.last == name) for name in "RGB"]
        if any(entry.sampled != (1, 1) for entry in colour):
            raise UserError("R, G and B differ in size. Save it without chroma subsampling.")
        for entry in colour:
            _not_whole(entry, "channel", "which are no light. Save it as half or float.")
        return colour if depth is None else [*colour, _depth(parts, channels, group[0], depth)]
    except UserError as error:
        raise UserError(f"{path}: {error}") from error


def _colour(channels: list[Channel], wanted: str | None) -> list[Channel]:
    """The entries of one layer that has R, G and B."""
    groups: dict[tuple[int, str], list[Channel]] = {}
    for entry in channels:
        groups.setdefault((entry.part, entry.layer), []).append(entry)
    full = [group for group in groups.values() if not _missing(group)]
    if wanted is not None:
        return _named(list(groups.values()), full, wanted)
    plain = [group for group in full if not group[0].layer]
    marked = [group for group in plain or full if any(word in MAIN for word in group[0].words)]
    if len(marked) == 1:
        return marked[0]
    # the first part is what a reader that knows nothing of parts shows
    if plain or len(full) == 1:
        return (plain or full)[0]
    if full:
        raise UserError(f"several layers have R, G and B ({_paths(full)}). Name one with --layer.")
    missing = _missing(entry for entry in channels if not entry.layer)
    have = {entry.last for entry in channels if not entry.layer}
    kind = ": luminance and chroma" if {"Y", "RY"} <= have else ": luminance without colour" if "Y" in have else ""
    names = _listed((entry.full for entry in channels), " ")
    raise UserError(f"no channel {missing} (it has {names}{kind}). Save it as R G B.")


def _missing(group: Iterable[Channel]) -> str:
    have = {entry.last for entry in group}
    return ", ".join(name for name in "RGB" if name not in have)


def _named(groups: list[list[Channel]], full: list[list[Channel]], wanted: str) -> list[Channel]:
    """The layer that --layer names: by the file's own name, or with the part's before it."""
    exact = [group for group in groups if group[0].path == wanted]
    found = exact or [group for group in groups if group[0].layer == wanted]
    if len(found) == 1 and found[0] in full:
        return found[0]
    shown = printable(wanted)
    if len(found) > 1:
        raise UserError(f"several layers are called {shown!r} ({_paths(found)}). Give --layer one of them.")
    if found:
        raise UserError(f"layer {shown!r} has no channel {_missing(found[0])}. Give --layer one with R G B.")
    listed = _paths([group for group in full if group[0].path])
    raise UserError(f"no layer {shown!r} (with R G B it has {listed}). Give --layer one of them.")


def _depth(parts: list[Part], channels: list[Channel], colour: Channel, wanted: str) -> Channel:
    """The depth channel that is closest to the colour's layer."""
    tier = next((tier for tier in _tiers(channels, colour, wanted) if tier), None)
    if tier is None:
        names = _listed((entry.full for entry in channels), " ")
        raise UserError(f"no depth channel {wanted!r} (it has {names}). Name one with --depth-channel, or give --coc.")
    differs = f"depth channel {printable(tier[0].full)!r} differs in size from the colour"
    fitting = [entry for entry in tier if parts[entry.part] == parts[colour.part]]
    if not fitting:
        raise UserError(
            f"{differs} ({parts[tier[0].part].data}, not {parts[colour.part].data}). Save both at one size."
        )
    if len(fitting) > 1:
        listed = _listed((entry.full for entry in fitting), ", ")
        raise UserError(f"several depth channels ({listed}). Name one with --depth-channel.")
    if fitting[0].sampled != (1, 1):
        raise UserError(f"{differs}. Save both at one size.")
    _not_whole(fitting[0], "depth channel", "whose unit the file does not say. Save it as float, in metres.")
    return fitting[0]


def _tiers(channels: list[Channel], colour: Channel, wanted: str) -> Iterator[list[Channel]]:
    """Candidates, the closest first."""
    lasts = {wanted, BLENDER_VALUE} if wanted == DEFAULT_DEPTH else {wanted}
    # a Z beside X and Y is a direction or a place
    with_x, with_y = ({(e.part, e.layer) for e in channels if e.last == name} for name in "XY")
    scalars = [e for e in channels if "." in wanted or (e.part, e.layer) not in with_x & with_y]
    words = colour.words or [""]
    beside = [[*words[:k], "depth", *words[k + 1 :]] for k in range(len(words))]
    yield [e for e in channels if (e.part, e.layer, e.last) == (colour.part, colour.layer, wanted)]
    yield [e for e in scalars if e.last in lasts and e.words in beside]
    yield [e for e in scalars if e.part == colour.part and e.name == wanted]
    yield [e for e in scalars if wanted in (e.name, e.full)]
    yield [e for e in scalars if e.last in lasts and any(word in DEPTH for word in e.words)]


def _not_whole(entry: Channel, what: str, advice: str) -> None:
    if entry.kind == "uint":
        raise UserError(f"{what} {printable(entry.full)!r} holds whole numbers (uint), {advice}")


def _paths(groups: list[list[Channel]]) -> str:
    return _listed((group[0].path for group in groups), ", ")


def _listed(names: Iterable[str], between: str) -> str:
    """Names in a message: printable, and not a page of them."""
    shown = [printable(name) for name in dict.fromkeys(names)]
    more = f"{between}and {len(shown) - MAX_LISTED} more" if len(shown) > MAX_LISTED else ""
    return (between.join(shown[:MAX_LISTED]) or "none") + more
