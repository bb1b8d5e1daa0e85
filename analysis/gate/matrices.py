"""Matrix Market files of another program: their condition numbers, raw and scaled by block Jacobi, and how many iterations of PCG they ask for."""

from __future__ import annotations

import datetime
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.io
import scipy.linalg
import scipy.sparse as sparse
import scipy.sparse.linalg as sparse_linalg

from . import baseline, judge
from .baseline import Baseline, keep
from .envelope import calibrate
from .finding import Finding
from .metrics import COND, LOWER_BETTER, PCG, TWO_SIDED, Metric

LARGEST_DENSE = 1500  # rows up to which all eigenvalues are computed, half a second
LARGEST_COND = 1e14
SYMMETRY = 1e-10  # largest |A - A^T| over the largest entry: what summation in another order leaves
PCG_TOLERANCE, PCG_CAP = 1e-6, 20000


class MatrixError(ValueError):
    """A file that holds no matrix that has a condition number."""


def read_matrix(path: Path) -> sparse.csc_matrix:
    """Raises MatrixError with file and reason: no Matrix Market, not real, not square, not symmetric, a number that is none, empty."""
    if not path.is_file():
        raise MatrixError(f"{path}: no such file")
    try:
        matrix = sparse.csc_matrix(scipy.io.mmread(path))
    except (ValueError, TypeError, OverflowError) as error:
        raise MatrixError(f"{path}: not Matrix Market: {error}") from None
    if np.iscomplexobj(matrix.data):
        raise MatrixError(f"{path}: complex; a real matrix is needed")
    matrix = matrix.astype(float)
    rows, columns = matrix.shape
    if rows != columns:
        raise MatrixError(f"{path}: {rows} x {columns}; a square matrix is needed")
    if rows == 0 or matrix.nnz == 0:
        raise MatrixError(f"{path}: empty")
    if not np.isfinite(matrix.data).all():
        entry = matrix.tocoo()
        k = int(np.flatnonzero(~np.isfinite(entry.data))[0])
        raise MatrixError(f"{path}: entry ({entry.row[k] + 1}, {entry.col[k] + 1}): {entry.data[k]}; finite numbers are needed")
    departure = abs(matrix - matrix.T).max() / abs(matrix).max()
    if departure > SYMMETRY:
        raise MatrixError(f"{path}: not symmetric: |A - A^T| is {departure:.2g} of the largest entry, at most {SYMMETRY:g} is rounding")
    return sparse.csc_matrix(0.5 * (matrix + matrix.T))


def block_jacobi(matrix: sparse.csc_matrix, size: int = 3) -> sparse.csc_matrix:
    """L^-1 A L^-T with the Cholesky factors of the blocks on the diagonal; the last one is smaller where the rows do not divide.
    Raises LinAlgError when a block is not positive definite."""
    n = matrix.shape[0]
    inverses = [scipy.linalg.solve_triangular(np.linalg.cholesky(matrix[k : k + size, k : k + size].toarray()),
                                              np.eye(min(size, n - k)), lower=True) for k in range(0, n, size)]
    inverse = sparse.block_diag(inverses, format="csc")
    return sparse.csc_matrix(inverse @ matrix @ inverse.T)


def log10_cond(matrix: sparse.csc_matrix) -> float | None:
    """At most 14; None when the matrix is not positive definite."""
    if matrix.shape[0] <= LARGEST_DENSE:
        values = np.linalg.eigvalsh(matrix.toarray())
        low, high = float(values[0]), float(values[-1])
    else:
        try:
            factor = sparse_linalg.splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        except RuntimeError:  # exactly singular
            return None
        if not (np.array_equal(factor.perm_r, factor.perm_c) and (factor.U.diagonal() > 0).all()):
            return None  # Sylvester: as many negative pivots as eigenvalues
        inverse = sparse_linalg.LinearOperator(matrix.shape, factor.solve)
        start = np.random.default_rng(1).standard_normal(matrix.shape[0])
        high = float(sparse_linalg.eigsh(matrix, k=1, which="LA", tol=1e-4, v0=start, return_eigenvectors=False)[0])
        low = 1 / float(sparse_linalg.eigsh(inverse, k=1, which="LA", tol=1e-4, v0=start, return_eigenvectors=False)[0])
    if low <= 0 and -low > 1e-14 * high:
        return None
    return float(np.log10(min(LARGEST_COND, high / low))) if low > 0 else 14.0


