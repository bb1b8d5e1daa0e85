"""Figures of the comparison on small tables whose answers were worked out by hand."""

import math

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import LogNorm

from barrierbench_analysis.figures import pgfplots
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.figures.plots import friction_slope, gap_ridge, heat_map, matrices, one_step, pair_forces, phase_times, profiles, resolution, scaling, slopes, step_front, trend
from barrierbench_analysis.tables.records import load
from synthetic import write_set


def run_rows(costs: dict[str, list], outcomes: dict[str, list] | None = None) -> pd.DataFrame:
    """A row a formulation and problem p1, p2, ...; None: failed at cost 99."""
    rows = []
    for formulation, of in costs.items():
        for k, cost in enumerate(of, 1):
            bad = cost is None
            rows.append({"run": f"{formulation} p{k}", "series": f"p{k} {formulation}", "formulation": formulation, "outcome": "newton_stall" if bad else "ok",
                         "valid": not bad, "newton_iterations": 99 if bad else cost, "comparability_verdict": "comparable", "steps": 2})
    return pd.DataFrame(rows)


TWO = run_rows({"log": [2, 4, None, 10, None], "cubic": [4, 4, 3, None, None]})


def test_the_performance_profile_of_two_solvers():
    found = profiles.trials(TWO, "newton_iterations")

    assert set(found["problem"]) == {"p1", "p2", "p3", "p4", "p5"}  # p5, which nobody solves, counts
    assert profiles.performance(found, "log") == [(1.0, 3 / 5)]
    assert profiles.performance(found, "cubic") == [(1.0, 2 / 5), (2.0, 3 / 5)]


def test_the_data_profile_of_two_solvers():
    found = profiles.trials(TWO, "newton_iterations")

    assert profiles.data(found, "log") == [(2.0, 1 / 5), (4.0, 2 / 5), (10.0, 3 / 5)]
    assert profiles.data(found, "cubic") == [(3.0, 1 / 5), (4.0, 3 / 5)]


def test_costs_pair_by_pair_are_of_problems_that_both_solve():
    pairs = profiles.pairwise(profiles.trials(TWO, "newton_iterations")).set_index(["over", "under"])

    assert pairs.loc[("log", "cubic"), "ratio"] == pytest.approx(math.sqrt(2 / 4 * 4 / 4))
    assert pairs.loc[("log", "cubic"), "n"] == 2
    assert pairs.loc[("cubic", "log"), "ratio"] == pytest.approx(math.sqrt(2))
    assert pairs.loc[("log", "log"), "ratio"] == 1


def test_a_run_that_is_not_valid_solves_nothing():
    runs = TWO.assign(valid=False)

    assert profiles.performance(profiles.trials(runs, "newton_iterations"), "log") == []


GRID = pd.DataFrame([
    {"run": f"{e} {dt} {seed}", "formulation": "log", "dt": dt, "E": e, "outcome": outcome, "newton_iterations": n, "steps": 2}
    for e, dt, seed, outcome, n in [
        (1.0, 0.1, 1, "ok", 8), (1.0, 0.1, 2, "ok", 12), (1.0, 0.2, 1, "ok", 20), (1.0, 0.2, 2, "newton_stall", 60),
        (2.0, 0.1, 1, "penetration", 4), (2.0, 0.1, 2, "stall_overload", 4), (2.0, 0.2, 1, "ok", 6), (2.0, 0.2, 2, "ok", 6),
        (3.0, 0.1, 1, "ok", 6), (3.0, 0.1, 2, "ok", 6), (3.0, 0.2, 1, "ok", 6), (3.0, 0.2, 2, "ok", 6)]])


def test_letters_and_iterations_of_cells():
    cells = heat_map.table(GRID, "dt", "E").set_index(["x", "y"])

    assert cells.loc[(0.1, 1.0), "letter"] == "o"
    assert cells.loc[(0.1, 1.0), "iterations"] == 5  # (8/2 + 12/2)/2
    assert cells.loc[(0.2, 1.0), "letter"] == "I1"  # one of two stalled
    assert cells.loc[(0.1, 2.0), "letter"] == "P1"  # penetration comes first in the order of the schema
    assert math.isnan(cells.loc[(0.1, 2.0), "iterations"])


