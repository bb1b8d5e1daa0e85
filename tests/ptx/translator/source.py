"""The text of PTX in pieces: functions, their parameters and statements."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from .words import Unknown, size_of


@dataclass
class Parameter:
    name: str
    offset: int
    size: int


@dataclass
class Function:
    name: str
    entry: bool
    line: int
    params: list[Parameter]
    returns: list[Parameter]
    number: int = 0
    body: str | None = None
    shared_bytes: int = 0
    synchronizes: bool = False
    calls: set[str] = field(default_factory=set)
    first_block: int = 0
    n_blocks: int = 0
    code: list[str] = field(default_factory=list)

    def param_bytes(self) -> int:
        return max((p.offset + p.size for p in self.params), default=0)


def parse_params(text: str) -> list[Parameter]:
    out, at = [], 0
    for piece in filter(None, (p.strip() for p in text.split(","))):
        m = re.fullmatch(r"\.param\s+(?:\.align\s+(\d+)\s+)?\.([bfsu]\d+)(?:\s+\.ptr\b[^%$\w]*(?:\.\w+\s+)*(?:\.align\s+\d+)?)?\s+([\w$]+)(?:\[(\d+)\])?", piece)
        if not m:
            raise Unknown(f"parameter {piece}")
        size = size_of(m[2])
        align = int(m[1] or size)
        at = (at + align - 1) // align * align
        bytes_of = size * int(m[4] or 1)
        out.append(Parameter(m[3], at, bytes_of))
        at += bytes_of
    return out


def split_arguments(text: str) -> list[str]:
    out, depth, current = [], 0, ""
    for ch in text:
        depth += ch in "{[("
        depth -= ch in "}])"
        if ch == "," and depth == 0:
            out.append(current.strip())
            current = ""
        else:
            current += ch
    if current.strip():
        out.append(current.strip())
    return out


def statements(body: str, line: int):
    """Yields (kind, text, line): "statement" up to its ';', "label", "open", "close"."""
    start, text = line, ""
    for ch in body:
        if not text.strip():
            start, text = line, ""
        if ch == "\n":
            line += 1
        if ch in "{}" and not text.strip():
            yield ("open" if ch == "{" else "close"), ch, line
        elif ch == ";":
            yield "statement", " ".join(text.split()), start
            text = ""
        elif ch == ":" and re.fullmatch(r"\s*[$%\w]+", text):
            yield "label", text.strip(), start
            text = ""
        else:
            text += ch
    if text.strip():
        raise Unknown(f"unfinished statement '{text.strip()}'")
