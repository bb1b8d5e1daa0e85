"""The study gap-map: its spec, a real map of one tiny scene, and what it refuses."""

import json
import re

import pytest

from barrierbench_analysis.io import fields
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.program.start import evaluated
from barrierbench_analysis.studies.kit.study import collect, store, verb
from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.rules.gap_map import figures, measured, page, table
from barrierbench_analysis.studies.rules.gap_map.spec import limit_settings, reachable, run_of, runs

SCENE = {"label": "block", "obstacle": "analytic", "set": {"/scene": {"name": "resting_block_1d"}, "/time/steps": 60},
         "resolutions": {"1": {"unknowns": 9, "set": {"/scene/mass_kg": 0.3}}}}  # fmt: skip
ABOUT = {"shapes": [{"label": name, "shape": shape, "argument": argument} for name, shape, argument in (
             ("log", "log", "gap"), ("cubic", "cubic", "gap"), ("cubic_of_square", "cubic", "squared_gap"))],
         "main": ["log", "cubic"], "gaps": [0.5, 0.1], "limits": ["off"], "scenes": [SCENE]}  # fmt: skip


@pytest.fixture(scope="module")
def shipped():
    return read_study("gap_map")


def small(tmp_path, **edits):
    """A scene of one resting triangle, whose gap and load are known."""
    spec = {"schema": "barrierbench.study/1", "name": "small", "rule": "gap_map", "question": "One block?", "base": str(ROOT / "configs/scenes/hang.json"),
            "set": json.loads((ROOT / "configs/studies/gap_map.json").read_text())["set"], "metrics": {"newton": "newton"}, "about": ABOUT | edits,
            "parts": {"quick": {"shape": ["log", "cubic"], "theta": ["0.5"]}}, "page": "results/SMALL.md"}  # fmt: skip
    file = tmp_path / "small.json"
    file.write_text(json.dumps(spec))
    return file


# --- the spec


def test_the_shipped_map_has_what_its_question_names(shipped):
    about, every = shipped.about, runs(shipped.about)
    assert len(about["scenes"]) == 7 and sum(s["obstacle"] == "mesh" for s in about["scenes"]) == 2 and len(about["shapes"]) == len(about["gaps"]) == 8
    sizes = [of["unknowns"] for scene in about["scenes"] for of in scene["resolutions"].values()]
    assert all(len(s["resolutions"]) == 4 for s in about["scenes"]) and 4000 < max(sizes) <= 5000 and about["limits"] == ["on", "contact", "off"]
    assert len(every) == 4864 and len(shipped.cells) == 4332 and {run_of(cell.place) for cell in shipped.cells} < set(every)


def test_its_parts_are_of_the_resolutions_that_they_name(shipped):
    quick, large = (verb.chosen(shipped, [], part) for part in ("quick", "large"))
    assert {cell.unknowns for cell in quick} == {144, 384, 192, 432} and len(quick) <= 260 and {cell.place["limit"] for cell in quick} == {"on", "off"}
    assert {cell.place["scene"] for cell in large} == {s["label"] for s in shipped.about["scenes"]} and max(cell.unknowns for cell in large) > 4000
    assert len(large) == 7 * 2 * 3 * 4 and min(cell.unknowns for cell in large) == 720


def test_sweeps_are_of_one_calibration_run_and_the_smallest_come_first(shipped):
    parts = list(collect.parts(shipped, shipped.cells))
    assert sum(map(len, parts)) == len(shipped.cells) and {len(part) for part in parts} == {7, 8}
    assert all(len({tuple(cell.place[a] for a in ("scene", "resolution", "limit", "theta")) for cell in part}) == 1 for part in parts)
    sizes = [part[0].unknowns for part in parts]
    assert sizes == sorted(sizes) and sizes[0] == 108 and sizes[-1] == 4800
    thetas = [part[0].place["theta"] for part in parts[:8]]
    assert thetas == sorted(thetas, key=float, reverse=True) and len(set(thetas)) == 8  # a run may decide those of smaller theta