def test_every_cell_has_its_letter_in_the_picture():
    _, axis = plt.subplots()
    heat_map.draw(axis, heat_map.table(GRID, "dt", "E"), LogNorm(1, 10))

    assert {(round(t.get_position()[0]), round(t.get_position()[1])): t.get_text() for t in axis.texts} == {
        (0, 0): "o", (1, 0): "I1", (0, 1): "P1", (1, 1): "o", (0, 2): "o", (1, 2): "o"}
    assert len(axis.patches) == 2  # failed cells are drawn, as failed
    plt.close("all")


def test_every_outcome_of_the_schema_has_a_letter_of_its_own():
    assert set(heat_map.LETTERS) == set(heat_map.WORDS)
    assert len(set(heat_map.LETTERS.values())) == len(heat_map.WORDS)


def test_the_frontier_of_success():
    found = heat_map.reached(GRID, "dt", "E").set_index("y")

    assert found.loc[1.0, "reached"] == 0.1 and found.loc[1.0, "fails_at"] == 0.2
    assert math.isnan(found.loc[2.0, "reached"])  # the smallest step fails, though a larger one gets through
    assert found.loc[3.0, "reached"] == 0.2 and math.isnan(found.loc[3.0, "fails_at"])


def test_the_distribution_of_eigenvalues_keeps_those_below_zero_in_the_count():
    x, share = matrices.ecdf(np.array([-1.0, 2.0, 3.0, 3.0]))

    assert list(x) == [2, 3, 3]
    assert list(share) == [0.5, 0.75, 1.0]


def test_slopes():
    assert slopes.slope([1, 2, 4], [3, 12, 48]) == pytest.approx(2)
    assert slopes.slope([1, 2, 4], [5, np.nan, 80]) == pytest.approx(2)
    assert slopes.slope([2, 2], [1, 3]) is None


def test_shares_of_gaps():
    shares = gap_ridge.shares(np.array([2.0, 0.5, 0.05, 0.05, 1e-9]), -2.0)  # one not in contact, one below all bins

    assert len(shares) == 2 * gap_ridge.BINS
    assert shares.sum() == pytest.approx(1)
    assert shares[0] == 0.25 and shares[5] == 0.5  # log10(0.05) = -1.30 in [-1.375, -1.25)
    assert gap_ridge.shares(np.array([1.0, 3.0]), -2.0).sum() == 0


def test_the_closed_form_of_a_block_on_a_slope():
    slope = friction_slope.Slope(10.0, 0.75, 1e-3)  # sin 0.6, cos 0.8

    assert list(slope.acceleration([0.0, 0.5, 0.75, 2.0])) == pytest.approx([6.0, 2.0, 0.0, 0.0])


def config(n: int = 5, mu: float = 0.25) -> dict:
    return {"friction": {"mu": mu, "eps_v_m_per_s": 1e-3},
            "scene": {"gravity_m_per_s2": [0, 0, -10], "obstacles": [{"axis": [0.6, 0, 0.8]}],
                      "bodies": [{"mesh": {"size_x_m": 2.0, "size_y_m": 0.5, "n_x": n}, "material": {"density_kg_per_m2": 3.0}}]}}


class Run:
    def __init__(self, given: dict, *steps: dict):
        self.config, self.steps = given, pd.DataFrame(steps)


def test_acceleration_of_a_run_from_its_energy():
    of = [{"kinetic_J": 0.5 * 3.0 * v**2, "t_s": t} for v, t in [(0.5, 1.0), (1.0, 2.0), (3.0, 3.0), (4.0, 4.0)]]  # 3 kg
    run = Run(config(), *of)  # from 1 m/s at 2 s to 4 m/s at 4 s
    row = friction_slope.table([(pd.Series({"formulation": "log", "outcome": "ok"}), run)]).iloc[0]

    assert row["speed_m_per_s"] == pytest.approx(4)
    assert row["acceleration_m_per_s2"] == pytest.approx(1.5)
    assert row["tan"] == pytest.approx(0.75)
    assert row["closed_form_m_per_s2"] == pytest.approx(10 * (0.6 - 0.25 * 0.8))


