"""Kept runs that no longer count are counted and named, by the call that refuses them and on the page."""

import copy
import json
import re

import pytest

from barrierbench_analysis.io import fields
from barrierbench_analysis.studies.gap_map import entry, kept, report, rows, table
from barrierbench_analysis.studies.gap_map.spec import read_spec
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.record_file import OURS

KEPT = ROOT / "results/gap_map.json"


@pytest.fixture(scope="module")
def spec():
    return read_spec(entry.DEFAULT)


@pytest.fixture
def of_now(spec):
    """The kept map, as if this program had made it."""
    found = copy.deepcopy(table.read(KEPT))
    found.about["places"] = {"-".join(place): digest for place, digest in kept.digests(spec).items()}
    for source in found.about["sources"]:
        source["version"] = ".".join(map(str, OURS))
    return found


def test_runs_of_now_count_and_nothing_is_said(spec, of_now, tmp_path, capsys):
    sorted_out = kept.sort_out(of_now, spec)
    assert len(sorted_out.counted) == of_now.about["runs"] > 2000 and sorted_out.refused == {} and sorted_out.why == ""
    table.write(of_now, tmp_path / "gap_map.json")
    assert len(entry.told_rows(tmp_path / "gap_map.json", spec).counted) == of_now.about["runs"] and capsys.readouterr().err == ""
    page = report.markdown(of_now)
    assert "`./bench study gap-map` goes on" in page and "no longer counts" not in page


@pytest.mark.parametrize(("change", "said"), [
    (lambda about: about["places"].update({"ball-7": "another"}), "171 whose settings, meshes or base config have changed since (ball 7)"),
    (lambda about: about["shapes"].update(cubic=["cubic", "squared_gap"]), "whose shape the spec has no more or gives otherwise (cubic)"),
    (lambda about: about["sources"][0].update(version="3.5.0"), "with records 3.5.0, in which 16 fields mean something else than in records from 3.6.0, 3.7.0 on; of these fields the map reads `trace contacts`"),
])
def test_what_is_refused_is_said_with_its_reason(spec, of_now, change, said, tmp_path, capsys):
    change(of_now.about)
    sorted_out = kept.sort_out(of_now, spec)
    refused, runs = sum(map(len, sorted_out.refused.values())), of_now.about["runs"]
    assert 0 < refused < runs and len(sorted_out.counted) == runs - refused and len(sorted_out.refused) == 1
    assert said in sorted_out.why and sorted_out.why.startswith(f"{refused} of {runs} kept runs: ")
    table.write(of_now, tmp_path / "gap_map.json")
    assert len(entry.told_rows(tmp_path / "gap_map.json", spec).counted) == runs - refused
    assert capsys.readouterr().err == f"gap-map: {tmp_path / 'gap_map.json'} has runs that do not count for {spec.path}: {sorted_out.why}\n"
    page = report.markdown(of_now, sorted_out)
    assert f"**A call that collects runs no longer counts all of these**: it refuses {sorted_out.why}. " in page and "`./bench study gap-map` goes on" not in page and "are those of now" not in page


def test_a_place_that_the_spec_has_no_more_is_a_reason_too(spec, of_now):
    of_now.rows[0].update(scene="gone", source=0)
    assert "1 of a place that the spec has no more (gone " in kept.sort_out(of_now, spec).why


def test_the_page_says_it_of_the_runs_that_are_kept(spec):
    found = table.read(KEPT)
    assert report.markdown(found, kept.sort_out(found, spec)) == (ROOT / "results/GAP_MAP.md").read_text()


@pytest.fixture
def partly(of_now, tmp_path, monkeypatch):
    """A folder with a kept map of which some runs do not count, what it has, and the words of a call on it; nothing is drawn, and no program asked."""
    of_now.about["sources"][0].update(version="3.5.0")
    table.write(of_now, tmp_path / "gap_map.json")
    monkeypatch.setattr(entry.figure, "draw_all", lambda *_: [])
    monkeypatch.setattr(entry, "cannot_reach", lambda _: {(r["shape"], r["theta"]) for r in of_now.rows if r["outcome"] == "cannot reach"})
    monkeypatch.setattr(entry, "add_rho", lambda *_: None)
    return tmp_path, (tmp_path / "gap_map.json").read_bytes(), ["--results", str(tmp_path), "--runs", str(tmp_path / "runs")]


