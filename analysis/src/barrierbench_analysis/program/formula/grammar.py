"""Reads a formula by a whitelist: decimal numbers, the symbols of what it stands for, pi, + - * / ^ (or **),
and the functions named here. Nothing of the text is ever evaluated. Imports no library beside the standard
one, so that a formula of the cache costs none.
"""

import ast
import re
from fractions import Fraction
from typing import NamedTuple

from barrierbench_analysis.io.errors import BAD_INPUT, UserError

FUNCTIONS = ("log", "exp", "sqrt", "sin", "cos", "tan", "atan", "sinh", "cosh", "tanh")
SAME = {"ln": "log"}
MOST_CHARACTERS = 400
MOST_EXPONENT = 32
LARGEST, SMALLEST = 1e12, 1e-12
DECIMAL = re.compile(r"(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
OPERATORS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "^"}
BASE = ("kg", "m", "s")

Powers = tuple[Fraction, Fraction, Fraction]  # of kg, m, s


def powers(kg: int = 0, m: int = 0, s: int = 0) -> Powers:
    return Fraction(kg), Fraction(m), Fraction(s)


class Quantity(NamedTuple):
    """What a formula stands for: its symbols with their units, and the unit that it has to have."""

    name: str
    symbols: dict[str, Powers]
    unit: Powers
    unit_text: str  # as messages have it

    @property
    def words(self) -> str:
        """All that its formulas may be made of."""
        names = ", ".join([*self.symbols, "pi"])
        return f"{names}, decimal numbers, + - * / ^ (or **) ( ) and the functions ln, {', '.join(FUNCTIONS)}"


SHAPE = Quantity(
    "shape", {"d": powers(m=1), "d_hat": powers(m=1)}, powers(m=2), "m^2: b(s d; s d_hat) = s^2 b(d; d_hat)"
)
POLICY = Quantity(
    "policy",
    {
        "m": powers(kg=1),  # w^T M w/(w^T w), w the weighted normals of a contact over its free vertices
        "k": powers(kg=1, s=-2),  # w^T H w/(w^T w), H the elastic Hessian
        "h": powers(s=1),  # time step
        "c": powers(),  # of the inertia M/(c h^2)
        "d": powers(m=1),
        "d_hat": powers(m=1),
    },
    powers(kg=1, s=-2),
    "N/m, which is kg s^-2",
)


class FormulaError(UserError):
    """What is wrong with a formula: what was found, with its place, and what is allowed."""

    def __init__(self, found: str, allowed: str, code: int = BAD_INPUT):
        super().__init__(f"found {found}; allowed: {allowed}", code)
        self.found, self.allowed = found, allowed


class Formula(NamedTuple):
    """A formula that was read. `text` is its one spelling: two texts with the same tree have the same."""

    text: str
    tree: ast.expr


class Unit(NamedTuple):
    """Powers of kg, m and s, and the value where it is a number alone."""

    power: Powers
    value: Fraction | None


NO_UNIT = powers()


