"""Scenes as data: what is refused, and what configs they make."""

import json

import numpy as np
import pytest

from barrierbench_analysis.studies.catalogue import page, table
from barrierbench_analysis.studies.catalogue.entry import FOLDER, FULL, MINI, entries, names, read_entry
from barrierbench_analysis.studies.catalogue.layouts import house_of_cards, placed, row, spiral
from barrierbench_analysis.studies.catalogue.scenes import main
from barrierbench_analysis.io.errors import UserError

PAPER = (
    "belt cards codim curtain domino drape five-twist fishing-knot fitting friction-slope hang kick needle noodle ribbon roller stack"
    " trampoline trapped twist woven yarn large-twist large-five-twist large-woven jaxls-drape intersect-1 intersect-2"
    " intersect-3 two-points beam-on-wedge ball-in-funnel"
).split()


def made(tmp_path, change, name="drape"):
    data = json.loads((FOLDER / f"{name}.json").read_text())
    change(data)
    (tmp_path / f"{name}.json").write_text(json.dumps(data))
    return tmp_path


def test_every_scene_is_here_and_makes_two_configs():
    assert sorted(PAPER) == names()
    for entry in entries([]):
        mini, full = entry.config(MINI), entry.config(FULL)
        assert mini != full and "copies" not in json.dumps(mini)
        labels = [body["name"] for body in full["scene"]["bodies"]]
        assert len(labels) == len(set(labels)) > 0


@pytest.mark.parametrize("change, message", [
    (lambda d: d.update(speed=3), "#/speed: unknown"),
    (lambda d: d.pop("expect"), "#/expect: is missing"),
    (lambda d: d.update(expect=[]), "#/expect: found []; a list of at least one expectation"),
    (lambda d: d["expect"][0].pop("because"), "#/expect/0/because: is missing"),
    (lambda d: d["expect"][0].update(check="nice"), "#/expect/0/check: found 'nice'; one of no_crossing"),
    (lambda d: d["expect"][0].update(speed=1), "#/expect/0/speed: unknown"),
    (lambda d: d["expect"].append({"check": "turned", "body": "ball", "because": "b"}), "turns: is missing"),
    (lambda d: d.update(loads={}), "#/loads/contact_N: is missing"),
    (lambda d: d.update(jitter_m=0), "#/jitter_m: found 0"),
    (lambda d: d["mini"]["set"].pop("/time/steps"), "#/mini/set: /time/steps is missing, which the other size sets"),
    (lambda d: d["full"]["set"].pop("/time/steps"), "#/full/set: /time/steps is missing, which the other size sets"),
    (lambda d: d.update(name="curtain"), "#/name: found 'curtain'"),
    (lambda d: d["config"].pop("scene"), "#/config/scene: is missing"),
])
def test_a_wrong_scene_is_refused(tmp_path, change, message):
    read_entry("drape", made(tmp_path, lambda d: None))
    with pytest.raises(UserError) as told:
        read_entry("drape", made(tmp_path, change))
    assert "drape.json" in str(told.value) and message in str(told.value)


@pytest.mark.parametrize("change, message", [
    (lambda d: d["config"]["scene"]["bodies"][0]["copies"].update(layout="heap"), "copies/layout: found 'heap'; one of row"),
    (lambda d: d["config"]["scene"]["bodies"][0]["copies"].update(high=2), "copies/high: unknown"),
    (lambda d: d["config"]["scene"]["bodies"][0]["copies"].pop("step_m"), "copies/step_m: is missing"),
    (lambda d: [d[size]["set"].update({"/scene/bodies/7/mesh/n": 3}) for size in ("mini", "full")], "mini/set/scene/bodies/7/mesh/n"),
])
def test_a_scene_without_a_config_is_refused(tmp_path, change, message):
    with pytest.raises(UserError) as told:
        read_entry("drape", made(tmp_path, change)).config()
    assert message in str(told.value)


