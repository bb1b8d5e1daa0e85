"""Runs that end ok though points alone were judged, or surfaces overlap obstacles within a promise: a reader of tables, verdict and profiles sees it."""

import pytest

from barrierbench_analysis.figures.plots import profiles
from barrierbench_analysis.figures.plots.drawing import Drawing
from barrierbench_analysis.figures.plots.drawing import SweepRecords
from barrierbench_analysis.tables.records import load
from barrierbench_analysis.pages.report import apart, tables, verb, verdict
from barrierbench_analysis.tables import words
from barrierbench_analysis.pages.report.gather import gathered
from report_runs import changed

POINTS = "audit: points only: vertices were judged at obstacles; the surface between them is at most 0.004 m deep in one"
OVERLAP = "audit: surfaces overlap obstacles at ends of steps, 7 primitives summed over the steps"


@pytest.fixture
def reserved(runs):
    """log is judged by points, cubic overlaps; cubic_dynamic is ok without a reservation."""
    changed(runs / "log", audit={"obstacles_judge": "points"}, status={"detail": POINTS})
    changed(runs / "cubic", audit={"overlaps": 7, "overlap_max_m": 0.003}, status={"detail": OVERLAP})
    return runs


def outcomes(runs) -> dict[str, tables.Cell]:
    return {entry.row["formulation"]: tables.outcome(entry) for entry in gathered(runs).entries}


@pytest.mark.parametrize("audit, said", [
    ({"obstacles_judge": "points"}, "ok: obstacles are judged by points"),
    ({"overlaps": 1}, "ok: overlaps within its promise"),
    ({"corners_cut": 1}, "ok: corners of obstacles cut"),
    ({"overlaps": 2, "corners_cut": 1}, "ok: overlaps within its promise, corners of obstacles cut"),
    ({"overlaps": 0, "corners_cut": 0, "obstacles_judge": "surface"}, "ok"),
])
def test_the_outcome_of_a_run_says_its_reservation(runs, audit, said):
    changed(runs / "cubic", audit=audit)
    found = outcomes(runs)
    assert found["cubic"].text == said and (found["cubic"].tone == "good") == (said == "ok")
    assert found["log"].text == "ok" and found["log"].tone == "good"


def test_a_run_that_does_not_count_has_its_own_word(runs):
    changed(runs / "quadratic", audit={"overlaps": 3})
    changed(runs / "cubic", audit={"overlaps": 3}, status={"valid": False})
    assert outcomes(runs)["quadratic"].text == "newton_stall" and outcomes(runs)["cubic"].text == "ok, not valid"
    assert list(verdict.reserved(gathered(runs))) == []


def test_the_page_has_them_with_the_detail_of_their_status(reserved, without_figures):
    folder = gathered(reserved)
    table = apart.reserved(folder, reserved / "report.html")
    assert [row[3].text for row in table.rows] == [OVERLAP, POINTS] and [row[4].text for row in table.rows] == ["0.003", "-"]
    assert verb.main([str(reserved)]) == 0
    page = (reserved / "report.html").read_text()
    assert POINTS in page and OVERLAP in page and page.index(POINTS) < page.index('<section id="comparison"')
    (said,) = verdict.reserved(folder)
    assert said.text.startswith("2 runs of these are ok with a reservation: strip: cubic (overlaps within its promise) and strip: log (obstacles")
    assert said.tone == verdict.BAD and said in verdict.verdict(folder)
    ok = {row[0].text: row[3] for row in tables.comparison(folder).rows}
    assert sum("1 of 1, 1 with reservations" in cell.text and cell.tone == "" for cell in ok.values()) == 2
    assert sum(cell.text == "1 of 1" and cell.tone == "good" for cell in ok.values()) == 1


def test_a_page_without_reservations_says_nothing_of_them(runs, without_figures):
    assert verb.main([str(runs)]) == 0
    page = (runs / "report.html").read_text()
    assert "reservation:" not in page and 'data-table="reserved"' not in page


@pytest.mark.parametrize("kind", ["performance_profile", "data_profile"])
def test_the_caption_of_a_profile_names_them_and_what_is_left_out(reserved, tmp_path, unpainted, kind):
    for name in ("cubic", "cubic_dynamic", "quadratic", "log"):  # one problem
        changed(reserved / name, labels={"formulation": name, "note": f"strip: {name}"})
    drawing = Drawing("profile", "Profile", tmp_path / "profile", 7.0, {"costs": ["newton_iterations"]})
    getattr(profiles, kind)(SweepRecords("strip", load(reserved), reserved), drawing)
    said = " ".join((tmp_path / "profile.txt").read_text().split())
    assert "1 solved runs are ok with a reservation: cubic (overlaps within its promise); 1 runs whose audit does not judge obstacles by `surface` are left out" in said
    numbers = (tmp_path / "profile.csv").read_text()
    assert "cubic_dynamic" in numbers and "log" not in numbers


def test_profiles_are_of_runs_that_are_judged_alike(reserved):
    runs = load(reserved).runs
    some, text = profiles.judged_alike(runs)
    assert set(some["formulation"]) == {"cubic", "cubic_dynamic", "quadratic"} and text == "1 runs whose audit does not judge obstacles by `surface` are left out"
    changed(reserved / "cubic", audit={"obstacles_judge": "points"})
    changed(reserved / "quadratic", audit={"obstacles_judge": "points"})
    some, text = profiles.judged_alike(load(reserved).runs)
    assert set(some["formulation"]) == {"log", "cubic", "quadratic"} and "by `points` are left out" in text
    changed(reserved / "cubic", audit={"obstacles_judge": "surface"})
    assert set(profiles.judged_alike(load(reserved).runs)[0]["formulation"]) == {"cubic", "cubic_dynamic"}  # of as many, surfaces


def test_runs_that_are_all_judged_by_surfaces_stay(runs):
    some, text = profiles.judged_alike(load(runs).runs)
    assert len(some) == 4 and text == ""


def test_a_scene_that_begins_beyond_its_strain_limit_is_among_the_meanings():
    said = words.meaning("invalid_scene")
    assert "begins beyond its strain limit, or its calibration run could not be matched" in said and "pilot" not in said
