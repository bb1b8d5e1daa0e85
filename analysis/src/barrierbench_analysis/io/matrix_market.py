"""Symmetric matrices from Matrix Market files, whoever wrote them."""

import io
from pathlib import Path

import numpy as np
import scipy.io
import scipy.sparse as sparse

from .errors import UserError
from .input_file import LARGE, read_bytes

SYMMETRY = 1e-10  # largest |A - A^T| over the largest entry: what summation in another order leaves
EMPTY_ROWS = 1_000_000  # up to so many rows a matrix may have that has fewer entries
LEAST_LINE = 6  # bytes of "1 1 1" and an end of line


def _check_sizes(path: Path, text: bytes) -> None:
    """Before anything of the announced size is made. Errors: UserError for entries that the file cannot hold
    for, and for many rows without an entry; ValueError for a header that is none.
    """
    rows, columns, entries, form, *_ = scipy.io.mminfo(io.BytesIO(text))
    room = len(text) // (LEAST_LINE if form == "coordinate" else 2)
    if entries > room or max(rows, columns) > max(entries, EMPTY_ROWS):
        raise UserError(
            f"{path}: its header says {rows} x {columns} with {entries} entries, and the file has {len(text)}"
            f" bytes, enough for at most {room}; as many entries as it says, and one in every row, are needed"
        )


def read_matrix(path: Path) -> sparse.csc_matrix:
    """Raises UserError with file and reason: not there, a folder, no Matrix Market, not real, not square, not
    symmetric, a NaN or infinite number, empty.
    """
    if path.is_dir():
        raise UserError(f"{path}: a folder; allowed: Matrix Market files, {path}/*.mtx")
    try:
        text = read_bytes(path, LARGE)
        _check_sizes(path, text)
        matrix = sparse.csc_matrix(scipy.io.mmread(io.BytesIO(text)))
    except UserError:
        raise
    except (ValueError, TypeError, OverflowError, EOFError) as error:
        raise UserError(f"{path}: not Matrix Market: {error}") from None
    if np.iscomplexobj(matrix.data):
        raise UserError(f"{path}: complex; a real matrix is needed")
    matrix = matrix.astype(float)
    rows, columns = matrix.shape
    if rows != columns:
        raise UserError(f"{path}: {rows} x {columns}; a square matrix is needed")
    if rows == 0 or matrix.nnz == 0:
        raise UserError(f"{path}: empty")
    if not np.isfinite(matrix.data).all():
        entry = matrix.tocoo()
        k = int(np.flatnonzero(~np.isfinite(entry.data))[0])
        raise UserError(
            f"{path}: entry ({entry.row[k] + 1}, {entry.col[k] + 1}): {entry.data[k]}; finite numbers are"
            " needed"
        )
    departure = abs(matrix - matrix.T).max() / abs(matrix).max()
    if departure > SYMMETRY:
        raise UserError(
            f"{path}: not symmetric: |A - A^T| is {departure:.2g} of the largest entry, at most"
            f" {SYMMETRY:g} is rounding"
        )
    return sparse.csc_matrix(0.5 * (matrix + matrix.T))
