"""The code that computes verdicts is one that the list of its changes has."""

import inspect

import pytest

from barrierbench_analysis.tables import gap_rule
from barrierbench_analysis.tables import estimate
from barrierbench_analysis.studies.claims import numbers, verdict_code
from barrierbench_analysis.pages.claims import report
from barrierbench_analysis.studies.claims.table import Table


def test_the_code_of_verdicts_is_the_last_of_the_list():
    """Red: add an entry to analysis/src/barrierbench_analysis/studies/claims/verdict_code.json with the new hash and what it means for verdicts that are registered."""
    found = verdict_code.changes()
    assert found and found[-1].code == verdict_code.code_now(), f"the code is {verdict_code.code_now()}"
    assert [one.date for one in found] == sorted(one.date for one in found) and all(len(one.what) > 20 for one in found)


@pytest.mark.parametrize("module, old, new", [
    (estimate, "CONFIDENCE = 0.95", "CONFIDENCE = 0.5"), (gap_rule, "MAX_RATIO = 2", "MAX_RATIO = 100"),
    (numbers, "not all(of_judged)", "all(of_judged)")])
def test_a_constant_and_a_line_of_code_change_the_hash(monkeypatch, module, old, new):
    before, original = verdict_code.code_now(), inspect.getsource
    assert module in verdict_code.MODULES and old in original(module)
    monkeypatch.setattr(inspect, "getsource", lambda code: original(code).replace(old, new) if code is module else original(code))
    assert verdict_code.code_now() != before


def test_the_page_lists_the_changes():
    page = report.markdown([], Table())
    assert all(f"- {one.date}, {one.code}: {one.what}" in page for one in verdict_code.changes())
