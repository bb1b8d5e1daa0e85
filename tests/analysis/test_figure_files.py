"""What every figure keeps: caption, letters, words on lines, axes that magnify nothing, looks that differ, matrices that are not mixed."""

import json

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.plots import barrier_shapes, condition, matrix_forms, over_time
from barrierbench_analysis.tables.records import load
from synthetic import bind, write_run, write_set


@pytest.mark.usefixtures("unpainted")
@pytest.mark.parametrize("draw", [condition.figure, over_time.iterations, over_time.gaps, barrier_shapes.figure])
def test_a_caption_stands_beside_every_figure(records, program, tmp_path, monkeypatch, draw):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    paths = draw(tmp_path) if draw is barrier_shapes.figure else draw(records, "strip", tmp_path)
    text = paths[3].read_text()
    if draw is barrier_shapes.figure:
        assert "d_hat" in text and "shapes of the runs" in text.replace("\n", " ")
    else:
        for part in ("strip", "hollow markers", "matching_rule equal_force", "Machine: a cpu, 2 cores", "BLAS: Haswell", "2024-01-31 (UTC), 4 runs"):
            assert part in text.replace("\n", " "), part


def lettered(fig) -> list[str]:
    return [axis.get_title(loc="left") for axis in fig.axes]


def test_panels_have_letters_and_reference_lines_have_words(records, tmp_path, monkeypatch):
    figures = {}
    monkeypatch.setattr(style, "save", lambda fig, stem, *_: [figures.setdefault(stem.name, fig)])
    condition.figure(records, "strip", tmp_path)
    over_time.iterations(records, "strip", tmp_path)
    over_time.gaps(records, "strip", tmp_path)
    assert lettered(figures["condition_strip"]) == ["(a)", "(b)"]
    assert lettered(figures["iterations_strip"]) == ["(a)", "(b)", "(c)"]
    axis = figures["gaps_strip"].axes[0]
    lines = [line.get_ydata()[0] for line in axis.lines if line.get_gid() == style.REFERENCE]
    words = [text.get_text() for text in axis.texts]
    assert lines == [1, 0.2] and any("contact begins" in w for w in words) and any("0.2" in w and "matched" in w for w in words)
    plt.close("all")


