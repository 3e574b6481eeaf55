"""The checks of guides.py themselves, on guides made for it."""

import guides
import pytest

README = """# Engine

## Inputs

```sh
## not a heading
```

## Code

```python
if found:
    use(found)
```
"""


@pytest.fixture
def readme(tmp_path):
    """A guide with one command and one block of code."""
    path = tmp_path / "README.md"
    path.write_text(README, encoding="utf-8")
    return path


def test_blocks(readme):
    """Language, text and line."""
    assert [(block.language, block.line) for block in guides.blocks(readme)] == [("sh", 6), ("python", 12)]
    assert guides.blocks(readme)[1].text == "if found:\n    use(found)"


@pytest.mark.parametrize(
    ("text", "quoted"),
    [
        ("if found:\n    use(found)\n", True),
        ("def f():\n    if found:\n        use(found)\n    return\n", True),
        ("if found:\n    use(found, 1)\n", False),
        ("if found:\n    log()\n    use(found)\n", False),
        ("if found:\nuse(found)\n", False),
    ],
)
def test_quoted(readme, tmp_path, text, quoted):
    """A block must be in the file as it is, at any indentation; commands need not."""
    source = tmp_path / "sample.py"
    source.write_text(text, encoding="utf-8")
    if quoted:
        guides.assert_quoted(readme, [source])
    else:
        with pytest.raises(AssertionError, match="README.md:12"):
            guides.assert_quoted(readme, [source])


def test_unclosed_block(readme):
    """Such a block would be no block, and would not be checked."""
    readme.write_text(README + "\n```python\nuse()\n", encoding="utf-8")
    with pytest.raises(AssertionError, match="not closed"):
        guides.blocks(readme)


def test_headings(readme):
    """All of them, in order, and a comment in a command is none."""
    with pytest.raises(AssertionError):
        guides.assert_headings(readme)
    readme.write_text("".join(f"## {name}\n\n```sh\n## no\n```\n" for name in guides.HEADINGS), encoding="utf-8")
    guides.assert_headings(readme)


def test_section(readme):
    """Up to the next heading of the same level."""
    assert "not a heading" in guides.section(readme, "Inputs") and "use" not in guides.section(readme, "Inputs")
    assert len(guides.blocks(guides.section(readme, "Engine"))) == 2


def test_code_lines():
    """No empty lines, comments or docstrings; strings that are no docstrings count."""
    text = '"""Docstring\n\nof two."""\n\n# comment\nx = """a\nb\n"""\n\ndef f():\n    """Doc."""\n    return x\n'
    assert guides.code_lines(text, "#") == ['x = """a', "b", '"""', "def f():", "return x"]
    assert guides.code_lines("// no\n\nlet x;\n") == ["let x;"]
