"""Names of users with dollars are drawn as they are written; our own mathematics is mathematics."""

import ast
import json
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.own_math import is_ours

ROOT = Path(__file__).resolve().parents[2]
NAMES = ("$x", "a$b^c^d$", "$a_{$", "100%", "#1", "a_b^c", "$$", "_private", "$ $", "$\\frac{$", "a$b$c$d", "\\$x$", "$^$")


def own_texts() -> list[str]:
    """String constants of the package that have mathematics."""
    found = []
    for path in (ROOT / "analysis").rglob("*.py"):
        if path.name == "own_math.py":
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value.count("$") >= 2 and not node.value.count("$schema") and "\n" not in node.value:
                found.append(node.value)
    return found


def test_mathematics_of_the_package_is_known():
    texts = own_texts()
    assert len(texts) >= 15
    assert [text for text in texts if not is_ours(text.replace("{{", "{").replace("}}", "}")) and "$defs" not in text] == []
    assert all(is_ours(text) for text in ("$10^{-3}$", "$\\mathdefault{10^{\u22122}}$", "$\\mathdefault{2\\times10^{4}}$", "$\\mathdefault{0.5}$"))


@pytest.mark.parametrize("name", NAMES)
def test_a_name_is_drawn_as_it_is_written(tmp_path, name):
    fig, axis = plt.subplots()
    axis.plot([1, 2], [1, 2], label=name)
    axis.set(title=name, xlabel=f"{name} / $\\hat d$", yscale="log")
    axis.annotate(name, (1, 1))
    axis.legend([name.lstrip("_")])
    for suffix in ("png", "svg", "pdf"):
        fig.savefig(tmp_path / f"a.{suffix}")
    plt.close(fig)
    svg = (tmp_path / "a.svg").read_text()
    assert f">{name}<" in svg.replace("&gt;", ">") and style  # as text


def test_figures_and_report_of_a_sweep_with_such_labels(program, tmp_path):
    base = json.loads((ROOT / "configs/scenes/resting_block_1d.json").read_text())
    base["time"] = {"dt_s": 0.01, "steps": 3}
    base["passes"] = {"diagnose": True}
    (tmp_path / "base.json").write_text(json.dumps(base))
    cases = [{"label": name, "set": {"/time/dt_s": 0.01 + 0.001 * k}} for k, name in enumerate(name for name in NAMES if "\\" not in name)]
    (tmp_path / "s.json").write_text(json.dumps({"schema": "barrierbench.sweep/1", "name": "s", "base": "base.json", "axes": [{"cases": cases}]}))
    done = subprocess.run([program, "sweep", "s.json", "--out", "out", "--progress", "none"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    for words in (["draw", "figures", "out"], ["report", "out"], ["data", "collect", "out", "out.csv"]):
        done = subprocess.run([sys.executable, ROOT / "analysis", *words], cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0 and "Traceback" not in done.stderr, done.stderr