def test_steps_are_drawn_as_steps_and_shares_start_at_0(records, tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr(style, "save", lambda fig, *_: [figures.append(fig)])
    over_time.iterations(records, "strip", tmp_path)
    of_steps, shares, pcg = figures[0].axes
    runs = [line for line in of_steps.lines if line.get_gid() != style.FAILURE]
    assert {line.get_drawstyle() for line in runs} == {"steps-mid"}
    assert {line.get_drawstyle() for axis in (shares, pcg) for line in axis.lines} == {"steps-post"}
    for line in (*shares.lines, *pcg.lines):
        assert line.get_ydata()[0] == 0 and line.get_ydata()[-1] == 1
    plt.close("all")


@pytest.mark.parametrize("end", [0.04, 0.03])
def test_no_line_of_the_condition_figure_is_cut(tmp_path, monkeypatch, end):
    """The stalled run goes on for 200 iterations in its last step; all are drawn, inside that step, even where it got nowhere."""
    write_set(tmp_path / "runs")
    lines = [json.loads(line) for line in (tmp_path / "runs/quadratic/trace.jsonl").read_text().splitlines()]
    more = [lines[-2] | {"step": 3, "iteration": k} for k in range(200)]
    (tmp_path / "runs/quadratic/trace.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines + more))
    record = json.loads((tmp_path / "runs/quadratic/run.json").read_text())
    record["summary"]["newton_iterations"] += len(more)
    record["steps"].append(record["steps"][-1] | {"step": 3, "t_s": end})
    (tmp_path / "runs/quadratic/run.json").write_text(json.dumps(record))
    bind(tmp_path / "runs/quadratic")
    figures = []
    monkeypatch.setattr(style, "save", lambda fig, *_: [figures.append(fig)])
    condition.figure(load(tmp_path / "runs"), "strip", tmp_path)
    axis = figures[0].axes[0]
    x = {line.get_label(): line.get_xdata() for line in axis.lines if len(line.get_xdata())}["quadratic (newton_stall)"]
    assert len(x) == 5 + 200 and (np.diff(x) > 0).all() and 0.03 <= x[5] and x[-1] < 0.04
    assert axis.get_xlim()[1] >= x[-1]
    plt.close("all")


@pytest.mark.parametrize(("values", "scale", "least"), [([100.0, 101.0], "linear", 25), ([1.0, 1.01], "log", None), ([0.0, 0.0], "linear", None)])
def test_an_axis_never_magnifies_one_percent(values, scale, least):
    _, axis = plt.subplots()
    axis.plot([0, 1], values)
    axis.set_yscale(scale)
    style.keep_span(axis)
    low, high = axis.get_ylim()
    assert low <= min(values) and high >= max(values)
    if scale == "log":
        assert high / low >= 2
    elif least:
        assert high - low >= least
    plt.close("all")


def test_a_wide_axis_stays_as_it_is():
    _, axis = plt.subplots()
    axis.plot([0, 1], [1.0, 3.0])
    before = axis.get_ylim()
    style.keep_span(axis)
    style.reference_line(axis, 2, "two")
    style.keep_span(axis)
    assert axis.get_ylim() == before
    style.reference_line(axis, 5, "five")
    assert axis.get_ylim()[1] >= 5
    plt.close("all")


def test_series_of_a_d_hat_axis_are_told_apart(tmp_path):
    for k, d_hat in enumerate(("0.01", "0.005", "0.0025")):
        write_run(tmp_path / "runs", "log", 1.0, 0.1, note=f"strip: log d_hat_m={d_hat}", folder=f"log{k}")
        write_run(tmp_path / "runs", "cubic", 1.0, 0.1, note=f"strip: cubic d_hat_m={d_hat}", folder=f"cubic{k}")
    runs = style.runs_of(load(tmp_path / "runs").runs, "strip")
    looks = [style.look(row["formulation"], row["variant"]) for _, row in runs.iterrows()]
    assert len({(look.color, look.dash) for look in looks}) == 6
    assert len({look.color for look in looks}) == 6 and len({look.dash for look in looks}) >= 4
    assert {look.marker for look in looks} == {"o", "^"}  # the formulation is still seen


def test_the_plain_run_of_a_formulation_keeps_its_look(tmp_path):
    write_run(tmp_path / "runs", "cubic", 1.0, 0.1, note="strip: cubic slow", folder="a")
    write_run(tmp_path / "runs", "cubic", 1.0, 0.1, note="strip: cubic", folder="b")
    runs = style.runs_of(load(tmp_path / "runs").runs, "strip").set_index("series")
    assert dict(runs["variant"]) == {"cubic": 0, "cubic slow": 1}
    assert style.look("cubic", 0) == style.LOOKS["cubic"] != style.look("cubic", 1)


def test_clamped_and_solved_matrices_are_drawn_apart_and_never_mixed(tmp_path):
    write_set(tmp_path / "runs")
    trace = tmp_path / "runs" / "log" / "trace.jsonl"
    lines = [json.loads(line) for line in trace.read_text().splitlines()]
    for line in lines:
        line["cond"] = [{**sample, "matrix": "clamped"} for sample in line["cond"]]
        line["cond"] += [{**sample, "matrix": "solved", "cond": 7.0 * sample["cond"]} for sample in line["cond"]]
    trace.write_text("".join(json.dumps(line) + "\n" for line in lines))
    bind(trace.parent)
    records = load(tmp_path / "runs")

    table = pd.read_csv(matrix_forms.figure(records, "strip", tmp_path)[2])
    assert set(table["run"]) == {"log"} and len(table) == 2 * 11  # 6 iterations, 2 scalings; a bound is not drawn
    clamped, solved = (table[table["matrix"] == form]["cond"].to_numpy() for form in ("clamped", "solved"))
    np.testing.assert_allclose(solved, 7 * clamped)
    plain = pd.read_csv(condition.figure(records, "strip", tmp_path)[2])
    assert len(plain) == 4 * 6 * 2  # the other figures keep to the clamped ones


def test_a_bound_of_a_clamped_matrix_is_a_fork_and_the_run_is_named(tmp_path, monkeypatch):
    write_set(tmp_path / "runs")
    trace = tmp_path / "runs" / "log" / "trace.jsonl"
    lines = [json.loads(line) for line in trace.read_text().splitlines()]
    for line in lines:
        clamped = [{**sample, "matrix": "clamped", "status": "lower_bound", "cond": 1e14} for sample in line["cond"]]
        line["cond"] = clamped + [{**sample, "matrix": "solved", "status": "ok", "cond": 70.0} for sample in line["cond"]]
    trace.write_text("".join(json.dumps(line) + "\n" for line in lines))
    bind(trace.parent)
    drawn = []
    monkeypatch.setattr(style, "save", lambda fig, *_: drawn.append(fig) or [])
    matrix_forms.figure(load(tmp_path / "runs"), "strip", tmp_path)
    [fig] = drawn
    assert "run log" in fig.get_suptitle()
    forks = [line for axis in fig.axes for line in axis.lines if line.get_marker() == "2" and len(line.get_ydata())]
    assert len(forks) == 2 and all(set(line.get_ydata()) == {1e14} for line in forks)


def test_records_without_solved_matrices_have_no_such_figure(records, tmp_path):
    assert matrix_forms.figure(records, "strip", tmp_path) == []
