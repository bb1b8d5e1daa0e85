"""C++ of a formula: a struct that is made like a built-in shape, from u, e, l
(core/barrier/normalized_gap.hpp), with common subexpressions computed once; in a plugin
(core/model/plugin/barrierbench_plugin.h), and in a kernel for a card.
"""

import math

import sympy as sp
from sympy.printing.cxx import CXX17CodePrinter

from .checks import Ends
from .symbolic import L, Terms, U

INVERSE = sp.Symbol("r", positive=True)  # 1/u
MOST_FACTORS = 8  # of a power that is written as a product
# Functions that have the same bits on a card (core/math); all others are those of the compiler's library.
ELEMENTARY = {
    "log": "bb::elementary::log({})",
    "exp": "bb::elementary::exp({})",
    "atan": "bb::elementary::atan2({}, T(1.0))",
}

HEAD = """\
// {formula}
// Made by ./bench formula; not edited. e = 1 - u, u = d/d_hat, l = -ln u, r = 1/u.
// clang-format off
"""
STRUCT = """\
struct Formula {{
  static constexpr bool infinite_at_zero = {infinite};

  template <class T>
  BB_HD static bb::ShapeTerms<T> eval(T d, T d_hat) {{
    if (d >= d_hat) return {{T(0), T(0), T(0)}};
    if (d == T(0)) return {{d_hat * d_hat * T({zero[0]}), d_hat * T({zero[1]}), T({zero[2]})}};
    const bb::shapes::NormalizedGap<T> gap(d, d_hat);
    return {terms}(gap, d_hat, {minus_log});
  }}
  /// As built-in shapes have it where it takes nothing but + - * / and the logarithm: then four rows at a time.
  template <class T>
  BB_HD static bb::ShapeTerms<T> {terms}(const bb::shapes::NormalizedGap<T>& gap, T d_hat, [[maybe_unused]] T l) {{
    using std::cos, std::cosh, std::pow, std::sin, std::sinh, std::sqrt, std::tan, std::tanh;
    [[maybe_unused]] const T u = gap.u, e = gap.e;
{inverse}{common}    return {{d_hat * d_hat * ({b}), d_hat * ({db}), T({d2b})}};
  }}
}};
"""
PLUGIN = """\
#include <cmath>
#include <limits>

#include "barriers/shapes/builtin_shape.hpp"
#include "barriers/shapes/lane_batch.hpp"
#include "core/math/atan2.hpp"
#include "core/math/exp.hpp"
#include "core/model/plugin/barrierbench_plugin.h"

namespace {{

{struct}
void eval_double(void* self, size_t n, const double* d, const double* d_hat, double* b, double* db, double* d2b) {{
  bb::{batch}<Formula{of_double}>(self, n, d, d_hat, b, db, d2b);
}}
void eval_float(void* self, size_t n, const float* d, const float* d_hat, float* b, float* db, float* d2b) {{
  bb::shape_batch<Formula, float>(self, n, d, d_hat, b, db, d2b);
}}

constexpr bb_plugin_shape shapes[] = {{{{.name = "{name}",
                                       .doc = "{formula}",
                                       .smoothness_at_d_hat = {smoothness},
                                       .infinite_at_zero = {infinite},
                                       .self = nullptr,
                                       .eval_double = eval_double,
                                       .eval_float = eval_float}}}};
constexpr bb_plugin plugin = {{.abi_version = BB_PLUGIN_ABI_VERSION,
                              .name = "{name}",
                              .n_shapes = 1,
                              .shapes = shapes,
                              .n_policies = 0,
                              .policies = nullptr,
                              .n_integrators = 0,
                              .integrators = nullptr}};

}}  // namespace

extern "C" const bb_plugin* barrierbench_plugin(void) {{ return &plugin; }}

// b, b', b'' at one gap, for d_hat = 1: what ./bench formula compares with 40 digits.
extern "C" __attribute__((visibility("default"))) void barrierbench_formula_shape(double d, double* terms) {{
  const double d_hat = 1.0;
  eval_double(nullptr, 1, &d, &d_hat, terms, terms + 1, terms + 2);
}}
"""
ENTRY = "barrierbench_shape"  # the kernel of the device form
DEVICE = """\
#include <cmath>
#include <limits>

#include "core/exec/cuda/device_block.cuh"
#include "core/math/atan2.hpp"
#include "core/math/exp.hpp"
#include "core/contact/executor/given_shape.hpp"
#include "core/contact/executor/shape_kernels.hpp"

static_assert(bb::exec::given_shape_layout == {layout}, "the program was built from other sources: ./bench build");

{struct}
extern "C" __global__ void __launch_bounds__(bb::exec::block_threads)
    {entry}(bb::exec::Index n, const __grid_constant__ bb::exec::EvaluateGivenShape f) {{
  const auto i = static_cast<bb::exec::Index>(blockIdx.x) * bb::exec::block_threads + threadIdx.x;
  if (i < n) bb::exec::EvaluateShape<Formula>{{f.rows, f.argument}}(i);
}}
"""