def test_a_failed_run_has_no_acceleration():
    run = Run(config(), {"kinetic_J": 1.0, "t_s": 1.0}, {"kinetic_J": 2.0, "t_s": 2.0})
    row = friction_slope.table([(pd.Series({"formulation": "log", "outcome": "newton_stall"}), run)]).iloc[0]

    assert math.isnan(row["acceleration_m_per_s2"])


def test_forces_of_a_step_without_contact_are_0():
    run = Run(config(), *({"t_s": t} for t in (0.5, 1.0)))
    run.pair_forces = pd.DataFrame([{"step": 1, "t_s": 1.0, "body_a": "a", "body_b": "b", "contacts": 3, "normal_N": 2.5, "friction_N": 0.5}])
    found = pair_forces.table([(pd.Series({"formulation": "log", "run": "r", "outcome": "ok"}), run)])
    assert list(found["t_s"]) == [0.5, 1.0] and set(found["pair"]) == {"a, b"}
    assert list(found["normal_N"]) == [0, 2.5] and list(found["friction_N"]) == [0, 0.5] and list(found["contacts"]) == [0, 3]


def test_errors_of_meshes_against_both_references():
    heights = {("log", 3): 1.4, ("log", 5): 1.1, ("log", 9): 1.0, ("cubic", 5): 1.5, ("cubic", 9): 1.2}
    runs = [(pd.Series({"formulation": f, "outcome": "ok", "scene_extent_m": 2.0, "scene_free_dofs": n}), Run(config(n), {"gravity_J": 30.0 * h}))
            for (f, n), h in heights.items()]
    found, band = resolution.heights(runs).errors()
    of = found.set_index(["formulation", "unknowns"])

    assert of.loc[("log", 3), "own"] == pytest.approx(0.4 / 2) and of.loc[("log", 9), "own"] == 0
    assert of.loc[("cubic", 5), "own"] == pytest.approx(0.3 / 2)
    assert of.loc[("log", 5), "common"] == pytest.approx(0.0)  # the middle of 1.0 and 1.2
    assert band == pytest.approx(0.1 / 2)
    assert of.loc[("log", 3), "cell_m"] == 1.0


def test_the_bound_of_conjugate_gradients():
    assert matrices.bound(np.array([4.0]))[0] == pytest.approx(math.log(2e6))


def test_points_of_the_preconditioned_matrix_are_the_traces(tmp_path):
    write_set(tmp_path)
    found = matrices.table(load(tmp_path))
    log = found[found["formulation"] == "log"]

    assert list(log["cond"]) == [1, 1, 2, 2, 3, 3]
    assert list(log["probe_pcg_iterations"]) == [10, 10, 11, 11, 12, 12]
    assert matrices.ranks(found)["log"] == pytest.approx(1)


def test_the_step_that_is_held_back_most():
    rows = pd.DataFrame({"run": list("aabbabb"), "step": [0, 0, 0, 0, 1, 1, 2], "alpha": [1.0, 0.1, 1.0, 1.0, 0.5, 0.5, 0.01]})

    assert one_step.least(rows["alpha"], rows) == 1  # means 0.55 and 0.5; step 2 is of one run alone
    assert one_step.least(rows["alpha"][:4], rows[:4]) == 0
    assert one_step.least(pd.Series(dtype=float), pd.DataFrame()) is None


def test_the_step_with_the_largest_condition_numbers():
    cond = pd.DataFrame({"run": list("abab"), "step": [0, 0, 1, 1], "cond": [10.0, 1000.0, 90.0, 90.0], "scaling": "none", "stage": "full"})

    assert one_step.worst(cond) == 0  # geometric means 100 and 90
    assert one_step.worst(cond.assign(scaling="block_jacobi")) is None


def test_phase_times_are_sums_of_phases_over_iterations():
    times = {f"time_{column}_s": 0.0 for columns, _, _ in phase_times.PHASES.values() for column in columns}
    run = times | {"time_linear_factor_s": 0.03, "time_linear_solve_s": 0.01, "time_step_bound_s": None, "time_linear_analyze_s": np.nan, "formulation": "log", "linear_solver": "cholmod",
                   "outcome": "ok", "scene_free_dofs": 7, "newton_iterations": 8}
    found = phase_times.table(pd.DataFrame([run])).set_index("phase")["ms_an_iteration"]

    assert found["linear system"] == pytest.approx(5)
    assert found["CCD"] == 0 and found.sum() == pytest.approx(5)


