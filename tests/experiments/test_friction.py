"""Friction of a whole run: a patch on a slope against Coulomb's law, every law and rule through the config, and what is refused."""

import json
import math
from pathlib import Path

import pytest
from test_cli import bench, refused

from barrierbench_analysis.studies.steps import step_corpus_page as page
from barrierbench_analysis.studies.catalogue.scenes import main as catalogue

ROOT = Path(__file__).resolve().parents[2]
SLOPE = ROOT / "configs/scenes/friction_slope.json"
G, ANGLE = 9.81, math.atan(0.5)
MASS = 0.2 * 0.2  # kg
EPS_V = 1e-3  # m/s


def slope(program: str, out: Path, **settings) -> list[dict]:
    """The steps of the run; settings by pointer, / written as __."""
    words = [w for name, value in settings.items() for w in ("--set", f"/{name.replace('__', '/')}={value}")]
    done = bench(program, "run", SLOPE, "--out", out, "--progress", "none", *words)
    assert done.returncode == 0, done.stderr
    record = json.loads((out / "run.json").read_text())
    assert record["status"]["outcome"] == "ok", record["status"]
    assert len(record["steps"]) == 60
    return record["steps"]


def speed(step: dict) -> float:
    return math.sqrt(2 * step["kinetic_J"] / MASS)


def acceleration(steps: list[dict]) -> float:
    """m/s^2, over the second half, when the patch has settled on its gap."""
    return (speed(steps[59]) - speed(steps[29])) / (steps[59]["t_s"] - steps[29]["t_s"])


def creep(law: str, mu: float) -> float:
    """m/s, at which the force of the law balances the slope: tan(ANGLE)/mu of mu times the load."""
    part = math.tan(ANGLE) / mu
    return EPS_V * (part if law == "capped" else 1 - math.sqrt(1 - part))


@pytest.mark.parametrize("law", ["smoothed_coulomb", "capped"])
@pytest.mark.parametrize("mu", [0.51, 0.6])
def test_above_the_tangent_of_the_slope_it_sticks_and_creeps(program, tmp_path, law, mu):
    steps = slope(program, tmp_path, friction__mu=mu, friction__law=law)
    assert speed(steps[59]) == pytest.approx(creep(law, mu), rel=0.05)
    assert speed(steps[59]) == pytest.approx(speed(steps[44]), rel=1e-3)
    assert (steps[59]["friction_sticking"], steps[59]["friction_sliding"]) == (9, 0)
    work = MASS * G * math.sin(ANGLE) * speed(steps[59]) * 0.005  # of the weight, all of it dissipated
    assert steps[59]["friction_dissipation_J"] == pytest.approx(work, rel=0.01)


@pytest.mark.parametrize(("mu", "tolerance"), [(0.2, 0.01), (0.4, 0.01), (0.49, 0.05)])
def test_below_it_slides_as_coulomb_says(program, tmp_path, mu, tolerance):
    steps = slope(program, tmp_path, friction__mu=mu)
    expected = G * (math.sin(ANGLE) - mu * math.cos(ANGLE))
    assert expected > 0.08
    assert acceleration(steps) == pytest.approx(expected, rel=tolerance)
    assert (steps[59]["friction_sticking"], steps[59]["friction_sliding"]) == (0, 9)
    lost = mu * MASS * G * math.cos(ANGLE) * (speed(steps[58]) + speed(steps[59])) / 2 * 0.005
    assert steps[59]["friction_dissipation_J"] == pytest.approx(lost, rel=0.02)


def test_the_coefficient_is_the_one_that_the_rule_makes_of_both_sides(program, tmp_path):
    sides = {"scene__bodies__0__friction": 0.1, "scene__obstacles__0__friction": 0.3}
    for rule, mu in {"min": 0.1, "max": 0.3, "mean": 0.2}.items():
        steps = slope(program, tmp_path / rule, friction__combine=rule, **sides)
        assert acceleration(steps) == pytest.approx(G * (math.sin(ANGLE) - mu * math.cos(ANGLE)), rel=0.01), rule


