"""Verdicts on the numbers of a run: class III inside its envelope, class IV at most 3% dearer each and 1%
together, or what copies differ by.
"""

import numpy as np

from barrierbench_analysis.tables.statistics import geometric, holm

from . import drift, shares
from .baseline import Kept, keep
from .envelope import KS_LEVEL, calibrate, ks_p_value
from .finding import RED, Finding, moved
from .metrics import LOWER_BETTER, UPPER_BETTER, Metric

COST_EACH, COST_TOGETHER = 1.03, 1.01
NOT_OF_A_RECORD = ("instructions",)  # counted in a run of its own (instructions.py)
NOT_IN_THE_REFERENCE = ("FAIL", "not in the reference")
NOT_JUDGED = ("not_judged", "not in the reference, which is of another config or version")


def not_in_the_baseline(how: str = "bench gate calibrate, bench gate accept") -> tuple[str, str]:
    """Verdict and note. how: the verbs that take the number into the baseline."""
    return "FAIL", f"not in the baseline: accept it ({how})"


def around(values: dict[Metric, float]) -> dict[str, Kept]:
    """What a baseline would keep of one run: the tolerances round its values."""
    return {metric.name: keep(metric, calibrate(metric, [value])) for metric, value in values.items()}


def _finding(
    case: str, name: str, kept: Kept, value: float, verdict: str, ends: tuple, note: str = ""
) -> Finding:
    """ends: lower, which may be None, and upper."""
    if kept.xfail:
        verdict, note = ("xfail" if verdict in RED else "xpass"), f"expected to fail: {kept.xfail}"
    before = kept.envelope.value
    change = moved(value, before, kept.unit)
    note = "; ".join(text for text in (change if change != "same" else "", note) if text)
    return Finding(case, kept.gate_class, name, verdict, value, before, *ends, kept.unit, note=note)


def outside(direction: str, value: float, lower: float, upper: float) -> str:
    """`pass` inside, `better` beyond the end on the good side, else `FAIL`."""
    if lower <= value <= upper:
        return "pass"
    good = LOWER_BETTER if value < lower else UPPER_BETTER
    return "better" if direction == good else "FAIL"


def dearer(kept: Kept) -> float:
    """How many times a cost may be what it was, on the machine of the baseline: 3%, or what copies of one and
    the same program differ by.
    """
    return max(COST_EACH, kept.scatter / kept.envelope.value) if kept.envelope.value > 0 else COST_EACH


def drifted(kept: Kept, value: float, same_build_kind: bool) -> str:
    """What a value that the last baseline passes says against the first one: empty when it has not
    drifted."""
    first, e = kept.first, kept.envelope
    if first is None:
        return ""
    each = dearer(kept) if kept.gate_class == "IV" and same_build_kind and first.here else None
    lower, upper = drift.limits(first.value, e.value, e.lower, e.upper, kept.unit, each)
    return (
        drift.note(first, lower, upper, moved(value, first.value, kept.unit))
        if outside(kept.direction, value, lower, upper) == "FAIL"
        else ""
    )


def _held(kept: Kept, value: float, verdict: str, same_build_kind: bool = False) -> tuple[str, str]:
    """The verdict against the last baseline, then against the first: verdict and note."""
    note = drifted(kept, value, same_build_kind) if verdict in ("pass", "better") else ""
    return ("drift" if note else verdict), note


def _numeric(case: str, name: str, kept: Kept, value: float) -> Finding:
    e = kept.envelope
    verdict, note = _held(kept, value, outside(kept.direction, value, e.lower, e.upper))
    return _finding(case, name, kept, value, verdict, (e.lower, e.upper), note)


def _cost(case: str, name: str, kept: Kept, value: float, same_build_kind: bool) -> Finding:
    """Elsewhere than on the machine of the baseline rounding differs, and with it what the perturbed copies
    differ in.
    """
    e = kept.envelope
    upper = dearer(kept) * e.value if same_build_kind else max(COST_EACH * e.value, e.upper)
    is_better = same_build_kind and value < e.value / COST_EACH
    verdict = "FAIL" if value > upper else "better" if is_better else "pass"
    verdict, note = _held(kept, value, verdict, same_build_kind)
    return _finding(case, name, kept, value, verdict, (None, upper), note)


