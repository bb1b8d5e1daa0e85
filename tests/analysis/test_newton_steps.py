"""Jumps of a residual curve are ringed and explained as far as the file goes."""

import json

import matplotlib.pyplot as plt
import pytest

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.plots import newton_steps


def data(**edit) -> dict:
    """exact_or_clamped jumps at iteration 4; blend does not."""
    jump = {"step": 11, "hessian": "exact_or_clamped", "status": "converged", "tolerance_m": 1e-6, "hessian_fallbacks": 1, "dx_inf_m": [1e-2, 1e-3, 1e-4, 5e-3, 1e-7]}
    calm = {"step": 11, "hessian": "blend", "status": "converged", "tolerance_m": 1e-6, "hessian_fallbacks": 0, "dx_inf_m": [1e-2, 1e-3, 9e-3, 1e-7]}
    return {"schema": newton_steps.SCHEMA, "config": {"scene": {"name": "drape"}, "formulation": {"shape": "log"}}, "trials": [jump | edit, calm]}


def caption(tmp_path, found: dict) -> str:
    path = tmp_path / "s.json"
    path.write_text(json.dumps(found))
    return " ".join(newton_steps.figure(newton_steps.read_steps(path), tmp_path / "s")[3].read_text().split())


def test_a_jump_is_ringed_where_it_is(tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr(style, "save", lambda fig, *_: figures.append(fig))
    newton_steps.figure(data(), tmp_path / "s")
    rings = [line for line in figures[0].axes[0].lines if line.get_gid() == newton_steps.RING]
    assert [line.get_xydata().tolist() for line in rings] == [[[4, 5e-3]], []]
    plt.close("all")


def test_the_caption_says_which_jump_it_is_and_why(tmp_path):
    said = caption(tmp_path, data())
    assert "exact_or_clamped, step 11, iteration 4 (1.0e-04 to 5.0e-03 m), failed attempts with the exact matrix in this step: 1" in said
    assert "has become positive definite again" in said and "does not name the matrix" in said
    assert (tmp_path / "s.csv").read_text().count("True") == 1


@pytest.mark.usefixtures("unpainted")
def test_a_jump_after_a_direction_below_the_tolerance_leaves_a_saddle(tmp_path):
    said = caption(tmp_path, data(dx_inf_m=[1e-2, 1e-7, 5e-3, 1e-7]))
    assert "the step goes on from a saddle" in said and "has become positive definite again" not in said


@pytest.mark.usefixtures("unpainted")
@pytest.mark.parametrize("edit", [{"dx_inf_m": [1e-2, 1e-3, 5e-3, 1e-7]}, {"hessian": "progressive", "dx_inf_m": [1e-2, 1e-3]}])
def test_without_a_jump_nothing_is_said(tmp_path, edit):
    assert "Rings" not in caption(tmp_path, data(**edit))


@pytest.mark.usefixtures("unpainted")
def test_choices_that_take_the_same_directions_are_named(tmp_path):
    found = data(dx_inf_m=[1e-2, 1e-3, 9e-3, 1e-7])
    assert "One line: exact_or_clamped, blend in step 11." in caption(tmp_path, found) and "One line" not in caption(tmp_path, data())
