"""The study as a user runs it, on a small spec of their own; what it refuses; the spec as committed."""

import hashlib
import json
from pathlib import Path

import pytest

from barrierbench_analysis.tables.accuracy.errors import NAMES
from barrierbench_analysis.tables.accuracy.reference import CLOSED_FORMS
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT, SCHEMAS
from barrierbench_analysis.studies.kit.study import collect, page, store, verb
from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.rules.work_precision import figure
from barrierbench_analysis.studies.rules.work_precision.scenes import ANCHOR, AXES, SOLVERS, scenes_of

SCENE = {"name": "stack", "base": str(ROOT / "configs/scenes/stack.json"), "set": {"/matching/rule": "equal_force", "/matching/load_N": 10}, "duration_s": 2, "samples": 1,
         "anchor": {"dt_s": 0.1, "d_hat_m": 0.004, "tolerance": 0.01}, "vary": {"d_hat_m": [0.25], "kappa": [0.001]}, "reference": {"closed_form": "rigid_stack"},
         "error": "e_offset", "targets": [0.01, 0.001]}
STRIP = {"name": "strip", "base": str(ROOT / "configs/scenes/strip_on_disk.json"), "duration_s": 0.1, "samples": 5, "anchor": {"dt_s": 0.01, "d_hat_m": 0.01, "tolerance": 0.01},
         "vary": {"dt_s": [2]}, "reference": {"refined": ["log", "cubic"]}, "error": "e_traj", "targets": [0.01]}
TWO = ["log", {"name": "cubic", "label": "third"}]
DEFAULT = json.loads((ROOT / "configs/studies/work_precision.json").read_text())


def write(folder: Path, scenes=(SCENE,), formulations=TWO, **about) -> Path:
    spec = {**DEFAULT, "name": "spec", "rule": "work_precision", "base": SCENE["base"], "about": {"formulations": formulations, "scenes": list(scenes), **about}}
    file = folder / "spec.json"
    file.write_text(json.dumps(spec))
    return file


@pytest.fixture
def run(program, tmp_path, monkeypatch):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    monkeypatch.setattr(collect, "RUNS", tmp_path / "runs")
    return lambda *words, **about: verb.main([str(write(tmp_path, **about)), *words])


@pytest.fixture
def draw_no_more(monkeypatch):
    """From its call on: what is kept and what is said does not come from the figures, which take most of a call's time."""
    return lambda: [monkeypatch.setattr(figure, name, lambda *_: []) for name in ("draw", "draw_profile")]


def kept(tmp_path) -> dict[tuple, store.Row]:
    return {tuple(row.place.values())[1:]: row for row in store.read_rows(tmp_path / "spec.rows.jsonl").values()}


def test_a_small_spec_is_run_judged_and_kept(run, draw_no_more, tmp_path):
    assert run() == 0
    rows = kept(tmp_path)
    assert set(rows) == {(f, *at, s) for f in ("log", "third") for at in (("anchor", "1"), ("d_hat_m", "0.25"), ("kappa", "0.001")) for s in SOLVERS}
    for (formulation, axis, _, solver), row in rows.items():
        if axis == "d_hat_m":
            assert row.values["e_offset"] < 0.5 * rows[formulation, "anchor", "1", solver].values["e_offset"] and row.values["e_gap"] < 1e-4
        assert (row.values["products"] > 0) == (solver == "pcg")
        failed = formulation == "third" and axis == "kappa"
        assert (row.outcome == "ok") != failed and all((row.values[name] is None) == failed for name in ("e_traj", "e_offset", "e_gap"))
    text = (tmp_path / "spec.page.md").read_text()
    assert "third kappa x0.001 (direct) stall_overload" in text and "closed form" in text and "(./work_precision_stack.png)" in text
    assert {p.name for p in tmp_path.glob("*.png")} == {"work_precision_stack.png", "work_precision_profile.png"}
    records = sorted((tmp_path / "runs").rglob("run.json"))
    assert len(records) == 12
    draw_no_more()
    assert run(scenes=[{**SCENE, "anchor": {**SCENE["anchor"], "d_hat_m": 0.003}}]) == 0  # rows and records of another anchor do not count
    assert len(list((tmp_path / "runs").rglob("run.json"))) == 24 and run() == 0
    before = [r.stat().st_mtime_ns for r in records]
    (tmp_path / "spec.rows.jsonl").unlink()
    assert run() == 0 and [r.stat().st_mtime_ns for r in records] == before
    assert run("--no-run") == 0 and (tmp_path / "spec.page.md").read_text() == text


