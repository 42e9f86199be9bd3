r"""What every constraint becomes: rows ``A x = y``, and a wish that stacks them.

.. math:: y = A x + \epsilon, \qquad \epsilon \sim \mathcal N(0, \Sigma)

with :math:`x` the motion in frame-major order, index ``(frame * 22 + joint) * 3 + axis``, metres,
and :math:`\Sigma` diagonal (ProjFlow eq. 4). A row of variance 0 is hard: it must hold exactly.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, aslinearoperator

from projflow_lite.skeleton import JOINTS, N_JOINTS, check_positions, shown

AXES = "xyz"


class Rows(NamedTuple):
    """A linear wish about a motion of known length.

    Attributes:
        A: ``(m, frames * 22 * 3)`` sparse matrix.
        y: ``(m,)`` targets, metres.
        variance: ``(m,)`` variance of each target, square metres; 0 means exactly.
    """

    A: sparse.csr_matrix
    y: NDArray[np.float64]
    variance: NDArray[np.float64]


class Markers(NamedTuple):
    """The points of space that a wish names: one entry for each pinned frame and joint.

    Attributes:
        frame: ``(k,)`` frame of each point.
        joint: ``(k,)`` joint of each point.
        target: ``(k, 3)`` metres; NaN on an axis that is left free.
        std: ``(k,)`` standard deviation, metres; 0 means exactly.
    """

    frame: NDArray[np.int64]
    joint: NDArray[np.int64]
    target: NDArray[np.float64]
    std: NDArray[np.float64]


class Term(NamedTuple):
    """One constraint: a sentence for people, and the rows for a motion of a given length."""

    sentence: str
    build: Callable[[int], Rows]


@dataclass(frozen=True, repr=False)
class Wish:
    """One or several constraints, stacked with ``&``. Made by `pin` and its neighbours.

    Raises:
        ValueError: without a constraint.
    """

    terms: tuple[Term, ...]

    def __post_init__(self) -> None:
        terms = self.terms if isinstance(self.terms, tuple) else ()
        if not terms or not all(isinstance(term, Term) for term in terms):
            raise ValueError(f"Wish: made by pin and its neighbours, not of {shown(self.terms)}")

    def __and__(self, other: Wish) -> Wish:
        """Ask for both.

        Raises:
            TypeError: for something that is no wish.
        """
        if not isinstance(other, Wish):
            raise TypeError(f"Wish: & stacks a wish and a wish, not {shown(other)}")
        return Wish(self.terms + other.terms)

    __rand__ = __and__

    def __bool__(self) -> bool:
        """A wish is neither true nor false, or ``a and b`` would silently be b alone.

        Raises:
            TypeError: always.
        """
        raise TypeError("Wish: a wish is neither true nor false; stack wishes with &, not 'and'")

    def __repr__(self) -> str:
        """Say in words what is asked for."""
        return "Wish: " + "; ".join(term.sentence for term in self.terms)

    def rows(self, frames: int) -> Rows:
        """Write the wish as rows for a motion of `frames` frames.

        Raises:
            ValueError: if a constraint names a frame that the motion does not have.
        """
        whole = isinstance(frames, int | np.integer) and not isinstance(frames, bool)
        if not whole or frames < 1:
            raise ValueError(f"rows: frames is a whole number of at least 1, not {shown(frames)}")
        return stack([term.build(int(frames)) for term in self.terms])

    def operator(self, frames: int) -> LinearOperator:
        """``A`` as a scipy linear operator ``(m, frames * 22 * 3)``, for scipy's solvers.

        Raises:
            ValueError: as for `rows`.
        """
        return aslinearoperator(self.rows(frames).A)

    def residual(self, positions: NDArray) -> float:
        """Largest ``|A x - y|`` over the hard rows, metres.

        Args:
            positions: ``(..., frames, 22, 3)``, metres.

        Raises:
            ValueError: for another shape, or a length that the wish was not made for.
        """
        positions = check_positions(positions, "Wish.residual")
        A, y, variance = self.rows(positions.shape[-3])
        hard = variance == 0
        if not hard.any():
            return 0.0
        x = positions.reshape(-1, A.shape[1]).astype(np.float64)
        return float(np.abs(A[hard] @ x.T - y[hard, None]).max())

    def markers(self, frames: int) -> Markers:
        """Every point that the wish names, for drawing it: see `Markers`."""
        A, y, variance = self.rows(frames)
        single = is_coordinate(A)
        column = A.indices[A.indptr[:-1][single]]
        joint_frames, point = np.unique(column // 3, return_inverse=True)
        target = np.full((len(joint_frames), 3), np.nan)
        target[point, column % 3] = y[single]
        std = np.zeros(len(joint_frames))
        np.maximum.at(std, point, np.sqrt(variance[single]))
        return Markers(joint_frames // N_JOINTS, joint_frames % N_JOINTS, target, std)


def stack(parts: list[Rows]) -> Rows:
    """Several sets of rows, about motions of one length, as one."""
    return Rows(
        sparse.vstack([part.A for part in parts], format="csr"),
        np.concatenate([part.y for part in parts]),
        np.concatenate([part.variance for part in parts]),
    )


def is_coordinate(A: sparse.csr_matrix) -> NDArray[np.bool_]:
    """Which rows of ``A`` read off a single coordinate, ``(m,)`` bool: one entry, equal to 1."""
    single = np.diff(A.indptr) == 1
    single[single] = A.data[A.indptr[:-1][single]] == 1.0
    return single


def columns_of(
    frame: NDArray | int, joint: NDArray | int, axis: NDArray | int
) -> NDArray[np.int64]:
    """Where coordinates are in a motion written as a vector; arguments broadcast."""
    return (np.asarray(frame) * N_JOINTS + joint) * 3 + axis


def weighted_rows(
    columns: NDArray, weights: NDArray, y: NDArray, frames: int, std: float = 0.0
) -> Rows:
    """Rows that measure weighted sums of coordinates: ``sum_k weights[k] x[columns[:, k]] = y``.

    Args:
        columns: ``(m, k)`` coordinates of each row.
        weights: ``(k,)`` or ``(m, k)``.
        y: ``(m,)`` targets, metres.
        frames: of the motion.
        std: standard deviation of every target, metres; 0 means exactly.
    """
    m, k = columns.shape
    data = np.broadcast_to(weights, (m, k)).astype(np.float64).ravel()
    starts = np.arange(0, m * k + 1, k)
    A = sparse.csr_matrix((data, columns.ravel(), starts), (m, frames * N_JOINTS * 3))
    if k > 1:
        A.sum_duplicates()
        A.eliminate_zeros()
    return Rows(A, np.asarray(y, dtype=np.float64), np.full(m, float(std) ** 2))


def coordinate_rows(columns: NDArray, y: NDArray, frames: int, std: float = 0.0) -> Rows:
    """Rows that read off single coordinates: ``x[columns] = y``."""
    return weighted_rows(columns[:, None], np.ones(1), y, frames, std)


def difference_rows(
    plus: NDArray, minus: NDArray, y: NDArray, frames: int, std: float = 0.0
) -> Rows:
    """Rows on differences of two coordinates: ``x[plus] - x[minus] = y``."""
    return weighted_rows(np.stack([plus, minus], 1), np.array([1.0, -1.0]), y, frames, std)


def describe_row(A: sparse.csr_matrix, row: int, most: int = 4) -> str:
    """Say which joints, frames and axes a row is about; the heaviest ones if there are many."""
    places = np.arange(A.indptr[row], A.indptr[row + 1])
    heaviest = places[np.argsort(-np.abs(A.data[places]), kind="stable")[:most]]
    parts = []
    for k in np.sort(heaviest):
        point, axis = divmod(A.indices[k], 3)
        frame, joint = divmod(point, N_JOINTS)
        weight = "" if A.data[k] == 1 else f"{A.data[k]:.4g} * "
        parts.append(f"{weight}{JOINTS[joint]}, frame {frame}, {AXES[axis]}")
    rest = len(places) - len(parts)
    return " + ".join(parts) + (f" + {rest} more" if rest else "")
