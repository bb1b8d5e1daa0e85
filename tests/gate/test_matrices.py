"""Matrix Market files of another program: what is computed of them, and what is refused."""

import numpy as np
import pytest
import scipy.io
import scipy.sparse as sparse

from barrierbench_analysis.studies.gate import matrices


def write(path, matrix):
    scipy.io.mmwrite(path, sparse.coo_matrix(matrix))
    return path


def laplace(n: int) -> np.ndarray:
    """2 on the diagonal, -1 beside it: eigenvalues 2 - 2 cos(k pi/(n + 1))."""
    return 2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)


def test_a_spectrum_that_is_known(tmp_path):
    n = 30
    found = matrices.spectrum(write(tmp_path / "a.mtx", laplace(n)))
    angles = np.pi / (2 * (n + 1))
    assert found.raw == pytest.approx(np.log10((np.sin(n * angles) / np.sin(angles)) ** 2), abs=1e-10)
    assert found.rows == n and found.scaled < found.raw and 5 < found.pcg <= n


def test_block_jacobi_takes_the_blocks_away(tmp_path):
    random = np.random.default_rng(1)
    blocks = [a @ a.T + 1e-3 * np.eye(3) for a in random.standard_normal((4, 3, 3))]
    found = matrices.spectrum(write(tmp_path / "a.mtx", sparse.block_diag([*blocks, [[7.0]]])))
    assert found.raw > 1 and found.scaled == pytest.approx(0, abs=1e-10) and found.pcg <= 2


def test_large_ones_agree_with_all_eigenvalues(monkeypatch):
    matrix = sparse.csc_matrix(laplace(400) + 1e-3 * np.eye(400))
    exact = matrices.log10_cond(matrix)
    monkeypatch.setattr(matrices, "LARGEST_DENSE", 10)
    assert matrices.log10_cond(matrix) == pytest.approx(exact, abs=1e-3)
    assert matrices.log10_cond(sparse.csc_matrix(laplace(400) - 0.1 * np.eye(400))) is None
    assert matrices.log10_cond(sparse.diags([0.0] + [1.0] * 399, format="csc")) is None  # exactly singular: no factor at all


@pytest.mark.parametrize("text, said", [
    ("", "not Matrix Market"),
    ("%%MatrixMarket matrix coordinate real general\n2 3 1\n1 1 1\n", "2 x 3; a square matrix is needed"),
    ("%%MatrixMarket matrix coordinate real general\n2 2 3\n1 1 1\n2 2 1\n1 2 0.5\n", "not symmetric: |A - A^T| is 0.5"),
    ("%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 nan\n2 2 1\n", "entry (1, 1): nan"),
    ("%%MatrixMarket matrix coordinate complex general\n1 1 1\n1 1 1 0\n", "complex"),
    ("%%MatrixMarket matrix coordinate real symmetric\n0 0 0\n", "empty"),
    ("%%MatrixMarket matrix coordinate real symmetric\n2 2 5\n1 1 1\n", "not Matrix Market"),
])
def test_what_has_no_condition_number(gate, tmp_path, capsys, text, said):
    good, bad, kept = write(tmp_path / "good.mtx", laplace(2)), tmp_path / "bad.mtx", tmp_path / "b.json"
    bad.write_text(text)
    assert gate("accept", "--matrix", good, "--baseline", kept, "--reason", "first") == 0
    capsys.readouterr()
    assert gate("gate", "--matrix", good, bad, "--baseline", kept) == 2
    error = capsys.readouterr().err
    assert str(bad) in error and said in error


def test_a_file_that_is_not_there(gate, tmp_path, capsys):
    kept = tmp_path / "b.json"
    assert gate("accept", "--matrix", tmp_path / "none.mtx", "--baseline", kept, "--reason", "first") == 2
    assert "No such file" in capsys.readouterr().err and not kept.exists()


def test_a_folder_is_called_one(gate, tmp_path, capsys):
    kept = tmp_path / "b.json"
    good = write(tmp_path / "good.mtx", laplace(2))
    assert gate("accept", "--matrix", good, "--baseline", kept, "--reason", "first") == 0
    (tmp_path / "more").mkdir()
    assert gate("gate", "--matrix", tmp_path / "more", "--baseline", kept) == 2
    assert f"{tmp_path / 'more'}: a folder; allowed: Matrix Market files, {tmp_path / 'more'}/*.mtx" in capsys.readouterr().err
    assert gate("gate", "--matrix", good, "--baseline", tmp_path / "more") == 2
    assert f"{tmp_path / 'more'}: a folder; `bench gate accept --matrix" in capsys.readouterr().err


def test_advice_is_the_command_for_matrices(gate, tmp_path, capsys):
    kept, matrix, command = tmp_path / "b.json", tmp_path / "a.mtx", f"bench gate accept --matrix ... --baseline {tmp_path / 'b.json'}"
    worse = laplace(30)
    worse[0, 0] = 100
    assert gate("gate", "--matrix", write(matrix, worse), "--baseline", kept) == 2
    assert f"{kept}: no such baseline; `{command} --reason \"...\"` makes one" in capsys.readouterr().err
    assert gate("accept", "--matrix", matrix, "--baseline", kept, "--reason", "first") == 0
    write(matrix, laplace(30))
    assert gate("gate", "--matrix", matrix, write(tmp_path / "b.mtx", laplace(30)), "--baseline", kept) == 1
    said = capsys.readouterr()
    assert f"from now on: {command} --better --reason" in said.err and "calibrate" not in said.err + said.out
    assert "accept it (bench gate accept --matrix)" in said.out
    assert gate("accept", "--matrix", matrix, "--baseline", kept, "--better", "--reason", "better") == 0


def test_one_that_is_not_positive_definite_is_red_and_never_accepted(gate, tmp_path, answer):
    good, kept = write(tmp_path / "good.mtx", laplace(6)), tmp_path / "b.json"
    bad = write(tmp_path / "bad.mtx", laplace(6) - np.eye(6))
    singular = write(tmp_path / "singular.mtx", np.diag([1.0, 1, 1, 1, 1, 0]) + np.diag([0.0] * 6))
    assert gate("accept", "--matrix", bad, "--baseline", kept, "--reason", "first") == 2
    assert gate("accept", "--matrix", good, "--baseline", kept, "--reason", "first") == 0
    for matrix in (bad, singular):
        assert gate("gate", "--matrix", good, matrix, "--baseline", kept) == 1
        assert "positive definite" in {f["metric"] for f in answer()["findings"] if f["verdict"] == "FAIL"}


def test_a_worse_matrix_is_red_in_its_direction(gate, tmp_path, capsys):
    kept = tmp_path / "b.json"
    assert gate("accept", "--matrix", write(tmp_path / "a.mtx", laplace(30)), "--baseline", kept, "--reason", "first") == 0
    worse = laplace(30)
    worse[0, 0] = 100
    assert gate("gate", "--matrix", write(tmp_path / "a.mtx", worse), "--baseline", kept) == 1
    assert "higher, x" in capsys.readouterr().out
    assert gate("gate", "--matrix", write(tmp_path / "a.mtx", laplace(31)), "--baseline", kept) == 2
    assert "of other matrices" in capsys.readouterr().err
