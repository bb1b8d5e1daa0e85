"""Sign-flip test of the mean over scenes (Fisher 1935, The Design of Experiments, section 21): if a level
does nothing, the value of a scene is as likely above zero as below by as much, so each pattern of signs is as
likely. It assumes neither a distribution nor one spread for all scenes, and tests the mean that is reported.
"""

from functools import lru_cache

import numpy as np

EXACT = 18  # scenes up to which every pattern is counted
DRAWN = 2**16  # patterns for more scenes
SEED = 20261126
NOTHING = 1e-9  # what a least squares of equal numbers leaves


@lru_cache(maxsize=None)
def _patterns(n: int) -> np.ndarray:
    """Signs of n values, a pattern a row, the first row all +. The first sign is + where all are counted:
    turning every sign keeps the absolute mean.
    """
    if n > EXACT:
        signs = np.random.default_rng(SEED).choice([-1.0, 1.0], (DRAWN, n))
        signs[0] = 1.0
        return signs
    bits = (np.arange(2 ** (n - 1))[:, None] >> np.arange(n)) & 1
    return np.hstack([np.ones((len(bits), 1)), 1.0 - 2.0 * bits[:, : n - 1]])


def sign_flip(values: np.ndarray) -> float:
    """Two-sided p: the share of patterns whose mean is at least as far from zero as that of the values. 1
    where all values are nothing; at least 2^(1 - n) for n values. Exact up to EXACT values.
    """
    values = np.where(np.abs(values) < NOTHING, 0.0, values)
    sums = np.abs(_patterns(len(values)) @ values)
    return float(np.mean(sums >= sums[0] - NOTHING * np.abs(values).sum()))
