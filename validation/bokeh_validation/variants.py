"""The rows of variants.toml: which shader programs there are, and which compilers each goes through."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from bokeh_validation import entries, paths, shaders
from bokeh_validation.errors import UserError

VERTEX = "BokehFullScreen"
ENTRIES = (VERTEX, *entries.ENTRIES)

PAPER_SAMPLES = 13  # on a line, section 4.3

# Compilers that can take a language at a profile, in the order in which they are shown.
COMPILERS: dict[tuple[str, str], tuple[str, ...]] = {
    ("glsl", "330"): ("glslang", "spirv-val", "mesa"),
    ("glsl", "300es"): ("glslang", "mesa", "angle"),
    ("glsl", "450"): ("glslang", "glslc", "spirv-val", "essl300", "essl310", "msl", "hlsl50", "mesa"),
    ("hlsl", "sm3"): ("fxc", "mojoshader"),
    ("hlsl", "sm4"): ("fxc",),
    ("hlsl", "sm5"): ("fxc", "glslang", "spirv-val", "essl300", "essl310", "msl"),
    ("hlsl", "sm6"): ("dxc-spirv", "dxc-dxil", "spirv-val", "essl300", "essl310", "msl", "naga"),
    ("wgsl", "wgsl"): ("naga", "tint"),
}
COLUMNS = (
    "fxc",
    "mojoshader",
    "glslang",
    "glslc",
    "dxc-spirv",
    "dxc-dxil",
    "spirv-val",
    "essl300",
    "essl310",
    "msl",
    "hlsl50",
    "mesa",
    "angle",
    "naga",
    "tint",
)


@dataclass(frozen=True)
class Variant:
    """One row of the matrix.

    id         of the [[variant]] it comes from
    language   'hlsl', 'glsl' or 'wgsl'
    profile    second half of a key of COMPILERS
    entry      one of ENTRIES
    samples    BOKEH_NUM_SAMPLES, or None for the default of the shader file
    compilers  those it goes through, a part of COLUMNS
    values     other configuration values of section [1], as they are written in the file
    """

    id: str
    language: str
    profile: str
    entry: str
    samples: int | None
    compilers: tuple[str, ...]
    values: tuple[tuple[str, float], ...] = ()

    @property
    def name(self) -> str:
        """Unique in the matrix and readable, such as 'glsl-330 BokehNaiveGather 127'."""
        return " ".join(filter(None, (self.id, self.entry, str(self.samples or ""))))

    @property
    def stage(self) -> str:
        """'vert' or 'frag'."""
        return "vert" if self.entry == VERTEX else "frag"

    @property
    def targets(self) -> int:
        """How many render targets it writes; of a vertex shader, what it is linked with does."""
        return entries.ENTRIES[self.entry].targets if self.entry in entries.ENTRIES else 1

    @property
    def function(self) -> str:
        """Name of the entry point in HLSL and WGSL."""
        return self.entry + ("_VS" if self.entry == VERTEX else "_PS")


def source(variant: Variant) -> str:
    """The complete program of a variant. In WGSL its configuration is not in the text: see constants()."""
    values = _configuration(variant)
    if variant.language == "glsl":
        return shaders.glsl(variant.entry, variant.profile, values)
    if variant.language == "hlsl":
        return shaders.hlsl(int(variant.profile.removeprefix("sm")), values)
    return shaders.wgsl()


def constants(variant: Variant) -> dict[str, float]:
    """Pipeline constants of a WGSL variant."""
    return {name: float(value) for name, value in _configuration(variant).items()}


def _configuration(variant: Variant) -> dict[str, int | float]:
    """What is not left at the default of the shader file."""
    count = {} if variant.samples is None else {"BOKEH_NUM_SAMPLES": variant.samples}
    return count | dict(variant.values)


def load(path: Path = paths.VARIANTS, quick: bool = False) -> list[Variant]:
    """All rows of a file in its order; `quick`: one sample count for each entry, the paper's where the file has it.

    Raises UserError, in one line, for whatever is wrong in the file.
    """
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise UserError(f"{path}: {error.strerror}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UserError(f"{path}: not TOML: {error}") from error
    try:
        rows = _expand(data)
    except _Wrong as error:
        raise UserError(f"{path.name}: {error}") from error
    return _one_sample_count(rows) if quick else rows


def _one_sample_count(rows: list[Variant]) -> list[Variant]:
    kept: dict[tuple[str, str], Variant] = {}
    for row in rows:
        if row.samples == PAPER_SAMPLES or (row.id, row.entry) not in kept:
            kept[row.id, row.entry] = row
    return list(kept.values())


class _Wrong(Exception):
    """What is wrong in the file, without its name."""


def _expand(data: Mapping) -> list[Variant]:
    _keys("the file", data, {"sets", "variant"}, {"sets", "variant"})
    if not isinstance(data["sets"], dict) or not _list_of(data["variant"], dict):
        raise _Wrong("'sets' must be tables [sets.NAME], 'variant' tables [[variant]]")
    sets = {name: _set(f"[sets.{name}]", table) for name, table in data["sets"].items()}
    rows, seen = [], set()
    for index, table in enumerate(data["variant"]):
        expanded = _variant(f"[[variant]] {table.get('id', index + 1)}", table, sets)
        if expanded[0].id in seen:
            raise _Wrong(f"two variants have the id {expanded[0].id!r}")
        seen.add(expanded[0].id)
        names = [row.name for row in expanded]
        twice = {name for name in names if names.count(name) > 1}
        if twice:
            raise _Wrong(f"[[variant]] {expanded[0].id}: more than once: {', '.join(sorted(twice))}")
        rows += expanded
    return rows


def _set(where: str, table: object) -> list[tuple[str, int | None]]:
    """(entry, samples) of a [sets.NAME] table."""
    if not isinstance(table, dict):
        raise _Wrong(f"{where} must be a table with 'entries'")
    _keys(where, table, {"entries", "samples"}, {"entries"})
    entries = _names(where, "entries", table, ENTRIES)
    samples = table.get("samples", [None])
    if not samples or ("samples" in table and not (_list_of(samples, int) and all(count >= 2 for count in samples))):
        raise _Wrong(f"{where}: samples must be a list of whole numbers from 2 up, not {samples!r}")
    return [(entry, count) for entry in entries for count in samples]


def _variant(where: str, table: Mapping, sets: Mapping[str, list]) -> list[Variant]:
    """All rows of a [[variant]] table."""
    keys = {"id", "language", "profile", "sets", "compilers"}
    _keys(where, table, keys | {"values"}, keys)
    values = table.get("values", {})
    if not isinstance(values, dict) or not all(type(value) is int for value in values.values()):
        raise _Wrong(f"{where}: values must be a table of whole numbers, not {values!r}")
    for key in ("id", "language", "profile"):
        if not isinstance(table[key], str) or not table[key]:
            raise _Wrong(f"{where}: {key} must be a text, not {table[key]!r}")
    language, profile = table["language"], table["profile"]
    _one_of(where, "language", language, dict.fromkeys(language for language, _ in COMPILERS))
    _one_of(where, "profile", profile, [known for owner, known in COMPILERS if owner == language])
    compilers = _names(where, "compilers", table, COMPILERS[language, profile])
    chosen = _names(where, "sets", table, sets)
    return [
        Variant(table["id"], language, profile, entry, samples, tuple(compilers), tuple(values.items()))
        for name in chosen
        for entry, samples in sets[name]
    ]


def _keys(where: str, table: Mapping, allowed: set[str], needed: set[str]) -> None:
    for key in table:
        _one_of(where, "key", key, sorted(allowed))
    for key in sorted(needed - set(table)):
        raise _Wrong(f"{where}: no {key!r}")


def _names(where: str, key: str, table: Mapping, known) -> list[str]:
    """A list of names that are all known, and not empty."""
    names = table[key]
    if not names or not _list_of(names, str):
        raise _Wrong(f"{where}: {key} must be a list of names, not {names!r}")
    for name in names:
        _one_of(where, key, name, known)
    return names


def _one_of(where: str, what: str, value: str, known) -> None:
    if value not in known:
        raise _Wrong(f"{where}: unknown {what} {value!r}; one of: {', '.join(known)}")


def _list_of(value: object, kind: type) -> bool:
    """Whether it is a list of that type; a bool is not an int."""
    return isinstance(value, list) and all(type(item) is kind for item in value)