def test_a_repeated_lag_rubs_in_the_step_of_the_impact(program, tmp_path):
    """Let fall from 2 d_hat: no contact at the start of the step that makes the first one."""
    fall = {"scene__bodies__0__transform__translate_m": "[0.0008944271909999159,0,0.0017888543819998318]", "friction__mu": 0.2}
    rubbing = {}
    for times in (1, 2, 3):
        steps = slope(program, tmp_path / str(times), friction__lag_iterations=times, **fall)
        rubbing[times] = [step["step"] for step in steps if step["friction_sliding"] + step["friction_sticking"] > 0]
        touching = [step["step"] for step in steps if step["contact_load_sum_N"]]
        assert rubbing[times][0] == touching[0] + (times == 1) > 1
    assert rubbing[2][0] == rubbing[1][0] - 1


def test_without_a_coefficient_there_is_no_term_and_no_loss(program, tmp_path):
    steps = slope(program, tmp_path, friction__mu=0)
    assert acceleration(steps) == pytest.approx(G * math.sin(ANGLE), rel=1e-3)
    assert steps[59]["friction_dissipation_J"] is None and steps[59]["friction_dissipation_J_status"] == "no_friction"
    plan = json.loads((tmp_path / "run.json").read_text())["plan"]
    assert [item["active"] for item in plan if item["item"] == "friction"] == [False]


def test_bits_do_not_depend_on_threads(program, tmp_path):
    hashes = set()
    for threads in (1, 2):
        steps = slope(program, tmp_path / str(threads), threads=threads)
        assert steps[59]["friction_sticking"] == 9
        hashes.add(json.loads((tmp_path / str(threads) / "run.json").read_text())["summary"]["state_hash"])
    assert len(hashes) == 1


@pytest.mark.parametrize(("setting", "message"), [
    ("/friction/mu=-0.1", "/friction/mu"), ("/scene/bodies/0/friction=-1", "/scene/bodies/0/friction"),
    ("/scene/obstacles/0/friction=-1", "/scene/obstacles/0/friction"), ("/friction/eps_v_m_per_s=0", "/friction/eps_v_m_per_s"),
    ("/friction/lag_iterations=0", "/friction/lag_iterations"), ("/friction/law=coulomb", "smoothed_coulomb, capped, static_kinetic"), ("/friction/combine=most", "min, max, mean"),
])
def test_what_has_no_meaning_is_refused(program, tmp_path, setting, message):
    refused(bench(program, "run", SLOPE, "--out", tmp_path, "--set", setting), message)


def published(program: str, out: Path, *settings: str, changed: bool = False) -> dict:
    words = [w for setting in ("/method=ando2024", *settings) for w in ("--set", setting)]
    done = bench(program, "run", SLOPE, "--out", out, "--progress", "none", *words)
    assert done.returncode == 0, done.stderr
    record = json.loads((out / "run.json").read_text())
    assert record["status"]["outcome"] == "ok"
    assert record["labels"]["method"] == "ando2024" + ", changed" * changed, record["method"]
    return record


def late_acceleration(record: dict) -> float:
    """m/s^2, once the patch, which is thrown up by a stiffer contact than the scene was made for, has come down."""
    late = [step for step in record["steps"] if step["t_s"] > 0.15]
    assert len(late) > 100 and all((s["friction_sticking"], s["friction_sliding"]) == (0, 9) for s in late)
    return (speed(late[-1]) - speed(late[0])) / (late[-1]["t_s"] - late[0]["t_s"])


@pytest.mark.parametrize("mu", [0.2, 0.4])
def test_the_cubic_papers_method_slides_as_coulomb_says(program, tmp_path, mu):
    """Steps of its own length, in single precision, with the loads of every iterate; 32 iterations a step, as its authors advise for friction."""
    record = published(program, tmp_path, f"/friction/mu={mu}", "/step_solver/min_newton_steps=32", changed=True)
    form = {"law": "capped", "refresh": "per_iteration", "hessian": "secant", "eps_m": 1e-5, "combine": "max"}
    assert {key: record["config"]["friction"][key] for key in form} == form
    assert "multiplicities" in record["method"]["differs"]["contacts"] and "as there" in record["method"]["differs"]["friction and air"]
    expected = G * (math.sin(ANGLE) - mu * math.cos(ANGLE))
    assert late_acceleration(record) == pytest.approx(expected, abs=0.01 * mu * G * math.cos(ANGLE))


