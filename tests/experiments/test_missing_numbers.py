"""A number that is missing has the reason that holds for the whole run: what was requested and is not there differs from what was never requested."""

import json

from test_cli import GRID, bench, write

BODY = {"name": "leaf", "mesh": GRID, "material": {"youngs_N_per_m": 100, "density_kg_per_m2": 1}, "transform": {"translate_m": [0, 0, 5]}}
FALL = {
    "schema": "barrierbench.config/1",
    "scene": {"name": "bodies", "bodies": [BODY], "obstacles": [{"name": "floor", "kind": "plane"}]},
    "formulation": {"name": "log", "d_hat_m": 0.002, "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 50}},
    "time": {"dt_s": 0.01, "steps": 2},
    "passes": {"audit": True},
}


def test_a_run_without_contact_and_limit_says_so_in_its_summary(program, tmp_path):
    write(tmp_path / "fall.json", FALL)
    done = bench(program, "run", tmp_path / "fall.json", "--out", tmp_path / "run")
    assert done.returncode == 0, done.stderr
    record = json.loads((tmp_path / "run/run.json").read_text())
    summary, audit = record["summary"], record["audit"]
    names = ("gap_min_m", "gap_min_iterates_m", "gap_min_iterates_rel", "contact_load_max_N")
    assert {name: (summary[name], summary[f"{name}_status"]) for name in names} == dict.fromkeys(names, (None, "no_contacts"))
    assert summary["max_stretch"] is None and summary["max_stretch_status"] == "no_limit"
    assert audit["surface_gaps"] == 2 and audit["surface_gap_between_m_status"] == "none_within_d_hat"
    assert audit["surface_gap_obstacles_m"] > 4
