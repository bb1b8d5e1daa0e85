"""`bench engine compare --starts`: jittered starts are the same for all, what is dear is left out, scatter is counted and drawn."""

import dataclasses
import json

import numpy as np
import pytest
from test_engines_of_others import HANG

from barrierbench_analysis.studies.engines import compare, figure, scatter, starts, verb
from barrierbench_analysis.studies.engines.report import text_of
from barrierbench_analysis.io.errors import UserError


def small_study(tmp_path, starts):
    """One scene under us and the template."""
    spec = {
        "schema": "barrierbench.engines/1",
        "scenes": [{"name": "hang", "base": str(HANG), "set": {"/scene/n": 4, "/strain_limit/enabled": False, "/matching/rule": "as_given", "/time/steps": 4}}],
        "material": {"youngs_N_per_m": 254.4, "poisson": 0.243, "density_kg_per_m2": 0.15, "hinge_J": 0.0},
        "ours": {"parts": [1]}, "reference": {"parts": 2, "integrator": "bdf2"},
        "engines": [{"engine": "template", "variant": "plain", "levels": [{"dt_s": 0.001}, {"dt_s": 0.0005}]}],
        "limit_s": 60, **({"starts": starts} if starts else {}),
    }  # fmt: skip
    path = tmp_path / "spec.json"
    path.write_text(json.dumps(spec))
    said = []
    return compare.read_study(path, tmp_path / "runs", [], said.append), said


def test_starts_are_jittered_alike_for_all_and_their_scatter_is_said(program, here, tmp_path):
    study, said = small_study(tmp_path, {"jitter_m": 1e-4})
    record = compare.compared(study)
    n = len(said)
    found = starts.with_starts(study, record, 3)
    assert len(said) > n and all(found[key] == record[key] for key in ("material_left", "guarantees"))
    own, one = record["scenes"][0], found["scenes"][0]
    assert [row["error_mean"] for row in one["rows"]] == [row["error_mean"] for row in own["rows"]]
    errors = {}
    for start in one["starts"]:
        for row in start["rows"]:
            errors.setdefault((row["engine"], row["level"]), []).append(row["error_mean"])
    assert set(errors) == {("barrierbench", 0), ("template", 0), ("template", 1)}
    assert all(len(set(each)) == 3 and min(each) > 0 for each in errors.values())
    assert len(one["references_apart"]) == 2 and 0 < min(one["references_apart"]) < 1e-2
    # ours and the engine's begin at the same place, another one than the scene's own, by at most the jitter
    at = [tmp_path / "runs/start-2/hang" / name / "frames.npz" for name in ("reference", "template-plain-0")]
    ours, theirs = (np.load(file)["positions"][0] for file in at)
    unmoved = np.load(tmp_path / "runs/hang/reference/frames.npz")["positions"][0]
    assert np.allclose(ours, theirs, atol=1e-12) and 1e-5 < np.abs(ours - unmoved).max() <= 1e-4
    spread = scatter.scatter(one)[("template", "plain", 0)]
    assert spread["error"] == (min(errors["template", 0]), sorted(errors["template", 0])[1], max(errors["template", 0]))
    assert (spread["starts"], spread["ok"], spread["judged"], spread["crossing"]) == (3, 3, 3, 0)
    n = len(said)
    assert starts.with_starts(study, record, 3) == found and len(said) == n  # what was run is not run again
    page = text_of(found | {"command_of_starts": "this"})
    assert "From 3 jittered starts" in page and "| 3 of 3 |" in page and "from jittered starts: 6 of 6 ended ok; 0 with" in page
    assert "jittered" not in text_of(record)


def test_a_scene_without_starts_stays_as_it_is_and_a_spec_names_its_files(program, here, tmp_path):
    study, _ = small_study(tmp_path, {"jitter_m": 1e-4})
    first = study.spec["scenes"][0]
    study.spec["scenes"].append({**first, "name": "large", "starts": False})
    study.scenes["large"] = study.scenes["hang"]
    study.spec["name"] = "engines_mine"
    record = compare.compared(study)
    found = starts.with_starts(study, record, 2) | {"command": "./bench engine compare mine.json", "command_of_starts": "this"}
    small, large = found["scenes"]
    assert len(small["starts"]) == 2 and large == record["scenes"][1]
    page = text_of(found)
    assert "Made by `./bench engine compare mine.json`" in page and "(../docs/engines_mine.png)" in page and page.count("From 2 jittered starts") == 1
    assert "Of their own start alone are large." in page
    with pytest.raises(UserError, match="--starts: found large; allowed: a scene whose `starts` is not false"):
        starts.with_starts(dataclasses.replace(study, scenes={"large": study.scenes["large"]}), record, 2)


def test_files_have_the_name_of_the_spec(program, here, tmp_path, monkeypatch, capsys):
    spec = small_study(tmp_path, None)[0].spec | {"engines": [{"engine": "template", "variant": "plain", "levels": [{"dt_s": 0.001}]}]}
    for folder in ("results", "docs"):
        (tmp_path / folder).mkdir()
    monkeypatch.setattr(verb, "ROOT", tmp_path)
    path = tmp_path / "named.json"
    path.write_text(json.dumps(spec | {"name": "catalogue"}))
    with pytest.raises(UserError, match="found 'catalogue'; engines, or engines_ and a name of a-z, 0-9 and _ is needed"):
        verb._compare(path, verb.parse(["compare", str(path), "--runs", str(tmp_path / "runs")]), ["compare"])
    path.write_text(json.dumps(spec | {"name": "engines_mine"}))
    assert verb._compare(path, verb.parse(["compare", str(path), "--runs", str(tmp_path / "runs")]), ["compare"]) == 0
    made = capsys.readouterr().out.split()
    assert made == ["results/engines_mine.json", "results/ENGINES_MINE.md", "docs/engines_mine.png"] and all((tmp_path / name).is_file() for name in made)
    assert (tmp_path / made[1]).read_text().startswith("# Engines of others: mine\n")


