"""Numbers of a record that rules may name. A number that the record does not have is None."""

from __future__ import annotations

import math
import re
from pathlib import Path

from barrierbench_analysis.figures.plots.kappa_cycle import SETTLED, UNSETTLED_ITERATIONS
from barrierbench_analysis.io.record_file import read_trace
from .locking import bound_share
from .success import FAILURES, RESIDUAL, TIME, residual_max, time_asked


def _at(record: dict, *place: str):
    for name in place:
        record = record.get(name) if isinstance(record, dict) else None
    return record if isinstance(record, (int, float)) and not isinstance(record, bool) and math.isfinite(record) else None


def _cond(matrix: str, which: str):
    def read(record):
        value = _at(record, "summary", "cond", matrix, "log10_cond", which)
        return None if value is None else 10.0**value

    return read


def _climb_of_limit(record) -> float | None:
    """Share of the strain limit in what limit and contact add to the 95th percentile of log10 cond: Shapley's, the mean of what the limit adds before
    and after contact. None below half a decade, and where the record lacks a stage, since one order alone is another number."""
    full, limit, contact, none = (_at(record, "summary", "cond", f"{stage}/none", "log10_cond", "p95")
                                  for stage in ("full", "without_contact", "without_limit", "without_contact_and_limit"))
    if None in (full, limit, contact, none) or full - none < 0.5:
        return None
    return (limit - none + full - contact) / 2 / (full - none)


def _stretch_of_limit(record) -> float | None:
    stretch, limit = _at(record, "summary", "max_stretch"), record["config"].get("strain_limit") or {}
    onset, width = limit.get("onset"), limit.get("width")
    return None if None in (stretch, onset, width) else stretch / (onset + width)


def _per_iteration(*place: str):
    def read(record):
        value, count = _at(record, *place), _at(record, "summary", "newton_iterations")
        return value / count if value is not None and count else None

    return read


def _gap_end(record) -> float | None:
    steps = record.get("steps") or [{}]
    return _at(steps[-1], "gap_min_rel")


def _load_end(record) -> float | None:
    steps = record.get("steps") or [{}]
    return _at(steps[-1], "contact_load_sum_N")


def _slide_loss(record) -> float | None:
    """Share of the kinetic energy at the end of the first step that is gone, or has come, at the end of the last."""
    steps = record.get("steps") or [{}]
    first, last = _at(steps[0], "kinetic_J"), _at(steps[-1], "kinetic_J")
    return abs(1 - last / first) if first and last is not None else None


def _front_rate(record) -> float | None:
    """Bodies a second that a front takes along a row block0, block1, ...: from the first touch of two neighbours to the last. Where it does
    not reach the end of the row, over the rest of the run too. None without two touches or with a failed step."""
    if record["status"]["outcome"] not in ("ok", "unproven"):
        return None
    steps, first = record["steps"], record["summary"].get("first_contact") or {}
    bodies = len([b for b in (record["config"].get("scene") or {}).get("bodies", ()) if re.fullmatch(r"block\d+", b.get("name", ""))])
    pairs = [first.get(f"block{k}|block{k + 1}") for k in range(bodies - 1)]
    times = [steps[step]["t_s"] for step in pairs if step is not None]
    if len(times) < 2:
        return None
    end = max(times) if len(times) == len(pairs) else steps[-1]["t_s"]
    return (len(times) - 1) / (end - min(times)) if end > min(times) else None


def _unsettled(record) -> float:
    """1 when the run ended because a stiffness did not settle."""
    status = record["status"]
    return float(status["outcome"] == "newton_stall" and "does not settle" in status.get("detail", ""))


def longest_run(changes: list[float]) -> int:
    """Most iterations in a row in which a stiffness changed by more than what leaves Newton alone."""
    longest = now = 0
    for change in changes:
        now = now + 1 if change > SETTLED else 0
        longest = max(longest, now)
    return longest


