"""A study as its spec has it, and the cells that it asks for."""

import importlib
import itertools
import json
import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from types import ModuleType

from barrierbench_analysis.io import fields
from barrierbench_analysis.io.digests import of_text
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.spec_file import checked, read_spec, refused, require_base
from barrierbench_analysis.studies.kit import runs
from barrierbench_analysis.studies.kit.metrics import METRICS

FOLDER = ROOT / "configs" / "studies"
ABOUT = ROOT / "configs" / "schema" / "about"  # RULE.schema.json: what the key `about` of its specs holds
RULES = "barrierbench_analysis.studies.rules"
SEED, SEED_POINTER = "seed", "/seeds/main"
KEY_DIGITS = 24


@dataclass(frozen=True)
class Case:
    """A run that the rule of a study asks for, in place of a combination of axes. place: the label of every
    axis. base: another config than that of the spec. unknowns: where the rule knows them before the run.
    against: what the measured values depend on beside the run; another one makes another cell.
    """

    place: dict[str, str]
    settings: dict
    base: Path | None = None
    unknowns: int | None = None
    against: dict = field(default_factory=dict)


@dataclass(frozen=True)
class Cell:
    """One run that a study asks for. key: hash of all that the run is made of but the program, the content
    of files included, of a film that of its first frame; two cells with one key are one run.
    """

    place: dict[str, str]
    settings: dict
    key: str
    base: Path
    unknowns: int | None = None

    @property
    def label(self) -> str:
        return " ".join(self.place.values())


@dataclass(frozen=True)
class Study:
    """A spec that has been read. Places are names of axes, and `seed`. out: the folder of its runs, rows,
    page and figures where a call names one. more_plugins: shared libraries that a call names.
    """

    file: Path
    data: dict
    out: Path | None = None
    more_plugins: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        return self.data["name"]

    @property
    def about(self) -> dict:
        return self.data.get("about", {})

    @property
    def base(self) -> Path:
        return self.file.parent / self.data["base"]

    @property
    def plugins(self) -> list[str]:
        """Shared libraries that every run loads: of the spec, whose paths begin in its folder, and of the
        call."""
        own = [str((self.file.parent / name).resolve()) for name in self.data.get("plugins", [])]
        return [*own, *self.more_plugins]

    @property
    def is_ours(self) -> bool:
        """Whether rows and page are kept with the results of this tree."""
        return self.out is None and self.file.parent.resolve() == FOLDER

    def beside(self, suffix: str) -> Path:
        """A file of a study whose results are not kept in this tree: in `out`, or beside its spec."""
        return (self.out or self.file.parent) / f"{self.file.stem}{suffix}"

    @property
    def page(self) -> Path:
        return ROOT / self.data["page"] if self.is_ours else self.beside(".page.md")

    @property
    def template(self) -> Path:
        """That of the rule, which a spec of one's own may have beside it."""
        own = self.file.with_suffix(".md")
        return own if self.is_ours or own.is_file() else FOLDER / f"{self.rule}.md"

    @property
    def figures(self) -> Path:
        """The folder of the pictures that the page shows."""
        return ROOT / "docs" if self.is_ours else self.out or self.file.parent

    @property
    def command(self) -> str:
        is_named = self.file.parent.resolve() == FOLDER
        return f"./bench study {self.name.replace('_', '-') if is_named else self.file}"

    def call(self, mode: str) -> str:
        """The command of a mode, with what names another folder or more plugins."""
        more = "".join(f" --plugin {plugin}" for plugin in self.more_plugins)
        return f"{self.command} {mode}" + (f" --out {self.out}" if self.out else "") + more

    @property
    def rule(self) -> str:
        return self.data.get("rule", self.name)

    @cached_property
    def module(self) -> ModuleType:
        """The rule: studies/rules/RULE. Errors: UserError where there is none, or where `about` is not what
        it reads (its schema)."""
        try:
            found = importlib.import_module(f"{RULES}.{self.rule}")
        except ModuleNotFoundError as fault:
            if fault.name != f"{RULES}.{self.rule}":
                raise
            raise UserError(
                f"{self.file}#/rule: found {self.rule!r}; allowed: a study whose rule is"
                f" analysis/src/barrierbench_analysis/studies/rules/{self.rule}.py"
            ) from None
        if (ABOUT / f"{self.rule}.schema.json").is_file():
            checked(self.about, self.file, f"about/{self.rule}", "about")
        elif self.about:
            raise refused(
                self.file, "about", self.about, f"nothing, since the rule {self.rule!r} reads none,"
            )
        return found

    @cached_property
    def cells(self) -> list[Cell]:
        """What the rule asks for (its function `cells`), or the product of all axes and seeds, the last axis
        fastest. Errors: UserError for two cells that are one run, and what the rule refuses.
        """
        asked = getattr(self.module, "cells", product)(self)
        found = [self.cell(case) for case in asked]
        counts = Counter(cell.key for cell in found)
        if twice := next((cell for cell in found if counts[cell.key] > 1), None):
            raise refused(self.file, "axes", twice.label, "another run for each combination of cases")
        return found

    @cached_property
    def names(self) -> list[str]:
        """Of the axes."""
        return list(self.cells[0].place) if self.cells else []

    @cached_property
    def _of_bases(self) -> dict[Path, tuple[Path, bytes]]:
        """Base config -> the folder that its paths begin in, and the hashes of the files of it and of `set`,
        as they are read."""
        return {}

    def cell(self, case: Case) -> Cell:
        """A case as a cell, with its key."""
        base, common = case.base or self.base, self.data.get("set", {})
        if base not in self._of_bases:
            whole = base.resolve()
            files = runs.inputs({"base": str(whole), "set": common}, whole.parent)
            self._of_bases[base] = whole.parent, files + runs.contents(self.plugins)
        folder, of_base = self._of_bases[base]
        files = runs.inputs({"set": case.settings}, folder) + of_base
        content = {"set": common, "cell": case.settings, "files": sha256(files).hexdigest()}
        content |= {"against": case.against} if case.against else {}
        key = of_text(json.dumps(content, sort_keys=True))[:KEY_DIGITS]
        return Cell(case.place, case.settings, key, base, case.unknowns)


