"""Pages and the figure: kinds side by side, scenes beside the mean, exploratory beside confirmed."""

import csv
from dataclasses import replace

from made import runs

from barrierbench_analysis.studies.claims import figure
from barrierbench_analysis.pages.claims import appendix, parts_file, report
from barrierbench_analysis.studies.claims.entry import read_claim
from barrierbench_analysis.studies.claims.judge import Answer
from barrierbench_analysis.studies.claims.numbers import level, ratio, slope
from barrierbench_analysis.studies.claims.outcomes import outcomes
from barrierbench_analysis.studies.claims.registry import State
from barrierbench_analysis.studies.claims.table import Table
from barrierbench_analysis.studies.claims.verdict import Judged, together

OF = {"a": 18.0, "b": 20.0, "c": 25.0}


def judged(rule, function, **part):
    made = runs(lambda s, lv, c, k: {"newton": OF[s] * float(lv) if c == "x" else 10.0})
    found = function({"says": rule, "sweep": "s", "metric": "newton", "case": "x", "over": "y", **part}, made)
    found.rule, found.says = rule, rule
    return found


def answers():
    parts = {"K3": judged("ratio", ratio, above=1), "K17": judged("slope", slope, above=0.5), "H2": judged("level", level, above=0.5), "K4": judged("outcomes", outcomes, needs="more"),
             "H8": Judged("holds", says="law", value=2.0, lower=1.0, upper=9.0, extremes=True, proof=True)}
    return [Answer(replace(read_claim(name), frontier={}, parts=({"says": part.says, "rule": part.rule, "metric": "newton", "case": "x", "over": "y"},)), together([part]), [part]) for name, part in parts.items()]


def test_panels_by_kind_of_number(tmp_path):
    drawn = figure.draw(answers(), tmp_path / "claims")
    rows = {row["claim"]: row for row in csv.DictReader((tmp_path / "claims.csv").read_text().split("\n"))}
    assert {claim: row["panel"] for claim, row in rows.items()} == {"K3": "ratio", "K17": "slope", "H2": "share", "K4": "share", "H8": "closed form"}
    assert len(rows["K3"]["scenes"].split()) == 3 and rows["K4"]["scenes"] == "" and (tmp_path / "claims.png") in drawn
    assert "Light dots below: the scenes" in (tmp_path / "claims.txt").read_text().replace("\n", " ")


def test_the_figure_has_the_number_of_a_confirmation_beside_that_of_its_rule(tmp_path):
    """The square is the number of the same part, and a proof has none: no scene decides it."""
    first, *others = answers()
    again = judged("ratio", ratio, above=1)
    again.value, again.lower, again.upper = 0.5, 0.25, 0.75
    another = judged("ratio", ratio, above=1)
    another.says, another.value = "another part", 9.0
    proof = others[-1]
    proof.confirmed, proof.confirmed_parts = Judged("holds"), [proof.parts[0]]
    figure.draw([replace(first, confirmed=Judged("does not hold"), confirmed_parts=[another, again]), *others], tmp_path / "claims")
    rows = {row["claim"]: row for row in csv.DictReader((tmp_path / "claims.csv").read_text().split("\n"))}
    assert (rows["K3"]["verdict"], rows["K3"]["confirmed_verdict"]) == ("holds", "does not hold")
    assert [float(rows["K3"][f"confirmed_{key}"]) for key in ("value", "lower", "upper")] == [0.5, 0.25, 0.75]
    assert rows["H8"]["confirmed_value"] == rows["K17"]["confirmed_value"] == ""


def test_scatter_slice_and_starts_stand_in_the_table_of_parts():
    a = answers()[0]
    a.parts[0].slice, a.parts[0].sweep = "theta 0.1, limit off", "s"
    made = runs(lambda s, lv, c, k: {})
    (row,) = parts_file.rows([a], Table({"s": made}))
    assert (row["conditions"], row["scenes"], row["starts"]) == ("theta 0.1, limit off", "3", "up to 5 starts at each of 9 places, intraclass correlation 1.0000")
    assert row["by_scene"].startswith("a 3.6 (1.8 to 7.2 at 3, n = 15); ") and row["basis"] == f"exploratory: {len(a.claim.rule_changes)} changes after numbers were seen"
    assert (row["unknowns_least"], row["unknowns_largest"], row["of_small_scenes"]) == ("3", "9", "yes") and float(row["lower"]) < float(row["number"]) < float(row["upper"])
    assert set(row) <= set(parts_file.COLUMNS) and row["interval"] == "95% over scenes" and row["kind"] == "deciding"


