"""What the map keeps of a run: the gap that it reached, what its shape costs there, and condition numbers."""

import math
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.record_file import read_trace
from barrierbench_analysis.program.start import evaluated
from barrierbench_analysis.studies.kit.metrics import FOLDER
from barrierbench_analysis.studies.kit.study.spec import Cell, Study

STAGES = {
    "cond": ("full", "none"),
    "bj": ("full", "block_jacobi"),
    "nc": ("without_contact", "none"),
    "nc_bj": ("without_contact", "block_jacobi"),
}  # name -> stage and scaling
CONDS = {
    "p95": "95th percentile of cond over iterations in contact",
    "median": "their median",
    "end": "median over the last iterations of the steps that end in contact",
    "end_max": "the largest of these",
}
UNKNOWN = "unknown"
# Value of a row -> what it is.
MEASURED = {
    "gap": "load-weighted median of d/d_hat at converged step ends",
    "gap_p05": "its 5% quantile",
    "rho": "rho of the shape at `gap`",
    "rho_p05": "rho of the shape at `gap_p05`",
    "load": "median over step ends in contact of the largest load of a contact",
    **{f"{name}_{k}": f"{what}, {' '.join(of)}" for name, of in STAGES.items() for k, what in CONDS.items()},
    "pcg": "median of the iterations of the probes in contact",
    "pcg_max": "the most iterations of a probe in contact",
    UNKNOWN: "estimates of condition numbers in contact without a number",
}
LARGEST = 1e14  # what a matrix counts with that has no finite condition number
# Statuses of these. One that is not known (not_converged) is no number at all, as in the program's summary.
INFINITE = ("singular", "not_pd")

# What a row is made of: fields of a record, and of the lines of its trace. Names as in record_file.CHANGED.
READ = (
    *("status.outcome", "status.valid", "scene.free_dofs", "summary.newton_iterations"),
    *("summary.contact_gaps", "steps[].contact_load_max_N", "trace step", "trace iteration"),
    *("trace contacts", "trace cond", "trace cond[].matrix", "trace cond[].stage", "trace cond[].scaling"),
    *("trace cond[].status", "trace cond[].cond", "trace probe_pcg_iterations"),
)


def quantile_of_mixture(pairs: list[tuple[float, list[float]]], share: float) -> float | None:
    """Gap below which `share` of the load of all body pairs lies. pairs: (load share, gaps below which 5, 50
    and 95% of the pair's load lie); between these the distribution is linear in the logarithm of the gap.
    Exact for one pair. By bisection. Cost O(n).
    """
    pairs = [(weight, np.log(gaps)) for weight, gaps in pairs if weight > 0]
    if not pairs:
        return None
    total = sum(weight for weight, _ in pairs)

    def below(x: float) -> float:
        found = 0.0
        for weight, (low, middle, high) in pairs:
            found += weight * float(np.interp(x, [low, middle, high], [0.05, 0.5, 0.95], left=0.0, right=1.0))
        return found / total

    low, high = min(g[0] for _, g in pairs) - 1e-12, max(g[2] for _, g in pairs) + 1e-12
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if below(middle) < share else (low, middle)
    return math.exp(high)


def reached(record: dict, share: float = 0.5) -> float | None:
    """Load-weighted quantile of d/d_hat at converged step ends; None for a run without load."""
    pairs = (record["summary"].get("contact_gaps") or {}).values()
    names = ("gap_rel_p05", "gap_rel_median", "gap_rel_p95")
    return quantile_of_mixture([(p["load_share"], [p[name] for name in names]) for p in pairs], share)


def _estimates(line: dict) -> list[dict]:
    return [s for s in line.get("cond") or [] if s["matrix"] == "clamped"]


def _samples(line: dict, stage: str, scaling: str) -> list[float]:
    """Condition numbers of a line, in the rule of the program's summary
    (experiments/run/cond_summary.hpp)."""
    return [
        LARGEST if s["status"] in INFINITE else s["cond"]
        for s in _estimates(line)
        if (s["stage"], s["scaling"]) == (stage, scaling)
        and (s["status"] in INFINITE or s["cond"] is not None)
    ]


def _unknown(lines: list[dict]) -> int:
    """Estimates without a number: they are in no percentile, and only counted."""
    every = [s for line in lines for s in _estimates(line) if (s["stage"], s["scaling"]) in STAGES.values()]
    return sum(s["cond"] is None and s["status"] not in INFINITE for s in every)


def conditions(lines: list[dict]) -> dict[str, float | None]:
    """Of iterations in contact: 95th percentile and median, median and largest of the last iterations of
    steps, and how many have no number.
    """
    touching = [line for line in lines if sum(line["contacts"].values()) > 0]
    last = {line["step"]: line for line in touching}
    ends = [
        last[step]
        for step in sorted(last)
        if not any(line["step"] == step and line["iteration"] > last[step]["iteration"] for line in lines)
    ]
    found: dict[str, float | None] = {}
    for name, place in STAGES.items():
        every = [c for line in touching for c in _samples(line, *place)]
        at_end = [c for line in ends for c in _samples(line, *place)]
        found |= {
            f"{name}_p95": float(np.percentile(every, 95)) if every else None,
            f"{name}_median": float(np.median(every)) if every else None,
            f"{name}_end": float(np.median(at_end)) if at_end else None,
            f"{name}_end_max": max(at_end) if at_end else None,
        }
    probes = [n for line in touching if (n := line.get("probe_pcg_iterations")) is not None]
    return found | {
        UNKNOWN: _unknown(touching),
        "pcg": float(np.median(probes)) if probes else None,
        "pcg_max": max(probes) if probes else None,
    }


def _load(record: dict) -> float | None:
    """Median over step ends in contact of the largest load of a contact."""
    loads = [step["contact_load_max_N"] for step in record["steps"] if step.get("contact_load_max_N")]
    return float(np.median(loads)) if loads else None


def numbers(record: dict, folder: Path) -> dict[str, float | None]:
    """All of MEASURED but rho. Errors: RecordError for a trace that is not the record's."""
    gaps = {"gap": reached(record), "gap_p05": reached(record, 0.05)}
    return gaps | {"load": _load(record)} | conditions(read_trace(record, folder))


def measure(study: Study, cell: Cell, record: dict) -> dict[str, float | None]:
    """Values of a row, of a record with its folder."""
    found = numbers(record, Path(record[FOLDER]))
    shape = next(s for s in study.about["shapes"] if s["label"] == cell.place["shape"])
    query = {"kind": "rho", "shape": shape["shape"], "argument": shape["argument"]}
    at = [name for name in ("gap", "gap_p05") if found[name] is not None and 0 < found[name] < 1]
    answers = evaluated([{**query, "u": found[name]} for name in at]) if at else []
    rho = {name.replace("gap", "rho"): answer["rho"] for name, answer in zip(at, answers)}
    return found | {"rho": None, "rho_p05": None} | rho
