"""The step solver xpbd through the program: a hanging chain, what its record says, what the plan leaves out, what is refused."""

import json
from pathlib import Path

import pytest
from test_cli import bench, refused

ROOT = Path(__file__).resolve().parents[2]
CHAIN, HANG = ROOT / "configs/scenes/chain.json", ROOT / "configs/scenes/hang.json"
XPBD = ["--set", "/step_solver/name=xpbd"]


def run(program: str, out: Path, *words: str) -> dict:
    done = bench(program, "run", CHAIN, "--out", out, "--progress", "none", "--set", "/time/steps=3", "--set", "/time/dt_s=0.01", *words)
    assert done.returncode == 0, done.stderr
    return json.loads((out / "run.json").read_text())


STILL = ["--set", "/scene/bodies/0/pins/1/motion/velocity_m_per_s=[0,0,0]"]


def test_a_chain_sags_as_newton_has_it_and_the_record_says_who_counted_what(program, tmp_path):
    newton = run(program, tmp_path / "newton", *STILL)
    xpbd = run(program, tmp_path / "xpbd", *STILL, *XPBD, "--set", "/step_solver/max_iterations=4000")
    assert (newton["status"]["outcome"], xpbd["status"]["outcome"]) == ("ok", "ok"), xpbd["status"]
    assert newton["steps"][-1]["kinetic_J"] > 1e-3
    assert xpbd["steps"][-1]["kinetic_J"] == pytest.approx(newton["steps"][-1]["kinetic_J"], rel=0.01)
    for step in xpbd["steps"]:
        assert step["newton_iterations"] == 0 and step["linear_solves"] == 0
        assert step["solver"]["xpbd_sweeps"] == 4000 and step["solver"]["xpbd_constraints"] == 16
        assert 0 <= step["solver"]["xpbd_correction_m"] < 1e-9
    assert xpbd["summary"]["solver"]["xpbd_sweeps"] == 12000
    assert xpbd["summary"]["solver"]["xpbd_correction_m"] == max(s["solver"]["xpbd_correction_m"] for s in xpbd["steps"])
    assert xpbd["summary"]["convergence"] == "not_asked"


def test_trials_short_of_a_pose_are_counted_and_compare_no_energies(program, tmp_path):
    record = run(program, tmp_path, "--set", "/passes/diagnose=true")
    assert set(record["summary"]["solver"]) == {"feasibility_trials", "truncations", "lengthened", "secants"} and record["summary"]["solver"]["truncations"] == 0
    assert record["summary"]["solver"]["feasibility_trials"] == sum(s["solver"]["feasibility_trials"] for s in record["steps"]) > 0
    rows = [json.loads(line) for line in (tmp_path / "trace.jsonl").read_text().splitlines()]
    unknown = [row for row in rows if row["energy_change_J"] is None]
    assert 0 < len(unknown) < len(rows) and {row["energy_change_J_status"] for row in unknown} == {"not_compared"}


def test_the_plan_leaves_out_what_it_does_without(program):
    message = bench(program, "explain", CHAIN, *XPBD).stdout
    for item, reason in [("linear_solver", "no matrix"), ("trial_energies", "feasibility alone"), ("end_check", "saddle is ignore")]:
        line = next(line for line in message.splitlines() if line.split()[:1] == [item])
        assert reason in line, line
    assert "feasibility alone" not in bench(program, "explain", CHAIN).stdout


@pytest.mark.parametrize(("config", "words", "message"), [
    (HANG, [], ["xpbd with the term", "offers no constraints"]),
    (CHAIN, ["--set", "/step_solver/saddle=report"], ["/step_solver/saddle"]),
    (CHAIN, ["--set", "/integrator/name=bdf2"], ["/integrator/name", "implicit_euler: the step solver is xpbd"]),
    (CHAIN, ["--set", "/device=host", "--set", "/linear_solver/name=pcg_resident"], ["/step_solver/name"]),
])
def test_what_it_cannot_step_is_refused_before_the_first_step(program, tmp_path, config, words, message):
    for verb in (["check", config], ["run", config, "--out", tmp_path / "out"]):
        refused(bench(program, *verb, *XPBD, *words), *message)
    assert not (tmp_path / "out" / "run.json").exists()
