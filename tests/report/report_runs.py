"""Records of one sweep whose numbers are known, and ways to change one of them."""

import json
import math
from pathlib import Path

from synthetic import STATS, write_set

CONFIG = {
    "time": {"dt_s": 0.01, "steps": 5, "duration_s": 0.05}, "seeds": {"main": 1, "jitter_m": 0.0}, "friction": {"mu": 0.0},
    "step_solver": {"name": "line_search", "max_iterations": 77, "tol_velocity_m_per_s": 4e-05}, "strain_limit": {"enabled": True},
    "diagnose": {"every": 1, "tier": 2}, "contact": {"hessian_mode": "projected_full"},
}
COND = {"log": 100.0, "cubic": 250.0, "cubic_dynamic": 300.0, "quadratic": 400.0}
NEWTON = {"log": 6, "cubic": 6, "cubic_dynamic": 6, "quadratic": 6}


def changed(folder: Path, **sections) -> None:
    """Puts values into the sections of a record: `changed(run, audit={"crossings": 2})`."""
    file = folder / "run.json"
    record = json.loads(file.read_text())
    for name, values in sections.items():
        record[name] = {**record.get(name, {}), **values}
    file.write_text(json.dumps(record))


def conditions(cond: float) -> dict:
    stats = {**STATS, "median": math.log10(cond), "max": math.log10(2 * cond)}
    return {"full/none": {"log10_cond": stats}, "full/block_jacobi": {"log10_cond": {**stats, "median": math.log10(cond / 10)}}}


def write_records(root: Path) -> Path:
    """log (reference), cubic comparable with it, cubic_dynamic not comparable, quadratic stalled."""
    write_set(root)
    for name, cond in COND.items():
        changed(
            root / name, config=CONFIG, summary={"cond": conditions(cond), "wall_s": 2.0, "steps": 3},
            scene={"vertices": 12}, labels={"d_hat_m": 0.01, "dt_s": 0.01, "integrator": "implicit_euler", "precision": "double"},
            ids={"build_id": "b" * 64, "machine_id": "c" * 64})
    return root
