"""The table and figure of who gets how far, and the counting of cycles, on numbers that are known."""

import json
from dataclasses import replace

import pytest
from made import runs

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.claims import frontiers
from barrierbench_analysis.studies.claims.entry import FOLDER, read_claim
from barrierbench_analysis.studies.kit.metrics import FOLDER as PLACE
from barrierbench_analysis.studies.kit.metrics import METRICS, longest_run
from barrierbench_analysis.studies.claims.outcomes import outcomes
from barrierbench_analysis.studies.claims.table import Table, used_metrics

LEVELS = ("nominal", "E0.1", "E10", "E100", "v2", "v8")
CLAIM = replace(read_claim("K4"), frontier={"sweep": "policies", "cost": "factorizations", "axes": {"E": 1, "v": 1}})


def some_fail(scene, level, case, seed):
    """y stalls in scene b at E10 and everywhere at v8."""
    bad = case == "y" and ((scene, level) == ("b", "E10") or level == "v8")
    return {"outcome": "newton_stall" if bad else "ok", "factorizations": 100.0 if bad else 10.0}


def made():
    return runs(some_fail, levels=LEVELS)


def test_the_table():
    lines = frontiers.lines(CLAIM, Table({"policies": made()}))
    x, y = (next(line for line in lines if line.startswith(f"| {case} |")) for case in "xy")
    assert x == "| x | 90 of 90 runs; every run in 3 of 3 scenes [0.439, 1.000] | 10 | 0.1 to 100 | 1 to 8 |"
    assert y.startswith("| y | 70 of 90 runs; every run in 0 of 3 scenes [0.000, 0.561]") and "| 38.57 | 0.1 to 1[ | 1 to 2[ |" in y  # (70 x 10 + 20 x 100)/70
    assert frontiers.lines(replace(CLAIM, frontier={}), Table()) == [] and frontiers.lines(CLAIM, Table()) == []


def test_not_even_the_middle():
    all_fail = runs(lambda s, lv, c, k: {"outcome": "newton_stall" if c == "y" else "ok", "factorizations": 3.0}, levels=LEVELS)
    line = frontiers.lines(CLAIM, Table({"policies": all_fail}))[-2]
    assert line.count("not even the middle") == 2 and "| 0 of 90 runs; every run in 0 of 3 scenes [0.000, 0.561] | - |" in line


def too_hard(scene, level, case, seed):
    """Nobody gets through a E100, whose runs have no cost either."""
    return some_fail(scene, level, case, seed) | ({"outcome": "newton_stall", "factorizations": None} if (scene, level) == ("a", "E100") else {})


def test_what_nobody_gets_through_is_left_out_of_shares_and_bounds_the_frontier(tmp_path):
    hard = runs(too_hard, levels=LEVELS)
    lines = frontiers.lines(CLAIM, Table({"policies": hard}))
    x = next(line for line in lines if line.startswith("| x |"))
    assert x == "| x | 85 of 85 runs; every run in 3 of 3 scenes [0.439, 1.000] | 10 | 0.1 to 10[ | 1 to 8 |"
    assert "1 of 18 scenes x levels (5 runs of each case) are left out, since no case gets through: a E100." in "".join(lines)
    assert "left out" not in "".join(frontiers.lines(CLAIM, Table({"policies": made()})))
    frontiers.draw(CLAIM, hard, tmp_path / "policies")
    assert "1 of 18 scenes x levels" in (tmp_path / "policies.txt").read_text()


def test_where_nobody_gets_through_the_middle_there_is_no_frontier():
    hard = runs(lambda s, lv, c, k: {"outcome": "newton_stall" if (s, lv) == ("a", "nominal") else "ok", "factorizations": 3.0}, levels=LEVELS)
    line = next(line for line in frontiers.lines(CLAIM, Table({"policies": hard})) if line.startswith("| x |"))
    assert "| x | 85 of 85 runs" in line and line.count("not even the middle") == 2


def test_a_run_without_its_cost():
    broken = made()
    broken.rows[0]["factorizations"] = None
    with pytest.raises(UserError, match="a nominal x main=1: no factorizations"):
        frontiers.lines(CLAIM, Table({"policies": broken}))


def test_levels_are_numbers_of_one_axis():
    assert frontiers.value_of("E0.01", "E", 1) == 0.01 and frontiers.value_of("nominal", "E", 1) == 1
    assert frontiers.value_of("v2", "E", 1) is None and frontiers.value_of("Early", "E", 1) is None


def test_the_figure(tmp_path):
    paths = frontiers.draw(CLAIM, made(), tmp_path / "policies")
    png, numbers = tmp_path / "policies.png", (tmp_path / "policies.csv").read_text()
    assert png in paths and png.stat().st_size > 10000
    assert "profile,x,10.0,1.0" in numbers and f"profile,y,10.0,{70 / 90:.5f}"[:20] in numbers and "share,y,v8,0.0" in numbers


def test_the_cost_is_collected():
    assert "factorizations" in used_metrics([replace(CLAIM, parts=())])["policies"] and CLAIM.sweeps == ["policies"]


def test_a_frontier_that_lacks_something(tmp_path):
    data = json.loads((FOLDER / "K4.json").read_text())
    del data["frontier"]["cost"]
    (tmp_path / "K4.json").write_text(json.dumps(data))
    with pytest.raises(UserError, match="/frontier: sweep, cost and axes are needed"):
        read_claim("K4", tmp_path)


def test_cycles_are_ten_changes_in_a_row(tmp_path):
    assert longest_run([0.5] * 4 + [0.005] + [0.5] * 7 + [0.01]) == 7 and longest_run([]) == 0
    read = METRICS["kappa_cycles"][3]

    def record(folder, n_lines):
        return {PLACE: str(folder), "schema": {"version": "3.3.0"}, "summary": {"newton_iterations": n_lines}}

    def count(*steps):
        lines = [{"step": k, "kappa_change_rel": change} for k, changes in enumerate(steps) for change in changes]
        (tmp_path / "trace.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
        return read(record(tmp_path, len(lines)))

    assert count([0.5] * 10, [0.5] * 9, [None] + [0.02] * 30) == 2
    assert count([0.5] * 5, [0.5] * 5) == 0  # a new step begins anew
    assert read({}) is None and read(record(tmp_path / "none", 0)) is None


def test_without_a_trace_no_cycle_is_no_proof():
    missing = runs(lambda s, lv, c, k: {"kappa_cycles": None})
    with pytest.raises(UserError, match="no kappa_cycles"):
        outcomes({"says": "x", "sweep": "s", "case": "x", "over": "y", "bad": "kappa_cycles"}, missing)
