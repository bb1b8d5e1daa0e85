"""./bench study compare-toolkit on small sheets: both codes answer alike, the table and the JSON hold every stage, and a
disagreement is an error. Nothing here is about time."""

import json
import re
import subprocess

import pytest
from barrierbench_analysis.studies.toolkit import compare_toolkit

pytest.importorskip("ipctk", reason="the toolkit (Python package ipctk) is not installed")


@pytest.fixture()
def stages(build_folder):
    path = build_folder / "experiments" / "microbenchmarks" / "contact_stages"
    if not path.exists():
        pytest.skip(f"{path} is not built")
    return path


def run(stages, tmp_path, *more):
    return compare_toolkit.main(["--size", "12", "--rounds", "2", "--out", str(tmp_path), "--program", str(stages),
                                 *more])


def test_table_and_record_hold_every_stage(stages, tmp_path, capsys):
    assert run(stages, tmp_path, "--mesh", "sheets") == 0
    text = capsys.readouterr().out
    assert len(re.findall(r"\| [0-9.]+x \|", text)) == len(compare_toolkit.STAGES) == 7
    (path,) = tmp_path.glob("*.json")
    record = json.loads(path.read_text())
    table = {row["stage"]: row for row in record["table"]}
    assert list(table) == list(compare_toolkit.STAGES)
    for stage, row in table.items():
        assert row["ratio"] == pytest.approx(row["toolkit_s"] / row["ours_s"]) and row["ratio"] > 0
        assert row["ours_items"] > 0 and row["toolkit_items"] > 0
        for side in ("ours", "toolkit"):
            assert len(record["answers"][stage][side]) == record["rounds"] == 2
    assert table["rows"]["ours_items"] == table["rows"]["toolkit_items"] > 500
    assert table["energies"]["ours_value"] == pytest.approx(table["energies"]["toolkit_value"], rel=1e-12)
    assert 0 < table["step_bound"]["ours_value"] == table["motion_to_bound"]["ours_value"] < 1


def test_without_the_data_folder_it_says_so_and_takes_sheets(stages, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(compare_toolkit, "DATA", tmp_path / "nothing")
    assert run(stages, tmp_path) == 0
    captured = capsys.readouterr()
    assert "no cloth_ball92.ply" in captured.err and "BARRIERBENCH_DATA" in captured.err
    assert "three sheets of 13^2" in captured.out


def test_codes_that_disagree_are_an_error():
    rows = {"stage": "rows", "items": 10, "value": 0}
    assert compare_toolkit.disagreement(rows, dict(rows)) is None
    assert "toolkit 11" in compare_toolkit.disagreement(rows, {**rows, "items": 11})
    energy = {"stage": "energies", "items": 10, "value": 1.0}
    assert compare_toolkit.disagreement(energy, {**energy, "value": 1 + 1e-10}) is None
    assert compare_toolkit.disagreement(energy, {**energy, "value": 1.001})
    bound = {"stage": "step_bound", "items": 10, "value": 0.5}
    assert compare_toolkit.disagreement(bound, {**bound, "value": 0.55}) is None
    assert compare_toolkit.disagreement(bound, {**bound, "value": 0.9})
    assert compare_toolkit.disagreement({**bound, "value": 1.1}, {**bound, "value": 1.0})


@pytest.mark.parametrize("arguments", [["PROBLEM", "0"], ["/nowhere", "1"], []])
def test_stages_program_names_what_is_wrong(stages, arguments):
    answer = subprocess.run([stages, *arguments], capture_output=True, text=True, input="")
    assert answer.returncode == 2 and "contact_stages" in answer.stderr