def test_refined_references_have_a_band_for_every_time_step(run, draw_no_more, tmp_path):
    draw_no_more()
    assert run(scenes=[STRIP], formulations=["log"]) == 0
    study = read_study(str(tmp_path / "spec.json"))
    rows = page.rows_of(study)
    scene, = study.module.rule(study, rows)["scenes"]
    assert [ref["dt_factor"] for ref in scene["references"]] == [1, 2]
    assert all(0 < ref["band"]["e_traj"] < 0.01 and "run_id" in ref["name"] for ref in scene["references"])
    assert len(scene["rows"]) == 4 and all(row["error"] is not None for row in scene["rows"])
    assert "Uncertainty of the reference" in (tmp_path / "spec.page.md").read_text()
    # Without its row a run is measured from the same references, though theirs are kept.
    errors = {row.key: row.values for row in rows}
    last = next(row for row in rows if row.place["axis"] == "dt_s")
    store.write_rows(tmp_path / "spec.rows.jsonl", {row.key: row for row in rows if row is not last})
    assert verb.make_rows(study) == 1 and {row.key: row.values for row in page.rows_of(study)} == errors


def test_a_run_is_measured_again_from_another_reference(tmp_path):
    def keys(**scene):
        cells = read_study(str(write(tmp_path, scenes=[{**STRIP, **scene}]))).cells
        return {tuple(cell.place.values()): cell.key for cell in cells if cell.place["axis"] != "reference"}

    before, other = keys(), keys(reference={"refined": ["log", "quadratic"]})
    assert before.keys() == other.keys() and not set(before.values()) & set(other.values())
    assert before == keys(targets=[0.02])


def test_a_reference_that_fails_is_named(run, tmp_path, capsys):
    """With a stiffness that carries less than the impact the cubic stalls: no reference."""
    assert run(formulations=["log"], scenes=[{**STRIP, "set": {"/matching/rule": "equal_force", "/matching/load_N": 0.02}, "vary": {}}]) == 2
    said = capsys.readouterr().err
    assert "scene strip: reference run 'spec: strip cubic reference 1 direct " in said and "ended stall_overload" in said and "a reference has to be ok and valid" in said
    assert not (tmp_path / "spec.rows.jsonl").exists()


def test_bad_numbers_are_named(run, draw_no_more, tmp_path, capsys):
    draw_no_more()
    small = {"formulations": ["log"], "scenes": [{**SCENE, "vary": {}}]}
    assert run(**small) == 0
    rows = tmp_path / "spec.rows.jsonl"
    rows.unlink()
    frame = next((tmp_path / "runs").glob("spec/*/stack_log_anchor_1_direct*/frames/step_000020.ply"))
    good = frame.read_bytes()
    frame.write_bytes(good.replace(good[good.index(b"end_header\n") + 11:][:8], b"\x00\x00\x00\x00\x00\x00\xf8\x7f", 1))
    assert run(**small) == 2 and "step_000020.ply: found sha256" in capsys.readouterr().err  # a frame of other content
    record = frame.parents[1] / "run.json"  # a record whose own frame has no numbers
    record.write_text(record.read_text().replace(hashlib.sha256(good).hexdigest(), hashlib.sha256(frame.read_bytes()).hexdigest()))
    assert run(**small) == 2
    said = capsys.readouterr().err
    assert "stack_log_anchor_1_direct" in said and "e_traj is nan" in said and not rows.exists()
    assert run("--no-run", **small) == 2 and "2 cells of 2 without a row, the first 'stack log anchor 1 direct'" in capsys.readouterr().err


