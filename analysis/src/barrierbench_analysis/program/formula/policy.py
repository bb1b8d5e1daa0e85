"""A stiffness as a formula: kappa in N/m of a contact, checked on a grid of its arguments, printed
as C++ (a plugin with one policy) and compared with 40 digits.
"""

import ctypes
import itertools
import math
from collections.abc import Iterator
from pathlib import Path

import mpmath
import sympy as sp

from .accuracy import MOST_ERROR
from .checks import DIGITS
from .grammar import POLICY, Formula, FormulaError
from .source import Printer, with_constants
from .symbolic import expression

SYMBOLS = {name: sp.Symbol(name, positive=True) for name in POLICY.symbols}
ORDER = tuple(SYMBOLS)  # m, k, h, c, d, d_hat: the arguments of kappa_of in the library
UNITS = {"m": "kg", "k": "N/m", "h": "s", "c": "", "d": "m", "d_hat": "m"}
# Arguments of runs: decades of masses and stiffnesses, of steps and lengths; d as a part of d_hat.
GRID = {
    "m": ("1e-8", "1e-5", "1e-2", "10"),
    "k": ("0", "1e-3", "1", "1e4", "1e8"),
    "h": ("1e-5", "1e-3", "0.1"),
    "c": ("0.25", "1"),
    "d": ("1e-6", "1e-3", "0.05", "0.2", "0.5", "0.7", "0.9", "0.99", "1"),
    "d_hat": ("1e-5", "1e-3", "0.1"),
}
EVERY = 7  # points at which the compiled library is evaluated

TEMPLATE = """\
// kappa = {formula}
// Made by ./bench formula; not edited.
#include <cmath>

#include "core/barrier/stiffness_sums.hpp"
#include "core/math/atan2.hpp"
#include "core/math/exp.hpp"
#include "core/math/log.hpp"
#include "core/model/plugin/barrierbench_plugin.h"

namespace {{

using T = double;

double kappa_of({arguments}) {{
  using std::cos, std::cosh, std::pow, std::sin, std::sinh, std::sqrt, std::tan, std::tanh;
{common}  return {kappa};
}}

double slope_of({slope_arguments}) {{
  using std::cos, std::cosh, std::pow, std::sin, std::sinh, std::sqrt, std::tan, std::tanh;
{slope_common}  return {slope};
}}

void fill(void*, const bb_plugin_rows* rows, double* kappa) {{
  for (size_t r = 0; r < rows->n; ++r) {{
    const double* hessian = rows->hessian ? rows->hessian + 144 * r : nullptr;
    const auto sums = bb::contact_sums<double>(rows->n_free[r], rows->weight + 4 * r, rows->normal + 3 * r,
                                               rows->mass + 4 * r, bb::ColumnMajor<double>{{hessian, 12}},
                                               hessian != nullptr);
    kappa[r] = kappa_of(sums.mass / sums.w_sq, sums.elastic / sums.w_sq, rows->h, rows->c, rows->d[r],
                        rows->d_hat[r]);
  }}
}}

constexpr bb_plugin_policy policies[] = {{{{.name = "{name}",
                                           .doc = "{formula}",
                                           .needs_hessian = {hessian},
                                           .self = nullptr,
                                           .fill = fill}}}};
constexpr bb_plugin plugin = {{.abi_version = BB_PLUGIN_ABI_VERSION,
                              .name = "{name}",
                              .n_shapes = 0,
                              .shapes = nullptr,
                              .n_policies = 1,
                              .policies = policies,
                              .n_integrators = 0,
                              .integrators = nullptr}};

}}  // namespace

extern "C" const bb_plugin* barrierbench_plugin(void) {{ return &plugin; }}

// kappa and d kappa/dd at n gaps of one pair (barriers/formulas.hpp).
extern "C" __attribute__((visibility("default"))) void barrierbench_formula_in_gap(
    double m, double k, double h, double c, double d_hat, size_t n, const double* d, double* kappa,
    double* slope) {{
  for (size_t i = 0; i < n; ++i) {{
    kappa[i] = kappa_of(m, k, h, c, d[i], d_hat);
    slope[i] = slope_of(m, k, h, c, d[i], d_hat);
  }}
}}
"""


def kappa_of(formula: Formula) -> sp.Expr:
    return expression(formula.tree, {**SYMBOLS, "pi": sp.pi})


def slope_of(kappa: sp.Expr) -> sp.Expr:
    """d kappa/dd, N/m^2."""
    return sp.diff(kappa, SYMBOLS["d"])


def symbols_of(kappa: sp.Expr) -> list[str]:
    """What it reads, in the order of the arguments."""
    return [name for name in ORDER if SYMBOLS[name] in kappa.free_symbols]


def points(kappa: sp.Expr) -> Iterator[dict[str, mpmath.mpf]]:
    """All combinations of what it reads; one value of what it does not."""
    read = symbols_of(kappa)
    values = [GRID[name] if name in read else GRID[name][-1:] for name in ORDER]
    with mpmath.workdps(DIGITS):
        for one in itertools.product(*values):
            point = {name: mpmath.mpf(text) for name, text in zip(ORDER, one, strict=True)}
            point["d"] *= point["d_hat"]
            yield point


