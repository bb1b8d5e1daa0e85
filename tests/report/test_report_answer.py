"""The answer of a folder: its lines are those of records with known numbers, on the page and on the terminal; failures that are expected
are labels, others are loud; the page has its sections in order and nothing in it is wider than the window.
"""

import json
import re
import shutil
from pathlib import Path

import pytest

from barrierbench_analysis.figures.plots import answer as plot
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.pages.report import answer, apart, closing, expected, figures, page, tables, verb, verdict
from barrierbench_analysis.pages.report.gather import gathered
from barrierbench_analysis.studies.rules.stress.entry import OUTCOMES
from barrierbench_analysis.tables import answer as rows_of
from report_runs import changed, conditions

NUMBERS = {  # newton, median of the probe, seconds, smallest gap
    "log": (100, 20.0, 2.0, 0.10), "cubic": (50, 40.0, 1.0, 0.15), "cubic_dynamic": (400, 5.0, 8.0, 0.03), "quadratic": (9, 9.0, 9.0, 0.01),
}


@pytest.fixture
def known(runs):
    """log is the reference, cubic and the published method are comparable with it, quadratic stalled."""
    for name, (newton, probe, wall, gap) in NUMBERS.items():
        stats = {"n": 1, "min": 1.0, "p05": 1.0, "p95": 1.0, "max": 1.0, "sum": 1.0, "median": probe}
        changed(runs / name, summary={"newton_iterations": newton, "probe_pcg": stats, "wall_s": wall, "linear_iterations": 0,
                                      "gap_min_rel": {**stats, "median": gap, "min": gap}})
    changed(runs / "cubic_dynamic", labels={"method": "ando2024"}, comparability={"verdict": "comparable"})
    return runs


def expecting(monkeypatch, **ends: expected.End) -> None:
    monkeypatch.setattr(expected, "_listed", lambda: {("strip", name): end for name, end in ends.items()})


def cells_of(folder: Path) -> dict[str, list[str]]:
    return {row[0]: row for row in (line.cells() for line in answer.of(gathered(folder)).lines)}


# --- the lines


def test_the_lines_are_those_of_the_records(known):
    assert cells_of(known) == {
        "fixed log": ["fixed log", "1 of 1", "reference", "0.1", "100", "2000", "2", rows_of.WHEN["fixed log"]],
        "fixed cubic": ["fixed cubic", "1 of 1", "1", "0.15", "x 0.5", "x 1", "x 0.5", rows_of.WHEN["fixed cubic"]],
        "dynamic as published": ["dynamic as published", "1 of 1", "1", "0.03", "x 4", "x 1", "x 4", rows_of.WHEN["dynamic as published"]],
        "fixed quadratic": ["fixed quadratic", "0 of 1", "0", "-", "-", "-", "-", rows_of.WHEN["fixed quadratic"]],
    }
    assert list(cells_of(known)) == ["fixed log", "fixed cubic", "dynamic as published", "fixed quadratic"]


def test_numbers_of_several_pairs_are_means_and_those_of_the_reference_its_ends(known):
    for name in ("log", "cubic"):
        shutil.copytree(known / name, known / "fine" / name)
    changed(known / "fine/cubic", summary={"newton_iterations": 200})
    changed(known / "fine/log", summary={"newton_iterations": 100, "wall_s": 4.0})
    found = cells_of(known)
    assert found["fixed log"][1:7] == ["2 of 2", "reference", "0.1", "100", "2000", "2 to 4"]
    assert found["fixed cubic"][1:7] == ["2 of 2", "2", "0.15", "x 1", "x 2", "x 0.35"]


def test_runs_that_are_not_comparable_are_in_no_number_but_the_count_of_ends(known):
    changed(known / "cubic", comparability={"verdict": "not_comparable"})
    assert cells_of(known)["fixed cubic"][1:7] == ["1 of 1", "0", "-", "-", "-", "-"]
    changed(known / "cubic_dynamic", comparability={"verdict": "not_comparable"})
    found = answer.of(gathered(known))
    assert found.reference == "" and found.notes() == ["No two runs here are comparable, so the table has no factors."]


