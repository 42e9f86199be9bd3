r"""The projection in closed form, and the method it generalises: ProjFlow eq. 7, 8, 21–25, 34.

Here a motion is a vector of length d (see `vectorise`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import linear_model, one_of, real_array

RANK_TOLERANCE = 1e-13
CONTRADICTION_TOLERANCE = 1e-12


def solve_consistent(
    S: NDArray, residual: NDArray, A: NDArray, Sigma: NDArray, scale: NDArray
) -> NDArray:
    r"""Solve the system of eq. 7, also where rows are redundant, if it has a solution at all.

    .. math:: (A R^{-1} A^\top + \Sigma)\, z = r

    Some combination of rows may measure nothing and carry no variance. Such a combination is a
    null vector of :math:`A A^\top + \Sigma`, whatever the metric; it must find nothing in r.

    Args:
        S: ``(m, m)``, :math:`A R^{-1} A^\top + \Sigma`.
        residual: ``(m,)``, r.
        A: ``(m, d)``.
        Sigma: ``(m, m)``.
        scale: ``(m,)``, size of the numbers that r was computed from; a contradiction below
            1e-12 of it is rounding.

    Returns:
        ``(m,)``, a solution.

    Raises:
        ValueError: if rows contradict each other; the message names them.

    Source: the inverse in ProjFlow eq. 7.
    """
    G = A @ A.T + Sigma
    unit = 1 / np.sqrt(np.where(np.diag(G) > 0, np.diag(G), 1))  # rows of any scale, made alike
    eigenvalue, U = np.linalg.eigh(unit[:, None] * G * unit)
    idle = U[:, eigenvalue < RANK_TOLERANCE * len(G)]
    unsolvable = np.abs(idle @ (idle.T @ (unit * residual)))
    if unsolvable.max(initial=0) > CONTRADICTION_TOLERANCE * (unit * scale).max(initial=0):
        rows = np.flatnonzero(unsolvable > 0.01 * unsolvable.max())
        if len(rows) == 1:
            raise ValueError(f"project: row {rows[0]} measures nothing, yet asks for a value")
        raise ValueError(f"project: rows {', '.join(map(str, rows))} contradict each other")
    S_regular = unit[:, None] * S * unit + idle @ idle.T  # z is 0 along idle directions
    return unit * np.linalg.solve(S_regular, unit * residual)


def projection_correction(
    x1_hat: ArrayLike,
    A: ArrayLike,
    y: ArrayLike,
    R: ArrayLike,
    Sigma: ArrayLike,
    form: str = "derived",
) -> NDArray:
    r"""Smallest correction, in the metric R, that meets the measurements.

    .. math:: \Delta^* = R^{-1} A^\top (A R^{-1} A^\top + \Sigma)^{-1} (y - A \hat{x}_1)

    Args:
        x1_hat: ``(d,)``, the predicted endpoint.
        A: ``(m, d)``; any m, 0 included, and any rank.
        y: ``(m,)``.
        R: ``(d, d)``, positive definite.
        Sigma: ``(m, m)``, positive semidefinite; 0 makes every row exact.
        form: ``"derived"`` as above, with the pseudo-inverse where rows are redundant but agree.
            ``"released"`` adds 1e-8 to the diagonal as the public code does: never singular,
            never exact, and contradictions pass unnoticed.

    Returns:
        ``(d,)``.

    Raises:
        ValueError: if shapes do not fit, R is not positive definite, Sigma is not positive
            semidefinite, or exact rows contradict each other.

    Source: ProjFlow eq. 7.
    """
    one_of("project", form, ("derived", "released"))
    x1_hat, A, y, R, Sigma = linear_model("project", x1_hat, A, y, R, Sigma)
    R_inv_At = np.linalg.solve(R, A.T)
    S = A @ R_inv_At + Sigma
    residual = y - A @ x1_hat
    if form == "released":
        return R_inv_At @ np.linalg.solve(S + 1e-8 * np.eye(len(y)), residual)
    scale = np.abs(y) + np.abs(A) @ np.abs(x1_hat)
    return R_inv_At @ solve_consistent(S, residual, A, Sigma, scale)


def project(
    x1_hat: ArrayLike,
    A: ArrayLike,
    y: ArrayLike,
    R: ArrayLike,
    Sigma: ArrayLike,
    form: str = "derived",
) -> NDArray:
    r"""Corrected endpoint: the prediction plus the smallest correction that meets the wish.

    .. math:: \hat{x}_1^* = \hat{x}_1
              + R^{-1} A^\top (A R^{-1} A^\top + \Sigma)^{-1} (y - A \hat{x}_1)

    Args:
        x1_hat: ``(d,)``, the predicted endpoint.
        A: ``(m, d)``; any m, 0 included, and any rank.
        y: ``(m,)``.
        R: ``(d, d)``, positive definite.
        Sigma: ``(m, m)``, positive semidefinite; 0 makes every row exact.
        form: ``"derived"`` or ``"released"``, see `projection_correction`.

    Returns:
        ``(d,)``.

    Raises:
        ValueError: if shapes do not fit, R is not positive definite, Sigma is not positive
            semidefinite, or exact rows contradict each other.

    Source: ProjFlow eq. 7–8, again as 22 and 34.
    """
    delta = projection_correction(x1_hat, A, y, R, Sigma, form)
    return np.asarray(x1_hat, dtype=np.float64) + delta


def ddnm(x1_hat: ArrayLike, A: ArrayLike, y: ArrayLike) -> NDArray:
    r"""Keep what the measurement fixes from `y`, and the rest from the prediction.

    .. math:: \hat{x}_1^* = A^{+} y + (I - A^{+} A)\, \hat{x}_1

    Args:
        x1_hat: ``(d,)``.
        A: ``(m, d)``, of any rank.
        y: ``(m,)``. If no motion meets it, the nearest in the least-squares sense is met.

    Returns:
        ``(d,)``.

    Raises:
        ValueError: if shapes do not fit.

    Source: ProjFlow eq. 21 and 25.
    """
    x1_hat, A, y = _noiseless("ddnm", x1_hat, A, y)
    A_pinv = np.linalg.pinv(A)
    return A_pinv @ y + (np.eye(len(x1_hat)) - A_pinv @ A) @ x1_hat


def euclidean_projection(x1_hat: ArrayLike, A: ArrayLike, y: ArrayLike) -> NDArray:
    r"""Eq. 7 with R = I and Sigma = 0: the orthogonal projection onto A x = y.

    .. math:: \hat{x}_1^* = \hat{x}_1 + A^\top (A A^\top)^{-1} (y - A \hat{x}_1)

    Args:
        x1_hat: ``(d,)``.
        A: ``(m, d)`` of full row rank. A square mask with unobserved coordinates never is: its
            empty rows make :math:`A A^\top` singular. `ddnm` needs no such assumption.
        y: ``(m,)``.

    Returns:
        ``(d,)``.

    Raises:
        ValueError: if shapes do not fit or rows of A are dependent.

    Source: ProjFlow eq. 23.
    """
    x1_hat, A, y = _noiseless("euclidean_projection", x1_hat, A, y)
    if np.linalg.matrix_rank(A) < len(A):
        raise ValueError("euclidean_projection: rows of A are dependent; use ddnm (eq. 21)")
    return x1_hat + A.T @ np.linalg.solve(A @ A.T, y - A @ x1_hat)


def euclidean_projection_expanded(x1_hat: ArrayLike, A: ArrayLike, y: ArrayLike) -> NDArray:
    r"""The same step with the pseudo-inverse multiplied out.

    .. math:: \hat{x}_1^* = \hat{x}_1 + A^{+} y - A^{+} A\, \hat{x}_1, \qquad
              A^{+} = A^\top (A A^\top)^{-1} \text{ for full row rank}

    Args:
        x1_hat: ``(d,)``.
        A: ``(m, d)``, of any rank.
        y: ``(m,)``.

    Returns:
        ``(d,)``.

    Raises:
        ValueError: if shapes do not fit.

    Source: ProjFlow eq. 24.
    """
    x1_hat, A, y = _noiseless("euclidean_projection_expanded", x1_hat, A, y)
    A_pinv = np.linalg.pinv(A)
    return x1_hat + A_pinv @ y - A_pinv @ A @ x1_hat


def _noiseless(
    who: str, x1_hat: ArrayLike, A: ArrayLike, y: ArrayLike
) -> tuple[NDArray, NDArray, NDArray]:
    """Check the three arrays of a measurement without noise."""
    x1_hat = real_array(who, "x1_hat", x1_hat, (None,))
    A = real_array(who, "A", A, (None, len(x1_hat)))
    return x1_hat, A, real_array(who, "y", y, (len(A),))
