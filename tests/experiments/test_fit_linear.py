"""The cost model of linear solvers: the fit gives back known coefficients, and the program expects what the fit expects."""

import json
import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from barrierbench_analysis import fit_linear
from barrierbench_analysis.records import RecordError, load

ROOT = Path(__file__).resolve().parents[2]
SCENES = [{"/scene/layers": 1, "/scene/n": 4}, {"/scene/layers": 1, "/scene/n": 8}, {"/scene/layers": 2, "/scene/n": 8}]
SOLVERS = [{"/linear_solver/name": "cholmod"}, {"/linear_solver/name": "pcg", "/linear_solver/preconditioner": "ic0"}]


def bench(program: str, *arguments, configs: Path = ROOT / "configs") -> subprocess.CompletedProcess:
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False, timeout=240,
                          env={**os.environ, "BARRIERBENCH_CONFIGS": str(configs)})


@pytest.fixture(scope="module")
def records(program, tmp_path_factory):
    """The sweep of ./bench fit-linear on three tiny scenes and by two solvers."""
    folder = tmp_path_factory.mktemp("fit")
    sweep = json.loads((ROOT / "configs/sweeps/linear_fit.json").read_text())
    sweep["base"] = str(ROOT / "configs/scenes/drape.json")
    sweep["set"]["/time/steps"] = 2
    sweep["axes"] = [{"cases": [{"label": str(i), "set": case} for i, case in enumerate(cases)]} for cases in (SCENES, SOLVERS)]
    (folder / "sweep.json").write_text(json.dumps(sweep))
    done = bench(program, "sweep", folder / "sweep.json", "--out", folder / "runs")
    assert done.returncode == 0, done.stderr
    return load(folder / "runs")


def test_the_fit_gives_back_coefficients_that_made_the_times():
    terms = np.array([fit_linear.work_terms(*work) for work in [(10, 50, 80, 1e3), (100, 700, 2e3, 5e4), (1e3, 9e3, 4e4, 3e6), (1e4, 1e5, 9e5, 2e8)]])
    for each in ([1e-5, 2e-8, 0, 3e-9, 1e-10], [0, 0, 1e-9, 0, 0], [1e-4, 0, 0, 0, 1e-10]):
        seconds = terms @ np.array(each)
        fitted = fit_linear.non_negative_fit(terms, seconds)
        assert (fitted >= 0).all() and fitted.max() > 0
        assert terms @ fitted == pytest.approx(seconds, rel=1e-6)


def test_a_term_that_would_be_negative_is_left_out():
    terms = np.array([[1.0, 1.0], [1.0, 2.0], [1.0, 4.0]])
    fitted = fit_linear.non_negative_fit(terms, np.array([3.0, 2.0, 1.0]))  # falls with the second term
    assert fitted[1] == 0
    assert fitted[0] == pytest.approx((1 / 3 + 1 / 2 + 1) / (1 / 9 + 1 / 4 + 1))  # the least squares of c/t - 1


def test_measurements_have_times_and_the_work_of_the_first_matrix(records):
    table = fit_linear.measurements(records)
    assert len(table) == len(SCENES) * len(SOLVERS)
    assert (table["seconds"] > 0).all()
    assert table.groupby("scene")["factor_flop"].nunique().eq(1).all() and table["factor_flop"].nunique() == 3
    assert sorted(set(table["preconditioner"])) == ["", "ic0"]


def test_the_program_expects_the_seconds_of_the_fit_and_takes_the_cheapest(program, records, tmp_path):
    content, table = fit_linear.model(records)
    (tmp_path / "linear_models").mkdir()
    (tmp_path / "formulations").symlink_to(ROOT / "configs/formulations")
    (tmp_path / "linear_models/here.json").write_text(json.dumps(content))
    for i, scene in enumerate(SCENES):
        settings = [word for pointer, value in scene.items() for word in ("--set", f"{pointer}={value}")]
        done = bench(program, "explain", ROOT / "configs/scenes/drape.json", "--set", "/linear_solver/name=auto", *settings, configs=tmp_path)
        assert done.returncode == 0, done.stderr
        line = next(line for line in done.stdout.splitlines() if line.strip().startswith("linear_solver"))
        rows = table[table["scene"] == str(i)]
        said = {name: float(seconds) for name, seconds in re.findall(r"(cholmod|pcg with ic0) ([0-9.e-]+) s", line)}
        expected = dict(zip(rows["solver"] + rows["preconditioner"].map(lambda p: f" with {p}" if p else ""), rows["expected"]))
        assert said == pytest.approx(expected, rel=5e-3)  # three digits are printed, four are kept
        assert line.split()[1] == f"{min(expected, key=expected.get).split()[0]},"


def test_a_run_with_auto_is_a_run_with_the_chosen_solver(program, records, tmp_path):
    content, _ = fit_linear.model(records)
    (tmp_path / "linear_models").mkdir()
    (tmp_path / "formulations").symlink_to(ROOT / "configs/formulations")
    (tmp_path / "linear_models/here.json").write_text(json.dumps(content))
    small = ["--set", "/scene/n=6", "--set", "/scene/layers=1", "--set", "/time/steps=2", "--set", "/passes/diagnose=true"]
    for number, rule in enumerate(("equal_force", "as_given")):  # with a pilot, and without
        given = ["--set", f"/matching/rule={rule}", "--set", "/formulation=cubic_dynamic_consistent"]
        done = bench(program, "run", ROOT / "configs/scenes/drape.json", *small, *given, "--set", "/linear_solver/name=auto", "--out", tmp_path / str(number), configs=tmp_path)
        assert done.returncode == 0, done.stderr
        record = json.loads((tmp_path / str(number) / "run.json").read_text())
        assert record["status"]["outcome"] == "ok", record["status"]
        solver = record["labels"]["linear_solver"]
        assert solver in ("cholmod", "pcg") and record["config"]["linear_solver"]["name"] == solver  # nothing is left to be decided
        reason = next(item["reason"] for item in record["plan"] if item["item"] == "linear_solver")
        assert reason.startswith(f"{solver}, by auto: ")
    again = bench(program, "run", tmp_path / "1/run.json", "--out", tmp_path / "again")  # no model is needed
    assert again.returncode == 0, again.stderr


def test_records_that_cannot_be_fitted_are_refused(records):
    few = records.runs["series"].str.startswith(("0", "1"))
    with pytest.raises(RecordError, match="2 scenes"):
        fit_linear.model(type(records)(records.runs[few], records.steps, records.trace, records.cond))
    other = records.runs.assign(machine_cpu_model=["a"] + ["b"] * (len(records.runs) - 1))
    with pytest.raises(RecordError, match="several machines: a, b"):
        fit_linear.model(type(records)(other, records.steps, records.trace, records.cond))
    builds = records.runs.assign(build_id=["a"] + ["b"] * (len(records.runs) - 1))
    with pytest.raises(RecordError, match="2 builds"):
        fit_linear.model(type(records)(builds, records.steps, records.trace, records.cond))
    no_factor = records.runs["linear_solver"] != "cholmod"
    with pytest.raises(RecordError, match="no record of cholmod"):
        fit_linear.model(type(records)(records.runs[no_factor], records.steps, records.trace, records.cond))