def test_a_record_of_the_same_spec_keeps_its_starts(tmp_path):
    kept = {"schema": compare.RECORD, "spec": {"a": 1}, "command_of_starts": "this", "scenes": [{"scene": "hang", "rows": [1], "starts": [2]}, {"scene": "gone", "starts": [3]}]}
    path, new = tmp_path / "engines.json", {"schema": compare.RECORD, "spec": {"a": 1}, "scenes": [{"scene": "hang", "rows": [4]}, {"scene": "new", "rows": [5]}]}
    assert starts.with_kept_starts(new, path) == new
    path.write_text(json.dumps(kept))
    found = starts.with_kept_starts(new, path)
    assert found["command_of_starts"] == "this" and found["scenes"] == [{"scene": "hang", "rows": [4], "starts": [2]}, {"scene": "new", "rows": [5]}]
    assert starts.with_kept_starts({**new, "spec": {"a": 2}}, path) == {**new, "spec": {"a": 2}}


def test_dear_runs_are_made_from_few_starts(program, here, tmp_path):
    study, _ = small_study(tmp_path, {"jitter_m": 1e-4, "few": 1, "few_above_s": 1e-9})
    record = compare.compared(study)
    for row in record["scenes"][0]["rows"][1:2]:
        row["seconds"] = 0  # this one is cheap
    found = starts.with_starts(study, record, 2) | {"command_of_starts": "this"}
    assert "take more than 1e-09 s were made from 1 starts alone" in text_of(found)
    found["spec"]["starts"]["few"] = 0
    assert "take more than 1e-09 s were not made again" in text_of(found)
    one = found["scenes"][0]
    assert {who[::2]: s["starts"] for who, s in scatter.scatter(one).items()} == {("barrierbench", 0): 2, ("template", 0): 2, ("template", 1): 1}


def test_one_variant_is_run_alone_and_what_is_known_of_others_stays(program, here, tmp_path):
    study, said = small_study(tmp_path, {"jitter_m": 1e-4})
    record = compare.compared(study)
    line = {"engine": "template", "variant": "other", "level": 0}
    one = record["scenes"][0]
    one["rows"].insert(2, one["rows"][1] | line)  # an engine that is not installed any more
    one["starts"] = [{"start": k, "reference": {}, "rows": [line | {"outcome": "ok", "error_mean": 0.5}]} for k in (1, 2)]
    found = starts.with_starts(study, record, 2, ["template/plain"])["scenes"][0]["starts"]
    assert [[(row["variant"], row["level"]) for row in start["rows"]] for start in found] == 2 * [[("log", 0), ("plain", 0), ("other", 0), ("plain", 1)]]
    assert [start["rows"][2]["error_mean"] for start in found] == [0.5, 0.5] and found[0]["reference"]["outcome"] == "ok"
    n = len(said)
    starts.with_starts(study, record, 3, ["template/plain"])
    assert sum("template" in line for line in said[n:]) == 2, "start 3 alone is new"
    with pytest.raises(UserError, match="found 'template/other'; allowed: template/plain"):
        starts.with_starts(study, record, 2, ["template/other"])
    assert verb.main(["compare", "--only", "template/plain"]) == 2


def test_how_many_cross_is_counted_and_drawn(tmp_path):
    row = {"engine": "e", "variant": "v", "level": 0, "outcome": "ok", "verdict": "clean", "frames_crossing": 0, "frames_in_obstacles": 0, "passages": 0,
           "depth_obstacles_m": 0.0, "depth_bodies_m": 0.0, "error_mean": 0.01}  # fmt: skip
    rows = [row, row | {"frames_crossing": 3, "passages": 9, "depth_obstacles_m": 2e-3, "error_mean": 0.04}, row | {"frames_in_obstacles": 1, "error_mean": 0.02}, row | {"outcome": "crashed"}]
    one = {"scene": "s", "rows": [row | {"seconds": 1.0}], "reference_apart": {}, "starts": [{"start": k + 1, "rows": [r]} for k, r in enumerate(rows)]}
    found = scatter.scatter(one)[("e", "v", 0)]
    assert (found["starts"], found["ok"], found["crossing"], found["inside"], found["passing"]) == (4, 3, 1, 1, 1)
    assert found["error"] == (0.01, 0.02, 0.04) and found["depth"] == (0.0, 0.0, 2e-3)
    ((seconds, middle, least, most, crossed),) = figure._points(one, one["rows"])
    assert (seconds, least, most, crossed) == (1.0, 1.0, 4.0, True) and middle == pytest.approx(2)
    del one["starts"]
    assert figure._points(one, one["rows"]) == [(1.0, 1.0, 1.0, 1.0, False)]


def test_starts_need_the_record_of_the_same_spec(program, here, tmp_path):
    study, _ = small_study(tmp_path, None)
    path = tmp_path / "record.json"
    with pytest.raises(UserError, match="without --starts first"):
        starts.earlier(path, study)
    path.write_text(json.dumps({"schema": compare.RECORD, "spec": study.spec | {"limit_s": 1}}))
    with pytest.raises(UserError, match="another spec"):
        starts.earlier(path, study)
    path.write_text(json.dumps({"schema": compare.RECORD, "spec": study.spec | {"starts": {"jitter_m": 1.0}}}))
    assert starts.earlier(path, study)["schema"] == compare.RECORD
    with pytest.raises(UserError, match="no `starts`"):
        starts.with_starts(study, {"material_left": {}, "scenes": []}, 2)
    assert verb.main(["compare", "--starts", "-1"]) == 2