def test_in_one_iteration_a_step_as_published_ends_before_its_friction_has_converged(program, tmp_path):
    """The matrix with lambda in both directions lets a slide grow by a part of itself alone in an iteration."""
    record = published(program, tmp_path, "/friction/mu=0.2")
    too_much = G * (math.sin(ANGLE) - 0.2 * math.cos(ANGLE)) - late_acceleration(record)
    assert 0.05 < too_much / (0.2 * G * math.cos(ANGLE)) < 0.3


def test_the_cubic_papers_method_sticks_and_creeps_below_its_threshold(program, tmp_path):
    record = published(program, tmp_path, "/friction/mu=0.6")
    last = record["steps"][-1]
    assert (last["friction_sticking"], last["friction_sliding"]) == (9, 0)
    assert speed(last) == pytest.approx(1e-5 / 1e-3 * math.tan(ANGLE) / 0.6, rel=0.01)  # eps a step, times the part of mu


def test_without_a_coefficient_a_method_leaves_friction_as_it_is(program, tmp_path):
    record = published(program, tmp_path, "/friction/mu=0", "/time/duration_s=0.02")
    assert record["config"]["friction"]["law"] == "smoothed_coulomb" and "refresh" not in record["config"]["friction"]
    assert record["method"]["differs"]["friction and air"].startswith("energy/model/friction.hpp")


def test_a_method_that_says_nothing_of_friction_refuses_it(program, tmp_path):
    words = ["--set", "/method=ipc2020", "--set", "/friction/mu=0.3"]
    refused(bench(program, "run", SLOPE, "--out", tmp_path, *words), "/friction/mu", "0 with method ipc2020")


def test_a_setting_of_friction_beside_a_method_overrides_it(program, tmp_path):
    words = ["--set", "/method=ando2024", "--set", "/friction/mu=0.3", "--set", "/friction/eps_m=1e-4"]
    text = bench(program, "explain", SLOPE, *words).stdout
    assert "ando2024, changed" in text and "overridden: /friction/eps_m" in text


TWO = {"friction__law": "static_kinetic"}


@pytest.mark.parametrize("mu", [0.2, 0.4])
def test_two_coefficients_hold_by_the_static_one_and_brake_by_the_kinetic_one(program, tmp_path, mu):
    held = slope(program, tmp_path / "held", friction__mu=mu, friction__mu_static=0.53, **TWO)
    assert (held[59]["friction_sticking"], held[59]["friction_sliding"]) == (9, 0)
    assert speed(held[59]) == pytest.approx(creep("static_kinetic", 0.53), rel=0.05)
    slides = slope(program, tmp_path / "slides", friction__mu=mu, friction__mu_static=0.45, **TWO)
    expected = G * (math.sin(ANGLE) - mu * math.cos(ANGLE))
    assert acceleration(slides) == pytest.approx(expected, abs=0.01 * mu * G * math.cos(ANGLE))
    assert (slides[59]["friction_sticking"], slides[59]["friction_sliding"]) == (0, 9)


def test_the_rule_of_combination_is_of_both_coefficients(program, tmp_path):
    sides = {"scene__bodies__0__friction": 0.1, "scene__bodies__0__friction_static": 0.6,
             "scene__obstacles__0__friction": 0.3, "scene__obstacles__0__friction_static": 0.4}
    for rule, (kinetic, sticks) in {"min": (0.1, False), "max": (0.3, True), "mean": (0.2, False)}.items():
        changed = sides | {"scene__obstacles__0__friction_static": 0.38} if rule == "mean" else sides
        steps = slope(program, tmp_path / rule, friction__law="static_kinetic", friction__combine=rule, friction__mu=0, **changed)
        assert (steps[59]["friction_sticking"] == 9) == sticks
        if not sticks:
            expected = G * (math.sin(ANGLE) - kinetic * math.cos(ANGLE))
            assert acceleration(steps) == pytest.approx(expected, rel=0.01), rule


