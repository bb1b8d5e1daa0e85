"""The study at size: what it reads of a run, its six questions and three laws, on numbers that are known."""

import json
import math
import subprocess
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import nct, t

from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.program.start import built_program
from barrierbench_analysis.studies.claims.merged import put
from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.studies.rules.at_size import causes, laws, loads, measured, p_values, questions, stops
from barrierbench_analysis.studies.rules.at_size.pairs import Rows, Where

STUDY = read_study("at_size")
SHELLS = [s["label"] for s in STUDY.about["scenes"] if s["kind"] != "solid"]
EVERY = [s["label"] for s in STUDY.about["scenes"]]


def line(step=0, **more):
    found = {
        "step": step, "alpha": 1.0, "alpha_ccd": 1.0, "alpha_strain": 1.0, "hessian_t": 0.0, "hessian_fallbacks": 0,
        "contacts": {"total": 1}, "dx_inf_m": 1.0, "grad_inf_N": 1.0, "gap_min_iterates_rel": 0.5, "linear_iterations": 10,
        "factor_flop": 100, "time": {"elastic_s": 0.25, "output_s": None}, "contact_load_max_N": 1.0,
        "contact_curvature_max_N_per_m": 4.0, "cond": [], "probe_pcg_iterations": None, "iteration": 0,
    }
    return found | more


# ---- what limits an iteration


@pytest.mark.parametrize(
    ("of", "expected"),
    [
        ({"alpha": 0.4, "alpha_ccd": 0.5, "hessian_t": 1.0}, "contact"),
        ({"alpha": 0.2, "alpha_ccd": 0.5, "alpha_strain": 0.25}, "limit"),
        ({"hessian_t": 0.5}, "indefinite"),
        ({"hessian_fallbacks": 1}, "indefinite"),
        ({"alpha": 0.5}, "search"),
        ({}, "full"),
    ],
)
def test_an_iteration_has_one_cause(of, expected):
    assert causes.cause(line(**of)) == expected
    assert causes.counts([line(**of)] * 3) == {name: 3 * (name == expected) for name in causes.CAUSES}


def test_the_slope_of_a_cause_is_that_over_the_logarithm_of_contacts():
    steps = {}
    for k in range(1, 5):  # k full steps, then one that contact bounds, at e^k contacts
        contacts = {"total": math.exp(k)}
        steps[k] = [line(k, contacts=contacts)] * k + [line(k, contacts=contacts, alpha_ccd=0.5)]
    steps[9] = [line(9, contacts={"total": 0})] * 50  # no contact: not in it
    found = causes.slopes(steps)
    assert found["full"] == pytest.approx(1) and found["contact"] == pytest.approx(0)
    assert causes.slopes({1: [line()]})["full"] is None


# ---- stop rules


def steps_of_one():
    gaps, sizes, forces = [0.9, 0.3, 0.52, 0.5], [1.0, 1e-2, 1e-5, 1e-9], [5.0, 4.0, 1e-3, 1e-7]
    of = [
        line(gap_min_iterates_rel=g, dx_inf_m=d, grad_inf_N=f) for g, d, f in zip(gaps, sizes, forces, strict=True)
    ]
    return {0: of}, {"steps": [{"step": 0, "gap_min_rel": 0.5}]}


def test_work_to_each_rule_counts_the_systems_that_were_solved_until_it_holds():
    steps, record = steps_of_one()
    found = stops.work(steps, record, {"velocity": 1e-4, "residual": 1e-2})
    assert found["velocity_newton"] == 3  # the third direction is short, and had to be solved for
    assert found["residual_newton"] == 2  # the gradient of the third iterate is known before
    assert found["gap_newton"] == 2  # 0.3 is farther than a tenth of 0.5 from the end, 0.52 is not
    assert found["residual_products"] == 20 and found["gap_flop"] == 200 and found["velocity_seconds"] == 0.75
    assert not any(found[f"{rule}_missed"] for rule in stops.RULES)


