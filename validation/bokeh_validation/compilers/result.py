"""What a compiler says of a shader."""

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class CompileResult:
    """Outcome of one compilation; `facts` holds what the compiler tells of its output (slots, sizes)."""

    ok: bool
    messages: str = ""
    binary: bytes = b""
    facts: dict[str, object] = field(default_factory=dict)


def accepted(messages: str, binary: bytes = b"", facts: Mapping[str, object] | None = None) -> CompileResult:
    """A result that is ok. What was printed all the same are warnings: their lines are counted in facts."""
    known = dict(facts or {})
    if messages.strip():
        known["warnings"] = len(messages.strip().splitlines())
    return CompileResult(True, messages.strip(), binary, known)


def refused(messages: str) -> CompileResult:
    """A result that is not ok."""
    return CompileResult(False, messages.strip() or "refused without a message")
