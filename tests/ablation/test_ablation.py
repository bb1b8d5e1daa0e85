"""The draw of the fraction, and what effects are made of: known answers on made tables."""

import json

import numpy as np
import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.kit.study import page
from barrierbench_analysis.studies.kit.study.spec import Study, read_study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.studies.rules import ablation
from barrierbench_analysis.studies.rules.ablation import bound, effects, factors, report
from barrierbench_analysis.studies.rules.ablation.design import drawn, seldom

SCENES = ("one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")


@pytest.fixture(scope="module")
def small(tmp_path_factory) -> factors.Factorial:
    """Ten scenes, three factors of 3, 2 and 5 levels; c with y is excluded."""
    folder = tmp_path_factory.mktemp("small")

    def axis(pointer, labels):
        return {"cases": [{"label": label, "set": {pointer: label}} for label in labels]}

    sweep = {"schema": "barrierbench.sweep/1", "name": "small", "base": "b.json", "set": {}, "budget": {"run_s": 9}, "exclude": [{"labels": ["c", "y"]}],
             "axes": [axis("/scene", SCENES), axis("/shape", "abc"), axis("/solver", "xy"), axis("/precision", ["double", "float", "half", "tenth", "none"])]}
    (folder / "sweep.json").write_text(json.dumps(sweep))
    return factors.read_factorial(study_in(folder))


def study_in(folder, base="b.json", **changes) -> Study:
    about = {"sweep": "sweep.json", "factors": ["scene", "shape", "solver", "precision"], "excluded": ["it means nothing"], "left_out": {}, "seed": 3, "combinations": 8}
    return Study(folder / "small.json", {"name": "small", "rule": "ablation", "question": "?", "base": base, "metrics": {}, "about": about | changes})


@pytest.fixture(scope="module")
def whole() -> factors.Factorial:
    return factors.read_factorial(read_study("ablation"))


def made(small, newton, through=lambda levels: True) -> list[Row]:
    """A row of every allowed combination in every scene. newton: scene number, levels -> iterations."""
    rows = []
    for k, scene in enumerate(SCENES):
        for levels in small.allowed:
            ok = through(levels)
            place = {"scene": scene} | dict(zip((f.name for f in small.factors), small.labels_of(levels), strict=True))
            values = {"newton": newton(k, levels), "bj_p95": 10.0, "pcg": 5.0, "gap": 0.1, "failed": "" if ok else "not_valid"}
            rows.append(Row(" ".join(place.values()), place, "ok" if ok else "newton_stall", values, {}, 45, 1.0, "r", {"date": "d", "machine": "m", "commit": "c", "build": "b"}))
    return rows


def effect(found, small, name) -> effects.Effect:
    return next(e for e in found if report.name_of(small, e.term) == name)


def test_exclusions_leave_what_they_do_not_name(small):
    assert small.sizes == (3, 2, 5) and len(small.allowed) == 25
    assert (2, 1, 0) not in small.allowed and (2, 0, 0) in small.allowed and (1, 1, 0) in small.allowed
    assert small.settings_of("two", (1, 0, 1)) == {"/scene": "two", "/shape": "b", "/solver": "x", "/precision": "float"}


def test_a_draw_is_that_of_its_seed_and_scene(small):
    first = drawn(small, "one")
    assert first == drawn(small, "one") and len(set(first)) == 8 and set(first) <= set(small.allowed)
    assert any(drawn(small, scene) != first for scene in SCENES)


def test_the_fraction_determines_every_main_effect(whole):
    """Of each scene: no level is a combination of others. Integrator and step solver exclude each other in part."""
    terms = effects.main_terms(whole)
    assert len(terms) == 19 and len(whole.allowed) * len(whole.scenes.levels) == 95040
    for scene in whole.scenes.labels:
        array = drawn(whole, scene)
        found = effects.fitted(array, [float(k) for k in range(len(array))], terms, terms)
        assert set(found) == set(terms), scene
        assert seldom(whole, array) >= 0


