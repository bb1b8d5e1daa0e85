"""Every number of a record that a gate looks at: those of metrics.py, and the shares of its words."""

from . import shares
from .metrics import LAST_STEP, ROUNDING, SUMMARY, Metric, at, cond_metric
from .records import Run


def _numbers(run: Run) -> dict[Metric, float]:
    """Every number that the record has as one. Class III counts of 0 (nothing of the kind ran) and energies
    of rounding are left out: they judge nothing. A cost of 0 stays: one that appears is a cost.
    """
    summary, steps = run.section("summary"), run.record.get("steps") or [{}]
    found = {metric: at(summary, place) for metric, place in SUMMARY}
    found |= {metric: at(steps[-1], place) for metric, place in LAST_STEP}
    conditions = summary.get("cond")
    for matrix, conditioning in sorted(conditions.items() if isinstance(conditions, dict) else []):
        for which in ("median", "p95", "max"):
            found[cond_metric(matrix, which)] = at(conditioning, ("log10_cond", which))
    energies = [abs(value) for metric, value in found.items() if metric.unit == "J" and value is not None]
    return {
        metric: value
        for metric, value in found.items()
        if value is not None
        and not (metric.gate_class == "III" and metric.unit == "1" and value == 0)
        and not (metric.unit == "J" and abs(value) <= ROUNDING * max(energies))
    }


def measure(run: Run) -> dict[Metric, float]:
    return _numbers(run) | shares.measure(run)
