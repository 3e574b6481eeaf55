"""What a compiler says of a shader."""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class CompileResult:
    """Outcome of one compilation; `facts` holds what the compiler tells of its output (slots, sizes)."""

    ok: bool
    messages: str = ""
    binary: bytes = b""
    facts: dict[str, object] = field(default_factory=dict)
