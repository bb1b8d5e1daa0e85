"""al_barrier and al_free through the program: a fast motion that passes through surfaces without a step bound ends clean, records have
the counters, what does not go with them is refused by name."""

import json

import pytest
from test_cli import bench, refused
from test_step_solver_baselines import run, shot

SOLVERS = ["al_barrier", "al_free"]
OWN = {"al_barrier": "al_barrier_near", "al_free": "al_free_standoff"}


@pytest.mark.parametrize("solver", SOLVERS)
def test_what_is_fast_does_not_pass_through(program, tmp_path, solver):
    through = run(program, shot(tmp_path, 0), tmp_path / "through", "penalty")
    assert through["status"]["outcome"] == "penetration"
    record = run(program, shot(tmp_path, 0), tmp_path / "out", solver)
    assert record["status"]["outcome"] == "ok", record["status"]
    assert record["audit"]["judged"] and not record["audit"]["crossings"] + record["audit"]["violations"] + record["audit"]["unproven"]
    assert record["summary"]["gap_min_m"] > 0
    counted = record["summary"]["solver"]
    assert all(name.startswith(solver) for name in counted)
    if solver == "al_free":
        assert counted["al_free_admitted"] > 0 and counted["al_free_force_N"] > 0
        assert record["summary"]["convergence"] == "not_asked"


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_resolved_config_has_the_settings_of_its_own_solver(program, tmp_path, solver):
    stated = run(program, shot(tmp_path, 0), tmp_path / solver, solver)["config"]["step_solver"]
    assert {name for name in OWN.values() if name in stated} == {OWN[solver]}


@pytest.mark.parametrize("solver", SOLVERS)
def test_list_and_explain_say_what_they_guarantee(program, tmp_path, solver):
    message = bench(program, "explain", shot(tmp_path, 0), "--set", f"/step_solver/name={solver}").stdout
    line = next(line for line in message.splitlines() if line.startswith("guarantee "))
    assert line.split()[1] == solver + ":" and "no surface passes through another" in line
    assert line.split(": ", 1)[1] in bench(program, "list", "step_solvers").stdout


def test_the_same_bits_with_one_thread_and_with_two(program, tmp_path):
    for solver in SOLVERS:
        ends = {run(program, shot(tmp_path, 0.002), tmp_path / f"{solver}{n}", solver, "--set", f"/threads={n}")["summary"]["state_hash"] for n in (1, 2)}
        assert len(ends) == 1, solver


@pytest.mark.parametrize(("solver", "words", "message"), [
    ("al_barrier", ["/step_solver/al_barrier_near=1"], ["/step_solver/al_barrier_near"]),
    ("al_barrier", ["/step_solver/al_barrier_growth=0.5"], ["/step_solver/al_barrier_growth"]),
    ("al_free", ["/step_solver/al_free_standoff=0"], ["/step_solver/al_free_standoff"]),
    ("al_free", ["/step_solver/al_free_decay=1"], ["/step_solver/al_free_decay"]),
    ("al_free", ["/step_solver/saddle=escape"], ["/step_solver/saddle"]),
    ("al_free", ["/contact/step_bound=per_vertex"], ["/contact/step_bound"]),
])
def test_what_does_not_go_with_them_is_refused_by_name(program, tmp_path, solver, words, message):
    sets = [word for each in words for word in ("--set", each)]
    refused(bench(program, "check", shot(tmp_path, 0), "--set", f"/step_solver/name={solver}", *sets), *message)


@pytest.mark.parametrize(("solver", "words", "message"), [
    ("al_barrier", ["/step_solver/al_barrier_release=0.005"], "al_barrier_release"),
    ("al_free", ["/friction/mu=0.3"], "friction"),
])
def test_what_only_a_run_can_know_is_refused_before_its_first_step(program, tmp_path, solver, words, message):
    sets = [word for each in words for word in ("--set", each)]
    done = bench(program, "run", shot(tmp_path, 0), "--out", tmp_path / "out", "--progress", "none", "--set", f"/step_solver/name={solver}", *sets)
    assert done.returncode != 0 and message in done.stderr
    record = tmp_path / "out" / "run.json"
    assert not record.exists() or json.loads(record.read_text())["status"]["outcome"] == "invalid_config"