def test_exploratory_and_confirmed_side_by_side():
    for state, confirmed, word in ((State(), None, "-"), (State("registered, not run", "why"), None, "registered, not run"), (State("refused", "why"), None, "refused"),
                                   (State("verified", "why", True), Judged("does not hold"), "does not hold")):
        a = answers()[0]
        a.state, a.confirmed = state, confirmed
        line = report.verdict_table([a], Table())[2]
        assert line.split(" | ")[2:4] == ["holds", word], line
    proven = answers()[-1]
    assert report.confirmed_cell(replace(proven, claim=read_claim("H8")), Table()) == "closed form"


def test_a_verdict_of_small_scenes_says_up_to_which_size():
    """The limit stands once, in sizes.py; where a sweep keeps no sizes nothing is said."""
    a = answers()[0]
    a.parts[0].sweep = "s"
    made = runs(lambda s, lv, c, k: {})
    for unknowns, cell, size in (
        ("3 to 4999", "holds; of small scenes (up to 4,999 unknowns)", "of small scenes, 3 to 4,999 unknowns"),
        ("3 to 5000", "holds", "3 to 5,000 unknowns"), ("", "holds", "-")):
        made.about["unknowns"] = unknowns
        line = report.verdict_table([a], Table({"s": made}))[2].split(" | ")
        assert (line[2], line[4]) == (cell, size)
    a.confirmed, a.confirmed_parts = Judged("does not hold"), [replace(a.parts[0], sweep="t")]
    again = runs(lambda s, lv, c, k: {})
    again.about["unknowns"] = "10 to 20"
    assert report.confirmed_cell(a, Table({"s": made, "t": again})) == "does not hold; of small scenes (up to 20 unknowns)"
    a.parts[0].beside = True  # what decides nothing has no size
    assert report.exploratory_cell(a, Table({"s": again})) == "holds"


def test_claims_that_are_true_by_construction_stand_apart_with_a_reason():
    a, proven = answers()[0], answers()[-1]
    assert [line for line in report.verdict_table([a, proven], Table()) if "[H8]" in line] == [] and len(appendix.TRIVIAL) == 5
    (line,) = (line for line in report.trivial_table([a, proven], Table()) if "[H8]" in line)
    assert line.split(" | ")[2:4] == ["holds", appendix.TRIVIAL["H8"]]


def test_what_holds_in_part_says_which_parts(tmp_path):
    refuted = judged("ratio", ratio, below=0.5)
    refuted.says = "less"
    a = replace(answers()[0], verdict=together([answers()[0].parts[0], refuted]))
    a.parts.append(refuted)
    assert report.verdict_table([a], Table())[2].split(" | ")[2] == "holds in part (of 2 questions on 1 number: 1 upheld, 1 refuted, 0 not decided)"
    assert "holds in part (holds: ratio. does not hold: less)" in report.text([a]).replace("\n     ", " ")
    figure.draw([a], tmp_path / "claims")
    assert "holds in part" in (tmp_path / "claims.csv").read_text()


def test_one_scene_has_no_interval():
    alone = ratio({"says": "", "sweep": "s", "metric": "newton", "case": "x", "over": "y", "above": 1}, runs(lambda s, lv, c, k: {"newton": 2.0 if c == "x" else 1.0}, scenes=("a",)))
    assert report.interval(alone) == "2 (one scene: no interval)"


def test_of_many_parts_a_table_says_how_many_hold():
    def part(k: int, verdict: str) -> Judged:
        return Judged(verdict, says=f"part {k}", missing="a scene" if verdict == "not decided" else "")

    few = together([part(1, "holds"), part(2, "does not hold")])
    assert report.sentence(few, brief=True) == report.sentence(few) == "holds in part (holds: part 1. does not hold: part 2)"
    many = together([part(k, verdict) for k, verdict in enumerate(("holds", "holds", "does not hold", "not decided", "not decided", "not decided"))])
    assert report.sentence(many, brief=True) == "holds in part (of 6 parts: 2 upheld, 1 refuted, 3 not decided)" and "part 4" in report.sentence(many)
