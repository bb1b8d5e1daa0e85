"""Rules of studies on rows whose numbers are known."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

from barrierbench_analysis.studies.kit.study import page
from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.studies.rules import answer, drift
from barrierbench_analysis.studies.rules.pareto import fronts

NAMES = {"fixed_log": "fixed log", "fixed_cubic": "fixed cubic"}
STUDY = SimpleNamespace(about={"reference": "fixed_log", "large": ["n4"], "names": NAMES})


def row(scene, level, formulation, outcome="ok", build="b", **values):
    place = {"scene": scene, "level": level, "formulation": formulation, "seed": "1"}
    return Row(f"{place}", place, outcome, values, {}, 12, 1.0, "r", {"build": build, "machine": "m"})


def answered(**cubic):
    """Two scenes of two levels: the cubic takes 2 and 8 times the Newton iterations of the log."""
    rows = []
    for scene, factor in (("a", 2), ("b", 8)):
        for level in ("nominal", "hard"):
            rows.append(row(scene, level, "fixed_log", gap_min=0.1, newton=10, products=100, seconds=1))
            values = {"gap_min": 0.2 if scene == "a" else 0.8, "newton": 10 * factor, "products": 50, "seconds": 3}
            rows.append(row(scene, level, "fixed_cubic", cubic.get(f"{scene}_{level}", "ok"), **values))
    return answer.compared(rows, STUDY)


def test_ratios_are_geometric_means_over_scenes_with_an_interval():
    found = answered()["fixed_cubic"]
    assert (found["newton"].value, found["newton"].scenes) == (pytest.approx(4), 2)
    # Student's t of two scenes: 12.706 times half the distance of their logarithms
    assert found["newton"].upper == pytest.approx(4 * math.exp(12.706 * math.log(2)), rel=1e-3)
    assert found["newton"].lower * found["newton"].upper == pytest.approx(16)
    assert found["products"].value == pytest.approx(0.5) and found["seconds"].value == pytest.approx(3)
    assert found["gap"].value == pytest.approx(0.4) and found["ends"].cells == ["4 of 4", "2 of 2 (0.34 to 1.00)"]


def test_a_run_that_failed_enters_the_share_and_no_ratio():
    found = answered(b_nominal="stall_overload", b_hard="stall_overload")["fixed_cubic"]
    assert found["ends"].cells == ["2 of 4", "1 of 2 (0.09 to 0.91)"]
    assert (found["newton"].value, found["newton"].scenes, found["newton"].lower) == (pytest.approx(2), 1, None)
    assert found["gap"].value == pytest.approx(0.2)
    nothing = answered(**{f"{s}_{k}": "nan" for s in "ab" for k in ("nominal", "hard")})["fixed_cubic"]
    assert nothing["newton"] is None and nothing["gap"] is None


def test_seconds_of_two_builds_are_not_compared():
    rows = [row(s, "nominal", f, build=f, gap_min=0.1, newton=10, products=1, seconds=1) for s in "ab" for f in NAMES]
    found = answer.compared(rows, STUDY)["fixed_cubic"]
    assert found["seconds"] is None and found["newton"].value == 1


def test_the_table_has_the_reference_as_one_and_says_when_to_use_each():
    lines = answer.table(answered(), STUDY)
    assert lines[2].startswith("| fixed log | 4 of 4 | 2 of 2 (0.34 to 1.00) | 0.1 [0.1, 0.1] | 1 | 1 | 1 | Use it")
    assert "| 4 [" in lines[3] and "largest load is known" in lines[3] and len(lines) == 4


def test_levels_of_another_size_are_a_table_of_their_own():
    rows = [row(s, level, f, gap_min=0.1, newton=k, products=1, seconds=1) for s in "ab" for f in NAMES for level, k in (("nominal", 1), ("n4", 9))]
    made = answer.rule(STUDY, rows)
    assert made["runs_each"] == 2 and made["levels"] == "nominal" and made["scenes"] == 2
    assert "| fixed cubic | ok | 4 | nominal: 2, n4: 2 |" in made["ended"]


def test_the_advice_of_the_kept_answer_is_what_its_rows_say():
    """tables/answer.py: the log never fails and comes closest, the cubic fails alone by its capacity, the dynamic ones never."""
    study = read_study("answer")
    rows = [r for r in page.rows_of(study) if r.place["level"] not in study.data["about"]["large"]]
    found = answer.compared(rows, study)
    assert all(found[name]["ends"].ok == found[name]["ends"].runs > 0 for name in ("fixed_log", "published", "potential"))
    assert found["fixed_log"]["gap"].upper < min(found[name]["gap"].lower for name in found if name != "fixed_log")
    failed = {r.outcome for r in rows if r.place["formulation"] == "fixed_cubic"} - {"ok"}
    assert failed == {"stall_overload"}
    nominal = [r.outcome for r in rows if (r.place["formulation"], r.place["level"]) == ("fixed_cubic", "nominal")]
    assert nominal and set(nominal) == {"ok"}


def test_drift_is_the_largest_share_of_a_scene_whatever_its_sign():
    study = SimpleNamespace(about={"names": {"fixed_log": "fixed log"}})
    rows = [row("a", f"n{k}", "fixed_log", settled_J=2.0, end_J=end, newton=10.0, gap_min=0.5) for k, end in enumerate((1.98, 2.08, 2.0))]
    rows += [row("b", "n0", "fixed_log", settled_J=1.0, end_J=0.99, newton=30.0, gap_min=0.3)]
    rows += [row("b", "n1", "fixed_log", "newton_stall", settled_J=1.0, end_J=0.1, newton=30.0, gap_min=0.3)]
    cells = drift.rule(study, rows)["table"].splitlines()[2].split(" | ")
    assert cells[1] == "4 of 5" and cells[2].startswith("0.02 [") and cells[3] == "0.3" and cells[4].startswith("15")


def test_seconds_of_a_scene_on_two_machines_are_in_no_front():
    rows = [row("a", "x", f, seconds=2.0) for f in NAMES] + [row("b", "x", f, build=f, seconds=2.0) for f in NAMES]
    runs = fronts.Runs(rows, ("seconds",), "smallest")
    assert [runs.value(one, "seconds") for one in rows] == [2.0, 2.0, None, None]


def test_a_scene_with_a_row_of_another_build_has_no_seconds_and_names_both():
    """Rows of before have no version of their record, rows of today have."""
    study = read_study("work_precision")
    rows = page.rows_of(study)
    scene = next(iter(study.module.rule(study, rows)["scenes"]))
    assert all(run["seconds"] for run in scene["rows"] if run["outcome"] == "ok")
    first = next(k for k, one in enumerate(rows) if one.place["scene"] == scene["name"] and one.place["axis"] != "reference")
    rows[first] = replace(rows[first], origin={**rows[first].origin, "build": "another", "version": "9"})
    again = next(iter(study.module.rule(study, rows)["scenes"]))
    assert not any(run["seconds"] for run in again["rows"]) and "another" in again["about"]["build"]
    assert [run["newton"] for run in again["rows"]] == [run["newton"] for run in scene["rows"]]
