"""Every case of a sweep is a run of its own: what would undo itself, or differ in nothing, is refused before the first run."""

import json

import pytest

from barrierbench_analysis import load
from barrierbench_analysis.tables.table import as_text, summary_table
from test_cli import BLOCK, bench, refused, write

STEPS = {"pointer": "/time/steps", "values": [1, 2]}
STIFF = {"/matching/rule": "as_given", "/formulation/stiffness_policy/kappa_N_per_m": 1000}


def spec(tmp_path, *axes, **more):
    return write(tmp_path / "s.json", {"schema": "barrierbench.sweep/1", "name": "own", "base": BLOCK, "axes": list(axes), **more})


def case(label, **settings):
    return {"label": label, "set": settings}


ASSIGNED = case("a", **{"/time/steps=3": 1})


@pytest.mark.parametrize("axes, more, message", [
    ([{"pointer": "/seeds/main=x", "values": [1]}], {}, ["#/axes/0/pointer", "/seeds/main=x", "without \"=\""]),
    ([{"pointer": "/name=x", "values": [1, 2]}], {}, ["#/axes/0/pointer", "/name=x"]),
    ([STEPS], {"set": {"/time/dt_s=1": 3}}, ["#/set", "/time/dt_s=1"]),
    ([{"cases": [ASSIGNED]}], {}, ["#/axes/0/cases/0/set", "/time/steps=3"]),
    ([STEPS, {"pointer": "/time/steps", "values": [3]}], {}, ["#/axes/1", "axis 0 sets too"]),
    ([{"pointer": "/contact/ccd_park", "values": [1e-5]}, {"pointer": "/contact/min_gap_fraction", "values": [1e-5]}], {}, ["#/axes/1", "axis 0 sets too"]),  # the earlier name and the present one
    ([STEPS, {"cases": [case("a", **{"/time/steps": 3})]}], {}, ["#/axes/1", "/time/steps"]),
    ([{"cases": [case("a", **{"/time/steps": 1}), case("a", **{"/time/steps": 2})]}], {}, ["#/axes/0/cases/1/label", "\"a\" again"]),
    ([{"pointer": "/time/steps", "values": [1, 2, 1]}], {}, ["#/axes/0/values/2", "steps=1"]),
    ([{"pointer": "/formulation/name", "values": ["a/b", "a_b"]}], {}, ["#/axes/0/values/1", "name=a_b"]),
    ([{"cases": [case("a b", **{"/time/steps": 1}), case("a", **{"/time/steps": 2})]},
      {"cases": [case("c", **{"/time/dt_s": 0.01}), case("b c", **{"/time/dt_s": 0.02})]}], {}, ["#/axes", "two cases \"a b c\""]),
    ([{"cases": [case("one", **{"/time/steps": 3}), case("two", **{"/time": {"dt_s": 0.01, "steps": 3}})]}], {"set": {"/time/dt_s": 0.01}},
     ["[two]", "the same run as [one]"]),
    ([{"pointer": "/time/dt_s", "values": [0.01, 1e-2, 0.010]}], {}, ["again"]),
])
def test_what_is_not_a_run_of_its_own_is_refused(program, tmp_path, axes, more, message):
    file = spec(tmp_path, *axes, **more)
    refused(bench(program, "sweep", file, "--dry-run"), str(file), *message)
    refused(bench(program, "sweep", file, "--out", tmp_path / "out"), *message)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("override", ["/time/steps=7", "/time={\"steps\": 7, \"dt_s\": 0.01}"])
def test_an_override_of_what_an_axis_sets_is_refused(program, tmp_path, override):
    file = spec(tmp_path, STEPS)
    refused(bench(program, "sweep", file, "--dry-run", "--set", override), "--set", "/time/steps", "an axis of the sweep")
    assert bench(program, "sweep", file, "--dry-run", "--set", "/time/dt_s=0.005").returncode == 0


def test_the_number_of_threads_makes_a_run_and_neighbouring_pointers_are_free(program, tmp_path):
    for axes in ([{"pointer": "/threads", "values": [1, 2]}], [STEPS, {"pointer": "/time/dt_s", "values": [0.01, 0.02]}],
                 [{"cases": [case("A", **{"/time/steps": 1}), case("a", **{"/time/steps": 2}), case("a.", **{"/time/steps": 3})]}]):
        done = bench(program, "sweep", spec(tmp_path, *axes), "--dry-run")
        assert done.returncode == 0 and len({line.lower() for line in done.stdout.splitlines()}) == len(done.stdout.splitlines()) > 1


def test_swept_pointers_are_columns_and_outcomes_stand_beside_their_comparability(program, tmp_path):
    file = spec(tmp_path, {"pointer": "/time/dt_s", "values": [0.01, 0.02]},
                {"cases": [case("log", **{"/formulation/stiffness_policy/kappa_N_per_m": 1000}), case("soft", **{"/formulation/stiffness_policy/kappa_N_per_m": 10})]},
                set={"/time/steps": 30, "/matching/rule": "as_given", "/passes/diagnose": True})
    out = tmp_path / "out"
    done = bench(program, "sweep", file, "--out", out)
    assert done.returncode == 0, done.stderr
    records = load(out)
    for _, run in records.runs.iterrows():
        assert run["/time/dt_s"] == run["dt_s"] and f"dt_s={run['dt_s']:g}" in run["note"]
        assert run["/formulation/stiffness_policy/kappa_N_per_m"] == (1000 if " log" in run["note"] else 10)
        line = [line for line in done.stdout.splitlines() if line.startswith(run["note"]) and run["comparability_verdict"] in line]
        assert len(line) == 1, (run["note"], done.stdout)
        below = " ".join(done.stdout.split(line[0])[1].split())  # the reason is broken into lines
        assert run["comparability_verdict"] == "comparable" or below.startswith(run["comparability_reason"])
    assert {"comparable", "not_comparable"} <= set(records.runs["comparability_verdict"])
    table = summary_table(records)
    assert set(table["/time/dt_s"]) == {0.01, 0.02}
    assert "/time/dt_s" in as_text(table).splitlines()[0]
    written = json.loads(next(out.glob("*/run.json")).read_text())["labels"]["swept"]
    assert set(written) == {"/time/dt_s", "/formulation/stiffness_policy/kappa_N_per_m"}


def test_a_config_is_told_that_it_is_no_sweep(program, tmp_path):
    """One line with the verb, and not one for every key."""
    done = bench(program, "sweep", BLOCK, "--dry-run")
    refused(done, f"{BLOCK}#/schema", "./bench run FILE")
    assert len(done.stderr.strip().splitlines()) == 1
