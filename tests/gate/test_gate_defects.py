"""Defects of the program turn the gate red, and 20 clean repetitions leave it green.

Where settings act as the defect would, the run is real: a stand-in for the program adds them, and its record claims the config that was asked
for (conftest.py). What no setting can do is written into the record as the defect would leave it. All five stand as changes of the code in
tests/mutation/gate.toml too, which `./bench dev mutate --only 'gate/*'` builds and judges with the committed baselines.
"""

import pytest

from barrierbench_analysis.studies.gate import baseline, cases, judge
from barrierbench_analysis.studies.gate.finding import failures
from barrierbench_analysis.studies.gate.measure import measure


def red(answer) -> dict[str, set]:
    """Class -> metrics that failed."""
    found: dict[str, set] = {}
    for line in answer()["findings"]:
        if line["verdict"] == "FAIL":
            found.setdefault(line["class"], set()).add(line["metric"])
    return found


def test_kappa_times_4(gate, defective, answer):
    """A real run: `scale` acts after matching."""
    defective({"/formulation/stiffness_policy/scale": 4})
    assert gate("gate", "--case", "block-cubic") == 1
    assert red(answer)["III"] >= {"gap_median", "log10_cond full/none median"}


def test_ccd_slack_off(gate, defective, answer):
    """A real run: a binding bound is taken whole, so that steps end at the stop level."""
    defective({"/step_solver/cap_fraction": 1})
    assert gate("gate", "--case", "sphere-log") == 1
    assert red(answer)["IV"] & {"linear_solves", "line_search_trials"}


def test_preconditioner_transposed(gate, defective, answer):
    """A real run with a preconditioner that is positive definite and does not fit: to the gate a transposed one is one of these. The
    transposed factor itself is the mutant preconditioner_transposed."""
    defective({"/linear_solver/preconditioner": "jacobi"})
    assert gate("gate", "--case", "drape-log") == 1
    assert "linear_iterations" in red(answer)["III"]


def test_psd_projection_missing(gate, defective, answer):
    """Edited: the clamped matrix of an iteration is not positive definite. No setting switches the projection of a clamped matrix off."""
    defective({}, {"/summary/cond/full~1none/statuses": {"ok": 137, "not_pd": 1}})
    assert gate("gate", "--case", "block-log") == 1
    assert red(answer)["I"] == {"matrices"}


def test_an_audit_that_does_not_run(gate, defective, answer):
    defective({"/passes/audit": False})
    assert gate("gate", "--case", "block-log") == 1
    assert red(answer)["I"] >= {"audit", "crossings", "violations", "unproven"}


@pytest.mark.parametrize("place", ["/audit/judged", "/audit/motions", "/audit/states"])
def test_an_audit_that_judges_nothing_and_says_ok(gate, defective, answer, place):
    """Edited: the program itself would call such a run unproven."""
    defective({}, {place: 0})
    assert gate("gate", "--case", "block-log") == 1
    assert "audit" in red(answer)["I"]


@pytest.mark.parametrize("edit, metric", [
    ({"/audit/crossings": 1}, "crossings"),
    ({"/audit/violations": 1}, "violations"),
    ({"/status/outcome": "newton_stall"}, "outcome"),
    ({"/summary/gap_min_m": None, "/summary/gap_min_m_status": "nan"}, "numbers"),
    ({"/summary/newton_iterations": 68}, "trace"),
    ({"/summary/new": 1}, "schema"),
])
def test_every_invariant_turns_it_red(gate, defective, answer, edit, metric):
    defective({}, edit)
    assert gate("gate", "--case", "block-log") == 1
    assert metric in red(answer)["I"]


def test_another_state_with_two_threads(gate, program, answer, monkeypatch, tmp_path):
    """A program whose result depends on the number of threads."""
    path = tmp_path / "program"
    path.write_text(f"""#!/bin/bash
case " $* " in *"/threads=2"*) set -- "$@" --set /seeds/jitter_m=1e-13 ;; esac
exec {program} "$@"
""")
    path.chmod(0o755)
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", str(path))
    assert gate("gate", "--case", "block-log") == 1
    assert red(answer) == {"I": {"config_id"}, "II": {"state_hash", "numbers"}}


def test_20_clean_repetitions_stay_green(gate, defective, seeds):
    """Not the same run 20 times: each has a start perturbed by 1e-12 of the scene with a seed that no calibration has seen."""
    for seed in seeds:
        defective({"/seeds/main": seed, "/seeds/jitter_m": 1e-13})
        assert gate("gate", "--case", "block-log") == 0, seed


CLOTHS = ("drape-cubic", "strip-adaptive", "strip-dynamic")


@pytest.mark.parametrize("name", CLOTHS)
def test_20_clean_repetitions_of_three_cloths_stay_green(program, monkeypatch, tmp_path, seeds, name):
    seeds = seeds[CLOTHS.index(name) :: len(CLOTHS)]
    assert seeds
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    case = next(case for case in cases.read_set("small") if case.name == name)
    kept = baseline.read(baseline.FOLDER / f"{case.name}.json", case.name)
    for seed in seeds:
        run = cases.jittered(case, tmp_path / "run", seed, 1.0, 1 + seed % 2)
        lines = judge.numbers(case.name, kept.metrics, measure(run), False)
        assert len(lines) > 20 and not failures(lines), (seed, failures(lines))
