"""The verb figure: names, missing records, bytes of a rebuild, widths."""

import hashlib
import json
import struct
from pathlib import Path

import pandas as pd
import pytest

from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.figures.plots import heat_map, matrices, one_step, phase_times, profiles, scaling, step_front, trend
from barrierbench_analysis.studies.comparison import rebuild, sources
from barrierbench_analysis.figures.plots.drawing import Drawing
from barrierbench_analysis.studies.comparison.kinds import KINDS
from barrierbench_analysis.studies.comparison.spec import FOLDER, chosen, known, read_spec
from barrierbench_analysis.figures.plots.drawing import Place, SweepRecords, Wanted
from barrierbench_analysis.tables.records import Records
from barrierbench_analysis.figures.style import SUFFIXES

ROOT = Path(__file__).resolve().parents[2]


def spec_of(tmp_path: Path, **change) -> Path:
    data = json.loads((FOLDER / "barrier_shapes.json").read_text()) | change
    file = tmp_path / "mine.json"
    file.write_text(json.dumps({key: value for key, value in data.items() if value is not None}))
    return file


def test_every_committed_figure_is_read_and_every_kind_is_used():
    specs = [read_spec(FOLDER / f"{name}.json") for name in known()]

    assert len(specs) >= 20
    assert {json.loads(spec.path.read_text())["kind"] for spec in specs} == set(KINDS)


def test_an_unknown_name_is_answered_with_the_known_ones(capsys):
    assert rebuild.main(["pareta", "--quick"]) == 2
    said = capsys.readouterr().err
    assert "figure 'pareta': one of ablation, barrier_shapes," in said and "or all; did you mean 'pareto'?" in said


