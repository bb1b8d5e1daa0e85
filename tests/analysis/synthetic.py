"""A small set of records with known numbers: three formulations in one scene, one of them failed."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

STATS = {"n": 1, "min": 1.0, "p05": 1.0, "median": 1.0, "p95": 1.0, "max": 1.0, "sum": 1.0}
CONTACTS = {"total": 3}


def digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _trace_line(step: int, iteration: int, scale: float) -> dict:
    def estimate(scaling: str, cond: float, status: str = "ok") -> dict:
        return {"stage": "full", "scaling": scaling, "tier": 2, "lambda_min": 2.0, "lambda_max": 2.0 * cond,
                "cond": cond, "status": status, "method": "spectra"}

    last = iteration == 1
    return {
        "step": step, "iteration": iteration, "linear_iterations": 10 + step, "probe_pcg_iterations": 10.0 + step, "gap_min_iterates_rel": 0.5,
        "kappa_change_rel": None if iteration == 0 else 0.0, "limit_kappa_change_rel": None if iteration == 0 else 0.0, "limit_gap_min_rel": 0.9, "contacts": CONTACTS, "time": {},
        "cond": [estimate("none", scale * 10.0 ** (step + 1), "lower_bound" if last and step == 2 else "ok"),
                 estimate("block_jacobi", scale * (step + 1))],
    }


def _step(step: int, gap: float | None) -> dict:
    return {"step": step, "t_s": 0.01 * (step + 1), "newton_iterations": 2, "gap_min_m": None if gap is None else gap * 1e-2,
            "gap_min_rel": gap, "gap_min_iterates_rel": None if gap is None else 0.9 * gap, "contacts": CONTACTS, "time": {}}


def _comparability(gap: float, verdict: str) -> dict:
    return {"verdict": verdict, "reason": "", "reference_run": "log", "reference_run_id": digest("run log"), "gap_rel": gap,
            "reference_gap_rel": 0.1, "ratio": gap / 0.1, "pair": "cloth|floor", "pair_quantile": "gap_rel_p05", "pair_gap_rel": gap,
            "pair_reference_gap_rel": 0.1, "pair_ratio": gap / 0.1, "max_ratio": 2.0}


def write_run(root: Path, formulation: str, scale: float, gap: float, outcome: str = "ok", note: str = "", verdict: str = "comparable", folder: str = "") -> dict:
    shape = "log" if formulation == "log" else "cubic"
    record = {
        "schema": {"name": "barrierbench.run", "version": "3.99.0"},
        "a_field_of_a_later_version": 1,
        "ids": {"run_id": digest(f"run {formulation}"), "config_id": digest(f"config {formulation}"), "sweep_id": "strip"},
        "status": {"outcome": outcome, "started_utc": "2024-01-31T12:00:00Z", "detail": "" if outcome == "ok" else "step 2 ended at its cap", "valid": outcome == "ok"},
        "labels": {"step_solver": "line_search", "scene": "drape2d", "formulation": formulation, "shape": shape, "argument": "gap", "note": note},
        "summary": {"newton_iterations": 6, "first_contact": {}, "linear_iterations": 66, "probe_pcg": STATS, "gap_min_rel": {**STATS, "min": gap}, "time": {}},
        "audit": {"enabled": True, "judged": 9, "crossings": 0, "violations": 0, "unproven": 0, "obstacle_violations": 0, "scene_faults": 0},
        "comparability": _comparability(gap, verdict),
        "scene": {"free_dofs": 30, "extent_m": 1.0},
        "matching": {"rule": "equal_force", "theta": 0.2},
        "machine": {"cpu_model": "a cpu", "cores": 2},
        "provenance": {"threads": 1, "git_commit": "0123456789abcdef", "blas": {"kernel": "Haswell"}},
        "steps": [_step(0, None), _step(1, 2 * gap), _step(2, gap)],
    }
    place = root / (folder or formulation)
    place.mkdir(parents=True)
    (place / "run.json").write_text(json.dumps(record))
    lines = [_trace_line(step, iteration, scale) for step in range(3) for iteration in range(2)]
    (place / "trace.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    bind(place)
    return record


def bind(folder: Path) -> None:
    """Lets the record name the trace as it is now."""
    path, trace = folder / "run.json", (folder / "trace.jsonl").read_bytes()
    record = json.loads(path.read_text())
    record["artifacts"] = [{"path": "trace.jsonl", "kind": "trace", "media_type": "application/jsonl", "sha256": hashlib.sha256(trace).hexdigest(), "bytes": len(trace)}]
    path.write_text(json.dumps(record))


def write_cycle(folder: Path, change: float, whose: str = "") -> None:
    """Appends a step 3 in which a gap swings between two values and its kappa changes by `change` each time; whose: "" or "limit_"."""
    gap = "limit_gap_min_rel" if whose else "gap_min_iterates_rel"
    lines = [_trace_line(3, iteration, 1.0) | {gap: (0.1, 0.6)[iteration % 2], f"{whose}kappa_change_rel": change} for iteration in range(12)]
    with (folder / "trace.jsonl").open("a") as trace:
        trace.writelines(json.dumps(line) + "\n" for line in lines)
    record = json.loads((folder / "run.json").read_text())
    record["summary"]["newton_iterations"] += len(lines)
    (folder / "run.json").write_text(json.dumps(record))
    bind(folder)


def write_set(root: Path) -> None:
    """log and cubic comparable, cubic_dynamic three times closer, quadratic stalled."""
    write_run(root, "log", 1.0, 0.10, note="strip: log")
    write_run(root, "cubic", 2.0, 0.15, note="strip: cubic")
    write_run(root, "cubic_dynamic", 3.0, 0.03, note="strip: cubic_dynamic", verdict="not_comparable")
    write_run(root, "quadratic", 4.0, 0.12, outcome="newton_stall", note="strip: quadratic", verdict="not_valid")
