"""Describe a frame for Godot's CompositorEffect: the variants of one shader, and the passes that use them."""

import re
from functools import cache
from typing import NamedTuple

from bokeh_validation.generate import samples

METHODS = ("layered", "exact")
# Textures of the engine: the two that the CoC map reads; the last pass writes the first one
COLOR, DEPTH = "color", "depth"
MAP = "map"


class Version(NamedTuple):
    """Describe a program. It reads `slot_0` and so on, for the numbers in `slots`; `returned` as in samples.Row."""

    name: str
    slots: tuple[int, ...]
    call: str
    returned: tuple[str, ...]


class Step(NamedTuple):
    """Describe a pass: program, divisor of its targets' size, textures by slot ('-': none), targets."""

    version: str
    scale: int
    reads: tuple[str, ...]
    writes: tuple[str, ...]


@cache
def _numbered() -> dict[tuple[str, tuple[str, ...]], Version]:
    """Return (call, returned) -> variant, for all passes after the CoC map; equal calls share a program."""
    versions_by_key: dict[tuple[str, tuple[str, ...]], Version] = {}
    for method in METHODS:
        for aperture in samples.polygons(method):
            for row in samples.after_map(method, aperture, memory="texture_"):
                key = (_slotted(row), row.returned)
                if key not in versions_by_key:
                    function = re.match(r"Bokeh(\w+)\(", row.call)[1]
                    name = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", function).lower()
                    count = sum(re.sub(r"_\d+$", "", version.name) == name for version in versions_by_key.values())
                    slots = tuple(i for i, texture in enumerate(row.reads) if texture != "-")
                    versions_by_key[key] = Version(name + (f"_{count + 1}" if count else ""), slots, *key)
    return versions_by_key


def versions() -> list[Version]:
    """Return every program after the CoC map's, without duplicates."""
    return list(_numbered().values())


def frame(method: str, aperture: str) -> list[Step]:
    """Return the passes of a method, the CoC map first."""
    first, *rows = samples.frame(method, aperture, memory="texture_")
    steps = [Step(MAP, first.scale, (COLOR, DEPTH), first.writes)]
    steps += [Step(_numbered()[_slotted(row), row.returned].name, row.scale, row.reads, row.writes) for row in rows]
    steps[-1] = steps[-1]._replace(writes=(COLOR,))
    return steps


def _slotted(row: samples.Row) -> str:
    """Return the call of a pass with slot_0, slot_1 and so on instead of its textures' names."""
    call = row.call
    for i, texture in enumerate(row.reads):
        call = re.sub(rf"(?<!\.)\b{texture}\b", f"slot_{i}", call) if texture != "-" else call
    return call
