"""Bounds of each vertex, weights by area, offset geometric contact and the policy `dart` in whole runs of the program."""

import json
import subprocess
from pathlib import Path

import pytest
from numpy import log
from scipy.optimize import brentq

SCENES = Path(__file__).resolve().parents[2] / "configs" / "scenes"


def start(program: str, scene, *words: str) -> subprocess.CompletedProcess:
    return subprocess.run([program, *words[:1], str(scene), *words[1:]], capture_output=True, text=True, check=False)


def settings(given: dict) -> list:
    return [word for key, value in given.items() for word in ("--set", f"{key}={json.dumps(value)}")]


def run(program: str, folder: Path, scene, **given) -> dict:
    """The record of a run that ended well and was audited."""
    config = SCENES / f"{scene}.json" if isinstance(scene, str) else folder.parent / f"{folder.name}.json"
    if not isinstance(scene, str):
        config.write_text(json.dumps(scene))
    done = start(program, config, "run", "--out", str(folder), "--progress", "none", "--set", "/passes/audit=true", *settings(given))
    assert done.returncode == 0, done.stderr
    record = json.loads((folder / "run.json").read_text())
    assert record["status"]["outcome"] == "ok" and record["audit"]["judged"] > 0
    assert record["audit"]["crossings"] == record["audit"]["obstacle_violations"] == 0
    return record


def refused(program: str, scene: str, *lines: str, **given) -> None:
    done = start(program, SCENES / f"{scene}.json", "check", *settings(given))
    assert done.returncode == 2, done.stdout
    for line in lines:
        assert line in done.stderr


# --- bounds of each vertex


WORDS = {
    "planar_truncation": "planar truncation of each vertex",
    "planar_balanced": "planes where the smallest part is largest",
    "per_vertex": "a ball round each vertex",
}


# The published planes need not get through sphere_on_sheet: the test below shows why.
@pytest.mark.parametrize("scene, rule", [("stack", "planar_truncation"), ("stack", "planar_balanced"), ("stack", "per_vertex"),
                                         ("sphere_on_sheet", "planar_balanced"), ("sphere_on_sheet", "per_vertex"), ("strip_on_disk", "planar_truncation"),
                                         ("strip_on_disk", "planar_balanced"), ("strip_on_disk", "per_vertex")])  # fmt: skip
def test_a_run_ends_where_it_ends_with_accd(program, tmp_path, scene, rule):
    """The same minimum of every step, without one query of ACCD and without a crossing."""
    fixed = {"/time/steps": 6}
    before = run(program, tmp_path / "accd", scene, **fixed)
    after = run(program, tmp_path / rule, scene, **fixed, **{"/contact/step_bound": rule})
    for record in (before, after):
        assert min(step["alpha_ccd_min"] for step in record["steps"]) < 1, "the bound is asked for something"
    assert before["summary"]["solver"]["truncations"] == 0
    assert scene != "sphere_on_sheet" or after["summary"]["solver"]["truncations"] > 0, "where not all vertices go alike"
    assert after["summary"]["ccd_queries"] == 0
    assert before["config"]["contact"].get("step_bound") is None and after["config"]["contact"]["step_bound"] == rule
    reason = next(item["reason"] for item in after["plan"] if item["item"] == "step_bound")
    assert WORDS[rule] in reason
    for one, other in zip(before["steps"], after["steps"], strict=True):
        for name in ("gravity_J", "contact_J"):
            assert other[name] == pytest.approx(one[name], rel=1e-3, abs=1e-7), (one["step"], name)


def test_published_planes_stall_where_balanced_ones_go_on(program, tmp_path):
    """A plane at the closest points leaves a vertex behind them what it is behind, and in the next iteration a part of that."""
    words = ("run", "--out", str(tmp_path / "published"), "--progress", "none", *settings({"/contact/step_bound": "planar_truncation"}))
    assert start(program, SCENES / "strip_on_disk.json", *words).returncode == 0  # a stall is an outcome
    stalled = json.loads((tmp_path / "published" / "run.json").read_text())
    assert stalled["status"]["outcome"] == "newton_stall"
    rows = [json.loads(line) for line in (tmp_path / "published" / "trace.jsonl").read_text().splitlines()]
    ways = [row["alpha_ccd"] for row in rows if row["step"] == rows[-1]["step"]]
    assert len(ways) > 10 and all(after < 0.3 * before for before, after in zip(ways, ways[1:], strict=False))
    assert ways[-1] < 1e-12, "the way ends without a contact"
    gaps = [row["gap_min_iterates_m"] for row in rows if row["step"] == rows[-1]["step"] and row["gap_min_iterates_m"]]
    assert gaps and min(gaps) > 1e-4, "a tenth of d_hat is open all the time"
    steps = stalled["steps"][-1]["step"] + 3
    on = run(program, tmp_path / "balanced", "strip_on_disk", **{"/time/steps": steps, "/contact/step_bound": "planar_balanced"})
    assert on["summary"]["solver"]["truncations"] > 0