def test_targets_that_can_be_reached_are_those_of_the_program(shipped, program, monkeypatch):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    for shape in shipped.about["shapes"]:
        queries = [{"kind": "shape", **{k: shape[k] for k in ("shape", "argument")}, "d": theta, "d_hat": 1} for theta in shipped.about["gaps"]]
        rising = {(shape["label"], theta) for theta, answer in zip(shipped.about["gaps"], evaluated(queries), strict=True) if answer["d2b"] > 0}
        assert rising == {place for place in reachable(shipped.about) if place[0] == shape["label"]}
    other = {"gaps": [0.5, 0.1], "shapes": [{"label": "x", "shape": "exponential:8", "argument": "gap"}]}  # without a closed form in Python
    assert reachable(other) == {("x", 0.5), ("x", 0.1)}


def test_a_limit_that_is_the_same_in_every_run_undoes_theta():
    assert limit_settings("contact", "cubic", "gap", 0.1)["/strain_limit/stiffness_policy"]["scale"] == pytest.approx(1)
    deep = limit_settings("contact", "cubic", "gap", 0.01)
    assert deep["/strain_limit/shape"] == "log" and deep["/strain_limit/stiffness_policy"]["scale"] == pytest.approx(8.75, rel=0.01)
    assert limit_settings("off", "cubic", "gap", 0.01) == {"/strain_limit/enabled": False} and limit_settings("on", "cubic", "gap", 0.01)["/strain_limit/shape"] == "cubic"


@pytest.mark.parametrize(("edit", "words"), [
    ({"gaps": [0.1, 0.5]}, "about/gaps: found .0.1, 0.5.; a falling list"), ({"gaps": [0.5, 0.0]}, "gaps/1"), ({"limits": ["of"]}, "on, contact, off"), ({"main": ["cubic"]}, "about/main: found"),
    ({"main": ["log", "x"]}, "about/main: found .'log', 'x'.; a list of some of log, cubic, cubic_of_square"), ({"extra": 1}, "about/extra: unknown"), ({"scenes": [{"label": "x"}]}, "obstacle"),
    ({"gaps": [0.5, 1.0]}, "gaps/1: found 1.0; a gap in"), ({"gaps": [0.5, 0.5]}, "gaps: found .0.5, 0.5.; a falling list"), ({"limits": ["on", "on"]}, "limits: found"),
    ({"shapes": [{"label": "log", "shape": "log", "argument": "gaps"}]}, "shapes/0/argument: found 'gaps'; one of gap, squared_gap"),
    ({"scenes": [{"label": "x", "obstacle": "none", "set": {}, "resolutions": {"1": {"set": {}}}}]}, "scenes/0/resolutions/1/unknowns: is missing"),
    ({"scenes": [SCENE | {"limits": ["on"]}]}, "about/scenes/block/limits: found .'on'.; a list of some of off"), ({"scenes": [SCENE, SCENE]}, "about/scenes: found")])  # fmt: skip
def test_a_bad_spec_is_refused_with_its_place(tmp_path, edit, words):
    file = small(tmp_path, **edit)
    with pytest.raises(UserError, match=re.escape(str(file)) + f".*{words}"):
        _ = read_study(str(file)).cells


# --- real runs


@pytest.fixture(scope="module")
def real(program, tmp_path_factory):
    """A map of real runs, made once: first its part `quick`, then the rest."""
    folder = tmp_path_factory.mktemp("map")
    file = small(folder)
    patch = pytest.MonkeyPatch()
    patch.setenv("BARRIERBENCH_PROGRAM", program)
    patch.setattr(collect, "RUNS", folder / "runs")
    assert verb.main([str(file), "--minutes", "1e-9"]) == 2 and not list((folder / "runs").rglob("run.json"))
    with patch.context() as undrawn:  # which takes most of a call's time
        undrawn.setattr(figures, "draw_all", lambda *_: [])
        assert verb.main([str(file), "--part", "quick"]) == 0
    part = file.with_suffix(".page.md").read_text()
    assert verb.main([str(file)]) == 0
    yield file, part
    patch.undo()


