"""What a gate measures in a record: one line a number, with its class (docs/laboratory.md, Gates), unit, direction and tolerance."""

from __future__ import annotations

from dataclasses import dataclass

from .records import Run

TWO_SIDED, LOWER_BETTER = "two_sided", "lower_better"


@dataclass(frozen=True)
class Tolerance:
    """How far a value may move where nothing was calibrated: the larger of an absolute and a relative distance."""

    absolute: float = 0.0
    relative: float = 0.0

    def around(self, value: float) -> float:
        return max(self.absolute, self.relative * abs(value))


@dataclass(frozen=True)
class Metric:
    name: str
    gate_class: str  # III: inside an envelope. IV: a cost that does not depend on the clock. V: a time, reported only
    unit: str
    direction: str
    tolerance: Tolerance


COND = Tolerance(absolute=0.05)  # of log10
NEWTON, PCG, GAP = Tolerance(2, 0.05), Tolerance(5, 0.10), Tolerance(absolute=0.02)
CONTACTS = Tolerance(0.5, 0.05)
PHYSICS = Tolerance(relative=0.02)
COST = Tolerance(5, 0.10)  # of the copies; on the machine of the baseline judge.py allows 3%
ROUNDING = 1e-12  # of the largest energy: a smaller one is what rounding left

# metric, place in the record below `summary` or in the last of `steps`
SUMMARY = [
    (Metric("newton_iterations", "III", "1", LOWER_BETTER, NEWTON), ("newton_iterations",)),
    (Metric("linear_iterations", "III", "1", LOWER_BETTER, PCG), ("linear_iterations",)),
    (Metric("probe_pcg_median", "III", "1", LOWER_BETTER, PCG), ("probe_pcg", "median")),
    (Metric("probe_pcg_max", "III", "1", LOWER_BETTER, PCG), ("probe_pcg", "max")),
    (Metric("gap_min", "III", "d_hat", TWO_SIDED, GAP), ("gap_min_rel", "min")),
    (Metric("gap_p05", "III", "d_hat", TWO_SIDED, GAP), ("gap_min_rel", "p05")),
    (Metric("gap_median", "III", "d_hat", TWO_SIDED, GAP), ("gap_min_rel", "median")),
    (Metric("contacts_median", "III", "1", TWO_SIDED, CONTACTS), ("contacts", "median")),
    (Metric("contact_load_max", "III", "N", TWO_SIDED, PHYSICS), ("contact_load_max_N",)),
    (Metric("stretch_max", "III", "1", TWO_SIDED, PHYSICS), ("max_stretch",)),
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
NEVER_RECORDED = ("crossings", "violations", "unproven", "audit", "numbers", "state_hash", "matrices", "outcome", "trace", "schema",
                  "config_id", "judged")  # class I and II: exact, so there is nothing to accept


def _number(value) -> float | None:
    return float(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else None


def _at(record, place: tuple[str, ...]) -> float | None:
    for name in place:
        record = record.get(name) if isinstance(record, dict) else None
    return _number(record)


def cond_metric(matrix: str, which: str) -> Metric:
    """matrix: stage/scaling as in the summary, such as full/block_jacobi."""
    return Metric(f"log10_cond {matrix} {which}", "III", "log10", TWO_SIDED, COND)


def measure(run: Run) -> dict[Metric, float]:
    """Every number that the record has. Class III counts of 0 (nothing of the kind ran) and energies of rounding are left out: they
    judge nothing. A cost of 0 stays: one that appears is a cost."""
    summary, steps = run.section("summary"), run.record.get("steps") or [{}]
    found = {metric: _at(summary, place) for metric, place in SUMMARY}
    found |= {metric: _at(steps[-1], place) for metric, place in LAST_STEP}
    conditions = summary.get("cond")
    for matrix, conditioning in sorted(conditions.items() if isinstance(conditions, dict) else []):
        for which in ("median", "max"):
            found[cond_metric(matrix, which)] = _at(conditioning, ("log10_cond", which))
    energies = [abs(value) for metric, value in found.items() if metric.unit == "J" and value is not None]
    return {metric: value for metric, value in found.items() if value is not None and not (metric.gate_class == "III" and metric.unit == "1" and value == 0)
            and not (metric.unit == "J" and abs(value) <= ROUNDING * max(energies))}
