"""Claims and their sweeps as data: claims/ID.json, claims/sweeps/NAME.json, and claims/confirmation/NAME.json
for scenes that no rule was tuned on.
"""

import itertools
import json
import re
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from barrierbench_analysis.io import places
from barrierbench_analysis.io.digests import of_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.spec_file import read_spec

FOLDER = ROOT / "claims"
REQUIRED = ("id", "source", "sentence", "dimension", "guarantee", "kind")
SEEDS = "/seeds/main"
SOLVER = "/step_solver/name"
METHOD = "/method"


@dataclass(frozen=True)
class Claim:
    id: str
    source: str
    sentence: str
    dimension: str
    guarantee: str
    kind: str  # what makes it true or false; by dimension and by construction are trivial
    # rules with their parameters; all of them together are the claim, but those marked beside
    parts: tuple[dict, ...] = ()
    waits_for: str = ""  # what has to be built before it can be decided
    note: str = ""
    rule_changes: tuple[str, ...] = ()  # of a rule after numbers were seen
    # sweep, cost, axes, and which runs are bad, of the table and figure of who gets how far (frontiers.py)
    frontier: dict = field(default_factory=dict, hash=False)

    @property
    def sweeps(self) -> list[str]:
        found = [part["sweep"] for part in (*self.parts, self.frontier) if "sweep" in part]
        return list(dict.fromkeys(found))

    @property
    def deciding(self) -> list[dict]:
        return [part for part in self.parts if not part.get("beside")]

    @property
    def confirmation_sweeps(self) -> list[str]:
        return list(dict.fromkeys(part["confirm"]["sweep"] for part in self.deciding if "confirm" in part))

    @property
    def command(self) -> str:
        return f"./bench study claims {self.id}"


@dataclass(frozen=True)
class Sweep:
    """The cases of a sweep file: SCENE LEVEL, case, seed, and what more it varies."""

    name: str
    sha256: str
    # Note of a record -> its place; note -> values of further axes: theta, ...
    cases: dict[str, tuple[str, str, str, int]] = field(hash=False, default_factory=dict)
    more: dict[str, dict] = field(hash=False, default_factory=dict)
    axes: dict[str, list] = field(hash=False, default_factory=dict)  # of these their values
    path: Path = Path()
    # Case -> step solver, of those that name one.
    solvers: dict[str, str] = field(hash=False, default_factory=dict)

    @property
    def file(self) -> str:
        return f"claims/{self.path.parent.name}/{self.name}.json"

    @property
    def command(self) -> str:
        return f"./bench sweep {self.file} --out results/runs/claims/{self.name}"


def order(name: str) -> tuple:
    """K before H before N, and 9 before 10."""
    letter, number = re.match(r"([A-Z]+)(\d+)$", name).groups()
    return "KHN".find(letter), int(number)


def ids(folder: Path = FOLDER) -> list[str]:
    return sorted((path.stem for path in folder.glob("*.json")), key=order)


def read_claim(name: str, folder: Path = FOLDER) -> Claim:
    path = folder / f"{name}.json"
    if not path.is_file():
        raise UserError(f"claim {name!r}: one of {', '.join(ids(folder))} (claims/)")
    data = read_spec(path, "claim")
    if data["id"] != name:
        raise UserError(f"{path}: /id: found {data['id']!r}; the name of the file is needed")
    if "frontier" in data and set(data["frontier"]) - {"bad"} != {"sweep", "cost", "axes"}:
        raise UserError(
            f"{path}: /frontier: sweep, cost and axes are needed, bad may be given; found"
            f" {', '.join(data['frontier'])}"
        )
    if not data.get("parts") and not data.get("waits_for"):
        raise UserError(f"{path}: neither parts that decide it nor waits_for")
    return Claim(
        **{key: data[key] for key in REQUIRED},
        parts=tuple(data.get("parts", ())),
        waits_for=data.get("waits_for", ""),
        note=data.get("note", ""),
        rule_changes=tuple(data.get("rule_changes", ())),
        frontier=data.get("frontier", {}),
    )


