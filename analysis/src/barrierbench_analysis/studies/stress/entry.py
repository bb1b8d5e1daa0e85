"""A stress test as data: configs/stress/ID.json, the formulations of configs/stress/formulations.json, the
words an outcome may be.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path

from barrierbench_analysis.io import fields
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object, read_of_schema
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.spec_file import read_spec, require_base
from barrierbench_analysis.studies.catalogue.entry import read_entry, write_config

FOLDER = ROOT / "configs" / "stress"
RUNS = ("base", "set", "axes", "formulations", "contacts", "full", "relations")  # of a test that runs scenes
ONE = "-"  # the case of a test without axes

# What a record cannot say of itself: ok but not valid; no record because the config was refused; the
# program died without a record.
BESIDE = ("not_valid", "refused", "crash")
OUTCOMES = tuple(fields.schema("run")["$defs"]["Status"]["properties"]["outcome"]["enum"]) + BESIDE
NEVER_NAMED = ("penetration", "unproven", "oom", "timeout", "crash", "not_valid", "refused", "ok")
CATALOGUE = "barrierbench.catalogue/1"
NAMED = "named"  # in an expectation: any failure but these


@dataclass(frozen=True)
class Formulation:
    label: str
    set: dict = field(hash=False)
    by_case: dict = field(default_factory=dict, hash=False)  # label of a case -> more settings


@dataclass(frozen=True)
class Case:
    label: str
    set: dict = field(hash=False)
    needs: tuple = field(
        default=(), hash=False
    )  # settings that a program may not have yet: pointer and value


@dataclass(frozen=True)
class Expected:
    outcomes: tuple[str, ...]
    reason: str

    def holds(self, outcome: str) -> bool:
        return outcome in self.outcomes or (NAMED in self.outcomes and outcome not in NEVER_NAMED)


@dataclass(frozen=True)
class Test:
    path: Path
    data: dict = field(hash=False)
    cases: tuple[Case, ...]
    formulations: tuple[Formulation, ...]
    groups: dict = field(hash=False)

    @property
    def id(self) -> str:
        return self.data["id"]

    def write_base(self, folder: Path) -> Path:
        """The config that its cases change: a file, or the mini scene of the catalogue that `base` names,
        which is written into `folder`.
        """
        base = (self.path.parent / self.data["base"]).resolve()
        if read_object(base).get("schema") != CATALOGUE:
            return base
        file = folder / "base.json"
        write_config(read_entry(base.stem, base.parent), file)
        return file

    @property
    def contacts(self) -> bool:
        return self.data.get("contacts", True)

    def named(self, names: list[str], place: str) -> list[str]:
        """Labels of formulations; @GROUP stands for several, @all for those of this test."""
        out = []
        for name in names:
            found = (
                [f.label for f in self.formulations]
                if name == "@all"
                else self.groups.get(name[1:])
                if name.startswith("@")
                else [name]
            )
            if found is None or not set(found) <= {f.label for f in self.formulations}:
                raise UserError(
                    f"{self.path}: {place}: {name!r}; allowed:"
                    f" {', '.join(f.label for f in self.formulations)}, @all, "
                    + ", ".join(f"@{group}" for group in self.groups)
                )
            out += found
        return out

    def expected(self, formulation: str, case: str) -> Expected:
        """The first expectation that names both. Every pair needs one."""
        for k, entry in enumerate(self.data["expect"]):
            if formulation in self.named(entry["formulations"], f"/expect/{k}/formulations") and _covers(
                entry, case
            ):
                return Expected(tuple(entry["outcomes"]), entry["reason"])
        raise UserError(f"{self.path}: /expect: nothing is expected of {formulation} in case {case!r}")

    def defect(self, formulation: str, case: str, outcome: str) -> str:
        """What is known to be wrong with the program where this outcome is found in the place of the expected
        one; empty: nothing.
        """
        for k, entry in enumerate(self.data.get("defects", [])):
            if (
                formulation in self.named(entry["formulations"], f"/defects/{k}/formulations")
                and _covers(entry, case)
                and outcome in entry["outcomes"]
            ):
                return entry["why"]
        return ""


def _covers(entry: dict, case: str) -> bool:
    return any(fnmatchcase(case, pattern) for pattern in entry.get("cases", ["*"]))


def order(name: str) -> tuple:
    """S before M, and 9 before 10."""
    return "SM".find(name[0]), int(name[1:])


def ids(folder: Path = FOLDER) -> list[str]:
    return sorted(
        (path.stem for path in folder.glob("*.json") if re.fullmatch(r"[SM]\d\d", path.stem)), key=order
    )


def left_out(folder: Path = FOLDER) -> dict[str, str]:
    """Proposed tests that are not here, and why."""
    return {
        k: v
        for k, v in read_of_schema(folder / "left_out.json", "barrierbench.stress_left_out/1").items()
        if k != "schema"
    }


def _cases(axes: list[dict]) -> tuple[Case, ...]:
    """Every combination of one entry of each axis; axes are written as in a sweep, by cases."""
    out = [Case("", {})]
    for axis in axes:
        out = [
            Case(
                f"{one.label} {entry['label']}".strip(),
                {**one.set, **entry.get("set", {})},
                (*one.needs, *entry.get("needs", ())),
            )
            for one in out
            for entry in axis["cases"]
        ]
    return tuple(Case(one.label or ONE, one.set, one.needs) for one in out)


def _formulations(data: dict, folder: Path, path: Path) -> tuple[tuple[Formulation, ...], dict]:
    """The comparable ones with what the test adds to them, or the test's own."""
    common = read_of_schema(folder / "formulations.json", "barrierbench.stress_formulations/1")
    choice = data.get("formulations", {})
    if "own" in choice:
        return tuple(Formulation(f["label"], f["set"], f.get("by_case", {})) for f in choice["own"]), {}
    add = choice.get("add", {})
    if unknown := set(add) - {f["label"] for f in common["comparable"]}:
        raise UserError(
            f"{path}: /formulations/add/{sorted(unknown)[0]}: no formulation of formulations.json"
        )
    return (
        tuple(Formulation(f["label"], {**f["set"], **add.get(f["label"], {})}) for f in common["comparable"]),
        common["groups"],
    )


