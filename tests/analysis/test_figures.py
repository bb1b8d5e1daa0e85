"""Figures: the files are there, the CSV holds the record's numbers, the bytes do not depend on the day."""

import hashlib
import json
import subprocess
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest

from barrierbench_analysis.tables import run_words
from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.plots import barrier_shapes, condition, demo, kappa_cycle, over_time
from barrierbench_analysis.figures.plots import verb as figures_verb
from barrierbench_analysis.tables.records import load
from barrierbench_analysis.io.record_file import sha256_of
from barrierbench_analysis.tables.table import as_text, summary_table
from synthetic import write_cycle, write_run, write_set

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("draw", [condition.figure, over_time.iterations, over_time.gaps])
def test_files_exist_and_are_the_same_twice(records, tmp_path, draw):
    paths = draw(records, "strip", tmp_path / "a")
    again = draw(records, "strip", tmp_path / "b")

    assert [p.suffix for p in paths] == [".png", ".pdf", ".csv", ".txt", ".svg", ".dat"]
    for one, two in zip(paths, again):
        assert one.stat().st_size > 100
        assert hashlib.sha256(one.read_bytes()).digest() == hashlib.sha256(two.read_bytes()).digest(), one


def test_pdf_fonts_are_truetype(records, tmp_path):
    pdf = over_time.gaps(records, "strip", tmp_path)[1].read_bytes()

    assert b"/Type3" not in pdf
    assert b"CIDFontType2" in pdf


@pytest.mark.usefixtures("unpainted")
def test_condition_numbers_beside_the_figure_are_the_traces(records, tmp_path):
    table = pd.read_csv(condition.figure(records, "strip", tmp_path)[2])

    assert len(table) == 4 * 6 * 2
    for scaling in ("none", "block_jacobi"):
        ours = table[(table["series"] == "cubic") & (table["scaling"] == scaling)]
        theirs = records.cond[(records.cond["run"] == "cubic") & (records.cond["scaling"] == scaling)]
        for field in ("cond", "lambda_min", "lambda_max", "status", "n"):
            assert list(ours[field]) == list(theirs[field])


@pytest.mark.usefixtures("unpainted")
def test_gaps_and_iterations_beside_the_figures_are_the_steps(records, tmp_path):
    gap = pd.read_csv(over_time.gaps(records, "strip", tmp_path)[2])
    work = pd.read_csv(over_time.iterations(records, "strip", tmp_path)[2])

    assert list(gap[gap["series"] == "log"]["gap_min_rel"]) == [0.2, 0.1]
    newton = work[(work["what"] == "newton_per_step") & (work["series"] == "log")]
    pcg = work[(work["what"] == "probe_pcg") & (work["series"] == "log")]
    assert list(newton["count"]) == [2, 2, 2]
    assert list(pcg["count"]) == [10, 10, 11, 11, 12, 12]


@pytest.mark.usefixtures("unpainted")
@pytest.mark.parametrize(("whose", "word"), [("", "contacts"), ("limit_", "strain limit")])
def test_the_kappa_that_does_not_settle_is_drawn_in_its_step_over_its_own_gap(tmp_path, monkeypatch, whose, word):
    titles, save = [], style.save
    monkeypatch.setattr(style, "save", lambda fig, *rest: titles.append(fig.get_suptitle()) or save(fig, *rest))
    write_set(tmp_path / "runs")
    write_cycle(tmp_path / "runs" / "quadratic", change=0.8, whose=whose)
    table = pd.read_csv(kappa_cycle.figure(load(tmp_path / "runs"), "strip", tmp_path)[2])

    assert f"kappa of the {word}, refreshed" in titles[0]
    assert set(table["kappa"]) == {word}
    assert set(table["step"]) == {3}
    assert list(table["kappa_change_rel"]) == [0.8] * 12
    assert list(table["gap_min_iterates_rel"]) == [0.1, 0.6] * 6


@pytest.mark.parametrize(("run", "change"), [("quadratic", 1e-3), ("log", 0.8)])
def test_a_kappa_that_settles_or_a_run_that_ended_ok_is_no_cycle(tmp_path, run, change):
    write_set(tmp_path / "runs")
    write_cycle(tmp_path / "runs" / run, change=change)

    assert kappa_cycle.figure(load(tmp_path / "runs"), "strip", tmp_path) == []


