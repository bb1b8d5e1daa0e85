"""What tables and figures of claims state of steps that do not have to converge: the residual of their ends, in the words of every other table."""

import json
from dataclasses import replace

import pandas as pd
from made import runs
from synthetic import write_run

from barrierbench_analysis.tables import run_words
from barrierbench_analysis.studies.claims import figure, frontiers
from barrierbench_analysis.pages.claims import parts_file, report
from barrierbench_analysis.studies.claims.ends import end_of_case, ends_of_part
from barrierbench_analysis.studies.claims.entry import read_claim, read_sweep
from barrierbench_analysis.studies.claims.judge import judge
from barrierbench_analysis.studies.claims.proofs import Eval
from barrierbench_analysis.studies.claims.table import Runs, Table, collect

SWEEP = read_sweep("tight_limits")
WORD = "not asked to converge, residual 3 tolerances"


def ends(case: str, seed: int) -> dict:
    """Of the published case, with a residual of 1 to 5 tolerances; the others converge."""
    published = case.startswith("published")
    return {"convergence": "not_asked" if published else "asked", "end_error_tolerances_median": float(seed) if published else 0.01}


def made(**more) -> Runs:
    return runs(lambda s, lv, c, k: {"gap_min": 0.2 if c == "published" else 0.1, "stretch": 0.01, "factorizations": 3.0, **ends(c, k), **more}, scenes=("strip", "ball", "cloth"), cases=("published", "log", "cubic"))


def test_the_words_are_those_of_all_tables():
    row = pd.Series({"convergence": "not_asked", "end_error_tolerances_median": 3.0})
    assert end_of_case(made().rows, "published", SWEEP) == run_words.end_word(row) == WORD
    assert end_of_case(made().rows, "log", SWEEP) == "" == run_words.end_word(pd.Series({"convergence": "asked"}))


def test_of_a_sweep_over_stiffness_all_scales_are_one_case():
    rows = runs(lambda s, lv, c, k: ends(c, k), cases=("published x0.1", "published x1", "log x1")).rows
    assert ends_of_part({"case": "published", "over": "log"}, rows, SWEEP) == f"published: {WORD}"
    assert ends_of_part({}, rows, SWEEP) == f"published x0.1: {WORD}; published x1: {WORD}"


def test_numbers_that_were_kept_without_it_say_that_it_was_not_measured():
    rows = [{key: value for key, value in row.items() if key not in ("convergence", "end_error_tolerances_median")} for row in made().rows]
    assert end_of_case(rows, "published", SWEEP) == "not asked to converge, residual not measured"
    assert end_of_case(rows, "log", SWEEP) == ""


def test_a_record_says_it(tmp_path):
    body = write_run(tmp_path, "log", 1.0, 0.1, note="tight_limits: strip 1% published main=3", folder="one")
    body["status"]["ended_utc"] = "2024-01-31T12:00:02Z"
    body["ids"]["build_id"] = "b"
    body["summary"] |= {"convergence": "not_asked", "end_error_tolerances": {"median": 4.5},
                        "contact_gaps": {"strip|floor": {"gap_rel_p05": 0.1, "gap_rel_median": 0.2, "gap_rel_p95": 0.3, "load_share": 1.0, "time_share": 0.9}}}
    (tmp_path / "one/run.json").write_text(json.dumps(body))
    (row,) = collect(SWEEP, tmp_path, ["newton"]).rows
    assert end_of_case([row], "published", SWEEP) == "not asked to converge, residual 4.5 tolerances"
    assert row["gaps"] == {"strip|floor": [0.1, 0.2, 0.3, True]}


def test_page_and_figure_of_a_claim_say_it(tmp_path, monkeypatch):
    claim, table = replace(read_claim("K1"), parts=read_claim("K1").parts[:1]), Table({"tight_limits": made()})
    monkeypatch.setattr("barrierbench_analysis.studies.claims.judge.missing", lambda *_: [])
    judged = judge(claim, table, Eval(None))
    (row,) = parts_file.rows([judged], table)
    assert row["ends_of_steps"] == f"published: {WORD}" and f"(published: {WORD})" in report.markdown([judged], table)
    assert f"published: {WORD}" in report.text([judged]).replace("\n     ", " ")
    figure.draw([judged], tmp_path / "claims")
    assert WORD in (tmp_path / "claims.csv").read_text() and "residual of their ends" in " ".join((tmp_path / "claims.txt").read_text().split())


def test_the_frontier_says_it(tmp_path):
    claim = replace(read_claim("K4"), frontier={"sweep": "tight_limits", "cost": "factorizations", "axes": {"E": 1}})
    levels = runs(lambda s, lv, c, k: {"factorizations": 3.0, **ends(c, k)}, levels=("nominal", "E0.1"), cases=("published", "log"))
    lines = frontiers.lines(claim, Table({"tight_limits": levels}))
    assert any(line.startswith(f"| published ({WORD}) |") for line in lines) and any(line.startswith("| log |") for line in lines)
    assert frontiers.case_labels(claim, levels) == {"published": f"published ({WORD})", "log": "log"}
    assert frontiers.draw(claim, levels, tmp_path / "frontier")