def test_other_time_steps_and_other_references_are_said(known):
    changed(known / "cubic_dynamic", labels={"dt_s": 0.001})
    notes = answer.of(gathered(known)).notes()
    assert notes[-1] == "Other time steps than the reference: dynamic as published."
    shutil.copytree(known / "quadratic", known / "more/quadratic")
    shutil.copytree(known / "cubic", known / "more/cubic")
    changed(known / "more/quadratic", status={"outcome": "ok", "valid": True})
    reference = json.loads((known / "more/quadratic/run.json").read_text())["ids"]["run_id"]
    changed(known / "more/cubic", comparability={"reference_run": "quadratic", "reference_run_id": reference})
    found = answer.of(gathered(known))
    assert found.left_out == 1 and found.notes()[-1] == "1 comparable run has another reference, or one of the same formulation, and is in no factor."


def test_products_are_of_the_solver_where_every_run_iterates(known):
    assert answer.of(gathered(known)).is_probed
    for name, iterations in (("log", 1000), ("cubic", 3000), ("cubic_dynamic", 500)):
        changed(known / name, summary={"linear_iterations": iterations})
    found = cells_of(known)
    assert [found[name][5] for name in ("fixed log", "fixed cubic", "dynamic as published")] == ["1000", "x 3", "x 0.5"]


def test_a_kind_is_told_by_method_solver_and_scale():
    row = {"formulation": "cubic_dynamic", "method": "", "step_solver": "line_search", "matching_scale": None}
    assert rows_of.name_of(row) == "dynamic to convergence"
    assert rows_of.name_of({**row, "matching_scale": 3.1}) == "dynamic to convergence x s"
    assert rows_of.name_of({**row, "method": "ando2024", "step_solver": "accumulated_toi"}) == "dynamic as published"
    assert rows_of.name_of({**row, "method": "ando2024, changed"}) == "dynamic to convergence"
    assert rows_of.name_of({**row, "formulation": "log", "step_solver": "article_literal"}) == "fixed log (article_literal)"
    assert rows_of.name_of({**row, "formulation": "cubic_dynamic_consistent"}) == "dynamic from a potential"
    presets = {path.stem for path in (ROOT / "configs/formulations").glob("*.json")}
    assert set(rows_of.NAMES) <= presets and set(rows_of.METHODS) == {path.stem for path in (ROOT / "configs/methods").glob("*.json")}
    assert set(rows_of.FIRST) <= set(rows_of.WHEN) <= {*rows_of.NAMES.values(), *rows_of.METHODS.values()}


def test_page_and_terminal_have_the_same_cells_and_the_terminal_100_columns(known):
    changed(known / "quadratic", labels={"formulation": "cubic_dynamic_consistent_scaled", "step_solver": "article_literal"})
    found = answer.of(gathered(known))
    table, lines = answer.table(found), answer.lines(found)
    assert [column.heading for column in table.columns] == list(rows_of.HEAD)
    assert [[cell.text for cell in row] for row in table.rows] == [line.cells() for line in found.lines]
    assert max(map(len, lines)) <= answer.WIDTH
    printed = "\n".join(lines)
    for line in found.lines:
        first, *numbers = line.cells()[:-1]
        words = [re.escape(word) for word in (first[: answer.NAME_WIDTH].split()[0], *numbers)]
        assert re.search(r".*\s+".join(words[:2]) + r"\s+" + r"\s+".join(words[2:]), printed), (line, printed)


# --- the log over the cubic


def test_the_log_over_the_cubic_is_of_each_pair_and_says_which_is_comparable(known):
    (pair,) = rows_of.log_over_cubic(gathered(known).rows.values())
    assert pair.ratios == pytest.approx({"cond_raw": 0.4, "cond_bj": 0.4, "pcg": 0.5, "newton": 2.0})
    assert (pair.place, pair.theta, pair.is_comparable) == ("strip: cubic", 0.2, True)
    shutil.copytree(known / "log", known / "a/log")
    shutil.copytree(known / "cubic", known / "a/cubic")
    changed(known / "a/cubic", comparability={"verdict": "not_comparable"}, summary={"cond": conditions(1000)})
    assert [pair.is_comparable for pair in rows_of.log_over_cubic(gathered(known).rows.values())] == [True, False]
    changed(known / "log", status={"outcome": "newton_stall", "valid": False})
    changed(known / "a/log", status={"valid": False})
    assert rows_of.log_over_cubic(gathered(known).rows.values()) == []


