"""The study at size: its runs, and what it reads of them."""

import json
import math
import subprocess
from types import SimpleNamespace

import pytest
from at_size_rows import EVERY, STUDY

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.program.start import built_program
from barrierbench_analysis.studies.claims.merged import put
from barrierbench_analysis.studies.rules.at_size import causes, loads, measured, stops
from barrierbench_analysis.studies.rules.at_size.pairs import Where


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


def test_the_residual_of_a_stop_follows_a_changed_mass_and_step_length():
    def limit(setting, measure, size):
        place = {"scene": "drape", "setting": setting, "measure": measure, "size": size}
        cell = next(c for c in STUDY.cells if place.items() <= c.place.items())
        return measured.limits(STUDY, cell)["residual"]

    own = limit("base", "diagnosed", "XS")
    assert own > 0 and limit("m10", "audited", "XS") == pytest.approx(10 * own) and limit("E10", "audited", "XS") == pytest.approx(own)
    assert limit("dt24", "diagnosed", "S") == pytest.approx(limit("base", "diagnosed", "S") * (24 * 0.01) ** 2)


@pytest.mark.parametrize(("label", "found"), [("E0.01", ("E", 0.01)), ("v4", ("v", 4.0)), ("base", None), ("Eva", None), ("m", None)])
def test_the_label_of_a_changed_load_is_told_from_other_settings(label, found):
    assert loads.of_label(label) == found


def test_an_unknown_arm_of_a_group_is_refused(tmp_path):
    data = json.loads((ROOT / "configs/studies/at_size.json").read_text())
    data["about"]["groups"][0]["arms"] = ["logarithm"]
    file = ROOT / "configs/studies/at_size.json"
    study = type(STUDY)(file, data)
    with pytest.raises(UserError, match=r"about/groups/0/arms: found \['logarithm'\]; log, cubic, ipc, consistent, ando2024 is needed"):
        study.cells
