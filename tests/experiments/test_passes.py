"""What each pass may leave: times come from the run that nobody looked at, a trace from the one that somebody did."""

import json
from pathlib import Path

import pytest
from test_cli import BLOCK, bench, write

PASSES = {"time only": (True, False), "audit only": (False, True), "both": (True, True)}


def run(program: str, out: Path, *passes: bool, more: tuple[str, ...] = ()) -> dict:
    timed, audited = passes
    settings = ["--set", f"/passes/time={json.dumps(timed)}", "--set", f"/passes/audit={json.dumps(audited)}"]
    done = bench(program, "run", BLOCK, "--out", out, "--set", "/time/steps=3", *settings, *more)
    assert done.returncode == 0, done.stderr
    return json.loads((out / "run.json").read_text())


def trace(out: Path) -> list[dict]:
    return [json.loads(line) for line in (out / "trace.jsonl").read_text().splitlines()]


def test_no_time_of_an_observed_run_is_reported(program, tmp_path):
    record = run(program, tmp_path, *PASSES["audit only"])
    summary = record["summary"]
    assert summary["wall_s"] is None and summary["solve_s"] is None
    assert summary["wall_s_status"] == summary["solve_s_status"] == "not_requested"
    assert summary["time"] == {} and "wall_s" not in record["samples"]
    assert all(step["time"] == {} for step in record["steps"])
    assert all(row["time"] == {} for row in trace(tmp_path))


def test_the_times_of_the_timed_run_stand_beside_what_was_observed(program, tmp_path):
    record = run(program, tmp_path, *PASSES["both"])
    summary, rows = record["summary"], trace(tmp_path)
    assert summary["wall_s"] > summary["solve_s"] > 0
    for phase in ("elastic_s", "linear_factor_s"):
        of_steps = sum(step["time"][phase] for step in record["steps"])
        assert of_steps == pytest.approx(summary["time"][phase])
        assert sum(row["time"][phase] for row in rows) == pytest.approx(of_steps)


def test_a_trace_that_nobody_leaves_is_named_and_an_earlier_one_goes(program, tmp_path):
    observed = run(program, tmp_path, *PASSES["both"])
    assert len(trace(tmp_path)) == observed["summary"]["newton_iterations"]
    assert {"item": "trace", "active": True, "reason": "a run is observed"} in observed["plan"]

    record = run(program, tmp_path, *PASSES["time only"], more=("--replace",))
    assert not (tmp_path / "trace.jsonl").exists()
    assert {"metric": "trace", "reason": "not_requested"} in record["skipped"]
    assert [p["active"] for p in record["plan"] if p["item"] == "trace"] == [False]
    assert record["summary"]["state_hash"] == observed["summary"]["state_hash"]
    assert record["steps"][0]["time"] and record["summary"]["solve_s"] > 0
    explained = bench(program, "explain", BLOCK, "--set", "/passes/audit=false").stdout
    assert "trace" in explained.split("skipped")[1]


def test_a_sweep_goes_on_after_a_case_that_fails_midway(program, build_folder, tmp_path):
    plugin = build_folder / "tests/barriers/plugin_negative_weight.so"
    if not plugin.exists():
        pytest.skip(f"{plugin} is not built")
    spec = write(tmp_path / "sweep.json", {
        "schema": "barrierbench.sweep/1", "name": "integrators", "base": BLOCK,
        "set": {"/time/steps": 2, "/matching/rule": "as_given"},
        "axes": [{"pointer": "/integrator/name", "values": ["negative_weight", "implicit_euler"]}]})
    done = bench(program, "--plugin", plugin, "sweep", spec, "--out", tmp_path / "out")
    assert done.returncode == 2 and "[name=negative_weight]" in done.stderr and "c = -1" in done.stderr
    assert "no record" in done.stdout
    assert [json.loads(p.read_text())["labels"]["integrator"] for p in (tmp_path / "out").glob("*/run.json")] == ["implicit_euler"]
    # what an earlier build left there stays, but takes no part in the sweep
    words = ["--set", "/time/steps=2", "--set", '/matching/rule="as_given"', "--set", '/integrator/name="{}"']
    ids = {}
    for name in ("negative_weight", "implicit_euler"):
        reported = bench(program, "--plugin", plugin, "explain", BLOCK, *(word.format(name) for word in words)).stdout
        ids[name] = reported.splitlines()[0].rsplit("-", 1)[1]
    assert [p.name for p in (tmp_path / "out").glob("name=*")] == [f"name=implicit_euler-{ids['implicit_euler']}"]
    failed = tmp_path / "out" / f"name=negative_weight-{ids['negative_weight']}"
    failed.mkdir()
    for name in ("run.json", "trace.jsonl"):
        write(failed / name, "{}")
    again = bench(program, "--plugin", plugin, "sweep", spec, "--out", tmp_path / "out", "--again")
    assert again.returncode == 2 and again.stdout.count("no record; the one of an earlier sweep stays") == 1
    assert sorted((p.name, p.read_text()) for p in failed.iterdir()) == [("run.json", "{}"), ("trace.jsonl", "{}")]
    ran = json.loads(next((tmp_path / "out").glob("name=implicit_euler-*/run.json")).read_text())
    assert ran["comparability"]["reference_run"].startswith("name=implicit_euler-")


