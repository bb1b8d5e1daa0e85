"""Who reaches what and at which cost, on made-up runs whose answers are known."""

import math
from types import SimpleNamespace


from barrierbench_analysis.studies.kit.study import page as study_page
from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.rules.work_precision.figure import draw, draw_profile
from barrierbench_analysis.studies.rules.work_precision.judge import band_of, cheapest, cost_to, formulations, front, points, profile, smallest_error, standing
from barrierbench_analysis.studies.rules.work_precision.tables import intervals, numbers


def row(formulation, axis, factor, newton, error, outcome="ok", solver="direct"):
    return {"formulation": formulation, "axis": axis, "factor": factor, "solver": solver, "outcome": outcome, "error": error, "seconds": newton / 100, "newton": newton,
            "factorizations": newton + 1, "products": 10 * newton, "run": f"{formulation}{axis}{factor}"}


def markdown(*scenes) -> str:
    """The page of scenes."""
    made = SimpleNamespace(origin=scenes[0]["about"], unknowns=9, run="r", key="k")
    return study_page.text_of(read_study("work_precision"), [made], {"doc": "made up", **numbers(list(scenes))})


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


def test_standing_says_in_which_intervals_a_formulation_is_the_cheapest():
    names, found = formulations(scene()), points(scene(), "newton")
    a, b, c = (standing(found, names, name) for name in names)
    assert (a.solved, a.runs, a.smallest, a.cost_there, a.cheapest_in) == (2, 2, 0.05, 20, ((0.05, math.inf),))
    assert (b.solved, b.cheapest_in) == (2, ((0.001, 0.05),))
    assert (c.solved, c.runs, c.smallest, c.cheapest_in) == (1, 2, 0.1, ())
    assert cheapest(found, names) == [(0.1, ("a",)), (0.05, ("a",)), (0.04, ("b",)), (0.001, ("b",))]


def test_a_formulation_that_is_the_cheapest_twice_is_not_so_in_between():
    """a from 0.1 up and again from 0.001 to 0.01, b in between; both at once where they cost the same."""
    made = {**scene(), "rows": [row("a", "anchor", 1.0, 10, 0.1), row("a", "d_hat_m", 0.5, 40, 0.001), row("b", "anchor", 1.0, 20, 0.01), row("b", "d_hat_m", 0.5, 40, 0.001)]}
    found = points(made, "newton")
    a, b = (standing(found, ["a", "b"], name) for name in "ab")
    assert a.cheapest_in == ((0.1, math.inf), (0.001, 0.01)) and b.cheapest_in == ((0.001, 0.1),)
    assert cheapest(found, ["a", "b"]) == [(0.1, ("a",)), (0.01, ("b",)), (0.001, ("a", "b"))]
    assert intervals(a) == "from 0.1 up; 0.001 to 0.01" and intervals(b) == "0.001 to 0.1"
    page = markdown(made)
    assert "| a | 2 of 2 | 0.001 | 40 | from 0.1 up; 0.001 to 0.01 |" in page and "cheaper |" not in page


def test_ends_of_an_interval_are_told_apart():
    made = {**scene(), "rows": [row("a", "anchor", 1.0, 10, 0.1), row("b", "anchor", 1.0, 20, 0.0123411), row("a", "d_hat_m", 0.5, 15, 0.0123422)]}
    assert intervals(standing(points(made, "newton"), ["a", "b"], "b")) == "0.012341 to 0.012342"


def varied_dt(band):
    """a is cheap with a large time step, and no error of it is seen; b is the cheaper one at the anchor."""
    rows = [row("a", "dt_s", 4.0, 1, 0.001), row("a", "anchor", 1.0, 30, 0.01), row("b", "anchor", 1.0, 20, 0.01), row("b", "dt_s", 4.0, 2, None, "newton_stall")]
    return {**scene(band), "rows": rows + [{**r, "solver": "pcg"} for r in rows]}


