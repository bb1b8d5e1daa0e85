"""Records held against their files: a study as it was written is green, and every edit, loss and addition is told; runs are made again."""

import json
import shutil

import pytest
from study_files import edit, made

from analysis.study import held, ids, verify
from analysis.study.archive import packed


@pytest.fixture
def study(kept_study, tmp_path):
    return shutil.copytree(kept_study, tmp_path / "study")


def told(capsys, *words) -> tuple[int, str]:
    code = verify.main([str(word) for word in words])
    return code, capsys.readouterr().out


def records(study):
    return sorted(study.glob("*/run.json"))


def test_a_study_as_it_was_written_has_nothing_wrong(study, capsys):
    code, said = told(capsys, study)
    found = held.held_folder(study)
    assert code == 0 and "verify: nothing wrong" in said
    assert found.records == found.cases == 4 and found.ids == 8 and found.files >= 4 and found.sums > 40 and len(found.good) == 4
    assert f"4 records with {found.files} files, 8 ids and {found.sums} numbers of summaries; 4 cases" in said


@pytest.mark.parametrize("place, value, says", [
    (("config", "time", "dt_s"), 0.25, "ids/config_id is"),
    (("provenance", "threads"), 7, "ids/run_id is"),
    (("summary", "newton_iterations"), 1, "summary/newton_iterations is 1, the sum of its steps"),
    (("summary", "contact_load_max_N"), 1e9, "the max of its steps"),
    (("ids", "build_id"), "0" * 64, "ids/run_id is"),
    (("status", "outcome"), "fine", "status/outcome"),
])
def test_an_edited_record_is_told(study, capsys, place, value, says):
    edit(records(study)[1], place, value)
    code, said = told(capsys, study)
    assert code == 1 and says in said and records(study)[1].parent.name in said and "edited" in said.splitlines()[-1]
    assert len(held.held_folder(study).good) == 3


def test_lost_extra_and_edited_files_are_told(study, capsys):
    one, two, three, four = records(study)
    (one.parent / "trace.jsonl").unlink()
    (two.parent / "notes.txt").write_text("mine")
    (three.parent / "trace.jsonl").write_text((three.parent / "trace.jsonl").read_text().replace("1", "2", 1))
    shutil.copytree(four.parent, study / "another")
    code, said = told(capsys, study)
    assert code == 1 and "trace.jsonl, which it names, is not there" in said and "notes.txt" in said and "trace.jsonl has sha256" in said
    assert "another/run.json" in said and "no case of the sweep" in said
    assert "1 edited, 2 extra, 1 missing" in said.splitlines()[-1]


def test_a_lost_record_is_told(study, capsys):
    shutil.rmtree(records(study)[0].parent)
    code, said = told(capsys, study)
    assert code == 1 and "the record of the case" in said and "1 missing" in said


def test_an_empty_folder_and_none_are_not_green(tmp_path, capsys):
    (tmp_path / "empty").mkdir()
    code, said = told(capsys, tmp_path / "empty")
    assert code == 1 and "nothing was judged" in said and "judged: 0 records" in said
    assert verify.main([str(tmp_path / "nowhere")]) == 2 and "no such folder" in capsys.readouterr().err


def test_reruns_are_the_same_to_the_last_bit(study, capsys, built):
    code, said = told(capsys, study, "--rerun", "2", "--seed", "3")
    assert code == 0 and "reruns: 2 of 2 asked for: 2 the same to the last bit, 0 differ, 0 not judged" in said


def test_a_rerun_tells_a_number_that_no_sum_knows(study, capsys, built):
    for record in records(study):
        edit(record, ("summary", "gap_min_m"), 1e-7)
    assert told(capsys, study)[0] == 0  # unseen without a rerun
    code, said = told(capsys, study, "--rerun", "1")
    assert code == 1 and "1 rerun differs" in said and "/summary/gap_min_m is 1e-07 and" in said and "more" not in said


def test_a_rerun_of_nothing_is_red(study, capsys, built):
    for record in records(study):
        (record.parent / "trace.jsonl").unlink()
    code, said = told(capsys, study, "--rerun", "3")
    assert code == 1 and "reruns: 0 of 3" in said and "red: nothing was judged" in said


def test_a_run_of_another_build_is_not_judged(study, capsys, built):
    for record in records(study):
        edit(record, ("ids", "build_id"), "0" * 64)
        edit(record, ("ids", "run_id"), ids.of_record(record)[1])
    code, said = told(capsys, study, "--rerun", "1")
    assert code == 1 and "1 not judged" in said and "another build or machine" in said


def test_a_folder_is_held_against_its_archive_to_the_byte(study, capsys, tmp_path):
    packed(study, tmp_path / "study.zip")
    code, said = told(capsys, study, "--archive", tmp_path / "study.zip")
    assert code == 0 and " 0 files against" not in said
    edit(records(study)[0], ("summary", "gap_min_m"), 1e-7)
    (study / "later.txt").write_text("x")
    (study / "cases.json").rename(tmp_path / "cases.json")
    code, said = told(capsys, study, "--archive", tmp_path / "study.zip")
    assert code == 1 and "1 edited, 1 extra, 1 missing" in said.splitlines()[-1]
    assert verify.main([str(tmp_path / "study.zip"), "--archive", str(tmp_path / "study.zip")]) == 2


def test_an_archive_is_verified_as_its_folder(study, capsys, tmp_path):
    packed(study, tmp_path / "study.zip")
    code, said = told(capsys, tmp_path / "study.zip")
    assert code == 0 and "judged: 4 records" in said


def test_ids_are_those_of_the_program(kept_study):
    for path in sorted(kept_study.glob("*/run.json")):
        record = json.loads(path.read_text())
        assert ids.of_record(path) == (record["ids"]["config_id"], record["ids"]["run_id"])


def test_a_config_with_a_mesh_keeps_its_id_wherever_the_mesh_lies(program, tmp_path):
    folder = made(program, tmp_path)
    record = json.loads((folder / "run.json").read_text())
    assert ids.of_record(folder / "run.json")[0] == record["ids"]["config_id"] and "patch.obj" in json.dumps(record["config"])
    assert held.held_folder(folder).wrong == [] and held.held_folder(folder).files >= 2
    (tmp_path / "patch.obj").write_text("v 0 0 0\n")
    assert any("patch.obj has sha256" in found for _, _, found in held.held_folder(folder).wrong)
