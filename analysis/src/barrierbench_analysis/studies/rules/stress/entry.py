"""A stress test as data: configs/stress/ID.json, the formulations of configs/stress/formulations.json, the
words an outcome may be.
"""

import re
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path

from barrierbench_analysis.io import fields
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object, read_of_schema
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.spec_file import read_spec, refused, require_base
from barrierbench_analysis.studies.catalogue.entry import read_entry
from barrierbench_analysis.studies.kit.alone import CRASH, REFUSED

FOLDER = ROOT / "configs" / "stress"
RUNS = ("base", "set", "axes", "formulations", "contacts", "full", "relations")  # of a test that runs scenes
ONE = "-"  # the case of a test without axes

OUTCOMES = (
    *fields.schema("run")["$defs"]["Status"]["properties"]["outcome"]["enum"],
    "not_valid",
    REFUSED,
    CRASH,
)
NEVER_NAMED = ("penetration", "unproven", "oom", "timeout", "crash", "not_valid", "refused", "ok")
CATALOGUE = "barrierbench.catalogue/1"
NAMED = "named"  # in an expectation: any failure but these


@dataclass(frozen=True)
class Formulation:
    label: str
    set: dict = field(hash=False)
    by_case: dict = field(default_factory=dict, hash=False)  # label of a case -> more settings


@dataclass(frozen=True)
class Variant:
    """A case of a test. needs: settings that configs may not have yet, pointer and value."""

    label: str
    set: dict = field(hash=False)
    needs: tuple = field(default=(), hash=False)


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
    cases: tuple[Variant, ...] = ()
    formulations: tuple[Formulation, ...] = ()
    groups: dict = field(default_factory=dict, hash=False)

    @property
    def id(self) -> str:
        return self.data["id"]

    def base(self, plain: Path) -> tuple[Path, dict]:
        """The config that its cases change, and settings on top of it: a file, or a plain config with all
        sections of the mini scene of the catalogue that `base` names.
        """
        base = (self.path.parent / self.data["base"]).resolve()
        if read_object(base).get("schema") != CATALOGUE:
            return base, {}
        sections = read_entry(base.stem, base.parent).config().items()
        return plain, {f"/{key}": one for key, one in sections if key not in ("schema", "name", "doc")}

    def settings(self, formulation: Formulation, case: Variant) -> dict:
        more = formulation.by_case.get(case.label, {})
        return {**formulation.set, **self.data.get("set", {}), **case.set, **more}

    def named(self, names: list[str], place: str) -> list[str]:
        """Labels of formulations; @GROUP stands for several, @all for those of this test."""
        labels = [f.label for f in self.formulations]
        groups = {"@all": labels} | {f"@{name}": group for name, group in self.groups.items()}
        out = []
        for name in names:
            found = groups.get(name, [name])
            if not set(found) <= set(labels):
                raise refused(self.path, place, name, f"one of {', '.join([*labels, *groups])}")
            out += found
        return out

    def _first(self, key: str, formulation: str, case: str) -> list[dict]:
        """The entries of `expect` or `defects` that name both."""
        return [
            entry
            for k, entry in enumerate(self.data.get(key, []))
            if formulation in self.named(entry["formulations"], f"{key}/{k}/formulations")
            and any(fnmatchcase(case, pattern) for pattern in entry.get("cases", ["*"]))
        ]

    def expected(self, formulation: str, case: str) -> Expected:
        """The first expectation that names both. Every pair needs one."""
        for entry in self._first("expect", formulation, case):
            return Expected(tuple(entry["outcomes"]), entry["reason"])
        raise UserError(f"{self.path}#/expect: nothing is expected of {formulation} in case {case!r}")

    def defect(self, formulation: str, case: str, outcome: str) -> str:
        """What is known to be wrong with the program where this outcome is found in the place of the expected
        one; empty: nothing.
        """
        known = (e for e in self._first("defects", formulation, case) if outcome in e["outcomes"])
        return next(known, {"why": ""})["why"]


def order(name: str) -> tuple:
    """S before M, and 9 before 10."""
    return "SM".find(name[0]), int(name[1:])


