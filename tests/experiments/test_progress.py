"""Off a terminal a long run says from time to time where it is, in all its passes and while a step is going on."""

import re

from test_cli import BLOCK, ROOT, bench, sweep_spec

DRAPE = [ROOT / "configs/scenes/drape.json", "--set", "/scene/n=8", "--set", "/scene/layers=2", "--set", "/time/steps=8", "--set", "/passes/diagnose=true"]
LINE = re.compile(r"\[(calibration|time|diagnose)\] step (\d+)/8  t ([\d.e-]+) of 0.\d+ s .* eta (\d+) s  after \d+ s$")


def test_lines_come_from_every_pass_and_the_estimate_covers_those_that_follow(program, tmp_path):
    done = bench(program, "run", *DRAPE, "--out", tmp_path / "out", "--progress-every", "0.02")
    assert done.returncode == 0, done.stderr
    lines = done.stderr.splitlines()
    reported = [LINE.search(line) for line in lines]
    assert lines and all(found or "before the end of the first step" in line for line, found in zip(lines, reported)), lines[:5]
    passes = [found[1] for found in reported if found]
    assert {"time", "diagnose"} <= set(passes)
    assert passes == sorted(passes, key=["calibration", "time", "diagnose"].index)
    steps = [int(found[2]) for found in reported if found and found[1] == "diagnose"]
    assert steps == sorted(steps) and steps


def test_a_short_run_says_nothing_and_none_says_nothing(program, tmp_path):
    assert bench(program, "run", BLOCK, "--out", tmp_path / "a").stderr == ""
    assert bench(program, "--progress", "none", "run", *DRAPE, "--out", tmp_path / "b", "--progress-every", "0.02").stderr == ""


def test_a_sweep_says_which_case_it_is_at(program, tmp_path):
    done = bench(program, "sweep", sweep_spec(tmp_path, [200, 201]), "--out", tmp_path / "out", "--progress-every", "0.002")
    assert done.returncode == 0 and "[1/2] " in done.stderr and "[2/2] " in done.stderr


def test_a_time_between_lines_is_a_number_above_0(program, tmp_path):
    for text in ("0", "-1", "nan", "inf", "soon"):
        done = bench(program, "run", BLOCK, "--out", tmp_path / "out", "--progress-every", text)
        assert done.returncode == 2 and "--progress-every" in done.stderr, text
    assert not (tmp_path / "out").exists()
