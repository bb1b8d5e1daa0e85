"""The adversary: its statements, its regions and its draws."""

import json
import math
import random
import subprocess
from dataclasses import replace

import pytest
from adversary_rows import FILE, LABELS, keep, named, there

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.program.start import built_program
from barrierbench_analysis.studies.claims.merged import put
from barrierbench_analysis.studies.kit.study import cost, store
from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.rules.adversary import (
    draws,
    of_claims,
    of_size,
    size_region,
)
from barrierbench_analysis.studies.rules.adversary.gathered import gathered
from barrierbench_analysis.studies.rules.adversary.region import Range
from barrierbench_analysis.studies.rules.adversary.statement import (
    EVERY,
    MEAN,
)
from barrierbench_analysis.studies.rules.at_size import questions

pytestmark = pytest.mark.usefixtures("no_rows_of_the_study_at_size")


# ---- statements


def test_questions_laws_and_parts_that_hold_are_attacked_or_listed_with_a_reason():
    found = gathered(read_study("adversary"))
    size = ("question-1", "question-2", "question-4-products", "question-4-seconds", "law-1", "law-2", "law-3")
    assert {*size} <= {*LABELS} and any(label.startswith("question-5-") for label in LABELS)
    assert {"K5-1", "K6-1", "H2-1", "K4-1", "N2-1"} <= {*LABELS} and len({*LABELS}) == len(LABELS)
    assert {one.source for one in found.left} >= {"`at_size`, question 3", "claim H6", "claim H8"}
    assert not {one.label for one in found.statements if one.verdict == "does not hold"}


def test_statements_about_every_run_are_kept_apart_from_means():
    kinds = {label: named(label).kind for label in LABELS}
    assert [kinds[label] for label in ("K5-1", "K5-2", "K6-1", "law-2", "law-3")] == [EVERY] * 5
    assert [kinds[label] for label in ("question-1", "K6-2", "H2-1", "N2-1", "law-1")] == [MEAN] * 5
    assert named("law-3").refuted_by == 2 and named("K6-1").refuted_by == 1


def test_thresholds_are_those_that_were_registered():
    assert named("law-3").side.high == pytest.approx(math.log(2.3)) and named("law-2").side.high == pytest.approx(4)
    part = next(part for part in of_claims.entry.read_claim("H3").deciding if part["rule"] == "ratio")
    assert named("H3-1").side.low == pytest.approx(math.log(part["above"])) and part["above"] == 0.9


@pytest.mark.parametrize(("word", "side"), [("vanishes", questions.VANISHES), ("persists", (questions.PERSISTS, math.inf))])
def test_the_outcome_of_a_question_is_what_is_attacked(word, side, monkeypatch):
    def answers(_):
        return [questions.Answer(number, "", word if number == 1 else questions.NO_RUNS, 0.0, {}, p_holm=0.0) for number in (1, 3)]

    monkeypatch.setattr(questions, "answers", answers)
    about = {**read_study("adversary").about, "unless_decided": {"1": "persists"}}
    (found,), (left,) = of_size.of_questions(size_region.study(), about, [])
    assert (found.side.low, found.side.high) == side and found.verdict == word and "question 3" in left.source


def test_a_metric_that_no_row_has_is_a_reason():
    part = {"rule": "ratio", "metric": "stretch"}
    assert of_claims.why_not(part, {"newton": "newton"}) == "the spec names no metric stretch"
    assert "closed form" in of_claims.why_not({"proof": "x"}, {}) and not of_claims.why_not(part, {"stretch": ""})
    assert "no pair" in of_claims.why_not({"rule": "slope", "metric": "stretch"}, {"stretch": ""})


# ---- regions and draws


@pytest.mark.parametrize("label", LABELS)
def test_no_draw_leaves_its_region(label):
    region, rng = named(label).region, random.Random(3)
    point, scenes = region.draw(rng), set()
    for k in range(500):
        point = region.near(point, rng) if k % 5 else region.draw(rng)
        scenes.add(point.scene)
        assert region.holds(point), point
    assert scenes == {*region.scenes}


def test_a_point_outside_is_not_in_the_region():
    region = named("question-1").region
    point = region.draw(random.Random(1))
    for name, value in (("E", 101.0), ("dt_s", 1.0), ("limit", "half"), ("friction", 0.31)):
        assert not region.holds(replace(point, scene="drape", values={**_full(region), name: value}))
    assert region.holds(replace(point, scene="drape", values=_full(region)))


def _full(region):
    return {name: axis.draw(random.Random(1)) for name, axis in region.scenes["drape"].items()}


