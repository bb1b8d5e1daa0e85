"""The table of Spectra beside Lanczos, from samples that are known."""

import json

import pytest

from analysis import condition_table as table


def sample(cond=100.0, status="ok", method="spectra", solves=20, proof="both"):
    return {"matrix": "clamped", "stage": "full", "scaling": "none", "cond": cond, "status": status, "method": method, "proof": proof,
            "solves": solves, "products": 40, "time_s": 0.002}


def write(folder, rows):
    folder.mkdir(parents=True)
    folder.joinpath("trace.jsonl").write_text("\n".join(json.dumps(row) for row in rows) + "\n")


def test_samples_of_two_tiers_pair_up_by_case_and_iteration(tmp_path):
    for tier, cond in ((2, 100.0), (4, 101.0)):
        write(tmp_path / f"{tier}" / "log", [{"step": 0, "iteration": k, "cond": [sample(cond + k)]} for k in range(3)])
    pairs = table.pair_up("demo", {tier: table.samples(tmp_path / f"{tier}") for tier in (2, 4)})
    assert [(p.spectra["cond"], p.lanczos["cond"]) for p in pairs] == [(100, 101), (101, 102), (102, 103)]
    assert table.difference(pairs[0]) == pytest.approx(1 / 101)
    with pytest.raises(table.TableError, match="not of the same matrices"):
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