def test_an_unknown_scene_ends_with_2(capsys):
    assert main(["drapes"]) == 2 and "one of ball-in-funnel, beam-on-wedge, belt" in capsys.readouterr().err


def test_the_page_is_made_of_the_kept_numbers():
    assert page.PAGE.read_text() == page.page_of(table.read())


def kept_of(monkeypatch, tmp_path, *red: str) -> None:
    """Two scenes, one of them with a red row, and a page elsewhere."""
    scenes = {name: table.read()[name] for name in ("belt", "drape")}
    for record in (record for one in scenes.values() for record in one["rows"]):
        record["red"] = []
    scenes["drape"]["rows"][0]["red"] = list(red)
    monkeypatch.setattr(table, "read", lambda: scenes)
    monkeypatch.setattr(page, "PAGE", tmp_path / "CATALOGUE.md")


def test_without_runs_it_says_what_is_red_and_which_page_is_written(tmp_path, monkeypatch, capsys):
    kept_of(monkeypatch, tmp_path, "fell: 0.1")
    assert page.main(["--no-run"]) == 1
    *red, count, file = capsys.readouterr().out.splitlines()
    assert len(red) == 1 and red[0].startswith("drape") and "fell: 0.1" in red[0] and "9 of 10 runs of 2 scenes" in count
    assert file == str(tmp_path / "CATALOGUE.md") and (tmp_path / "CATALOGUE.md").is_file()


def test_without_runs_a_scene_of_which_nothing_is_kept_is_an_error(tmp_path, monkeypatch, capsys):
    kept_of(monkeypatch, tmp_path)
    assert page.main(["belt", "--no-run"]) == 0 and "5 of 5 runs of 1 scene end as expected" in capsys.readouterr().out
    assert page.main(["twist", "--no-run"]) == 2
    said = capsys.readouterr()
    assert said.out == "" and "nothing kept of twist: ./bench study catalogue twist" in said.err


def test_one_is_written_as_an_ordinary_config(tmp_path, capsys):
    file = tmp_path / "twist.json"
    assert main(["twist", "--write", str(file), "--full"]) == 0
    config = json.loads(file.read_text())
    assert config["schema"] == "barrierbench.config/1" and config["scene"]["bodies"][0]["mesh"]["n_along"] == 360
    assert main(["--write", str(file)]) == 2 and "one NAME" in capsys.readouterr().err


def test_places_turn_and_move_what_the_body_has_done():
    (_, second) = row(2, [0, 0, 1.0], 90)
    made = placed({"axis": [1, 0, 0], "angle_deg": 90, "translate_m": [1, 0, 0]}, second)
    assert np.allclose(made["translate_m"], [0, 1, 1])
    assert np.allclose(made["axis"], np.ones(3) / 3**0.5) and made["angle_deg"] == pytest.approx(120)


def test_the_spiral_has_the_blocks_of_the_source():
    places = [at for _, at in spiral(1000, 0.15)]
    assert len(places) == 63
    steps = [np.linalg.norm(b - a) for a, b in zip(places, places[1:])]
    assert min(steps) > 0.15 and max(steps) < 0.154


def test_a_house_has_the_cards_of_the_source_and_none_touches():
    places = list(house_of_cards(8, 0.25, 25, 1e-3))
    assert len(places) == 100
    cards = []
    for rotation, at in places:  # seen along y: a card is a segment
        half = rotation.apply([0, 0, 0.125])
        cards.append(((at - half)[[0, 2]], (at + half)[[0, 2]]))
    parts = np.linspace(0, 1, 60)[:, None]
    points = [a + parts * (b - a) for a, b in cards]
    least = min(np.linalg.norm(p[:, None] - q[None], axis=2).min() for k, p in enumerate(points) for q in points[:k])
    assert 0.0009 < least < 0.0021 and min(p[:, 1].min() for p in points) > 0.0009