def test_the_figure_is_of_these_pairs(known, tmp_path, unpainted):
    paths = plot.figure(gathered(known).rows.values(), tmp_path)
    assert [path.suffix for path in paths[:3]] == [".png", ".pdf", ".csv"]
    head, line = (tmp_path / "answer.csv").read_text().splitlines()
    assert head == "place,theta,unknowns,comparable,cond_raw,cond_bj,pcg,newton" and line.startswith("strip: cubic,0.2,30,True,0.4")
    said = " ".join((tmp_path / "answer.txt").read_text().split())
    assert "1 pair of runs, 0 of them not comparable" in said and "theta 0.2; 30 to 30 unknowns" in said
    shutil.rmtree(known / "cubic")
    assert plot.figure(gathered(known).rows.values(), tmp_path) == []


# --- failures that are expected


def test_a_failure_that_is_expected_is_a_label_and_any_other_stays_loud(runs, monkeypatch):
    def quadratic():
        return next(entry for entry in gathered(runs).entries if entry.row["formulation"] == "quadratic")

    assert tables.outcome(quadratic()) == tables.Cell("newton_stall", tone="bad", badge=True)
    expecting(monkeypatch, quadratic=expected.End(("newton_stall",), "it cycles"))
    folder = gathered(runs)
    assert tables.outcome(quadratic()) == tables.Cell("newton_stall, expected", tone="expected", badge=True)
    assert verdict.headline(folder) == verdict.Sentence("3 of 4 runs ended ok and are valid; 1 was expected to fail and did.", verdict.GOOD)
    assert list(verdict.expectations(folder)) == [verdict.Sentence("1 run was expected to fail and did: strip: quadratic (newton_stall).", verdict.EXPECTED)]
    assert apart.failures(folder, runs / "report.html").rows[0][3].text == "expected: it cycles"
    assert [(cell.text, cell.tone) for cell in tables.badges(folder)] == [("3 ok", "good"), ("1 newton_stall, expected", "expected")]
    changed(runs / "quadratic", status={"outcome": "nan", "valid": False})
    assert tables.outcome(quadratic()).tone == "bad" and verdict.headline(gathered(runs)).tone == verdict.BAD
    changed(runs / "quadratic", status={"outcome": "ok", "valid": True})
    (said,) = verdict.expectations(gathered(runs))
    assert said == verdict.Sentence("1 run was expected to fail and ended ok: strip: quadratic.", verdict.BAD)


def test_a_run_that_ends_ok_and_is_not_valid_can_be_expected_too(runs, monkeypatch):
    expecting(monkeypatch, log=expected.End(("not_valid",), "past its limit"), quadratic=expected.End(("newton_stall",), "it cycles"))
    changed(runs / "log", status={"outcome": "ok", "valid": False})
    folder = gathered(runs)
    assert tables.outcome(folder.by_run["log"]).text == "ok, not valid, expected"
    assert verdict.headline(folder).text == "2 of 4 runs ended ok and are valid; 2 were expected to fail and did."
    changed(runs / "cubic", status={"outcome": "nan", "valid": False}, audit={"crossings": 2})
    assert verdict.headline(gathered(runs)).text == "1 of 4 runs ended ok and is valid; 2 were expected to fail and did; 1 ended nan."
    assert list(verdict.crossings(gathered(runs)))[0].tone == verdict.BAD
    changed(runs / "cubic", audit={"crossings": 0})
    changed(runs / "quadratic", audit={"crossings": 2})
    assert list(verdict.crossings(gathered(runs)))[0].tone == verdict.BAD  # a stall was expected, no crossing
    expecting(monkeypatch, log=expected.End(("not_valid",), "past its limit"), quadratic=expected.End(("newton_stall", "penetration"), "it lets surfaces through"))
    assert list(verdict.crossings(gathered(runs)))[0].tone == verdict.EXPECTED


def test_every_expected_end_is_of_a_case_of_a_committed_sweep():
    judged = 0
    for (sweep, case), end in expected._listed().items():
        spec = json.loads((ROOT / f"configs/sweeps/{sweep}.json").read_text())
        assert case in [one["label"] for axis in spec["axes"] for one in axis["cases"]] and set(end.outcomes) < set(OUTCOMES) - {"ok"}
        judged += 1
    assert judged == 5