def test_a_default_reference_is_of_the_same_step_length(program, tmp_path):
    spec = write(tmp_path / "sweep.json", {
        "schema": "barrierbench.sweep/1", "name": "steps", "base": BLOCK, "set": {"/time/steps": 4},
        "axes": [{"pointer": "/time/dt_s", "values": [0.01, 0.005]},
                 {"pointer": "/formulation", "values": ["cubic", "log"]}]})
    assert bench(program, "sweep", spec, "--out", tmp_path / "out").returncode == 0
    runs = [json.loads(p.read_text()) for p in (tmp_path / "out").glob("*/run.json")]
    assert len(runs) == 4
    for run in runs:
        reference = run["comparability"]["reference_run"]
        assert "formulation=log" in reference and f"dt_s={run['labels']['dt_s']}" in reference


def test_explain_names_the_bounds_of_an_adaptive_kappa(program):
    done = bench(program, "explain", BLOCK, "--set", "/formulation=ipc2020", "--set",
                 "/formulation/stiffness_policy/kappa_min_N_per_m=5", "--set", "/formulation/stiffness_policy/doubling_gap_m=1e-9")
    assert done.returncode == 0, done.stderr
    assert "ipc_adaptive, doubling_gap_m 1e-09, kappa_min_N_per_m 5.0" in done.stdout


DRAPE = Path(BLOCK).parent / "drape.json"


@pytest.fixture(scope="module")
def drape(program, tmp_path_factory) -> dict:
    """Two layers of a small drape beyond their first contacts, timed and audited."""
    out = tmp_path_factory.mktemp("drape")
    done = bench(program, "run", DRAPE, "--out", out, "--set", "/scene/n=8", "--set", "/scene/layers=2", "--set", "/time/steps=12",
                 "--set", "/formulation=cubic_dynamic_lagged", "--set", "/matching/rule=as_given", "--set", "/step_solver/max_iterations=50")
    assert done.returncode == 0, done.stderr
    return json.loads((out / "run.json").read_text())


def test_every_moment_of_a_step_belongs_to_a_phase(drape):
    def adds_up(place: dict) -> bool:
        return sum(place["time"].values()) + place["unaccounted_s"] == pytest.approx(place["wall_s"], abs=1e-12)

    summary = drape["summary"]
    assert max(step["contacts"]["total"] for step in drape["steps"]) > 0
    assert adds_up(summary) and all(adds_up(step) for step in drape["steps"])
    assert 0 <= summary["unaccounted_s"] < 0.02 * summary["wall_s"]
    assert summary["wall_s"] == pytest.approx(sum(step["wall_s"] for step in drape["steps"]))
    assert summary["solve_s"] == pytest.approx(sum(summary["time"].values()) - summary["time"]["output_s"])
    phases = json.loads((DRAPE.parents[1] / "schema/run.schema.json").read_text())["$defs"]["PhaseTimes"]["properties"]
    assert set(summary["time"]) == set(phases), "a phase of the schema that a scene with all kinds of work never charges"


def test_the_first_record_of_a_process_knows_its_blas_threads(drape):
    assert drape["provenance"]["blas"]["threads"] == 1


def test_the_estimator_ritz_reads_the_ritz_values_of_every_solve(program, tmp_path):
    settings = ["/linear_solver/name=pcg", "/linear_solver/forcing=fixed", "/diagnose/estimator=ritz", "/passes/diagnose=true", "/time/steps=2", "/scene/n=6", "/scene/layers=1"]
    done = bench(program, "run", DRAPE, "--out", tmp_path, *(word for setting in settings for word in ("--set", setting)))
    assert done.returncode == 0, done.stderr
    summary = json.loads((tmp_path / "run.json").read_text())["summary"]
    rows = trace(tmp_path)
    assert list(summary["cond"]) == ["solved/full/block_jacobi"]  # the exact Hessian is what PCG solves
    assert summary["cond"]["solved/full/block_jacobi"]["statuses"] == {"lower_bound": len(rows)}
    for row in rows:
        estimate, = row["cond"]
        assert estimate["tier"] == 0 and estimate["method"] == "ritz"
        assert estimate["cond"] == pytest.approx(row["ritz_max"] / row["ritz_min"])


def test_every_estimate_says_who_found_it_and_what_is_proven(program, tmp_path):
    found = {}
    for name, more in (("spectra", []), ("cut", ["/diagnose/max_solves=3", "/diagnose/max_products=3"]), ("lanczos", ["/diagnose/estimator=lanczos"])):
        settings = ["/passes/diagnose=true", "/passes/time=false", "/passes/audit=false", "/diagnose/pcg=false", "/time/steps=3", "/scene/n=6",
                    "/scene/layers=1", *more]
        done = bench(program, "run", DRAPE, "--out", tmp_path / name, *(word for setting in settings for word in ("--set", setting)))
        assert done.returncode == 0, done.stderr
        record = json.loads((tmp_path / name / "run.json").read_text())
        assert record["summary"]["wall_s"] is None, "what estimates take is no time of the method"
        found[name] = [one for row in trace(tmp_path / name) for one in row["cond"] if one["status"] == "ok"]
    assert len(found["spectra"]) == len(found["cut"]) == len(found["lanczos"]) > 5
    for by_spectra, cut, lanczos in zip(found["spectra"], found["cut"], found["lanczos"]):
        assert by_spectra["method"] == "spectra" and by_spectra["tier"] == 2
        assert "smallest by lanczos" in cut["method"] and "largest by lanczos" in cut["method"]
        assert lanczos["method"].startswith("lanczos") and lanczos["tier"] == 4
        assert {one["proof"] for one in (by_spectra, cut, lanczos)} == {"both"}
        assert 4 <= by_spectra["solves"] <= 61 and 4 <= by_spectra["products"] <= 202 and by_spectra["time_s"] > 0
        assert cut["cond"] == pytest.approx(by_spectra["cond"], rel=1e-3)
        assert lanczos["cond"] == pytest.approx(by_spectra["cond"], rel=1e-3)