def test_no_name_is_an_error_and_the_list_needs_none(capsys):
    assert rebuild.main([]) == 2
    assert "no figure is named: one of ablation" in capsys.readouterr().err
    assert rebuild.main(["--list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 1 + len(known())
    assert any(line.split()[:3] == ["preconditioned", "3.33", "configs/sweeps/figure_runs.json"] for line in lines)


def test_all_is_every_figure_once():
    assert [spec.name for spec in chosen(["gaps", "all"])] == known()
    assert [spec.name for spec in chosen(["gaps", "trend", "gaps"])] == ["gaps", "trend"]


@pytest.mark.parametrize(("change", "said"), [
    ({"kind": "pie"}, "#/kind: found 'pie'; one of barrier_shapes, "),
    ({"columns": 3}, "#/columns: found 3; 1 or 2, columns of a journal"),
    ({"quick": {"sweep": "x.json"}}, '#/quick: found {\'sweep\': \'x.json\'}; {"shapes": ...}, which is what this kind is drawn of, is needed'),
    ({"options": {"colour": 1}}, "#/options/colour: found 1; no options, of this kind, is needed"),
    ({"title": None}, "#/title: is missing"),
    ({"speed": 1}, "#/speed: unknown; allowed: schema, title,")])
def test_a_bad_spec(tmp_path, change, said):
    file = spec_of(tmp_path, **change)
    with pytest.raises(UserError) as told:
        read_spec(file)
    assert f"{file}{said}" in str(told.value)


def test_a_sweep_file_that_is_not_there(tmp_path):
    file = spec_of(tmp_path, kind="gaps", records={"sweep": "nowhere.json"}, quick={"sweep": "nowhere.json"})
    with pytest.raises(UserError, match="#/records/sweep: found 'nowhere.json'; the path of a file"):
        read_spec(file)


def test_missing_records_are_said_with_the_command_that_makes_them(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(ROOT)
    assert rebuild.main(["gaps", "--quick", "--no-run", "--runs", str(tmp_path / "runs"), "--out", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert "no record is there; this makes them: ./bench sweep configs/sweeps/figure_runs_quick.json --out" in said
    assert not list(tmp_path.glob("*.png"))


def test_records_that_are_partly_missing_are_counted(tmp_path):
    file = ROOT / "configs/sweeps/figure_friction_quick.json"
    folder = sources.folder_of(file, tmp_path)
    folder.mkdir()
    cases = [{"folder": "a", "label": "a", "config_id": "1", "swept": {}}, {"folder": "b", "label": "b", "config_id": "2", "swept": {}}]
    (folder / "cases.json").write_text(json.dumps({"schema": "barrierbench.cases/1", "cases": cases}))
    (folder / "a").mkdir()
    (folder / "a/run.json").write_text("{}")
    with pytest.raises(UserError, match="1 of 2 records are missing"):
        sources.sweep(Wanted("sweep", file), Place(tmp_path, False))


def test_the_folder_of_records_follows_the_sweep_and_what_it_names(tmp_path):
    base, sweep = tmp_path / "base.json", tmp_path / "s.json"
    base.write_text('{"scene": {"name": "hang"}}')
    sweep.write_text(json.dumps({"base": "base.json", "set": {}}))
    first = sources.folder_of(sweep, tmp_path)
    base.write_text('{"scene": {"name": "drape"}}')
    second = sources.folder_of(sweep, tmp_path)
    sweep.write_text(json.dumps({"base": "base.json", "set": {"/threads": 1}}))

    assert len({first, second, sources.folder_of(sweep, tmp_path)}) == 3


def test_kept_numbers_of_a_study_that_are_missing(tmp_path):
    wanted = Wanted("study", ROOT / "configs/pareto/quick.json")
    with pytest.raises(UserError, match=r"quick.rows.jsonl: 21 cells of 21 .*; ./bench study .*quick.json run --out .* makes them"):
        sources.subject(wanted, Place(tmp_path, False))


def test_a_folder_that_cannot_be_written_is_said_before_anything_is_run(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert rebuild.main(["gaps", "--quick", "--runs", str(tmp_path / "runs"), "--out", str(tmp_path / "file/below")]) == 2
    assert f"{tmp_path}/file/below: Not a directory; a folder that can be written to is needed" in capsys.readouterr().err
    assert not (tmp_path / "runs").exists()


EMPTY_RUNS = pd.DataFrame(columns=["run", "series", "group", "formulation", "outcome", "valid", "newton_iterations", "linear_solves", "line_search_trials", "solve_s", "steps", "linear_solver",
                                   "linear_iterations", "scene_free_dofs", "comparability_verdict", "dt_s", "time_linear_factor_s", "time_linear_solve_s"])
EMPTY = SweepRecords("none", Records(EMPTY_RUNS, *[pd.DataFrame()] * 3), Path("nowhere"))
FAILED_RUN = {"run": "a", "series": "strip log", "group": "g", "formulation": "log", "outcome": "nan", "valid": False, "newton_iterations": 1, "linear_solves": 1, "line_search_trials": 1, "solve_s": 1.0,
              "steps": 1, "linear_solver": "pcg", "linear_iterations": 1, "scene_free_dofs": 9, "comparability_verdict": "not_valid", "dt_s": 0.1, "time_linear_factor_s": 0.1, "time_linear_solve_s": 0.1}
FAILED = SweepRecords("none", Records(pd.DataFrame([FAILED_RUN]), *[pd.DataFrame()] * 3), Path("nowhere"))


@pytest.mark.parametrize("subject", [EMPTY, FAILED])
@pytest.mark.parametrize(("draw", "options"), [
    (profiles.performance_profile, profiles.OPTIONS), (profiles.data_profile, profiles.OPTIONS), (heat_map.figure, heat_map.OPTIONS), (heat_map.success_frontier, heat_map.OPTIONS),
    (one_step.newton_condition, {}), (matrices.preconditioned, {}), (one_step.step_lengths, {}), (phase_times.figure, phase_times.OPTIONS), (scaling.figure, {}), (step_front.figure, {})])
def test_a_figure_without_a_subject_is_refused(tmp_path, subject, draw, options):
    with pytest.raises(UserError, match="figure mine: nothing to draw: "):
        draw(subject, Drawing("mine", "Title", tmp_path / "mine", 7.0, options))
    assert not list(tmp_path.iterdir())


def test_a_trend_of_one_commit_is_refused(tmp_path):
    one = pd.DataFrame([{"at": 0, "commit": "a", "day": "2026-01-01", "case": "strip-log", "metric": "newton_iterations", "value": 1.0, "lower": 1.0, "upper": 1.0}])
    with pytest.raises(UserError, match="no case has baselines of two commits"):
        trend.figure(one, Drawing("mine", "Title", tmp_path / "mine", 7.0, trend.OPTIONS))


def test_six_formulations_are_too_many_for_a_figure(tmp_path):
    numbers = pd.DataFrame({"formulation": list("abcdef")})
    with pytest.raises(UserError, match="found a, b, c, d, e, f; at most 5 formulations"):
        Drawing("mine", "Title", tmp_path / "mine", 7.0, {}).save(None, numbers, "", Facts("1", "1", "1", "1"))


def pixels(png: Path) -> int:
    return struct.unpack(">I", png.read_bytes()[16:20])[0]


@pytest.fixture(scope="module")
def runs(tmp_path_factory) -> Path:
    """Where the runs of figures are kept for all tests of this file: what is there is not run again."""
    return tmp_path_factory.mktemp("runs")


@pytest.mark.parametrize(("name", "inches"), [("barrier_shapes", 7.0), ("friction_slope", 7.0)])
def test_a_rebuild_has_the_same_bytes_and_the_width_of_a_journal(program, runs, tmp_path, monkeypatch, name, inches):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    for out in ("a", "b"):
        assert rebuild.main([name, "--quick", "--runs", str(runs), "--out", str(tmp_path / out)]) == 0

    files = sorted(path.name for path in (tmp_path / "a").iterdir())
    assert files == sorted(f"{name}{suffix}" for suffix in SUFFIXES)
    for file in files:
        one, two = ((tmp_path / out / file).read_bytes() for out in ("a", "b"))
        assert len(one) > 50 and hashlib.sha256(one).digest() == hashlib.sha256(two).digest(), file
    assert pixels(tmp_path / "a" / f"{name}.png") == inches * 200
    caption = (tmp_path / "a" / f"{name}.txt").read_text().replace("\n", " ")
    assert all(word in caption for word in ("N: ", "Statistic: ", "Reference: ", "Conditions: "))


@pytest.mark.usefixtures("unpainted")
def test_friction_beside_its_closed_form(program, runs, tmp_path, monkeypatch):
    """Records of the program, not of this file: what slides keeps to g (sin - mu cos) within 1 %, what sticks creeps below eps_v."""
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    assert rebuild.main(["friction_slope", "--quick", "--runs", str(runs), "--out", str(tmp_path)]) == 0
    found = pd.read_csv(tmp_path / "friction_slope.csv")
    slides, sticks = found[found["mu"] < 0.35], found[found["mu"] > 0.5]

    assert len(slides) == 12 and len(sticks) == 9
    assert ((slides["acceleration_m_per_s2"] / slides["closed_form_m_per_s2"] - 1).abs() < 0.01).all()
    assert (sticks["speed_m_per_s"] < sticks["eps_v_m_per_s"]).all() and (sticks["closed_form_m_per_s2"] == 0).all()


@pytest.mark.usefixtures("unpainted")
def test_a_stack_bears_what_lies_above(program, runs, tmp_path, monkeypatch):
    """Records of the program: at rest each of the four layers, all of one weight, bears that of the layers above it."""
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    assert rebuild.main(["stack_forces", "--quick", "--runs", str(runs), "--out", str(tmp_path)]) == 0
    found = pd.read_csv(tmp_path / "stack_forces.csv")
    assert len(found) == 2 * 40 * 4 and set(found["formulation"]) == {"log", "cubic"}
    last = found[found["t_s"] == found["t_s"].max()]
    weight = 2.943  # N: 17.32 kg/m^2 on a triangle with sides of 0.2 m, times 9.81 m/s^2
    for pair, layers in (("layer0, floor", 4), ("layer0, layer1", 3), ("layer1, layer2", 2), ("layer2, layer3", 1)):
        borne = last[last["pair"] == pair]["normal_N"]
        assert len(borne) == 2 and borne.to_numpy() == pytest.approx(layers * weight, rel=0.05)