def _log10_cond_of(path: Path, matrix: sparse.csc_matrix) -> float | None:
    try:
        return log10_cond(matrix)
    except sparse_linalg.ArpackNoConvergence:
        raise MatrixError(f"{path}: the eigenvalues of {matrix.shape[0]} rows did not converge") from None


def pcg_iterations(matrix: sparse.csc_matrix) -> int | None:
    """Of conjugate gradients to a residual of 1e-6 on one fixed right-hand side; None at the cap."""
    b, steps = np.random.default_rng(1).standard_normal(matrix.shape[0]), []
    _, info = sparse_linalg.cg(matrix, b, rtol=PCG_TOLERANCE, atol=0.0, maxiter=PCG_CAP, callback=steps.append)
    return len(steps) if info == 0 else None


@dataclass(frozen=True)
class Spectrum:
    path: Path
    rows: int
    raw: float | None
    scaled: float | None
    pcg: int | None


def spectrum(path: Path, block: int = 3) -> Spectrum:
    matrix = read_matrix(path)
    raw = _log10_cond_of(path, matrix)
    if raw is None:
        return Spectrum(path, matrix.shape[0], None, None, None)
    try:
        scaled = block_jacobi(matrix, block)
    except np.linalg.LinAlgError:
        return Spectrum(path, matrix.shape[0], raw, None, None)
    return Spectrum(path, matrix.shape[0], raw, _log10_cond_of(path, scaled), pcg_iterations(scaled))


def measure(spectra: list[Spectrum]) -> dict[Metric, float]:
    """Medians and largest values over the matrices."""
    out = {}
    for name, unit, direction, tolerance, values in (
            ("log10_cond raw", "log10", TWO_SIDED, COND, [s.raw for s in spectra if s.raw is not None]),
            ("log10_cond block_jacobi", "log10", TWO_SIDED, COND, [s.scaled for s in spectra if s.scaled is not None]),
            ("pcg_iterations block_jacobi", "1", LOWER_BETTER, PCG, [s.pcg for s in spectra if s.pcg is not None])):
        if values:
            out[Metric(f"{name} median", "III", unit, direction, tolerance)] = float(np.median(values))
            out[Metric(f"{name} max", "III", unit, direction, tolerance)] = float(max(values))
    return out


def _invariants(case: str, spectra: list[Spectrum]) -> list[Finding]:
    bad = [s for s in spectra if s.raw is None or s.scaled is None]
    stuck = [s for s in spectra if s not in bad and s.pcg is None]
    return [Finding(case, "I", "positive definite", "FAIL" if bad else "pass", len(bad), 0, unit="1", judged=len(spectra),
                    note=f"{bad[0].path}" if bad else f"of {len(spectra)}"),
            Finding(case, "I", "pcg converges", "FAIL" if stuck else "pass", len(stuck), 0, unit="1", judged=len(spectra),
                    note=f"{stuck[0].path}: more than {PCG_CAP}" if stuck else f"of {len(spectra)}")]


def _sizes(spectra: list[Spectrum]) -> dict:
    return {"/rows_min": min(s.rows for s in spectra), "/rows_max": max(s.rows for s in spectra)}


def propose(paths: list[Path], case: str) -> Baseline:
    """Raises MatrixError, also for a matrix that is not positive definite: that is never accepted."""
    spectra = [spectrum(path) for path in paths]
    if red := [f for f in _invariants(case, spectra) if f.verdict == "FAIL"]:
        raise MatrixError("\n".join(f"{f.metric}: {f.value} of {len(spectra)} matrices are not, {f.note}: makes no baseline" for f in red))
    kept = {metric.name: keep(metric, calibrate(metric, [value])) for metric, value in measure(spectra).items()}
    return Baseline(case, "matrix", "", {"date": datetime.date.today().isoformat(), "runs": 1}, kept, scene=_sizes(spectra))


def judge_matrices(paths: list[Path], path: Path) -> list[Finding]:
    """Against a baseline of kind matrix. Raises MatrixError, BaselineError."""
    kept = baseline.read(path, kind="matrix")
    spectra = [spectrum(file) for file in paths]
    sizes = _sizes(spectra)
    if unlike := [f"  {place}: {value} and {sizes.get(place)}" for place, value in kept.scene.items() if sizes.get(place) != value]:
        raise baseline.BaselineError("\n".join([f"{path}: a baseline of other matrices:", *unlike]))
    return _invariants(kept.case, spectra) + judge.numbers(kept.case, kept.metrics, measure(spectra), False)
