"""The full sizes of the scenes beside the counts that their sources publish, and the page of them."""

import copy

import pytest

from barrierbench_analysis.studies.catalogue import sizes
from barrierbench_analysis.studies.catalogue.entry import FULL, entries, read_entry
from barrierbench_analysis.studies.catalogue.scenes import main

SMALL = ("cards", "domino", "friction-slope", "roller", "jaxls-drape", "trampoline", "two-points")


def test_every_published_count_is_met_or_has_a_reason():
    kept, own = sizes.read(), entries([])
    assert {entry.name for entry in own} == set(kept)
    assert [sizes.complaint(entry, kept[entry.name]) for entry in own] == [""] * len(own)
    ratios = [ratio for entry in own for ratio in sizes.ratios(entry, kept[entry.name]).values()]
    assert len(ratios) > 50 and sum(abs(ratio - 1) <= sizes.WITHIN for ratio in ratios) > 45
    vertices = [sizes.ratios(entry, kept[entry.name]).get("vertices") for entry in own]
    assert all(ratio is None or abs(ratio - 1) <= sizes.WITHIN for ratio in vertices) and sum(ratio is not None for ratio in vertices) == 25


def test_the_page_is_made_of_the_kept_counts():
    assert sizes.PAGE.read_text() == sizes.page()
    text = sizes.PAGE.read_text()
    assert "| roller | 6,172 of 6,200: 0.995 |" in text and "**19,440 of 73,600: 0.264**" in text and "armadillo" in text


def test_small_scenes_have_the_counts_that_are_kept(program, monkeypatch):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    assert sizes.built([read_entry(name) for name in SMALL]) == {name: sizes.read()[name] for name in SMALL}


def test_a_large_scene_is_not_built():
    entry = read_entry("large-five-twist")
    assert sizes.built([entry])[entry.name] == {kind: entry.data[FULL][kind] for kind in ("vertices", "faces")}


@pytest.mark.parametrize("change, own, says", [
    (lambda d: None, {"vertices": 100, "faces": 212}, ""),
    (lambda d: None, {"vertices": 100, "faces": 300}, "faces are 1.5 times those of the source, without `because`"),
    (lambda d: None, {"vertices": 100}, "faces are 0 times"),
    (lambda d: d.update(because="of a reason"), {"vertices": 100, "faces": 300}, ""),
    (lambda d: d.update(because="of a reason"), {"vertices": 100, "faces": 200}, "because: every count is within"),
])
def test_a_count_that_is_off_needs_a_reason(change, own, says):
    entry = copy.deepcopy(read_entry("drape"))
    entry.data["source_counts"] = {"of": "a source", "vertices": 100, "faces": 200}
    change(entry.data["source_counts"])
    said = sizes.complaint(entry, own)
    assert says in said and bool(said) == bool(says)


def test_sizes_are_of_all_scenes(capsys):
    assert main(["drape", "--sizes"]) == 2 and "all scenes" in capsys.readouterr().err
