"""Matrix Market files of another program: their condition numbers, raw and scaled by block Jacobi, and how
many iterations of PCG they ask for.
"""

import datetime
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.linalg
import scipy.sparse as sparse
import scipy.sparse.linalg as sparse_linalg

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.matrix_market import read_matrix

from . import baseline, judge
from .baseline import Baseline
from .finding import Finding, exact
from .metrics import COND, LOWER_BETTER, PCG, Metric

LARGEST_DENSE = 1500  # rows up to which all eigenvalues are computed, half a second
LARGEST_COND = 1e14
PCG_TOLERANCE, PCG_CAP = 1e-6, 20000


def block_jacobi(matrix: sparse.csc_matrix, size: int = 3) -> sparse.csc_matrix:
    """L^-1 A L^-T with the Cholesky factors of the blocks on the diagonal; the last one is smaller where the
    rows do not divide. Raises LinAlgError when a block is not positive definite.
    """
    starts = range(0, matrix.shape[0], size)
    factors = [np.linalg.cholesky(matrix[k : k + size, k : k + size].toarray()) for k in starts]
    solve = scipy.linalg.solve_triangular
    inverse = sparse.block_diag([solve(f, np.eye(len(f)), lower=True) for f in factors], format="csc")
    return sparse.csc_matrix(inverse @ matrix @ inverse.T)


def log10_cond(matrix: sparse.csc_matrix) -> float | None:
    """At most 14; None when the matrix is not positive definite."""
    if matrix.shape[0] <= LARGEST_DENSE:
        values = np.linalg.eigvalsh(matrix.toarray())
        low, high = float(values[0]), float(values[-1])
    else:
        mode = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
        try:
            factor = sparse_linalg.splu(matrix, **mode)
        except RuntimeError:  # exactly singular
            return None
        if not (np.array_equal(factor.perm_r, factor.perm_c) and (factor.U.diagonal() > 0).all()):
            return None  # Sylvester: as many negative pivots as eigenvalues
        inverse = sparse_linalg.LinearOperator(matrix.shape, factor.solve)
        start = np.random.default_rng(1).standard_normal(matrix.shape[0])
        how = {"k": 1, "which": "LA", "tol": 1e-4, "v0": start, "return_eigenvectors": False}
        high, of_inverse = (float(sparse_linalg.eigsh(of, **how)[0]) for of in (matrix, inverse))
        low = 1 / of_inverse
    if low <= 0 and -low > 1e-14 * high:
        return None
    return float(np.log10(min(LARGEST_COND, high / low))) if low > 0 else 14.0


def _log10_cond_of(path: Path, matrix: sparse.csc_matrix) -> float | None:
    try:
        return log10_cond(matrix)
    except sparse_linalg.ArpackNoConvergence:
        raise UserError(f"{path}: the eigenvalues of {matrix.shape[0]} rows did not converge") from None


def pcg_iterations(matrix: sparse.csc_matrix) -> int | None:
    """Of conjugate gradients to a residual of 1e-6 on one fixed right-hand side; None at the cap."""
    b, steps = np.random.default_rng(1).standard_normal(matrix.shape[0]), []
    _, info = sparse_linalg.cg(
        matrix, b, rtol=PCG_TOLERANCE, atol=0.0, maxiter=PCG_CAP, callback=steps.append
    )
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


def names(paths: list[Path]) -> list[str]:
    """Of files by their place below the folder that holds them all: a matrix is compared with the one of its
    own name. Raises UserError.
    """
    whole = [path.resolve() for path in paths]
    top = Path(os.path.commonpath([path.parent for path in whole]))
    found = [path.relative_to(top).as_posix() for path in whole]
    if twice := sorted({name for name in found if found.count(name) > 1}):
        raise UserError(f"{', '.join(twice)}: given twice")
    return found


NUMBERS = (
    ("log10_cond raw", "log10", COND, "raw"),
    ("log10_cond block_jacobi", "log10", COND, "scaled"),
    ("pcg_iterations block_jacobi", "1", PCG, "pcg"),
)  # metric, unit, tolerance, attribute of a Spectrum


