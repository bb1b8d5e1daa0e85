"""The card of an imported scene: every key of its source stands in exactly one of four lists."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path

from barrierbench_analysis.io.errors import UserError

SCHEMA = "barrierbench.import_card/1"
LISTS = {
    "mapped": "mapped",
    "changed": "changed",
    "not_mapped": "not mapped",
    "unknown": "unknown to this importer",
}
MOST_LINES = 40  # of a list on the standard output; the card has all of them


def leaves(data, above: str = "") -> list[str]:
    """JSON pointers of all values: what is neither an object nor an array of objects. Arrays of numbers and
    texts, and what is empty, are one value each.
    """
    if isinstance(data, dict) and data:
        pairs = [(escaped(key), value) for key, value in data.items()]
    elif isinstance(data, list) and any(isinstance(one, dict) for one in data):
        pairs = [(str(number), value) for number, value in enumerate(data)]
    else:
        return [above]
    return [leaf for key, value in pairs for leaf in leaves(value, f"{above}/{key}")]


def escaped(key: str) -> str:
    """A key as a part of a JSON pointer."""
    return key.replace("~", "~0").replace("/", "~1")


def is_below(key: str, above: str) -> bool:
    return key == above or key.startswith(f"{above}/")


def _above(key: str) -> list[str]:
    """Pointers of the objects that a key is in, the outermost first, but for the file."""
    parts = key.split("/")
    return ["/".join(parts[:n]) for n in range(1, len(parts)) if any(parts[:n])]


def _matches(key: str, pattern: str) -> bool:
    """Whether a key is at or below a pattern, in which `*` stands for anything within a part of a
    pointer; a pattern that ends in `!` is that key alone.
    """
    parts, wanted = key.split("/"), pattern.removesuffix("!").split("/")
    if pattern.endswith("!") and len(parts) > len(wanted):
        return False
    return len(parts) >= len(wanted) and all(map(fnmatchcase, parts, wanted))


# What reading a damaged source raises where no check has named its place.
DAMAGE = (LookupError, TypeError, AttributeError, ValueError, ArithmeticError)


@dataclass
class Card:
    """What became of each key of a source. A key that was noted before keeps its first note."""

    source: Path
    importer: str
    keys: list[str]  # all of the source
    entries: list[dict] = field(default_factory=list)
    defaults: list[dict] = field(default_factory=list)  # what the source leaves out and the config needs

    def __post_init__(self) -> None:
        self.open = dict.fromkeys(self.keys)
        self.below: dict[str, int] = {}  # by pointer of an object: how many keys are in it
        for key in self.keys:
            for above in _above(key):
                self.below[above] = self.below.get(above, 0) + 1

    def _note(self, kind: str, pointer: str | Iterable[str], **words) -> None:
        pointers = [pointer] if isinstance(pointer, str) else list(pointer)
        taken = [key for one in pointers for key in self.open if is_below(key, one)]
        taken = list(dict.fromkeys(taken))
        for key in taken:
            del self.open[key]
        if taken:
            self.entries.append({"list": kind, "keys": self._together(taken), "count": len(taken), **words})

    def _together(self, taken: list[str]) -> list[str]:
        """The pointers of these keys, where an object all of whose keys are among them stands for these."""
        within: dict[str, int] = {}
        for key in taken:
            for above in _above(key):
                within[above] = within.get(above, 0) + 1
        whole = {above for above, count in within.items() if count == self.below[above] > 1}
        return list(dict.fromkeys(next((a for a in _above(key) if a in whole), key) for key in taken))

    def mapped(self, pointer: str | Iterable[str], to: str, how: str = "") -> None:
        """A key whose meaning the config has. to: place in the config. how: the conversion, if any."""
        self._note("mapped", pointer, to=to, **({"how": how} if how else {}))

    def changed(self, pointer: str | Iterable[str], was, became, why: str) -> None:
        """A key whose meaning the config has only nearly."""
        self._note("changed", pointer, was=was, became=became, why=why)

    def left_out(self, pointer: str | Iterable[str], consequence: str) -> None:
        """A key that this program has nothing for."""
        self._note("not_mapped", pointer, consequence=consequence)

    def default(self, key: str, value, why: str) -> None:
        """A value that the source does not give."""
        self.defaults.append({"key": key, "value": value, "why": why})

    def close(self, known: Iterable[tuple[str, str]]) -> None:
        """What is left: keys that the format is known to have (pattern, consequence), and unknown ones."""
        for pattern, consequence in known:
            if found := [key for key in self.open if _matches(key, pattern)]:
                self.left_out(found, consequence)
        self._note("unknown", list(self.open))

    def refuse(self, pointer: str, found, allowed: str) -> UserError:
        """The error about a value that no config of this program can have."""
        file = self.source if pointer.startswith("/") else self.source / pointer.partition("#")[0]
        place = pointer if pointer.startswith("/") else pointer.partition("#")[2]
        return UserError(f"{file}{f'#{place}' if place else ''}: found {found!r}; allowed: {allowed}")

    def as_json(self) -> dict:
        """The card as it is written."""
        lists = {name: [] for name in LISTS}
        for entry in self.entries:
            words = {key: value for key, value in entry.items() if key != "list"}
            lists[entry["list"]].append(words)
        return {
            "schema": SCHEMA,
            "importer": self.importer,
            "source": self.source.name,
            "counts": {name: sum(e["count"] for e in entries) for name, entries in lists.items()},
            **lists,
            "defaults": self.defaults,
        }

    def lines(self) -> list[str]:
        """The card as text: one line for keys with the same note, at most MOST_LINES a list."""
        found = self.as_json()
        out = [f"{len(self.keys)} keys of {self.source.name}, read as a scene of {self.importer}"]
        for name, title in LISTS.items():
            out.append(f"{title}: {found['counts'][name]}")
            together: dict[str, list[str]] = {}
            for entry in found[name]:
                together.setdefault(_words(entry), []).extend(entry["keys"])
            lines = [f"  {_where(keys)}{words}" for words, keys in together.items()]
            if name == "unknown":
                lines = [f"  {key}" for entry in found[name] for key in entry["keys"]]
            out += lines if name == "unknown" else lines[:MOST_LINES]
            if name != "unknown" and len(lines) > MOST_LINES:
                out.append(f"  ... {len(lines) - MOST_LINES} more in the card")
        if self.defaults:
            out.append("not given by the source:")
            out += [f"  {one['key']} = {one['value']}: {one['why']}" for one in self.defaults]
        return out


def _where(keys: list[str]) -> str:
    return keys[0] if len(keys) == 1 else f"{keys[0]} and {len(keys) - 1} more keys"


def _words(entry: dict) -> str:
    if "to" in entry:
        return f" -> {entry['to']}" + (f" ({entry['how']})" if "how" in entry else "")
    if "became" in entry:
        return f": {entry['was']} became {entry['became']}: {entry['why']}"
    return f": {entry['consequence']}" if "consequence" in entry else ""