def test_a_rule_that_never_holds_counts_the_whole_step():
    steps, record = steps_of_one()
    found = stops.work(steps, record, {"velocity": 1e-12, "residual": 1e-12})
    assert found["velocity_newton"] == found["residual_newton"] == 4
    assert found["velocity_missed"] == found["residual_missed"] == 1


def test_a_step_without_contact_is_done_for_the_gap_rule_before_its_first_system():
    steps = {0: [line(gap_min_iterates_rel=None)]}
    found = stops.work(steps, {"steps": [{"step": 0, "gap_min_rel": None}]}, {"velocity": 1, "residual": 1})
    assert found["gap_newton"] == 0 and found["velocity_newton"] == 1


# ---- changed loads


def test_elasticity_and_mass_scale_their_own_keys():
    body = {"material": {"youngs_N_per_m": 2.0, "bending_J": 3.0, "density_kg_per_m2": 5.0, "poisson": 0.3}}
    before = {"/scene": {"bodies": [body]}, "/time": {"steps": 10, "dt_s": 0.01}}
    soft = loads.changed(before, "E0.1")["/scene"]["bodies"][0]["material"]
    assert soft == {"youngs_N_per_m": 0.2, "bending_J": pytest.approx(0.3), "density_kg_per_m2": 5.0, "poisson": 0.3}
    heavy = loads.changed(before, "m100")["/scene"]["bodies"][0]["material"]
    assert heavy["density_kg_per_m2"] == 500 and heavy["youngs_N_per_m"] == 2
    assert before["/scene"]["bodies"][0]["material"]["density_kg_per_m2"] == 5  # unchanged


def test_a_rod_of_other_mass_keeps_its_bending():
    rod = {"line_density_kg_per_m": 2.0, "rod_bending_J_per_kg": 10.0, "rod_stretching_N": 7.0}
    settings = {"/scene": {"bodies": [{"material": rod}]}, "/time": {"steps": 1, "dt_s": 1}}
    heavy = loads.changed(settings, "m10")["/scene"]["bodies"][0]["material"]
    assert heavy["line_density_kg_per_m"] * heavy["rod_bending_J_per_kg"] == pytest.approx(20)
    assert loads.changed(settings, "E10")["/scene"]["bodies"][0]["material"]["rod_bending_J_per_kg"] == 100


def test_a_faster_scene_goes_the_same_way_in_less_time():
    motion = {"velocity_m_per_s": [1, 0, 0], "end_s": 2, "keyframes": [{"time_s": 1, "scale": 0.5}], "then": [{"start_s": 4}]}
    settings = {"/scene": {"bodies": [{"motion": motion, "velocity_m_per_s": [0, 0, 3]}]}, "/time": {"steps": 9, "dt_s": 1}}
    fast = loads.changed(settings, "v2")
    moved = fast["/scene"]["bodies"][0]
    assert moved["motion"] == {
        "velocity_m_per_s": [2, 0, 0], "end_s": 1, "keyframes": [{"time_s": 0.5, "scale": 0.5}], "then": [{"start_s": 2}]
    }
    assert moved["velocity_m_per_s"] == [0, 0, 6] and fast["/time"]["steps"] == 5


def test_bodies_of_a_scene_at_rest_get_a_downward_speed():
    still = {"/scene": {"bodies": [{}, {"kind": "rigid"}]}, "/time": {"steps": 4, "dt_s": 1}}
    bodies = loads.changed(still, "v4")["/scene"]["bodies"]
    assert bodies == [{"velocity_m_per_s": [0, 0, -2.0]}, {"kind": "rigid"}]


# ---- what the laws read of a run


def test_the_fall_of_the_load_is_taken_where_it_is_above_twice_that_of_the_end():
    path = [8.0, 4.0, 1.9, 1.0]
    of = [line(contact_load_max_N=f, alpha_ccd=0.5 if k == 0 else 1.0) for k, f in enumerate(path)]
    found = measured._loads({"steps": [{"step": 0, "contact_load_max_N": 1.0}]}, {0: of})
    assert found["fall"] == pytest.approx((math.log(2) + math.log(4 / 1.9)) / 2)
    assert found["binding"] == 1 and found["stiffness"] == 4 and found["load_high"] == found["load_low"] == 1


