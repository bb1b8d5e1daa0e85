"""Scenes as data: what is refused, and what configs they make."""

import json
from dataclasses import replace

import numpy as np
import pytest
from own_spec import written

from barrierbench_analysis.studies.kit.study import page
from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.rules import catalogue
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


def kept(scenes, *red):
    """The kept rows of these scenes, the first one of the last scene with these red checks."""
    study = read_study("catalogue")
    rows = [row for row in page.rows_of(study) if row.place["scene"] in scenes]
    rows = [replace(row, values={**row.values, "red": []}) for row in rows]
    at = [row.place["scene"] for row in rows].index(scenes[-1])
    rows[at] = replace(rows[at], values={**rows[at].values, "red": list(red)})
    return study, rows


def test_a_call_says_what_is_red_of_its_runs():
    lines, passed = catalogue.judged(*kept(["belt", "drape"], "fell: 0.1"))
    assert not passed and lines[-1] == "9 of 10 runs of 2 scenes end as expected" and len(lines) == 11
    (red,) = (line for line in lines if "fell: 0.1" in line)
    assert red.startswith("drape") and sum("as expected" in line for line in lines[:-1]) == 9
    lines, passed = catalogue.judged(*kept(["belt"]))
    assert passed and lines[-1] == "5 of 5 runs of 1 scene end as expected"
    study = read_study("catalogue")
    lines, passed = catalogue.judged(study, page.rows_of(study))  # of all, those that are red alone
    assert not passed and len(lines) == 160 - 149 + 1 and lines[-1].startswith("149 of 160 runs of 32 scenes")


def test_the_page_has_outcomes_and_what_is_red():
    study, rows = kept(["belt", "intersect-2"])
    numbers = catalogue.rule(study, rows)
    assert numbers["red"] == "Nothing." and numbers["expected"] == numbers["runs"] == 10 and numbers["scenes"] == 2
    assert "| intersect-2 | 288/484 | initial_intersection, 0.2 s |" in numbers["outcomes"]
    numbers = catalogue.rule(*kept(["belt", "intersect-2"], "rejected: it made 3 steps"))
    assert "red: rejected** |" in numbers["outcomes"] and "| intersect-2 | log | initial_intersection | rejected: it made 3 steps |" in numbers["red"]
    assert "| intersect-2 | - |" not in numbers["outcomes"]
    without = catalogue.rule(study, [row for row in rows if (row.place["scene"], row.place["formulation"]) != ("belt", "cubic")])
    assert "s | - | ok" in without["outcomes"] and "### belt: " in without["described"]


def test_a_scene_that_is_not_there_is_refused_where_a_spec_names_it(tmp_path):
    with pytest.raises(UserError, match="scene 'drapes': one of ball-in-funnel, beam-on-wedge, belt"):
        _ = written(tmp_path, "catalogue", ["drapes"]).cells


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


def test_a_scene_that_expects_something_else_makes_other_cells(tmp_path, monkeypatch):
    """A kept verdict is one on the expectations of its day."""
    from barrierbench_analysis.studies.catalogue import cells as mini
    from barrierbench_analysis.studies.catalogue.entry import Entry, read_entry

    study = written(tmp_path / "a", "catalogue", ["drape"])
    before = [cell.key for cell in study.cells]
    entry = read_entry("drape")
    other = Entry(entry.path, {**entry.data, "expect": entry.data["expect"][:1]})
    monkeypatch.setattr(mini, "entries", lambda names: [other])
    assert before and not set(before) & {cell.key for cell in written(tmp_path / "b", "catalogue", ["drape"]).cells}
