"""A study as its spec has it, and the cells that it asks for."""

from __future__ import annotations

import itertools
import json
from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from barrierbench_analysis.io.digests import of_text
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.spec_file import read_spec, refused, require_base
from barrierbench_analysis.studies.kit import runs
from barrierbench_analysis.studies.kit.metrics import METRICS

FOLDER = ROOT / "configs" / "studies"
SEED, SEED_POINTER = "seed", "/seeds/main"


@dataclass(frozen=True)
class Cell:
    """One run that a study asks for. place: the label of every axis. key: hash of all that the run is made
    of but the program, the content of files included, of a film that of its first frame; two cells with one
    key are one run.
    """

    place: dict[str, str]
    settings: dict
    key: str

    @property
    def label(self) -> str:
        return " ".join(self.place.values())


@dataclass(frozen=True)
class Study:
    """A spec that has been read. Places are names of axes, and `seed`."""

    file: Path
    data: dict

    @property
    def name(self) -> str:
        return self.data["name"]

    @property
    def base(self) -> Path:
        return self.file.parent / self.data["base"]

    @property
    def is_ours(self) -> bool:
        """Whether the spec is one of this tree, whose rows and page are kept with its results."""
        return self.file.parent.resolve() == FOLDER

    @property
    def page(self) -> Path:
        return ROOT / self.data["page"] if self.is_ours else self.file.with_suffix(".page.md")

    @property
    def template(self) -> Path:
        return self.file.with_suffix(".md")

    @property
    def names(self) -> list[str]:
        return [name for axis in self.data["axes"] for name in axis["names"]] + [SEED]

    @cached_property
    def cells(self) -> list[Cell]:
        """The product of all axes and seeds, the last axis fastest. Errors: UserError for a label with
        another number of words than its axis has names, or two cells that are one run.
        """
        axes = [
            [(_place(self.file, k, axis["names"], case["label"]), case["set"]) for case in axis["cases"]]
            for k, axis in enumerate(self.data["axes"])
        ]
        axes.append([({SEED: str(seed)}, {SEED_POINTER: seed}) for seed in self.data["seeds"]])
        found = [self._cell(chosen) for chosen in itertools.product(*axes)]
        counts = Counter(cell.key for cell in found)
        if twice := next((cell for cell in found if counts[cell.key] > 1), None):
            raise refused(self.file, "axes", twice.label, "another run for each combination of cases")
        return found

    def _cell(self, chosen: tuple[tuple[dict, dict], ...]) -> Cell:
        place = {name: word for labels, _ in chosen for name, word in labels.items()}
        settings = {pointer: value for _, of in chosen for pointer, value in of.items()}
        made = runs.sweep(
            self.name, self.base, self.data.get("set", {}), [{"label": "cell", "set": settings}]
        )
        content = {"set": self.data.get("set", {}), "cell": settings, "files": runs.inputs_sha256(made)}
        return Cell(place, settings, of_text(json.dumps(content, sort_keys=True))[:24])


def _place(file: Path, number: int, names: list[str], label: str) -> dict[str, str]:
    words = label.split()
    if len(names) != len(words):
        raise refused(file, f"axes/{number}/cases/label", label, f"a word for each of {', '.join(names)}")
    return dict(zip(names, words))


def read_study(name: str) -> Study:
    """The study of a name, or of the path of a spec. Errors: UserError, with the names of what there is."""
    file = Path(name) if name.endswith(".json") else FOLDER / f"{name}.json"
    if not file.is_file():
        raise UserError(f"study: found {name!r}; allowed: {', '.join(known())}, or the path of a spec")
    data = read_spec(file, "study")
    require_base(data, file)
    for metric, source in data["metrics"].items():
        if not source.startswith("/") and source not in METRICS:
            raise refused(file, f"metrics/{metric}", source, f"a pointer, or one of {', '.join(METRICS)},")
    if data["name"] != file.stem:
        raise refused(file, "name", data["name"], f"{file.stem!r}, as its file is called,")
    study = Study(file, data)
    if len(set(study.names)) < len(study.names):
        raise refused(file, "axes", study.names, "another name for each axis, none of them 'seed',")
    return study


def known() -> list[str]:
    """The names of the studies of this tree."""
    return sorted(path.stem for path in FOLDER.glob("*.json"))
