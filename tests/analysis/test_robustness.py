"""Shares, expected cost, frontiers and data profiles, on trials that are known."""

import math

import pytest

from barrierbench_analysis.tables.robustness import Frontier, Trial, expected_cost, frontier, profile, success


def trial(value, ok=True, cost=10.0, seed=1):
    return Trial(f"a {seed}", value, ok, cost)


def test_a_share_has_the_interval_of_wilson():
    share = success([trial(1, ok=k < 8, seed=k) for k in range(10)])
    assert (share.ok, share.n) == (8, 10)
    assert (share.low, share.high) == (pytest.approx(0.490, abs=1e-3), pytest.approx(0.943, abs=1e-3))  # Wilson 1927
    with pytest.raises(ValueError, match="no trials"):
        success([])


def test_failed_runs_are_paid_for():
    found = [trial(1, True, 10), trial(1, False, 100, 2), trial(1, True, 30, 3)]
    assert expected_cost(found) == 70
    assert expected_cost([trial(1, False, 100)]) is None
    with pytest.raises(ValueError, match="no trials"):
        expected_cost([])


def test_the_frontier_is_where_the_first_seed_fails():
    found = [trial(v, seed=k) for v in (0.01, 0.1, 1, 10, 100) for k in (1, 2)]
    assert frontier(found, 1) == Frontier(0.01, 100, None, None)
    found[7] = trial(10, False, seed=2)  # what gets through beyond does not count
    assert frontier(found, 1) == Frontier(0.01, 1, None, 10)
    found[3] = trial(0.1, False, seed=2)
    assert frontier(found, 1) == Frontier(1, 1, 0.1, 10)
    found[4] = trial(1, False)
    assert frontier(found, 1) == Frontier(None, None, 1, 1)
    with pytest.raises(ValueError, match="no trial at 2; tested: 0.01, 0.1, 1"):
        frontier(found, 2)


def test_a_profile_counts_every_problem():
    found = [trial(1, True, 10, 1), trial(1, True, 10, 2), trial(1, True, 40, 3), trial(1, False, 5, 4)]
    assert profile(found) == [(10, 0.5), (40, 0.75)]
    assert profile([trial(1, False)]) == []
    with pytest.raises(ValueError, match="occurs twice"):
        profile([trial(1), trial(1)])


@pytest.mark.parametrize("bad", [math.nan, math.inf, -1.0])
def test_a_cost_that_is_none(bad):
    with pytest.raises(ValueError, match="a finite cost >= 0"):
        expected_cost([trial(1), trial(1, True, bad, 2)])