def read(text: str, quantity: Quantity = SHAPE) -> Formula:
    """Errors: FormulaError for anything but the symbols allowed, an exponent that is not a number, and a unit
    that is not that of the quantity.
    """
    if not text.strip() or len(text) > MOST_CHARACTERS:
        raise FormulaError(f"{len(text)} characters", f"1 to {MOST_CHARACTERS}")
    strange = next((i for i, c in enumerate(text) if not (c.isascii() and c.isprintable()) or c == "#"), None)
    if strange is not None:
        raise FormulaError(f"{text[strange]!r} at character {strange + 1}", quantity.words)
    source, places = _as_python(text)
    try:
        tree = ast.parse(source, mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
        at = places[min(max((getattr(error, "offset", 1) or 1) - 1, 0), len(places) - 1)]
        raise FormulaError(
            f"{text!r}, which breaks off at character {at + 1}", f"a formula of {quantity.words}"
        ) from None
    found = _Reader(source, places, quantity).unit(tree)
    if found.power != quantity.unit:
        raise FormulaError(f"the unit {_unit_text(found.power)}", quantity.unit_text)
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


def _unit_text(power: Powers) -> str:
    parts = [
        name if p == 1 else f"{name}^{p}" if p.denominator == 1 else f"{name}^({p})"
        for name, p in zip(BASE, power, strict=True)
        if p != 0
    ]
    return " ".join(parts) or "1"


def _combined(left: Powers, right: Powers, times: Fraction | int) -> Powers:
    return tuple(a + times * b for a, b in zip(left, right, strict=True))


class _Renamed(ast.NodeTransformer):
    def visit_Name(self, node: ast.Name) -> ast.Name:
        return ast.Name(SAME.get(node.id, node.id), node.ctx)


class _Reader:
    """Judges every node of the tree, and gives its unit."""

    def __init__(self, source: str, places: list[int], quantity: Quantity):
        self.source, self.places, self.quantity = source, places, quantity

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
        raise self.refuse(node, f'"{ast.unparse(node)[:40]}"', self.quantity.words)

    def of_number(self, node: ast.Constant) -> Unit:
        value = node.value
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.refuse(node, repr(value)[:40], self.quantity.words)
        spelling = self.source[node.col_offset : node.end_col_offset]
        if not DECIMAL.fullmatch(spelling):
            raise self.refuse(node, f"the number {spelling[:40]}", "decimal numbers, such as 16, 0.5 or 1e-3")
        if value != 0 and not SMALLEST <= value <= LARGEST:
            raise self.refuse(node, f"the number {repr(value)[:40]}", f"0, or {SMALLEST:g} to {LARGEST:g}")
        return Unit(NO_UNIT, Fraction(repr(value)))

    def of_name(self, node: ast.Name) -> Unit:
        if node.id in self.quantity.symbols:
            return Unit(self.quantity.symbols[node.id], None)
        if node.id == "pi":
            return Unit(NO_UNIT, None)
        raise self.refuse(node, f'the symbol "{node.id[:40]}"', self.quantity.words)

    def of_operator(self, node: ast.BinOp) -> Unit:
        left, right = self.unit(node.left), self.unit(node.right)
        both = None if left.value is None or right.value is None else (left.value, right.value)
        if isinstance(node.op, ast.Add | ast.Sub):
            if left.power != right.power:
                found = f"the sum of {_unit_text(left.power)} and {_unit_text(right.power)}"
                units = ", ".join(
                    f"{name} is in {_unit_text(u)}" for name, u in self.quantity.symbols.items()
                )
                raise self.refuse(node, found, f"two terms of one unit: {units}")
            return Unit(
                left.power,
                both and (both[0] + both[1] if isinstance(node.op, ast.Add) else both[0] - both[1]),
            )
        if isinstance(node.op, ast.Mult):
            return Unit(_combined(left.power, right.power, 1), both and both[0] * both[1])
        if isinstance(node.op, ast.Div):
            if right.value == 0:
                raise self.refuse(node.right, "a division by 0", "a divisor that is not 0")
            return Unit(_combined(left.power, right.power, -1), both and both[0] / both[1])
        return self.of_power(node, left, right)

    def of_power(self, node: ast.BinOp, base: Unit, exponent: Unit) -> Unit:
        p = exponent.value
        if p is None or abs(p) > MOST_EXPONENT or p.denominator > MOST_EXPONENT:
            found = f"the exponent {ast.unparse(node.right)[:40].replace(' ** ', '^')}"
            raise self.refuse(
                node.right, found, f"a number from -{MOST_EXPONENT} to {MOST_EXPONENT}, such as 3, -1 or 3/2"
            )
        if base.value is None:
            return Unit(_combined(NO_UNIT, base.power, p), None)
        if base.value <= 0 or p.denominator != 1:
            raise self.refuse(
                node, f"a power of the number {float(base.value):g}", "a whole power of a number > 0"
            )
        value = base.value ** int(p)
        if not SMALLEST <= value <= LARGEST:
            raise self.refuse(
                node, f"the number {float(base.value):g}^{int(p)}", f"{SMALLEST:g} to {LARGEST:g}"
            )
        return Unit(NO_UNIT, value)

    def of_call(self, node: ast.Call) -> Unit:
        known = isinstance(node.func, ast.Name) and SAME.get(node.func.id, node.func.id) in FUNCTIONS
        if not known or len(node.args) != 1 or node.keywords:
            raise self.refuse(
                node, f'the call "{ast.unparse(node)[:40]}"', f"one argument of ln, {', '.join(FUNCTIONS)}"
            )
        inner = self.unit(node.args[0])
        if node.func.id == "sqrt":
            return Unit(_combined(NO_UNIT, inner.power, Fraction(1, 2)), None)
        if inner.power != NO_UNIT:
            found = f"{node.func.id} of {_unit_text(inner.power)}"
            raise self.refuse(node, found, "an argument without a unit, such as d/d_hat")
        return Unit(NO_UNIT, None)