def product(study: Study) -> Iterable[Case]:
    """The combinations of the cases of all axes and of the seeds, the last axis fastest. Errors: UserError
    for a label with another number of words than its axis has names, or an axis that is there twice.
    """
    axes = [
        [(_place(study.file, k, axis["names"], case["label"]), case["set"]) for case in axis["cases"]]
        for k, axis in enumerate(study.data["axes"])
    ]
    axes.append([({SEED: str(seed)}, {SEED_POINTER: seed}) for seed in study.data["seeds"]])
    names = [name for axis in study.data["axes"] for name in axis["names"]] + [SEED]
    if len(set(names)) < len(names):
        raise refused(study.file, "axes", names, "another name for each axis, none of them 'seed',")
    for chosen in itertools.product(*axes):
        place = {name: word for labels, _ in chosen for name, word in labels.items()}
        yield Case(place, {pointer: value for _, of in chosen for pointer, value in of.items()})


def _place(file: Path, number: int, names: list[str], label: str) -> dict[str, str]:
    words = label.split()
    if len(names) != len(words):
        raise refused(file, f"axes/{number}/cases/label", label, f"a word for each of {', '.join(names)}")
    return dict(zip(names, words))


def parts_of(pointer: str) -> list[str]:
    """The keys of a JSON pointer (RFC 6901)."""
    return [part.replace("~1", "/").replace("~0", "~") for part in pointer.strip("/").split("/")]


def _is_of_record(pointer: str) -> bool:
    """Whether records have a field at the pointer, by their schema; the keys of a map are not known there."""
    schema = fields.schema("run")
    node = schema
    for part in parts_of(pointer):
        while "$ref" in node:
            node = schema["$defs"][node["$ref"].rsplit("/", 1)[1]]
        if "items" in node and re.fullmatch(r"-1|\d+", part):
            node = node["items"]
        elif part in node.get("properties", {}):
            node = node["properties"][part]
        elif isinstance(node.get("additionalProperties"), dict):
            node = node["additionalProperties"]
        elif node.get("properties") or "items" in node:
            return False
        else:
            return True  # a part of the schema that says no more
    return True


def read_study(name: str, out: Path | None = None, plugins: Iterable[str] = ()) -> Study:
    """The study of a name, or of the path of a spec. out, plugins: of a call (Study). Errors: UserError, with
    the names of what there is.
    """
    file = Path(name) if name.endswith(".json") else FOLDER / f"{name}.json"
    if not file.is_file():
        raise UserError(f"study: found {name!r}; allowed: {', '.join(known())}, or the path of a spec")
    data = read_spec(file, "study")
    require_base(data, file)
    for metric, source in data["metrics"].items():
        if not source.startswith("/") and source not in METRICS:
            raise refused(file, f"metrics/{metric}", source, f"a pointer, or one of {', '.join(METRICS)},")
        if source.startswith("/") and not _is_of_record(source):
            raise refused(
                file, f"metrics/{metric}", source, "the pointer of a field of records (./bench help record)"
            )
    if data["name"] != file.stem:
        raise refused(file, "name", data["name"], f"{file.stem!r}, as its file is called,")
    study = Study(file, data, out, tuple(plugins))
    if not hasattr(study.module, "cells") and not {"axes", "seeds"} <= data.keys():
        raise refused(file, "axes", data.get("axes"), "axes and seeds, since the rule makes no cells,")
    return study


def known() -> list[str]:
    """The names of the studies of this tree."""
    return sorted(path.stem for path in FOLDER.glob("*.json"))