class Printer(CXX17CodePrinter):
    """Every number as T(...), small whole powers as products: the same text for float, double and four
    doubles."""

    def _print_Integer(self, x: sp.Integer) -> str:
        return f"T({int(x)}.0)"

    def _print_Rational(self, x: sp.Rational) -> str:
        return f"(T({x.p}.0) / T({x.q}.0))"

    def _print_NumberSymbol(self, x: sp.NumberSymbol) -> str:
        return f"T({sp.N(x, 17)})"

    def _print_Float(self, x: sp.Float) -> str:
        return f"T({float(x)!r})"

    def _print_Mul(self, x: sp.Mul) -> str:
        sign, parts = "", list(x.args)
        if parts[0] == -1:
            sign, parts = "-", parts[1:]
        below = [p for p in parts if p.is_Pow and p.exp.is_negative and not p.exp == -sp.S.Half]
        above = [p for p in parts if p not in below]
        top = " * ".join(self._factor(p) for p in above) or "T(1.0)"
        bottom = "".join(f" / {self._factor(1 / p)}" for p in below)
        return sign + top + bottom

    def _factor(self, x: sp.Expr) -> str:
        text = self._print(x)
        return text if x.is_Symbol or x.is_Function or x.is_Number and x >= 0 else f"({text})"

    def _print_Pow(self, x: sp.Pow) -> str:
        base, p = x.base, x.exp
        if p.is_Integer and 1 < p <= MOST_FACTORS:
            factor = self._factor(base)
            return "(" + " * ".join([factor] * int(p)) + ")"
        if p.is_Integer and p < 0:
            return f"(T(1.0) / {self._factor(1 / x)})"
        if p == sp.S.Half:
            return f"sqrt({self._print(base)})"
        return f"pow({self._print(base)}, {self._print(p)})"

    def _print_Function(self, x: sp.Function) -> str:
        name, of = type(x).__name__, self._print(x.args[0])
        return ELEMENTARY[name].format(of) if name in ELEMENTARY else f"{name}({of})"

    _print_log = _print_exp = _print_atan = _print_Function


def cpp(name: str, formula: str, terms: Terms, ends: Ends) -> str:
    """The source of the plugin whose shape is called `name`."""
    parts = _parts(terms, ends)
    batch = "lane_batch" if parts["lanes"] else "shape_batch"
    of_double = "" if parts["lanes"] else ", double"
    shape = {"struct": STRUCT.format(**parts), "smoothness": ends.smoothness, "infinite": parts["infinite"]}
    plugin = PLUGIN.format(formula=formula, name=name, batch=batch, of_double=of_double, **shape)
    return HEAD.format(formula=formula) + plugin


def cu(formula: str, terms: Terms, ends: Ends, layout: int) -> str:
    """The source of its kernel, ENTRY. layout: given_shape_layout of the program that will launch it."""
    return HEAD.format(formula=formula) + DEVICE.format(
        struct=STRUCT.format(**_parts(terms, ends)), entry=ENTRY, layout=f"{layout:#x}"
    )


def _parts(terms: Terms, ends: Ends) -> dict:
    """What STRUCT is filled with, and whether four rows may be taken at a time."""
    inverted = [sp.sympify(x).replace(_is_inverse, lambda x: INVERSE ** (-x.exp)) for x in terms.precise]
    inverted = with_constants(inverted)
    common, last = sp.cse(inverted, symbols=sp.numbered_symbols("c"), optimizations="basic")
    used = set().union(*(x.free_symbols for x in [*last, *(y for _, y in common)]))
    simple = all(_is_rational(x) for x in [*last, *(y for _, y in common)])
    printer = Printer()
    lanes = simple and L in used  # without a logarithm the compiler does as well by itself
    inverse = "    const T r = T(1.0) / u;\n" if INVERSE in used else ""
    lines = "".join(f"    const T {symbol} = {printer.doprint(x)};\n" for symbol, x in common)
    parts = dict(zip(("b", "db", "d2b"), map(printer.doprint, last), strict=True))
    parts |= {"terms": "terms" if lanes else "scalar_terms", "inverse": inverse, "common": lines}
    parts |= {"zero": [_literal(x) for x in ends.at_zero], "infinite": int(math.isinf(ends.at_zero[0]))}
    return parts | {"minus_log": "gap.minus_log()" if L in used else "T(0)", "lanes": lanes}


def with_constants(terms: list[sp.Expr]) -> list[sp.Expr]:
    """Functions and powers of numbers alone become numbers."""
    constant = {
        x: sp.Float(sp.N(x, 20), 20)
        for y in terms
        for x in y.atoms(sp.Function) | y.atoms(sp.Pow)
        if not x.free_symbols
    }
    return [x.xreplace(constant) for x in terms]


def _is_inverse(x: sp.Expr) -> bool:
    return x.is_Pow and x.base == U and x.exp.is_Integer and x.exp.is_negative


def _is_rational(x: sp.Expr) -> bool:
    """Made of + - * / of numbers and symbols: four rows side by side have nothing else."""
    return all(
        y.is_Symbol or y.is_Number or y.is_Add or y.is_Mul or y.is_Pow and y.exp.is_Integer
        for y in sp.preorder_traversal(x)
    )


def _literal(x: float) -> str:
    if math.isinf(x):
        return f"{'-' if x < 0 else ''}std::numeric_limits<T>::infinity()"
    return repr(float(x))