def test_the_region_of_the_study_at_size_is_what_its_groups_span():
    axes = named("law-1").region.scenes["drape"]
    assert (axes["E"].low, axes["E"].high, axes["v"].high) == (0.01, 100.0, 4.0)
    assert (axes["theta"].low, axes["theta"].high) == (0.01, 0.1) and axes["friction"].high == 0.3
    assert axes["dt_s"].high == pytest.approx(1 / 24) and axes["dt_s"].low == axes["dt_s"].base
    assert "friction" not in named("law-1").region.scenes["cards"]  # whose friction no registered run changes
    assert "theta" not in named("question-1").region.scenes["drape"]  # which names its own
    assert "d_hat_m" not in named("question-2").region.scenes["links"]  # each size has its own


def test_a_drawn_run_has_the_parameters_of_its_point_and_arms_differ_in_the_formulation_alone():
    region = named("law-1").region
    values = {**_full(region), "theta": 0.03, "E": 10.0, "friction": 0.2, "dt_s": 0.02, "limit": "off", "clamped": "off", "seed": 7}
    point = replace(region.draw(random.Random(1)), scene="drape", values=values)
    _, log = region.settings(point, "log@XS")
    _, cubic = region.settings(point, "cubic@XS")
    assert {key for key in log if log[key] != cubic[key]} == {"/formulation"}
    assert log["/matching"]["theta"] == 0.03 and log["/friction"]["mu"] == 0.2 and log["/time"]["dt_s"] == 0.02
    _, soft = region.settings(replace(point, values={**values, "E": 1.0}), "log@XS")
    of = [s["/scene"]["bodies"][0]["material"] for s in (log, soft)]
    assert of[0] != of[1] and log["/matching"] == soft["/matching"] and log["/seeds/main"] == 7


def test_between_two_levels_numbers_are_between_them():
    a = {"n": 4, "v": [0, -1.0], "E": 1.0, "kind": "low", "only_a": 1, "on": True}
    b = {"n": 8, "v": [0, -16.0], "E": 100.0, "kind": "high", "on": True}
    middle = of_claims.between(a, b, 0.5)
    assert middle == {"n": 6, "v": [0, -8.5], "E": pytest.approx(10.0), "kind": "high", "on": True}
    assert of_claims.between(a, b, 0.0) == a and of_claims.between(a, b, 1.0) == b
    for k in range(101):
        found = of_claims.between(a, b, k / 100)
        assert 4 <= found["n"] <= 8 and 1 <= found["E"] <= 100 and -16 <= found["v"][1] <= -1


def test_the_levels_of_a_sweep_are_its_registered_configs():
    part = named("K6-1").part
    sweep = of_claims.entry.read_sweep(part["sweep"])
    for note, config in list(of_claims.asked_once(sweep).items()):
        scene, level, case, seed = sweep.cases[note]
        if seed == 1 and case == "line_search":
            at = [lv for sc, lv, cs, sd in sweep.cases.values() if (sc, cs, sd) == (scene, case, 1)].index(level)
            assert of_claims.config_at(part, scene, case, float(at)) == config


def test_a_range_rounds_and_stays_within():
    axis, rng = Range(0.1, 2 / 3, log=True, base=0.2), random.Random(5)
    found = [axis.draw(rng) for _ in range(400)]
    assert 100 < found.count(0.2) < 300 and len({*found}) > 100 and all(map(axis.holds, found))
    assert max(axis.near(2 / 3, rng) for _ in range(50)) == 2 / 3  # which rounds to more
    assert all(abs(math.log(axis.near(0.2, rng) / 0.2)) < 4 * 0.15 * math.log(20 / 3) for _ in range(100))


def test_draws_are_the_same_in_every_call_and_others_for_another_seed(adversary):
    keys = [cell.key for cell in adversary.cells]
    assert keys == [cell.key for cell in replace(adversary).cells] and len({*keys}) == len(keys)
    assert len(keys) == adversary.about["round"] * sum(len(named(label).arms) for label in LABELS)
    other = replace(adversary, data={**adversary.data, "about": {**adversary.about, "seed": 1}})
    assert not {*keys} & {cell.key for cell in other.cells}


def test_kept_draws_keep_their_cells_whatever_rows_come_later(adversary):
    first = keep(adversary, "N2-1", lambda number, arm: {"newton": 20.0 if arm == "clamped" else 10.0 + number})
    assert [draw.label for draw in first] == ["0", "1", "2", "3"]  # nothing is known before
    keys = [cell.key for cell in adversary.cells if cell.place["statement"] == "N2-1"]
    second = keep(adversary, "N2-1", lambda number, arm: {"newton": 30.0 if arm == "clamped" and number == 5 else 40.0})
    assert [draw.label for draw in second] == ["4", "5of3", "6", "7of3"]  # 20/13 is nearest to 1
    third = draws.next_draws(adversary, named("N2-1"), there(adversary, "N2-1"))
    assert [draw.label for draw in third] == ["8", "9of5", "10", "11of5"]
    after = [cell.key for cell in replace(adversary).cells if cell.place["statement"] == "N2-1"]
    assert after[: len(keys)] == keys and len(after) == 3 * 4 * 2
    kept = there(adversary, "N2-1")
    assert [draw.point for draw in kept] == [draw.point for draw in (*first, *second)]
    assert kept[5].point.scene == kept[3].point.scene and kept[5].point.values["seed"] != kept[3].point.values["seed"]


