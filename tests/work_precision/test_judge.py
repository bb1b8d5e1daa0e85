"""Who reaches what and at which cost, on made-up runs whose answers are known."""

import math

import pytest

from analysis.work_precision.judge import band_of, cheapest, cost_to, formulations, front, points, profile, smallest_error, standing
from analysis.work_precision.report import markdown, text


def row(formulation, axis, factor, newton, error, outcome="ok", solver="direct"):
    return {"formulation": formulation, "axis": axis, "factor": factor, "solver": solver, "outcome": outcome, "error": error, "seconds": newton / 100, "newton": newton,
            "factorizations": newton + 1, "products": 10 * newton, "run": f"{formulation}{axis}{factor}", "errors": {} if error is None else {"e_traj": error}}


def scene(band=0.0):
    """a is cheap and coarse, b dear and fine, c fails where it is pushed and is never the cheapest."""
    rows = [row("a", "anchor", 1.0, 10, 0.1), row("a", "d_hat_m", 0.5, 20, 0.05), row("b", "anchor", 1.0, 30, 0.04), row("b", "d_hat_m", 0.5, 40, 0.001),
            row("c", "anchor", 1.0, 50, 0.1), row("c", "d_hat_m", 0.5, 15, None, "stall_overload")]
    rows += [{**r, "solver": "pcg"} for r in rows]
    return {"name": "made", "base": "configs/scenes/made.json", "error": "e_traj", "targets": [0.1, 0.045], "anchor": {"dt_s": 0.01, "d_hat_m": 0.01, "tolerance": 0.01},
            "duration_s": 1.0, "references": [{"dt_factor": 1.0, "name": "a made-up truth", "band": {"e_traj": band} if band else {}}],
            "about": {"unknowns": 9, "seconds": 1.0, "runs": 12, "date": "2024-01-31", "machine": "a cpu", "commit": "0", "build": "0"}, "rows": rows}


def test_cost_to_an_error_is_that_of_the_cheapest_run_that_reaches_it():
    found = points(scene(), "newton")
    assert [cost_to(found, "a", x) for x in (1.0, 0.1, 0.09, 0.05, 0.04)] == [10, 10, 20, 20, math.inf]
    assert cost_to(found, "b", 0.1) == 30 and cost_to(found, "c", 0.001) == math.inf
    assert {name: smallest_error(found, name) for name in formulations(scene())} == {"a": 0.05, "b": 0.001, "c": 0.1}


def test_standing_says_where_a_formulation_stops_being_the_cheapest():
    names, found = formulations(scene()), points(scene(), "newton")
    a, b, c = (standing(found, names, name) for name in names)
    assert (a.solved, a.runs, a.smallest, a.cost_there, a.cheapest_down_to, a.cheaper) == (2, 2, 0.05, 20, 0.05, "b")
    assert (b.solved, b.cheapest_down_to, b.cheaper) == (2, 0.001, "")
    assert (c.solved, c.runs, c.smallest) == (1, 2, 0.1) and math.isinf(c.cheapest_down_to) and c.cheaper == "a"
    assert cheapest(found, names) == [(0.1, "a"), (0.05, "a"), (0.04, "b"), (0.001, "b")]


def test_front_has_no_run_that_a_cheaper_one_equals():
    mine = points({**scene(), "rows": [row("a", "anchor", 1.0, n, e) for n, e in ((10, 0.1), (12, 0.1), (15, 0.2), (20, 0.05), (20, 0.06))]}, "newton")
    assert front(mine, "a") == [(10, 0.1), (20, 0.05)]


def test_errors_inside_the_band_are_not_ranked():
    """b and a both lie in a band of 0.06: then the cheaper one leads, down to the band."""
    found = points(scene(band=0.06), "newton")
    names = formulations(scene())
    assert smallest_error(found, "a") == smallest_error(found, "b") == 0.06 and band_of(scene(band=0.06)) == 0.06
    assert standing(found, names, "b").cheaper == "a" and math.isinf(standing(found, names, "b").cheapest_down_to)


def test_a_run_has_the_band_of_its_own_time_step():
    made = scene(band=0.01)
    made["references"].append({"dt_factor": 2.0, "name": "of 2 dt", "band": {"e_traj": 0.07}})
    made["rows"] = [row("a", "dt_s", 2.0, 5, 0.02), row("a", "d_hat_m", 2.0, 6, 0.02)]
    assert [p.error for p in points(made, "newton")] == [0.07, 0.02]


def test_profile_counts_failures_as_never():
    scenes = [scene(), scene()]
    assert profile(scenes, "newton", "a", 0) == ([10, 10, 20, 20], 4)
    assert profile(scenes, "newton", "c", 0) == ([50, 50], 4)
    assert profile(scenes, "newton", "a", 1) == ([], 4) and profile(scenes, "factorizations", "b", 1) == ([31, 31, 41, 41], 4)


def test_costs_come_from_the_solver_that_has_them():
    made = scene()
    made["rows"] = [row("a", "anchor", 1.0, 10, 0.1), row("a", "anchor", 1.0, 11, 0.2, solver="pcg")]
    assert [(p.cost, p.error) for p in points(made, "products")] == [(110, 0.2)] and [(p.cost, p.error) for p in points(made, "newton")] == [(10, 0.1)]


def test_the_page_names_what_failed_and_what_is_useless():
    page = markdown({"doc": "made up", "scenes": [scene(band=0.002)]})
    assert "c d_hat_m x0.5 (direct) stall_overload" in page and "Failed or not valid, 2 of 12" in page
    assert "| a | 2 of 2 | 0.05 | 20 | 0.05 | b |" in page and "| b | 2 of 2 | 0.002 (band) | 40 | 0.002 | - |" in page
    assert "| c | 1 of 2 | 0.1 | 50 | nowhere | a |" in page and "never" in page and "a made-up truth; e_traj 0.002" in page
    assert "b is cheaper below 0.05" in text({"scenes": [scene()]})


@pytest.mark.parametrize("error", [None])
def test_nobody_counts(error):
    made = scene()
    made["rows"] = [row("a", "anchor", 1.0, 10, error, "newton_stall")]
    s = standing(points(made, "newton"), ["a"], "a")
    assert s.solved == 0 and math.isinf(s.smallest) and math.isinf(s.cost_there)
    assert "| a | 0 of 1 | never | never | nowhere | - |" in markdown({"doc": "", "scenes": [made]})
