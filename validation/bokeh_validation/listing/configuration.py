"""Section [1]: the same names, order and values in each language, and a table that tells the truth."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest

from bokeh_validation.listing.difference import Difference, first_unequal
from bokeh_validation.listing.syntax import Item

WHERE = "[1] configuration"


@dataclass(frozen=True)
class Setting:
    """A configuration value; `reason` of a deviation."""

    name: str
    value: str
    line: int
    reason: str | None = None


def check(found: Mapping[str, Sequence[Item]], comments: Mapping[str, Sequence[str]]) -> Iterator[Difference]:
    """Differences in language -> items of the section, and language -> its comment lines."""
    settings: dict[str, list[Setting]] = {}
    rest: dict[str, list[str]] = {}
    for language, items in found.items():
        read = _wgsl_settings if language == "wgsl" else _c_settings
        settings[language], rest[language] = read(items)
    yield from _names(settings)
    yield from _values(settings)
    for language, lines in comments.items():
        yield from _table(language, lines, settings[language])
    # What is neither a value nor a comment: the tests for wrong values, which WGSL has no means for.
    yield from first_unequal(WHERE, "checks of the values", {key: rest[key] for key in ("hlsl", "glsl")})
    for line in rest["wgsl"]:
        yield Difference(WHERE, "neither a const nor an override with type and value", {"wgsl": line})


def _names(settings: Mapping[str, Sequence[Setting]]) -> Iterator[Difference]:
    names = {language: [setting.name for setting in found] for language, found in settings.items()}
    yield from first_unequal(WHERE, "names or their order", names)
    for language, found in names.items():
        for name in sorted({name for name in found if found.count(name) > 1}):
            yield Difference(WHERE, f"{name} is there more than once", {language: name})


def _values(settings: Mapping[str, Sequence[Setting]]) -> Iterator[Difference]:
    by_name: dict[str, dict[str, Setting]] = {}
    for language, found in settings.items():
        for setting in found:
            by_name.setdefault(setting.name, {})[language] = setting
    for name, values in by_name.items():
        if len({setting.value for setting in values.values() if setting.reason is None}) > 1:
            text = {language: f"line {setting.line}: {setting.value}" for language, setting in values.items()}
            yield Difference(WHERE, f"value of {name}", text)


def _table(language: str, lines: Sequence[str], settings: Sequence[Setting]) -> Iterator[Difference]:
    """The comment table against the code. Its rows are the same in every language, so a marked value is not in it."""
    rows = [row for line in lines if (row := re.match(r"//\s+(BOKEH_\w+)\s+(\S+)", line))]
    defined = {setting.name: setting for setting in settings}
    table = [f"{row[1]} {row[2]}" for row in rows if row[1] not in defined or defined[row[1]].reason is None]
    code = [f"{setting.name} {setting.value}" for setting in settings if setting.reason is None]
    for told, is_so in zip_longest(table, code, fillvalue="(nothing)"):
        if told != is_so:
            yield Difference(WHERE, "the table does not say what the code does", {language: f"{told} / {is_so}"})
            return


def _c_settings(found: Sequence[Item]) -> tuple[list[Setting], list[str]]:
    """`#ifndef name`, `#define name value`, `#endif` as one setting each; and everything else."""
    settings, rest = [], []
    index = 0
    while index < len(found):
        three = [" ".join(item.tokens[0].text.split()) for item in found[index : index + 3]]
        guard = re.fullmatch(r"#ifndef (\w+)", three[0])
        value = re.fullmatch(r"#define (\w+) (.+)", three[1]) if len(three) == 3 else None
        if guard and value and guard[1] == value[1] and three[2] == "#endif":
            settings.append(Setting(guard[1], value[2], found[index + 1].line, found[index + 1].reason))
            index += 3
        else:
            rest.append(" ".join(" ".join(token.text for token in found[index].tokens).split()))
            index += 1
    return settings, rest


def _wgsl_settings(found: Sequence[Item]) -> tuple[list[Setting], list[str]]:
    """`const name: type = value;` and `override ...` as one setting each; and everything else."""
    settings, rest = [], []
    for item in found:
        texts = [token.text for token in item.code]
        declared = len(texts) >= 7 and texts[0] in ("const", "override") and (texts[2], texts[4]) == (":", "=")
        value = " ".join(texts[5:-1]) if declared else ""
        if declared and texts[3] == ("i32" if re.fullmatch(r"(- )?\d+", value) else "f32"):
            settings.append(Setting(texts[1], value, item.line, item.reason))
        else:
            rest.append(f"line {item.line}: {' '.join(texts)}")
    return settings, rest
