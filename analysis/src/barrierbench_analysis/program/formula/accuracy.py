"""The compiled library beside 40 digits: how much of b, b', b'' double precision keeps."""

import ctypes
from pathlib import Path

import mpmath
import sympy as sp

from .checks import DIGITS, NAMES, grid
from .grammar import FormulaError
from .symbolic import Terms, U

MOST_ERROR = 1e-6  # relative, of force and curvature between NEAR and 1 - NEAR
NEAR = 1e-4
EVERY = 7  # points of the grid


def check(library: Path, terms: Terms) -> dict[str, float]:
    """Largest relative error of b, b', b'' for u from 1e-4 to 1 - 1e-4. Errors: FormulaError where force or
    curvature is lost to cancellation.
    """
    call = _call(library)
    worst = dict.fromkeys(NAMES, 0.0)
    with mpmath.workdps(DIGITS):
        exact = [sp.lambdify(U, term, "mpmath") for term in terms.plain]
        for u in grid()[::EVERY]:
            if not NEAR <= u <= 1 - NEAR:
                continue
            found = call(float(u))
            for name, value, of in zip(NAMES, found, exact, strict=True):
                true = of(mpmath.mpf(float(u)))
                error = float(abs((mpmath.mpf(value) - true) / true)) if true != 0 else abs(value)
                worst[name] = max(worst[name], error)
                if name != "b" and not error <= MOST_ERROR:
                    raise FormulaError(
                        f"{name} off by a factor of {error:.1g} in double precision at"
                        f" d = {float(u):.6g} d_hat",
                        f"a formula that keeps {MOST_ERROR:g}: without differences of near numbers, in"
                        " (d_hat - d), say",
                    )
    return worst


def _call(library: Path):
    """b, b', b'' of the library at one gap, for d_hat = 1."""
    terms = (ctypes.c_double * 3)()
    evaluate = ctypes.CDLL(str(library)).barrierbench_formula_shape
    evaluate.argtypes, evaluate.restype = [ctypes.c_double, ctypes.c_double * 3], None

    def at(u: float) -> list[float]:
        evaluate(u, terms)
        return list(terms)

    return at