def test_no_phase_of_a_record_is_left_out():
    from barrierbench_analysis.io import fields

    known = {column.removeprefix("time_").removesuffix("_s") for column in fields.columns("steps") if column.startswith("time_")}
    drawn = {column for columns, _, _ in phase_times.PHASES.values() for column in columns}
    assert known - drawn == {"output"}


def test_failed_runs_have_no_number_of_scaling_and_stay_in_the_table():
    runs = pd.DataFrame({"formulation": ["log", "log"], "linear_solver": ["pcg", "pcg"], "scene_free_dofs": [10, 20], "outcome": ["ok", "timeout"],
                         "newton_iterations": [4, 4], "linear_solves": [5, 5], "solve_s": [0.02, 0.02], "linear_iterations": [50, 50], "steps": [2, 2],
                         "time_linear_factor_s": [0.004, 0.004], "time_linear_solve_s": [0.008, None]})
    found = scaling.table(runs)

    assert list(found.loc[0, ["ms_an_iteration", "ms_outside", "pcg_a_solve", "newton_a_step"]]) == pytest.approx([5, 2, 10, 2])
    assert found.loc[1, ["ms_an_iteration", "ms_outside", "pcg_a_solve", "newton_a_step"]].isna().all()
    assert list(found["outcome"]) == ["ok", "timeout"]


def test_a_trend_is_over_the_first_value_and_of_the_number_itself():
    rows = [{"at": k, "case": "strip-log", "metric": "log10_cond full/none median", "value": v, "lower": v - 1, "upper": v + 1} for k, v in enumerate([3.0, 4.0])]
    rows += [{"at": 1, "case": "late-log", "metric": "log10_cond full/none median", "value": 3.0, "lower": 2.0, "upper": 4.0}]
    found = trend.relative(pd.DataFrame(rows), "log10_cond full/none median")

    assert list(found["case"]) == ["strip-log", "strip-log"]  # one commit is no trend
    assert list(found["value"]) == pytest.approx([1, 10])
    assert list(found["lower"]) == pytest.approx([0.1, 1])


def test_numbers_for_pgfplots():
    table = pd.DataFrame({"a b": ["two words", "", None], "x/y": [0.1, np.nan, 3.0]})

    assert pgfplots.text(table) == "a_b x_y\n{two words} 0.1\n{} nan\nnan 3.0\n"


def test_a_caption_says_n_statistic_reference_and_slice():
    assert Facts("3 runs", "mean", "none", "strip").sentence() == "N: 3 runs. Statistic: mean. Reference: none. Conditions: strip."
    with pytest.raises(ValueError, match="a caption without reference"):
        Facts("3 runs", "mean", " ", "strip")


def test_errors_over_the_time_step_are_those_against_the_own_finest_step(monkeypatch):
    ends = {"log 10": np.full((4, 3), 0.5), "log 5": np.full((4, 3), 0.2), "log 1": np.zeros((4, 3)), "cubic 10": np.full((4, 3), 7.0), "cubic 1": None}
    monkeypatch.setattr(step_front, "end", ends.get)
    rows = []
    for name in ends:
        formulation, ms = name.split()
        outcome = "newton_stall" if name == "cubic 1" else "ok"
        rows.append((pd.Series({"formulation": formulation, "outcome": outcome, "dt_s": int(ms) / 1e3, "newton_iterations": 3, "solve_s": 1.0, "scene_extent_m": 2.0}), name))
    found = step_front.table(rows)
    assert list(found["error"])[:2] == pytest.approx([math.sqrt(3) * 0.5 / 2, math.sqrt(3) * 0.2 / 2])
    assert found["error"].isna().tolist() == [False, False, True, True, True]  # the reference, and two without one
    assert step_front.left_out(found) == " Not drawn, since the run or its reference failed: cubic at 10 ms (ok)."
    with pytest.raises(UserError, match="two runs of log at 0.01 s"):
        step_front.table([*rows, rows[0]])
