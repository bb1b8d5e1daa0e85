"""The errors on data whose error is known, and what they refuse."""

import numpy as np
import pytest

from barrierbench_analysis.tables.accuracy import errors


def test_e_traj_is_the_largest_distance_over_the_size():
    x = np.zeros((3, 4, 3))
    moved = x.copy()
    moved[2, 1] = [3.0, 0.0, 4.0]
    moved[1, 0] = [0.0, 2.0, 0.0]
    assert errors.e_traj(moved, x, 10.0) == pytest.approx(0.5) and errors.e_traj(x, x, 10.0) == 0


def test_e_com_is_that_of_the_centres():
    com = np.zeros((2, 2, 3))
    other = com.copy()
    other[1, 1, 2] = -0.3
    assert errors.e_com(com, other, 2.0) == pytest.approx(0.15)


def test_e_gap_is_in_units_of_d_hat():
    assert errors.e_gap([1e-3, 2.5e-3], [1e-3, 2e-3], 1e-2) == pytest.approx(0.05)


def test_e_offset_looks_along_gravity_only_and_counts_below_as_well():
    com, up = np.array([[7.0, 0.0, 0.12], [0.0, 0.0, 0.17]]), np.array([0.0, 0.0, 1.0])
    assert errors.e_offset(com, np.array([[0.0, 0.0, 0.1], [0.0, 0.0, 0.2]]), up) == pytest.approx(0.03)


def test_e_momentum_is_relative_to_the_start():
    assert errors.e_momentum(np.array([0.0, 0.0, 2.5]), np.array([0.0, 0.0, 2.0])) == pytest.approx(0.25)
    assert errors.e_momentum(np.array([0.3, 0.0, 0.4]), np.array([0.0, 0.0, 0.4])) == pytest.approx(0.75)
    with pytest.raises(ValueError, match="no momentum"):
        errors.e_momentum(np.ones(3), np.zeros(3))


def test_e_energy_has_no_sign():
    assert errors.e_energy(1.5, 2.0) == errors.e_energy(2.5, 2.0) == pytest.approx(0.25)
    with pytest.raises(ValueError, match="positive"):
        errors.e_energy(1.0, 0.0)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_no_number_is_said(bad):
    x = np.zeros((1, 1, 3))
    with pytest.raises(errors.NotFinite, match="e_traj"):
        errors.e_traj(np.full((1, 1, 3), bad), x, 1.0)
    with pytest.raises(errors.NotFinite, match="e_gap"):
        errors.e_gap([bad], [0.0], 1.0)


def test_unlike_or_empty_positions_are_refused():
    with pytest.raises(ValueError, match="reference"):
        errors.e_traj(np.zeros((2, 3, 3)), np.zeros((2, 4, 3)), 1.0)
    with pytest.raises(ValueError):
        errors.e_traj(np.zeros((0, 3, 3)), np.zeros((0, 3, 3)), 1.0)


def test_every_error_says_what_it_is():
    assert set(errors.NAMES) == {name for name in dir(errors) if name.startswith("e_")}
