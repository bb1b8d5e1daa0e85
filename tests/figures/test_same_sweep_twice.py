"""A folder that holds a sweep and its copy has figures and a report: a name of a folder within it is no key."""

import shutil

from barrierbench_analysis.figures.plots import verb as figures
from barrierbench_analysis.pages.report import verb as report
from small_sweep import sweep_of


def test_a_sweep_and_its_copy(program, tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {0})  # one process
    runs = tmp_path / "runs"
    shutil.copytree(sweep_of(program, tmp_path), runs / "a")
    shutil.copytree(runs / "a", runs / "b")
    assert figures.main([str(runs), str(tmp_path / "figures")]) == 0, capsys.readouterr().err
    assert len(list((tmp_path / "figures").glob("*.png"))) > 3
    assert report.main([str(runs), "--out", str(tmp_path / "r.html")]) == 0, capsys.readouterr().err
