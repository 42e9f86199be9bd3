"""Any linear wish: rows that somebody wrote down themselves."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse

from projflow_lite.constraints.checks import check_numbers
from projflow_lite.constraints.wish import Rows, Term, Wish
from projflow_lite.skeleton import N_JOINTS


def rows(A: ArrayLike | sparse.spmatrix, y: ArrayLike, variance: ArrayLike = 0.0) -> Wish:
    """Ask for ``A x = y``, whatever it means.

    Args:
        A: ``(m, frames * 22 * 3)``, dense or sparse; coordinates in frame-major order, see
            `wish`.
        y: ``(m,)`` targets.
        variance: ``(m,)``, or one number for all rows; 0 means exactly.

    Raises:
        ValueError: if shapes do not fit, a value is not finite, a variance is negative, or a row
            is zero.
    """
    if sparse.issparse(A):
        check_numbers(sparse.coo_array(A).data, "rows: A")
        matrix = sparse.csr_matrix(A, dtype=np.float64, copy=True)
    else:
        dense = np.atleast_2d(check_numbers(A, "rows: A"))
        if dense.ndim > 2:
            raise ValueError(f"rows: A is a matrix (m, frames * 22 * 3), not {dense.shape}")
        matrix = sparse.csr_matrix(dense)
    matrix.sum_duplicates()
    matrix.eliminate_zeros()
    m, columns = matrix.shape
    if m == 0:
        raise ValueError("rows: A has no row")
    target = check_numbers(y, "rows: y")
    spread = check_numbers(variance, "rows: variance")
    if columns == 0 or columns % (N_JOINTS * 3):
        raise ValueError(f"rows: A has {columns} columns, not a multiple of {N_JOINTS} * 3")
    if target.shape != (m,) or spread.shape not in ((), (m,)):
        raise ValueError(
            f"rows: A has {m} rows, y has shape {target.shape} and variance {spread.shape}"
        )
    if not (np.isfinite(matrix.data).all() and np.isfinite(target).all()):
        raise ValueError("rows: A or y has a value that is not finite")
    if not (np.isfinite(spread).all() and (spread >= 0).all()):
        raise ValueError("rows: variance has a value that is negative or not finite")
    empty = np.flatnonzero(np.diff(matrix.indptr) == 0)
    if len(empty):
        raise ValueError(f"rows: row {empty[0]} of A is zero")
    frames = columns // (N_JOINTS * 3)

    def build(total: int) -> Rows:
        if total != frames:
            raise ValueError(f"rows: written for {frames} frames, but the motion has {total}")
        return Rows(matrix, target, np.broadcast_to(spread, (m,)).copy())

    return Wish((Term(f"{m} rows of its own on {frames} frames", build),))