@pytest.mark.parametrize(("settings", "message"), [
    (["/friction/mu_static=0.6"], ("/friction/mu_static", "smoothed_coulomb", "static_kinetic")),
    (["/friction/law=capped", "/scene/bodies/0/friction_static=0.6"], ("/scene/bodies/0/friction_static", "capped")),
    (["/friction/law=static_kinetic", "/friction/mu_static=0.5"], ("/friction/mu_static", "0.5", "0.51", "/friction/mu is")),
    (["/friction/law=static_kinetic", "/scene/obstacles/0/friction_static=0.5"], ("/scene/obstacles/0/friction_static", "0.51")),
    (["/friction/law=static_kinetic", "/scene/bodies/0/friction=0.7", "/scene/bodies/0/friction_static=0.6"], ("/scene/bodies/0/friction_static", "0.6", "0.7")),
    (["/friction/law=static_kinetic", "/friction/kinetic_v_m_per_s=1e-3"], ("/friction/kinetic_v_m_per_s", "eps_v_m_per_s")),
    (["/friction/law=static_kinetic", "/friction/kinetic_v_m_per_s=1e-1", "/friction/eps_m=1e-5"], ("/friction/kinetic_v_m_per_s", "eps_m")),
    (["/friction/kinetic_v_m_per_s=1e-1"], ("/friction/kinetic_v_m_per_s", "smoothed_coulomb")),
    (["/friction/refresh=per_iteration", "/friction/lag_iterations=2"], ("/friction/lag_iterations", "per_iteration")),
    (["/friction/refresh=per_iteration", "/step_solver/name=pncg"], ("/friction/refresh", "pncg", "line_search, accumulated_toi, penalty")),
    (["/friction/hessian=secant"], ("/friction/hessian", "exact or adaptive", "line_search")),
])
def test_forms_of_friction_that_contradict_each_other_are_refused(program, tmp_path, settings, message):
    words = [w for setting in settings for w in ("--set", setting)]
    refused(bench(program, "run", SLOPE, "--out", tmp_path, *words), *message)


def test_loads_of_every_iterate_end_where_a_lag_ends_that_was_renewed_often(program, tmp_path):
    """A patch that falls onto the slope: its load changes within steps."""
    fall = {"scene__bodies__0__transform__translate_m": "[0.0008944271909999159,0,0.0017888543819998318]", "friction__mu": 0.2}
    ends = {}
    for name, form in {"once": {}, "often": {"friction__lag_iterations": 30}, "iterate": {"friction__refresh": "per_iteration"}}.items():
        ends[name] = slope(program, tmp_path / name, **fall, **form)
    first = next(k for k, step in enumerate(ends["iterate"]) if step["contact_load_sum_N"])
    loss = {name: sum(step["friction_dissipation_J"] or 0 for step in steps[: first + 5]) for name, steps in ends.items()}
    assert loss["often"] > 0 and loss["iterate"] == pytest.approx(loss["often"], rel=1e-3)
    assert abs(loss["once"] / loss["often"] - 1) > 0.01


def test_another_step_solver_does_not_repeat_the_lag(program, tmp_path):
    words = ["--set", "/step_solver/name=accumulated_toi", "--set", "/friction/lag_iterations=2"]
    refused(bench(program, "run", SLOPE, "--out", tmp_path, *words), "/friction/lag_iterations")


def test_another_step_solver_has_no_secant(program, tmp_path):
    words = ["--set", "/step_solver/name=accumulated_toi", "--set", "/friction/hessian=adaptive"]
    refused(bench(program, "run", SLOPE, "--out", tmp_path, *words), "/friction/hessian", "line_search, penalty")
    refused(bench(program, "run", SLOPE, "--out", tmp_path, "--set", "/friction/hessian=whole"), "/friction/hessian", "exact, adaptive, secant")