def ids(folder: Path = FOLDER) -> list[str]:
    names = (path.stem for path in folder.glob("*.json"))
    return sorted((name for name in names if re.fullmatch(r"[SM]\d\d", name)), key=order)


def left_out(folder: Path = FOLDER) -> dict[str, str]:
    """Proposed tests that are not here, and why."""
    found = read_of_schema(folder / "left_out.json", "barrierbench.stress_left_out/1")
    return {name: why for name, why in found.items() if name != "schema"}


def _cases(axes: list[dict]) -> tuple[Variant, ...]:
    """Every combination of one entry of each axis; axes are written as in a sweep, by cases."""
    out = [Variant("", {})]
    for axis in axes:
        out = [
            Variant(
                f"{one.label} {entry['label']}".strip(),
                {**one.set, **entry.get("set", {})},
                (*one.needs, *entry.get("needs", ())),
            )
            for one in out
            for entry in axis["cases"]
        ]
    return tuple(Variant(one.label or ONE, one.set, one.needs) for one in out)


def _formulations(data: dict, path: Path) -> tuple[tuple[Formulation, ...], dict]:
    """The comparable ones with what the test adds to them, or the test's own."""
    choice = data.get("formulations", {})
    if "own" in choice:
        return tuple(Formulation(f["label"], f["set"], f.get("by_case", {})) for f in choice["own"]), {}
    common = read_of_schema(path.parent / "formulations.json", "barrierbench.stress_formulations/1")
    add, labels = choice.get("add", {}), [f["label"] for f in common["comparable"]]
    if unknown := sorted(set(add) - set(labels)):
        raise refused(path, "formulations/add", unknown[0], f"one of {', '.join(labels)}")
    made = (Formulation(f["label"], {**f["set"], **add.get(f["label"], {})}) for f in common["comparable"])
    return tuple(made), common["groups"]


def _check(test: Test) -> None:
    """What its schema cannot say."""
    labels = [case.label for case in test.cases]
    if len(set(labels)) < len(labels):
        raise refused(test.path, "axes", labels, "another label for each case")
    for k, entry in enumerate(test.data["expect"]):
        if wrong := [word for word in entry["outcomes"] if word not in (*OUTCOMES, NAMED)]:
            words = ", ".join((*OUTCOMES, NAMED))
            raise refused(test.path, f"expect/{k}/outcomes", wrong[0], f"one of {words}")
        for pattern in entry.get("cases", []):
            if not any(fnmatchcase(label, pattern) for label in labels):
                raise refused(test.path, f"expect/{k}/cases", pattern, f"one of {', '.join(labels)}")
    for k, entry in enumerate(test.data.get("relations", [])):
        for label in (label for group in entry.get("groups", []) for label in group):
            if label not in labels:
                raise refused(test.path, f"relations/{k}/groups", label, f"one of {', '.join(labels)}")
    for formulation in test.formulations:
        for case in test.cases:
            test.expected(formulation.label, case.label)


def read_test(name: str, folder: Path = FOLDER, full: bool = False) -> Test:
    """full: with the larger axes of its key `full`. Errors: UserError: an unknown id or key, a formulation in
    a case of which nothing is expected.
    """
    path = folder / f"{name}.json"
    if not path.is_file():
        raise UserError(f"stress test: found {name!r}; allowed: {', '.join(ids(folder))}")
    data = read_spec(path, "stress")
    if data["id"] != name:
        raise refused(path, "id", data["id"], "the name of the file")
    if "geometry" in data:
        if both := [key for key in RUNS if key in data]:
            raise UserError(f"{path}#/{both[0]}: a test of geometry runs no scene")
        return Test(path, data)
    require_base(data, path)
    if full and "full" in data:
        more = data["full"]
        data = {**data, "axes": more["axes"], "set": {**data.get("set", {}), **more.get("set", {})}}
        # expectations of cases by name hold of those that are left
        labels = [case.label for case in _cases(data["axes"])]
        data["expect"] = [
            entry
            for entry in data["expect"]
            if "cases" not in entry
            or any(fnmatchcase(label, pattern) for label in labels for pattern in entry["cases"])
        ]
    test = Test(path, data, _cases(data.get("axes", [])), *_formulations(data, path))
    _check(test)
    return test
