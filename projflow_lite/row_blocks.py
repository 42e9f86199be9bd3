"""The structure of a set of rows: which couple, which repeat others, which contradict them.

How nearly rows repeat each other is a *condition number*: scale every row to unit length, measured
with the metric's inverse and counting its standard deviation as one more coordinate, and divide
the largest singular value of those that couple by the smallest. Orthogonal rows have 1, two rows
at an angle have the cotangent of half of it, and rows that imply each other have infinity. It says
how far a motion has to go where targets disagree a little: millimetres times the condition number.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, sparse
from scipy.sparse.csgraph import connected_components

from projflow_lite.constraints import Rows, describe_row
from projflow_lite.skeleton import N_JOINTS

DEPENDENT = 1e-12
"""Rows imply another when they leave less than this share of its length: rounding, no more."""

DOUBTFUL = 1e-6
"""Below this eigenvalue of the rows' correlations their squares say too little: look at rows."""

TOO_NEARLY_DEPENDENT = 1e6
"""Condition number above which float64 cannot meet rows exactly, so they are refused."""

AGREEMENT = 1e-6
"""Redundant rows may disagree by this many metres: rounding of float32 targets, not two wishes."""


def numbered(values: NDArray, most: int) -> tuple[NDArray, NDArray]:
    """Distinct values, rising, and the place of each value among them.

    As ``np.unique`` does it by sorting, but quicker for whole numbers from 0 to below `most`.
    """
    there = np.zeros(most, dtype=bool)
    there[values] = True
    return np.flatnonzero(there), np.cumsum(there)[values] - 1


def blocks_of_rows(A: sparse.csr_matrix) -> list[NDArray]:
    """Split rows into groups that share no frame and axis; each group can be solved alone.

    Returns:
        One array ``(blocks, size)`` of row indices for every size of group that occurs.
    """
    if A.shape[0] == 0:
        return []
    cell = A.indices // (3 * N_JOINTS) * 3 + A.indices % 3
    label = cell[A.indptr[:-1]]
    if (cell != np.repeat(label, np.diff(A.indptr))).any():  # some rows reach beyond one cell
        touches = sparse.csr_matrix((np.ones(A.nnz), cell, A.indptr), (A.shape[0], A.shape[1]))
        _, label = connected_components(touches @ touches.T, directed=False)
    size = np.bincount(label)[label]
    order = np.lexsort((label, size))  # stable: within a group the rows keep their order
    return [order[size[order] == n].reshape(-1, n) for n in np.unique(size)]


def metric_times_rows(A: sparse.csr_matrix, covariance: NDArray) -> sparse.csr_matrix:
    r""":math:`R^{-1} A^\top`, ``(d, m)``: how every coordinate moves when one row is pulled."""
    entries = A.tocoo()
    joint = entries.col // 3 % N_JOINTS
    # An entry pulls all joints of its frame, along its axis.
    moved = (entries.col - 3 * joint)[:, None] + 3 * np.arange(N_JOINTS)
    size = entries.data[:, None] * covariance[joint]
    pulled = np.broadcast_to(entries.row[:, None], moved.shape)
    return sparse.csr_matrix((size.ravel(), (moved.ravel(), pulled.ravel())), A.shape[::-1])


def observed_covariance(A: sparse.csr_matrix, covariance: NDArray) -> sparse.csr_matrix:
    r""":math:`A R^{-1} A^\top`, ``(m, m)``."""
    return (A @ metric_times_rows(A, covariance)).tocsr()


def dense_blocks(S: sparse.csr_matrix, block: NDArray) -> NDArray:
    """Cut blocks of equal size out of ``S``: ``(blocks, size)`` to ``(blocks, size, size)``."""
    size = block.shape[1]
    entries = S[np.repeat(block, size, axis=1).ravel(), np.tile(block, size).ravel()]
    return np.asarray(entries).reshape(-1, size, size)


def observed_blocks(
    A: sparse.csr_matrix, covariance: NDArray, blocks: list[NDArray]
) -> list[NDArray]:
    r"""Parts of :math:`A R^{-1} A^\top`: of each group of blocks, ``(blocks, size, size)``."""
    if (np.diff(A.indptr) == 1).all():  # single coordinates: those of a block differ in joint only
        joint, weight = A.indices // 3 % N_JOINTS, A.data
        return [
            weight[block][:, :, None]
            * covariance[joint[block][:, :, None], joint[block][:, None]]
            * weight[block][:, None]
            for block in blocks
        ]
    whole = observed_covariance(A, covariance)
    return [dense_blocks(whole, block) for block in blocks]


class Independent(NamedTuple):
    """The rows that stay when those are dropped that others imply.

    Attributes:
        keep: ``(kept,)`` their indices.
        condition: the largest condition number of a block of them.
        worst: the indices of the rows of that block; empty where no rows couple.
        blocks: the rows that stay, in groups that can be solved alone, see `blocks_of_rows`.
        observed: their parts of :math:`A R^{-1} A^\\top`, see `observed_blocks`.
    """

    keep: NDArray[np.int64]
    condition: float
    worst: NDArray[np.int64]
    blocks: list[NDArray]
    observed: list[NDArray]


