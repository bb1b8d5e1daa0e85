"""Sweeps of made-up runs: every number is known."""

import json
from pathlib import Path

from synthetic import write_run

from barrierbench_analysis.studies.claims.table import Runs

SCENES, LEVELS, SEEDS = ("a", "b", "c"), ("1", "2", "4"), (1, 2, 3, 4, 5)


def row(scene, level, case, seed, **more):
    return {"scene": scene, "level": level, "case": case, "seed": seed, "outcome": "ok", "comparability": "comparable", "gap_rel": 0.1,
            "run": f"{scene}{level}{case}{seed}", **more}


def runs(make, scenes=SCENES, levels=LEVELS, cases=("x", "y"), seeds=SEEDS) -> Runs:
    """make(scene, level, case, seed) gives what differs from a run that ended ok and is comparable."""
    rows = [row(s, lv, c, k, **make(s, lv, c, k)) for s in scenes for lv in levels for c in cases for k in seeds]
    return Runs({"sha256": "", "seconds": 1.0, "date": "2024-01-31", "machine": "a cpu", "build": "0", "unknowns": "3 to 9", "commit": "0"}, rows)


def record(root: Path, sweep, note: str, folder: str, **status) -> None:
    body = write_run(root, "log", 1.0, 0.1, note=note, folder=folder)
    body["status"] |= {"ended_utc": "2024-01-31T12:00:02Z", **status}
    body["config"] = {"strain_limit": {"onset": 0.01, "width": 0.01}}
    body["ids"]["build_id"] = "b"
    body["summary"] |= {"max_stretch": 0.015, "cond": {"full/none": {"log10_cond": {"max": 3.0}}}}
    (root / folder / "run.json").write_text(json.dumps(body))