def test_failed_and_not_comparable_runs_are_hollow_and_named(records):
    _, axis = plt.subplots()
    runs = records.runs.set_index("series", drop=False)
    for name in ("log", "cubic_dynamic", "quadratic"):
        style.draw(axis, np.array([0, 1]), np.array([1.0, 2.0]), runs.loc[name])
    log, dynamic, quadratic, failure = axis.lines

    assert log.get_markerfacecolor() == style.LOOKS["log"].color
    assert dynamic.get_markerfacecolor() == "none"
    assert quadratic.get_markerfacecolor() == "none"
    assert dynamic.get_label() == "cubic_dynamic (not_comparable)"
    assert quadratic.get_label() == "quadratic (newton_stall)"
    assert failure.get_gid() == style.FAILURE and failure.get_marker() == "x"
    assert failure.get_xydata().tolist() == [[1, 2.0]] and failure.get_color() == quadratic.get_color()
    assert len(axis.get_legend_handles_labels()[1]) == 3 and not axis.texts
    plt.close("all")


def test_comparability_is_read_and_never_computed(tmp_path):
    """Whatever the gaps are: an invalid run that is no failure, a reference far away, a run without a reference."""
    write_run(tmp_path / "runs", "log", 1.0, 0.10, note="strip: log", verdict="not_valid")
    write_run(tmp_path / "runs", "cubic", 2.0, 1e-6, note="strip: cubic")
    write_run(tmp_path / "runs", "quadratic", 2.0, 0.1, note="strip: quadratic", verdict="no_reference")
    runs = load(tmp_path / "runs").runs.set_index("series", drop=False)

    assert [run_words.name_of(runs.loc[name]) for name in ("log", "cubic", "quadratic")] == ["log (not_valid)", "cubic", "quadratic"]
    verdicts = summary_table(load(tmp_path / "runs")).set_index("series")["verdict"]
    assert verdicts["log"] == "ok, not_valid" and verdicts["cubic"] == verdicts["quadratic"] == "ok"


def version(root: Path, name: str, number: str) -> None:
    path = root / name / "run.json"
    record = json.loads(path.read_text())
    record["schema"]["version"] = number
    path.write_text(json.dumps(record))


@pytest.mark.usefixtures("unpainted")
def test_verdicts_of_an_earlier_rule_are_marked_and_the_rule_is_stated(tmp_path, capsys):
    """cubic and cubic_dynamic were judged by the smallest gap of the run; quadratic failed, which means the same in every version."""
    write_set(tmp_path / "runs")
    for name in ("cubic", "cubic_dynamic", "quadratic"):
        version(tmp_path / "runs", name, "3.4.0")
    records = load(tmp_path / "runs")
    assert "3 of 4 records are of before 3.5.0, in which these fields mean something else: comparability.verdict" in capsys.readouterr().err
    runs = records.runs.set_index("series", drop=False)
    assert [run_words.name_of(runs.loc[name]) for name in ("log", "cubic", "cubic_dynamic", "quadratic")] == [
        "log", "cubic (comparable by the rule before 3.5.0)", "cubic_dynamic (not_comparable by the rule before 3.5.0)", "quadratic (newton_stall)"]
    text = as_text(summary_table(records))
    assert "ok, not_comparable by the rule before 3.5.0" in text and "ok, comparable by the rule before 3.5.0" in text
    rule = run_words.hollow_rule(records.runs).replace("\n", " ")
    assert "between two bodies" in rule and "by the rule before 3.5.0, with reference log, comparable: the smallest gap of the run" in rule
    assert "by the rule before 3.5.0" in " ".join(over_time.gaps(records, "strip", tmp_path / "out")[3].read_text().split())
    version(tmp_path / "runs", "log", "3.4.0")
    only = run_words.hollow_rule(load(tmp_path / "runs").runs).replace("\n", " ")
    assert only.startswith("hollow markers: the run failed, is not valid or not comparable; by the rule before 3.5.0") and "between two bodies" not in only


def test_records_of_this_version_have_no_other_rule(records, capsys):
    assert "mean something else" not in capsys.readouterr().err
    assert not any("by the rule" in run_words.name_of(row) for _, row in records.runs.iterrows()) and "before" not in run_words.hollow_rule(records.runs)


