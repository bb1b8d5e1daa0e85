"""On what a verdict on who gets through rests, and how many numbers a claim has."""

from dataclasses import replace

from barrierbench_analysis.studies.claims import outcomes, registry
from barrierbench_analysis.pages.claims import report
from barrierbench_analysis.studies.claims import table as claims_table
from barrierbench_analysis.studies.claims.entry import read_claim, read_sweep
from barrierbench_analysis.studies.claims.judge import judge
from barrierbench_analysis.studies.claims.proofs import Eval
from barrierbench_analysis.studies.claims.rests import rests_on
from barrierbench_analysis.studies.kit.success import FAILURES
from barrierbench_analysis.studies.claims.table import Runs
from barrierbench_analysis.studies.claims.verdict import HOLDS, IN_PART, Judged

PART = {"says": "more", "rule": "outcomes", "sweep": "made", "case": "mine", "over": "other", "bad": "common"}


def runs(**failed) -> Runs:
    """Ten scenes of three levels. failed: what the other case fails in."""
    rows = []
    for scene in range(10):
        for level in ("1", "2", "3"):
            for case in ("mine", "other"):
                row = {"scene": f"s{scene}", "level": level, "case": case, "seed": 0, "outcome": "ok", "run": "r", "time_asked": 1.0, "residual_max": 1.0, **dict.fromkeys(FAILURES, 0.0)}
                rows.append(row | (failed if case == "other" else {}))
    return Runs({}, rows)


def judged(of: Runs) -> Judged:
    return outcomes.outcomes(PART, of)


def test_a_verdict_that_one_demand_makes_says_so():
    of = runs(close_gap=1.0)
    assert judged(of).verdict == HOLDS
    assert rests_on(PART, of, judged(of)) == "rests on the least gap of 0.05 d_hat alone: without it `does not hold`"


def test_a_verdict_that_holds_without_each_demand_rests_on_none():
    of = runs(close_gap=1.0, short_of_time=1.0)
    assert judged(of).verdict == HOLDS and rests_on(PART, of, judged(of)) == ""
    assert rests_on({**PART, "bad": "close_gap"}, of, judged(of)) == ""  # judged by one condition alone, which the part names
    assert rests_on(PART, of, replace(judged(of), verdict="not decided")) == ""


def kept(name: str):
    table = claims_table.read(claims_table.FILE)
    return judge(read_claim(name), table, Eval(None, table.answers, fresh=False))


def test_k4_against_the_fixed_log_rests_on_the_gap():
    answer = kept("K4")
    against = {"published form against the fixed log": "rests on the least gap of 0.05 d_hat alone: without it `does not hold`"}
    if answer.state.word != registry.UNVERIFIED:  # without git history nothing is confirmed
        assert answer.confirmed.verdict == HOLDS and answer.confirmed_rests == against
        assert report.confirmed_word(answer) == "holds (published form against the fixed log rests on the least gap of 0.05 d_hat alone: without it `does not hold`)"
    # as the sweep says: every run of the fixed log ends ok
    rows = [row for row in claims_table.read(claims_table.FILE).sweeps["shells_policies"].rows if row["case"] == "fixed_log"]
    assert len(rows) == 60 == len(read_sweep("shells_policies").cases) // 3 and all(row["outcome"] == "ok" for row in rows)


def test_two_questions_on_one_number_are_one_number():
    def part(value: float, says: str, **more) -> Judged:
        return Judged(HOLDS, says=says, measures="cond", sweep="s", slice="theta", value=value, **more)

    two = [part(2.0, "above 1"), part(2.0, "below 10"), part(3.0, "above 1"), part(3.0, "below 10"), part(3.0, "beside", beside=True)]
    assert report.counts_of((2, 1, 1), two) == "of 4 questions on 2 numbers: 2 upheld, 1 refuted, 1 not decided"
    assert report.counts_of((1, 1, 0), two[::2]) == "of 2 parts: 1 upheld, 1 refuted, 0 not decided"
    answer = kept("H1")
    assert answer.verdict.verdict == IN_PART and "of 20 questions on 10 numbers" in report.sentence(answer.verdict, True, answer.parts)
