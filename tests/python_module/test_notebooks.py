"""The notebooks, every cell in order, in a process and a folder of their own."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = ROOT / "examples/notebooks"


def executed(bb, name, folder, *more):
    """What the notebook prints. more: lines behind its last cell."""
    cells = json.loads((NOTEBOOKS / f"{name}.ipynb").read_text())["cells"]
    code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    assert len(code) > 2 and all(not cell.get("outputs") for cell in cells)
    script = folder / "notebook.py"
    script.write_text("\n\n".join([*code, *more]))
    path = os.pathsep.join([str(Path(bb.__file__).parents[1]), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, str(script)],
        cwd=folder,
        env={**os.environ, "MPLBACKEND": "Agg", "PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_from_formula_to_figure(bb, tmp_path):
    pytest.importorskip("matplotlib")
    reported = executed(bb, "from_formula_to_figure", tmp_path, "assert steps['cubic'][-1]['contacts']['total'] > 0")
    assert "shape wrong: found b' = " in reported and reported.count(": ok, ") == 3
    assert (tmp_path / "from_formula_to_figure.png").stat().st_size > 10_000


def test_judge_an_engine(bb, program, tmp_path):
    pytest.importorskip("barrierbench_analysis")
    reported = executed(bb, "judge_an_engine", tmp_path, "assert verdicts['careful'] == 'clean' != verdicts['careless']")
    assert "careful: clean; 8 frames" in reported and "passage" in reported
