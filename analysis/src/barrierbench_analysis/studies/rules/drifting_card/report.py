"""The numbers of the page: means over placements with their intervals, and how combinations ended."""

import math
from collections import Counter, defaultdict
from dataclasses import dataclass

from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.studies.kit import formulations
from barrierbench_analysis.studies.kit.study.spec import Study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.tables.numbers import significant, written
from barrierbench_analysis.tables.outcomes import OK
from barrierbench_analysis.tables.statistics import Mean, Ratio, mean_over, ratio_of_scenes
from barrierbench_analysis.tables.words import counted, listed

from . import arms
from .arms import ALL_PAIRS, PLANE, Arm
from .matched import MATCH

# value -> its unit on the page, and the factor to it
METRICS = {
    "drift_m": ("drift, mm", 1e3),
    "tangential_J": ("kinetic energy along the table, nJ", 1e9),
    "pull": ("tangential over normal force, 1e-3", 1e3),
}
NOT_RUN = "not run"
FAR = 0.06  # of d_hat, of a mean gap from that of the spec


@dataclass(frozen=True)
class Found:
    """The rows of an arm: those of its placements, and those that match its stiffness."""

    placements: list[Row]
    searched: list[Row]

    @property
    def ended(self) -> list[Row]:
        return [row for row in self.placements if row.outcome == OK]

    def mean(self, value: str) -> Mean | None:
        """Over the placements that end."""
        found = [row.values[value] for row in self.ended]
        return mean_over(found) if found else None

    @property
    def is_without_run(self) -> bool:
        return self.mean("gap") is None and self.outcomes() == NOT_RUN

    def outcomes(self) -> str:
        """How the runs ended, where no placement has a number."""
        if self.placements:
            counts = Counter(row.outcome for row in self.placements)
            return ", ".join(f"{word} {n}" for word, n in counts.items())
        last = self.searched[-1].outcome if self.searched else OK
        return NOT_RUN if last == OK else last

    def cell(self, value: str) -> str:
        factor = METRICS[value][1]
        if (mean := self.mean(value)) is None:
            return self.outcomes()
        ends = (None if end is None else end * factor for end in (mean.lower, mean.upper))
        text = written(Mean(mean.value * factor, *ends, mean.scenes))
        lost = len(self.placements) - mean.scenes
        return f"{text} ({mean.scenes} of {mean.scenes + lost})" if lost else text


def gathered(study: Study, rows: list[Row]) -> dict[Arm, Found]:
    """Of every arm of the study, those without a row among them."""
    found = {arm: Found([], []) for arm in arms.arms(study)}
    for row in rows:
        arm = Arm(*(row.place[name] for name in ("formulation", "model", "level")))
        is_search = row.place["placement"].startswith(MATCH)
        (found[arm].searched if is_search else found[arm].placements).append(row)
    return found


def _table(study: Study, found: dict[Arm, Found], model: str, value: str) -> str:
    """A line for each formulation that has a run, a column for each table."""
    levels = [*study.about["tables"]]
    body = [
        [name, *(found[Arm(name, model, one)].cell(value) for one in levels)]
        for name in arms.compared()
        if any(not found[one].is_without_run for k in levels if (one := Arm(name, model, k)) in found)
    ]
    return "\n".join(markdown([METRICS[value][0], *levels], body))


def _plane(found: dict[Arm, Found]) -> str:
    names = [name for name in arms.compared() if not found[Arm(name, PLANE, PLANE)].is_without_run]
    body = [[name, *(found[Arm(name, PLANE, PLANE)].cell(value) for value in METRICS)] for name in names]
    return "\n".join(markdown([PLANE, *(title for title, _ in METRICS.values())], body))


def _lacking(found: dict[Arm, Found], model: str) -> str:
    """Formulations of a model of which some table has no run."""
    names = dict.fromkeys(
        arm.formulation for arm, one in found.items() if arm.model == model and one.is_without_run
    )
    return f"`{model}`: {', '.join(names)}" if names else ""


def _failed(found: dict[Arm, Found], model: str) -> str:
    """Outcomes of the placements of a model that do not end well."""
    rows = [row for arm, one in found.items() if arm.model == model for row in one.placements]
    counts = Counter(row.outcome for row in rows if row.outcome != OK)
    words = listed([f"{word} {n}" for word, n in counts.items()])
    return f"`{model}`: {words}, of {len(rows)}" if counts else ""


