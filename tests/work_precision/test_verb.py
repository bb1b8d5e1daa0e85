"""The verb as a user runs it, on a small spec; what it refuses; the page and the spec as committed."""

import hashlib
import json
from pathlib import Path

import pytest

from barrierbench_analysis.tables.accuracy.errors import NAMES
from barrierbench_analysis.tables.accuracy.reference import CLOSED_FORMS
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.record_file import RecordError
from barrierbench_analysis.studies.work_precision import figure, report, verb
from barrierbench_analysis.io.places import ROOT, SCHEMAS
from barrierbench_analysis.studies.work_precision.spec import ANCHOR, AXES, read_spec

SCENE = {"name": "stack", "base": str(ROOT / "configs/scenes/stack.json"), "set": {"/matching/rule": "equal_force", "/matching/load_N": 10}, "duration_s": 2, "samples": 1,
         "anchor": {"dt_s": 0.1, "d_hat_m": 0.004, "tolerance": 0.01}, "vary": {"d_hat_m": [0.25], "kappa": [0.001]}, "reference": {"closed_form": "rigid_stack"},
         "error": "e_offset", "targets": [0.01, 0.001]}
SPEC = {"schema": "barrierbench.work_precision/1", "name": "small", "formulations": ["log", {"name": "cubic", "label": "third"}], "scenes": [SCENE]}
STRIP = {"name": "strip", "base": str(ROOT / "configs/scenes/strip_on_disk.json"), "duration_s": 0.1, "samples": 5, "anchor": {"dt_s": 0.01, "d_hat_m": 0.01, "tolerance": 0.01},
         "vary": {"dt_s": [2]}, "reference": {"refined": ["log", "cubic"]}, "error": "e_traj", "targets": [0.01]}


def write(folder: Path, spec: dict) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "spec.json"
    file.write_text(json.dumps(spec))
    return file


@pytest.fixture
def run(program, tmp_path, monkeypatch):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    return lambda spec, *words: verb.main([str(write(tmp_path, spec)), "--runs", str(tmp_path / "runs"), "--out", str(tmp_path / "out"), *words])


@pytest.fixture
def draw_no_more(monkeypatch):
    """From its call on: what is kept and what is said does not come from the figures, which take most of a call's time."""
    return lambda: [monkeypatch.setattr(figure, name, lambda *_: []) for name in ("draw", "draw_profile")]


def test_a_small_spec_is_run_judged_and_kept(run, draw_no_more, tmp_path, capsys):
    assert run(SPEC) == 0
    said = capsys.readouterr()
    assert "stack: 12 runs" in said.err and "third" in said.out
    table = json.loads((tmp_path / "out/work_precision.json").read_text())
    assert table["spec_sha256"] == hashlib.sha256((tmp_path / "spec.json").read_bytes()).hexdigest()
    rows = table["scenes"][0]["rows"]
    assert len(rows) == 2 * 3 * 2 and {r["formulation"] for r in rows} == {"log", "third"}
    thin = {(r["formulation"], r["solver"]): r for r in rows if r["axis"] == "d_hat_m"}
    wide = {(r["formulation"], r["solver"]): r for r in rows if r["axis"] == "anchor"}
    assert all(thin[k]["error"] < 0.5 * wide[k]["error"] and thin[k]["errors"]["e_gap"] < 1e-4 for k in thin)
    assert all(r["products"] > 0 for r in rows if r["solver"] == "pcg") and all(r["products"] == 0 for r in rows if r["solver"] == "direct")
    failed = [r for r in rows if r["axis"] == "kappa" and r["formulation"] == "third"]
    assert len(failed) == 2 and all(r["outcome"] != "ok" and r["error"] is None for r in failed)
    page = (tmp_path / "out/WORK_PRECISION.md").read_text()
    assert "third kappa x0.001 (direct) stall_overload" in page and "closed form" in page
    assert {p.name for p in (tmp_path / "out").glob("*.png")} == {"work_precision_stack.png", "work_precision_profile.png"}
    records = sorted((tmp_path / "runs").rglob("run.json"))
    assert len(records) == 12
    draw_no_more()
    assert run({**SPEC, "scenes": [{**SCENE, "anchor": {**SCENE["anchor"], "d_hat_m": 0.003}}]}) == 0  # records of another anchor lie beside them and do not count
    assert len(list((tmp_path / "runs").rglob("run.json"))) == 24 and run(SPEC) == 0
    before = [r.stat().st_mtime_ns for r in records]
    assert run(SPEC) == 0 and [r.stat().st_mtime_ns for r in records] == before
    assert run(SPEC, "--no-run") == 0 and (tmp_path / "out/WORK_PRECISION.md").read_text() == page