def _together(case: str, ratios: list[float], scatter: list[float]) -> Finding:
    """scatter: what copies of each cost reach, over its value."""
    mean, copies = geometric(ratios), geometric(scatter)
    upper = max(COST_TOGETHER, copies)
    verdict, n = "FAIL" if mean > upper else "pass", len(ratios)
    ends = (None, upper)
    return Finding(case, "IV", "geometric mean", verdict, mean, 1.0, *ends, "ratio", n, f"of {n} costs")


def _new(case: str, metric: Metric, value: float, new: tuple[str, str]) -> Finding:
    """A number that the other side does not have. A time is shown, and a cost of 0 is none."""
    verdict, note = new
    if metric.gate_class == "V":
        verdict = "report"
    elif metric.gate_class == "IV" and value == 0:
        verdict = "not_judged"
    of = case, metric.gate_class, metric.name
    return Finding(*of, verdict, value, unit=metric.unit, judged=0, note=note)


def _absent(case: str, name: str, k: Kept, seen: set[str]) -> Finding:
    """A number that the run does not have: a share of a family that it has, or a count that may be 0, is 0;
    else it has vanished.
    """
    e = k.envelope
    counted = k.unit == shares.UNIT and shares.family_of(name) in seen
    if k.gate_class == "III" and (counted or (k.unit == "1" and e.lower <= 0)):
        return _numeric(case, name, k, 0.0)
    verdict, note = "not_judged" if k.gate_class == "V" else "FAIL", "the run has no such number any more"
    return Finding(case, k.gate_class, name, verdict, None, e.value, e.lower, e.upper, k.unit, 0, note)


def _unseen(case: str, metric: Metric, value: float, new: tuple[str, str], seen: set[str]) -> Finding:
    """A word that no copy had is judged against the share 0; what else is new has nothing that it could be
    judged against.
    """
    if metric.unit == shares.UNIT and shares.family_of(metric.name) in seen:
        return _numeric(case, metric.name, keep(metric, calibrate(metric, [0.0])), value)
    return _new(case, metric, value, new)


def _families(metrics) -> set[str]:
    return {shares.family_of(name) for name, unit in metrics if unit == shares.UNIT}


def numbers(
    case: str,
    kept: dict[str, Kept],
    values: dict[Metric, float],
    same_build_kind: bool,
    new: tuple[str, str] = not_in_the_baseline(),
) -> list[Finding]:
    """A line for every metric of either side. Chaotic ones are left to distributions(). new: verdict and note
    of what only the run has.
    """
    findings, ratios, scatter, found = [], [], [], {metric.name: value for metric, value in values.items()}
    here = _families((metric.name, metric.unit) for metric in values)
    there = _families((name, k.unit) for name, k in kept.items())
    for name, k in kept.items():
        if name in NOT_OF_A_RECORD:
            continue
        value = found.get(name)
        if k.gate_class == "III" and k.envelope.sample and value is not None:
            continue
        if value is None:
            findings.append(_absent(case, name, k, here))
        elif k.gate_class == "V":
            findings.append(_finding(case, name, k, value, "report", (None, k.envelope.value)))
        elif k.gate_class == "IV":
            findings.append(_cost(case, name, k, value, same_build_kind))
            if k.envelope.value > 0 and value > 0:
                ratios.append(value / k.envelope.value)
                scatter.append(max(1.0, k.scatter / k.envelope.value))
        else:
            findings.append(_numeric(case, name, k, value))
    if ratios and same_build_kind:
        findings.append(_together(case, ratios, scatter))
    only_here = [(metric, value) for metric, value in values.items() if metric.name not in kept]
    return findings + [_unseen(case, metric, value, new, there) for metric, value in only_here]


def distributions(samples: list[tuple[str, str, Kept, list[float]]]) -> list[Finding]:
    """Chaotic metrics of all cases as one family: (case, metric, kept, values of copies of the run)."""
    p_values = [ks_p_value(kept.envelope.sample, values) for _, _, kept, values in samples]
    findings = []
    for (case, name, kept, values), p, of_all in zip(samples, p_values, holm(p_values)):
        note = f"chaotic: {len(values)} copies against {len(kept.envelope.sample)}, KS p = {p:.2g}"
        e, middle = kept.envelope, float(np.median(values))
        verdict, more = _held(kept, middle, "FAIL" if of_all < KS_LEVEL else "pass")
        note = "; ".join(text for text in (note, more) if text)
        findings.append(_finding(case, name, kept, middle, verdict, (e.lower, e.upper), note))
    return findings


def chaotic(metrics: dict[str, Kept]) -> dict[str, Kept]:
    return {name: kept for name, kept in metrics.items() if kept.envelope.sample and kept.gate_class == "III"}
