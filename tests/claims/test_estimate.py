"""Scene values, intervals, signs, and how much alike starts are."""

import math

import numpy as np
import pytest

from barrierbench_analysis.tables.estimate import intraclass, of_scenes, sign_test, student, wilson


def test_a_scene_is_the_mean_of_its_levels_whatever_starts_they_have():
    a, b = of_scenes({"a": {"1": [1.0], "2": [3.0, 5.0, 4.0]}, "b": {"1": [7.0]}})
    assert (a.value, a.low, a.high, a.levels, a.n) == (2.5, 1.0, 4.0, 2, 4) and (b.value, b.n) == (7.0, 1)


def test_students_interval():
    low, high = student([1.0, 2.0, 3.0])  # t of 2 degrees of freedom: 4.3027
    assert (low, high) == (pytest.approx(2 - 4.302653 / math.sqrt(3)), pytest.approx(2 + 4.302653 / math.sqrt(3)))
    assert student(np.array([[1.0, 2.0, 3.0], [0.0, 0.0, 0.0]]))[1].shape == (2,)
    with pytest.raises(ValueError, match="1 scenes: an interval over scenes needs two"):
        student([1.0])


def test_more_levels_and_starts_make_no_narrower_interval():
    few = [s.value for s in of_scenes({s: {"1": [v]} for s, v in zip("abc", (1.0, 2.0, 3.0))})]
    many = [s.value for s in of_scenes({s: {str(k): [v] * 50 for k in range(20)} for s, v in zip("abc", (1.0, 2.0, 3.0))})]
    assert student(few) == pytest.approx(student(many))


def test_intraclass_correlation():
    assert intraclass([[1.0, 1.0], [2.0, 2.0], [5.0, 5.0]]) == pytest.approx(1)
    assert intraclass([[9.0, 7.0], [6.0, 8.0]]) == pytest.approx((1 - 2) / (1 + 2))  # MSB = 1, MSW = 2
    assert intraclass([[1.0], [2.0]]) is None and intraclass([[1.0, 1.0], [1.0, 1.0]]) is None and intraclass([[1.0, 2.0]]) is None
    random = np.random.default_rng(1)
    groups = [list(random.normal() + 0.5 * random.normal(size=5)) for _ in range(4000)]
    assert intraclass(groups) == pytest.approx(0.8, abs=0.02)
    assert intraclass([g[: 2 + k % 3] for k, g in enumerate(groups)]) == pytest.approx(0.8, abs=0.02)  # places of other sizes


def test_signs_and_shares():
    assert sign_test(6, 0) == pytest.approx(2 / 64) and sign_test(0, 0) == 1
    assert wilson(10, 10)[1] == pytest.approx(1) and wilson(10, 10)[0] == pytest.approx(0.722, abs=1e-3)