def _ratio(found: dict[Arm, Found], model: str, level: str) -> Ratio | None:
    """Drift of a model over that of all pairs: geometric mean over formulations of each placement that ends
    in both, and over placements, which are the samples.
    """
    logs: dict[str, dict[str, list[float]]] = defaultdict(dict)
    for name in arms.compared():
        pair = [found.get(Arm(name, one, level)) for one in (model, ALL_PAIRS)]
        if all(pair):
            drifts = [{row.place["placement"]: row.values["drift_m"] for row in one.ended} for one in pair]
            for placement in drifts[0].keys() & drifts[1].keys():
                logs[placement][name] = [math.log(drifts[0][placement] / drifts[1][placement])]
    return ratio_of_scenes({placement: logs[placement] for placement in sorted(logs)})


def _beside_all_pairs(study: Study, found: dict[Arm, Found], model: str) -> str:
    """A computed sentence: drift of a model over that of all pairs, for each table."""
    ratios = {level: _ratio(found, model, level) for level in study.about["tables"]}
    said = [
        f"{ratio} on {level} ({counted(ratio.scenes, 'placement')})"
        for level, ratio in ratios.items()
        if ratio
    ]
    return f"`{model}` drifts {listed(said)} times as far as `{ALL_PAIRS}`." if said else ""


def _border(study: Study, found: dict[Arm, Found], model: str) -> str:
    """The share of rows at borders of triangles over all formulations, for each table."""
    said = []
    for level in study.about["tables"]:
        of = [row.values["border"] for arm, one in found.items() for row in one.ended
              if (arm.model, arm.level) == (model, level)]  # fmt: skip
        if of:
            said.append(f"{significant(100 * sum(of) / len(of), 2)} % on {level}")
    return f"`{model}`: {listed(said)}" if said else ""


def _gaps(found: dict[Arm, Found], model: str) -> str:
    gaps = [one.mean("gap").value for arm, one in found.items() if arm.model == model and one.ended]
    return f"`{model}` {min(gaps):.3f} to {max(gaps):.3f}" if gaps else ""


def _unmatched(study: Study, found: dict[Arm, Found]) -> list[str]:
    """A table of the arms whose mean gap is farther than FAR from the wanted one; empty without any."""
    body = [
        [arm.formulation, arm.model, arm.level, f"{mean.value:.3f}"]
        for arm, one in found.items()
        if (mean := one.mean("gap")) and abs(mean.value - study.about["theta"]) > FAR
    ]
    return markdown(["formulation", "contact", "level", "mean gap / d_hat"], body) if body else []


def _same_as(names: list[str]) -> list[str]:
    """Presets that are left out, since matching makes them another one."""
    return [name for name in formulations.known() if name not in names]


def rule(study: Study, rows: list[Row]) -> dict:
    found, models = gathered(study, rows), arms.models()
    ended = [row for one in found.values() for row in one.placements]
    refused = {row.values["detail"] for row in rows if row.outcome == "refused"}
    return {
        "tables": {
            model: {value: _table(study, found, model, value) for value in METRICS} for model in models
        },
        "plane": _plane(found),
        "beside": [line for one in models[1:] if (line := _beside_all_pairs(study, found, one))],
        "borders": [line for one in models if (line := _border(study, found, one))],
        "gaps": listed([line for one in [*models, PLANE] if (line := _gaps(found, one))]),
        "unmatched": _unmatched(study, found),
        "far": f"{FAR:g}",
        "theta": f"{study.about['theta']:g}",
        "placements": study.about["placements"],
        "formulations": len(arms.compared()),
        "left_out": listed([f"`{name}`" for name in _same_as(arms.compared())]),
        "runs": len(ended),
        "failed": sum(row.outcome != OK for row in ended),
        "refused": sorted(text.partition(": ")[2] or text for text in refused),
        "failures": [line for one in [*models, PLANE] if (line := _failed(found, one))],
        "lacking": [line for one in [*models, PLANE] if (line := _lacking(found, one))],
        "once": study.about["once"],
        "minutes": f"{sum(row.seconds for row in rows) / 60:.0f}",
    }
