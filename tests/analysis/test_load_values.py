"""Every column of the tables against the field of the record that it is named after."""

import json

import pytest

from barrierbench_analysis.figures.plots import kappa_cycle
from barrierbench_analysis.tables.records import condition_of, load
from barrierbench_analysis.tables.run_words import name_of
from barrierbench_analysis.tables.table import as_text, summary_table
from synthetic import bind, digest, write_cycle, write_run, write_set


def edit(folder, change) -> None:
    """Applies `change` to the record in `folder`."""
    path = folder / "run.json"
    record = json.loads(path.read_text())
    change(record)
    path.write_text(json.dumps(record))


def edit_trace(folder, change) -> None:
    path = folder / "trace.jsonl"
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    for line in lines:
        change(line)
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    bind(folder)


def test_numbers_of_a_run_come_from_their_own_fields(tmp_path):
    write_run(tmp_path, "cubic", 1.0, 0.25)

    def distinct(record):
        stats = {name: 100.0 + k for k, name in enumerate(("min", "p05", "median", "p95", "max", "sum"))}
        record["summary"]["gap_min_rel"] = {"n": 3, **stats}
        record["summary"]["probe_pcg"] = {"n": 3, **stats}
        record["audit"] |= {"judged": 11, "crossings": 12, "violations": 13, "unproven": 14, "obstacle_violations": 15, "scene_faults": 16}
        record["status"] |= {"valid": False, "detail": "why"}
        record["scene"] = {"free_dofs": 17, "extent_m": 18.0}
        record["matching"] = {"rule": "equal_force", "load_N": 19.0, "scale": 20.0}
        record["comparability"] |= {"verdict": "not_comparable", "reason": "far", "reference_gap_rel": 21.0, "ratio": 22.0, "max_ratio": 23.0}

    edit(tmp_path / "cubic", distinct)
    run = load(tmp_path).runs.iloc[0]

    assert run["gap_min_rel_min"] == 100 and run["probe_pcg_median"] == 102
    assert [run[f"audit_{k}"] for k in ("judged", "crossings", "violations", "unproven", "obstacle_violations", "scene_faults")] == [11, 12, 13, 14, 15, 16]
    assert not run["valid"] and run["detail"] == "why" and run["outcome"] == "ok"
    assert (run["scene_free_dofs"], run["scene_extent_m"], run["matching_load_N"], run["matching_scale"]) == (17, 18, 19, 20)
    assert run["matching_rule"] == "equal_force"
    assert (run["comparability_verdict"], run["comparability_reason"], run["comparability_reference_run"]) == ("not_comparable", "far", "log")
    assert (run["comparability_reference_gap_rel"], run["comparability_ratio"], run["comparability_max_ratio"]) == (21, 22, 23)
    assert (run["run"], run["folder"], run["run_id"], run["config_id"]) == ("cubic", "cubic", digest("run cubic"), digest("config cubic"))


def test_a_group_is_the_sweep_or_else_the_scene_and_a_series_the_case_or_else_the_formulation(tmp_path):
    write_run(tmp_path, "log", 1.0, 0.1, note="strip: log, stiff")
    write_run(tmp_path, "cubic", 1.0, 0.1, note="as_given")
    write_run(tmp_path, "quadratic", 1.0, 0.1)
    edit(tmp_path / "quadratic", lambda record: record["ids"].pop("sweep_id"))
    runs = load(tmp_path).runs.set_index("run")

    assert list(runs.loc[["log", "cubic", "quadratic"], "series"]) == ["log, stiff", "as_given", "quadratic"]
    assert list(runs.loc[["log", "cubic", "quadratic"], "group"]) == ["strip", "strip", "drape2d"]


def test_runs_stand_in_the_order_of_their_start_and_share_no_name(tmp_path):
    for k, name in enumerate(("c", "a", "b")):
        write_run(tmp_path / name, "log", 1.0, 0.1, note="strip: same")
        edit(tmp_path / name / "log", lambda record, k=k: record["status"].update(started_utc=f"2024-01-31T12:00:0{k}Z"))
    runs = load(tmp_path).runs

    assert list(runs["run"]) == ["c/log", "a/log", "b/log"]
    assert list(runs["series"]) == ["same", "same #2", "same #3"]


def test_names_of_configs_tell_runs_apart_and_group_scenes_that_are_given_as_bodies(tmp_path):
    notes = {"a": "my try: log", "b": "another: log", "c": "another: log", "d": "chain: log", "e": "block: log"}
    for name, note in notes.items():
        write_run(tmp_path / name, "log", 1.0, 0.1, note=note)
        edit(tmp_path / name / "log", lambda record: record["ids"].pop("sweep_id"))
    for name in "de":
        edit(tmp_path / name / "log", lambda record: record["labels"].update(scene="bodies"))
    runs = load(tmp_path).runs.set_index("run")
    assert list(runs.loc[[f"{k}/log" for k in "abc"], "series"]) == ["log (my try)", "log (another)", "log (another) #2"]
    assert list(runs.loc[["a/log", "d/log", "e/log"], "group"]) == ["drape2d", "chain", "block"]
    assert list(runs.loc[["d/log", "e/log"], "series"]) == ["log", "log"]


