"""The sign-flip test: against counting by hand, its least p, and more scenes than are counted one by one."""

from itertools import product

import numpy as np
import pytest

from barrierbench_analysis.studies.rules.ablation.flips import EXACT, sign_flip


def by_hand(values) -> float:
    sums = [abs(sum(s * v for s, v in zip(signs, values, strict=True))) for signs in product((1, -1), repeat=len(values))]
    return sum(s >= abs(sum(values)) - 1e-12 for s in sums) / len(sums)


@pytest.mark.parametrize("values", [[1.0, 2.0, 4.0], [1.0, -2.0, 4.0, 0.5, 0.3], [0.2, 0.1, -0.1, 0.4, 0.3, 0.0, 0.7], [-3.0, -1.0, 2.0, -5.0]])
def test_it_is_the_share_of_all_patterns(values):
    assert sign_flip(np.array(values)) == pytest.approx(by_hand(values))
    assert sign_flip(-np.array(values)) == sign_flip(np.array(values)) == sign_flip(1000 * np.array(values))


def test_its_least_p_is_that_of_one_sign():
    assert [sign_flip(np.arange(1.0, n + 1)) for n in (5, 10, 16)] == [2.0**-4, 2.0**-9, 2.0**-15]


def test_nothing_is_not_decided_by_rounding():
    assert sign_flip(np.zeros(12)) == 1.0 and sign_flip(np.full(12, 1e-15)) == 1.0
    assert sign_flip(np.array([1e-15] * 11 + [0.3])) == 1.0


def test_more_scenes_than_are_counted_are_drawn():
    """Beside Student's p of as many values; the draw is the same each time."""
    from scipy.stats import ttest_1samp

    values = np.random.default_rng(4).normal(0.35, 1.0, EXACT + 12)
    p = sign_flip(values)
    assert p == sign_flip(values) and p == pytest.approx(ttest_1samp(values, 0).pvalue, rel=0.1)
    assert 0 < sign_flip(np.ones(EXACT + 12)) < 1e-4