@pytest.mark.parametrize("edit, said", [
    ({"formulation": []}, "formulation: unknown; allowed: doc, formulations, scenes"),
    ({"formulations": []}, "formulations: found []; a list of formulations is needed"),
    ({"formulations": ["log", "log"]}, "formulations: found ['log', 'log']; every name once is needed"),
    ({"scenes": [SCENE, SCENE]}, "scenes: found ['stack', 'stack']; every name once is needed"),
    ({"scenes": [{**SCENE, "speed": 1}]}, "scenes/0/speed: unknown; allowed: name, base, set"),
    ({"scenes": [{**SCENE, "base": "none.json"}]}, "scenes/0/base: found 'none.json'; the path of a config, relative to this file, is needed"),
    ({"scenes": [{k: v for k, v in SCENE.items() if k != "reference"}]}, "scenes/0/reference: is missing"),
    ({"scenes": [{**SCENE, "reference": {}}]}, "scenes/0/reference: found {}; either closed_form or refined is needed"),
    ({"scenes": [{**SCENE, "reference": {"closed_form": "truth"}}]}, "scenes/0/reference/closed_form: found 'truth'; one of rigid_bounce, rigid_stack"),
    ({"scenes": [{**SCENE, "reference": {"refined": ["log"]}}]}, "scenes/0/reference/refined: found ['log']; a list of two formulations"),
    ({"scenes": [{**SCENE, "error": "e_work"}]}, "scenes/0/error: found 'e_work'; one of e_traj"),
    ({"scenes": [{**SCENE, "vary": {"mass": [2]}}]}, "scenes/0/vary/mass: unknown; allowed: tolerance"),
    ({"scenes": [{**SCENE, "vary": {"kappa": [1]}}]}, "scenes/0/vary/kappa/0: found 1; a factor > 0 of the anchor, other than 1, is needed"),
    ({"scenes": [{**SCENE, "vary": {"kappa": [-2]}}]}, "scenes/0/vary/kappa/0: found -2; a factor > 0 of the anchor, other than 1, is needed"),
    ({"scenes": [{**SCENE, "vary": {"dt_s": [3]}}]}, "scenes/0/samples: found 1; an integer that divides"),
    ({"scenes": [{**STRIP, "vary": {"d_hat_m": [0.1]}}]}, "scenes/0/vary/d_hat_m: found 0.1; at least 0.125"),
    ({"formulations": [3]}, "formulations/0: found 3; the name of a formulation, or an object"),
    ({"formulations": [{"label": "third"}]}, "formulations/0/name: is missing"),
    ({"formulations": [{"name": "log", "set": {"matching": 1}}]}, "formulations/0/set: found 'matching'; overrides"),
    ({"scenes": [{**SCENE, "duration_s": True}]}, "scenes/0/duration_s: found True; a number > 0 is needed"),
    ({"scenes": [{**SCENE, "duration_s": float("inf")}]}, "scenes/0/duration_s: found inf; a number > 0 is needed"),
    ({"scenes": [{**SCENE, "samples": 1.5}]}, "scenes/0/samples: found 1.5; a whole number >= 1 is needed"),
    ({"scenes": [{**SCENE, "anchor": {"dt_s": 0.1}}]}, "scenes/0/anchor/tolerance: is missing"),
    ({"scenes": [{**SCENE, "vary": {"kappa": [2, 2.0]}}]}, "scenes/0/vary/kappa: found [2, 2.0]; a list of factors of the anchor, each once, is needed"),
    ({"scenes": [{**SCENE, "reference": {"refined": ["log", "log"]}}]}, "scenes/0/reference/refined: found ['log', 'log']; a list of two formulations"),
    ({"scenes": [{**SCENE, "reference": {"refined": ["log", "cubic"], "closed_form": "rigid_stack"}}]}, "scenes/0/reference: found {"),
    ({"scenes": [{**SCENE, "targets": [0.1, float("nan")]}]}, "scenes/0/targets/1: found nan; a number > 0 is needed"),
])
def test_a_bad_spec_is_refused_with_its_place(tmp_path, capsys, edit, said):
    file = write(tmp_path, **edit)
    assert verb.main([str(file), "--plan"]) == 2
    error = capsys.readouterr().err
    assert f"{file}#/about/{said}" in error, error


@pytest.mark.parametrize("base, said", [
    ([], ": not a JSON object"),
    ("torn", ": not JSON"),
    ({"formulation": "log"}, "#/scene: found None; an object is needed"),
    ({"scene": {"gravity_m_per_s2": "x"}}, "#/scene/gravity_m_per_s2: found 'x'; a number >= 0 or an array of three numbers is needed"),
    ({"scene": {"gravity_m_per_s2": None}}, "#/scene/gravity_m_per_s2: found None; a number >= 0"),
    ({"scene": {"gravity_m_per_s2": True}}, "#/scene/gravity_m_per_s2: found True; a number >= 0"),
    ({"scene": {"gravity_m_per_s2": [0, "x", 0]}}, "#/scene/gravity_m_per_s2: found [0, 'x', 0]; a number >= 0"),
    ({"scene": {"gravity_m_per_s2": [9.81]}}, "#/scene/gravity_m_per_s2: found [9.81]; a number >= 0"),
    ({"scene": {"gravity_m_per_s2": -1}}, "#/scene/gravity_m_per_s2: found -1; a number >= 0"),
])
def test_a_base_whose_gravity_cannot_be_read_is_named_with_its_place(tmp_path, base, said):
    (tmp_path / "base.json").write_text(base if base == "torn" else json.dumps(base))
    with pytest.raises(UserError) as refused:
        scenes_of(read_study(str(write(tmp_path, scenes=[{**SCENE, "base": "base.json"}]))))
    assert f"{tmp_path / 'base.json'}{said}" in str(refused.value)


