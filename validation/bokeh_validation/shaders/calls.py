"""Find the code that a program runs: the functions that its entry calls, without branches that its
constants disable.
"""

import re
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import NamedTuple

from bokeh_validation import shaders
from bokeh_validation.shaders.entries import ENTRIES

_MAIN = {shaders.glsl_pass(name): f"{name}_PS" for name in ENTRIES} | {"BOKEH_FULL_SCREEN": "BokehFullScreen_VS"}


def found_functions(text: str) -> Iterator[tuple[str, re.Match]]:
    """Yield every function of a text with its name; GLSL's main() has the name of the entry in HLSL,
    with _PS or _VS.
    """
    for match in shaders.FUNCTION.finditer(text):
        name = match["name"]
        if name == "main":
            branch = re.findall(r"BOKEH_PASS == (\w+)", text[: match.start()])[-1]
            # an older text may have entries that no longer exist
            name = _MAIN.get(branch, branch)
        yield name, match


@lru_cache(maxsize=16)
def functions(text: str) -> Mapping[str, str]:
    """Return name -> code without comments. Two HLSL functions of one name, in branches of an #if, are joined."""
    code: dict[str, str] = {}
    for name, match in found_functions(text):
        code[name] = code.get(name, "") + _code(match["head"] + "\n" + match["body"])
    return code


@lru_cache(maxsize=16)
def _outside(text: str) -> tuple[tuple[str, frozenset[str]], ...]:
    """Return the lines of code outside functions, each with the package's names in it."""
    return tuple((line, _words(line)) for line in _code(shaders.FUNCTION.sub("", text)).splitlines())


@lru_cache(maxsize=4096)
def _words(code: str) -> frozenset[str]:
    return frozenset(re.findall(r"\b(?:Bokeh|BOKEH_|bokeh)\w+", code))


def declared(text: str, code: Mapping[str, str]) -> frozenset[str]:
    """Return the lines outside functions that declare what these functions use, directly or through the value of
    another name, and those without a name of the package.
    """
    names_used, before = set().union(*map(_words, code.values())), set()
    while names_used != before:
        before = set(names_used)
        for line, words in _outside(text):
            if "=" in line or line.startswith("#define"):
                names_used |= words if words & before else set()
    return frozenset(line for line, words in _outside(text) if not words or words & names_used)


def _code(text: str) -> str:
    lines = (line.rstrip() for line in shaders.COMMENT.sub("", text).splitlines())
    return "".join(f"{line}\n" for line in lines if line)


@lru_cache(maxsize=4096)
def _live(code: str, constants: frozenset[tuple[str, float]]) -> str:
    """Return code without the branches that these constants disable."""
    for name, value in constants:
        for bound in re.findall(rf"if \({name} > (\d(?:\.0)?)\)$", code, re.MULTILINE):
            if value <= float(bound):
                branch = rf"^( *)if \({name} > {bound}\)\n\1\{{\n(?:.*\n)*?\1\}}\n"
                code = re.sub(branch, "", code, flags=re.MULTILINE)
    return code


@lru_cache(maxsize=4096)
def _called(code: str) -> tuple[str, ...]:
    return tuple(re.findall(r"\b[Bb]okeh\w+(?=\()", code))


@lru_cache(maxsize=1024)
def program(text: str, entry: str, constants: frozenset[tuple[str, float]] = frozenset()) -> Mapping[str, str]:
    """Return name -> code of a function and of everything that it calls.

    entry      its name, or the code of a main function
    constants  (name, value) pairs that the program is compiled with
    """
    code, reached, waiting = functions(text), {}, [entry]
    while waiting:
        name = waiting.pop()
        if name not in reached and (name in code or name == entry):
            reached[name] = _live(code.get(name, name), constants)
            waiting += _called(reached[name])
    return reached


class Signature(NamedTuple):
    """Hold the return type of a GLSL function, and type and name of each parameter."""

    kind: str
    parameters: tuple[tuple[str, str], ...]


@lru_cache(maxsize=16)
def signatures(text: str) -> Mapping[str, Signature]:
    """Return name -> signature of every function of a GLSL text; main() is listed under its entry's name."""
    by_name = {}
    for name, match in found_functions(text):
        kind, _, parameters = _code(match["head"]).strip().removesuffix(")").partition("(")
        pairs = (tuple(parameter.split()) for parameter in parameters.split(",") if parameter.strip())
        by_name[name] = Signature(kind.split()[0], tuple(pairs))
    return by_name


@lru_cache(maxsize=16)
def structs(text: str) -> Mapping[str, tuple[tuple[str, str], ...]]:
    """Return name -> (type, name) of each member of every struct of a GLSL text."""
    definitions = re.findall(r"^struct (\w+)\n\{\n(.*?)^\};$", _code(text), re.MULTILINE | re.DOTALL)
    return {name: tuple(re.findall(r"^ +(\w+) (\w+);$", members, re.MULTILINE)) for name, members in definitions}


def called_from(text: str, entry: str) -> tuple[str, ...]:
    """Return the functions that an entry calls, directly or through functions of its own file `text`, outside that
    file.
    """
    own_functions = program(text, f"{entry}_PS")
    return tuple(
        dict.fromkeys(name for code in own_functions.values() for name in _called(code) if name not in own_functions)
    )
