"""Records that must not be read: an empty folder, another schema, a file that is not JSON."""

import json

import pytest

from barrierbench_analysis.figures.plots import verb as figures
from barrierbench_analysis.tables.records import RecordError, load
from barrierbench_analysis.io.whole_file import write_whole
from synthetic import write_set


def test_an_empty_folder_is_named(tmp_path):
    with pytest.raises(RecordError, match="no run.json"):
        load(tmp_path)


def test_another_major_version_is_refused(tmp_path):
    record = {"schema": {"name": "barrierbench.run", "version": "9.0.0"}}
    (tmp_path / "run.json").write_text(json.dumps(record))
    with pytest.raises(RecordError, match="9.0.0"):
        load(tmp_path)


def test_a_file_that_is_not_json_is_named(tmp_path):
    (tmp_path / "run.json").write_text("{")
    with pytest.raises(RecordError, match="not JSON"):
        load(tmp_path)


@pytest.mark.parametrize("torn", ["", "{", "half", "[]", "not text"])
def test_a_torn_record_is_left_out_and_named(tmp_path, capsys, torn):
    write_set(tmp_path)
    path = tmp_path / "cubic" / "run.json"
    text = path.read_text()
    path.write_bytes(b"\xff\xfe" if torn == "not text" else (text[: len(text) // 2] if torn == "half" else torn).encode())
    records = load(tmp_path)

    assert sorted(records.runs["run"]) == ["cubic_dynamic", "log", "quadratic"]
    assert len(records.unreadable) == 1 and str(path) in records.unreadable[0]
    said = capsys.readouterr().err
    assert said.count(str(path)) == 1 and "1 of 4 records left out" in said


def test_runs_of_an_earlier_sweep_file_are_left_out_and_named(tmp_path, capsys):
    write_set(tmp_path / "strip")
    names = sorted(path.parent.name for path in (tmp_path / "strip").glob("*/run.json"))
    cases = [{"folder": name, "label": name, "config_id": "0" * 64, "swept": {}} for name in names if name != "log"]
    assert len(load(tmp_path).runs) == len(names) > 2 and "no case" not in capsys.readouterr().err
    (tmp_path / "strip/cases.json").write_text(json.dumps({"schema": "barrierbench.cases/1", "sweep": "strip", "cases": cases}))
    assert sorted(load(tmp_path).runs["run"]) == sorted(f"strip/{case['folder']}" for case in cases)
    assert capsys.readouterr().err.count(f"{tmp_path / 'strip/log'}: no case of its sweep as it is now; left out") == 1


def test_runs_of_a_sweep_stand_in_the_order_of_its_cases_whenever_they_ran(tmp_path):
    write_set(tmp_path / "strip")
    names = sorted((path.parent.name for path in (tmp_path / "strip").glob("*/run.json")), reverse=True)
    for second, name in enumerate(reversed(names)):
        path = tmp_path / "strip" / name / "run.json"
        record = json.loads(path.read_text())
        record["status"]["started_utc"] = f"2024-01-31T12:00:0{second}Z"
        path.write_text(json.dumps(record))
    assert list(load(tmp_path).runs["folder"]) == names[::-1]  # of no sweep: as they began
    cases = [{"folder": name, "label": name, "config_id": "0" * 64, "swept": {}} for name in names]
    (tmp_path / "strip/cases.json").write_text(json.dumps({"schema": "barrierbench.cases/1", "sweep": "strip", "cases": cases}))
    assert list(load(tmp_path).runs["folder"]) == names


@pytest.mark.usefixtures("unpainted")
def test_figures_end_well_beside_a_torn_record_and_not_without_any(tmp_path, capsys):
    write_set(tmp_path / "runs")
    path = tmp_path / "runs" / "cubic" / "run.json"
    path.write_text("{")
    assert figures.main([str(tmp_path / "runs"), str(tmp_path / "out")]) == 0
    said = capsys.readouterr()
    assert said.err.count(str(path)) == 1 and "1 of 4 records left out" in said.err
    assert "cubic_dynamic" in said.out and (tmp_path / "out" / "table.csv").exists()

    for other in tmp_path.rglob("run.json"):
        other.write_text("{")
    assert figures.main([str(tmp_path / "runs"), str(tmp_path / "none")]) == 2
    assert str(path) in capsys.readouterr().err


def test_a_file_that_cannot_be_written_whole_stays_what_it_was(tmp_path):
    path = tmp_path / "folder" / "file.txt"
    write_whole(path, "whole")
    with pytest.raises(UnicodeEncodeError):
        write_whole(path, "half \ud800")  # no UTF-8
    assert path.read_text() == "whole" and [p.name for p in path.parent.iterdir()] == ["file.txt"]
