"""The files of a session folder of the ppf contact solver: info.toml, param.toml, dyn_param.txt, and arrays.

The form is that which crates/ppf-cts-solver/src/scene.rs of st-tech/ppf-contact-solver at f23b356 reads.
"""

from pathlib import Path

import numpy as np
import tomllib

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError

from .card import Card, leaves
from .ppf_pins import KEYS, NEEDED, TEXTS, Operation

# name of an array in bin/: numbers in it, how many a row
ARRAYS = {
    "displacement": ("<f8", 3),
    "vert_dmap": ("<u4", 1),
    "vert": ("<f8", 3),
    "vel": ("<f4", 3),
    "rod": ("<u8", 2),
    "tri": ("<u8", 3),
    "tet": ("<u8", 4),
    "uv": ("<f4", 6),
    "rest_vert": ("<f8", 3),
    "rest_vert_mask": ("u1", 1),
    "static_vert_dmap": ("<u4", 1),
    "static_vert": ("<f8", 3),
    "static_tri": ("<u8", 3),
}
COUNTS = {
    "vert": "vert",
    "rod": "rod",
    "tri": "tri",
    "tet": "tet",
    "static_vert": "static_vert",
    "static_tri": "static_tri",
}


def _toml(path: Path) -> dict:
    """A TOML file. Errors: UserError."""
    try:
        return tomllib.loads(input_file.read_text(path))
    except tomllib.TOMLDecodeError as fault:
        raise UserError(f"{path}: found no TOML: {fault}; allowed: what the frontend of ppf writes") from None


class Session:
    """What the files hold. Errors: UserError for a file that is missing or has another length."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.info, found = _toml(folder / "info.toml"), _toml(folder / "param.toml")
        self.dynamic = _dynamic(folder / "dyn_param.txt")
        files = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())
        keys = [
            f"{name}#{leaf}"
            for name, data in (("info.toml", self.info), ("param.toml", found))
            for leaf in leaves(data)
        ]
        keys += [f"dyn_param.txt#/{key}" for key in self.dynamic]
        keys += [name for name in files if name not in ("info.toml", "param.toml", "dyn_param.txt")]
        self.card = Card(folder, "ppf", keys)
        self.param = found.get("param", {})
        if not isinstance(self.param, dict):
            raise self.card.refuse("param.toml#/param", self.param, "a table")
        for name in COUNTS:
            self._hold(name)

    def table(self, name: str) -> dict:
        """A table of info.toml, empty where it is missing. Errors: UserError."""
        found = self.info.get(name, {})
        if not isinstance(found, dict):
            raise self.card.refuse(f"info.toml#/{name}", found, "a table")
        return found

    def count(self, key: str, rest: int = 0, of: str = "count") -> int:
        """A number of [count], or of another table. Errors: UserError."""
        found = self.table(of).get(key, rest)
        if not isinstance(found, int) or isinstance(found, bool) or found < 0:
            raise self.card.refuse(f"info.toml#/{of}/{key}", found, "a whole number from 0")
        return found

    def number(self, of: str, key: str, rest: float | None = None) -> float:
        """A number of a table of info.toml; without `rest` it has to be there. Errors: UserError."""
        found = self.table(of).get(key, rest)
        if not is_number(found):
            raise self.card.refuse(f"info.toml#/{of}/{key}", found, "a number")
        return float(found)

    def _hold(self, name: str) -> None:
        """Holds a count against the array."""
        wanted = self.count(name)
        if wanted != len(self.array(name)):
            raise self.card.refuse(
                f"bin/{name}.bin", len(self.array(name)), f"{wanted} rows, which info.toml has"
            )
        self.card.mapped(f"info.toml#/count/{name}", "the mesh files", "a count")

    def numbers(self, name: str, kind: str, width: int) -> np.ndarray:
        """[rows, width] of a file of bin/, without rows where it is missing. Errors: UserError."""
        path = self.folder / "bin" / f"{name}.bin"
        if not path.exists():
            return np.zeros((0, width))
        data = input_file.read_bytes(path, input_file.LARGE)
        size = np.dtype(kind).itemsize * width
        if len(data) % size:
            raise self.card.refuse(f"bin/{name}.bin", len(data), f"a multiple of {size} bytes")
        return np.frombuffer(data, kind).reshape(-1, width)

    def array(self, name: str) -> np.ndarray:
        """An array of ARRAYS; of one column, flat."""
        kind, width = ARRAYS[name]
        found = self.numbers(name, kind, width)
        return found[:, 0] if width == 1 else found

    def parameter(self, kind: str, name: str, count: int, rest: float) -> np.ndarray:
        """A parameter of every element of a kind (rod, tri, tet, static). Errors: UserError."""
        path = f"param/{kind}-{name}"
        found = self.numbers(path, "u1" if name == "model" else "<f4", 1)[:, 0].astype(float)
        if not len(found):
            return np.full(count, rest)
        if len(found) != count:
            raise self.card.refuse(f"bin/{path}.bin", len(found), f"one number for each of {count} elements")
        return found

    def value(self, key: str, rest):
        """A parameter of the run."""
        return self.param.get(key, rest)

    def at(self, key: str) -> str:
        """The place of a parameter of the run on the card."""
        return f"param.toml#/param/{key}"

    def operations(self, pin: int, scaling: float) -> list[Operation]:
        """The operations of a pin, in their order. Errors: UserError."""
        made = []
        for number in range(self.count("operation_count", of=f"pin-{pin}")):
            name = f"pin-{pin}-op-{number}"
            given = self.info.get(name)
            if not isinstance(given, dict):
                raise self.card.refuse(f"info.toml#/{name}", given, "a table with type")
            kind = given.get("type")
            rows = self.numbers(name, "<f8", 3) * scaling if kind in ("move_by", "move_to") else None
            made.append(Operation(f"info.toml#/{name}", given, rows, scaling))
            self._hold_operation(name, made[-1], len(self.numbers(f"pin-ind-{pin}", "<u8", 1)))
        return made

    def _hold_operation(self, name: str, one: Operation, pinned: int) -> None:
        """Holds an operation against what its motion needs. Errors: UserError."""
        for key, value in one.given.items():
            if key in KEYS and key not in TEXTS and not is_number(value):
                raise self.card.refuse(f"info.toml#/{name}/{key}", value, "a number")
        if not one.is_read:
            return
        for key in NEEDED[one.given["type"]]:
            self.number(name, key)
        if one.rows is not None and len(one.rows) != pinned:
            raise self.card.refuse(
                f"bin/{name}.bin", len(one.rows), f"{pinned} rows, one for each vertex of the pin"
            )
        if one.given["type"] == "spin" and not one.axis.any():
            raise self.card.refuse(f"info.toml#/{name}/axis_x", 0.0, "an axis of a length above 0")


def is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _dynamic(path: Path) -> dict[str, list[list[float]]]:
    """Values over time: a heading for each parameter, below it lines of a time and its numbers."""
    found: dict[str, list[list[float]]] = {}
    if not path.exists():
        return found
    for line in input_file.read_text(path).splitlines():
        if line.startswith("[") and line.rstrip().endswith("]"):
            rows = found.setdefault(line.strip()[1:-1], [])
        elif line.strip():
            try:
                rows.append([float(word) for word in line.split()])
            except (ValueError, UnboundLocalError):
                raise UserError(f"{path}: found {line!r}; allowed: a heading, or numbers") from None
    return found
