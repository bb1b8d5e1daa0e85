"""Kept runs that no longer count are counted and named, by the call that refuses them and on the page."""

import copy

import pytest

from analysis.gap_map import entry, kept, report, table
from analysis.gap_map.spec import read_spec
from analysis.places import ROOT
from analysis.record_file import OURS

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
    assert len(entry.counted_rows(tmp_path / "gap_map.json", spec)) == of_now.about["runs"] and capsys.readouterr().err == ""
    page = report.markdown(of_now)
    assert "`./bench gap-map` goes on" in page and "no longer counts" not in page


@pytest.mark.parametrize(("change", "said"), [
    (lambda about: about["places"].update({"ball-7": "another"}), "171 whose settings, meshes or base config have changed since (ball 7)"),
    (lambda about: about["shapes"].update(cubic=["cubic", "squared_gap"]), "whose shape the spec has no more or gives otherwise (cubic)"),
    (lambda about: about["sources"][0].update(version="3.5.0"), "with records 3.5.0, in which 16 fields mean something else than in records from 3.6.0, 3.7.0 on"),
])
def test_what_is_refused_is_said_with_its_reason(spec, of_now, change, said, tmp_path, capsys):
    change(of_now.about)
    sorted_out = kept.sort_out(of_now, spec)
    refused, runs = sum(sorted_out.refused.values()), of_now.about["runs"]
    assert 0 < refused < runs and len(sorted_out.counted) == runs - refused and len(sorted_out.refused) == 1
    assert said in sorted_out.why and sorted_out.why.startswith(f"{refused} of {runs} kept runs: ")
    table.write(of_now, tmp_path / "gap_map.json")
    assert len(entry.counted_rows(tmp_path / "gap_map.json", spec)) == runs - refused
    assert capsys.readouterr().err == f"gap-map: {tmp_path / 'gap_map.json'} has runs that do not count for {spec.path}: {sorted_out.why}\n"
    page = report.markdown(of_now, sorted_out.why)
    assert f"it refuses, and runs again, {sorted_out.why}. " in page and "`./bench gap-map` goes on" not in page and "are those of now" not in page


def test_a_place_that_the_spec_has_no_more_is_a_reason_too(spec, of_now):
    of_now.rows[0].update(scene="gone", source=0)
    assert "1 of a place that the spec has no more (gone " in kept.sort_out(of_now, spec).why


def test_the_page_says_it_of_the_runs_that_are_kept(spec):
    found = table.read(KEPT)
    assert report.markdown(found, kept.sort_out(found, spec).why) == (ROOT / "results/GAP_MAP.md").read_text()