def rows_of(file):
    study = read_study(str(file))
    return table.map_of(study, store.read_rows(store.file_of(study)).values())


def test_a_block_rests_at_its_target_and_a_theta_beyond_the_peak_is_named(real):
    file, _ = real
    found = {(r["shape"], r["theta"]): r for r in rows_of(file).rows}
    for shape in ("log", "cubic"):
        for theta in (0.5, 0.1):  # matched to the impact, which is more than the weight: the rest is farther off
            row = found[shape, theta]
            assert row["outcome"] == "ok" and theta < row["gap"] < 6 * theta and row["unknowns"] == 9 and row["cond_end"] >= row["nc_end"] > 0
        assert found[shape, 0.1]["gap"] < found[shape, 0.5]["gap"]
    assert found["log", 0.1]["gap"] < found["cubic", 0.1]["gap"]  # a bounded force is spent on the impact
    assert found["cubic", 0.1]["rho"] == pytest.approx(2 / (1 - found["cubic", 0.1]["gap"]), rel=1e-4)
    beyond = found["cubic_of_square", 0.1]
    assert beyond["outcome"] == "cannot reach" and beyond["gap"] is None and found["cubic_of_square", 0.5]["outcome"] == "ok"
    text = file.with_suffix(".page.md").read_text()
    assert "| `cubic_of_square` | no strain limit | 0.1 | cannot reach 1 |" in text and "0 not run" in text and "not run yet" not in text
    assert all((file.parent / name).is_file() for name in ("gap_map.png", "gap_law.png", "gap_map_more.png", "gap_map.txt"))


def test_a_part_of_a_map_says_what_is_not_run(real):
    _, part = real
    assert "**3 of 6 cells are not run yet**: `./bench study" in part and "block 1: 2 of 5" in part


def test_the_page_comes_from_the_kept_rows_alone(real, monkeypatch):
    file, _ = real
    before = file.with_suffix(".page.md").read_text()
    monkeypatch.setattr(verb, "run_cells", None)
    monkeypatch.setattr(figures, "draw_all", lambda *_: [])
    assert verb.main([str(file), "--no-run"]) == 0 and file.with_suffix(".page.md").read_text() == before
    assert verb.main([str(file)]) == 0  # nothing is left to run


def test_unknowns_that_the_spec_has_wrong_are_refused(real, tmp_path, monkeypatch, capsys):
    wrong = {"1": {"unknowns": 12, "set": {"/scene/mass_kg": 0.3}}}
    file = small(tmp_path, scenes=[SCENE | {"resolutions": wrong}], shapes=ABOUT["shapes"][:2], gaps=[0.5])
    monkeypatch.setattr(collect, "RUNS", real[0].parent / "runs")  # whose runs are not made again
    assert verb.main([str(file)]) == 2 and "found 12 unknowns" in capsys.readouterr().err


# --- rows of another version of records


def test_the_page_names_records_in_which_fields_mean_something_else(shipped):
    kept = list(store.read_rows(store.file_of(shipped)).values())
    text = page.other_records(kept)
    assert "1252 with records 3.5.0, in which 16 fields mean something else than in records from 3.6.0, 3.7.0 on; of these fields the map reads `trace contacts`" in text
    assert f"of the 2325 kept runs {text}. They count" in (ROOT / "results/GAP_MAP.md").read_text()
    assert page.other_records([]) == ""


def test_fields_that_the_map_reads_are_fields_of_records():
    """Of the run's the schema has each; so a name that is spelled otherwise is found."""
    run, trace = fields.schema("run"), fields.schema("trace")
    names = {*re.findall(r'"([a-z_A-Z]+)":', json.dumps([run, trace]))}
    assert len(names) > 100
    for field in measured.READ:
        assert set(re.split(r"[. ]|\[\]\.?", field.removeprefix("trace "))) - {""} <= names, field
