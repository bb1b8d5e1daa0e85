"""The bound of docs/theory/scaled-conditioning.md: with block Jacobi no eigenvalue of a matrix of positive semi-definite elements on at
most four vertices exceeds 4, whatever barrier, load and mesh are."""

import json
import subprocess

import numpy as np
import pytest
from scipy.io import mmread
from scipy.linalg import LinAlgError, cholesky, eigh

from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.record_file import read_record, read_trace

BOUND = 4.0
ROUNDING = 1e-9
MATRICES = sorted((ROOT / "results/matrices").glob("*.mtx"))


def largest_scaled(matrix: np.ndarray, starts: list[int]) -> float:
    """lambda_max(D^-1 H). Errors: LinAlgError where a diagonal block is not positive definite."""
    blocks = np.zeros_like(matrix)
    for begin, end in zip(starts, [*starts[1:], len(matrix)]):
        cholesky(matrix[begin:end, begin:end])
        blocks[begin:end, begin:end] = matrix[begin:end, begin:end]
    return float(eigh(matrix, blocks, eigvals_only=True, subset_by_index=[len(matrix) - 1] * 2)[0])


def test_every_matrix_of_the_corpus_with_semi_definite_elements_keeps_the_bound():
    found = {}
    for path in MATRICES:
        about = json.loads(path.with_suffix(".json").read_text())
        if about["form"] != "exact":
            found[path.stem] = largest_scaled(mmread(path).toarray(), about["block_start"])
    assert len(found) >= 17 and max(found.values()) <= BOUND + ROUNDING
    assert max(found.values()) > 3  # the bound is not far from what matrices have


def test_indefinite_elements_are_beyond_the_theorem():
    """The corpus has one such matrix: the bound is one of semi-definite elements, and not of any matrix."""
    path = ROOT / "results/matrices/indefinite_exact.mtx"
    about = json.loads(path.with_suffix(".json").read_text())
    with pytest.raises(LinAlgError):
        largest_scaled(mmread(path).toarray(), about["block_start"])


@pytest.mark.parametrize("base", ["sheets_on_ball", "solid_ball", "strip_on_disk"])
@pytest.mark.parametrize("formulation", ["log", "quadratic", "cubic", "cubic_dynamic_consistent"])
def test_every_diagnosed_iteration_keeps_the_bound(tmp_path, program, base, formulation):
    config = json.loads((ROOT / f"configs/scenes/{base}.json").read_text())
    config |= {"threads": 1, "passes": {"time": False, "diagnose": True, "audit": False}}
    given = config["formulation"] if isinstance(config["formulation"], dict) else {}
    config["formulation"] = {"name": formulation} | {key: value for key, value in given.items() if key == "d_hat_m"}
    config["diagnose"] = {"scalings": ["none", "block_jacobi"], "stages": ["full"]}
    (tmp_path / "config.json").write_text(json.dumps(config))
    subprocess.run([program, "run", tmp_path / "config.json", "--out", tmp_path / "run", "--set", "/time/steps=12"], check=False, capture_output=True)
    record = read_record(tmp_path / "run/run.json")
    trace = read_trace(record, tmp_path / "run")
    rows = [row for line in trace for row in line["cond"]]
    scaled = [row["lambda_max"] for row in rows if row["scaling"] == "block_jacobi" and row["matrix"] == "clamped" and row["lambda_max"] is not None]
    raw = [row["lambda_max"] for row in rows if row["scaling"] == "none" and row["lambda_max"] is not None]
    assert sum(sum(line["contacts"].values()) for line in trace) > 0  # contacts are active
    assert len(scaled) > 3 and max(scaled) <= BOUND * (1 + 1e-6)
    assert max(raw) > 100 * max(scaled)  # the bound is on the scaled matrix alone
