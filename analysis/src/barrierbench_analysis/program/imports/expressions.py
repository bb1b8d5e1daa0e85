"""Expressions of x, y, z and t in scenes of PolyFEM, which reads them by tinyexpr: +, -, *, /, % and ^ (from
the left, behind the sign of a number), functions, pi and e; log is that of base 10.
"""

import re
from collections.abc import Callable

import numpy as np

NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
TOKEN = re.compile(rf"\s*({NUMBER}|[A-Za-z_]\w*|[-+*/%^(),])")
CONSTANTS = {"pi": np.pi, "e": np.e}
VARIABLES = ("x", "y", "z", "t")


def _smoothstep(a):
    a = np.clip(a, 0, 1)
    return 3 * a**2 - 2 * a**3


FUNCTIONS: dict[str, tuple[int, Callable]] = {
    **{
        name: (1, getattr(np, name))
        for name in ("sin", "cos", "tan", "exp", "sqrt", "floor", "ceil", "tanh", "sinh", "cosh")
    },
    "abs": (1, np.abs),
    "acos": (1, np.arccos),
    "asin": (1, np.arcsin),
    "atan": (1, np.arctan),
    "atan2": (2, np.arctan2),
    "ln": (1, np.log),
    "log": (1, np.log10),
    "log10": (1, np.log10),
    "pow": (2, np.power),
    "min": (2, np.minimum),
    "max": (2, np.maximum),
    "smoothstep": (1, _smoothstep),
    "half_smoothstep": (1, lambda a: 2 * _smoothstep((a + 1) / 2) - 1),
    "deg2rad": (1, np.deg2rad),
    "rotate_2D_x": (3, lambda x, y, angle: x * np.cos(angle) - y * np.sin(angle)),
    "rotate_2D_y": (3, lambda x, y, angle: x * np.sin(angle) + y * np.cos(angle)),
    "if": (3, lambda test, yes, no: np.where(test >= 0, yes, no)),
    "compare": (2, lambda a, b: np.where(a < b, 1.0, 0.0)),
    "smooth_abs": (2, lambda x, k: np.tanh(k * x) * x),
    "sign": (1, np.sign),
}


class NoExpression(ValueError):
    """A text that is no expression; the message says what was found."""


class _Reader:
    """Recursive descent over the tokens; what it makes is a function of the variables."""

    def __init__(self, text: str) -> None:
        self.tokens: list[str] = []
        place = 0
        while place < len(text.rstrip()):
            if not (found := TOKEN.match(text, place)):
                raise NoExpression(f"{text[place:].strip()[:1]!r} in {text!r}")
            self.tokens.append(found[1])
            place = found.end()
        self.text, self.at = text, 0

    def peek(self) -> str:
        return self.tokens[self.at] if self.at < len(self.tokens) else ""

    def take(self, *wanted: str) -> str:
        token = self.peek()
        if not token or (wanted and token not in wanted):
            raise NoExpression(f"{token or 'its end'!r} in {self.text!r}")
        self.at += 1
        return token

    def chain(self, operations: dict[str, Callable], part: Callable) -> Callable:
        """Parts with operations of one rank between them, from the left."""
        made = part()
        while (token := self.peek()) in operations:
            self.take()
            made = _joined(operations[token], made, part())
        return made

    def total(self) -> Callable:
        return self.chain({"+": np.add, "-": np.subtract}, self.term)

    def term(self) -> Callable:
        return self.chain({"*": np.multiply, "/": np.divide, "%": np.fmod}, self.factor)

    def factor(self) -> Callable:
        return self.chain({"^": np.power}, self.signed)

    def signed(self) -> Callable:
        sign = 1.0
        while self.peek() in ("+", "-"):
            sign *= -1.0 if self.take() == "-" else 1.0
        base = self.base()
        return base if sign > 0 else lambda values: -base(values)

    def base(self) -> Callable:
        token = self.take()
        if re.fullmatch(NUMBER, token):
            return lambda values, number=float(token): number
        if token == "(":
            inner = self.total()
            self.take(")")
            return inner
        if token in CONSTANTS:
            return lambda values: CONSTANTS[token]
        if token in VARIABLES:
            return lambda values: values[token]
        if token not in FUNCTIONS:
            raise NoExpression(f"{token!r} in {self.text!r}")
        count, function = FUNCTIONS[token]
        self.take("(")
        parts = [self.total()]
        for _ in range(count - 1):
            self.take(",")
            parts.append(self.total())
        self.take(")")
        return lambda values: function(*(part(values) for part in parts))


def _joined(operation: Callable, left: Callable, right: Callable) -> Callable:
    return lambda values: operation(left(values), right(values))


def compiled(value: float | str) -> Callable[[np.ndarray, float], np.ndarray]:
    """A number or an expression as a function of points [n, 3] and the time, with values [n]. Errors:
    NoExpression.
    """
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise NoExpression(repr(value))
    if isinstance(value, str):
        reader = _Reader(value)
        made = reader.total()
        if reader.peek():
            raise NoExpression(f"{reader.peek()!r} in {value!r}")
    else:
        made = lambda values: float(value)  # noqa: E731 (of the same kind as the others)

    def evaluate(points: np.ndarray, time: float) -> np.ndarray:
        values = dict(zip("xyz", np.asarray(points, float).T)) | {"t": float(time)}
        return np.broadcast_to(np.asarray(made(values), float), (len(points),))

    return evaluate
