"""Verdicts on the numbers of a run: class III inside its envelope, class IV at most 3% dearer each and 1% together."""

from __future__ import annotations

import numpy as np

from .baseline import Baseline, Kept, keep
from .envelope import calibrate, holm, ks_p_value
from .finding import Finding, moved
from .metrics import LOWER_BETTER, Metric

COST_EACH, COST_TOGETHER = 1.03, 1.01
NOT_OF_A_RECORD = ("instructions",)  # counted in a run of its own (instructions.py)


def around(values: dict[Metric, float]) -> dict[str, Kept]:
    """What a baseline would keep of one run: the tolerances round its values."""
    return {metric.name: keep(metric, calibrate(metric, [value])) for metric, value in values.items()}


def _finding(case: str, name: str, kept: Kept, value: float, verdict: str, lower: float | None, upper: float, note: str = "") -> Finding:
    if kept.xfail:
        verdict, note = ("xfail" if verdict == "FAIL" else "xpass"), f"expected to fail: {kept.xfail}"
    change = moved(value, kept.envelope.value, kept.unit)
    return Finding(case, kept.gate_class, name, verdict, value, kept.envelope.value, lower, upper, kept.unit,
                   note="; ".join(text for text in (change if change != "same" else "", note) if text))


def _numeric(case: str, name: str, kept: Kept, value: float) -> Finding:
    e = kept.envelope
    if e.lower <= value <= e.upper:
        verdict = "pass"
    else:
        verdict = "better" if value < e.lower and kept.direction == LOWER_BETTER else "FAIL"
    return _finding(case, name, kept, value, verdict, e.lower, e.upper)


def _cost(case: str, name: str, kept: Kept, value: float, same_build_kind: bool) -> Finding:
    """Elsewhere than on the machine of the baseline rounding differs, and with it what the perturbed copies differ in."""
    e = kept.envelope
    upper = COST_EACH * e.value if same_build_kind else max(COST_EACH * e.value, e.upper)
    verdict = "FAIL" if value > upper else "better" if value < e.value / COST_EACH and same_build_kind else "pass"
    return _finding(case, name, kept, value, verdict, None, upper)


def _together(case: str, ratios: list[float]) -> Finding:
    mean = float(np.exp(np.mean(np.log(ratios))))
    return Finding(case, "IV", "geometric mean", "FAIL" if mean > COST_TOGETHER else "pass", mean, 1.0, None, COST_TOGETHER, "ratio",
                   judged=len(ratios), note=f"of {len(ratios)} costs")


def _new(case: str, metric: Metric, value: float, costs_are_kept: bool) -> Finding:
    """A number that the baseline does not have: red where it is a cost beside costs that it has."""
    cost = costs_are_kept and metric.gate_class == "IV" and value > 0
    return Finding(case, metric.gate_class, metric.name, "FAIL" if cost else "not_judged", value, unit=metric.unit, judged=int(cost),
                   note="not in the baseline" + ("; a cost that is new" if cost else ""))


def numbers(case: str, kept: dict[str, Kept], values: dict[Metric, float], same_build_kind: bool) -> list[Finding]:
    """A line for every metric of either side. Chaotic ones are left to distributions()."""
    findings, ratios, found = [], [], {metric.name: value for metric, value in values.items()}
    for name, k in kept.items():
        if name in NOT_OF_A_RECORD:
            continue
        value = found.get(name)
        if value is None:
            findings.append(Finding(case, k.gate_class, name, "not_judged" if k.gate_class == "V" else "FAIL", None, k.envelope.value,
                                    k.envelope.lower, k.envelope.upper, k.unit, judged=0, note="the run has no such number any more"))
        elif k.gate_class == "V":
            findings.append(_finding(case, name, k, value, "report", None, k.envelope.value))
        elif k.gate_class == "IV":
            findings.append(_cost(case, name, k, value, same_build_kind))
            if k.envelope.value > 0:
                ratios.append(value / k.envelope.value)
        elif not k.envelope.sample:
            findings.append(_numeric(case, name, k, value))
    if ratios and same_build_kind:
        findings.append(_together(case, ratios))
    costs_are_kept = any(k.gate_class == "IV" and name not in NOT_OF_A_RECORD for name, k in kept.items())
    return findings + [_new(case, metric, value, costs_are_kept) for metric, value in values.items() if metric.name not in kept]


def distributions(samples: list[tuple[str, str, Kept, list[float]]]) -> list[Finding]:
    """Chaotic metrics of all cases as one family: (case, metric, kept, values of copies of the run)."""
    p_values = [ks_p_value(kept.envelope.sample, values) for _, _, kept, values in samples]
    findings = []
    for (case, name, kept, values), p, red in zip(samples, p_values, holm(p_values)):
        note = f"chaotic: {len(values)} copies against {len(kept.envelope.sample)}, KS p = {p:.2g}"
        e = kept.envelope
        findings.append(_finding(case, name, kept, float(np.median(values)), "FAIL" if red else "pass", e.lower, e.upper, note))
    return findings


def chaotic(baseline: Baseline) -> dict[str, Kept]:
    return {name: kept for name, kept in baseline.metrics.items() if kept.envelope.sample and kept.gate_class == "III"}