@pytest.mark.parametrize("there", ["nothing", "a folder", "an empty place", "figures"])
def test_the_page_is_written_anew_without_losing_a_run(partly, spec, there):
    """And it says which of them another call would refuse."""
    folder, before, words = partly
    if there != "nothing":
        (folder / "runs" / {"a folder": "", "an empty place": "cloth-8-0/x", "figures": "figures"}[there]).mkdir(parents=True)
    assert entry.main(["--no-run", *words]) == 0 and (folder / "gap_map.json").read_bytes() == before
    sorted_out = kept.sort_out(table.read(folder / "gap_map.json"), spec)
    page = (folder / "GAP_MAP.md").read_text()
    assert f"**A call that collects runs no longer counts all of these**: it refuses {sorted_out.why}. " in page and "1252 with records 3.5.0" in sorted_out.why


@pytest.mark.parametrize("words", [[], ["--quick"], ["--anew"], ["--no-run"]])
def test_a_call_that_would_lose_runs_is_refused_before_it_runs_any(partly, monkeypatch, capsys, words):
    folder, before, common = partly
    monkeypatch.setattr(entry, "run_missing", None)
    monkeypatch.setattr(entry, "records_in", lambda folders: {})
    (folder / "runs/cloth-8-0/x").mkdir(parents=True), (folder / "runs/cloth-8-0/x/run.json").write_text("{}")
    assert entry.main([*words, *common]) == 2 and (folder / "gap_map.json").read_bytes() == before
    assert "gap_map.json: found 2325 runs, of which 1252 would be gone" in capsys.readouterr().err
    if words == ["--no-run"]:
        assert entry.main([*words, *common, "--drop"]) == 0 and table.read(folder / "gap_map.json").about["runs"] == 1073


def test_runs_of_a_target_that_the_spec_has_no_more_are_not_lost_either(partly, spec, monkeypatch, capsys):
    """They count, and no cell asks for them."""
    folder, before, common = partly
    text = (entry.DEFAULT).read_text().replace("0.5, 0.25, 0.1, 0.05, 0.02,", "0.5, 0.25, 0.1, 0.05,").replace("../scenes/", f"{ROOT}/configs/scenes/")
    (folder / "fewer.json").write_text(text)
    table_now = table.read(folder / "gap_map.json")
    table_now.about["sources"][0].update(version=".".join(map(str, OURS)))
    table.write(table_now, folder / "gap_map.json")
    before = (folder / "gap_map.json").read_bytes()
    monkeypatch.setattr(entry, "run_missing", None)
    assert entry.main([str(folder / "fewer.json"), *common]) == 2 and (folder / "gap_map.json").read_bytes() == before
    lost = sum(r["theta"] == 0.02 and r["source"] is not None for r in table_now.rows)
    assert lost > 100 and f"of which {lost} would be gone" in capsys.readouterr().err


def test_where_none_counts_the_page_says_none(spec, of_now):
    for source in of_now.about["sources"]:
        source["version"] = "3.5.0"
    page = report.markdown(of_now, kept.sort_out(of_now, spec))
    assert "**A call that collects runs counts none of these**: it refuses 2325 of 2325 kept runs" in page and "no longer counts" not in page


def test_fields_that_the_map_reads_are_fields_of_records():
    """Of the run's the schema has each; so a name that is spelled otherwise is told."""
    run, trace = fields.schema("run"), fields.schema("trace")
    names = {*re.findall(r'"([a-z_A-Z]+)":', json.dumps([run, trace]))}
    assert len(names) > 100
    for field in rows.READ:
        assert set(re.split(r"[. ]|\[\]\.?", field.removeprefix("trace "))) - {""} <= names, field