def test_the_legend_states_the_rule_of_hollow_markers_and_its_reference(records):
    rule = run_words.hollow_rule(records.runs).replace("\n", " ")
    assert "converged step ends" in rule and "factor 2 of log" in rule
    fig, axis = plt.subplots()
    style.draw(axis, np.array([0, 1]), np.array([1.0, 2.0]), records.runs.iloc[0])
    style.legend_below(fig, axis, records.runs)
    assert fig.legends[0].get_title().get_text() == run_words.hollow_rule(records.runs)
    plt.close("all")


def test_looks_differ_in_colour_marker_and_dash_pairwise():
    looks = [(k.color, k.marker) for k in style.LOOKS.values()]
    assert len({c for c, _ in looks}) == len(looks)
    assert len({m for _, m in looks}) == len(looks)
    assert style.look("never heard of") == style.look("never heard of")


def test_table_takes_medians_of_the_logarithm_over_sure_values(records):
    table = summary_table(records).set_index("series")

    assert table.loc["log", "cond_raw_median"] == pytest.approx(100)  # 10, 10, 100, 100, 1000
    assert table.loc["log", "cond_raw_max"] == 1000
    assert table.loc["cubic", "cond_bj_median"] == pytest.approx(4)
    assert table.loc["quadratic", "verdict"] == "newton_stall"
    assert table.loc["cubic_dynamic", "verdict"] == "ok, not_comparable"
    text = as_text(summary_table(records))
    assert len(text.splitlines()) == 5
    assert "1.00e+02" in text


@pytest.mark.usefixtures("unpainted")
def test_barrier_shapes_come_from_the_program(program, tmp_path, monkeypatch):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    table = pd.read_csv(barrier_shapes.figure(tmp_path)[2])

    cubic = table[table["name"] == "cubic"]
    np.testing.assert_allclose(cubic["minus_db"], 2 * (1 - cubic["u"]) ** 2, rtol=1e-12)
    np.testing.assert_allclose(cubic["rho"], 2 / (1 - cubic["u"]), rtol=1e-12)
    runs = pd.DataFrame({"shape": ["two_stage", "log", "two_stage"], "argument": ["gap", "squared_gap", "gap"]})
    table = pd.read_csv(barrier_shapes.figure(tmp_path / "of_runs", runs)[2])
    assert list(dict.fromkeys(table["name"])) == ["two_stage", "log on squared_gap"]
    squared = table[table["name"] == "log on squared_gap"]
    np.testing.assert_allclose(squared["b"], -((squared["u"] ** 2 - 1) ** 2) * np.log(squared["u"] ** 2), rtol=1e-12)


@pytest.mark.usefixtures("unpainted")
def test_a_shape_of_a_plugin_is_drawn_while_its_file_is_there(program, tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    library = tmp_path / "inverse.so"
    command = ["g++", "-shared", "-fPIC", "-O1", "-std=c++20", f"-I{ROOT}", "-o", library, ROOT / "examples/plugins/inverse_shape.cpp"]
    subprocess.run(command, check=True)
    runs = pd.DataFrame({"shape": ["log", "inverse"], "argument": ["gap", "gap"], "plugin_files": [(), ((str(library), sha256_of(library)),)]})

    table = pd.read_csv(barrier_shapes.figure(tmp_path / "with", runs)[2])
    assert set(table["name"]) == {"log", "inverse"} and np.isfinite(table["b"]).all() and (table[table["name"] == "inverse"]["minus_db"] > 0).all()
    assert capsys.readouterr().err == ""

    library.write_bytes(b"another")
    table = pd.read_csv(barrier_shapes.figure(tmp_path / "without", runs)[2])
    said = capsys.readouterr().err
    assert set(table["name"]) == {"log"} and str(library) in said and "inverse" in said


def test_demo_makes_everything_and_names_failures(program, tmp_path, monkeypatch):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    write_set(tmp_path / "runs")

    text = demo.make_all_of(load(tmp_path / "runs"), tmp_path / "out")

    assert "strip: quadratic ended newton_stall: step 2 ended at its cap" in text
    names = {p.name for p in (tmp_path / "out").iterdir()}
    expected = {f"{stem}.{suffix}" for stem in ("condition_strip", "iterations_strip", "gaps_strip", "barrier_shapes", "answer")
                for suffix in ("png", "pdf", "csv", "txt", "svg", "dat")}
    assert names == expected | {"table.csv"}


def test_a_folder_without_runs_is_one_clear_line(tmp_path, capsys):
    assert figures_verb.main([str(tmp_path)]) == 2
    assert "no run.json" in capsys.readouterr().err
