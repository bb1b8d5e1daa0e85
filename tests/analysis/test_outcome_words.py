"""tables/outcomes.py: what a run is counted as, and that no module has a rule of its own for it."""

import ast
from pathlib import Path

import pytest

from barrierbench_analysis.tables import outcomes

SOURCE = Path(__file__).resolve().parents[2] / "analysis" / "src" / "barrierbench_analysis"


@pytest.mark.parametrize("outcome, valid, word", [("ok", True, "ok"), ("ok", False, "not_valid"), ("timeout", False, "timeout"), ("nan", True, "nan")])
def test_a_run_that_is_not_valid_is_not_ok(outcome, valid, word):
    assert outcomes.outcome_of({"status": {"outcome": outcome, "valid": valid}}) == word == outcomes.counted_as(outcome, valid)


def test_a_page_may_have_another_word():
    assert outcomes.counted_as("ok", False, "not valid") == "not valid"


def own_rules(text: str) -> list[int]:
    """Lines with a choice between the word of a run that is not valid and another one."""
    return [node.lineno for node in ast.walk(ast.parse(text)) if isinstance(node, ast.IfExp)
            and any(isinstance(end, ast.Constant) and end.value in ("not_valid", "not valid") for end in (node.body, node.orelse))]


def test_only_one_module_has_the_rule():
    assert own_rules('"not_valid" if outcome == "ok" and not valid else outcome') == [1]
    texts = {path.relative_to(SOURCE).as_posix(): path.read_text() for path in sorted(SOURCE.rglob("*.py"))}
    assert len(texts) > 300
    assert {name: lines for name, text in texts.items() if (lines := own_rules(text))} == {}
