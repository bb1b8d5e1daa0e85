"""A panel that says nothing of its own is left out, and the caption says which and why."""

import numpy as np
import pandas as pd
import pytest

from barrierbench_analysis.figures.plots import condition
from barrierbench_analysis.tables.records import load
from barrierbench_analysis.figures.panels import Panel, choose, constant, is_flat
from synthetic import write_set

WAVE = pd.Series(np.geomspace(1, 1000, 40))


def test_a_flat_line_and_a_repeated_panel_are_left_out_and_named():
    kept, said = choose([Panel("a", WAVE), Panel("b", 7 * WAVE), Panel("c", WAVE**2), Panel("d", 0 * WAVE + 296), Panel("e", WAVE * np.nan)])
    assert kept == ["a", "c"]
    assert said.startswith("Left out: b: a times 7; d: one flat line at 296 (296 to 296); e: not measured (")


def test_nothing_is_said_where_nothing_is_left_out():
    assert choose([Panel("a", WAVE), Panel("b", WAVE[::-1].reset_index(drop=True))]) == (["a", "b"], "")


def test_the_first_panel_stays_whatever_it_is():
    assert choose([Panel("a", 0 * WAVE + 1)])[0] == ["a"]


@pytest.mark.parametrize(("factor", "repeats"), [(1.05, True), (3.0, False)])
def test_what_is_not_seen_at_the_height_of_the_panel_is_no_difference(factor, repeats):
    other = WAVE.copy()
    other[::2] *= factor
    assert (constant(Panel("a", other), Panel("b", WAVE)) is not None) == repeats


def test_one_point_of_forty_does_not_make_a_panel():
    other = 2 * WAVE
    other[7] *= 100
    assert constant(Panel("a", other), Panel("b", WAVE)) == pytest.approx(2)
    flat = 0 * WAVE + 1
    flat[7] = 2
    assert is_flat(Panel("a", flat)) and not is_flat(Panel("a", WAVE))


def test_other_points_and_other_errors_are_no_repetition():
    assert constant(Panel("a", WAVE.set_axis(WAVE.index + 100)), Panel("b", WAVE)) is None
    errors = 1 / WAVE
    assert constant(Panel("a", WAVE, errors), Panel("b", WAVE, errors)) == pytest.approx(1)
    assert constant(Panel("a", WAVE, errors), Panel("b", WAVE, errors[::-1].set_axis(errors.index))) is None


@pytest.mark.usefixtures("unpainted")
def test_eigenvalues_that_repeat_the_condition_number_have_no_figure(tmp_path):
    """In the made records the smallest eigenvalue is 2 and the largest is twice the condition number."""
    write_set(tmp_path / "runs")
    paths = condition.figure(load(tmp_path / "runs"), "strip", tmp_path)
    assert {path.stem for path in paths} == {"condition_strip"}
    said = " ".join(paths[3].read_text().split())
    assert "largest eigenvalue, raw: condition number, raw times 2" in said and "smallest eigenvalue, raw: one flat line at 2 (2 to 2)" in said
    table = pd.read_csv(paths[2])
    assert (table["lambda_max"] == 2 * table["cond"]).all()  # the numbers are kept
