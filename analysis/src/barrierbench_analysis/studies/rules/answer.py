"""Which barrier to use: four formulations in scenes that no rule was tuned on, with what was calibrated
once a scene kept while its material, mass and speed change.

A scene is one sample. Of each formulation: how many runs end `ok`; the share of scenes in which all do,
with Wilson's interval; the smallest gap of those runs, geometric mean over scenes of the least of a scene;
Newton iterations, matrix products and seconds over those of the fixed log in the same runs, geometric mean
over scenes with Student's interval. All intervals are at 95%. Only runs in which both formulations end `ok`
enter a ratio.
"""

import math
from collections import defaultdict
from dataclasses import dataclass

from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.studies.kit.study.spec import Study
from barrierbench_analysis.studies.kit.study.store import Row, timed_alike
from barrierbench_analysis.tables.answer import when_to_use
from barrierbench_analysis.tables.estimate import Cells, wilson
from barrierbench_analysis.tables.numbers import written
from barrierbench_analysis.tables.outcomes import OK
from barrierbench_analysis.tables.statistics import Ratio, ratio_of_scenes

RATIOS = ("newton", "products", "seconds")
HEAD = (
    "formulation",
    "runs that end ok",
    "scenes in which all do (95%)",
    "smallest gap / d_hat",
    "Newton",
    "matrix products",
    "seconds",
)


def _run(row: Row) -> tuple[str, str, str]:
    return row.place["scene"], row.place["level"], row.place["seed"]


@dataclass(frozen=True)
class Ends:
    """How runs end: those that end ok of all, and the scenes in which all do of all."""

    ok: int
    runs: int
    whole: int
    scenes: int

    @property
    def cells(self) -> list[str]:
        low, high = wilson(self.whole, self.scenes)
        return [f"{self.ok} of {self.runs}", f"{self.whole} of {self.scenes} ({low:.2f} to {high:.2f})"]


def _ends(rows: list[Row]) -> Ends:
    ok: dict[str, list[bool]] = defaultdict(list)
    for row in rows:
        ok[row.place["scene"]].append(row.outcome == OK)
    whole = sum(map(all, ok.values()))
    return Ends(sum(map(sum, ok.values())), len(rows), whole, len(ok))


def _gaps(rows: list[Row]) -> Ratio | None:
    least: dict[str, float] = {}
    for row in rows:
        if row.outcome == OK and (gap := row.values["gap_min"]) is not None:
            least[row.place["scene"]] = min(gap, least.get(row.place["scene"], math.inf))
    return ratio_of_scenes({scene: {"least": [math.log(gap)]} for scene, gap in least.items()})


def _ratio(rows: list[Row], reference: dict[tuple, Row], metric: str) -> Ratio | None:
    cells: Cells = defaultdict(lambda: defaultdict(list))
    for row in rows:
        other = reference.get(_run(row))
        if other is None or row.outcome != OK or other.outcome != OK:
            continue
        if metric == "seconds" and not timed_alike([row, other]):
            continue
        over, under = row.values[metric], other.values[metric]
        if over and under:
            cells[row.place["scene"]][row.place["level"]].append(math.log(over / under))
    return ratio_of_scenes(cells)


def compared(rows: list[Row], study: Study) -> dict[str, dict]:
    """formulation -> its numbers, in the order of the rows, which are of the levels that are compared."""
    names = list(dict.fromkeys(row.place["formulation"] for row in rows))
    of = {name: [row for row in rows if row.place["formulation"] == name] for name in names}
    reference = {_run(row): row for row in of[study.about["reference"]]}
    return {
        name: {"ends": _ends(mine), "gap": _gaps(mine)}
        | {metric: _ratio(mine, reference, metric) for metric in RATIOS}
        for name, mine in of.items()
    }


def table(found: dict[str, dict], study: Study) -> list[str]:
    """Markdown: one row a formulation. Ratios of the reference are 1 by definition."""
    words, reference = study.about["names"], study.about["reference"]

    def cells(name: str) -> list[str]:
        numbers = found[name]
        ratios = ["1" if name == reference else written(numbers[metric]) for metric in RATIOS]
        return [words[name], *numbers["ends"].cells, written(numbers["gap"]), *ratios]

    return markdown([*HEAD, "when to use"], [[*cells(name), when_to_use(words[name])] for name in found])


def _pairs(rows: list[Row], study: Study) -> str:
    """In how many runs of how many scenes both the reference and each other formulation end ok."""
    words, reference = study.about["names"], study.about["reference"]
    good = {(row.place["formulation"], _run(row)) for row in rows if row.outcome == OK}
    found = []
    for name, word in words.items():
        both = [run for of, run in good if of == name and (reference, run) in good]
        if name != reference:
            found.append(f"{word} {len(both)} runs of {len({scene for scene, *_ in both})} scenes")
    return ", ".join(found)


def _ended(rows: list[Row], study: Study) -> list[str]:
    """Markdown: which outcomes the runs of each formulation have."""
    words = study.about["names"]
    counts: dict[tuple[str, str], dict[str, int]] = defaultdict(lambda: defaultdict(int))
    for row in rows:
        counts[words[row.place["formulation"]], row.outcome][row.place["level"]] += 1
    body = [
        [name, outcome, f"{sum(levels.values())}", ", ".join(f"{k}: {n}" for k, n in levels.items())]
        for (name, outcome), levels in sorted(counts.items())
    ]
    return markdown(["formulation", "outcome", "runs", "of which"], body)


def rule(study: Study, rows: list[Row]) -> dict:
    """The numbers of the page and of README."""
    large = set(study.about["large"])
    small_rows = [row for row in rows if row.place["level"] not in large]
    large_rows = [row for row in rows if row.place["level"] in large]
    small, finer = compared(small_rows, study), compared(large_rows, study)

    def sizes(of: list[Row]) -> str:
        return f"{min(row.unknowns for row in of)} to {max(row.unknowns for row in of)}"

    return {
        "table": "\n".join(table(small, study)),
        "table_large": "\n".join(table(finer, study)),
        "pairs": _pairs(small_rows, study),
        "pairs_large": _pairs(large_rows, study),
        "ended": "\n".join(_ended(rows, study)),
        "scenes": len({row.place["scene"] for row in rows}),
        "levels": ", ".join(dict.fromkeys(row.place["level"] for row in small_rows)),
        "runs_each": len(small_rows) // len(small),
        "sizes": sizes(small_rows),
        "sizes_large": sizes(large_rows),
    }
