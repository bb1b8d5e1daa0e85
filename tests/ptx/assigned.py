"""Registers of PTX that are used where some path has not set them: the device computes with whatever they held. Copies by
mov are followed. Some are harmless (a value that is chosen away later), some are a compiler's mistake: a list to read, not
a test. The translated code starts with NaN in such a register, so that tests see it where it runs.

    assigned.py KERNELS.ptx ...      names register, line and kernel; exit code 1 when there is one"""

from __future__ import annotations

import re
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER))
import translate  # noqa: E402

REGISTER = re.compile(r"%[a-zA-Z_]+\d+\b")
STORES = {"st", "red", "bra", "brx", "bar", "barrier", "ret", "exit", "call", "membar", "fence", "trap"}


def reads_and_writes(text: str) -> tuple[set[str], set[str], bool, bool]:
    """Registers of a statement, whether it may be skipped, whether it is a plain copy."""
    m = re.fullmatch(r"(?:@!?(%\w+)\s+)?([a-z][\w.:]*)\s*(.*)", text)
    args = translate.split_arguments(m[3])
    writes: set[str] = set()
    if m[2].split(".")[0] not in STORES and args:
        writes = set(REGISTER.findall(args.pop(0)))
    reads = set(REGISTER.findall(" ".join(args)))
    if m[1]:
        reads.add(m[1])
    return reads, writes, bool(m[1]), m[2].startswith("mov.") and len(reads) == 1 and len(writes) == 1


def unassigned(function: translate.Function) -> list[tuple[int, str]]:
    """(line, register), the first such read of each register."""
    blocks: list[list[tuple[int, int, int, bool, bool]]] = [[]]
    labels: dict[str, int] = {}
    successors: list[list] = [[]]
    tables: dict[str, list[str]] = {}

    numbers: dict[str, int] = {}

    def bits_of(names: set[str]) -> int:
        return sum(1 << numbers.setdefault(name, len(numbers)) for name in names)

    def fresh(falls: bool) -> None:
        if falls:
            successors[-1].append(len(blocks))
        blocks.append([]), successors.append([])

    for kind, text, line in translate.statements(function.body, function.line):
        if kind == "label":
            fresh(True)
            labels[text] = len(blocks) - 1
        elif kind == "statement" and ".branchtargets" in text:
            name, targets = text.split(":", 1)
            tables[name.strip()] = [t.strip() for t in targets.replace(".branchtargets", "").split(",")]
        elif kind == "statement" and text and not text.startswith("."):
            reads, writes, guarded, copies = reads_and_writes(text)
            blocks[-1].append((line, bits_of(reads), bits_of(writes), guarded, copies))
            word = re.sub(r"^@!?%\w+\s+", "", text)
            if word.startswith(("bra", "ret", "exit", "trap", "brx")):
                last = word.split()[-1] if " " in word else ""
                if word.startswith("bra"):
                    successors[-1].append(last)
                elif word.startswith("brx"):
                    successors[-1] += tables[last]
                fresh(guarded)

    def passed(have: int, block: int, used: list[tuple[int, int]] | None = None) -> int:
        """What is set behind a block that is entered with `have`."""
        for line, reads, writes, guarded, copies in blocks[block]:
            if copies and not guarded:
                have = have | writes if reads & have else have & ~writes
                continue
            if used is not None and reads & ~have:
                used.append((line, reads & ~have))
            if not guarded:
                have |= writes
        return have

    everything = (1 << len(numbers)) - 1
    into = [everything] * len(blocks)
    into[0] = 0
    seen, open_blocks = {0}, [0]
    while open_blocks:
        b = open_blocks.pop()
        out = passed(into[b], b)
        for target in successors[b]:
            t = labels[target] if isinstance(target, str) else target
            known = into[t] & out
            if known != into[t] or t not in seen:
                into[t] = known
                seen.add(t)
                if t not in open_blocks:
                    open_blocks.append(t)
    found: dict[str, int] = {}
    names = list(numbers)
    for b in sorted(seen):
        used: list[tuple[int, int]] = []
        passed(into[b], b, used)
        for line, bits in used:
            for i in range(bits.bit_length()):
                if bits >> i & 1:
                    found.setdefault(names[i], line)
    return sorted((line, name) for name, line in found.items())


def main() -> int:
    bad = 0
    for path in sys.argv[1:]:
        module = translate.Module(Path(path).read_text(), path)
        for function in module.functions.values():
            for line, name in unassigned(function):
                print(f"{path}:{line}: {name} may be read before it is set, in {function.name}")
                bad += 1
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