@pytest.mark.parametrize("settings, gravity", [
    ({"/scene/gravity_m_per_s2": [0, 3, -4]}, 5), ({"/scene/gravity_m_per_s2": 0}, 0), ({"/scene/gravity_m_per_s2/2": -2}, 2), ({"/scene": {"name": "hang"}}, 9.81),
    ({"/scene": {"name": "bodies", "gravity_m_per_s2": [0, 0, -1]}}, 1), ({"/scene/name": "hang"}, 9.81), ({"/scene/name": "bodies"}, 9.8), ({"/scene/planar": False}, 9.8)])
def test_the_gravity_that_a_scene_sets_counts(tmp_path, settings, gravity):
    """Tolerances are in units of the fall of a step: of the gravity that the run has."""
    (tmp_path / "base.json").write_text(json.dumps({"scene": {"name": "bodies", "gravity_m_per_s2": [0, 0, -9.8]}}))
    scene, = scenes_of(read_study(str(write(tmp_path, scenes=[{**SCENE, "base": "base.json", "set": settings}]))))
    assert scene.gravity == pytest.approx(gravity)
    assert scene.tolerance(0.01, 10.0, 0.1) == pytest.approx(0.01 * (0.05 * gravity if gravity else 100))


@pytest.mark.parametrize("settings, said", [
    ({"/scene/gravity_m_per_s2": "x"}, "set/scene/gravity_m_per_s2: found 'x'; a number >= 0 or an array of three numbers is needed"),
    ({"/scene/gravity_m_per_s2/3": 1}, "set/scene/gravity_m_per_s2/3: found 1; a place in [0, 0, -9.81] is needed"),
    ({"/scene/gravity_m_per_s2/1": "x"}, "set/scene/gravity_m_per_s2/1: found [0, 'x', -9.81]; a number >= 0"),
    ({"/scene": 7}, "set/scene: found 7; an object is needed"),
])
def test_a_gravity_that_a_scene_cannot_set_is_named_with_its_place(tmp_path, settings, said):
    file = write(tmp_path, scenes=[{**SCENE, "set": settings}])
    with pytest.raises(UserError) as refused:
        scenes_of(read_study(str(file)))
    assert f"{file}#/about/scenes/0/{said}" in str(refused.value)


def test_a_scene_without_a_base_has_that_of_the_spec(tmp_path):
    scene, = scenes_of(read_study(str(write(tmp_path, scenes=[{k: v for k, v in SCENE.items() if k != "base"}]))))
    assert scene.base == ROOT / "configs/scenes/stack.json"


def test_what_the_program_refuses_is_passed_on(run, capsys):
    assert run(formulations=["logg"]) == 2
    assert "the program ended with 2" in (said := capsys.readouterr().err) and "logg" in said


def test_an_error_that_a_scene_does_not_have(run, capsys):
    assert run(formulations=["log"], scenes=[{**SCENE, "vary": {}, "error": "e_momentum"}]) == 2
    assert "e_momentum does not apply: something outside acts on the bodies" in capsys.readouterr().err


def test_the_committed_spec_has_every_kind_of_reference_and_its_figures():
    scenes = scenes_of(read_study("work_precision"))
    assert {"refined", "closed_form"} == {key for scene in scenes for key in scene.reference}
    assert all((ROOT / "docs" / f"work_precision_{scene.name}.png").is_file() for scene in scenes)


def test_the_schema_names_the_errors_and_closed_forms_that_there_are():
    scene = json.loads((SCHEMAS / "about/work_precision.schema.json").read_text())["properties"]["scenes"]["items"]["properties"]
    assert scene["error"]["enum"] == list(NAMES) and scene["reference"]["properties"]["closed_form"]["enum"] == list(CLOSED_FORMS)
    assert list(scene["vary"]["properties"]) == list(AXES) and list(scene["anchor"]["properties"]) == list(ANCHOR)
