"""The verbs from end to end, on the fastest scenes; the scenes that must be rejected are."""

import json

import pytest
from own_spec import run, written

from barrierbench_analysis.studies.catalogue.counts import counts_of, unlike
from barrierbench_analysis.studies.catalogue.entry import FULL, MINI, entries, read_entry, write_config
from barrierbench_analysis.studies.catalogue.scenes import main
from barrierbench_analysis.studies.kit.study import collect, page, verb
from barrierbench_analysis.studies.rules import catalogue
from barrierbench_analysis.program.start import started

REJECTED = {"intersect-1": "crosses triangle ball", "intersect-2": "left", "intersect-3": "crosses triangle torus"}
FAST = ("domino", "friction-slope")


@pytest.fixture(autouse=True)
def built(program, monkeypatch):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)


@pytest.mark.parametrize("name", REJECTED)
def test_a_scene_that_crosses_itself_is_rejected(tmp_path, name):
    entry = read_entry(name)
    assert entry.is_rejected
    write_config(entry, tmp_path / "scene.json")
    done = started("check", str(tmp_path / "scene.json"))
    assert done.returncode == 2 and REJECTED[name] in done.stderr and "a start without intersections" in done.stderr
    (row,), (folder,) = run(written(tmp_path, "catalogue", [name]))
    assert row.outcome == "initial_intersection" and not row.values["red"] and row.values["detail"]
    assert not json.loads((folder / "run.json").read_text())["steps"]


@pytest.mark.parametrize("name", FAST)
def test_a_fast_scene_shows_what_it_expects(tmp_path, name):
    study = written(tmp_path, "catalogue", [name], ["cubic_dynamic_consistent"])
    (row,), (folder,) = run(study)
    assert row.outcome == "ok" and not row.values["red"], row
    assert len(row.values["seen"]) == len(read_entry(name).data["expect"])
    record = json.loads((folder / "run.json").read_text())
    record["status"]["outcome"] = "newton_stall"
    assert catalogue.measure(study, study.cells[0], record)["red"] == ["ends_ok: newton_stall"]


def test_every_scene_is_small_and_the_program_takes_it():
    for entry in entries([]):
        counts = counts_of(entry, MINI)
        assert 0 < counts["vertices"] <= 1500, entry.name


@pytest.mark.parametrize("name", ["drape", "curtain", "belt", "domino", "twist", "woven", "hang"])
def test_a_full_scene_has_the_counts_of_its_source(name):
    entry = read_entry(name)
    assert entry.data["full"]["vertices"] > 0
    assert unlike(counts_of(entry, FULL), entry.data["full"]) == ""


def test_a_count_that_is_not_the_stated_one_is_told(capsys, monkeypatch):
    from barrierbench_analysis.studies.catalogue import scenes

    def other(names):
        entry = read_entry("jaxls-drape")
        entry.data["full"]["vertices"] = 226
        return [entry]
    monkeypatch.setattr(scenes, "entries", other)
    assert main(["jaxls-drape"]) == 1
    told = capsys.readouterr().out
    assert "225/392" in told and "vertices 225, stated 226" in told and "expects   fell (share 0.2)" in told


SHORT = {"/time/steps": 25}  # without its end


def test_jittered_starts_pass_and_are_kept(tmp_path, capsys):
    study = written(tmp_path, "robust", ["domino", "intersect-2"], seeds=[1, 2], **SHORT)
    assert verb.main([str(study.file), "--out", str(tmp_path)]) == 0
    assert capsys.readouterr().out.count("2/2") == 2
    assert "| domino | log | 2 of 2 | 5e-05 | |" in study.page.read_text() and "4 runs of 2 of 32 scenes" in study.page.read_text()
    assert {row.outcome for row in page.rows_of(study)} == {"ok", "initial_intersection"}
    starts = {json.loads(file.read_text())["summary"]["state_hash"] for file in (tmp_path / "runs").glob("*/domino*/run.json")}
    assert len(starts) == 2  # the seeds differ


def test_settings_of_a_spec_are_taken_in_every_run(tmp_path):
    """Also where a scene has the section of a setting."""
    _, (folder,) = run(written(tmp_path, "robust", ["domino"], seeds=[1], **{"/time/steps": 3, "/device": "host"}))
    record = json.loads((folder / "run.json").read_text())
    assert record["config"]["time"]["steps"] == 3 and record["config"]["device"] == "host"
    assert record["config"]["time"]["dt_s"] == read_entry("domino").config()["time"]["dt_s"]
    assert record["config"]["seeds"]["jitter_m"] == read_entry("domino").data["jitter_m"]


def test_the_run_of_a_cell_is_that_of_the_config_of_the_scene(tmp_path):
    (row,), _ = run(written(tmp_path, "catalogue", ["two-points"], **{"/time/steps": 3}))
    write_config(read_entry("two-points"), tmp_path / "scene.json")
    given = [f"/{key}={json.dumps(value)}" for key, value in {"time/steps": 3, "passes": {"time": False, "diagnose": False, "audit": True}, "output/frames_every": 1000000}.items()]
    words = [word for setting in given for word in ("--set", setting)]
    assert started("run", str(tmp_path / "scene.json"), "--out", str(tmp_path / "alone"), *words).returncode == 0
    assert json.loads((tmp_path / "alone/run.json").read_text())["ids"]["run_id"].startswith(row.run)


def test_the_picture_is_of_the_runs_whose_records_are_there(tmp_path):
    study = written(tmp_path, "catalogue", ["intersect-2", "two-points"], **{"/time/steps": 3})
    assert catalogue.draw(study, [], {}, tmp_path) == []
    collect.run_cells(study, study.cells)
    (file,) = catalogue.draw(study, [], {}, tmp_path)
    assert file == tmp_path / "mine.png" and file.stat().st_size > 1000
