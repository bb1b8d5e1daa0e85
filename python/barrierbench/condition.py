"""Condition numbers of sparse symmetric matrices, by the estimators of the pass `diagnose`."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from . import _core
from .given import finite_reals, reals

MOST = 2**31 - 1  # rows and entries
ASYMMETRY = 1e-9  # of the largest entry: what may be rounding of whoever made the matrix


def _require_indices(matrix: Any) -> None:
    """Errors: ConfigError for indices beyond the shape of a scipy matrix, which scipy itself does not look at."""
    try:
        if hasattr(matrix, "check_format"):
            matrix.check_format(full_check=True)
        elif matrix.format == "coo":
            for which, n in zip((matrix.row, matrix.col), matrix.shape):
                if which.size and (which.min() < 0 or which.max() >= n):
                    raise ValueError(f"an index out of the range 0 to {n - 1}")
    except ValueError as error:
        raise _core.ConfigError(f"matrix: found {error}; allowed: indices within its shape") from None
    if max(*matrix.shape, matrix.nnz) > MOST:
        raise _core.ConfigError(
            f"matrix: found shape {matrix.shape} with {matrix.nnz} entries; allowed: at most {MOST}"
        )


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
    Failure is a status. Errors: ConfigError for what is not square, not symmetric or not finite, and for indices
    beyond its shape. Needs scipy.

    >>> import numpy as np
    >>> found = condition_number(np.diag([1.0, 2.0, 8.0]), tier=3)
    >>> found.cond, found.status
    (8.0, 'ok')
    """
    from scipy import sparse

    if sparse.issparse(matrix):
        _require_indices(matrix)
    given = sparse.csc_matrix(matrix) if sparse.issparse(matrix) else sparse.csc_matrix(reals(matrix, "matrix"))
    whole = sparse.csc_matrix((finite_reals(given.data, "matrix.data"), given.indices, given.indptr), shape=given.shape)
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