def test_a_draw_close_to_another_changes_a_value_and_no_scene():
    region, rng = named("law-1").region, random.Random(2)
    point = region.draw(rng)
    steps = [region.near(point, rng) for _ in range(50)]
    assert all(one.scene == point.scene and one.values["seed"] != point.values["seed"] for one in steps)
    assert any(one.values["theta"] == point.values["theta"] for one in steps)
    assert any(one.values["theta"] != point.values["theta"] for one in steps)


def test_rows_of_another_region_are_of_no_draw(adversary):
    keep(adversary, "N2-1", lambda number, arm: {"newton": 10.0})
    other = replace(adversary, data={**adversary.data, "about": {**adversary.about, "seed": 1}})
    assert there(adversary, "N2-1") and not draws.kept_draws(other, named("N2-1"), draws.rows_of_today(adversary))


def test_a_draw_whose_neighbour_is_gone_is_of_no_draw(adversary):
    for _ in range(2):
        keep(adversary, "N2-1", lambda number, arm: {"newton": 20.0 if arm == "clamped" else 10.0 + number})
    rows = draws.rows_of_today(adversary)
    left = {key: one for key, one in rows.items() if one.place["draw"] != "3"}
    assert [draw.label for draw in draws.kept_draws(adversary, named("N2-1"), rows)][3:] == ["3", "4", "5of3", "6", "7of3"]
    assert [draw.label for draw in draws.kept_draws(adversary, named("N2-1"), left)] == ["0", "1", "2", "4", "6"]


def test_the_search_of_a_statement_ends_with_its_hours(adversary):
    keep(adversary, "K6-1", lambda *_: {}, seconds=600.0)
    assert len(draws.next_draws(adversary, named("K6-1"), there(adversary, "K6-1"))) == 4  # 2400 s of 3600
    keep(adversary, "K6-1", lambda *_: {}, seconds=600.0)
    assert not draws.next_draws(adversary, named("K6-1"), there(adversary, "K6-1"))
    lines = cost.plan(replace(adversary), store.read_rows(store.file_of(adversary)), [])
    assert "K6-1: 8 draws, 1.33 core hours, search ended by its hours" in lines
    assert f"{LABELS[0]}: no draw, 0.00 core hours, 1.00 h left" in lines
    few = replace(adversary, data={**adversary.data, "about": {**adversary.about, "hours_each": 9.0, "draws_each": 10}})
    assert len(draws.next_draws(few, named("K6-1"), there(adversary, "K6-1"))) == 2  # of ten
    assert draws.spent(few, there(adversary, "K6-1") * 2) == "draws"


def test_rounds_grow_with_the_draws_that_are_there(adversary):
    kept = [replace(draws.Draw(named("K6-1"), str(k), None, {})) for k in range(100)]
    assert len(draws.next_draws(adversary, named("K6-1"), kept)) == 25


# ---- the spec and the program


@pytest.mark.parametrize("label", LABELS)
def test_the_first_draw_of_every_statement_is_a_config_that_the_program_takes(label, adversary, tmp_path):
    draw = draws.next_draws(adversary, named(label), [])[0]
    for case in draws.cases_of(adversary, draw):
        config = read_object(case.base)
        for pointer, value in (adversary.data["set"] | case.settings).items():
            put(config, pointer, value)
        (tmp_path / "run.json").write_text(json.dumps(config))
        found = subprocess.run([built_program(), "check", tmp_path / "run.json"], capture_output=True, text=True, check=False)
        assert found.returncode == 0, found.stderr


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"hours_each": 0}, "about/hours_each: found 0; .*a number > 0"),
        ({"changes": ["speed"]}, "about/changes/0: found 'speed'"),
        ({"unless_decided": {"1": "grows", "2": "grows", "4": "log", "5": "cubic less often than log"}}, "about/unless_decided/1: found 'grows'"),
        ({"verdicts": ["does not hold"]}, "about/verdicts/0: found 'does not hold'"),
        ({"hour": 1}, "about/hour"),
    ],
)
def test_a_spec_of_another_form_is_refused(tmp_path, change, text):
    data = read_object(FILE)
    data |= {"base": str(FILE.parent / data["base"]), "about": {**data["about"], **change}}
    (tmp_path / "adversary.json").write_text(json.dumps(data))
    with pytest.raises(UserError, match=text):
        read_study(str(tmp_path / "adversary.json"))
