"""The factors of a factorial sweep, their levels, and the combinations that it allows."""

from dataclasses import dataclass
from functools import cached_property
from itertools import product
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_of_schema
from barrierbench_analysis.io.spec_file import refused
from barrierbench_analysis.studies.kit.study.spec import Study
from barrierbench_analysis.studies.kit.study.store import Row

Combination = tuple[int, ...]  # one level a factor, without the scene


@dataclass(frozen=True)
class Factor:
    """levels: label -> what it sets. The first one is the reference."""

    name: str
    levels: dict[str, dict]

    @property
    def labels(self) -> list[str]:
        return list(self.levels)


@dataclass(frozen=True)
class Factorial:
    """A sweep, and what the spec of the study says of it. scenes is the first axis, factors are the others,
    in the order of the file.
    """

    path: Path  # of the spec
    about: dict
    sweep: dict
    scenes: Factor
    factors: tuple[Factor, ...]

    @property
    def sizes(self) -> tuple[int, ...]:
        return tuple(len(factor.levels) for factor in self.factors)

    def labels_of(self, one: Combination) -> list[str]:
        return [factor.labels[level] for factor, level in zip(self.factors, one, strict=True)]

    def levels_of(self, row: Row) -> Combination:
        return tuple(factor.labels.index(row.place[factor.name]) for factor in self.factors)

    @cached_property
    def allowed(self) -> tuple[Combination, ...]:
        """All combinations that no exclusion names, the last factor fastest."""
        barred = [set(entry["labels"]) for entry in self.sweep.get("exclude", [])]
        every = product(*(range(n) for n in self.sizes))
        return tuple(one for one in every if not any(names <= set(self.labels_of(one)) for names in barred))

    def settings_of(self, scene: str, one: Combination) -> dict:
        """Pointers that a combination sets in a scene, later axes over earlier ones."""
        out = self.sweep["set"] | self.scenes.levels[scene]
        for factor, label in zip(self.factors, self.labels_of(one), strict=True):
            out |= factor.levels[label]
        return out


def _axis(path: Path, k: int, name: str, axis: dict) -> Factor:
    if "cases" not in axis:
        raise UserError(f"{path}#/axes/{k}: found {', '.join(axis)}; allowed: an axis of cases")
    return Factor(name, {case["label"]: case["set"] for case in axis["cases"]})


def read_factorial(study: Study) -> Factorial:
    """Errors: UserError with file and place: another schema or base, an axis without cases, counts that do
    not agree, exclusions by pointers, a label in two axes.
    """
    about, path = study.about, study.file
    file = (path.parent / about["sweep"]).resolve()
    sweep = read_of_schema(file, "barrierbench.sweep/1")
    if (file.parent / sweep["base"]).resolve() != study.base.resolve():
        raise refused(path, "base", study.data["base"], f"the base of {file}, {sweep['base']},")
    names, excluded = about["factors"], sweep.get("exclude", [])
    if len(names) != len(sweep["axes"]):
        raise UserError(f"{path}#/about/factors: {len(names)} names for {len(sweep['axes'])} axes of {file}")
    if len(about["excluded"]) != len(excluded):
        raise UserError(
            f"{path}#/about/excluded: {len(about['excluded'])} reasons for {len(excluded)} exclusions of"
            f" {file}"
        )
    for k, entry in enumerate(excluded):
        if set(entry) != {"labels"}:
            raise UserError(f"{file}#/exclude/{k}: found {', '.join(entry)}; allowed: labels alone")
    axes = [_axis(file, k, name, axis) for k, (name, axis) in enumerate(zip(names, sweep["axes"]))]
    labels = [label for axis in axes for label in axis.levels]
    if twice := next((label for label in labels if labels.count(label) > 1), None):
        raise UserError(f"{file}: label {twice!r} in two places; allowed: each label once")
    return Factorial(path, about, sweep, axes[0], tuple(axes[1:]))
