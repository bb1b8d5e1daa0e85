"""Barriers of least stiffness beside log and cubic: their exponents, their runs and the table of their rows."""

import json
import math
import subprocess
from dataclasses import replace

import pytest
from at_size_rows import EVERY, row, spread

from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.program.start import built_program
from barrierbench_analysis.studies.claims.merged import put
from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.rules import least_price
from barrierbench_analysis.studies.rules.at_size.cells import settings
from barrierbench_analysis.studies.rules.at_size.pairs import Where

STUDY = read_study("least_price")


def test_exponents_are_those_of_the_page_on_ranges_of_loads():
    assert least_price.exponent("minimax", 100, 0.1) == pytest.approx(2.5 + math.log(100))
    assert least_price.exponent("minimax_bounded", 100, 0.1) == pytest.approx((1.5 + math.log(100)) / 0.9)
    best = least_price.exponent("exponential", 100, 0.1)
    assert best == pytest.approx(7.7, abs=0.05)
    assert least_price.exponential_price(best, 100, 0.9) == pytest.approx(8.72, abs=0.005)
    for other in (0.97 * best, 1.03 * best):
        assert least_price.exponential_price(other, 100, 0.9) > least_price.exponential_price(best, 100, 0.9)
    assert least_price.exponent("minimax", 1.01, 0.1) == 3 and least_price.exponent("minimax", 1e30, 0.1) == 40


def test_a_run_differs_from_that_of_the_log_in_its_barrier_alone():
    cell = next(c for c in STUDY.cells if c.place["arm"] == "minimax" and c.place["scene"] == "drape")
    log = settings(least_price.base(), cell.place | {"arm": "log"})
    assert {key for key in log if log[key] != cell.settings[key]} == {"/formulation"}
    assert cell.settings["/formulation"]["shape"] == "minimax:6.05"  # 5/2 + ln 34.8


@pytest.mark.parametrize("shape", STUDY.about["shapes"])
def test_the_program_takes_every_barrier(shape, tmp_path):
    cell = next(c for c in STUDY.cells if c.place["arm"] == shape and c.place["size"] == "XS")
    config = json.loads((ROOT / "configs/scenes/hang.json").read_text())
    for pointer, value in (STUDY.data["set"] | cell.settings).items():
        put(config, pointer, value)
    (tmp_path / "run.json").write_text(json.dumps(config))
    found = subprocess.run([built_program(), "check", tmp_path / "run.json"], capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr


def test_the_table_has_ratios_to_log_and_cubic_of_the_scenes_in_which_both_end_ok(monkeypatch):
    where = Where("S", "0.1")
    others = [row(s, arm, where, velocity_newton=10.0, pcg=10.0) for s in EVERY for arm in ("log", "cubic")]
    others[1] = replace(others[1], outcome="stall_overload")  # the cubic of the first scene
    monkeypatch.setattr(least_price, "rows_of", lambda study: others)
    mine = [row(s, "minimax", where, velocity_newton=8 * x, pcg=12.0) for s, x in zip(EVERY, spread(1.0, len(EVERY)))]
    lines = least_price.rule(STUDY, mine)["table"].splitlines()
    log, cubic = (next(li for li in lines if li.startswith(f"| S | 0.1 | minimax | {under} |")) for under in ("log", "cubic"))
    assert "| 10 of 10 | 9 and 0 | 10 |" in log and "| 10 of 10 | 9 and 0 | 9 |" in cubic
    assert "1.2 [1.2, 1.2] | 0.8 [" in log
