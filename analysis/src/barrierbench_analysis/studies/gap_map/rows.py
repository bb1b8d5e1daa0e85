"""Rows of a gap map from records: what a run reached, what it took, and what its shape costs there."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.origin import run_of, seconds_of_run
from barrierbench_analysis.io.record_file import read_trace
from barrierbench_analysis.program.start import evaluated
from barrierbench_analysis.tables.numbers import rounded
from barrierbench_analysis.tables.outcomes import outcome_of

from .spec import Cell, Spec

PLACE = ("scene", "resolution", "shape", "limit", "theta")
STATE = (
    "outcome",
    "source",
    "run",
    "unknowns",
    "seconds",
)  # source: index into the sources of the map, None without a run
REACHED = ("gap", "gap_p05", "rho", "rho_p05", "load")
CONDS = ("cond", "bj", "nc", "nc_bj")  # full raw and block-Jacobi, and both without contact
METRICS = tuple(f"{name}_{which}" for name in CONDS for which in ("p95", "median", "end", "end_max")) + (
    "pcg",
    "pcg_max",
    "newton",
)
UNKNOWN = "unknown"  # estimates of condition numbers in contact that have no number
COLUMNS = (*PLACE, *STATE, *REACHED, *METRICS, UNKNOWN)
STAGES = {
    "cond": ("full", "none"),
    "bj": ("full", "block_jacobi"),
    "nc": ("without_contact", "none"),
    "nc_bj": ("without_contact", "block_jacobi"),
}
LARGEST = 1e14  # what a matrix counts with that has no finite condition number
INFINITE = (
    "singular",
    "not_pd",
)  # statuses of these; one that is not known (not_converged) is no number at all, as in the program's summary

# What a row is made of: fields of a record, and of the lines of its trace. Names as in record_file.CHANGED.
READ = (
    *("status.outcome", "status.valid", "scene.free_dofs", "summary.newton_iterations"),
    *("summary.contact_gaps", "steps[].contact_load_max_N", "trace step", "trace iteration"),
    *("trace contacts", "trace cond", "trace cond[].matrix", "trace cond[].stage", "trace cond[].scaling"),
    *("trace cond[].status", "trace cond[].cond", "trace probe_pcg_iterations"),
)

NOT_RUN = "not run"
CANNOT = "cannot reach"  # theta lies beyond the peak of the force: no contact rests there
NO_CONTACT = "no contact"


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
    pairs = record["summary"].get("contact_gaps") or {}
    return quantile_of_mixture(
        [
            (p["load_share"], [p["gap_rel_p05"], p["gap_rel_median"], p["gap_rel_p95"]])
            for p in pairs.values()
        ],
        share,
    )


def _samples(line: dict, stage: str, scaling: str) -> list[float]:
    """Condition numbers of a line, in the rule of the program's summary
    (experiments/run/cond_summary.hpp)."""
    mine = [
        s
        for s in line.get("cond") or []
        if (s["matrix"], s["stage"], s["scaling"]) == ("clamped", stage, scaling)
    ]
    return [
        LARGEST if s["status"] in INFINITE else s["cond"]
        for s in mine
        if s["status"] in INFINITE or s["cond"] is not None
    ]


def _unknown(lines: list[dict]) -> int:
    """Estimates without a number: they are in no percentile, and only counted."""
    every = [
        s
        for line in lines
        for s in line.get("cond") or []
        if s["matrix"] == "clamped" and (s["stage"], s["scaling"]) in STAGES.values()
    ]
    return sum(s["cond"] is None and s["status"] not in INFINITE for s in every)


def in_contact(lines: list[dict]) -> list[dict]:
    return [line for line in lines if sum(line["contacts"].values()) > 0]


def conditions(lines: list[dict]) -> dict[str, float | None]:
    """Of iterations in contact: 95th percentile and median, median and largest of the last iterations of
    steps, and how many have no number.
    """
    touching = in_contact(lines)
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
    probes = [
        line["probe_pcg_iterations"] for line in touching if line.get("probe_pcg_iterations") is not None
    ]
    return found | {
        UNKNOWN: _unknown(touching),
        "pcg": float(np.median(probes)) if probes else None,
        "pcg_max": max(probes) if probes else None,
    }


def _load(record: dict) -> float | None:
    """Median over step ends in contact of the largest load of a contact."""
    loads = [step["contact_load_max_N"] for step in record["steps"] if step.get("contact_load_max_N")]
    return float(np.median(loads)) if loads else None


def row(cell: Cell, record: dict | None, folder: Path | None = None, outcome: str = NOT_RUN) -> dict:
    """One row. Without a record nothing but its outcome is known. Errors: RecordError for a trace that is not
    the record's.
    """
    found = dict.fromkeys(COLUMNS) | {
        "scene": cell.scene,
        "resolution": cell.resolution,
        "shape": cell.shape,
        "limit": cell.limit,
        "theta": cell.theta,
        "outcome": outcome,
    }
    if record is None:
        return found
    gap = reached(record)
    found |= {
        "outcome": outcome_of(record),
        "run": run_of(record),
        "unknowns": record["scene"]["free_dofs"],
        "seconds": seconds_of_run(record),
        "newton": record["summary"]["newton_iterations"],
        "load": _load(record),
    }
    if gap is None and found["outcome"] == "ok":
        found["outcome"] = NO_CONTACT
    found |= {"gap": gap, "gap_p05": reached(record, 0.05)} | conditions(read_trace(record, folder))
    return {key: rounded(value) for key, value in found.items()}


def cannot_reach(spec: Spec) -> set[tuple[str, float]]:
    """(shape, theta) where the force falls towards contact: what equal force would give rests at another gap,
    on the far side of the peak.
    """
    places = [(shape, theta) for shape in spec.shapes for theta in spec.gaps]
    answers = evaluated(
        [
            {
                "kind": "shape",
                "shape": spec.shapes[s][0],
                "argument": spec.shapes[s][1],
                "d": theta,
                "d_hat": 1,
            }
            for s, theta in places
        ]
    )
    return {place for place, answer in zip(places, answers) if not answer["d2b"] > 0}


def add_rho(spec: Spec, rows: list[dict]) -> None:
    """rho of each row's shape at the gaps that its run reached."""
    places = [
        (r, name) for r in rows for name in ("gap", "gap_p05") if r[name] is not None and 0 < r[name] < 1
    ]
    if not places:
        return
    answers = evaluated(
        [
            {
                "kind": "rho",
                "shape": spec.shapes[r["shape"]][0],
                "argument": spec.shapes[r["shape"]][1],
                "u": r[name],
            }
            for r, name in places
        ]
    )
    for (r, name), answer in zip(places, answers):
        r["rho" if name == "gap" else "rho_p05"] = rounded(answer["rho"])