def check(kappa: sp.Expr) -> int:
    """The number of points of the grid. Errors: FormulaError with the first where kappa is not finite, not
    real or negative, and where it is 0 at all of them.
    """
    value = sp.lambdify(list(SYMBOLS.values()), kappa, "mpmath")
    count = positive = 0
    with mpmath.workdps(DIGITS):
        for point in points(kappa):
            y, wrong = _value(value, point)
            if wrong:
                read = [f"{name} = {mpmath.nstr(point[name], 6)} {UNITS[name]}" for name in symbols_of(kappa)]
                raise FormulaError(
                    f"{wrong} at {', '.join(map(str.rstrip, read))}", "a finite kappa >= 0 for 0 < d <= d_hat"
                )
            count += 1
            positive += y > 0
    if positive == 0:
        raise FormulaError(f"kappa = 0 at all {count} points of the check", "a kappa that is not 0")
    return count


def _value(value, point: dict[str, mpmath.mpf]) -> tuple[mpmath.mpf, str]:
    """kappa, and what is wrong with it."""
    try:
        y = value(*point.values())
    except (ZeroDivisionError, ValueError, OverflowError):
        return mpmath.nan, "no kappa"
    if not mpmath.isfinite(y):
        return y, "an infinite kappa"
    if mpmath.im(y) != 0:
        return y, "no real kappa"
    y = mpmath.re(y)
    return y, f"kappa = {mpmath.nstr(y, 6)} N/m" if y < 0 else ""


def cpp(name: str, formula: str, kappa: sp.Expr) -> str:
    """The source of the plugin whose policy is called `name`."""
    common, value = _statements(kappa)
    slope = slope_of(kappa)
    slope_common, slope_value = _statements(slope)
    of_slope = {"slope_arguments": _arguments(slope), "slope_common": slope_common, "slope": slope_value}
    of_kappa = {"arguments": _arguments(kappa), "common": common, "kappa": value}
    hessian = int("k" in symbols_of(kappa))
    return TEMPLATE.format(formula=formula, name=name, hessian=hessian, **of_kappa, **of_slope)


def _arguments(x: sp.Expr) -> str:
    read = symbols_of(x)
    return ", ".join(f"{'' if one in read else '[[maybe_unused]] '}double {one}" for one in ORDER)


def _statements(x: sp.Expr) -> tuple[str, str]:
    """Common subexpressions as constants, a line each, and the value in terms of them."""
    common, (last,) = sp.cse(with_constants([x]), symbols=sp.numbered_symbols("x"), optimizations="basic")
    printer = Printer()
    lines = (f"  const double {symbol} = {printer.doprint(y)};\n" for symbol, y in common)
    return "".join(lines), printer.doprint(last)


def judge(library: Path, kappa: sp.Expr) -> dict[str, float]:
    """Largest errors of the library at points of the grid: error_rel of kappa, and slope_error_rel of d
    kappa/dd as a part of kappa/d, below d_hat, where a slope may be infinite. Errors: FormulaError where
    the first is above MOST_ERROR, or a slope is not finite.
    """
    at, worst, worst_slope = _call(library), 0.0, 0.0
    exact = [sp.lambdify(list(SYMBOLS.values()), x, "mpmath") for x in (kappa, slope_of(kappa))]
    with mpmath.workdps(DIGITS):
        for point in itertools.islice(points(kappa), 0, None, EVERY):
            numbers = {name: float(x) for name, x in point.items()}
            digits, (found, slope) = list(map(mpmath.mpf, numbers.values())), at(**numbers)
            value = exact[0](*digits)
            error = float(abs((mpmath.mpf(found) - value) / value)) if value != 0 else abs(found)
            worst = max(worst, error)
            if not error <= MOST_ERROR:
                raise FormulaError(
                    f"kappa off by a factor of {error:.1g} in double precision at {numbers}",
                    f"a formula that keeps {MOST_ERROR:g}: without differences of near numbers",
                )
            d, d_hat = numbers["d"], numbers["d_hat"]
            if d >= d_hat:
                continue
            if not math.isfinite(slope):
                raise FormulaError(f"d kappa/dd = {slope} at d = {d / d_hat:.6g} d_hat", "a finite number")
            wanted = exact[1](*digits)
            scale = max(abs(value) / d, abs(wanted))
            worst_slope = max(worst_slope, float(abs(slope - wanted) / scale) if scale != 0 else abs(slope))
    return {"error_rel": worst, "slope_error_rel": worst_slope}


def _call(library: Path):
    """kappa and d kappa/dd of the library at one point."""
    number, pointer = ctypes.c_double, ctypes.POINTER(ctypes.c_double)
    in_gap = ctypes.CDLL(str(library)).barrierbench_formula_in_gap
    in_gap.argtypes, in_gap.restype = [number] * 5 + [ctypes.c_size_t] + [pointer] * 3, None

    def at(m: float, k: float, h: float, c: float, d: float, d_hat: float) -> tuple[float, float]:
        kappa, slope = number(), number()
        in_gap(m, k, h, c, d_hat, 1, number(d), kappa, slope)
        return kappa.value, slope.value

    return at