def method_set(name: str | None) -> dict:
    """Pointer -> value of a published method (configs/methods); of none, or one that the program does not
    know, nothing.
    """
    file = places.METHODS / f"{name}.json"
    return read_object(file)["set"] if name and file.is_file() else {}


def word(pointer: str) -> str:
    """The name of an axis by pointer: of /matching/theta theta."""
    return pointer.rsplit("/", 1)[-1]


def settings_of(axis: dict, path: Path) -> list[tuple[str, dict]]:
    """Label and settings (pointer -> value) of every choice on an axis."""
    if "cases" in axis:
        return [(case["label"], case["set"]) for case in axis["cases"]]
    if "pointer" not in axis or not axis.get("values"):
        raise UserError(f"{path}: an axis has cases, or a pointer and values; found {', '.join(axis)}")
    return [
        (f"{word(axis['pointer'])}={json.dumps(value)}", {axis["pointer"]: value}) for value in axis["values"]
    ]


def note_of(name: str, labels) -> str:
    """labels.note of the record of a case."""
    return f"{name}: {' '.join(labels)}"


def sweep_path(name: str, folder: Path = FOLDER) -> Path:
    """Of a sweep of claims, or of one of confirmation scenes; no name is in both."""
    files = (folder / kind / f"{name}.json" for kind in ("sweeps", "confirmation"))
    found = [path for path in files if path.is_file()]
    if len(found) > 1:
        raise UserError(f"{found[1]}: a sweep of this name is in claims/sweeps as well")
    return found[0] if found else folder / "sweeps" / f"{name}.json"


def _axes_of(data: dict, name: str, path: Path) -> tuple[list[dict], int]:
    """The axes of a sweep of claims, and which of them is that of the seeds. Errors: UserError for a sweep of
    another form.
    """
    axes = data.get("axes", [])
    seeds = [k for k, axis in enumerate(axes) if axis.get("pointer") == SEEDS]
    if (
        data.get("name") != name
        or len(axes) < 3
        or len(seeds) != 1
        or not all("cases" in axis for axis in axes[:2])
        or any("cases" in axis for axis in axes[2:])
        or any("range" in axis or "zip" in axis for axis in axes)
        or {"exclude", "repeat", "seed"} & set(data)
    ):
        raise UserError(
            f"{path}: needs the name of the file and the axes: scenes with levels, cases, {SEEDS}; what is"
            " varied beside is an axis by pointer; every combination is run, and every value is written out"
        )
    return axes, seeds[0]


@cache
def read_sweep(name: str, folder: Path = FOLDER) -> Sweep:
    """Cases labelled SCENE LEVEL, the cases that are compared, values of /seeds/main, and any further axes by
    pointer, whose values become part of the place.
    """
    path = sweep_path(name, folder)
    axes, seeds = _axes_of(read_object(path), name, path)
    others = [k for k in range(2, len(axes)) if k != seeds]
    cases, more = {}, {}
    for chosen in itertools.product(*(settings_of(axis, path) for axis in axes)):
        labels = [label for label, _ in chosen]
        scene, _, level = labels[0].partition(" ")
        if not level:
            raise UserError(f"{path}: {labels}: the first axis is SCENE LEVEL")
        note = note_of(name, labels)
        cases[note] = scene, level, labels[1], int(labels[seeds].removeprefix("main="))
        more[note] = {word(axes[k]["pointer"]): json.loads(labels[k].partition("=")[2]) for k in others}
    solvers = {
        case["label"]: solver
        for case in axes[1]["cases"]
        if (solver := case["set"].get(SOLVER, method_set(case["set"].get(METHOD)).get(SOLVER)))
    }
    values = {word(axes[k]["pointer"]): axes[k]["values"] for k in others}
    return Sweep(name, of_file(path), cases, more, values, path, solvers)
