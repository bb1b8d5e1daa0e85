"""Reads a formula by a whitelist: numbers, d, d_hat, pi, + - * / ^, and the functions named here. Nothing
of the text is ever evaluated. Imports no library beside the standard one, so that a formula of the cache
costs none.
"""

from __future__ import annotations

import ast
from fractions import Fraction
from typing import NamedTuple

from ..errors import UserError

FUNCTIONS = ("log", "exp", "sqrt", "sin", "cos", "tan", "atan", "sinh", "cosh", "tanh")
SAME = {"ln": "log"}
LENGTHS = ("d", "d_hat")
MOST_CHARACTERS = 400
MOST_EXPONENT = 32
LARGEST, SMALLEST = 1e12, 1e-12
OPERATORS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "^"}
SYMBOLS = f"d, d_hat, pi, numbers, + - * / ^ ( ) and the functions ln, {', '.join(FUNCTIONS)}"


class FormulaError(UserError):
    """What is wrong with a formula: what was found, with its place, and what is allowed."""

    def __init__(self, found: str, allowed: str):
        super().__init__(f"found {found}; allowed: {allowed}")
        self.found, self.allowed = found, allowed


class Formula(NamedTuple):
    """A formula that was read. `text` is its one spelling: two texts with the same tree have the same."""

    text: str
    tree: ast.expr


class Unit(NamedTuple):
    """Power of a metre, and the value where it is a number alone."""

    power: Fraction
    value: Fraction | None