def test_the_price_weighs_a_condition_number_by_its_load():
    def at(cond, load):
        one = {"matrix": "clamped", "stage": "full", "scaling": "none", "cond": cond, "status": "ok", "lambda_max": 1.0}
        return line(cond=[one], contact_load_max_N=load)

    assert measured._price([at(90.0, 30.0), at(8.0, 0.1), at(5.0, None)], 2.0) == 4.0  # 90/30 and 8/2
    assert measured._price([at(None, 30.0)], 2.0) is None


def test_contact_made_is_the_ratio_of_one_iterate():
    def cond(stage, value):
        return {"matrix": "clamped", "stage": stage, "scaling": "none", "cond": value, "status": "ok", "lambda_max": 1.0}

    lines = [line(cond=[cond("full", 12.0), cond("without_contact", 4.0)]), line(cond=[cond("full", 20.0)])]
    found = measured._conditioning(lines)
    assert found["made"] == 3 and found["cond_most"] == 20 and found["samples"] == 2


# ---- questions


def row(scene, arm, where=None, outcome="ok", **values):
    place = {"scene": scene, "arm": arm, **(where or Where()).__dict__}
    empty = dict.fromkeys([*measured.MEASURED, "gap_min"])
    return Row(f"{place}", place, outcome, empty | values, {}, 12, 1.0, "r", {"build": "b", "machine": "m", "date": "d"})


def two(scene, metric, ratio, where=None, **more):
    return [row(scene, "log", where, **{metric: 10 * ratio}, **more), row(scene, "cubic", where, **{metric: 10.0}, **more)]


def answered(question, rows):
    return question(Rows(STUDY, rows))


def spread(middle, n, by=0.02):
    """n ratios round a middle, none alike."""
    return middle * np.exp(by * np.linspace(-1, 1, n))


@pytest.mark.parametrize(("ratio", "word"), [(1.05, "vanishes"), (5.0, "persists"), (1.5, "not decided")])
def test_conditioning_vanishes_or_persists(ratio, word):
    rows = [r for s, x in zip(SHELLS, spread(ratio, len(SHELLS))) for r in two(s, "cond_p95", x)]
    rows += [r for s in set(EVERY) - set(SHELLS) for r in two(s, "cond_p95", 100.0)]  # solids: apart
    found = answered(questions.conditioning, rows)
    assert found.word == word and found.numbers["raw"].value == pytest.approx(ratio)
    assert found.numbers["raw, solids"].value == pytest.approx(100) and len(found.scenes) == 7


def test_four_scenes_decide_nothing_and_none_is_not_run():
    rows = [r for s, x in zip(SHELLS[:4], spread(5, 4)) for r in two(s, "cond_p95", x)]
    assert answered(questions.conditioning, rows).word == questions.UNDECIDED
    for question in questions.QUESTIONS:
        assert answered(question, []).word == questions.NO_RUNS


def test_a_run_that_fails_leaves_its_scene_out():
    rows = [r for s, x in zip(SHELLS, spread(5, 7)) for r in two(s, "cond_p95", x)]
    rows[0] = row(SHELLS[0], "log", outcome="newton_stall", cond_p95=1e9)
    assert SHELLS[0] not in answered(questions.conditioning, rows).scenes


@pytest.mark.parametrize(("growth", "word"), [(1.3, "grows"), (1.02, "not decided"), (0.8, "not decided")])
def test_newton_grows(growth, word):
    rows = []
    for s, x in zip(EVERY, spread(growth, len(EVERY), 0.01)):
        rows += two(s, "velocity_newton", 1.1, Where("S")) + two(s, "velocity_newton", 1.1 * x)
    found = answered(questions.newton, rows)
    assert found.word == word and found.numbers["M/S of log/cubic"].value == pytest.approx(growth)


