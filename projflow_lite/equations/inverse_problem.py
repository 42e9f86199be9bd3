r"""A wish as a linear measurement: ProjFlow eq. 4 and 6.

Here a motion is a vector of length d; `vectorise` and `unvectorise` go back and forth.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import linear_model, positive_definite, real_array

SINGULAR = "; hard constraints have no inverse variance, use eq. 7 (project) for them"


def vectorise(x: ArrayLike) -> NDArray:
    r"""Write a motion as a vector, frame by frame, joint by joint, axis by axis.

    .. math:: i = (n J + j)\, 3 + c

    Args:
        x: ``(..., N, J, 3)``.

    Returns:
        ``(..., d)`` with d = 3 N J.

    Raises:
        ValueError: if the shape does not end in ``(N, J, 3)``.

    Source: ProjFlow section 3.1.
    """
    x = real_array("vectorise", "x", x)
    if x.ndim < 3 or x.shape[-1] != 3:
        raise ValueError(f"vectorise: x has shape {x.shape}, expected (..., frames, joints, 3)")
    return x.reshape(*x.shape[:-3], -1)


def unvectorise(x: ArrayLike, frames: int, joints: int) -> NDArray:
    r"""Read a vector as a motion again; the inverse of `vectorise`.

    .. math:: (n, j, c) = (\lfloor i / 3J \rfloor,\ \lfloor i / 3 \rfloor \bmod J,\ i \bmod 3)

    Args:
        x: ``(..., d)``.
        frames: N.
        joints: J.

    Returns:
        ``(..., N, J, 3)``.

    Raises:
        ValueError: if d is not 3 N J.

    Source: ProjFlow section 3.1.
    """
    x = real_array("unvectorise", "x", x)
    if x.ndim == 0 or x.shape[-1] != 3 * frames * joints:
        raise ValueError(f"unvectorise: shape {x.shape} does not end in 3 * {frames} * {joints}")
    return x.reshape(*x.shape[:-1], frames, joints, 3)


def observe(x: ArrayLike, A: ArrayLike, noise: ArrayLike) -> NDArray:
    r"""Measure a motion linearly.

    .. math:: y = A x + \epsilon, \qquad \epsilon \sim \mathcal{N}(0, \Sigma)

    Args:
        x: ``(d,)``.
        A: ``(m, d)``.
        noise: ``(m,)``, a draw of :math:`\epsilon`; zeros for a hard constraint.

    Returns:
        ``(m,)``.

    Raises:
        ValueError: if shapes do not fit.

    Source: ProjFlow eq. 4 and 27.
    """
    x = real_array("observe", "x", x, (None,))
    A = real_array("observe", "A", A, (None, len(x)))
    return A @ x + real_array("observe", "noise", noise, (len(A),))


def squared_norm(u: ArrayLike, W: ArrayLike) -> float:
    r"""Squared length of a vector in a metric.

    .. math:: \lVert u \rVert_W^2 = u^\top W u

    Args:
        u: ``(k,)``.
        W: ``(k, k)``.

    Raises:
        ValueError: if shapes do not fit.

    Source: the notation of ProjFlow eq. 6.
    """
    u = real_array("squared_norm", "u", u, (None,))
    W = real_array("squared_norm", "W", W, (len(u), len(u)))
    return float(u @ W @ u)


def projection_objective(
    delta: ArrayLike, x1_hat: ArrayLike, A: ArrayLike, y: ArrayLike, R: ArrayLike, Sigma: ArrayLike
) -> float:
    r"""Price of a correction: its size in the metric plus what it leaves of the misfit.

    .. math:: \tfrac12 \lVert \Delta \rVert_R^2
              + \tfrac12 \lVert y - A(\hat{x}_1 + \Delta) \rVert_{\Sigma^{-1}}^2

    Args:
        delta: ``(d,)``, the correction.
        x1_hat: ``(d,)``, the predicted endpoint.
        A: ``(m, d)``.
        y: ``(m,)``.
        R: ``(d, d)``, positive definite.
        Sigma: ``(m, m)``, positive definite. As it shrinks to 0 the second term becomes the
            constraint :math:`A(\hat{x}_1 + \Delta) = y`, and this function has no value.

    Raises:
        ValueError: if shapes do not fit or Sigma is singular.

    Source: ProjFlow eq. 6.
    """
    x1_hat, A, y, R, Sigma = linear_model("projection_objective", x1_hat, A, y, R, Sigma)
    positive_definite("projection_objective", "Sigma", Sigma, SINGULAR)
    delta = real_array("projection_objective", "delta", delta, x1_hat.shape)
    misfit = y - A @ (x1_hat + delta)
    return 0.5 * squared_norm(delta, R) + 0.5 * squared_norm(misfit, np.linalg.inv(Sigma))
