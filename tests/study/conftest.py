"""A small study of four runs, made once; the rule of the studies of small_study.py."""

import importlib
from types import SimpleNamespace

import pytest
from study_files import sweep_of_four

from barrierbench_analysis.studies.kit.study.spec import read_study


@pytest.fixture(scope="session")
def kept_study(program, tmp_path_factory):
    return sweep_of_four(program, tmp_path_factory.mktemp("kept"))


@pytest.fixture
def built(program, monkeypatch):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)


@pytest.fixture
def rule_of_small(monkeypatch):
    """The rule of the studies of small_study.py, which need no file in studies/rules; tests give it more functions."""
    real, rule = importlib.import_module, SimpleNamespace(rule=lambda study, rows: {"number": len(rows)})
    monkeypatch.setattr(importlib, "import_module", lambda name: rule if name.endswith("rules.small") else real(name))
    return rule


@pytest.fixture
def decided(rule_of_small):
    """The first cell, once it has a row, decides how the three after it end."""
    rule_of_small.decided = lambda study, rows: (
        {cell.key: "stalled" for cell in study.cells[1:4]} if study.cells[0].key in rows else {}
    )


@pytest.fixture(scope="module")
def no_rows_of_the_study_at_size():
    from adversary_rows import without_rows_of_the_study_at_size

    with without_rows_of_the_study_at_size():
        yield


@pytest.fixture
def adversary(tmp_path):
    """The study, without a kept row."""
    return read_study("adversary", tmp_path)
