"""A study whose runs need more memory than the machine has is refused before the first of them."""

from dataclasses import replace

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.kit.study import memory, store, verb

from small_study import SPEC, row, written

pytestmark = pytest.mark.usefixtures("rule_of_small")
GIB = 1 << 30


@pytest.fixture
def sized(tmp_path, monkeypatch):
    """The small study, whose cells of strip b have ten times the unknowns of the others; one of strip a has a row."""
    study = written(tmp_path, metrics={**SPEC["metrics"], memory.METRIC: "/summary/peak_rss_bytes"})
    for cell in study.cells:
        object.__setattr__(cell, "unknowns", 120 if cell.place["level"] == "b" else 12)
    kept = replace(row(study.cells[0], **{memory.METRIC: 1.0 * GIB}), sources=study.data["metrics"])
    monkeypatch.setattr(memory, "free_bytes", lambda: 30 * GIB)
    return study, {kept.key: kept}


def of_level(study, level):
    return [cell for cell in study.cells if cell.place["level"] == level]


def test_memory_grows_with_the_unknowns(sized):
    study, rows = sized
    found = memory.expected(study, rows, study.cells)
    assert len(of_level(study, "a")) == len(of_level(study, "b")) == 4
    assert {found[cell.key] for cell in of_level(study, "a")} == {GIB}
    assert [found[cell.key] for cell in of_level(study, "b")] == pytest.approx([GIB * 10 ** (4 / 3)] * 4)
    assert memory.line(study, rows, study.cells) == ["up to 21.5 GiB of memory for a run; 30.0 are free"]


def test_runs_that_memory_does_not_hold_are_refused_before_the_first(sized):
    study, rows = sized
    memory.require(study, rows, study.cells, 1)
    memory.require(study, rows, of_level(study, "a"), 30)
    with pytest.raises(UserError, match=r"small.json: found 'strip b.*about 21.5 GiB .*, 2 at a time; allowed: 30.0 GiB"):
        memory.require(study, rows, study.cells, 2)


def test_a_call_makes_no_run_that_memory_does_not_hold(sized, monkeypatch):
    study, rows = sized
    store.write_rows(store.file_of(study), rows)
    monkeypatch.setattr(verb, "run_cells", lambda *_: pytest.fail("a run was made"))
    with pytest.raises(UserError, match="found .* which needs about"):
        verb.make_rows(study, study.cells, jobs=2)


def test_without_rows_of_it_nothing_is_estimated(sized):
    study, _ = sized
    without = row(study.cells[0])
    assert memory.expected(study, {without.key: without}, study.cells) == {}
    assert memory.line(study, {}, study.cells) == []
    memory.require(study, {}, study.cells, 1000)