def test_conditions_are_of_one_run_scaling_and_stage_in_the_order_of_the_iterations(tmp_path):
    write_set(tmp_path)

    def with_stage(line):
        line["cond"].append(line["cond"][0] | {"stage": "without_contact", "cond": 5.0})

    edit_trace(tmp_path / "cubic", with_stage)
    records = load(tmp_path)
    full = condition_of(records, "cubic", "none")

    assert list(full["n"]) == list(range(6))
    assert list(full["cond"]) == [20, 20, 200, 200, 2000, 2000]
    assert set(full["scaling"]) == {"none"} and set(full["stage"]) == {"full"} and set(full["run"]) == {"cubic"}
    assert list(condition_of(records, "cubic", "none", "without_contact")["cond"]) == [5] * 6
    assert list(condition_of(records, "log", "block_jacobi")["cond"]) == [1, 1, 2, 2, 3, 3]


def test_a_table_counts_singular_matrices_as_the_largest_cond_and_no_audit_as_unknown(tmp_path):
    write_run(tmp_path, "log", 1.0, 0.1)
    write_run(tmp_path, "cubic", 1.0, 0.2)

    def singular(line):
        if line["step"] == 0:
            line["cond"][0] |= {"status": "singular", "cond": None}

    edit_trace(tmp_path / "log", singular)
    edit(tmp_path / "cubic", lambda record: record["audit"].update(enabled=False))
    table = summary_table(load(tmp_path)).set_index("series")

    assert table.loc["log", "cond_raw_max"] == 1e14
    assert table.loc["log", "cond_raw_median"] == pytest.approx(1000)  # 1e2 1e2 1e3 1e3 1e14 1e14
    assert table.loc["log", "cond_bj_max"] == 3
    assert table.loc["log", "crossings"] == 0
    assert table["crossings"].isna()["cubic"]
    assert dict(table["gap_min_rel"]) == {"log": 0.1, "cubic": 0.2}
    rows = as_text(summary_table(load(tmp_path))).splitlines()
    assert [row.split()[-1] for row in rows if " cubic " in row] == ["-"]


def test_hollow_runs_are_named_by_the_programs_own_verdict(tmp_path):
    write_set(tmp_path)
    edit(tmp_path / "cubic", lambda record: record["comparability"].update(verdict="not_valid"))
    table = summary_table(load(tmp_path)).set_index("series")

    assert dict(table["verdict"]) == {"log": "ok", "cubic": "ok, not_valid", "cubic_dynamic": "ok, not_comparable", "quadratic": "newton_stall"}


def test_a_run_that_was_not_asked_to_converge_says_which_residual_it_has(tmp_path):
    write_set(tmp_path)
    edit(tmp_path / "cubic", lambda record: record["summary"].update(convergence="not_asked", end_error_tolerances={"median": 42.0}))
    edit(tmp_path / "log", lambda record: record["summary"].update(convergence="asked", end_error_tolerances={"median": 0.5}))
    records = load(tmp_path)
    table = summary_table(records).set_index("series")

    assert table.loc["cubic", "verdict"] == "ok, not asked to converge, residual 42 tolerances"
    assert table.loc["log", "verdict"] == "ok"
    names = {row["series"]: name_of(row) for _, row in records.runs.iterrows()}
    assert names["cubic"] == "cubic (not asked to converge, residual 42 tolerances)"
    assert names["log"] == "log"


def test_the_median_condition_is_that_of_the_logarithms_for_each_scaling(tmp_path):
    write_run(tmp_path, "log", 1.0, 0.1)

    def two_values(line):
        large = line["step"] > 0 and line["iteration"] == 1 or line["step"] == 2
        line["cond"][0]["cond"], line["cond"][1]["cond"] = (1e6, 1e4) if large else (1e2, 1e2)

    edit_trace(tmp_path / "log", two_values)
    table = summary_table(load(tmp_path)).set_index("series")

    assert table.loc["log", "cond_raw_median"] == pytest.approx(1e4)  # three of 1e2, three of 1e6
    assert table.loc["log", "cond_bj_median"] == pytest.approx(1e3)
    assert (table.loc["log", "cond_raw_max"], table.loc["log", "cond_bj_max"]) == (1e6, 1e4)


def test_a_kappa_that_settles_within_the_last_iterations_is_no_cycle(tmp_path):
    write_set(tmp_path / "runs")
    folder = tmp_path / "runs" / "quadratic"
    write_cycle(folder, change=0.8)
    lines = (folder / "trace.jsonl").read_text().splitlines()
    last = json.loads(lines[-1]) | {"kappa_change_rel": 1e-3}
    (folder / "trace.jsonl").write_text("\n".join([*lines[:-1], json.dumps(last)]) + "\n")
    bind(folder)

    assert kappa_cycle.figure(load(tmp_path / "runs"), "strip", tmp_path) == []