def test_refined_references_have_a_band_for_every_time_step(run, draw_no_more, tmp_path):
    draw_no_more()
    assert run({**SPEC, "formulations": ["log"], "scenes": [STRIP]}) == 0
    scene = json.loads((tmp_path / "out/work_precision.json").read_text())["scenes"][0]
    assert [ref["dt_factor"] for ref in scene["references"]] == [1, 2]
    assert all(0 < ref["band"]["e_traj"] < 0.01 and "run_id" in ref["name"] for ref in scene["references"])
    assert all(row["error"] is not None for row in scene["rows"]) and "Uncertainty of the reference" in (tmp_path / "out/WORK_PRECISION.md").read_text()


def test_a_reference_that_fails_is_told(run, tmp_path, capsys):
    """With a stiffness that carries less than the impact the cubic stalls: no reference."""
    scene = {**STRIP, "set": {"/matching/rule": "equal_force", "/matching/load_N": 0.02}, "vary": {}}
    assert run({**SPEC, "formulations": ["log"], "scenes": [scene]}) == 2
    said = capsys.readouterr().err
    assert "reference run 'reference cubic dt_s x1' ended stall_overload" in said and "a reference has to be ok and valid" in said
    assert not (tmp_path / "out/work_precision.json").exists()


def test_missing_records_and_bad_numbers_are_told(run, draw_no_more, tmp_path, capsys):
    draw_no_more()
    small = {**SPEC, "formulations": ["log"], "scenes": [{**SCENE, "vary": {}}]}
    assert run(small) == 0
    spec = read_spec(tmp_path / "spec.json")
    frame = next((tmp_path / "runs").glob("small-stack/log_anchor_direct*/frames/step_000020.ply"))
    good = frame.read_bytes()
    frame.write_bytes(good.replace(good[good.index(b"end_header\n") + 11:][:8], b"\x00\x00\x00\x00\x00\x00\xf8\x7f", 1))
    with pytest.raises(RecordError, match="step_000020.ply: found sha256"):  # a frame of other content
        verb.collect(spec, spec.scenes[0], tmp_path / "runs")
    record = frame.parents[1] / "run.json"  # a record whose own frame has no numbers
    record.write_text(record.read_text().replace(hashlib.sha256(good).hexdigest(), hashlib.sha256(frame.read_bytes()).hexdigest()))
    with pytest.raises(UserError, match="log_anchor_direct.*e_traj is nan"):
        verb.collect(spec, spec.scenes[0], tmp_path / "runs")
    record.unlink()
    with pytest.raises(UserError, match="1 of 2 records missing, the first is 'log anchor direct'"):
        verb.collect(spec, spec.scenes[0], tmp_path / "runs")
    capsys.readouterr()
    assert verb.main([str(tmp_path / "spec.json"), "--no-run", "--out", str(tmp_path / "none")]) == 2
    assert "./bench study work-precision makes it" in capsys.readouterr().err


