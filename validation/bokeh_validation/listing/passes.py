"""The three `bokeh_passes.*`: the same entry points and the same parameters, those that the harness knows."""

import re
from collections.abc import Iterator, Mapping, Sequence

from bokeh_validation import shaders
from bokeh_validation.listing import normal, rules
from bokeh_validation.listing.difference import Difference, first_unequal
from bokeh_validation.listing.syntax import Item, items, matching, tokenize
from bokeh_validation.passes import PARAMETERS

# The one function of the passes files that is not an entry point; a language that lacks it does not compile
HELPER = "BokehUseViewport"


def check(texts: Mapping[str, str]) -> Iterator[Difference]:
    """Differences between the passes files, given as language -> text."""
    yield from _entries(texts)
    yield from _parameters(texts)


def _entries(texts: Mapping[str, str]) -> Iterator[Difference]:
    """Entry points: those of shaders.ENTRIES behind the full-screen vertex shader, in this order in each language."""
    expected = ["BokehFullScreen", *shaders.ENTRIES]
    for language, passes_text in texts.items():
        top = _without_helpers(items(tokenize(passes_text)), language)
        found = _glsl_entries(top) if language == "glsl" else _named_entries(top, language)
        if found != expected:
            text = {language: " ".join(found), "harness": " ".join(expected)}
            yield Difference(f"{language} passes", "entry points", text)
    top = items(tokenize(texts["glsl"]))
    numbers = [_defined(item) for item in top]
    table = [pair for pair in numbers if pair and pair[1].isdigit()]
    wanted = [(shaders.glsl_pass(entry), str(i)) for i, entry in enumerate((*shaders.ENTRIES, "BokehFullScreen"), 1)]
    if table != wanted:
        text = {"glsl": " ".join(map("=".join, table)), "harness": " ".join(map("=".join, wanted))}
        yield Difference("glsl passes", "values of BOKEH_PASS", text)


def _without_helpers(top: Sequence[Item], language: str) -> list[Item]:
    """All but the functions that the entries call."""
    return [
        item for item in top if item.kind != "function" or [n.text for n in rules.declared(item, language)] != [HELPER]
    ]


def _defined(item: Item) -> tuple[str, str] | None:
    found = re.fullmatch(r"#define (\w+) (\S+)", " ".join(item.tokens[0].text.split()))
    return (found[1], found[2]) if found and item.kind == "directive" else None


def _named_entries(top: Sequence[Item], language: str) -> list[str]:
    """HLSL and WGSL: functions with _VS or _PS behind their name; one name in two branches of an #if is one."""
    names = [name.text for item in top if item.kind == "function" for name in rules.declared(item, language)]
    return list(dict.fromkeys(re.sub(r"_[VP]S$", "", name) for name in names))


def _glsl_entries(top: Sequence[Item]) -> list[str]:
    """GLSL: the branches of BOKEH_PASS that hold a main()."""
    by_name = {shaders.glsl_pass(entry): entry for entry in ("BokehFullScreen", *shaders.ENTRIES)}
    branch, found = "(no branch)", []
    for item in top:
        chosen = re.fullmatch(r"#(?:el)?if BOKEH_PASS == (\w+)", " ".join(item.tokens[0].text.split()))
        if chosen:
            branch = by_name.get(chosen[1], chosen[1])
        elif item.kind == "function":
            names = [name.text for name in rules.declared(item, "glsl")]
            found += [branch] if names == ["main"] else names
    return found


def _parameters(texts: Mapping[str, str]) -> Iterator[Difference]:
    """Parameters: names, type and order of passes.PARAMETERS, which is the layout."""
    expected = [f"{index} float {name}" for index, name in enumerate(PARAMETERS)]
    for language, text in texts.items():
        top = items(tokenize(text))
        found = _wgsl_members(top) if language == "wgsl" else _macro_members(top)
        shown = [f"{index or number} {kind} {name}" for number, (index, kind, name) in enumerate(found)]
        yield from first_unequal(f"{language} passes", "parameters", {language: shown, "harness": expected})


# (index as written, or nothing where the language has none; type; name)
Member = tuple[str, str, str]


def _macro_members(top: Sequence[Item]) -> list[Member]:
    """HLSL and GLSL: BOKEH_PARAMETER(type, name, index), in or out of a block; GLSL has no index."""
    found: list[Member] = []
    for item in top:
        if item.kind == "block":
            found += _macro_members(rules.block_items(item))
        texts = [token.text for token in item.code]
        if item.kind == "call" and texts[0] == "BOKEH_PARAMETER":
            kind, name, index, *_ = [*texts[2:-1:2], "", "", ""]
            found.append((index, kind, name))
    return found


def _wgsl_members(top: Sequence[Item]) -> list[Member]:
    """WGSL: the members of struct BokehParameters."""
    found: list[Member] = []
    for item in top:
        code = item.code
        if item.kind == "block" and code[1].text == "BokehParameters" and code[2].text == "{":
            for member in normal.split(code[3 : matching(code, 2)]):
                kind = " ".join(text for _, text in normal.common(member[2:], "wgsl", ()))
                found.append(("", kind, member[0].text if member else ""))
    return found