def test_the_cause_is_that_whose_share_differs_most():
    rows = []
    for s, x in zip(EVERY, spread(1, len(EVERY), 0.1)):
        rows.append(row(s, "log", by_contact=20 + 30 * x, by_limit=0, by_indefinite=5, by_search=0, by_full=75))
        rows.append(row(s, "cubic", by_contact=20, by_limit=0, by_indefinite=6, by_search=0, by_full=74))
    found = answered(questions.cause, rows)
    assert found.word == "contact" and found.numbers["share contact"].value == pytest.approx(0.3, rel=0.01)
    assert found.numbers["share indefinite"].value == pytest.approx(-0.01)
    assert found.p < 1e-6


def works(ratio, but=None):
    rows = []
    for s, x in zip(EVERY, spread(1, len(EVERY))):
        values = {f"{rule}_{name}": ratio for rule in stops.RULES for name in stops.WORK} | (but or {})
        for measure in ("pcg", "diagnosed"):
            where = Where(measure=measure)
            rows.append(row(s, "log", where, **{key: 10 * v * x for key, v in values.items()}))
            rows.append(row(s, "cubic", where, **dict.fromkeys(values, 10.0)))
    return rows


@pytest.mark.parametrize(("ratio", "word"), [(1.05, "equivalent"), (1.6, "cubic"), (0.5, "log")])
def test_work_is_equivalent_or_has_a_winner(ratio, word):
    assert answered(questions.work, works(ratio)).word == word


def test_a_winner_has_to_win_under_every_stop_rule():
    found = answered(questions.work, works(1.6, {"gap_seconds": 0.9}))
    assert found.word == questions.UNDECIDED and found.numbers["seconds to gap"].value == pytest.approx(0.9)


def test_robustness_counts_runs_that_end_ok():
    rows = []
    for s in EVERY:
        for k, load in enumerate(("E0.01", "E10", "m100", "v4")):
            where = Where("S", "0.1", load, "audited")
            rows.append(row(s, "log", where, gap_min=0.1))
            rows.append(row(s, "cubic", where, "ok" if k < 2 else "stall_overload", gap_min=0.2))
    found = answered(questions.robustness, rows)
    assert found.word == "cubic less often than log" and found.p == pytest.approx(2 / 2**10)
    assert found.numbers["cubic: share that ends ok"].value == 0.5
    assert found.numbers["cubic: smallest gap"].value == pytest.approx(0.2)


def test_a_word_needs_its_own_p_after_all_corrections():
    rows = []
    for k, s in enumerate(EVERY):
        for load in ("E0.01", "E10"):
            where = Where("S", "0.1", load, "audited")
            rows += [row(s, "log", where), row(s, "cubic", where, "timeout" if load == "E10" else "ok")]
            rows.append(row(s, "ipc", where, "timeout" if k < 7 and load == "E10" else "ok"))
    found = answered(questions.robustness, rows)
    # 10 to 0: p = 0.002, times 2 formulations and 6 questions 0.023; 7 to 0: p = 0.016, times 12 above 0.05
    assert found.word == "cubic less often than log" and found.p == pytest.approx(2 * 2 / 2**10)


def test_loads_that_one_formulation_lacks_are_left_out():
    where = {load: Where("S", "0.1", load, "audited") for load in ("E0.01", "E10")}
    rows = [row(s, "log", w) for s in EVERY for w in where.values()]
    rows += [row(s, "cubic", where["E10"]) for s in EVERY]
    found = answered(questions.robustness, rows + [row("drape", "log", Where("S", "0.1", "m100", "audited"), "timeout")])
    assert found.numbers["log: share that ends ok"].value == 1


def test_a_mask_with_four_scenes_is_no_outcome():
    rows = []
    for s in EVERY:
        rows += two(s, "velocity_newton", 1.1, Where("S"))
    for s, x in zip(EVERY[:4], spread(3.0, 4, 0.001)):
        rows += two(s, "velocity_newton", 1.1 * x, Where("S", setting="limit"))
    for s, x in zip(EVERY, spread(1.0, len(EVERY), 0.3)):
        rows += two(s, "velocity_newton", 1.1 * x, Where("S", setting="clamped"))
    assert answered(questions.masks, rows).word == questions.UNDECIDED


