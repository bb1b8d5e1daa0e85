"""What a gate measures in a record: one line a number, with its class (docs/results/method/gates.md), unit,
direction and tolerance.
"""

import math
from dataclasses import dataclass

from barrierbench_analysis.io.json_file import number_at

TWO_SIDED, LOWER_BETTER, UPPER_BETTER = "two_sided", "lower_better", "upper_better"
DIRECTIONS = (TWO_SIDED, LOWER_BETTER, UPPER_BETTER)


@dataclass(frozen=True)
class Tolerance:
    """How far a value may move where nothing was calibrated: the larger of an absolute and a relative
    distance. The absolute one is at most `share` of the value, so that a small count cannot double; a
    `logarithmic` number moves by at most that much in log10 as well.
    """

    absolute: float = 0.0
    relative: float = 0.0
    share: float = math.inf
    logarithmic: float = 0.0

    def around(self, value: float) -> tuple[float, float]:
        """Lower and upper end. A gap that is 0 or below has no logarithm and keeps the absolute distance."""
        size = abs(value)
        absolute = self.absolute if math.isinf(self.share) else min(self.absolute, self.share * size)
        half = max(absolute, self.relative * size)
        if self.logarithmic and value > 0:
            factor = 10**self.logarithmic
            return max(value / factor, value - half), min(value * factor, value + half)
        return value - half, value + half


@dataclass(frozen=True)
class Metric:
    name: str
    gate_class: (
        str  # III: inside an envelope. IV: a cost that does not depend on the clock. V: a time, reported only
    )
    unit: str
    direction: str
    tolerance: Tolerance


HALF = 0.5  # of a count: 9 that becomes 18 is no scatter
COND = Tolerance(absolute=0.05)  # of log10
NEWTON, PCG = Tolerance(2, 0.05, HALF), Tolerance(5, 0.10, HALF)
GAP = Tolerance(absolute=0.02, logarithmic=0.02)  # 4.7 % up and down
CONTACTS = Tolerance(0.5, 0.05, HALF)
PHYSICS = Tolerance(relative=0.02)
COST = Tolerance(5, 0.10, HALF)  # of the copies; on the machine of the baseline judge.py allows 3%
ROUNDING = 1e-12  # of the largest energy: a smaller one is what rounding left

# metric, place in the record below `summary` or in the last of `steps`
SUMMARY = [
    (Metric("newton_iterations", "III", "1", LOWER_BETTER, NEWTON), ("newton_iterations",)),
    (Metric("linear_iterations", "III", "1", LOWER_BETTER, PCG), ("linear_iterations",)),
    (Metric("probe_pcg_median", "III", "1", LOWER_BETTER, PCG), ("probe_pcg", "median")),
    (Metric("probe_pcg_p95", "III", "1", LOWER_BETTER, PCG), ("probe_pcg", "p95")),
    (Metric("probe_pcg_max", "III", "1", LOWER_BETTER, PCG), ("probe_pcg", "max")),
    (Metric("gap_min", "III", "d_hat", TWO_SIDED, GAP), ("gap_min_rel", "min")),
    (Metric("gap_p05", "III", "d_hat", TWO_SIDED, GAP), ("gap_min_rel", "p05")),
    (Metric("gap_median", "III", "d_hat", TWO_SIDED, GAP), ("gap_min_rel", "median")),
    (Metric("contacts_median", "III", "1", TWO_SIDED, CONTACTS), ("contacts", "median")),
    (Metric("contact_load_max", "III", "N", TWO_SIDED, PHYSICS), ("contact_load_max_N",)),
    (Metric("stretch_max", "III", "1", TWO_SIDED, PHYSICS), ("max_stretch",)),
    (Metric("kappa_start", "III", "N/m", TWO_SIDED, PHYSICS), ("stiffness", "kappa_start_N_per_m")),
    (Metric("kappa_end", "III", "N/m", TWO_SIDED, PHYSICS), ("stiffness", "kappa_end_N_per_m")),
    (Metric("kappa_doublings", "III", "1", TWO_SIDED, CONTACTS), ("stiffness", "doublings")),
    (Metric("linear_solves", "IV", "1", LOWER_BETTER, COST), ("linear_solves",)),
    (Metric("factorizations", "IV", "1", LOWER_BETTER, COST), ("factorizations",)),
    (Metric("analyses", "IV", "1", LOWER_BETTER, COST), ("analyses",)),
    (Metric("line_search_trials", "IV", "1", LOWER_BETTER, COST), ("line_search_trials",)),
    (Metric("ccd_queries", "IV", "1", LOWER_BETTER, COST), ("ccd_queries",)),
    (Metric("ccd_probes", "IV", "1", LOWER_BETTER, COST), ("ccd_probes",)),
    (Metric("wall_s", "V", "s", LOWER_BETTER, Tolerance()), ("wall_s",)),
]
LAST_STEP = [
    (Metric("force_end", "III", "N", TWO_SIDED, PHYSICS), ("contact_load_sum_N",)),
    (Metric("elastic_end", "III", "J", TWO_SIDED, PHYSICS), ("elastic_J",)),
    (Metric("gravity_end", "III", "J", TWO_SIDED, PHYSICS), ("gravity_J",)),
]
# Class I and II: exact, so there is nothing to accept.
NEVER_RECORDED = frozenset(
    "crossings violations unproven audit numbers state_hash matrices outcome trace schema config_id"
    " judged".split()
)


def at(record, place: tuple[str, ...]) -> float | None:
    found = number_at(record, place)
    return None if found is None else float(found)


def cond_metric(matrix: str, which: str) -> Metric:
    """matrix: stage/scaling as in the summary, such as full/block_jacobi."""
    return Metric(f"log10_cond {matrix} {which}", "III", "log10", LOWER_BETTER, COND)
