"""A folder that cannot be listed may hold records: what reads records says so, and passes nothing over."""

import os
from pathlib import Path

import pytest

from barrierbench_analysis.tables import surface_gaps
from barrierbench_analysis.figures.plots import verb as figures
from barrierbench_analysis.studies.gate import compare
from barrierbench_analysis.pages.report import verb as report
from barrierbench_analysis.tables.sweeps import collect

VERBS = {"collect": (collect, ["{out}/t.csv"]), "figures": (figures, ["{out}/f"]), "report": (report, ["--out", "{out}/r.html"]), "compare": (compare, ["{runs}"]), "surface_gaps": (surface_gaps, [])}


@pytest.mark.parametrize("name", VERBS)
def test_it_is_said_and_nothing_is_made(name, tmp_path, monkeypatch, capsys):
    runs, out = tmp_path / "runs", tmp_path / "out"
    for folder in (runs / "closed", out):
        folder.mkdir(parents=True)
    (runs / "cases.txt").touch()
    real = os.scandir

    def scandir(path="."):
        """As for a user without rights; root has them."""
        if Path(path).name == "closed":
            raise PermissionError(13, "Permission denied", str(path))
        return real(path)

    monkeypatch.setattr(os, "scandir", scandir)
    verb, more = VERBS[name]
    assert verb.main([str(runs), *(word.format(out=out, runs=runs) for word in more)]) == 2
    assert f"{runs}/closed: Permission denied; a folder that can be listed is needed" in capsys.readouterr().err
    assert list(out.iterdir()) == []
