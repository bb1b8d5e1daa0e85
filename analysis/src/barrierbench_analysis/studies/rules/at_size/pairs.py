"""The same run under two formulations, a pair a scene."""

import math
from dataclasses import dataclass

from barrierbench_analysis.studies.kit.study.spec import Study
from barrierbench_analysis.studies.kit.study.store import Row, timed_alike
from barrierbench_analysis.tables.outcomes import OK
from barrierbench_analysis.tables.statistics import Ratio, ratio_over

LOG, CUBIC = "log", "cubic"
FINE, COARSE = "M", "S"  # the sizes that questions name
THETA = "0.01"  # the gap that questions name, in d_hat


@dataclass(frozen=True)
class Where:
    """Labels of the runs that are put beside each other; of all of them but scene and arm."""

    size: str = FINE
    theta: str = THETA
    setting: str = "base"
    measure: str = "diagnosed"

    def holds(self, row: Row) -> bool:
        return all(row.place[name] == label for name, label in self.__dict__.items())


def mean_ratio(logs: dict[str, float]) -> Ratio | None:
    """logs: scene -> logarithm of a ratio. None without a scene."""
    return ratio_over(list(logs.values())) if logs else None


class Rows:
    """The rows of a study, found by their labels."""

    def __init__(self, study: Study, rows: list[Row]):
        self.scenes = {scene["label"]: scene for scene in study.about["scenes"]}
        self.rows = rows

    def of(self, arm: str, where: Where) -> dict[str, Row]:
        """scene -> its run."""
        return {r.place["scene"]: r for r in self.rows if r.place["arm"] == arm and where.holds(r)}

    def kind(self, *kinds: str) -> set[str]:
        """Scenes whose bodies are of these kinds: shell, rod, solid."""
        return {label for label, scene in self.scenes.items() if scene["kind"] in kinds}

    def _both(self, where: Where, over: str, under: str, beside: Where | None) -> dict[str, tuple[Row, Row]]:
        first, second = self.of(over, where), self.of(under, beside or where)
        return {scene: (first[scene], second[scene]) for scene in first if scene in second}

    def pairs(
        self, where: Where, over: str = LOG, under: str = CUBIC, beside: Where | None = None
    ) -> dict[str, tuple[Row, Row]]:
        """scene -> both runs, where both end ok. beside: labels of the second one where they differ."""
        both = self._both(where, over, under, beside)
        return {s: two for s, two in both.items() if all(row.outcome == OK for row in two)}

    def dropped(self, where: Where, over: str = LOG, under: str = CUBIC) -> dict[str, str]:
        """scene -> which of its two runs did not end ok, and how: it is in no ratio."""
        return {
            scene: ", ".join(f"{row.place['arm']} {row.outcome}" for row in two if row.outcome != OK)
            for scene, two in self._both(where, over, under, None).items()
            if any(row.outcome != OK for row in two)
        }

    def logs(
        self,
        metric: str,
        where: Where,
        over: str = LOG,
        under: str = CUBIC,
        beside: Where | None = None,
    ) -> dict[str, float]:
        """scene -> logarithm of the ratio, where both runs have a value above 0. Seconds of two machines or
        builds are in no ratio."""
        found = {}
        for scene, two in self.pairs(where, over, under, beside).items():
            above, below = (row.values[metric] for row in two)
            if metric.endswith("seconds") and not timed_alike(list(two)):
                continue
            if above and below:
                found[scene] = math.log(above / below)
        return found

    def ratio(
        self, metric: str, where: Where, over: str = LOG, under: str = CUBIC, beside: Where | None = None
    ) -> Ratio | None:
        """The mean of these over scenes; None without one."""
        return mean_ratio(self.logs(metric, where, over, under, beside))

    def rises(self, metric: str, first: Where, second: Where) -> dict[str, float]:
        """scene -> logarithm of the ratio log/cubic at the second place over that at the first."""
        before, after = self.logs(metric, first), self.logs(metric, second)
        return {scene: after[scene] - before[scene] for scene in after if scene in before}