def test_the_secant_takes_fewer_iterations_to_the_same_minimum(program, tmp_path):
    """A soft heavy body on a membrane: its contacts turn round within the step."""
    words = ["--only", "trampoline_deepest", "--progress", "none", "--out", tmp_path / "steps.json"]
    done = bench(program, "steps", "--corpus", ROOT / "results/steps", *words)
    assert done.returncode == 0, done.stderr
    (state,) = json.loads((tmp_path / "steps.json").read_text())["states"]
    adaptive, exact = (page.trial_of(state, rule) for rule in ("blend", "blend" + page.EXACT))
    assert adaptive["minimum"] == exact["minimum"] == "A"
    assert 5 < adaptive["iterations_to_tolerance"] < exact["iterations_to_tolerance"] / 2


@pytest.mark.parametrize("solver", ["line_search", "penalty", "augmented_lagrangian", "al_barrier"])
def test_every_step_solver_that_has_the_secant_takes_it_and_counts_it(program, tmp_path, solver):
    """Cards that fall on each other, by a barrier that every one of these solvers can have."""
    file = tmp_path / "cards.json"
    assert catalogue(["cards", "--write", str(file)]) == 0
    words = ["--set", "/formulation=cubic", "--set", f"/step_solver/name={solver}", "--step-limit", "16", "--progress", "none"]
    taken = {}
    for rule in ("adaptive", "exact"):
        done = bench(program, "run", file, *words, "--set", f"/friction/hessian={rule}", "--out", tmp_path / rule)
        record = json.loads((tmp_path / rule / "run.json").read_text())
        assert record["summary"]["steps"] == 16 and max(step["contacts"]["total"] for step in record["steps"]) > 10, done.stderr
        (taken[rule],) = (value for name, value in record["summary"]["solver"].items() if name.endswith("secants"))
    assert taken["adaptive"] > 0 == taken["exact"]


def test_a_step_whose_iterations_end_with_a_lag_is_not_converged(program, tmp_path):
    """A cap from 1 up: each run ends with a word, and one of them at the very iteration that takes the lag anew."""
    words = ["--set", "/time/steps=30", "--set", "/friction/mu=0.6", "--set", "/friction/lag_iterations=2", "--progress", "none"]
    free = bench(program, "run", SLOPE, "--out", tmp_path / "free", *words)
    assert free.returncode == 0, free.stderr
    most = max(step["newton_iterations"] for step in json.loads((tmp_path / "free/run.json").read_text())["steps"])
    assert most > 2
    unfinished = 0
    for cap in range(1, most):
        done = bench(program, "run", SLOPE, "--out", tmp_path / str(cap), *words, "--set", f"/step_solver/max_iterations={cap}")
        assert done.returncode == 0, done.stderr
        record = json.loads((tmp_path / str(cap) / "run.json").read_text())
        assert record["status"]["outcome"] != "ok"
        last = record["steps"][-1]
        assert last["status"] == "iteration_cap" and float(last["detail"].split()[1]) > 0, last
        unfinished += last["friction_dissipation_J"] is None
    assert unfinished > 0  # a lag that no iterate has read yet is no dissipation


def test_a_run_that_goes_on_from_a_checkpoint_slides_as_one_that_was_not_stopped(program, tmp_path):
    words = ["--set", "/friction/mu=0.3", "--set", "/output/checkpoint_every=10", "--progress", "none"]
    whole = bench(program, "run", SLOPE, "--out", tmp_path / "whole", *words)
    assert whole.returncode == 0, whole.stderr
    one = json.loads((tmp_path / "whole/run.json").read_text())
    folder = tmp_path / "cut"
    assert bench(program, "run", SLOPE, "--out", folder, *words, "--step-limit", "23").returncode == 0
    cut = json.loads((folder / "run.json").read_text())
    assert cut["status"]["outcome"] == "timeout" and len(cut["steps"]) == 23
    on = bench(program, "run", SLOPE, "--out", folder, *words, "--resume")
    assert on.returncode == 0, on.stderr
    other = json.loads((folder / "run.json").read_text())
    assert other["summary"]["state_hash"] == one["summary"]["state_hash"]
    assert other["steps"][59]["friction_sliding"] == one["steps"][59]["friction_sliding"] == 9
