"""The table of Spectra beside Lanczos, from samples that are known."""

import json
from pathlib import Path

import pytest

from barrierbench_analysis.studies.matrices import condition_table as table


def sample(cond=100.0, status="ok", method="spectra", solves=20, proof="both"):
    return {"matrix": "clamped", "stage": "full", "scaling": "none", "cond": cond, "status": status, "method": method, "proof": proof,
            "solves": solves, "products": 40, "time_s": 0.002}


def write(folder, rows):
    folder.mkdir(parents=True)
    folder.joinpath("trace.jsonl").write_text("\n".join(json.dumps(row) for row in rows) + "\n")


def test_samples_of_two_tiers_pair_up_by_case_and_iteration(tmp_path):
    for tier, cond in ((2, 100.0), (4, 101.0)):
        write(tmp_path / f"{tier}" / f"log-{tier}abc", [  # the id of a run knows its tier
            {"step": 0, "iteration": k, "cond": [sample(cond + k)]} for k in range(3)])
    pairs = table.pair_up("demo", {tier: table.samples(tmp_path / f"{tier}") for tier in (2, 4)})
    assert [(p.spectra["cond"], p.lanczos["cond"]) for p in pairs] == [(100, 101), (101, 102), (102, 103)]
    assert table.difference(pairs[0]) == pytest.approx(1 / 101)
    with pytest.raises(table.UserError, match="not of the same matrices"):
        table.pair_up("demo", {2: table.samples(tmp_path / "2"), 4: {}})


def test_a_line_counts_who_found_what():
    pairs = [table.Pair("x", sample(), sample(solves=10, method="lanczos")),
             table.Pair("x", sample(method="spectra, smallest by lanczos", solves=60, proof="largest"), sample(100.5, method="lanczos")),
             table.Pair("x", sample(None, "not_pd", "lanczos, sigma = -1e-8 lambda_max", proof="none"), sample(None, "singular", "lanczos"))]
    line = dict(zip(table.COLUMNS, table.row("x", pairs)))  # the second of two columns of a name counts
    assert line["estimates"] == "3" and line["by Spectra"] == "2" and line["an end by Lanczos"] == "1"
    assert line["both ends proven"] == "1" and line["other status"] == "1" and line["solves: Spectra"] == "33.3 / 60"
    assert line["largest difference of cond"] == "5.0e-03"
    assert "| x | 3 |" in table.page({"x": pairs}, "") and "| all | 3 |" in table.page({"x": pairs}, "")


def test_a_label_that_no_case_has_runs_nothing(tmp_path, monkeypatch, capsys):
    """A misspelt label ran the first case."""
    asked = []
    monkeypatch.setattr(table, "run", lambda words: asked.append(json.loads(Path(words[1]).read_text())))
    monkeypatch.setattr(table, "samples", lambda folder: {("x",): sample()})
    with pytest.raises(table.UserError, match="configs/sweeps/demo_drape.json: no case 'cubicc'; it has log, quadratic, cubic"):
        table.of_sweep("demo_drape", ["cubicc"], tmp_path)
    assert table.main(["--sweeps", "demo_drape", "demo_strip", "--cases", "log", "cubicc", "--out", str(tmp_path / "page.md")]) == 2
    assert "--cases cubicc: none of demo_drape, demo_strip has it; they have cubic" in capsys.readouterr().err
    assert not asked and not (tmp_path / "page.md").exists()
    table.of_sweep("demo_drape", ["log", "cubic"], tmp_path)
    labels = [case["label"] for axis in asked[0]["axes"] for case in axis["cases"]]
    assert {"log", "cubic"} <= set(labels) and "quadratic" not in labels and len(asked) == 2
