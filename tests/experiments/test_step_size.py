"""Steps whose length the run chooses: what the record says of them, resuming, and what is refused."""

import json

import pytest
from test_cli import bench, refused, write
from test_resume import DRAPE, settings

CHOSEN = {"/matching": {"rule": "as_given"}, "/strain_limit/stiffness_policy/k_s_N_per_m": 50,
          "/formulation": {"name": "log", "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 50}},
          "/time/steps": 12, "/time/step_size": "adaptive", "/time/step_iterations": 4, "/time/step_halvings": 3}


@pytest.fixture
def config(tmp_path):
    return write(tmp_path / "drape.json", DRAPE)


def record_of(folder):
    return json.loads((folder / "run.json").read_text())


def test_lengths_follow_the_iterations_and_end_on_the_grid(program, config, tmp_path):
    assert bench(program, "run", config, "--out", tmp_path / "run", *settings(CHOSEN)).returncode == 0
    record = record_of(tmp_path / "run")
    assert record["status"]["outcome"] == "ok" and sum(step["contacts"]["total"] for step in record["steps"]) > 0
    dt, steps = record["config"]["time"]["dt_s"], record["steps"]
    halvings = [round(dt / step["dt_s"]).bit_length() - 1 for step in steps]
    assert all(step["dt_s"] == dt / 2**k for step, k in zip(steps, halvings, strict=True)) and max(halvings) > min(halvings)
    assert record["summary"]["dt_min_s"] == min(step["dt_s"] for step in steps)
    for step, k, after in zip(steps, halvings, halvings[1:], strict=False):
        if 2 * step["newton_iterations"] > 3 * 4:
            assert after == min(k + 1, 3), step["step"]
        elif 4 * step["newton_iterations"] > 3 * 4:
            assert after == k
        else:  # a longer step waits for its place on the grid
            assert after in (k, max(k - 1, 0))
    assert any(after < k for k, after in zip(halvings, halvings[1:], strict=False))
    assert steps[-1]["t_s"] == pytest.approx(12 * dt, rel=1e-14)


def test_an_error_that_is_asked_for_cuts_steps_that_are_cheap(program, config, tmp_path):
    fall = CHOSEN | {"/time/step_iterations": 1000, "/time/step_error_m": 1e-4, "/time/steps": 3}
    assert bench(program, "run", config, "--out", tmp_path / "run", *settings(fall)).returncode == 0
    lengths = [step["dt_s"] for step in record_of(tmp_path / "run")["steps"]]
    assert lengths[0] > lengths[1] > lengths[2]  # g h^2 / 2 of the first is above it


def test_a_run_that_is_stopped_goes_on_with_the_lengths_of_the_whole(program, config, tmp_path):
    words = settings(CHOSEN)
    assert bench(program, "run", config, "--out", tmp_path / "whole", *words).returncode == 0
    for _ in range(50):
        done = bench(program, "run", config, "--out", tmp_path / "cut", *words, "--step-limit", 5, "--resume")
        assert done.returncode == 0, done.stderr
        if record_of(tmp_path / "cut")["status"]["outcome"] != "timeout":
            break
    whole, cut = record_of(tmp_path / "whole"), record_of(tmp_path / "cut")
    assert cut["status"]["resumed_from_step"] > 0 and cut["summary"]["state_hash"] == whole["summary"]["state_hash"]
    assert [step["dt_s"] for step in cut["steps"]] == [step["dt_s"] for step in whole["steps"]]


@pytest.mark.parametrize(("more", "place", "allowed"), [
    ({"/time/step_size": "fixed"}, "/time/step_iterations", "step_size is fixed"),
    ({"/time/step_halvings": 11}, "/time/step_halvings", "<= 10"),
    ({"/time/step_size": "chosen"}, "/time/step_size", "adaptive"),
    ({"/step_solver/name": "accumulated_toi"}, "/time/step_size", "accumulated_toi"),
    ({"/time/step_error_m": 1e-3, "/integrator/name": "newmark"}, "/time/step_error_m", "newmark"),
])
def test_what_steps_of_chosen_length_cannot_have_is_refused_by_name(program, config, tmp_path, more, place, allowed):
    done = bench(program, "run", config, "--out", tmp_path / "run", *settings(CHOSEN | more))
    refused(done, place, code=2)
    assert allowed in done.stderr and not (tmp_path / "run").exists()


QUADRATIC = {"/formulation": {"shape": "quadratic", "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 50}}, "/strain_limit/enabled": False}
LITERAL = {"/scene": {"name": "drape2d", "variant": "pinned", "protocol": "article_literal", "pairs": "vertex_vertex"}, "/strain_limit/shape": "log", "/time/step_iterations": 1}
COMES_TO_ITS_END = {  # the barrier is bounded under penalty, and augmented_lagrangian may pass through: neither is tested here
    "line_search": {}, "al_barrier": {}, "augmented_lagrangian": {}, "penalty": QUADRATIC, "article_literal": LITERAL}


def test_every_step_solver_follows_it_or_is_refused_by_name(program, config, tmp_path):
    listed = {line.split()[0] for line in bench(program, "list", "step_solvers").stdout.splitlines() if line.startswith("  ") and not line.startswith("   ")}
    assert set(COMES_TO_ITS_END) < listed
    for name in sorted(listed):
        more = {key: value for key, value in (CHOSEN | {"/time/step_iterations": 2} | COMES_TO_ITS_END.get(name, {})).items() if not (name == "penalty" and key.endswith("k_s_N_per_m"))}
        words = settings(more | {"/step_solver/name": name, "/passes/audit": False})
        done = bench(program, "run", config, "--out", tmp_path / name, *words)
        if name not in COMES_TO_ITS_END:
            refused(done, "/time/step_size", name, code=2)
            continue
        assert done.returncode == 0, (name, done.stderr)
        record = record_of(tmp_path / name)
        dt, steps = record["config"]["time"]["dt_s"], record["steps"]
        assert record["status"]["outcome"] == "ok", (name, record["status"])
        assert len(steps) > 12 and steps[-1]["t_s"] == pytest.approx(12 * dt, rel=1e-14), name
        assert {round(dt / step["dt_s"]) for step in steps} <= {1, 2, 4, 8} and sum(step["contacts"]["total"] for step in steps) > 0, name


@pytest.mark.parametrize("more", [
    *({"/integrator/name": name} for name in ("half_gravity", "bdf2", "newmark")),
    {"/integrator/name": "quasi_static", "/scene": {"name": "hang"}}, {"/device": "host", "/linear_solver/name": "pcg_resident"}], ids=str)
def test_every_integrator_and_the_host_executor_follow_it(program, config, tmp_path, more):
    listed = {line.split()[0] for line in bench(program, "list", "integrators").stdout.splitlines() if line.startswith("  ") and not line.startswith("   ")}
    assert listed == {"implicit_euler", "half_gravity", "bdf2", "newmark", "quasi_static"}
    done = bench(program, "run", config, "--out", tmp_path / "run", *settings(CHOSEN | more | {"/time/step_iterations": 2}))
    assert done.returncode == 0, done.stderr
    record = record_of(tmp_path / "run")
    assert record["status"]["outcome"] == "ok" and len(record["steps"]) > 12
    assert record["steps"][-1]["t_s"] == pytest.approx(12 * record["config"]["time"]["dt_s"], rel=1e-14)