def test_a_stress_test_says_itself_what_is_expected():
    row = {"group": "stress", "series": "S01 log dt=0.02 0123456789", "outcome": "ok", "valid": True}
    assert expected.end_of(row) is None and expected.end_of({**row, "series": "S999 log dt=0.02 0123456789"}) is None
    assert expected.end_of({**row, "series": "S17 log analytic wall 0123456789"}) is None
    assert expected.end_of({**row, "series": "S22 log below a plane 0123456789"}).outcomes == ("initial_intersection",)
    found = [end for path in sorted((ROOT / "configs/stress").glob("[SM][0-9][0-9].json")) for end in expected._of_stress(path.stem).values()]
    assert len(found) > 10 and all("ok" not in end.outcomes and end.because for end in found)


# --- the page


def test_the_answer_comes_first_and_the_sections_fold(known, without_figures):
    assert verb.main([str(known)]) == 0
    text = (known / "report.html").read_text()
    order = re.findall(r'<section id="(\w+)"', text)
    assert order == ["answer", "verdict", "failures", "comparison", "runs", "methods"]
    assert [key for key, _ in page.SECTIONS if key in order] == order and [key for key, _ in page.SECTIONS].index("players") == 2
    opened = dict(re.findall(r'<section id="(\w+)"[^>]*>\s*<details class="fold"( open)?>', text))
    assert opened == {"verdict": " open", "failures": " open", "comparison": "", "runs": "", "methods": ""}
    answered = text[text.index('<section id="answer"') : text.index('<section id="verdict"')]
    assert answered.count("<tr>") == 1 + len(NUMBERS) and "x 0.5" in answered and rows_of.WHEN["fixed log"] in answered


def test_failures_that_are_all_expected_are_folded(runs, without_figures, monkeypatch):
    expecting(monkeypatch, quadratic=expected.End(("newton_stall",), "it cycles"))
    assert verb.main([str(runs)]) == 0
    text = (runs / "report.html").read_text()
    assert re.search(r'<section id="failures"[^>]*>\s*<details class="fold">', text)
    assert '<span class="badge expected">1 newton_stall, expected</span>' in text and '<p class="headline good">' in text


def test_nothing_is_wider_than_a_narrow_window():
    """What tests/report/test_report_browser.py measures in a browser, by the rules that do it."""
    css = (Path(page.HERE) / "page.css").read_text()
    narrow = css[css.index("@media (max-width: 1000px)") :]
    assert ".scroll { overflow-x: auto;" in css and "figure img { display: block; width: 100%;" in css
    assert ".cards thead { display: none; }" in narrow and "overflow-wrap: break-word" in css
    widths = [float(width) for width in re.findall(r"(?<!max-)(?<!-)\bmin-width: ([\d.]+)rem", css)]
    assert widths and max(widths) <= 20  # of cells, which scroll in their own box


# --- the end of a demonstration


def test_a_demonstration_ends_with_the_answer_and_the_files_to_open(known, monkeypatch, tmp_path, unpainted):
    expecting(monkeypatch, quadratic=expected.End(("newton_stall",), "it cycles"))
    file = known / "report.html"
    file.write_text("")
    plot.figure(gathered(known).rows.values(), known / "figures")
    lines = closing.lines(known, file, known / "figures")
    table = answer.lines(answer.of(gathered(known)))
    assert lines[: len(table)] == table
    assert "1 run was expected to fail and did: strip: quadratic (newton_stall)." in lines
    assert lines[-3:] == ["Open:", f"  report page        {file}", f"  comparison figure  {known / 'figures/answer.png'}"]
    (known / "player.html").write_text("")
    monkeypatch.setattr(closing, "_player", lambda folder: folder.root / "player.html")
    assert closing.lines(known, file, known / "figures")[-1] == f"  player             {known / 'player.html'}"


def test_the_report_takes_the_figure_that_was_drawn(known, tmp_path):
    plot.figure(gathered(known).rows.values(), tmp_path)
    shown = figures.drawn(gathered(known), tmp_path).answer
    assert shown == figures.figure_of("", tmp_path / "answer.png") and shown.first.startswith("The log's numbers over the cubic's")