def test_a_pin_that_is_held_back_arrives(program, tmp_path):
    """A pinned sheet is drawn down onto a plane by its pins, which a bound cuts short on the way."""
    scene = {
        "schema": "barrierbench.config/1",
        "scene": {"name": "bodies", "gravity_m_per_s2": [0, 0, -9.81],
                  "bodies": [{"name": "sheet", "mesh": {"generator": "grid", "n_x": 5, "n_y": 5, "size_x_m": 0.2, "size_y_m": 0.2},
                              "transform": {"translate_m": [0, 0, 0.01]}, "material": {"youngs_N_per_m": 100, "density_kg_per_m2": 0.2},
                              "pins": [{"box_m": [[-1, -1, -1], [-0.099, 1, 1]],
                                        "motion": {"velocity_m_per_s": [0, 0, -0.08], "end_s": 0.1}}]}],
                  "obstacles": [{"name": "floor", "kind": "plane"}]},
        "formulation": {"name": "log", "d_hat_m": 0.004, "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 50}},
        "time": {"dt_s": 0.05, "steps": 4}}  # fmt: skip
    for rule in WORDS:
        record = run(program, tmp_path / rule, scene, **{"/contact/step_bound": rule})
        assert record["summary"]["solver"]["truncations"] > 0
        assert record["summary"]["solver"]["feasibility_trials"] > 0, "the pins were short of their pose"


def test_bounds_are_refused_where_nothing_computes_them(program):
    planar = {"/contact/step_bound": "planar_truncation"}
    refused(program, "stack", "accumulated_toi takes one part", **planar, **{"/step_solver/name": "accumulated_toi"})
    refused(program, "stack", "no kernel bounds each vertex by itself", **planar, **{"/device": "host"})
    refused(program, "stack", "accd does not read it", **{"/contact/bound_gamma": 0.5})
    refused(program, "stack", "/contact/bound_gamma", **planar, **{"/contact/bound_gamma": 1})
    refused(program, "stack", "/contact/step_bound", "accd", "per_vertex", **{"/contact/step_bound": "planar"})


# --- weights by area

D_HAT, AREA_DENSITY, STIFFNESS = 0.01, 0.5, 4e3  # m, kg/m^2, N/m^3


def sheet_on_a_plane(n: int, kappa: float) -> dict:
    return {
        "schema": "barrierbench.config/1",
        "scene": {"name": "bodies", "gravity_m_per_s2": [0, 0, -9.81],
                  "bodies": [{"name": "sheet", "mesh": {"generator": "grid", "n_x": n, "n_y": n, "size_x_m": 0.4, "size_y_m": 0.3},
                              "transform": {"translate_m": [0, 0, 0.004]},
                              "material": {"youngs_N_per_m": 500, "density_kg_per_m2": AREA_DENSITY}}],
                  "obstacles": [{"name": "floor", "kind": "plane"}]},
        "formulation": {"name": "log", "d_hat_m": D_HAT, "stiffness_policy": {"name": "fixed", "kappa_N_per_m": kappa}},
        "time": {"dt_s": 0.1, "steps": 60}}  # fmt: skip


def gap_of(program, folder, n, kappa, **given) -> float:
    return run(program, folder, sheet_on_a_plane(n, kappa), **given)["steps"][-1]["surface_gap_obstacles_m"]


def test_a_sheet_that_is_refined_carries_the_same_gap(program, tmp_path):
    """Its weight on a square metre against kappa |b'| of a square metre; with pairs that count as one the gap goes with the mesh."""
    slope = lambda d: -2 * (D_HAT - d) * log(d / D_HAT) + (D_HAT - d) ** 2 / d  # noqa: E731  |b'| of the log
    known = brentq(lambda d: STIFFNESS * slope(d) - AREA_DENSITY * 9.81, 1e-9, D_HAT)
    area = {"/contact/weighting": "area"}
    weighted = [gap_of(program, tmp_path / f"area{n}", n, STIFFNESS, **area) for n in (4, 7, 13)]
    for gap in weighted:
        assert gap == pytest.approx(known, rel=1e-4)
    counted = [gap_of(program, tmp_path / f"none{n}", n, STIFFNESS * 0.12 / 16) for n in (4, 7, 13)]
    assert counted[2] > 1.2 * counted[0], "without weights a finer mesh is a stiffer one"


def test_weights_are_refused_where_kappa_is_that_of_a_pair(program):
    area = {"/contact/weighting": "area"}
    refused(program, "stack", "none, or policy fixed: kappa of ipc_adaptive", **area, **{"/formulation/stiffness_policy": {"name": "ipc_adaptive"}})
    refused(program, "stack", "none, or matching rule as_given", **area, **{"/matching/rule": "equal_force"})
    refused(program, "stack", "its kernels count every pair as one", **area, **{"/device": "host"})
    done = start(program, SCENES / "chain.json", "run", "--progress", "none", *settings(area))
    assert done.returncode == 2 and "belongs to no triangle" in done.stderr


def sheets(plate_squares: int) -> dict:
    """A sheet that comes to rest on another one, which is given, with other lines."""
    return {
        "schema": "barrierbench.config/1",
        "scene": {"name": "bodies", "gravity_m_per_s2": [0, 0, -9.81],
                  "bodies": [{"name": "sheet", "mesh": {"generator": "grid", "n_x": 5, "n_y": 4, "size_x_m": 0.4, "size_y_m": 0.3},
                              "transform": {"translate_m": [0.013, 0.021, 0.007]},
                              "material": {"youngs_N_per_m": 500, "density_kg_per_m2": AREA_DENSITY}},
                             {"name": "plate", "kind": "rigid", "mesh": {"generator": "grid", "n_x": plate_squares + 1, "n_y": plate_squares + 1}}]},
        "formulation": {"name": "log", "d_hat_m": D_HAT, "stiffness_policy": {"name": "fixed", "kappa_N_per_m": STIFFNESS}},
        "time": {"dt_s": 0.05, "steps": 20}}  # fmt: skip


def test_corrected_weights_carry_a_sheet_on_a_mesh(program, tmp_path):
    """Some rows pull, and the sheet rests where it does without them: here crossings of edges carry it."""
    gaps = {}
    for weighting in ("area", "area_corrected"):
        record = run(program, tmp_path / weighting, sheets(9), **{"/contact/weighting": weighting})
        assert record["config"]["contact"]["weighting"] == weighting
        last = record["steps"][-1]
        gaps[weighting] = last["gap_min_rel"]
        assert (last["kappa_min_N_per_m"] < 0) == (weighting == "area_corrected")
        assert last["kinetic_J"] < 1e-6
    assert 0.5 < gaps["area"] < 1 and gaps["area_corrected"] == pytest.approx(gaps["area"], rel=1e-2)


def test_corrected_weights_are_refused_where_no_row_may_pull(program):
    corrected = {"/contact/weighting": "area_corrected"}
    refused(program, "stack", "none, or policy fixed", **corrected, **{"/formulation/stiffness_policy": {"name": "ipc_adaptive"}})
    refused(program, "stack", "its corrections are no loads", **corrected, **{"/friction/mu": 0.2})
    refused(program, "stack", "rows have to be projected", **corrected, **{"/contact/hessian_mode": "gauss_newton"})
    refused(program, "stack", "accumulated_toi knows no pair that takes back", **corrected, **{"/step_solver/name": "accumulated_toi"})
    refused(program, "stack", "area_corrected", "its kernels count every pair as one", **corrected, **{"/device": "host"})


# --- offset geometric contact


def test_offset_geometric_contact_carries_a_sheet_with_a_large_radius(program, tmp_path):
    """d_hat of one and a half edges: few rows, by the step solver that compares no energies."""
    wide = {"/step_solver/name": "accumulated_toi", "/formulation/d_hat_m": 0.15, "/formulation/stiffness_policy/kappa_N_per_m": 0.2, "/contact/rest_rule": "off"}
    records = {model: run(program, tmp_path / model, sheets(9), **wide, **{"/contact/model": model}) for model in ("all_pairs", "offset_geometric")}
    few, many = (records[model]["steps"][-1]["contacts"]["total"] for model in ("offset_geometric", "all_pairs"))
    assert 20 <= few < many / 5
    assert all(0 < record["steps"][-1]["gap_min_rel"] < 1 for record in records.values())
    assert records["offset_geometric"]["config"]["contact"]["model"] == "offset_geometric"


def test_offset_geometric_contact_is_refused_where_it_has_no_blocks(program):
    model = {"/contact/model": "offset_geometric"}
    refused(program, "stack", "its kernels know no other pairs", **model, **{"/device": "host"})
    refused(program, "stack", "features of a block count as one", **model, **{"/contact/weighting": "area"})
    refused(program, "stack", "blocks are computed in double", **model, **{"/precision": "float"})
    refused(program, "stack", "the step solver is penalty", **model, **{"/step_solver/name": "penalty"})
    refused(program, "strip_on_disk", "the scene is planar", **model)


# --- dart


def test_dart_is_the_balance_of_the_heaviest_vertex(program, tmp_path):
    """A sheet whose inner vertices have six triangles: their mass over dt^2, on the host and on the executor of kernels."""
    for device in ("cpu", "host"):
        given = {"/formulation": {"shape": "log", "argument": "gap", "d_hat_m": D_HAT, "name": "dart",
                                  "stiffness_policy": {"name": "dart", "balance": "inertia", "kappa_min_N_per_m": 1e-6}},
                 "/time/steps": 3, "/time/dt_s": 0.02, "/device": device}  # fmt: skip
        record = run(program, tmp_path / device, sheet_on_a_plane(5, 1), **given)
        inner = AREA_DENSITY * 0.1 * 0.075
        assert record["summary"]["stiffness"]["kappa_end_N_per_m"] == pytest.approx(inner / 0.02**2, rel=1e-9)
        assert record["steps"][-1]["kappa_min_N_per_m"] == record["steps"][-1]["kappa_max_N_per_m"] == pytest.approx(inner / 0.02**2)


def test_dart_as_published_is_25_for_cloth(program, tmp_path):
    record = run(program, tmp_path / "run", sheet_on_a_plane(5, 1), **{"/formulation": "dart", "/formulation/d_hat_m": D_HAT, "/time/steps": 3})
    assert record["summary"]["stiffness"]["kappa_end_N_per_m"] == 25
    assert record["steps"][-1]["contacts"]["total"] > 0


# --- a frictionless card on a flat table


def card_on_table(y_m: float) -> dict:
    """A stiff card over a table of eight triangles. At y = 7 mm no vertex or edge of one is within 0.6 mm of an edge or a
    vertex of the other, seen from above, and d_hat is 0.5 mm; at 6.4 mm a line of the card's vertices is 0.05 mm from a line of the table."""
    card = {"name": "card", "mesh": {"generator": "grid", "n_x": 6, "n_y": 8, "size_x_m": 0.0635, "size_y_m": 0.0889},
            "transform": {"translate_m": [0.013, y_m, 0.0006]},
            "material": {"youngs_N_per_m": 3e5, "poisson": 0.3, "density_kg_per_m2": 0.3, "bending_J": 0.001}}  # fmt: skip
    table = {"name": "table", "kind": "rigid", "mesh": {"generator": "grid", "n_x": 3, "n_y": 3, "size_x_m": 0.4, "size_y_m": 0.4}}
    policy = {"name": "fixed", "kappa_N_per_m": 50}
    return {"schema": "barrierbench.config/1", "scene": {"name": "bodies", "gravity_m_per_s2": [0, 0, -9.81], "bodies": [card, table]},
            "formulation": {"name": "log", "d_hat_m": 0.0005, "stiffness_policy": policy}, "time": {"dt_s": 0.01, "steps": 12}}  # fmt: skip


def rows_of(record: dict) -> list:
    return [{kind: step["contacts"][kind] for kind in ("point_point", "point_edge", "point_triangle", "edge_edge", "mollified")} for step in record["steps"]]


def test_blocks_change_no_digit_where_no_closest_point_is_at_a_border(program, tmp_path):
    """Vertices over triangles and crossing edges are in their blocks, so that blocks leave every row."""
    both = [run(program, tmp_path / model, card_on_table(0.007), **{"/contact/model": model}) for model in ("all_pairs", "offset_geometric")]
    rows = rows_of(both[0])
    assert sum(one["point_triangle"] for one in rows) > 300 and sum(one["edge_edge"] for one in rows) > 300
    assert sum(one["point_point"] + one["point_edge"] + one["mollified"] for one in rows) == 0
    assert rows == rows_of(both[1])
    for one, other in zip(*(record["steps"] for record in both), strict=True):
        for name in ("kinetic_J", "elastic_J", "contact_J", "gravity_J", "contact_load_sum_N", "gap_min_m"):
            assert one[name] == other[name]


def test_blocks_take_the_rows_at_borders_of_a_flat_table(program, tmp_path):
    both = [run(program, tmp_path / model, card_on_table(0.0064), **{"/contact/model": model}) for model in ("all_pairs", "offset_geometric")]
    every, left = ([sum(one["point_point"] + one["point_edge"] + one["mollified"] for one in rows_of(record)) for record in both])
    assert every > 0 and left == 0
    assert both[0]["steps"][-1]["kinetic_J"] != both[1]["steps"][-1]["kinetic_J"]