def test_main_effects_are_ratios_with_the_other_factors_equal(small):
    found = effects.main_effects(small, made(small, lambda k, v: (10 + k) * 2.0 ** (v[0] == 1) * 3.0 ** v[1] * (1 + 0.001 * k) ** v[1]), "newton")
    b, y, single = (effect(found, small, name) for name in ("b", "y", "float"))
    assert np.exp(b.mean) == pytest.approx(2) and np.exp(y.mean) == pytest.approx(3, rel=0.01) and single.mean == pytest.approx(0, abs=1e-12)
    assert y.decided and y.signs == (10, 0) and y.sign_p == y.p == pytest.approx(2 / 1024)
    assert np.exp(y.low) < np.exp(y.mean) < np.exp(y.high)


def test_scenes_are_the_samples(small):
    """An effect that one scene has sixfold and nine have not is not decided, however many runs each has."""
    found = effects.main_effects(small, made(small, lambda k, v: 10 * (6.0 if k == 0 else 1.0 + 0.01 * k * (-1) ** k) ** v[1]), "newton")
    y = effect(found, small, "y")
    assert y.mean > 0 and not y.decided and y.low < 0 < y.high


def test_a_scene_that_is_far_out_does_not_hide_what_all_scenes_have(small):
    """Its interval reaches over nothing, the sign-flip test does not require one spread."""
    found = effects.main_effects(small, made(small, lambda k, v: 10 * (50.0 if k == 0 else 1.02 + 0.01 * k) ** v[1]), "newton")
    y = effect(found, small, "y")
    assert y.low < 0 < y.high and y.decided and y.p == pytest.approx(2 / 1024)


def test_a_scene_with_too_few_runs_has_no_value(small):
    """Eight parameters and 17 runs leave nine degrees of freedom."""
    every = made(small, lambda k, v: (10 + k) * 3.0 ** v[1])
    few = [row for row in every if row.place["scene"] != "one"] + [row for row in every if row.place["scene"] == "one"][-17:]
    y = effect(effects.main_effects(small, few, "newton"), small, "y")
    assert set(y.scenes) == set(SCENES) - {"one"} and y.p is None and not y.decided and report.verdict_of(small, y) == "9 scenes"


def test_failures_are_counted_in_the_share_and_in_no_ratio(small):
    """b fails with three of five precisions, so that it fails whichever two of them are left out."""
    fails = lambda v: v[0] == 1 and v[2] in (1, 2, 3)
    rows = made(small, lambda k, v: 1000.0 if fails(v) else 10.0 + k, lambda v: not fails(v))
    share, newton = effect(effects.main_effects(small, rows, "ok"), small, "b"), effects.main_effects(small, rows, "newton")
    assert share.mean < -0.4 and share.decided and all(abs(e.mean) < 1e-9 and not e.decided for e in newton)


def test_a_main_effect_that_is_one_interaction_is_taken_back(small):
    """b fails with y alone, where it always fails: without y every run of it gets through, as of a."""
    found = effects.main_effects(small, made(small, lambda k, v: 10.0 + k, lambda v: v[:2] != (1, 1)), "ok")
    b = effect(found, small, "b")
    assert b.mean < -0.2 and b.passes and not b.decided
    assert b.without == ((1, 1),) and b.direct.mean == 0.0
    assert report.verdict_of(small, b) == "taken back: without `y` +0.00 [+0.00, +0.00]"


def test_two_levels_left_out_take_back_what_one_does_not(small):
    """b fails with y or with float: each alone leaves failures, without both there is none."""
    found = effects.main_effects(small, made(small, lambda k, v: 10.0 + k, lambda v: not (v[0] == 1 and (v[1] == 1 or v[2] == 1))), "ok")
    b = effect(found, small, "b")
    assert b.passes and not b.decided and set(b.without) == {(1, 1), (2, 1)} and b.direct.mean == 0.0


