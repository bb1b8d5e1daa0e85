"""Numbers that stand in hand-written text of docs are those of the kept results."""

import math
import statistics

import pytest

from barrierbench_analysis.studies.claims import table as claims_table
from barrierbench_analysis.studies.claims.entry import read_claim
from barrierbench_analysis.studies.claims.judge import judge
from barrierbench_analysis.studies.claims.proofs import Eval
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.pages.stated import cost
from barrierbench_analysis.studies.kit.study.store import read_rows
from barrierbench_analysis.pages.readme import numbers

RUNS = {(row["group"], row["series"]): row for row in numbers.read()["runs"]}
LOG, CUBIC, LAGGED = (RUNS["demo_drape", name] for name in ("log", "cubic", "cubic_dynamic_lagged"))


def page(name: str) -> str:
    return " ".join((ROOT / name).read_text().split())


def cond(value: float) -> str:
    power = math.floor(math.log10(value))
    return f"{value / 10**power:.1f}e{power}" if power > 2 else f"{value:.0f}"


def ends(group: str) -> list[float]:
    """The log's condition number over the cubic's at the ends of steps in contact with both."""
    log, cubic = (RUNS[group, name]["cond_steps"] for name in ("log", "cubic"))
    return [log[step] / cubic[step] for step in sorted(log.keys() & cubic.keys())]


def test_the_text_on_the_drape_is_that_of_its_table():
    text, strip = page("docs/results/demo.md"), ends("demo_strip")
    pcg = [f"{row['probe_pcg']:g}" for row in (LOG, CUBIC, RUNS["demo_strip", "log"], RUNS["demo_strip", "cubic"])]
    assert "PCG takes {} against {} iterations (strip: {} against {})".format(*pcg) in text
    assert "and {:.1f} and {:.1f} times in the last two".format(*ends("demo_drape")[-2:]) in text
    assert f"is {LOG['cond_raw_max'] / CUBIC['cond_raw_max']:.1f} times the cubic's in the drape; in the strip it is {statistics.median(strip):.1f} in the median of the step ends, {max(strip):.1f} at most" in text


def test_the_text_on_a_stiffness_refreshed_once_a_step_is_that_of_its_table():
    text = page("docs/results/demo.md")
    for what, key in (("median", "cond_raw_median"), ("largest", "cond_raw_max")):
        assert LAGGED[key] > CUBIC[key] and f"{what} {cond(LAGGED[key])} against {cond(CUBIC[key])}" in text
    assert LAGGED["gap_min_rel"] < CUBIC["gap_min_rel"] and f"narrower ({LAGGED['gap_min_rel']:.3f} against {CUBIC['gap_min_rel']:.3f} d_hat)" in text
    scaled = [cond(row[key]) for row in (LAGGED, CUBIC) for key in ("cond_bj_median", "cond_bj_max")]
    counts = [f"{row[key]:g}" for key in ("probe_pcg", "newton_iterations") for row in (LAGGED, CUBIC)]
    assert "after block-Jacobi scaling {} and {} against {} and {}, PCG {} against {}, Newton {} against {} iterations".format(*scaled, *counts) in text
    assert all(LAGGED[key] < CUBIC[key] for key in ("cond_bj_median", "cond_bj_max", "probe_pcg", "newton_iterations"))


def days(parts) -> str:
    """First to last day of all runs."""
    found = sorted({day for part in parts for day in part["about"]["date"].split(", ")})
    return f"{found[0]} to {found[-1]}"


@pytest.mark.parametrize("name", ["docs/results/claims.md", "docs/guides/reproduce-a-figure.md"])
def test_what_claims_take_is_what_their_runs_took(name):
    (claims,) = (one for one in cost.gather() if one["study"] == "claims")
    of = days({"about": runs.about} for runs in claims_table.read(claims_table.FILE).sweeps.values())
    assert f"{claims['core_s'] / 3600:.2f} core hours" in page(name) and f"runs of {of}" in page(name)
    if name == "docs/results/claims.md":
        assert f"The kept verdicts are of runs of {of};" in page(name)


def test_what_the_stress_suite_takes_is_what_its_runs_took():
    (stress,) = (one for one in cost.gather() if one["study"] == "stress suite")
    found = sorted({row.origin["date"] for row in read_rows(ROOT / "results/studies/stress.jsonl").values()})
    of = f"{found[0]} to {found[-1]}"
    assert f"{stress['runs']} runs, {stress['core_s'] / 60:.1f} minutes of one core ({of})" in page("docs/guides/verbs.md")
    assert f"{stress['core_s'] / 60:.1f} minutes of one core in all" in page("results/STRESS.md")


def test_the_text_on_confirmed_claims_is_that_of_their_numbers():
    table, text = claims_table.read(claims_table.FILE), page("docs/results/claims.md")
    asker = Eval(None, table.answers, fresh=False)

    def of(claim: str, part: int, digits: str = ".2f") -> str:
        judged = judge(read_claim(claim), table, asker).confirmed_parts[part]
        return "{} [{}, {}]".format(*(f"{x:{digits}}" for x in (judged.value, judged.lower, judged.upper)))

    assert f"(K2: {of('K2', 0, '.3g')} seconds)" in text
    assert f"contact terms {of('K7', 0, '.2g')} times as fast" in text and f"is not decided ({of('K7', 1)};" in text
    assert f"(K8: {of('K8', 0)})" in text and f"it is not decided ({of('K8', 1)})" in text
    assert f"(K9: {of('K9', 0)})" in text and f"(K14: {of('K14', 0, '.2g')})" in text
    assert f"clamped takes {of('N2', 0)} times as many" in text and f"in the mean ({of('N2', 1)})" in text
