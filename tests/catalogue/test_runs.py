"""The verbs from end to end, on the fastest scenes; the scenes that must be rejected are."""

import json

import pytest

from barrierbench_analysis.studies.catalogue import page, robust, table
from barrierbench_analysis.studies.catalogue.counts import counts_of
from barrierbench_analysis.studies.catalogue.entry import FULL, MINI, entries, read_entry, write_config
from barrierbench_analysis.studies.catalogue.runs import run_scene
from barrierbench_analysis.studies.catalogue.scenes import main
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
    (run,) = run_scene(entry, ["log"], tmp_path)
    row = table.row_of(entry, run)
    assert row.outcome == "initial_intersection" and not row.red and not run.record["steps"]


@pytest.mark.parametrize("name", FAST)
def test_a_fast_scene_shows_what_it_expects(tmp_path, name):
    entry = read_entry(name)
    (run,) = run_scene(entry, ["cubic_dynamic_consistent"], tmp_path)
    row = table.row_of(entry, run)
    assert row.outcome == "ok" and not row.red, row.red
    assert len(row.seen) == len(entry.data["expect"])
    run.record["status"]["outcome"] = "newton_stall"
    assert table.row_of(entry, run).red == ["ends_ok: newton_stall"]


def test_every_scene_is_small_and_the_program_takes_it():
    for entry in entries([]):
        counts = counts_of(entry, MINI)
        assert 0 < counts.vertices <= 1500, entry.name


@pytest.mark.parametrize("name", ["drape", "curtain", "belt", "domino", "twist", "woven", "hang"])
def test_a_full_scene_has_the_counts_of_its_source(name):
    entry = read_entry(name)
    assert entry.data["full"]["vertices"] > 0
    assert counts_of(entry, FULL).unlike(entry.data["full"]) == ""


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


def short(name):
    """The scene without its end."""
    entry = read_entry(name)
    entry.data["mini"]["set"]["/time/steps"] = 25
    return entry


def test_jittered_starts_pass_and_are_kept(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(robust, "entries", lambda names: [short(name) for name in names])
    monkeypatch.setattr(robust, "FILE", tmp_path / "robust.json")
    monkeypatch.setattr(robust, "write", lambda scenes, write=robust.write: write(scenes, tmp_path / "robust.json"))
    asked = ["domino", "intersect-2", "--seeds", "2", "--formulations", "log", "--runs", str(tmp_path / "runs")]
    assert robust.main(asked) == 0
    assert capsys.readouterr().out.count("2/2") == 2
    kept = json.loads((tmp_path / "robust.json").read_text())["scenes"]["domino"][0]
    assert kept["passed"] == kept["seeds"] == 2 and kept["jitter_m"] > 0
    starts = {json.loads(file.read_text())["summary"]["state_hash"] for file in (tmp_path / "runs" / "domino").glob("*/run.json")}
    assert len(starts) == 2  # the seeds differ
    assert robust.main([]) == 2 and robust.main(["domino", "--all"]) == 2


def test_settings_of_all_runs_are_taken_and_their_table_is_not_kept(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(robust, "entries", lambda names: [short(name) for name in names])
    monkeypatch.setattr(robust, "write", lambda *_: pytest.fail("kept"))
    asked = ["domino", "--seeds", "1", "--formulations", "log", "--runs", str(tmp_path / "runs"), "--set", "/time/steps=3", "--set", '/device="host"']
    assert robust.main(asked) == 0
    assert "1/1" in capsys.readouterr().out
    (record,) = (json.loads(file.read_text()) for file in (tmp_path / "runs" / "domino").glob("*/run.json"))
    assert record["config"]["time"]["steps"] == 3 and record["config"]["device"] == "host"
    for wrong in ("/device", "device=1", "/device=cuda"):
        assert robust.main(["domino", "--set", wrong]) == 2
        assert f"--set {wrong}: " in capsys.readouterr().err


def test_a_seed_that_fails_fails_the_scene(tmp_path):
    entry = short("domino")
    (run,) = run_scene(entry, ["log"], tmp_path, [1])
    assert robust.failure(entry, run) == ""
    run.record["audit"]["crossings"] = 1
    assert "1 crossings" in robust.failure(entry, run)
    run.record["status"] |= {"outcome": "newton_stall"}
    assert robust.rows_of(entry, [run])[0]["passed"] == 0


def test_the_page_has_outcomes_and_what_is_red(tmp_path, monkeypatch):
    entry = read_entry("intersect-2")
    (run,) = run_scene(entry, ["log"], tmp_path)
    kept = {"intersect-2": table.kept_of(entry, [run], None)}
    table.write(kept, tmp_path / "catalogue.json")
    assert table.read(tmp_path / "catalogue.json") == kept
    page.write_page(kept, tmp_path / "page.md")
    text = (tmp_path / "page.md").read_text()
    assert "| intersect-2 |" in text and "initial_intersection" in text and "Nothing." in text
    kept["intersect-2"]["rows"][0]["red"] = ["rejected: it made 3 steps"]
    page.write_page(kept, tmp_path / "page.md")
    assert "red: rejected**" in (tmp_path / "page.md").read_text()
