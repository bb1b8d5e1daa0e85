"""A series is drawn as a band from where it swings, and only there."""

import json

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.plots import kappa_cycle, swings
from barrierbench_analysis.tables.records import load
from synthetic import write_cycle, write_set

CALM = np.linspace(1, 0.5, 20)
CYCLE = np.where(np.arange(40) % 2, 0.1, 0.6)
ROW = pd.Series({"series": "cubic", "formulation": "cubic", "outcome": "newton_stall", "comparability_verdict": ""})


@pytest.mark.parametrize(("values", "start"), [
    (CALM, None), (CYCLE, 0), (np.concatenate([CALM, CYCLE]), 19), (np.concatenate([CYCLE, CALM]), None),  # it settles
    (1 + 1e-3 * CYCLE, None), (CYCLE[:6], None), (np.tile([0.1, 0.3, 0.6, 0.3], 10), 0),
    (np.concatenate([CALM, np.tile([0.5, 0.502, 0.5, 0.8], 10)]), 19), (np.tile([0.5, 0.502, 0.5, 0.52], 10), None)])  # one large move of four
def test_where_a_series_swings(values, start):
    found = swings.swings_from(values)
    assert (found is None) if start is None else abs(found - start) <= swings.WINDOW // 2


def test_the_band_is_the_running_least_and_largest_and_a_calm_series_has_none():
    _, axis = plt.subplots()
    values = np.concatenate([CALM, CYCLE])
    [band] = swings.draw(axis, np.arange(60), values, ROW, end_mark=True)
    low, high = (line for line in axis.lines if line.get_gid() == swings.BAND)
    assert set(low.get_ydata()[-20:]) == {0.1} and set(high.get_ydata()[-20:]) == {0.6} and (band.low, band.high) == (0.1, 0.6)
    assert len(axis.lines[0].get_xdata()) <= 21 and len(axis.collections) == 1  # the line ends where the band begins
    assert any(line.get_gid() == style.FAILURE and line.get_xydata().tolist() == [[59, 0.1]] for line in axis.lines)
    _, calm = plt.subplots()
    assert swings.draw(calm, np.arange(20), CALM, ROW) == [] and not calm.collections and len(calm.lines[0].get_xdata()) == 20
    plt.close("all")


def test_swings_before_the_last_step_are_lines():
    _, axis = plt.subplots()
    assert swings.draw(axis, np.arange(60), np.concatenate([CYCLE, CALM]), ROW, since=40) == [] and not axis.collections
    [band] = swings.draw(axis, np.arange(100), np.concatenate([CYCLE, CALM, CYCLE]), ROW, since=40)
    assert abs(band.start - 59) <= swings.WINDOW // 2
    plt.close("all")


def test_the_cycle_of_a_run_is_a_band_that_the_caption_names(tmp_path):
    write_set(tmp_path / "runs")
    write_cycle(tmp_path / "runs" / "quadratic", change=0.8)
    said = " ".join(kappa_cycle.figure(load(tmp_path / "runs"), "strip", tmp_path)[3].read_text().split())
    assert "(gap, contacts, quadratic from iteration 1 on, 0.1 to 0.6 at the end)" in said


def test_numbers_of_a_caption_tell_the_ends_apart():
    assert "from 0.11 s on, 612 to 613 at the end" in swings.sentence([("cond", swings.Band("quadratic", 0.11, 612.2, 612.9))], "{:g} s")


@pytest.mark.usefixtures("unpainted")
def test_other_runs_stand_in_their_step_of_the_same_time(tmp_path):
    """The cycle is in step 3, 0.03 to 0.04 s; a run with other steps is there in its step 2."""
    write_set(tmp_path / "runs")
    write_cycle(tmp_path / "runs" / "quadratic", change=0.8)
    for name, times in (("quadratic", (0.01, 0.02, 0.03, 0.04)), ("log", (0.03, 0.034, 0.039))):
        path = tmp_path / "runs" / name / "run.json"
        record = json.loads(path.read_text())
        record["steps"] = [record["steps"][-1] | {"step": k, "t_s": t} for k, t in enumerate(times)]
        path.write_text(json.dumps(record))
    paths = kappa_cycle.figure(load(tmp_path / "runs"), "strip", tmp_path)
    table, said = pd.read_csv(paths[2]), " ".join(paths[3].read_text().split())
    assert dict(table.groupby("series")["step"].first()) == {"log": 2, "quadratic": 3}  # the others end before
    assert "the time step of 0.03 to 0.04 s" in said and "Steps of other lengths, in the middle of that time: log 0.005 s." in said
