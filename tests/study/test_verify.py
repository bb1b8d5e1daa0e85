"""Records held against their files: a study as it was written is green, and every edit, loss and addition is reported; runs are made again."""

import json
import shutil

import pytest
from study_files import cut, edit, filmed, made

from barrierbench_analysis.studies.archives import archive_verb, held, ids, verify
from barrierbench_analysis.tables.archive import packed


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
    (("ids", "config_id"), "", "ids/config_id is empty"),
    (("ids", "run_id"), "0" * 64, "ids/run_id is"),
    (("steps",), [], "there are 0 steps"),
    (("summary", "contact_load_max_N"), None, "summary/contact_load_max_N is None"),
    (("status", "outcome"), "newton_stall", "status/outcome is newton_stall, and its check outcome_ok passed"),
    (("status", "outcome"), "penetration", "its audit has 0 obstacle_violations, 0 crossings, 0 violations"),
    (("status", "valid"), False, "status/valid is false, and of its"),
    (("validity", "valid"), False, "validity/valid is false, and of its"),
    (("validity", "checks", 0, "pass"), False, "checks"),
    (("validity", "checks"), [], "status/valid is true, and of its 0 checks 0 passed"),
    (("audit", "crossings"), 3, "status/outcome is ok, and its audit has 0 obstacle_violations, 3 crossings, 0 violations"),
    (("audit", "unproven"), 2, "status/outcome is ok, and its audit has 2 unproven"),
    (("audit", "judged"), 0, "its audit judged nothing"),
])
def test_an_edited_record_is_told(study, capsys, place, value, says):
    edit(records(study)[1], place, value)
    code, said = told(capsys, study)
    assert code == 1 and says in said and records(study)[1].parent.name in said and "edited" in said.splitlines()[-1]
    assert len(held.held_folder(study).good) == 3


def test_steps_that_are_gone_are_told_by_what_they_add_up_to(study, capsys):
    path = records(study)[1]
    edit(path, ("steps",), [])
    edit(path, ("summary", "steps"), 0)
    code, said = told(capsys, study)
    assert code == 1 and "the sum of its steps 0" in said


def test_a_penetration_that_is_called_ok_is_told_wherever_it_is_edited(study, capsys):
    """Of a record that says so everywhere, each place that is set to what a good run says contradicts the others."""
    path = records(study)[1]
    edit(path, ("audit", "crossings"), 3)
    edit(path, ("status", "outcome"), "penetration")
    good = json.loads(records(study)[0].read_text())["validity"]["checks"]
    names = [check["name"] for check in good]
    for name in ("audit_clean", "outcome_ok"):
        edit(path, ("validity", "checks", names.index(name), "pass"), False)
    edit(path, ("status", "valid"), False)
    edit(path, ("validity", "valid"), False)
    assert told(capsys, study)[0] == 0
    bad = path.read_text()
    places = [("status", "outcome"), ("status", "valid"), ("validity", "valid"), ("validity", "checks", names.index("outcome_ok"), "pass"), ("audit", "crossings")]
    for place, value in zip(places, ("ok", True, True, True, 0), strict=True):
        path.write_text(bad)
        edit(path, place, value)
        code, said = told(capsys, study)
        assert code == 1 and "edited" in said, place


def test_a_run_of_points_is_ok_with_surfaces_that_cross(study, capsys):
    path = records(study)[0]
    edit(path, ("audit", "obstacles_judge"), "points")
    edit(path, ("audit", "crossings"), 3)
    assert told(capsys, study)[0] == 0
    edit(path, ("audit", "obstacle_violations"), 1)
    code, said = told(capsys, study)
    assert code == 1 and "its audit has 1 obstacle_violations" in said


