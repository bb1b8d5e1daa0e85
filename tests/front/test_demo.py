"""The demonstration: every sweep of the README once, with several runs at a time, and figures only of a whole demonstration."""

import json
import sys
from pathlib import Path
from subprocess import CompletedProcess

import pytest

from barrierbench_analysis.figures.plots import demo as figures
from barrierbench_analysis.front import demo
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.pages.readme.numbers import GROUPS
from barrierbench_analysis.pages.report import closing
from barrierbench_analysis.pages.report import verb as report


@pytest.fixture
def calls(monkeypatch):
    """Sweeps that are no runs: what was requested of each; `codes` says how each ends."""
    made, codes = [], {}

    def run_sweep(file: Path, out: Path, *words: str, stdout: None) -> CompletedProcess:
        made.append((file, out, words))
        print(f"table of {out.name}\n")  # the program's own, on the terminal that it keeps to
        print("no more disk\n" if out.name in codes else "", file=sys.stderr)
        return CompletedProcess([], codes.get(out.name, 0))

    monkeypatch.setattr(demo, "run_sweep", run_sweep)
    monkeypatch.setattr(figures, "make", lambda runs, out: made.append((runs, out)) or 1)
    monkeypatch.setattr(report, "report", lambda *words: made.append(words) or "the verdict")
    monkeypatch.setattr(closing, "lines", lambda *words: made.append(words) or ["the answer"])
    return made, codes


def test_every_sweep_runs_once_and_then_the_figures_and_the_page(calls, tmp_path, capsys):
    made, _ = calls
    assert demo.main(["--out", str(tmp_path), "--jobs", "2"]) == 1  # that of the figures
    *sweeps, drawn, page, closed = made
    assert {(file.stem, out) for file, out, _ in sweeps} == {(name, tmp_path / name) for name in demo.SWEEPS} and len(sweeps) == len(demo.SWEEPS) == 6
    assert all(words[:2] == ("--jobs", "2") for _, _, words in sweeps)
    assert drawn == (tmp_path, None) and page == closed == (tmp_path, tmp_path / "report.html", tmp_path / "figures")
    said = capsys.readouterr()
    *tables, verdict, answer = said.out.split("\n\n")
    assert sorted(tables) == sorted(f"table of {name}" for name in demo.SWEEPS)
    assert verdict.strip() == "the verdict" and answer.strip() == "the answer"


def test_a_sweep_that_fails_is_said_and_nothing_is_drawn(calls, tmp_path, capsys):
    made, codes = calls
    codes["demo_strip"] = 75
    assert demo.main(["--out", str(tmp_path), "--jobs", "2"]) == 75
    assert len(made) == len(demo.SWEEPS) and "no more disk" in capsys.readouterr().err


def test_no_job_is_refused(capsys):
    assert demo.main(["--jobs", "0"]) == 2 and "--jobs: found 0; a number from 1 on is needed" in capsys.readouterr().err


def test_the_sweeps_are_those_of_the_page():
    assert set(demo.SWEEPS) == set(GROUPS) == {path.stem for path in (ROOT / "configs/sweeps").glob("demo_*.json")}
    assert all(json.loads((ROOT / f"configs/sweeps/{name}.json").read_text())["name"] == name for name in demo.SWEEPS)
