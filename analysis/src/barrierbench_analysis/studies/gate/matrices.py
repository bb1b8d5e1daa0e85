"""Matrix Market files of another program: their condition numbers, raw and scaled by block Jacobi, and how
many iterations of PCG they ask for.
"""

from __future__ import annotations

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
from .baseline import Baseline, keep
from .envelope import calibrate
from .finding import Finding
from .metrics import COND, LOWER_BETTER, PCG, Metric

LARGEST_DENSE = 1500  # rows up to which all eigenvalues are computed, half a second
LARGEST_COND = 1e14
PCG_TOLERANCE, PCG_CAP = 1e-6, 20000


def block_jacobi(matrix: sparse.csc_matrix, size: int = 3) -> sparse.csc_matrix:
    """L^-1 A L^-T with the Cholesky factors of the blocks on the diagonal; the last one is smaller where the
    rows do not divide. Raises LinAlgError when a block is not positive definite.
    """
    n = matrix.shape[0]
    inverses = [
        scipy.linalg.solve_triangular(
            np.linalg.cholesky(matrix[k : k + size, k : k + size].toarray()),
            np.eye(min(size, n - k)),
            lower=True,
        )
        for k in range(0, n, size)
    ]
    inverse = sparse.block_diag(inverses, format="csc")
    return sparse.csc_matrix(inverse @ matrix @ inverse.T)


def log10_cond(matrix: sparse.csc_matrix) -> float | None:
    """At most 14; None when the matrix is not positive definite."""
    if matrix.shape[0] <= LARGEST_DENSE:
        values = np.linalg.eigvalsh(matrix.toarray())
        low, high = float(values[0]), float(values[-1])
    else:
        try:
            factor = sparse_linalg.splu(
                matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
            )
        except RuntimeError:  # exactly singular
            return None
        if not (np.array_equal(factor.perm_r, factor.perm_c) and (factor.U.diagonal() > 0).all()):
            return None  # Sylvester: as many negative pivots as eigenvalues
        inverse = sparse_linalg.LinearOperator(matrix.shape, factor.solve)
        start = np.random.default_rng(1).standard_normal(matrix.shape[0])
        high = float(
            sparse_linalg.eigsh(matrix, k=1, which="LA", tol=1e-4, v0=start, return_eigenvectors=False)[0]
        )
        low = 1 / float(
            sparse_linalg.eigsh(inverse, k=1, which="LA", tol=1e-4, v0=start, return_eigenvectors=False)[0]
        )
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
        values = {
            matrix: getattr(s, attribute)
            for matrix, s in spectra.items()
            if getattr(s, attribute) is not None
        }
        lines = (
            {"median": float(np.median(list(values.values()))), "max": float(max(values.values())), **values}
            if values
            else {}
        )
        out |= {
            Metric(f"{name} {which}", "III", unit, LOWER_BETTER, tolerance): float(value)
            for which, value in lines.items()
        }
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
    unlike = [
        f"  {place}: {value} and {rows[place]}"
        for place, value in kept.scene.items()
        if rows.get(place, value) != value
    ]
    if not unlike and not any(place in rows for place in kept.scene):
        unlike = [f"  {', '.join(place for place in kept.scene) or 'no names'} and {', '.join(rows)}"]
    if unlike:
        raise UserError("\n".join([f"{path}: a baseline of other matrices:", *unlike]))


def _lonely(case: str, old: set[str], new: set[str]) -> list[Finding]:
    """A line for every matrix that only one side has, instead of one for each of its numbers."""
    said = [(name, "missing: the baseline has it") for name in sorted(old - new)] + [
        (name, judge.not_in_the_baseline("bench gate accept --matrix")[1]) for name in sorted(new - old)
    ]
    return [Finding(case, "III", f"matrix {name}", "FAIL", judged=0, note=note) for name, note in said]


def _invariants(case: str, spectra: list[Spectrum]) -> list[Finding]:
    bad = [s for s in spectra if s.raw is None or s.scaled is None]
    stuck = [s for s in spectra if s not in bad and s.pcg is None]
    return [
        Finding(
            case,
            "I",
            "positive definite",
            "FAIL" if bad else "pass",
            len(bad),
            0,
            unit="1",
            judged=len(spectra),
            note=f"{bad[0].path}" if bad else f"of {len(spectra)}",
        ),
        Finding(
            case,
            "I",
            "pcg converges",
            "FAIL" if stuck else "pass",
            len(stuck),
            0,
            unit="1",
            judged=len(spectra),
            note=f"{stuck[0].path}: more than {PCG_CAP}" if stuck else f"of {len(spectra)}",
        ),
    ]


def propose(paths: list[Path], case: str) -> Baseline:
    """Raises UserError, also for a matrix that is not positive definite: that is never accepted."""
    spectra = dict(zip(names(paths), map(spectrum, paths)))
    if red := [f for f in _invariants(case, list(spectra.values())) if f.verdict == "FAIL"]:
        raise UserError(
            "\n".join(
                f"{f.metric}: {f.value} of {len(spectra)} matrices are not, {f.note}: makes no baseline"
                for f in red
            )
        )
    kept = {
        metric.name: keep(metric, calibrate(metric, [value])) for metric, value in measure(spectra).items()
    }
    return Baseline(
        case, "matrix", "", {"date": datetime.date.today().isoformat(), "runs": 1}, kept, scene=_rows(spectra)
    )


def judge_matrices(paths: list[Path], path: Path) -> list[Finding]:
    """Against a baseline of kind matrix. Raises UserError."""
    kept = baseline.read(path, kind="matrix")
    spectra = dict(zip(names(paths), map(spectrum, paths)))
    _same_matrices(kept, spectra, path)
    old = {matrix for name in kept.metrics if (matrix := _of_matrix(name))}
    common = old & spectra.keys()
    of_common = {
        name: k
        for name, k in kept.metrics.items()
        if (matrix := _of_matrix(name)) is None or matrix in common
    }
    values = {
        metric: value
        for metric, value in measure(spectra).items()
        if (matrix := _of_matrix(metric.name)) is None or matrix in common
    }
    return (
        _invariants(kept.case, list(spectra.values()))
        + _lonely(kept.case, old, set(spectra))
        + judge.numbers(kept.case, of_common, values, False)
    )
