"""Functions of the three languages in one common form: what is left is what a reader of three columns would compare.

Only porting is taken away: names of types, the way a texture travels with its sampler, the way a variable is declared.
Names, literals, operators and order stay as they are written.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from bokeh_validation.listing.syntax import Item, Token, marked_reason, matching

SCALARS = ("float", "int", "uint", "bool")
SIZES = ("2", "3", "4")


def _types(scalars: Sequence[str], vectors: Sequence[str], matrix: str) -> dict[str, str]:
    """Type words of a language -> the common name (HLSL's); `vectors` are written with a * for the size."""
    words = dict(zip(scalars, SCALARS, strict=True))
    words[matrix] = "float4x4"
    for vector, scalar in zip(vectors, SCALARS, strict=False):
        words.update({vector.replace("*", size): scalar + size for size in SIZES})
    return words


# Only the words that the language has itself: `vec4` in HLSL stays a stranger.
TYPES = {
    "hlsl": _types(SCALARS, ("float*", "int*", "uint*", "bool*"), "float4x4"),
    "glsl": _types(SCALARS, ("vec*", "ivec*", "uvec*", "bvec*"), "mat4"),
    "wgsl": _types(("f32", "i32", "u32", "bool"), ("vec*f", "vec*i", "vec*u"), "mat4x4f"),
}

MISPLACED = "a '// differs:' that stands on no statement"

# (kind, text): kinds are those of tokens, and 'type' and 'texture' for what was recognised as one.
Word = tuple[str, str]


@dataclass(frozen=True)
class Statement:
    """One statement, loop or branch head, closing brace, comment or directive of a function body.

    words   its common form
    source  as written, with the indentation of its first line
    reason  of a deviation
    """

    words: tuple[Word, ...]
    source: str
    line: int
    end_line: int
    reason: str | None = None


@dataclass(frozen=True)
class Parameter:
    """A parameter in common form: a texture and its sampler are one, of type 'texture'."""

    name: str
    type: str


@dataclass(frozen=True)
class Function:
    """A function in common form, and its text.

    doc        lines of the comment right above; the first is the tag line
    signature  as written, with the opening brace
    text       all of it as written, with the doc comment
    tokens     of the body, as written
    reason     of a deviation in the signature
    problems   (line, what) that keep it from being compared
    """

    name: str
    section: int
    line: int
    doc: tuple[str, ...]
    parameters: tuple[Parameter, ...]
    returns: str
    statements: tuple[Statement, ...]
    signature: str
    text: str
    tokens: tuple[Token, ...]
    reason: str | None = None
    problems: tuple[tuple[int, str], ...] = ()


def function(item: Item, language: str, section: int, text: str) -> Function | None:
    """A function item in common form; None where its head is not one of a function."""
    brace = _body_start(item.tokens)
    head = [token for token in item.tokens[:brace] if token.kind not in ("comment", "directive")]
    parts = _wgsl_head(head) if language == "wgsl" else _c_head(head)
    if parts is None:
        return None
    name, inner, returns = parts
    parameters = tuple(_parameters(inner, language))
    textures = {parameter.name for parameter in parameters if parameter.type == "texture"}
    body = item.tokens[brace + 1 : -1]
    statements, problems = _statements(body, language, textures, text)
    if item.reason is not None:
        problems.append((item.tokens[-1].line, MISPLACED))
    reasons = [reason for token in item.tokens[:brace] if (reason := marked_reason(token)) is not None]
    return Function(
        name=name.text,
        section=section,
        line=item.line,
        doc=tuple(token.text for token in item.doc),
        parameters=parameters,
        returns=_joined(common(returns, language, ())),
        statements=tuple(statements),
        signature=_source(text, item.tokens[0], item.tokens[brace]),
        text=_source(text, (*item.doc, *item.tokens)[0], item.tokens[-1]),
        tokens=tuple(body),
        reason=reasons[0] if reasons else None,
        problems=tuple(problems),
    )


def _body_start(tokens: Sequence[Token]) -> int:
    index = 0
    while tokens[index].text != "{":
        index = (matching(tokens, index) or index) + 1 if tokens[index].text in ("(", "[") else index + 1
    return index


def _c_head(head: Sequence[Token]) -> tuple[Token, Sequence[Token], Sequence[Token]] | None:
    """Name, tokens inside the parentheses, return type; `float4 Name(...) : SEMANTIC`."""
    opening = next((i for i, token in enumerate(head) if token.text == "("), None)
    end = matching(head, opening) if opening else None
    if not opening or end is None or head[opening - 1].kind != "name":
        return None
    return head[opening - 1], head[opening + 1 : end], head[: opening - 1]


def _wgsl_head(head: Sequence[Token]) -> tuple[Token, Sequence[Token], Sequence[Token]] | None:
    """Name, tokens inside the parentheses, return type; `@attribute fn Name(...) -> type`."""
    keyword = next((i for i, token in enumerate(head) if token.text == "fn"), None)
    if keyword is None or keyword + 2 >= len(head) or head[keyword + 2].text != "(":
        return None
    end = matching(head, keyword + 2)
    if end is None:
        return None
    arrow, returns = head[end + 1 : end + 2], head[end + 2 :]
    if arrow and arrow[0].text != "->":
        return None
    return head[keyword + 1], head[keyword + 3 : end], returns


def _parameters(tokens: Sequence[Token], language: str) -> list[Parameter]:
    pieces = split(tokens)
    if language == "wgsl":
        return _wgsl_parameters(pieces)
    found = []
    for piece in pieces:
        texts = [token.text for token in piece]
        if language == "hlsl" and len(texts) == 4 and texts[0] == "BOKEH_TEXTURE":
            found.append(Parameter(texts[2], "texture"))
        elif language == "glsl" and len(texts) == 2 and texts[0] == "sampler2D":
            found.append(Parameter(texts[1], "texture"))
        else:
            end = next((i for i, text in enumerate(texts) if text in (":", "=", "[")), len(texts))
            words = common([*piece[: end - 1], *piece[end:]], language, ())
            found.append(Parameter(texts[end - 1] if end else "", _joined(words)))
    return found


def _wgsl_parameters(pieces: Sequence[Sequence[Token]]) -> list[Parameter]:
    """Parameters; a texture directly followed by its sampler `<name>Sampler` is one."""
    single = []
    for piece in pieces:
        colon = next((i for i, token in enumerate(piece) if token.text == ":"), None)
        name = " ".join(token.text for token in piece[: colon or 0])
        single.append(Parameter(name, _joined(common(piece[(colon or 0) + 1 :], "wgsl", ()))))
    found: list[Parameter] = []
    for parameter in single:
        texture = found[-1] if found else None
        if (
            texture is not None
            and parameter == Parameter(texture.name + "Sampler", "sampler")
            and texture.type == "texture_2d < float >"
        ):
            found[-1] = Parameter(texture.name, "texture")
        else:
            found.append(parameter)
    return found


def split(tokens: Sequence[Token]) -> list[list[Token]]:
    """Parts between commas outside brackets; a trailing comma opens no part. `<` is a bracket: WGSL's templates."""
    parts: list[list[Token]] = [[]] if tokens else []
    depth = 0
    for token in tokens:
        if token.text == "," and depth == 0:
            parts.append([])
            continue
        depth += (token.text in ("(", "[", "{", "<")) - (token.text in (")", "]", "}", ">"))
        parts[-1].append(token)
    return parts[:-1] if parts and not parts[-1] else parts


def _statements(
    body: Sequence[Token], language: str, textures: Collection[str], text: str
) -> tuple[list[Statement], list[tuple[int, str]]]:
    found: list[Statement] = []
    problems: list[tuple[int, str]] = []
    current: list[Token] = []
    reason: str | None = None
    depth = 0

    def close() -> None:
        nonlocal reason
        words = common(current, language, textures)
        source = _source(text, current[0], current[-1])
        found.append(Statement(words, source, current[0].line, current[-1].end_line, reason))
        current.clear()
        reason = None

    for token in body:
        if token.kind == "comment":
            marked = marked_reason(token)
            if marked is None:
                found.append(_alone(token, text))
            elif current:
                reason = marked
            elif found and found[-1].end_line == token.line and found[-1].words != (("operator", "}"),):
                found[-1] = replace(found[-1], reason=marked)
            else:
                problems.append((token.line, MISPLACED))
            continue
        if token.kind == "directive":
            found.append(_alone(token, text))
            continue
        current.append(token)
        depth += (token.text in ("(", "[")) - (token.text in (")", "]"))
        if depth == 0 and token.text in (";", "{", "}"):
            close()
    if current:
        problems.append((current[0].line, "a statement without an end"))
        close()
    return found, problems


def _alone(token: Token, text: str) -> Statement:
    """A comment or directive as a statement of its own."""
    return Statement(((token.kind, " ".join(token.text.split())),), _source(text, token, token), token.line, token.line)


def _source(text: str, first: Token, last: Token) -> str:
    """The text from one token to another, with the indentation before it."""
    start = text.rfind("\n", 0, first.start) + 1 if first.first else first.start
    return text[start : last.end]


def common(tokens: Sequence[Token], language: str, textures: Collection[str]) -> tuple[Word, ...]:
    """Tokens of one statement, type or expression in common form."""
    words: list[Word] = [(t.kind, t.text) for t in tokens if t.kind not in ("comment", "directive")]
    if language == "wgsl":
        words = _plain_vectors(words)
    words = [("type", TYPES[language][text]) if text in TYPES[language] else (kind, text) for kind, text in words]
    if language == "hlsl":
        words = _without_loop_hint(words)
    words = _textures(words, language, textures)
    return tuple(_declarations(words) if language == "wgsl" else words)


def _plain_vectors(words: Sequence[Word]) -> list[Word]:
    """WGSL: vec4<f32> is vec4f."""
    found: list[Word] = []
    index = 0
    while index < len(words):
        four = [text for _, text in words[index : index + 4]]
        if len(four) == 4 and four[0] in ("vec2", "vec3", "vec4") and four[1] == "<" and four[3] == ">":
            letter = {"f32": "f", "i32": "i", "u32": "u"}.get(four[2])
            if letter:
                found.append(("name", four[0] + letter))
                index += 4
                continue
        found.append(words[index])
        index += 1
    return found


def _without_loop_hint(words: Sequence[Word]) -> list[Word]:
    """HLSL: BOKEH_LOOP, right before a `for`, is [loop] or nothing."""
    return [
        word
        for index, word in enumerate(words)
        if not (word == ("name", "BOKEH_LOOP") and index + 1 < len(words) and words[index + 1] == ("name", "for"))
    ]


def _textures(words: Sequence[Word], language: str, textures: Collection[str]) -> list[Word]:
    """A texture argument in the form of its language becomes one word; in any other form it stays as it is."""
    found: list[Word] = []
    index = 0
    while index < len(words):
        texts = [text for _, text in words[index : index + 4]]
        name, length = None, 1
        if language == "glsl" and texts[0] in textures and not (found and found[-1] == ("operator", ".")):
            name = texts[0]
        elif language == "hlsl" and texts[:2] == ["BOKEH_ARGUMENT", "("] and texts[3:] == [")"]:
            name, length = texts[2], 4
        elif language == "wgsl" and texts[1:3] == [",", texts[0] + "Sampler"]:
            name, length = texts[0], 3
        if name in textures:
            found.append(("texture", str(name)))
            index += length
        else:
            found.append(words[index])
            index += 1
    return found


def _declarations(words: Sequence[Word]) -> list[Word]:
    """WGSL: `let name: type` and `var name: type` become `type name`; `const` stays, as it does in the others."""
    start = 2 if [text for _, text in words[:2]] == ["for", "("] else 0
    if len(words) < start + 4 or words[start][1] not in ("let", "var", "const") or words[start + 2][1] != ":":
        return list(words)
    end = next((i for i in range(start + 3, len(words)) if words[i][1] in ("=", ";")), len(words))
    keyword = [words[start]] if words[start][1] == "const" else []
    return [*words[:start], *keyword, *words[start + 3 : end], words[start + 1], *words[end:]]


def _joined(words: Sequence[Word]) -> str:
    return " ".join(text for _, text in words)