def _check_expect(test: Test) -> None:
    for k, entry in enumerate(test.data["expect"]):
        place = f"{test.path}: /expect/{k}"
        if wrong := [word for word in entry["outcomes"] if word not in (*OUTCOMES, NAMED)]:
            raise UserError(f"{place}/outcomes: {wrong[0]!r}; allowed: {', '.join((*OUTCOMES, NAMED))}")
        if idle := [
            p for p in entry.get("cases", []) if not any(fnmatchcase(case.label, p) for case in test.cases)
        ]:
            raise UserError(
                f"{place}/cases: {idle[0]!r} is no case; cases:"
                f" {', '.join(case.label for case in test.cases)}"
            )
    for formulation in test.formulations:
        for case in test.cases:
            test.expected(formulation.label, case.label)


def read_test(name: str, folder: Path = FOLDER, full: bool = False) -> Test:
    """Raises UserError: unknown id or key, a formulation in a case of which nothing is expected."""
    path = folder / f"{name}.json"
    if not path.is_file():
        raise UserError(f"stress test {name!r}: one of {', '.join(ids(folder))} (configs/stress/)")
    data = read_spec(path, "stress")
    if data["id"] != name:
        raise UserError(f"{path}: /id: found {data['id']!r}; the name of the file is needed")
    if "geometry" in data:
        if both := [key for key in RUNS if key in data]:
            raise UserError(f"{path}: /{both[0]}: a test of geometry runs no scene")
        return Test(path, data, (), (), {})
    require_base(data, path)
    if full and "full" in data:
        data = {
            **data,
            "axes": data["full"]["axes"],
            "set": {**data.get("set", {}), **data["full"].get("set", {})},
        }
        # what is said of cases by name holds of those that are left
        labels = [case.label for case in _cases(data["axes"])]
        data["expect"] = [
            e
            for e in data["expect"]
            if "cases" not in e or any(fnmatchcase(x, p) for x in labels for p in e["cases"])
        ]
    formulations, groups = _formulations(data, folder, path)
    test = Test(path, data, _cases(data.get("axes", [])), formulations, groups)
    labels = [case.label for case in test.cases]
    if len(set(labels)) != len(labels):
        raise UserError(f"{path}: /axes: two cases with one label")
    if idle := [label for label in data.get("quick", []) if label not in labels and not full]:
        raise UserError(f"{path}: /quick: {idle[0]!r} is no case; cases: {', '.join(labels)}")
    _check_expect(test)
    return test
