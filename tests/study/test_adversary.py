"""The adversary: its statements and regions, its draws, and what rows with a planted contradiction say."""

import json
import math
import random
import subprocess
from contextlib import contextmanager
from dataclasses import replace

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.program.start import built_program
from barrierbench_analysis.studies.claims.merged import put
from barrierbench_analysis.studies.kit.study import cost, page, store
from barrierbench_analysis.studies.kit.study.collect import sources_of
from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.rules.adversary import compared, draws, of_claims, of_size, size_region
from barrierbench_analysis.studies.rules.adversary.gathered import _gathered, gathered
from barrierbench_analysis.studies.rules.adversary.page import rule, verdict
from barrierbench_analysis.studies.rules.adversary.region import Range
from barrierbench_analysis.studies.rules.adversary.statement import EVERY, MEAN, Side, contrary
from barrierbench_analysis.studies.rules.at_size import questions

FILE = read_study("adversary").file


@contextmanager
def without_rows_of_the_study_at_size():
    """Statements as they are before the study at size has a row, so that no test depends on what its rows say."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(of_size, "rows_of", lambda study: [])
        _gathered.cache_clear()
        yield
    _gathered.cache_clear()


with without_rows_of_the_study_at_size():
    LABELS = [one.label for one in gathered(read_study("adversary")).statements]


@pytest.fixture(autouse=True, scope="module")
def no_rows_of_the_study_at_size():
    with without_rows_of_the_study_at_size():
        yield


@pytest.fixture
def study(tmp_path):
    """Without a kept row."""
    return read_study("adversary", tmp_path)


def named(label):
    return gathered(read_study("adversary")).named(label)


def row(of, case, outcome="ok", seconds=1.0, **values):
    cell, sources = of.cell(case), sources_of(of)
    origin = {"date": "2026-01-01", "machine": "m", "commit": "c", "build": "b", "version": "1", "threads": 1}
    empty = dict.fromkeys(sources) | {"failed_audit": 0.0, "gap_min": 0.5}
    return store.Row(cell.key, cell.place, outcome, empty | values, sources, 12, seconds, "r", origin)


def keep(of, label, made, seconds=1.0):
    """Keeps rows of the next round of a statement. made: number of a draw and arm -> outcome and values."""
    file, statement = store.file_of(of), named(label)
    kept = store.read_rows(file)
    new = draws.next_draws(of, statement, draws.kept_draws(of, statement, kept))
    for draw in new:
        for case in draws.cases_of(of, draw):
            more = made(draw.number, case.place["arm"])
            outcome = more.pop("outcome", "ok")
            kept |= {(one := row(of, case, outcome, seconds, **more)).key: one}
    store.write_rows(file, kept)
    return new


def there(of, label):
    return draws.kept_draws(of, named(label), draws.rows_of_today(of))


def said(label, outcomes=("ok", "ok", "ok", "ok"), **columns):
    """The contrast of one draw whose runs have these numbers, column -> a number for each arm."""
    statement = named(label)
    rows = {}
    for k, arm in enumerate(statement.arms):
        values = {name: of[k] for name, of in columns.items()}
        place = {"statement": label, "draw": "0", "scene": "s", "arm": arm}
        empty = dict.fromkeys(sources_of(read_study("adversary"))) | {"gap_min": 0.5}
        rows[arm] = store.Row(arm, place, outcomes[k], empty | values, {}, 12, 1.0, "r", {"machine": "m", "build": "b"})
    return compared.contrast(statement, rows)


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


def test_draws_are_the_same_in_every_call_and_others_for_another_seed(study):
    keys = [cell.key for cell in study.cells]
    assert keys == [cell.key for cell in replace(study).cells] and len({*keys}) == len(keys)
    assert len(keys) == study.about["round"] * sum(len(named(label).arms) for label in LABELS)
    other = replace(study, data={**study.data, "about": {**study.about, "seed": 1}})
    assert not {*keys} & {cell.key for cell in other.cells}


def test_kept_draws_keep_their_cells_whatever_rows_come_later(study):
    first = keep(study, "N2-1", lambda number, arm: {"newton": 20.0 if arm == "clamped" else 10.0 + number})
    assert [draw.label for draw in first] == ["0", "1", "2", "3"]  # nothing is known before
    keys = [cell.key for cell in study.cells if cell.place["statement"] == "N2-1"]
    second = keep(study, "N2-1", lambda number, arm: {"newton": 30.0 if arm == "clamped" and number == 5 else 40.0})
    assert [draw.label for draw in second] == ["4", "5of3", "6", "7of3"]  # 20/13 is nearest to 1
    third = draws.next_draws(study, named("N2-1"), there(study, "N2-1"))
    assert [draw.label for draw in third] == ["8", "9of5", "10", "11of5"]
    after = [cell.key for cell in replace(study).cells if cell.place["statement"] == "N2-1"]
    assert after[: len(keys)] == keys and len(after) == 3 * 4 * 2
    kept = there(study, "N2-1")
    assert [draw.point for draw in kept] == [draw.point for draw in (*first, *second)]
    assert kept[5].point.scene == kept[3].point.scene and kept[5].point.values["seed"] != kept[3].point.values["seed"]


def test_a_draw_close_to_another_changes_a_value_and_no_scene():
    region, rng = named("law-1").region, random.Random(2)
    point = region.draw(rng)
    steps = [region.near(point, rng) for _ in range(50)]
    assert all(one.scene == point.scene and one.values["seed"] != point.values["seed"] for one in steps)
    assert any(one.values["theta"] == point.values["theta"] for one in steps)
    assert any(one.values["theta"] != point.values["theta"] for one in steps)


def test_rows_of_another_region_are_of_no_draw(study):
    keep(study, "N2-1", lambda number, arm: {"newton": 10.0})
    other = replace(study, data={**study.data, "about": {**study.about, "seed": 1}})
    assert there(study, "N2-1") and not draws.kept_draws(other, named("N2-1"), draws.rows_of_today(study))


def test_a_draw_whose_neighbour_is_gone_is_of_no_draw(study):
    for _ in range(2):
        keep(study, "N2-1", lambda number, arm: {"newton": 20.0 if arm == "clamped" else 10.0 + number})
    rows = draws.rows_of_today(study)
    left = {key: one for key, one in rows.items() if one.place["draw"] != "3"}
    assert [draw.label for draw in draws.kept_draws(study, named("N2-1"), rows)][3:] == ["3", "4", "5of3", "6", "7of3"]
    assert [draw.label for draw in draws.kept_draws(study, named("N2-1"), left)] == ["0", "1", "2", "4", "6"]


def test_the_search_of_a_statement_ends_with_its_hours(study):
    keep(study, "K6-1", lambda *_: {}, seconds=600.0)
    assert len(draws.next_draws(study, named("K6-1"), there(study, "K6-1"))) == 4  # 2400 s of 3600
    keep(study, "K6-1", lambda *_: {}, seconds=600.0)
    assert not draws.next_draws(study, named("K6-1"), there(study, "K6-1"))
    lines = cost.plan(replace(study), store.read_rows(store.file_of(study)), [])
    assert "K6-1: 8 draws, 1.33 core hours, search ended by its hours" in lines
    assert f"{LABELS[0]}: no draw, 0.00 core hours, 1.00 h left" in lines
    few = replace(study, data={**study.data, "about": {**study.about, "hours_each": 9.0, "draws_each": 10}})
    assert len(draws.next_draws(few, named("K6-1"), there(study, "K6-1"))) == 2  # of ten
    assert draws.spent(few, there(study, "K6-1") * 2) == "draws"


def test_rounds_grow_with_the_draws_that_are_there(study):
    kept = [replace(draws.Draw(named("K6-1"), str(k), None, {})) for k in range(100)]
    assert len(draws.next_draws(study, named("K6-1"), kept)) == 25


# ---- what draws say


@pytest.mark.parametrize(
    ("side", "x", "expected"),
    [
        (Side("above", 2.0), 1.5, 0.5),
        (Side("below", high=2.0), 1.5, -0.5),
        (Side("within", -1.0, 1.0), 1.5, 0.5),
        (Side("within", -1.0, 1.0), 0.75, -0.25),
        (Side("beyond", -1.0, 1.0), 0.75, 0.25),
        (Side("beyond", -1.0, 1.0), -1.5, -0.5),
    ],
)
def test_a_number_is_contrary_by_its_distance_from_the_threshold(side, x, expected):
    assert contrary(side, x) == pytest.approx(expected)


def test_a_ratio_on_the_threshold_contradicts_above_and_not_within():
    assert named("N2-1").contradicts(0.0) and not named("law-3").contradicts(0.0)
    assert not named("K6-1").contradicts(-0.0)


def test_a_ratio_needs_two_runs_that_end_ok():
    assert said("N2-1", newton=(20, 10)).margin == pytest.approx(-math.log(2))
    assert said("N2-1", newton=(10, 20)).margin == pytest.approx(math.log(2))
    failed = said("N2-1", ("ok", "newton_stall"), newton=(10, 20))
    assert failed.margin is None and failed.why == "absolute newton_stall"
    assert said("N2-1", newton=(10, None)).why == "no newton above 0"


def test_the_growth_of_a_ratio_is_of_four_runs():
    found = said("question-2", size_newton=(30, 10, 20, 10))
    assert found.margin == pytest.approx(-math.log(1.5)) and found.numbers.startswith("1.5 (log@S 30")
    assert said("question-2", size_newton=(10, 10, 20, 10)).margin == pytest.approx(math.log(2))


def test_runs_at_other_gaps_make_no_ratio_where_the_claim_asks_for_comparable_ones():
    def gaps(x):
        return json.dumps({"a|b": [x, x, x, True]})

    assert said("H3-1", cond_p95=(8, 10), gaps=(gaps(0.5), gaps(0.4))).margin == pytest.approx(math.log(0.9 / 0.8))
    assert "not_comparable" in said("H3-1", cond_p95=(8, 10), gaps=(gaps(0.5), gaps(0.1))).why


def test_who_gets_through_counts_runs_that_fail():
    through = {"failed_audit": (0.0, 1.0)}
    assert said("K6-2", **through).margin == -0.5  # the smaller its gap, the nearer to a failure
    assert said("K6-2", failed_audit=(1.0, 0.0)).margin == 1.0
    assert said("K6-2", failed_audit=(1.0, 1.0)).why == "no run gets through"
    assert said("K6-1", failed_audit=(1.0,)).margin == 1.0
    assert said("K5-2", ("newton_stall",)).margin == 1.0 and said("K5-2").margin < 0
    assert said("K6-1", ("timeout",), failed_audit=(None,)).margin == 1.0


def test_a_level_is_that_of_the_most_contrary_run():
    assert said("law-2", size_bj_lambda_max=(3.0, 4.5)).margin == pytest.approx(0.5)
    assert said("law-2", ("ok", "newton_stall"), size_bj_lambda_max=(3.0, 9.0)).margin == pytest.approx(-1.0)
    assert said("law-2", ("nan", "nan"), size_bj_lambda_max=(3.0, 9.0)).margin is None
    assert said("H2-1", climb_of_limit=(0.4,)).margin == pytest.approx(0.1)


def test_the_first_law_is_contradicted_by_the_wrong_sign_where_contact_makes_the_largest_eigenvalue():
    more = {"made": (5.0, 5.0), "load_high": (4.0, 4.0), "load_low": (1.0, 1.0), "theta": (0.01, 0.01)}
    assert said("law-1", size_cond_most=(30, 10), **more).margin == pytest.approx(-math.log(3))  # 100 > 2 sqrt(4)
    assert said("law-1", size_cond_most=(10, 30), **more).margin == pytest.approx(math.log(3))
    wide = {**more, "load_high": (1e4, 1e4)}  # 100 < 2 sqrt(1e4)
    assert said("law-1", size_cond_most=(10, 30), **wide).margin == pytest.approx(-math.log(3))
    assert "largest eigenvalue" in said("law-1", size_cond_most=(10, 30), **{**more, "made": (5.0, 1.0)}).why


def test_a_planted_contradiction_refutes_and_leads_the_search(study):
    keep(study, "K6-1", lambda number, arm: {"failed_audit": float(number == 2), "gap_min": 0.01 * (number + 1)})
    found = rule(study, page.rows_of(study))
    assert found["refuted"] == ["K6-1"] and "**refuted in 1 scene**" in found["every"]
    assert "`K6-1`, draw 2 contradicts: line_search fails (ok)" in found["best_every"]
    assert "--again --only statement=K6-1 --only draw=2`" in found["best_every"]
    assert [draw.label for draw in draws.next_draws(study, named("K6-1"), there(study, "K6-1"))] == ["4", "5of2", "6", "7of2"]


def test_a_mean_is_refuted_by_no_draw_and_draws_without_a_ratio_are_listed(study):
    keep(study, "N2-1", lambda number, arm: {"newton": 10.0 if arm == "clamped" else 20.0} | ({"outcome": "nan"} if number == 3 else {}))
    found = rule(study, page.rows_of(study))
    assert found["refuted"] == [] and "**3 draws of 4 on the other side**" in found["mean"]
    assert "| `N2-1` | clamped nan, absolute nan | 1 |" in found["nothing"] and found["draws"] == 4


def test_the_third_law_is_refuted_by_two_scenes(study):
    def ratio(number, arm):
        return {"size_newton": 30.0 if arm.startswith("log") else 10.0}

    new = keep(study, "law-3", ratio)
    scenes = {draw.point.scene for draw in new}
    assert len(scenes) > 1 and "law-3" in rule(study, page.rows_of(study))["refuted"]
    one = [draw for draw in there(study, "law-3") if draw.point.scene == min(scenes)]
    assert verdict(named("law-3"), one) == "contradicted in 1 scene"


def test_the_page_is_written_from_any_rows(study):
    keep(study, "K6-1", lambda *_: {})
    text = page.write_page(study).read_text()
    assert "no counterexample" in text and "not attacked yet" in text and "`at_size`, question 6" in text


# ---- the spec and the program


@pytest.mark.parametrize("label", LABELS)
def test_the_first_draw_of_every_statement_is_a_config_that_the_program_takes(label, study, tmp_path):
    draw = draws.next_draws(study, named(label), [])[0]
    for case in draws.cases_of(study, draw):
        config = read_object(case.base)
        for pointer, value in (study.data["set"] | case.settings).items():
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
