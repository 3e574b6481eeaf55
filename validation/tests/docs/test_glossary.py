"""Check that a page links a term of the glossary where it uses the term for the first time."""

import re

import pytest

from bokeh_validation import paths

GLOSSARY = paths.ROOT / "docs/glossary.md"
# Words that need no link: those of every graphics programmer, those that pages use in a plain sense too, and names of
# methods, which link to their pages
PLAIN = set("bokeh focus near far highlight light squeeze jitter target fetch preset truth".split())
PLAIN |= {"tile", "ring", "hole", "probe", "`layered`", "`exact`", "`paper`", "`naive`"}
# Another name of a term
SYNONYMS = {"CoC": r"circles?\s+of\s+confusion"}
# The npm package's page is read outside of the repository too
PAGES = [
    paths.ROOT / "README.md",
    *sorted(path for path in (paths.ROOT / "docs").glob("*.md") if path != GLOSSARY),
    *sorted((paths.ROOT / "docs/methods").glob("*.md")),
    paths.ROOT / "integration/README.md",
    *sorted(path for path in (paths.ROOT / "integration").glob("*/README.md") if path.parent.name != "web"),
]
# What is no prose: blocks of code, tables, headings, comments, images, code in a line, and the targets of links
NO_PROSE = (
    r"^ *```.*?^ *```|^ *\|.*?$|^#.*?$|<!--.*?-->|!\[[^]]*\]\([^)]*\)|`[^`]*`|(?<=\])\([^)]*\)"
    # a caption
    r"|(?<=\n\n)\*[^*\s](?:.(?!\n\n))*\*$",
    re.MULTILINE | re.DOTALL,
)


def terms() -> list[str]:
    """Return the glossary's terms that need a link, the longest first."""
    bold = re.findall(r"^\* (\*\*.*?\*\*): ", GLOSSARY.read_text(encoding="utf-8"), re.MULTILINE)
    found = {term for group in bold for part in re.findall(r"\*\*(.*?)\*\*", group) for term in part.split(", ")}
    return sorted(found - PLAIN, key=len, reverse=True)


def first_uses(text: str) -> dict[str, tuple[int, int, bool]]:
    """Return term -> (start and end of its first use in a page, whether that is in a link); a longer term hides a
    shorter one in it.
    """
    hidden = re.sub(*NO_PROSE[:1], lambda match: re.sub(r"[^\n]", " ", match[0]), text, flags=NO_PROSE[1])
    links = [match.span() for match in re.finditer(r"\[[^]]*\]", hidden)]
    uses = {}
    for term in terms():
        words = r"\s+".join(map(re.escape, term.split()))
        if term[0].islower():
            words = f"[{term[0]}{term[0].upper()}]{words[1:]}"
        pattern = rf"(?<![\w-])(?:{words}|{SYNONYMS.get(term, words)})s?(?![\w-])"
        for match in re.finditer(pattern, hidden):
            start, end = match.span()
            uses.setdefault(term, (start, end, any(a < start and end < b for a, b in links)))
        hidden = re.sub(pattern, lambda match: " " * len(match[0]), hidden)
    return uses


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(paths.ROOT)))
def test_first_use_is_a_link(page):
    """Check a page; an own definition of the term on the page is no link either, so that one place defines it."""
    text = page.read_text(encoding="utf-8")
    unlinked = {
        term: text.count("\n", 0, start) + 1 for term, (start, _, linked) in first_uses(text).items() if not linked
    }
    assert not unlinked, f"term -> line: {unlinked}"


def test_what_counts_as_a_use():
    """Check that code, tables and longer terms are no uses, and that a link is recognised across lines."""
    text = "# CoC\n\n`CoC`, a [CoC\nmap](glossary.md#blur) and strips.\n\n| CoC |\n"
    found = first_uses(text)
    assert set(found) == {"CoC map", "strip"} and found["CoC map"][2] and not found["strip"][2]