def test_what_a_definition_makes_is_no_finding(whole):
    """Every reason is of a level and a number that the shipped study has."""
    labels = {(f, level): factor.labels[level] for f, factor in enumerate(whole.factors) for level in range(len(factor.labels))}
    part = {label: part for part, label in labels.items()}
    for (metric, label), why in report.REASONS.items():
        assert metric in (*effects.METRICS, *effects.SHARES)
        made_so = effects.Effect(metric, effects.Term((part[label],)), {}, -0.5, -0.6, -0.4, 0.001, 0.002)
        assert made_so.decided and report.verdict_of(whole, made_so) == f"by construction: {why}"
        said = report.sentence(whole, [made_so], "iterations")
        assert said.startswith("Iterations: 0 of 1 main effects are decided. By construction, so no finding:")
    other = effects.Effect("gap", effects.Term((part["newmark"],)), {}, -0.5, -0.6, -0.4, 0.001, 0.002)
    assert report.verdict_of(whole, other) == "**decided**"


def test_an_effect_that_exclusions_make_of_an_interaction_is_taken_back(small):
    """c stands with x alone, and with x all shapes are alike; b with y costs nine times as much. Additive effects
    put the others lower at x than they are, so c seems to cost more.
    """
    found = effects.main_effects(small, made(small, lambda k, v: (10.0 + k) * 9.0 ** (v[:2] == (1, 1)) * (1 + 0.001 * k * (-1) ** k) ** v[2]), "newton")
    c, y = (effect(found, small, name) for name in ("c", "y"))
    assert c.mean > 0.4 and c.passes and not c.decided and c.without == () and abs(c.direct.mean) < 1e-9
    assert report.verdict_of(small, c).startswith("taken back: 1 [") and report.verdict_of(small, c).endswith("] directly")
    assert y.passes and not y.decided and y.without == ((0, 1),)  # y costs more with b alone
    assert "`c` (1 [1, 1] directly)" in report.sentence(small, found, "iterations")


def test_what_is_bound_is_what_the_exclusions_name(small):
    allowed = bound.contexts(small)
    assert [bound.is_bound(allowed, part) for part in ((0, 1), (0, 2), (1, 1), (2, 3))] == [False, True, True, False]


def test_a_direct_effect_takes_off_the_others(small):
    allowed, levels = bound.contexts(small), [(0, 0, 0), (0, 0, 1), (2, 0, 1)]
    assert bound.direct((0, 2), bound.compared(allowed, (0, 2), levels, [1.0, 3.0, 7.0], {(2, 1): 2.0})) == 4.0
    assert bound.direct((0, 2), bound.compared(allowed, (0, 2), levels, [1.0, 3.0, 7.0], {})) is None


def test_a_direct_effect_needs_runs_of_both_levels(small):
    allowed, levels = bound.contexts(small), [(0, 0, 0), (2, 0, 0), (0, 1, 0)]
    assert bound.direct((0, 2), bound.compared(allowed, (0, 2), levels, [1.0, 4.0, 9.0], {(1, 1): 0.0})) == 3.0
    assert bound.direct((0, 2), bound.compared(allowed, (0, 2), levels[:1], [1.0], {})) is None


def test_an_effect_of_the_size_of_rounding_has_no_sign():
    noise = {f"scene{k}": value for k, value in enumerate((3e-16, -2e-16, 8e-16, -1e-15, 0.0, 2e-16, 5e-16, 1e-16, 4e-16))}
    found = effects.over_scenes("newton", effects.Term(((0, 1),)), {**noise, "one": 0.25})
    assert found.signs == (1, 0) and found.scenes["scene3"] == 0.0
    assert found.p == 1.0 and found.mean == pytest.approx(0.025)


def test_an_interaction_is_no_main_effect():
    """Holm: the smallest of m p is multiplied by m, the next by m - 1."""
    term = [effects.Term(((0, k),)) for k in (1, 2, 3)]
    many = [effects.Effect("newton", t, {}, 1.0, 0.5, 1.5, p) for t, p in zip(term, (0.01, 0.02, 0.2), strict=True)]
    assert [e.holm for e in effects.with_holm(many)] == pytest.approx([0.03, 0.04, 0.2])
    assert [e.decided for e in effects.with_holm(many)] == [True, True, False]


def test_what_no_run_distinguishes_has_no_value(small):
    made_of_x = made(small, lambda k, v: 10.0 + k)
    only = [row for row in made_of_x if row.place["solver"] != "y"]
    y = effect(effects.main_effects(small, only, "newton"), small, "y")
    assert y.mean is None and y.scenes == {} and report.value_of(y) == "no scene has it"


