"""A study that is repeated in a folder of its own says how far its rows are from the kept ones."""

from dataclasses import replace

import pytest

from barrierbench_analysis.studies.kit.study import repeat, store, verb

from small_study import row, written

pytestmark = pytest.mark.usefixtures("rule_of_small")


def test_ratios_are_of_cells_with_a_kept_row(tmp_path):
    study = written(tmp_path)
    kept = {cell.key: row(cell, newton=4.0) for cell in study.cells[:3]}
    new = [replace(row(cell, newton=n), origin={"machine": "m", "build": "c"}) for cell, n in zip(study.cells, (4.0, 8.0, 2.0, 99.0))]
    new[2] = replace(new[2], outcome="timeout")
    head, *table = repeat.lines(kept, new)
    assert head == "3 cells with a kept row: the same outcome in 2, 2 builds"
    assert [line.split() for line in table if line.startswith("newton")] == [["newton", "3", "1", "0.5", "2"]]


def test_nothing_is_said_without_a_kept_row(tmp_path):
    assert repeat.lines({}, [row(cell) for cell in written(tmp_path).cells]) == []


@pytest.mark.parametrize("value", [None, 0, "text", -1.0])
def test_what_is_no_number_above_0_is_in_no_ratio(tmp_path, value):
    cell = written(tmp_path).cells[0]
    assert not any("newton" in line for line in repeat.lines({cell.key: row(cell, newton=value)}, [row(cell)]))


def test_a_call_with_out_prints_the_ratios(tmp_path, capsys):
    study = written(tmp_path)
    cell = study.cells[0]
    store.write_rows(store.file_of(study), {cell.key: row(cell, newton=1.0)})
    only = [f"--only={axis}={label}" for axis, label in cell.place.items()]
    verb.main([str(study.file), *only, "--out", str(tmp_path / "again")])
    assert "1 cell with a kept row: the same outcome in 1, 2 builds" in capsys.readouterr().out
