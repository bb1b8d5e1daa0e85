"""The step solver xpbd through the program: a hanging chain, what its record says, what the plan leaves out, what is refused."""

import json
import math
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


def test_a_chain_ends_where_newton_ends_and_the_record_says_who_counted_what(program, tmp_path):
    newton = run(program, tmp_path / "newton")
    xpbd = run(program, tmp_path / "xpbd", *XPBD, "--set", "/step_solver/max_iterations=4000")
    assert (newton["status"]["outcome"], xpbd["status"]["outcome"]) == ("ok", "ok"), xpbd["status"]
    assert newton["steps"][-1]["elastic_J"] > 1e-9
    for energy in ("kinetic_J", "elastic_J", "gravity_J"):
        assert xpbd["steps"][-1][energy] == pytest.approx(newton["steps"][-1][energy], rel=1e-6)
    for step in xpbd["steps"]:
        assert step["newton_iterations"] == 0 and step["linear_solves"] == 0
        assert step["solver"]["xpbd_sweeps"] == 4000 and step["solver"]["xpbd_constraints"] == 16
        assert 0 <= step["solver"]["xpbd_correction_m"] < 1e-9
    assert xpbd["summary"]["solver"]["xpbd_sweeps"] == 12000
    assert xpbd["summary"]["solver"]["xpbd_correction_m"] == max(s["solver"]["xpbd_correction_m"] for s in xpbd["steps"])
    assert xpbd["summary"]["convergence"] == "not_asked"
    assert set(newton["summary"]["solver"]) == {"feasibility_trials"}
    assert newton["summary"]["solver"]["feasibility_trials"] == sum(s["solver"]["feasibility_trials"] for s in newton["steps"]) > 0
    assert math.isfinite(xpbd["summary"]["solver"]["xpbd_correction_m"])


def test_the_plan_leaves_out_what_it_does_without(program):
    said = bench(program, "explain", CHAIN, *XPBD).stdout
    _, _, left_out = said.partition("step_bound")  # the first of what is not needed
    for item in ("linear_solver", "trial_energies", "end_check"):
        line = next(line for line in said.splitlines() if line.split()[:1] == [item])
        assert "step solver" in line or "step_solver" in line, line
    assert "feasibility alone judges the trials" in left_out
    assert "feasibility alone" not in bench(program, "explain", CHAIN).stdout


@pytest.mark.parametrize(("config", "words", "said"), [
    (HANG, [], ["xpbd with the term", "offers no constraints"]),
    (CHAIN, ["--set", "/step_solver/saddle=report"], ["/step_solver/saddle"]),
    (CHAIN, ["--set", "/integrator/name=bdf2"], ["/integrator/name", "implicit_euler: the step solver is xpbd"]),
    (CHAIN, ["--set", "/device=host", "--set", "/linear_solver/name=pcg_resident"], ["/step_solver/name"]),
])
def test_what_it_cannot_step_is_refused_before_the_first_step(program, tmp_path, config, words, said):
    for verb in (["check", config], ["run", config, "--out", tmp_path / "out"]):
        refused(bench(program, *verb, *XPBD, *words), *said)
    assert not (tmp_path / "out" / "run.json").exists()