def measure(spectra: dict[str, Spectrum]) -> dict[Metric, float]:
    """Of each matrix by its name, and medians and largest values over all of them."""
    out = {}
    for name, unit, tolerance, attribute in NUMBERS:
        found = {matrix: getattr(s, attribute) for matrix, s in spectra.items()}
        values = {matrix: float(value) for matrix, value in found.items() if value is not None}
        if every := list(values.values()):
            values = {"median": float(np.median(every)), "max": max(every), **values}
        for which, value in values.items():
            out[Metric(f"{name} {which}", "III", unit, LOWER_BETTER, tolerance)] = value
    return out


def _of_matrix(metric: str) -> str | None:
    """The name of the matrix that a metric is of; None for the medians and largest values."""
    which = next((metric[len(name) + 1 :] for name, *_ in NUMBERS if metric.startswith(name + " ")), "median")
    return None if which in ("median", "max") else which


def _rows(spectra: dict[str, Spectrum]) -> dict:
    return {f"/rows/{name}": s.rows for name, s in spectra.items()}


def _same_matrices(kept: Baseline, spectra: dict[str, Spectrum], path: Path) -> None:
    """Raises UserError when a matrix has another size than in the baseline, or when they have none in
    common."""
    rows = _rows(spectra)
    both = [(place, value, rows[place]) for place, value in kept.scene.items() if place in rows]
    unlike = [f"{place}: {value} and {now}" for place, value, now in both if value != now]
    if not both:
        unlike = [f"{', '.join(kept.scene) or 'no names'} and {', '.join(rows)}"]
    if unlike:
        raise UserError("\n  ".join([f"{path}: a baseline of other matrices:", *unlike]))


def _lonely(case: str, old: set[str], new: set[str]) -> list[Finding]:
    """A line for every matrix that only one side has, instead of one for each of its numbers."""
    _, unknown = judge.not_in_the_baseline("bench gate accept --matrix")
    notes = dict.fromkeys(sorted(old - new), "missing: the baseline has it")
    notes |= dict.fromkeys(sorted(new - old), unknown)
    return [
        Finding(case, "III", f"matrix {name}", "FAIL", judged=0, note=note) for name, note in notes.items()
    ]


def _invariants(case: str, spectra: list[Spectrum]) -> list[Finding]:
    bad = [s for s in spectra if s.raw is None or s.scaled is None]
    stuck = [s for s in spectra if s not in bad and s.pcg is None]
    n = len(spectra)
    of_bad = f"{bad[0].path}" if bad else f"of {n}"
    of_stuck = f"{stuck[0].path}: more than {PCG_CAP}" if stuck else f"of {n}"
    return [
        exact(case, "I", "positive definite", len(bad), n, of_bad),
        exact(case, "I", "pcg converges", len(stuck), n, of_stuck),
    ]


def propose(paths: list[Path], case: str) -> Baseline:
    """Raises UserError, also for a matrix that is not positive definite: that is never accepted."""
    spectra = dict(zip(names(paths), map(spectrum, paths)))
    if red := [f for f in _invariants(case, list(spectra.values())) if f.verdict == "FAIL"]:
        of = f"of {len(spectra)} matrices are not"
        raise UserError("\n".join(f"{f.metric}: {f.value} {of}, {f.note}: makes no baseline" for f in red))
    kept, at = judge.around(measure(spectra)), {"date": datetime.date.today().isoformat(), "runs": 1}
    return Baseline(case, "matrix", "", at, kept, scene=_rows(spectra))


def judge_matrices(paths: list[Path], path: Path) -> list[Finding]:
    """Against a baseline of kind matrix. Raises UserError."""
    kept = baseline.read(path, kind="matrix")
    spectra = dict(zip(names(paths), map(spectrum, paths)))
    _same_matrices(kept, spectra, path)
    old = {matrix for name in kept.metrics if (matrix := _of_matrix(name))}
    judged = {None, *(old & spectra.keys())}
    of_common = {name: k for name, k in kept.metrics.items() if _of_matrix(name) in judged}
    values = {metric: v for metric, v in measure(spectra).items() if _of_matrix(metric.name) in judged}
    lines = _invariants(kept.case, list(spectra.values())) + _lonely(kept.case, old, set(spectra))
    return lines + judge.numbers(kept.case, of_common, values, False)