@pytest.mark.parametrize("words, files", [((), 4), (("--keep-inputs",), 5)])  # kept apart, the mesh is no frame
def test_every_frame_of_a_film_is_held(program, tmp_path, capsys, words, files):
    folder = filmed(program, tmp_path, *words)
    named = json.loads((folder / "run.json").read_text())["scene"]["mesh_sha256"]
    assert len(named) == files and sum("times.csv" in name for name in named) == 1
    code, said = told(capsys, folder)
    assert code == 0 and held.held_folder(folder).files == files + 1, said  # and its trace
    for name in named:
        file = folder / name
        text = file.read_text()
        file.write_text(text + "\n")
        code, said = told(capsys, folder)
        assert code == 1 and f"{name} has sha256" in said and said.count("has sha256") == 1, name
        file.write_text(text)


def test_a_frame_whose_hash_is_edited_too_is_not_that_of_the_config(program, tmp_path, capsys):
    folder = filmed(program, tmp_path)
    for name in ("../walk_10.obj", "../times.csv"):
        before = (folder / name).read_text(), (folder / "run.json").read_text()
        (folder / name).write_text(before[0] + "\n")
        edit(folder / "run.json", ("scene", "mesh_sha256", name), held.of_file(folder / name))
        code, said = told(capsys, folder)
        assert code == 1 and "../walk_8.obj: its sha256 in the config is not that of scene/mesh_sha256" in said and "has sha256" not in said
        (folder / name).write_text(before[0]), (folder / "run.json").write_text(before[1])
    assert told(capsys, folder)[0] == 0


def test_a_file_among_kept_inputs_that_nothing_names_is_extra(program, tmp_path, capsys):
    folder = filmed(program, tmp_path, "--keep-inputs")
    (next((folder / "inputs").glob("film-*")) / "walk_11.obj").write_text("v 0 0 0\n")
    code, said = told(capsys, folder)
    assert code == 1 and "walk_11.obj" in said and "1 extra" in said.splitlines()[-1]


def test_the_checkpoint_of_a_cut_run_is_its_own(program, tmp_path, capsys):
    run = cut(program, tmp_path)
    assert (run / "checkpoint.bin").is_file()
    assert told(capsys, tmp_path)[0] == 0
    (run / "checkpoint.txt").touch()
    code, said = told(capsys, tmp_path)
    assert code == 1 and "checkpoint.txt" in said and "checkpoint.bin" not in said


def test_inputs_outside_an_archive_are_counted_and_not_missing(program, tmp_path, capsys, built):
    """In its folder they are held as ever; the archive says when it is packed that it has them not."""
    folder = made(program, tmp_path)
    assert archive_verb.main([str(folder), str(tmp_path / "study.zip")]) == 0
    assert "1 inputs lie outside" in (said := capsys.readouterr().err) and "../patch.obj" in said and "--keep-inputs" in said
    code, said = told(capsys, tmp_path / "study.zip", "--rerun", "1")
    assert "1 inputs of 1 records lie outside the archive" in said and "missing" not in said and "reruns: 0 of 1" in said
    assert code == 1 and "nothing was judged" in said  # of the rerun
    assert told(capsys, tmp_path / "study.zip")[0] == 0
    (tmp_path / "patch.obj").unlink()
    code, said = told(capsys, folder)
    assert code == 1 and "1 missing" in said.splitlines()[-1]


def test_a_run_with_a_mesh_is_the_same_from_another_folder(program, tmp_path, capsys, built):
    """Its record names the mesh by another path."""
    code, said = told(capsys, made(program, tmp_path), "--rerun", "1")
    assert code == 0 and "1 the same to the last bit" in said


def test_an_archive_with_its_inputs_is_run_again(program, tmp_path, capsys, built):
    folder = filmed(program, tmp_path, "--keep-inputs")
    assert archive_verb.main([str(folder), str(tmp_path / "study.zip")]) == 0 and capsys.readouterr().err == ""
    code, said = told(capsys, tmp_path / "study.zip", "--rerun", "1")
    assert code == 0 and "1 the same to the last bit" in said and "outside" not in said


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
    assert code == 0 and "reruns: 2 of 2 requested: 2 the same to the last bit, 0 differ, 0 not judged" in said


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