def read(text: str) -> Formula:
    """Errors: FormulaError for anything but the symbols allowed, an exponent that is no number, and a unit
    that is not m^2.
    """
    if not text.strip() or len(text) > MOST_CHARACTERS:
        raise FormulaError(f"{len(text)} characters", f"1 to {MOST_CHARACTERS}")
    strange = next((i for i, c in enumerate(text) if not (c.isascii() and c.isprintable())), None)
    if strange is not None:
        raise FormulaError(f"{text[strange]!r} at character {strange + 1}", SYMBOLS)
    source, places = _as_python(text)
    try:
        tree = ast.parse(source, mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
        at = places[min(max((getattr(error, "offset", 1) or 1) - 1, 0), len(places) - 1)]
        raise FormulaError(
            f"{text!r}, which breaks off at character {at + 1}", f"a formula of {SYMBOLS}"
        ) from None
    found = _Reader(text, places).unit(tree)
    if found.power != 2:
        raise FormulaError(f"the unit {_unit_text(found.power)}", "m^2: b(s d; s d_hat) = s^2 b(d; d_hat)")
    return Formula(ast.unparse(_Renamed().visit(tree)).replace(" ** ", "^"), tree)


def _as_python(text: str) -> tuple[str, list[int]]:
    """The text with ** for ^, and of each of its characters and the end the place in the text."""
    out, places = "", []
    text = text.rstrip()
    blank = len(text) - len(text.lstrip())
    for i in range(blank, len(text)):
        piece = "**" if text[i] == "^" else text[i]
        out += piece
        places += [i] * len(piece)
    return out, [*places, len(text)]


def _unit_text(power: Fraction) -> str:
    return (
        "1"
        if power == 0
        else "m"
        if power == 1
        else f"m^{power}"
        if power.denominator == 1
        else f"m^({power})"
    )


class _Renamed(ast.NodeTransformer):
    def visit_Name(self, node: ast.Name) -> ast.Name:
        return ast.Name(SAME.get(node.id, node.id), node.ctx)


class _Reader:
    """Judges every node of the tree, and gives its unit."""

    def __init__(self, text: str, places: list[int]):
        self.text, self.places = text, places

    def refuse(self, node: ast.expr, found: str, allowed: str) -> FormulaError:
        return FormulaError(f"{found} at character {self.places[node.col_offset] + 1}", allowed)

    def unit(self, node: ast.expr) -> Unit:
        if isinstance(node, ast.Constant):
            return self.of_number(node)
        if isinstance(node, ast.Name):
            return self.of_name(node)
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
            inner = self.unit(node.operand)
            return (
                inner._replace(value=-inner.value)
                if isinstance(node.op, ast.USub) and inner.value is not None
                else inner
            )
        if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
            return self.of_operator(node)
        if isinstance(node, ast.Call):
            return self.of_call(node)
        raise self.refuse(node, f'"{ast.unparse(node)[:40]}"', SYMBOLS)

    def of_number(self, node: ast.Constant) -> Unit:
        value = node.value
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.refuse(node, repr(value)[:40], SYMBOLS)
        if value != 0 and not SMALLEST <= value <= LARGEST:
            raise self.refuse(node, f"the number {repr(value)[:40]}", f"0, or {SMALLEST:g} to {LARGEST:g}")
        return Unit(Fraction(0), Fraction(repr(value)))

    def of_name(self, node: ast.Name) -> Unit:
        if node.id in LENGTHS:
            return Unit(Fraction(1), None)
        if node.id == "pi":
            return Unit(Fraction(0), None)
        raise self.refuse(node, f'the symbol "{node.id[:40]}"', SYMBOLS)

    def of_operator(self, node: ast.BinOp) -> Unit:
        left, right = self.unit(node.left), self.unit(node.right)
        both = None if left.value is None or right.value is None else (left.value, right.value)
        if isinstance(node.op, ast.Add | ast.Sub):
            if left.power != right.power:
                found = f"the sum of {_unit_text(left.power)} and {_unit_text(right.power)}"
                raise self.refuse(node, found, "two terms of one unit: d and d_hat are m")
            return Unit(
                left.power,
                both and (both[0] + both[1] if isinstance(node.op, ast.Add) else both[0] - both[1]),
            )
        if isinstance(node.op, ast.Mult):
            return Unit(left.power + right.power, both and both[0] * both[1])
        if isinstance(node.op, ast.Div):
            if right.value == 0:
                raise self.refuse(node.right, "a division by 0", "a divisor that is not 0")
            return Unit(left.power - right.power, both and both[0] / both[1])
        return self.of_power(node, left, right)

    def of_power(self, node: ast.BinOp, base: Unit, exponent: Unit) -> Unit:
        p = exponent.value
        if p is None or abs(p) > MOST_EXPONENT or p.denominator > MOST_EXPONENT:
            found = f"the exponent {ast.unparse(node.right)[:40].replace(' ** ', '^')}"
            raise self.refuse(
                node.right, found, f"a number from -{MOST_EXPONENT} to {MOST_EXPONENT}, such as 3, -1 or 3/2"
            )
        if base.value is None:
            return Unit(base.power * p, None)
        if base.value <= 0 or p.denominator != 1:
            raise self.refuse(
                node, f"a power of the number {float(base.value):g}", "a whole power of a number > 0"
            )
        value = base.value ** int(p)
        if not SMALLEST <= value <= LARGEST:
            raise self.refuse(
                node, f"the number {float(base.value):g}^{int(p)}", f"{SMALLEST:g} to {LARGEST:g}"
            )
        return Unit(Fraction(0), value)

    def of_call(self, node: ast.Call) -> Unit:
        known = isinstance(node.func, ast.Name) and SAME.get(node.func.id, node.func.id) in FUNCTIONS
        if not known or len(node.args) != 1 or node.keywords:
            raise self.refuse(
                node, f'the call "{ast.unparse(node)[:40]}"', f"one argument of ln, {', '.join(FUNCTIONS)}"
            )
        inner = self.unit(node.args[0])
        if node.func.id == "sqrt":
            return Unit(inner.power / 2, None)
        if inner.power != 0:
            found = f"{node.func.id} of {_unit_text(inner.power)}"
            raise self.refuse(node, found, "an argument without a unit, such as d/d_hat")
        return Unit(Fraction(0), None)