def test_a_mask_changes_the_ratio():
    rows = []
    for s, x in zip(EVERY, spread(1.5, len(EVERY))):
        rows += two(s, "velocity_newton", 1.1, Where("S"))
        rows += two(s, "velocity_newton", 1.1 * x, Where("S", setting="clamped"))
        rows += two(s, "velocity_newton", 1.1, Where("S", setting="friction"))
    found = answered(questions.masks, rows)
    assert found.word == "clamped" and found.numbers["clamped: Newton"].value == pytest.approx(1.5)
    assert found.numbers["friction: Newton"].value == pytest.approx(1) and found.numbers["limit: Newton"] is None


def test_an_outcome_needs_its_p_after_holm():
    rows = [r for s, x in zip(SHELLS, spread(5.0, 7)) for r in two(s, "cond_p95", x)]
    found = questions.answers(Rows(STUDY, rows))
    assert found[0].outcome == "persists" and found[0].p_holm == pytest.approx(6 * found[0].p)
    wide = [r for s, x in zip(SHELLS, spread(6.0, 7, 1.18)) for r in two(s, "cond_p95", x)]
    one = questions.answers(Rows(STUDY, wide))[0]
    assert one.word == "persists" and one.p < 0.05 < one.p_holm and one.outcome == questions.UNDECIDED


# ---- laws


def test_the_first_law_is_refuted_by_wrong_signs_alone():
    def places(ratio):
        more = {"made": 5.0, "load_high": 4.0, "load_low": 1.0, "price_most": 1.0}
        return [r for s in EVERY for r in two(s, "cond_most", ratio, **more)]

    assert laws.load_range(Rows(STUDY, places(3.0))).verdict == "stands"  # 1/theta = 100 > 2 sqrt(4)
    assert laws.load_range(Rows(STUDY, places(0.3))).verdict == "refuted"
    free = [r for s in EVERY for r in two(s, "cond_most", 0.3, made=1.0, load_high=4.0, load_low=1.0)]
    assert laws.load_range(Rows(STUDY, free)).verdict == "not observed"


def test_the_second_law_predicts_pcg_and_bounds_the_largest_eigenvalue():
    def places(seen, most=3.0):
        rows = []
        for s in EVERY:
            normal = Rows(STUDY, []).scenes[s]["sizes"]["M"]["normal_N_per_m"]
            rows.append(row(s, "log", pcg=10.0 * seen[s], stiffness=7 * normal, bj_lambda_max=most))
            rows.append(row(s, "cubic", pcg=10.0, stiffness=normal, bj_lambda_max=most))
        return Rows(STUDY, rows)

    of = Rows(STUDY, []).scenes
    right = {s: 2.0 if of[s]["contact"] == "free bodies" else 1.0 for s in EVERY}  # sqrt(8/2)
    assert laws.scaled(places(right)).verdict == "stands"
    assert laws.scaled(places(right, 4.2)).verdict == "refuted"
    assert laws.scaled(places(dict.fromkeys(EVERY, 1.0))).verdict == "refuted"


def test_the_third_law_is_refuted_by_two_scenes():
    def places(high):
        return Rows(STUDY, [r for k, s in enumerate(EVERY) for r in two(s, "velocity_newton", 2.5 if k < high else 1.5)])

    assert [laws.newton(places(k)).verdict for k in (0, 1, 2)] == ["stands", "stands", "refuted"]


# ---- power


def test_the_power_of_a_one_sided_test_is_that_of_the_noncentral_t():
    n, effect, scatter = 8, 0.3, 0.4
    shift = effect / scatter * math.sqrt(n)
    exact = nct.sf(t.ppf(0.95, n - 1), n - 1, shift)
    found = p_values.power(lambda v: p_values.p_above(list(v), 0.0) < 0.05, effect, scatter, n, seed=3)
    assert 0.3 < exact < 0.9 and found == pytest.approx(exact, abs=0.03)


# ---- the spec


