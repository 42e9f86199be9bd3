"""The structure of a set of rows: which couple, which repeat others, which contradict them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, sparse
from scipy.sparse.csgraph import connected_components

from projflow_lite.constraints import Rows, describe_row
from projflow_lite.skeleton import N_JOINTS

RANK_TOLERANCE = 1e-9
"""A row is redundant when the rows before it leave less than this share of its variance."""

AGREEMENT = 1e-6
"""Redundant rows may disagree by this many metres: rounding of float32 targets, not two wishes."""


def blocks_of_rows(A: sparse.csr_matrix) -> list[NDArray]:
    """Split rows into groups that share no frame and axis; each group can be solved alone.

    Returns:
        One array ``(blocks, size)`` of row indices for every size of group that occurs.
    """
    if A.shape[0] == 0:
        return []
    cell = A.indices // (3 * N_JOINTS) * 3 + A.indices % 3
    touches = sparse.csr_matrix((np.ones(A.nnz), cell, A.indptr), (A.shape[0], A.shape[1]))
    _, label = connected_components(touches @ touches.T, directed=False)
    order, sizes = np.argsort(label, kind="stable"), np.bincount(label)
    blocks = np.split(order, np.cumsum(sizes)[:-1])
    return [np.array([k for k in blocks if len(k) == size]) for size in np.unique(sizes)]


def metric_times_rows(A: sparse.csr_matrix, covariance: NDArray) -> sparse.csr_matrix:
    r""":math:`R^{-1} A^\top`, ``(d, m)``: how every coordinate moves when one row is pulled."""
    frames = A.shape[1] // (N_JOINTS * 3)
    spread = sparse.kron(sparse.eye(frames), sparse.kron(covariance, sparse.eye(3)), format="csr")
    return (spread @ A.T).tocsr()


def observed_covariance(A: sparse.csr_matrix, covariance: NDArray) -> sparse.csr_matrix:
    r""":math:`A R^{-1} A^\top`, ``(m, m)``."""
    return (A @ metric_times_rows(A, covariance)).tocsr()


def dense_blocks(S: sparse.csr_matrix, block: NDArray) -> NDArray:
    """Cut blocks of equal size out of ``S``: ``(blocks, size)`` to ``(blocks, size, size)``."""
    size = block.shape[1]
    entries = S[np.repeat(block, size, axis=1).ravel(), np.tile(block, size).ravel()]
    return np.asarray(entries).reshape(-1, size, size)


def independent_rows(rows: Rows, covariance: NDArray) -> NDArray:
    """Indices of the rows to keep: all but the hard rows that others already imply.

    Raises:
        ValueError: if a hard row contradicts the others.
    """
    S = (observed_covariance(rows.A, covariance) + sparse.diags(rows.variance)).tocsr()
    keep = np.ones(len(rows.y), dtype=bool)
    for block in blocks_of_rows(rows.A):
        dense = dense_blocks(S, block)
        scale = 1 / np.sqrt(np.diagonal(dense, axis1=1, axis2=2))
        correlation = dense * scale[:, :, None] * scale[:, None, :]
        singular = np.linalg.eigvalsh(correlation)[:, 0] < RANK_TOLERANCE
        for k in np.flatnonzero(singular):
            _, pivot, rank, _ = linalg.lapack.dpstrf(correlation[k], tol=RANK_TOLERANCE, lower=1)
            kept, dropped = np.sort(pivot[:rank] - 1), np.sort(pivot[rank:] - 1)
            implied = linalg.solve(dense[k][np.ix_(kept, kept)], dense[k][np.ix_(kept, dropped)]).T
            clash = np.abs(implied @ rows.y[block[k, kept]] - rows.y[block[k, dropped]]) > AGREEMENT
            if clash.any():
                first = np.argmax(clash)
                raise ValueError(
                    explain_clash(rows, block[k, dropped[first]], block[k, kept], implied[first])
                )
            keep[block[k, dropped]] = False
    return np.flatnonzero(keep)


def explain_clash(rows: Rows, row: int, others: NDArray, implied: NDArray) -> str:
    """One line that names two rows which cannot both hold, or the row that the others rule out."""
    first, second = sorted((row, others[np.argmax(np.abs(implied))]))
    where = describe_row(rows.A, first)
    if where == describe_row(rows.A, second):
        return (
            f"rows {first} and {second} contradict each other: {where} = "
            f"{rows.y[first]:.6g} and {rows.y[second]:.6g}"
        )
    return (
        f"row {row} contradicts the other rows: {describe_row(rows.A, row)} = "
        f"{rows.y[row]:.6g}, but they imply {implied @ rows.y[others]:.6g}"
    )