@pytest.mark.parametrize("edit, said", [
    ({"schema": "x"}, "schema: found 'x'; 'barrierbench.work_precision/1' is needed"),
    ({"formulation": []}, "formulation: unknown; allowed: schema, name, doc, formulations, scenes"),
    ({"formulations": []}, "formulations: found []; a list of formulations is needed"),
    ({"formulations": ["log", "log"]}, "formulations: found ['log', 'log']; every name once is needed"),
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
    ({"name": ""}, "name: found ''; a string that is not empty is needed"),
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
def test_a_bad_spec_is_told_with_its_place(tmp_path, capsys, edit, said):
    file = write(tmp_path, {**SPEC, **edit})
    assert verb.main([str(file), "--runs", str(tmp_path / "runs"), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert f"{file}#/{said}" in error, error
    assert not (tmp_path / "runs").exists() and not (tmp_path / "out").exists()


def test_files_that_are_none(tmp_path, capsys):
    assert verb.main([str(tmp_path / "none.json")]) == 2 and "No such file" in capsys.readouterr().err
    (tmp_path / "torn.json").write_text('{"schema"')
    assert verb.main([str(tmp_path / "torn.json")]) == 2 and "not JSON" in capsys.readouterr().err


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
def test_a_base_whose_gravity_cannot_be_read_is_told_with_its_place(tmp_path, base, said):
    (tmp_path / "base.json").write_text(base if base == "torn" else json.dumps(base))
    with pytest.raises(UserError) as told:
        read_spec(write(tmp_path, {**SPEC, "scenes": [{**SCENE, "base": "base.json"}]}))
    assert f"{tmp_path / 'base.json'}{said}" in str(told.value)


@pytest.mark.parametrize("given, gravity", [
    ({"/scene/gravity_m_per_s2": [0, 3, -4]}, 5), ({"/scene/gravity_m_per_s2": 0}, 0), ({"/scene/gravity_m_per_s2/2": -2}, 2), ({"/scene": {"name": "hang"}}, 9.81),
    ({"/scene": {"name": "bodies", "gravity_m_per_s2": [0, 0, -1]}}, 1), ({"/scene/name": "hang"}, 9.81), ({"/scene/name": "bodies"}, 9.8), ({"/scene/planar": False}, 9.8)])
def test_the_gravity_that_a_scene_sets_counts(tmp_path, given, gravity):
    """Tolerances are in units of the fall of a step: of the gravity that the run has."""
    (tmp_path / "base.json").write_text(json.dumps({"scene": {"name": "bodies", "gravity_m_per_s2": [0, 0, -9.8]}}))
    scene, = read_spec(write(tmp_path, {**SPEC, "scenes": [{**SCENE, "base": "base.json", "set": given}]})).scenes
    assert scene.gravity == pytest.approx(gravity)
    assert scene.tolerance(0.01, 10.0, 0.1) == pytest.approx(0.01 * (0.05 * gravity if gravity else 100))


@pytest.mark.parametrize("given, said", [
    ({"/scene/gravity_m_per_s2": "x"}, "scenes/0/set/scene/gravity_m_per_s2: found 'x'; a number >= 0 or an array of three numbers is needed"),
    ({"/scene/gravity_m_per_s2/3": 1}, "scenes/0/set/scene/gravity_m_per_s2/3: found 1; a place in [0, 0, -9.81] is needed"),
    ({"/scene/gravity_m_per_s2/1": "x"}, "scenes/0/set/scene/gravity_m_per_s2/1: found [0, 'x', -9.81]; a number >= 0"),
    ({"/scene": 7}, "scenes/0/set/scene: found 7; an object is needed"),
])
def test_a_gravity_that_a_scene_cannot_set_is_told_with_its_place(tmp_path, given, said):
    file = write(tmp_path, {**SPEC, "scenes": [{**SCENE, "set": given}]})
    with pytest.raises(UserError) as told:
        read_spec(file)
    assert f"{file}#/{said}" in str(told.value)


def test_numbers_of_another_spec_are_refused(draw_no_more, tmp_path, capsys):
    """A page of numbers that the spec no longer asks for would say what was never run."""
    file = write(tmp_path, SPEC)
    out = tmp_path / "out"
    out.mkdir()
    kept = json.loads((ROOT / "results/work_precision.json").read_text())
    kept["scenes"] = kept["scenes"][:1]
    words = [str(file), "--no-run", "--runs", str(tmp_path / "runs"), "--out", str(out)]
    for sha in ({}, {"spec_sha256": "0" * 64}, {"spec_sha256": None}):
        (out / "work_precision.json").write_text(json.dumps({**{k: v for k, v in kept.items() if k != "spec_sha256"}, **sha}))
        assert verb.main(words) == 2
        said = capsys.readouterr().err
        assert "#/spec_sha256: found" in said and f"its numbers are of another spec; ./bench study work-precision {file}" in said and read_spec(file).sha256 in said
        assert not (out / "WORK_PRECISION.md").exists() and not list(out.glob("*.png"))
    (out / "work_precision.json").write_text(json.dumps({**kept, "spec_sha256": read_spec(file).sha256}))
    draw_no_more()
    assert verb.main(words) == 0 and (out / "WORK_PRECISION.md").is_file()


def test_what_the_program_refuses_is_passed_on(run, capsys):
    assert run({**SPEC, "formulations": ["logg"]}) == 2
    assert "scene stack: the program ended with 2" in (said := capsys.readouterr().err) and "logg" in said


def test_an_error_that_a_scene_does_not_have(run, capsys):
    assert run({**SPEC, "formulations": ["log"], "scenes": [{**SCENE, "vary": {}, "error": "e_momentum"}]}) == 2
    assert "e_momentum does not apply: something outside acts on the bodies" in capsys.readouterr().err


def test_the_committed_spec_and_page():
    spec = read_spec(verb.DEFAULT)
    table = verb.read_table(ROOT / "results" / "work_precision.json")
    assert table["spec_sha256"] == spec.sha256
    assert [scene["name"] for scene in table["scenes"]] == [scene.name for scene in spec.scenes]
    for scene, kept in zip(spec.scenes, table["scenes"]):
        wanted = {(f.label, v.axis, v.factor, s) for f in spec.formulations for v in scene.variations for s in ("direct", "pcg")}
        assert {(r["formulation"], r["axis"], r["factor"], r["solver"]) for r in kept["rows"]} == wanted and len(wanted) > 100
        assert kept["targets"] == list(scene.targets) and (ROOT / "docs" / f"work_precision_{scene.name}.png").is_file()
    assert (ROOT / "results" / "WORK_PRECISION.md").read_text() == report.markdown(table)
    assert {"refined", "closed_form"} == {key for scene in spec.scenes for key in scene.reference}


def test_the_schema_names_the_errors_and_closed_forms_that_there_are():
    scene = json.loads((SCHEMAS / "work_precision.schema.json").read_text())["properties"]["scenes"]["items"]["properties"]
    assert scene["error"]["enum"] == list(NAMES) and scene["reference"]["properties"]["closed_form"]["enum"] == list(CLOSED_FORMS)
    assert list(scene["vary"]["properties"]) == list(AXES) and list(scene["anchor"]["properties"]) == list(ANCHOR)