def text_of(small, rows) -> str:
    study = study_in(small.path.parent)
    return page.text_of(study, rows, ablation.rule(study, rows))


def test_the_page_says_what_is_decided_and_what_is_not(small):
    found = text_of(small, made(small, lambda k, v: (10.0 + k) * 3.0 ** v[1] * (1 + 0.01 * (-1) ** k) ** v[0]))
    assert "over 10 scenes without a strain limit" in found and "250 of 250 runs end `ok`" in found and "Their build is b." in found
    first, second = (next(line for line in found.splitlines() if line.startswith(f"{k}. ")) for k in (1, 2))
    assert first.startswith("1. Newton iterations of a run: 1 of 7 main effects are decided: `y` 3 [") and "Not decided: `b`, `c`, `float`" in first
    assert second.count("decided: `") == 1 and "0 of 7" in second and f"\n{len(report.WORDS) + 1}. Interactions: of " in found
    assert "- c with y: it means nothing.\n" in found and "![main effects and interactions](./small.png)" in found


def test_the_page_says_what_was_not_tested_and_not_run(small):
    few = [row for row in made(small, lambda k, v: 10.0 + k) if row.place["scene"] != "ten"][:70]
    found = text_of(small, few)
    assert "Not tested, with fewer than 10 scenes: `b`, `c`, `y`" in found
    assert "70 of 80 runs are there; 10 are not run yet, and `./bench study " in found


@pytest.mark.parametrize(("changes", "words"), [
    ({"factors": ["scene", "shape", "solver"]}, "#/about/factors: 3 names for 4 axes"),
    ({"excluded": []}, "#/about/excluded: 0 reasons for 1 exclusions"),
    ({"base": "other.json"}, "#/base: found 'other.json'; the base of .*sweep.json, b.json, is needed"),
    ({"combinations": 500}, "#/about/combinations: found 500; allowed: at most 25")])
def test_a_spec_that_does_not_fit_its_sweep(small, changes, words):
    with pytest.raises(UserError, match="small.json" + words):
        list(ablation.cells(study_in(small.path.parent, **changes)))


def test_cells_are_the_fraction_of_each_scene(small):
    cells = list(ablation.cells(study_in(small.path.parent)))
    assert len(cells) == 80 and [c.place["scene"] for c in cells] == [scene for scene in SCENES for _ in range(8)]
    assert cells[8].place == {"scene": "two"} | {k[1:]: v for k, v in cells[8].settings.items() if k != "/scene"}
    assert {tuple(small.levels_of(c)) for c in cells if c.place["scene"] == "two"} == set(drawn(small, "two"))


def test_a_run_is_measured_by_the_common_success(record):
    assert ablation.measure(None, None, record) == {"failed": ""}
    record["audit"]["crossings"] = 1
    record["steps"][0]["gap_min_rel"] = 0.01
    assert ablation.measure(None, None, record) == {"failed": "close_gap failed_audit"}


@pytest.fixture
def record() -> dict:
    step = {"status": "converged", "t_s": 0.01, "end_error_tolerances": 0.5, "gap_min_rel": 0.2}
    return {"config": {"time": {"dt_s": 0.01, "steps": 1}}, "steps": [step], "audit": {"enabled": True, "judged": 1}, "status": {"outcome": "ok", "valid": True}}


def test_the_figure_and_its_caption(small, tmp_path):
    rows = made(small, lambda k, v: (10.0 + k) * 3.0 ** v[1])
    study = study_in(small.path.parent)
    picture, caption = ablation.draw(study, rows, ablation.rule(study, rows), tmp_path)
    assert picture.stat().st_size > 10000 and caption.read_text().startswith("Ablation, 250 runs in 10 scenes without a strain limit")
    assert (picture.name, caption.name) == ("small.png", "small.txt") and "the right panel is left out" not in caption.read_text()


def test_the_kept_rows_are_all_of_the_fraction():
    """What the page says of them is compared in tests/study/test_study_calls.py."""
    study = read_study("ablation")
    rows = page.rows_of(study)
    assert len(rows) == len(study.cells) == 1152 and {row.unknowns for row in rows} <= set(range(45, 166))
