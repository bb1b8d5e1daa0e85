"""The card: every key in exactly one list; which source is whose; what the verb refuses."""

import json
from pathlib import Path

import pytest
from tests.import_scenes import sources

from barrierbench_analysis.program.imports.card import Card, leaves


def test_leaves_are_values_and_arrays_of_numbers():
    data = {"a": {"b": 1, "c/d": [1, 2]}, "e": [{"f": True}, {}], "g": []}
    assert leaves(data) == ["/a/b", "/a/c~1d", "/e/0/f", "/e/1", "/g"]


def test_a_key_keeps_its_first_note_and_none_is_passed_over(tmp_path):
    card = Card(tmp_path / "s.json", "polyfem", ["/a/b", "/a/c", "/d", "/e/x", "/e/y"])
    card.mapped("/a", "/time")
    card.changed(["/a/b", "/d"], 1, 2, "why")
    card.close([("/e/x", "not here")])
    found = card.as_json()
    assert [e["keys"] for e in found["mapped"]] == [["/a"]]
    assert [e["keys"] for e in found["changed"]] == [["/d"]]
    assert [e["keys"] for e in found["not_mapped"]] == [["/e/x"]]
    assert [e["keys"] for e in found["unknown"]] == [["/e/y"]]
    assert found["counts"] == {"mapped": 2, "changed": 1, "not_mapped": 1, "unknown": 1}
    assert "unknown to this importer: 1" in card.lines() and "  /e/y" in card.lines()


def test_stars_of_patterns_stay_within_a_part():
    card = Card(Path("x.json"), "x", ["/m/0/phi", "/m/0/q/phi", "/c~1a", "/c~1b/z"])
    card.close([("/m/*/phi", "one"), ("/c~1*", "two")])
    assert [e["keys"] for e in card.as_json()["unknown"]] == [["/m/0/q/phi"]]


@pytest.mark.parametrize("make, kind", [(sources.polyfem, "polyfem"), (sources.libuipc, "libuipc"), (sources.ppf, "ppf")])
def test_the_kind_is_found_from_the_source(imported, tmp_path, make, kind):
    (tmp_path / "source").mkdir()
    made = imported(make(tmp_path / "source"))
    assert made.card["importer"] == kind and made.unknown == []
    assert all(made.card["counts"][name] > 0 for name in ("mapped", "changed"))


def test_another_file_is_refused(refused, tmp_path):
    path = tmp_path / "other.json"
    path.write_text(json.dumps({"schema": "barrierbench.config/1"}))
    assert "other.json: found another JSON file; allowed: a scene of PolyFEM" in refused(path)
    (tmp_path / "empty").mkdir()
    assert "found a folder of 0 files; allowed:" in refused(tmp_path / "empty")
    assert "found nothing; allowed: a file or a session folder" in refused(tmp_path / "missing.json")


def test_the_output_is_a_json_file(refused, tmp_path):
    source = sources.polyfem(tmp_path)
    assert "--out: found 'x.ply'; allowed: a file that ends in .json" in refused(source, "--out", "x.ply")
    assert "--steps" in refused(source, "--steps", "0")


def test_steps_of_the_user_are_a_change(imported, tmp_path):
    made = imported(sources.polyfem(tmp_path), "--steps", "3")
    assert made.config["time"]["steps"] == 3
    assert ["/time/tend"] in [entry["keys"] for entry in made.card["changed"]]