def _kappa_cycles(record) -> float | None:
    """Steps with a cycle, counted in the trace beside the record (FOLDER); None without a trace."""
    if FOLDER not in record:
        return None
    steps: dict[int, list[float]] = {}
    for line in read_trace(record, Path(record[FOLDER])):
        steps.setdefault(line["step"], []).append(line.get("kappa_change_rel") or 0.0)
    return float(sum(longest_run(changes) >= UNSETTLED_ITERATIONS for changes in steps.values())) if steps else None


def _bound_share(record) -> float | None:
    """Counted in the trace beside the record (FOLDER); None without a trace."""
    return bound_share(record, FOLDER)


def _stopped(record) -> float:
    """1 when the run did not come to its end, or went through a surface."""
    return float(record["status"]["outcome"] not in ("ok", "unproven"))


def _summary(*place: str):
    return lambda record: _at(record, "summary", *place)


FOLDER = "folder of the record"  # key that collect() adds, for numbers of the trace
# name -> (meaning, unit, depends on the machine, how it is read)
METRICS = {
    "cond_max": ("largest cond of a run, raw", "1", False, _cond("full/none", "max")),
    "cond_p95": ("95th percentile of cond over a run, raw", "1", False, _cond("full/none", "p95")),
    "cond_median": ("median cond, raw", "1", False, _cond("full/none", "median")),
    "cond_bj_p95": ("95th percentile of cond over a run, block-Jacobi scaled", "1", False, _cond("full/block_jacobi", "p95")),
    "cond_no_contact_p95": ("95th percentile of cond over a run, raw, without contact", "1", False, _cond("without_contact/none", "p95")),
    "cond_no_contact_no_limit_p95": ("95th percentile of cond over a run, raw, without contact and limit", "1", False,
                                     _cond("without_contact_and_limit/none", "p95")),
    "cond_bj_max": ("largest cond, block-Jacobi scaled", "1", False, _cond("full/block_jacobi", "max")),
    "cond_bj_median": ("median cond, block-Jacobi scaled", "1", False, _cond("full/block_jacobi", "median")),
    "pcg_probe": ("median block-Jacobi PCG iterations to 1e-6", "1", False, _summary("probe_pcg", "median")),
    "pcg_solve": ("median PCG iterations of a solve", "1", False, _summary("linear_per_solve", "median")),
    "newton": ("Newton iterations", "1", False, _summary("newton_iterations")),
    "factorizations": ("factorisations", "1", False, _summary("factorizations")),
    "seconds": ("seconds of the steps", "s", True, _summary("wall_s")),
    "contact_seconds": ("seconds of contact terms an iteration", "s", True, _per_iteration("summary", "time", "contact_terms_s")),
    "gap_min": ("smallest gap at a step end", "d_hat", False, _summary("gap_min_rel", "min")),
    "gap_median": ("median over the steps of the smallest gap at a step end", "d_hat", False, _summary("gap_min_rel", "median")),
    "gap_end": ("smallest gap at the end of the last step", "d_hat", False, _gap_end),
    "load_end": ("sum of the contact forces at the end of the last step", "N", False, _load_end),
    "slide_loss": ("share of the kinetic energy at the end of the first step that the last one does not have", "1", False, _slide_loss),
    "front_rate": ("bodies of a row that a front takes in a second", "1/s", False, _front_rate),
    "stretch": ("largest stretch", "1", False, _summary("max_stretch")),
    "stretch_of_limit": ("largest stretch at a step end over the limit", "1", False, _stretch_of_limit),
    "climb_of_limit": ("share of the strain limit in the climb of log10 cond", "1", False, _climb_of_limit),
    "kappa_cycles": ("steps in which a contact's kappa changes by more than 1% in ten iterations in a row", "1", False, _kappa_cycles),
    "bound_share": ("share of iterations whose motion contact stops", "1", False, _bound_share),
    "stopped": ("1 when a step failed or a surface was crossed", "1", False, _stopped),
    "unsettled": ("1 when a stiffness did not settle", "1", False, _unsettled),
    TIME: ("simulated time that a run was asked for", "s", False, time_asked),
    RESIDUAL: ("largest residual at a step end", "tolerances", False, residual_max),
    **{name: (meaning, "1", False, read) for name, (meaning, read) in FAILURES.items()},
}
