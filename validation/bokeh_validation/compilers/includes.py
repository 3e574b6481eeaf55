"""#include lines replaced by the files they name, for compilers that are handed one text."""

import re
from collections.abc import Callable
from pathlib import Path

_LINE = re.compile(r'^[ \t]*#[ \t]*(?:include[ \t]+"(?P<name>[^"]+)"|pragma[ \t]+once)[^\n]*$', re.MULTILINE)


def inlined(text: str, find: Callable[[str], Path]) -> str:
    """A shader's text with all that it includes, each file once; conditions around an #include are not looked at.

    find  path of the file that a name in an #include stands for; may raise
    """
    return _inlined(text, find, set())


def _inlined(text: str, find: Callable[[str], Path], seen: set[Path]) -> str:
    def replacement(match: re.Match) -> str:
        path = find(match["name"]) if match["name"] else None
        if path is None or path in seen:
            return ""
        seen.add(path)
        return _inlined(path.read_text(encoding="ascii"), find, seen)

    return _LINE.sub(replacement, text)
