"""A formula and its derivatives in u = d/d_hat, for d_hat = 1: as they are (for limits and checks), and in u,
e = 1 - u and l = -ln u, which keep full precision at both ends of (0, d_hat) and become C++.
"""

import ast
from fractions import Fraction
from typing import NamedTuple

import sympy as sp

from .grammar import SAME, Formula

U = sp.Symbol("u", positive=True)
E, L = sp.symbols("e l", positive=True)
HIGHEST = 6  # derivatives that smoothness is looked for in
# d_hat is 1 here: a formula of unit m^2 is d_hat^2 times this
VALUES = {"d": U, "d_hat": sp.Integer(1), "pi": sp.pi}


class Terms(NamedTuple):
    """b, b', b'' over d_hat^2, d_hat and 1 in u, and the same in u, e, l."""

    plain: tuple[sp.Expr, sp.Expr, sp.Expr]
    precise: tuple[sp.Expr, sp.Expr, sp.Expr]


def terms_of(formula: Formula) -> Terms:
    """Cost: a second, of which most is the import of sympy."""
    b = expression(formula.tree)
    slope = sp.diff(b, U)
    precise = _in_precise(b)
    first = _derivative(precise)
    return Terms((b, slope, sp.diff(slope, U)), (precise, first, _derivative(first)))


def expression(node: ast.expr, values: dict[str, sp.Expr] = VALUES) -> sp.Expr:
    """Requires a tree that grammar.read has let through, and a value of each of its names."""
    if isinstance(node, ast.Constant):
        exact = Fraction(repr(node.value))
        return sp.Rational(exact.numerator, exact.denominator)
    if isinstance(node, ast.Name):
        return values[node.id]
    if isinstance(node, ast.UnaryOp):
        inner = expression(node.operand, values)
        return -inner if isinstance(node.op, ast.USub) else inner
    if isinstance(node, ast.Call):
        return getattr(sp, SAME.get(node.func.id, node.func.id))(expression(node.args[0], values))
    left, right = expression(node.left, values), expression(node.right, values)
    kind = type(node.op)
    if kind is ast.Add:
        return left + right
    if kind is ast.Sub:
        return left - right
    if kind is ast.Mult:
        return left * right
    return left / right if kind is ast.Div else left**right


def _in_precise(b: sp.Expr) -> sp.Expr:
    """ln u becomes -l, and every polynomial that is 0 at u = 1 a power of e times the rest."""
    logs = sp.expand_log(b, force=True).replace(lambda x: x == sp.log(U), lambda _: -L)
    return logs.replace(lambda x: x.is_Add and x.has(U), _polynomial_parts)


def _polynomial_parts(total: sp.Expr) -> sp.Expr:
    """The terms of a sum that are a polynomial in u, factored at u = 1; the others as they are."""
    inside = [x for x in total.args if x.is_polynomial(U) and x.free_symbols <= {U}]
    polynomial = sp.Add(*inside)
    if not polynomial.has(U) or polynomial.subs(U, 1) != 0:
        return total
    rest = sp.Add(*(x for x in total.args if x not in inside))
    power = 0
    quotient = sp.Poly(polynomial, U)
    while quotient.eval(1) == 0:
        quotient, power = quotient.quo(sp.Poly(1 - U, U)), power + 1
    return rest + E**power * quotient.as_expr()


def _derivative(x: sp.Expr) -> sp.Expr:
    """d/du of an expression in u, e = 1 - u, l = -ln u."""
    return sp.diff(x, U) - sp.diff(x, E) - sp.diff(x, L) / U