def test_time_steps_whose_error_nobody_sees_are_not_ranked(tmp_path):
    """A refined reference shares the time step of its runs: what a large step costs less has no price there."""
    refined, closed = varied_dt(1e-4), varied_dt(0.0)
    names = ["a", "b"]
    found = points(refined, "newton")
    assert {p.problem for p in found} == {("anchor", 1.0)} and {p.problem for p in points(refined, "products")} == {("anchor", 1.0)}
    assert front(found, "a") == [(30, 0.01)] and cost_to(found, "a", 0.01) == 30 and standing(found, names, "a").runs == 1
    assert standing(found, names, "a").cheapest_in == () and standing(found, names, "b").cheapest_in == ((0.01, math.inf),)
    assert profile([refined], "newton", "a", 0) == ([30], 1)
    assert [(p.formulation, p.cost, p.error) for p in points(refined, "newton", ranked=False)] == [("a", 1, 0.001), ("b", 2, None)]
    # A closed form has no time step of its own: there they are ranked.
    assert points(closed, "newton", ranked=False) == [] and standing(points(closed, "newton"), names, "a").cheapest_in == ((0.001, math.inf),)
    page = markdown(refined)
    assert "4 runs of other time steps (dt_s) are not ranked" in page and "| a | 1 of 1 | 0.01 | 30 | nowhere |" in page
    assert "not ranked" not in markdown(closed).split("## made")[1]
    draw(refined, tmp_path / "refined")
    assert "Faint marks: other time steps" in " ".join((tmp_path / "refined.txt").read_text().split())
    rows = (tmp_path / "refined.csv").read_text().split("\n")
    assert sum(line.startswith("newton,") for line in rows) == 4 and sum(line.endswith(",True") for line in rows if line.startswith("newton,")) == 2
    draw(closed, tmp_path / "closed")
    assert "Faint" not in (tmp_path / "closed.txt").read_text()


def test_a_run_without_its_seconds_is_not_the_cheapest(tmp_path):
    made = {**scene(), "rows": [{**row("a", "anchor", 1.0, 10, 0.1), "seconds": None}, row("b", "anchor", 1.0, 30, 0.1)]}
    found = points(made, "seconds")
    assert cost_to(found, "a", 0.1) == math.inf and cheapest(found, ["a", "b"]) == [(0.1, ("b",))]
    assert front(found, "a") == [] and profile([made], "seconds", "a", 0) == ([], 1) and profile([made], "seconds", "b", 0) == ([0.3], 1)
    assert cost_to(points(made, "newton"), "a", 0.1) == 10
    draw(made, tmp_path / "made")
    rows = made["rows"] + [{**r, "solver": "pcg"} for r in made["rows"]]
    draw_profile([{**made, "rows": [{**r, "newton": None} for r in rows]}, {**made, "rows": rows}], tmp_path / "profile")


def test_front_has_no_run_that_a_cheaper_one_equals():
    mine = points({**scene(), "rows": [row("a", "anchor", 1.0, n, e) for n, e in ((10, 0.1), (12, 0.1), (15, 0.2), (20, 0.05), (20, 0.06))]}, "newton")
    assert front(mine, "a") == [(10, 0.1), (20, 0.05)]


def test_errors_inside_the_band_are_not_ranked():
    """b and a both lie in a band of 0.06: then the cheaper one leads, down to the band."""
    found = points(scene(band=0.06), "newton")
    names = formulations(scene())
    assert smallest_error(found, "a") == smallest_error(found, "b") == 0.06 and band_of(scene(band=0.06)) == 0.06
    assert standing(found, names, "b").cheapest_in == () and standing(found, names, "a").cheapest_in == ((0.06, math.inf),)


def test_a_run_has_the_band_of_its_own_time_step():
    made = scene(band=0.01)
    made["references"].append({"dt_factor": 2.0, "name": "of 2 dt", "band": {"e_traj": 0.07}})
    made["rows"] = [row("a", "dt_s", 2.0, 5, 0.02), row("a", "d_hat_m", 2.0, 6, 0.02)]
    assert [p.error for p in points(made, "newton", ranked=False)] == [0.07] and [p.error for p in points(made, "newton")] == [0.02]


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
    page = markdown(scene(band=0.002))
    assert "c d_hat_m x0.5 (direct) stall_overload" in page and "Failed or not valid, 2 of 12" in page
    assert "| a | 2 of 2 | 0.05 | 20 | from 0.05 up |" in page and "| b | 2 of 2 | 0.002 (band) | 40 | 0.002 to 0.05 |" in page
    assert "| c | 1 of 2 | 0.1 | 50 | nowhere |" in page and "never" in page and "a made-up truth; e_traj 0.002" in page
    assert "one start" in page and "did other work" in page


def test_nobody_counts():
    made = scene()
    made["rows"] = [row("a", "anchor", 1.0, 10, None, "newton_stall")]
    s = standing(points(made, "newton"), ["a"], "a")
    assert s.solved == 0 and math.isinf(s.smallest) and math.isinf(s.cost_there)
    assert "| a | 0 of 1 | never | never | nowhere |" in markdown(made)