@pytest.mark.parametrize("scene", EVERY)
def test_every_scene_is_a_config_that_the_program_takes(scene, tmp_path):
    cell = next(c for c in STUDY.cells if (c.place["scene"], c.place["size"]) == (scene, "XS"))
    config = json.loads((ROOT / "configs/scenes/hang.json").read_text())
    for pointer, value in (STUDY.data["set"] | cell.settings).items():
        put(config, pointer, value)
    (tmp_path / "run.json").write_text(json.dumps(config))
    found = subprocess.run([built_program(), "check", tmp_path / "run.json"], capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr


def test_a_method_in_one_piece_takes_its_own_step_over_the_same_time():
    cell = next(c for c in STUDY.cells if c.place["arm"] == "ando2024" and c.place["scene"] == "drape")
    own = next(c for c in STUDY.cells if c.place["arm"] == "log" and c.place["scene"] == "drape")
    time = own.settings["/time"]
    assert cell.settings["/time/steps"] * 0.001 == pytest.approx(time["steps"] * time["dt_s"])
    assert "/matching" not in cell.settings and cell.settings["/method"] == "ando2024"


def test_both_barriers_carry_the_same_load_and_nothing_else_differs():
    def of(arm, theta):
        where = SimpleNamespace(**Where("S", theta).__dict__, scene="drape", arm=arm)
        return next(c.settings for c in STUDY.cells if c.place == where.__dict__ | {})

    log, cubic = of("log", "0.01"), of("cubic", "0.01")
    assert {key for key in log if log[key] != cubic[key]} == {"/formulation"}
    assert log["/matching"]["load_N"] > 0 and log["/strain_limit"] == {"enabled": False}


def test_a_size_whose_load_is_not_known_has_the_runs_that_find_it_alone():
    sizes = {s["label"]: s["sizes"]["M"] for s in STUDY.about["scenes"]}
    of = [c for c in STUDY.cells if c.place["size"] == "M" and "load_N" not in sizes[c.place["scene"]]]
    guesses = [c for c in STUDY.cells if c.place["setting"] == "guess"]
    assert len(guesses) == len(EVERY) and {c.place["setting"] for c in of} <= {"guess"}
    for cell in guesses:
        assert cell.settings["/matching"]["load_N"] == sizes[cell.place["scene"]]["guess_N"]


def test_an_unknown_arm_of_a_group_is_refused(tmp_path):
    data = json.loads((ROOT / "configs/studies/at_size.json").read_text())
    data["about"]["groups"][0]["arms"] = ["logarithm"]
    file = ROOT / "configs/studies/at_size.json"
    study = type(STUDY)(file, data)
    with pytest.raises(Exception, match=r"about/groups/0/arms: found \['logarithm'\]; log, cubic, ipc, consistent, ando2024 is needed"):
        study.cells


# ---- the page


def test_the_page_shows_answers_laws_and_what_is_missing(tmp_path):
    from barrierbench_analysis.studies.rules.at_size import page

    rows = []
    for size in ("S", "M"):
        for s, x in zip(EVERY, spread(5.0, len(EVERY))):
            rows += two(s, "cond_p95", x, Where(size), gap_min=0.1)
    found = page.rule(STUDY, rows)
    assert found["outcome"][1] == "persists" and found["outcome"][5] == questions.NO_RUNS
    assert "raw condition number, log/cubic | 4.97 [" in found["of_question"][1]
    assert f"| S base diagnosed | 20 of {len(EVERY) * 6} | 0.01 |" in found["cost"]
    assert "| M | 0.01 | 10 | - | 1 [" in found["by_size"]
    assert "All runs end ok." in found["ends"] and "Every rule holds" in found["missed"] and "**not observed**" in found["laws"]
    failed = page.rule(STUDY, [row("drape", "log", outcome="timeout"), *two("twist", "cond_p95", 2.0), row("drape", "cubic")])
    assert "| M | 0.01 | 1 | drape (log timeout) |" in failed["by_size"]
    assert "| log | 0.01 | M | timeout | 1 run | drape base |" in failed["ends"]
