"""tables/numbers.py: how a number is written, and that no module has a way of its own to write one that may be missing."""

import ast
import math
import re
from pathlib import Path

import pytest

from barrierbench_analysis.tables import numbers

SOURCE = Path(__file__).resolve().parents[2] / "analysis" / "src" / "barrierbench_analysis"
OWN = {"numbers.py"}


@pytest.mark.parametrize("value, shown", [
    (None, "-"), (float("nan"), "-"), (0, "0"), (377.2, "377"), (0.1043, "0.104"), (38688.1, "38688"), (2.5e7, "2.50e7"),
    (3.2e-5, "3.20e-5"), (99999, "99999"), (999.7, "1000")])
def test_a_number_has_three_digits_and_a_short_power(value, shown):
    assert numbers.number(value) == shown


@pytest.mark.parametrize("shown, written", [
    (numbers.significant(None), "-"), (numbers.significant(float("nan"), none=""), ""), (numbers.significant(12345.0), "1.23e+04"),
    (numbers.significant(0.12345, 2, unit=" N"), "0.12 N"), (numbers.significant(math.inf), "inf"), (numbers.whole(12345.4), "12345"),
    (numbers.whole(12345.4, comma=","), "12,345"), (numbers.whole(999.7), "1000"), (numbers.whole(1.5), "1.5"), (numbers.whole(math.inf, none="never"), "never"),
    (numbers.ratio(1.0), "1"), (numbers.ratio(1.0001), "1.0001"), (numbers.ratio(1.5), "1.5"), (numbers.ratio(None), "-"),
    (numbers.interval(1.23456, 1.0, 2.0), "1.23 [1, 2]"), (numbers.interval(2.0, None, None), "2")])
def test_how_a_number_is_written(shown, written):
    assert shown == written


def test_a_rounded_value_keeps_its_shape_and_its_words():
    assert numbers.rounded({"a": [0.12345678, 3, "0.12345678", None, True]}) == {"a": [0.123457, 3, "0.12345678", None, True]}
    assert numbers.rounded(1.23456, 2) == 1.2


def missing_numbers(text: str) -> list[int]:
    """Lines with a choice, by `is None`, between a text and a number of so many digits alone: a formatter of their own."""
    def alone(node: ast.expr) -> bool:
        of = node.values if isinstance(node, ast.JoinedStr) else []
        spec = of[0].format_spec if len(of) == 1 and isinstance(of[0], ast.FormattedValue) else None
        return spec is not None and re.search(r"\.\S*g'", ast.unparse(spec)) is not None

    def none(test: ast.expr) -> bool:
        return isinstance(test, ast.Compare) and any(isinstance(c, ast.Constant) and c.value is None for c in test.comparators)

    return [node.lineno for node in ast.walk(ast.parse(text)) if isinstance(node, ast.IfExp) and none(node.test) and (alone(node.body) or alone(node.orelse))]


def test_only_one_module_writes_numbers_that_may_be_missing():
    assert missing_numbers('def f(x):\n    return "-" if x is None else f"{x:.3g}"') == [2]
    texts = {path.relative_to(SOURCE).as_posix(): path.read_text() for path in sorted(SOURCE.rglob("*.py")) if path.name not in OWN}
    assert len(texts) > 300
    assert {name: lines for name, text in texts.items() if (lines := missing_numbers(text))} == {}
