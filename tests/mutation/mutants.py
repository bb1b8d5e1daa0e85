"""Mutants as data: the entries of the *.toml files, and those of them that one build can hold together."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import switches

try:
    import tomllib
except ModuleNotFoundError:
    sys.exit("mutate: Python 3.11 or newer is needed, for tomllib")

ROOT = Path(__file__).resolve().parents[2]
FIELDS = {"name", "file", "find", "replace", "breaks", "judges", "equivalent"}


@dataclass(frozen=True)
class Mutant:
    table: str
    name: str
    file: str
    find: str
    replace: str
    breaks: str
    judges: tuple[str, ...]
    equivalent: str = ""

    @property
    def label(self) -> str:
        return f"{self.table}/{self.name}"

    def applied_to(self, text: str) -> str:
        """The file's text with the mistake in it. Raises ValueError when `find` is not there exactly once."""
        count = text.count(self.find)
        if count != 1:
            raise ValueError(f"{self.file}: the text to find is there {count} times, not once: {self.find!r}")
        return text.replace(self.find, self.replace)


def read_mutants(folder: Path) -> list[Mutant]:
    """All mutants, in the order of their files so that rebuilds are small. Exits with 2 for a malformed entry."""
    mutants = []
    for path in sorted(folder.glob("*.toml")):
        for entry in tomllib.loads(path.read_text())["mutant"]:
            unknown, missing = set(entry) - FIELDS, FIELDS - {"equivalent"} - set(entry)
            if unknown or missing or not entry["judges"] or entry["find"] == entry["replace"]:
                sys.exit(f"mutate: {path.name}: {entry.get('name')}: unknown {sorted(unknown)}, missing {sorted(missing)}, or it changes or asks nothing")
            mutants.append(Mutant(table=path.stem, **(entry | {"judges": tuple(entry["judges"])})))
    labels = [m.label for m in mutants]
    twice = sorted({label for label in labels if labels.count(label) > 1})
    if twice:
        sys.exit(f"mutate: named twice: {', '.join(twice)}")
    return sorted(mutants, key=lambda m: (m.file, labels.index(m.label)))


def line_of(mutant: Mutant, text: str) -> int:
    """Of the first line that differs, from 1."""
    at = text.find(mutant.find)
    old, new = mutant.find.splitlines(), mutant.replace.splitlines()
    same = next((i for i, (a, b) in enumerate(zip(old, new)) if a != b), 0)
    return text.count("\n", 0, max(at, 0)) + 1 + same


@dataclass(frozen=True)
class Switched:
    """A mutant that a build holds beside others."""

    mutant: Mutant
    number: int  # the value of BB_MUTANT that switches it on
    text: str  # of its file, unchanged
    edit: switches.Edit


def switched_rounds(mutants: list[Mutant]) -> list[list[Switched]]:
    """Mutants that one build can hold; a mutant that overlaps another one's text goes into a later round."""
    rounds: list[list[Switched]] = []
    for number, mutant in enumerate(mutants, 1):
        text = (ROOT / mutant.file).read_text()
        edit = switches.switched(number, mutant.find, mutant.replace, text) if mutant.file.endswith(".cpp") and text.count(mutant.find) == 1 else None
        if edit is None:
            continue
        one = Switched(mutant, number, text, edit)
        free = (r for r in rounds if all(o.mutant.file != mutant.file or edit.end <= o.edit.start or edit.start >= o.edit.end for o in r))
        place = next(free, None)
        if place is None:
            place = []
            rounds.append(place)
        place.append(one)
    return rounds
