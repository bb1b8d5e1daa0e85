"""Condition numbers of sparse symmetric matrices, by the estimators of the pass `diagnose`."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from . import _core

ASYMMETRY = 1e-9  # of the largest entry: what may be rounding of whoever made the matrix


class Condition(NamedTuple):
    """An estimate with its status; numbers are nan where they are unknown."""

    cond: float
    lambda_min: float
    lambda_max: float
    status: str  # ok, lower_bound, singular, not_pd, not_converged
    method: str
    residual: float  # largest |A v - lambda v|/|A| of the two pairs


def condition_number(matrix: Any, scaling: str = "none", tier: int = 2, seed: int = 1) -> Condition:
    """lambda_max/lambda_min of a symmetric matrix [n, n], given whole or by its lower triangle.

    matrix: scipy.sparse or dense. scaling: none, jacobi, block_jacobi (blocks of three rows). tier: 1 inverse power
    and Lanczos, 2 Spectra around a Cholesky factor, 3 dense (n <= 3000), 4 our Lanczos around the factor.
    Failure is a status. Errors: ConfigError for what is not square, not symmetric or not finite. Needs scipy.

    >>> import numpy as np
    >>> found = condition_number(np.diag([1.0, 2.0, 8.0]), tier=3)
    >>> found.cond, found.status
    (8.0, 'ok')
    """
    from scipy import sparse

    whole = sparse.csc_matrix(matrix, dtype=float)
    if whole.shape[0] != whole.shape[1]:
        raise _core.ConfigError(f"matrix: found shape {whole.shape}; allowed: a square matrix")
    upper, off = sparse.triu(whole, 1), whole - whole.T
    if upper.nnz and abs(off).max() > ASYMMETRY * abs(whole).max():
        raise _core.ConfigError(
            f"matrix: found entries that differ by {abs(off).max():.3g} from those across the diagonal;"
            " allowed: a symmetric matrix, or its lower triangle"
        )
    lower = sparse.csc_matrix(sparse.tril(whole))
    starts, rows = lower.indptr.astype(np.int32), lower.indices.astype(np.int32)
    return Condition(*_core.condition(starts, rows, lower.data, scaling, tier, seed))
