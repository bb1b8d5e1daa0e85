"""Paths over stiffness, on numbers that are known."""

import math

import numpy as np
import pytest

from barrierbench_analysis.studies.kit.front import Point, log_ratio, reached, segments, shared, value_at


def power(scales, factor=1.0, exponent=1.0):
    """gap = 0.1 scale^0.4, value = factor gap^exponent: a straight line of logarithms."""
    return [Point(s, 0.1 * s**0.4, factor * (0.1 * s**0.4) ** exponent) for s in scales]


DECADES = [0.01, 0.1, 1, 10, 100]


def test_between_two_runs_logarithms_are_linear():
    path = power(DECADES, 3.0, -0.7)
    assert value_at(path, 0.1) == pytest.approx(3 * 0.1**-0.7)
    assert value_at(path, 0.2) == pytest.approx(3 * 0.2**-0.7)
    assert value_at(list(reversed(path)), 0.2) == value_at(path, 0.2)  # the order of the runs is none of the path's


def test_beyond_the_path_there_is_nothing():
    path = power(DECADES)
    low, high = reached(path)
    assert (low, high) == (pytest.approx(0.1 * 0.01**0.4), pytest.approx(0.1 * 100**0.4))
    assert value_at(path, 0.99 * low) is None and value_at(path, 1.01 * high) is None
    assert value_at(path, low) is not None and value_at(path, high) is not None


def test_nothing_is_interpolated_across_a_failed_run():
    path = power(DECADES)
    path[2] = Point(1, None, None)
    assert len(segments(path)) == 2
    assert value_at(path, 0.09) is None and value_at(path, 0.12) is None
    assert value_at(path, 0.1 * 0.03**0.4) is not None
    without_metric = power(DECADES)
    without_metric[2] = Point(1, 0.1, None)
    assert value_at(without_metric, 0.12) is None


def test_a_path_that_turns_back_has_the_mean_of_its_passes():
    path = [Point(1, 0.1, 10.0), Point(2, 0.2, 20.0), Point(3, 0.1, 1000.0)]
    assert value_at(path, 0.1) == pytest.approx(100.0)
    assert value_at(path, 0.2) == pytest.approx(20.0)


def test_ratio_over_what_both_reach():
    a, b = power(DECADES, 6.0, 0.5), power([0.1, 1, 10, 100, 1000], 2.0, 0.5)
    gaps = shared(a, b)
    assert len(gaps) == 9 and gaps[0] == pytest.approx(0.1 * 0.1**0.4) and gaps[-1] == pytest.approx(0.1 * 100**0.4)
    assert np.allclose(np.diff(np.log(gaps)), np.log(gaps[1] / gaps[0]))
    assert math.exp(log_ratio(a, b)) == pytest.approx(3.0) and math.exp(log_ratio(b, a)) == pytest.approx(1 / 3)


def test_paths_that_share_too_little_are_not_compared():
    far = [Point(1, 0.001, 1.0), Point(10, 0.002, 1.0)]
    assert log_ratio(power(DECADES), far) is None
    touching = [Point(1, 0.1, 1.0), Point(10, 0.2, 1.0)], [Point(1, 0.19, 1.0), Point(10, 0.4, 1.0)]
    assert len(shared(*touching)) == 0
    assert log_ratio(power(DECADES), [Point(1, 0.1, 1.0)]) is None  # one run is no path
    assert reached([Point(1, 0.1, 1.0)]) is None and value_at([], 0.1) is None


def test_paths_share_what_both_cover_and_not_what_lies_between_their_ends():
    """Both reach from 0.01 to 1, yet a failed run leaves b two short ends, of which a covers one."""
    a = [Point(1, 0.01, 1.0), Point(2, 0.0125, 1.0), Point(3, None, None), Point(4, 0.9, 1.0), Point(5, 1.0, 1.0)]
    b = [Point(1, 0.01, 2.0), Point(2, 0.012, 2.0), Point(3, None, None), Point(4, 0.1, 2.0), Point(5, 0.8, 2.0), Point(6, None, None), Point(7, 2.0, 2.0), Point(8, 3.0, 2.0)]
    assert len(shared(a, b)) == 9 and log_ratio(a, b) is None and log_ratio(b, a) is None
    wider = [Point(1, 0.01, 1.0), Point(2, 0.1, 1.0), *a[2:]]
    assert log_ratio(wider, [Point(1, 0.01, 2.0), Point(2, 1.0, 2.0)]) == pytest.approx(math.log(0.5))


def test_numbers_that_are_none():
    with pytest.raises(ValueError, match="two runs with scale 1"):
        segments([Point(1, 0.1, 1.0), Point(1, 0.2, 1.0)])
    with pytest.raises(ValueError, match="scale 2: gap nan"):
        segments([Point(1, 0.1, 1.0), Point(2, math.nan, 1.0)])
    with pytest.raises(ValueError, match="value inf"):
        segments([Point(1, 0.1, math.inf)])
