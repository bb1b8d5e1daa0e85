"""Registers of PTX that are used where some path has not set them: the device computes with whatever they held. Copies by
mov are followed. Some are harmless (a value that is chosen away later), some are a compiler's mistake: a list to read, not
a test. The translated code starts with NaN in such a register, so that tests see it where it runs.

    assigned.py KERNELS.ptx ...      names register, line and kernel; exit code 1 when there is one"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import translator  # noqa: E402

REGISTER = re.compile(r"%[a-zA-Z_]+\d+\b")
STORES = {"st", "red", "bra", "brx", "bar", "barrier", "ret", "exit", "call", "membar", "fence", "trap"}


def reads_and_writes(text: str) -> tuple[set[str], set[str], bool, bool]:
    """Registers of a statement, whether it may be skipped, whether it is a plain copy."""
    m = re.fullmatch(r"(?:@!?(%\w+)\s+)?([a-z][\w.:]*)\s*(.*)", text)
    args = translator.split_arguments(m[3])
    writes: set[str] = set()
    if m[2].split(".")[0] not in STORES and args:
        writes = set(REGISTER.findall(args.pop(0)))
    reads = set(REGISTER.findall(" ".join(args)))
    if m[1]:
        reads.add(m[1])
    return reads, writes, bool(m[1]), m[2].startswith("mov.") and len(reads) == 1 and len(writes) == 1


@dataclass
class Instruction:
    """Sets of registers are numbers, a bit a register."""

    line: int
    reads: int
    writes: int
    guarded: bool
    copies: bool


@dataclass
class Block:
    """Straight-line code and where it may go on: the number of a block or a label."""

    code: list[Instruction] = field(default_factory=list)
    after: list[int | str] = field(default_factory=list)

    def passed(self, have: int, used: list[tuple[int, int]] | None = None) -> int:
        """What is set behind it when `have` is set before; used gets (line, registers) of what is read unset."""
        for i in self.code:
            if i.copies and not i.guarded:
                have = have | i.writes if i.reads & have else have & ~i.writes
                continue
            if used is not None and i.reads & ~have:
                used.append((i.line, i.reads & ~have))
            if not i.guarded:
                have |= i.writes
        return have


class Flow:
    """The blocks of a function, its labels and registers."""

    def __init__(self, function: translator.Function):
        self.blocks = [Block()]
        self.labels: dict[str, int] = {}
        self.tables: dict[str, list[str]] = {}
        self.numbers: dict[str, int] = {}
        for kind, text, line in translator.statements(function.body, function.line):
            if kind == "label":
                self.begin_block(True)
                self.labels[text] = len(self.blocks) - 1
            elif kind == "statement" and ".branchtargets" in text:
                name, targets = text.split(":", 1)
                self.tables[name.strip()] = [t.strip() for t in targets.replace(".branchtargets", "").split(",")]
            elif kind == "statement" and text and not text.startswith("."):
                self.add(text, line)

    def bits_of(self, names: set[str]) -> int:
        return sum(1 << self.numbers.setdefault(name, len(self.numbers)) for name in names)

    def begin_block(self, falls: bool) -> None:
        if falls:
            self.blocks[-1].after.append(len(self.blocks))
        self.blocks.append(Block())

    def add(self, text: str, line: int) -> None:
        reads, writes, guarded, copies = reads_and_writes(text)
        self.blocks[-1].code.append(Instruction(line, self.bits_of(reads), self.bits_of(writes), guarded, copies))
        word = re.sub(r"^@!?%\w+\s+", "", text)
        last = word.split()[-1]
        if word.startswith("bra"):
            self.blocks[-1].after.append(last)
        elif word.startswith("brx"):
            self.blocks[-1].after += self.tables[last]
        if word.startswith(("bra", "ret", "exit", "trap", "brx")):
            self.begin_block(guarded)

    def target(self, where: int | str) -> int:
        return self.labels[where] if isinstance(where, str) else where

    def set_before(self) -> dict[int, int]:
        """Block -> registers that are set on every path to it; blocks that are never reached are left out."""
        into, open_blocks = {0: 0}, [0]
        while open_blocks:
            b = open_blocks.pop()
            out = self.blocks[b].passed(into[b])
            for t in map(self.target, self.blocks[b].after):
                known = out & into.get(t, out)
                if into.get(t) != known:
                    into[t] = known
                    if t not in open_blocks:
                        open_blocks.append(t)
        return into


def unassigned(function: translator.Function) -> list[tuple[int, str]]:
    """(line, register), the first such read of each register."""
    flow = Flow(function)
    found: dict[str, int] = {}
    names = list(flow.numbers)
    for b, have in sorted(flow.set_before().items()):
        used: list[tuple[int, int]] = []
        flow.blocks[b].passed(have, used)
        for line, bits in used:
            for i in range(bits.bit_length()):
                if bits >> i & 1:
                    found.setdefault(names[i], line)
    return sorted((line, name) for name, line in found.items())


def main() -> int:
    bad = 0
    for path in sys.argv[1:]:
        module = translator.Module(Path(path).read_text(), path)
        for function in module.functions.values():
            for line, name in unassigned(function):
                print(f"{path}:{line}: {name} may be read before it is set, in {function.name}")
                bad += 1
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