def independent_rows(rows: Rows, covariance: NDArray) -> Independent:
    """Drop the rows that others imply, and say how nearly the rest imply each other.

    Raises:
        ValueError: if a row contradicts the others, or hardly differs from what they say.
    """
    blocks = blocks_of_rows(rows.A)
    observed = observed_blocks(rows.A, covariance, blocks)
    keep = np.ones(len(rows.y), dtype=bool)
    condition, worst = 1.0, np.zeros(0, dtype=np.int64)
    for block, dense in zip(blocks, observed, strict=True):
        dense = dense + rows.variance[block][:, None] * np.eye(block.shape[1])
        scale = 1 / np.sqrt(np.diagonal(dense, axis1=1, axis2=2))
        eigenvalues = np.linalg.eigvalsh(dense * scale[:, :, None] * scale[:, None, :])
        # The correlations are the unit rows squared, and so are their singular values.
        conditions = np.sqrt(eigenvalues[:, -1] / eigenvalues[:, 0].clip(min=DOUBTFUL))
        for k in np.flatnonzero(eigenvalues[:, 0] < DOUBTFUL):
            dropped, conditions[k] = implied_rows(rows, covariance, block[k])
            keep[dropped] = False
        k = np.argmax(conditions)
        if conditions[k] > condition:
            condition, worst = float(conditions[k]), block[k]
    if not keep.all():  # what is left may fall apart into smaller blocks
        stay = np.flatnonzero(keep)
        blocks = [stay[block] for block in blocks_of_rows(rows.A[stay])]
        observed = observed_blocks(rows.A, covariance, blocks)
    return Independent(np.flatnonzero(keep), condition, worst[keep[worst]], blocks, observed)


def unit_rows(rows: Rows, covariance: NDArray, index: NDArray) -> tuple[NDArray, NDArray]:
    """Rows scaled to unit length in the metric's inverse, ``(m, k)``, and their lengths ``(m,)``.

    The last coordinates are the rows' own standard deviations: noise of each, shared by none.
    """
    part = rows.A[index].tocoo()
    point, axis = np.divmod(part.col, 3)
    frame, joint = np.divmod(point, N_JOINTS)
    cells, cell = np.unique(frame * 3 + axis, return_inverse=True)
    dense = np.zeros((len(index), len(cells), N_JOINTS))
    dense[part.row, cell, joint] = part.data
    whole = (dense @ np.linalg.cholesky(covariance)).reshape(len(index), -1)
    whole = np.hstack([whole, np.diag(np.sqrt(rows.variance[index]))])
    length = np.linalg.norm(whole, axis=1)
    return whole / length[:, None], length


def implied_rows(rows: Rows, covariance: NDArray, index: NDArray) -> tuple[NDArray, float]:
    """The rows of one block that others imply, and the condition number of the others.

    Worked out on the rows themselves, for in the matrix S their angles are squared and lost.

    Raises:
        ValueError: if a row contradicts the others, or hardly differs from what they say.
    """
    unit, length = unit_rows(rows, covariance, index)
    R, order = linalg.qr(unit.T, mode="r", pivoting=True)
    rank = int((np.abs(np.diag(R)) > DEPENDENT).sum())
    kept, dropped = order[:rank], order[rank:]
    weights = linalg.solve_triangular(R[:rank, :rank], R[:rank, rank:]).T
    weights = weights * length[dropped, None] / length[kept]
    clash = np.abs(weights @ rows.y[index[kept]] - rows.y[index[dropped]]) > AGREEMENT
    if clash.any():
        first = np.argmax(clash)
        raise ValueError(explain_clash(rows, index[dropped[first]], index[kept], weights[first]))
    singular = linalg.svdvals(unit[kept])
    condition = float(singular[0] / singular[-1])
    if condition > TOO_NEARLY_DEPENDENT:
        names = name_nearest(rows, covariance, index[kept])
        raise ValueError(f"Projector: {names} are too nearly the same to meet both; leave one out")
    return index[dropped], condition


def name_nearest(rows: Rows, covariance: NDArray, index: NDArray) -> str:
    """Name the two rows that most of the block's weakest combination is made of."""
    unit, _ = unit_rows(rows, covariance, index)
    weakest = np.abs(linalg.svd(unit, full_matrices=False)[0][:, -1])
    two = np.sort(index[np.argsort(-weakest, kind="stable")[:2]])
    return " and ".join(f"row {k} ({describe_row(rows.A, k, most=2)})" for k in two)


def explain_clash(rows: Rows, row: int, others: NDArray, implied: NDArray) -> str:
    """One line that names two rows which cannot both hold, or the row that the others rule out."""
    first, second = sorted((row, others[np.argmax(np.abs(implied))]))
    where = describe_row(rows.A, first, most=3)
    if where == describe_row(rows.A, second, most=3):
        one, other = told_apart(rows.y[first], rows.y[second])
        return f"rows {first} and {second} contradict each other: {where} = {one} and {other}"
    asked, said = told_apart(rows.y[row], implied @ rows.y[others])
    return (
        f"row {row} contradicts the other rows: {describe_row(rows.A, row, most=3)} = {asked}, "
        f"but they imply {said}"
    )


def told_apart(a: float, b: float) -> tuple[str, str]:
    """Two numbers with as few digits, six or more, as show that they differ."""
    pairs = ((f"{a:.{digits}g}", f"{b:.{digits}g}") for digits in range(6, 18))
    return next((pair for pair in pairs if pair[0] != pair[1]), (repr(a), repr(b)))
