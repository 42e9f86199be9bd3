r"""How much of a misfit an observed coordinate corrects: ProjFlow eq. 18 and 39–47.

Here a motion is a vector of length d (see `vectorise`), and a mask M is a d × d diagonal matrix
of zeros and ones. Unobserved coordinates make its rows empty: wherever such a row has no
variance either, the matrix that eq. 39–45 invert is singular. The derived forms leave those rows
out, by the pseudo-inverse; the printed forms stop with an error.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import (
    diagonal_mask,
    linear_model,
    one_of,
    positive_semidefinite,
    real_array,
    same_shape,
)


def euclidean_masked_update(
    x1_hat: ArrayLike, M: ArrayLike, y: ArrayLike, Sigma: ArrayLike, form: str = "derived"
) -> NDArray:
    r"""Eq. 7 for a mask under the Euclidean metric.

    .. math:: \hat{x}_1^* = \hat{x}_1 + M (M + \Sigma)^{-1} (y - M \hat{x}_1)

    Args:
        x1_hat: ``(d,)``.
        M: ``(d, d)``, a mask.
        y: ``(d,)``.
        Sigma: ``(d, d)``, positive semidefinite.
        form: ``"derived"`` takes the pseudo-inverse, ``"printed"`` the inverse.

    Returns:
        ``(d,)``.

    Raises:
        ValueError: if shapes do not fit; in the printed form if M + Sigma is singular.

    Source: ProjFlow eq. 39.
    """
    x1_hat, M, y, Sigma = _masked_model("euclidean_masked_update", x1_hat, M, y, Sigma)
    gain = M @ _inverse("euclidean_masked_update", M + Sigma, form)
    return x1_hat + gain @ (y - M @ x1_hat)


def euclidean_masked_average(
    x1_hat: ArrayLike, M: ArrayLike, y: ArrayLike, Sigma: ArrayLike, form: str = "derived"
) -> NDArray:
    r"""The same step, sorted into a share of the prediction and a share of the data.

    .. math:: \hat{x}_1^* = \bigl(I - M (M + \Sigma)^{-1} M\bigr) \hat{x}_1
              + M (M + \Sigma)^{-1} y

    Args:
        x1_hat: ``(d,)``.
        M: ``(d, d)``, a mask.
        y: ``(d,)``.
        Sigma: ``(d, d)``, positive semidefinite.
        form: ``"derived"`` takes the pseudo-inverse, ``"printed"`` the inverse.

    Returns:
        ``(d,)``.

    Raises:
        ValueError: if shapes do not fit; in the printed form if M + Sigma is singular.

    Source: ProjFlow eq. 40.
    """
    x1_hat, M, y, Sigma = _masked_model("euclidean_masked_average", x1_hat, M, y, Sigma)
    gain = M @ _inverse("euclidean_masked_average", M + Sigma, form)
    return (np.eye(len(M)) - gain @ M) @ x1_hat + gain @ y


def euclidean_coordinate_update(x_i: ArrayLike, y_i: ArrayLike, variance: ArrayLike) -> NDArray:
    r"""What that step does to one observed coordinate.

    .. math:: \hat{x}_i^* = \Bigl(1 - \frac{1}{1 + \sigma_i^2}\Bigr) \hat{x}_i
              + \frac{1}{1 + \sigma_i^2}\, y_i

    Args:
        x_i: predicted coordinates, any shape.
        y_i: measured coordinates, same shape.
        variance: :math:`\sigma_i^2 \ge 0`, same shape; relative to the prior's variance, 1.

    Raises:
        ValueError: if shapes differ or a variance is negative.

    Source: ProjFlow eq. 41.
    """
    x_i, y_i, variance = same_shape(
        "euclidean_coordinate_update", x_i=x_i, y_i=y_i, variance=variance
    )
    if (variance < 0).any():
        raise ValueError("euclidean_coordinate_update: a variance is negative")
    return (1 - 1 / (1 + variance)) * x_i + 1 / (1 + variance) * y_i


def euclidean_gain(variance: ArrayLike) -> NDArray:
    r"""Weight of the data in that step.

    .. math:: \pi_{i, Euclid} = \frac{1}{1 + \sigma_i^2}

    Args:
        variance: :math:`\sigma_i^2 \ge 0`, any shape.

    Raises:
        ValueError: if a variance is negative.

    Source: ProjFlow eq. 42.
    """
    variance = real_array("euclidean_gain", "variance", variance)
    if (variance < 0).any():
        raise ValueError("euclidean_gain: a variance is negative")
    return 1 / (1 + variance)


def weighted_average(x_i: ArrayLike, y_i: ArrayLike, pi: ArrayLike) -> NDArray:
    r"""The step again, in terms of that weight.

    .. math:: \hat{x}_i^* = (1 - \pi_i)\, \hat{x}_i + \pi_i\, y_i

    Args:
        x_i: predicted coordinates, any shape.
        y_i: measured coordinates, same shape.
        pi: weights, same shape.

    Raises:
        ValueError: if shapes differ.

    Source: ProjFlow eq. 43.
    """
    x_i, y_i, pi = same_shape("weighted_average", x_i=x_i, y_i=y_i, pi=pi)
    return (1 - pi) * x_i + pi * y_i


def masked_update(
    x1_hat: ArrayLike,
    M: ArrayLike,
    y: ArrayLike,
    R: ArrayLike,
    Sigma: ArrayLike,
    form: str = "derived",
) -> NDArray:
    r"""Eq. 7 for a mask under any metric.

    .. math:: \hat{x}_1^* = \hat{x}_1
              + R^{-1} M^\top (M R^{-1} M^\top + \Sigma)^{-1} (y - M \hat{x}_1)

    Args:
        x1_hat: ``(d,)``.
        M: ``(d, d)``, a mask.
        y: ``(d,)``.
        R: ``(d, d)``, positive definite.
        Sigma: ``(d, d)``, positive semidefinite.
        form: ``"derived"`` takes the pseudo-inverse, ``"printed"`` the inverse.

    Returns:
        ``(d,)``.

    Raises:
        ValueError: if shapes do not fit; in the printed form if the inverse does not exist.

    Source: ProjFlow eq. 44, first line.
    """
    x1_hat, M, y, R, Sigma = linear_model("masked_update", x1_hat, M, y, R, Sigma)
    M, R_inv = diagonal_mask("masked_update", "M", M, len(x1_hat)), np.linalg.inv(R)
    gain = R_inv @ M.T @ _inverse("masked_update", M @ R_inv @ M.T + Sigma, form)
    return x1_hat + gain @ (y - M @ x1_hat)


def masked_average(
    x1_hat: ArrayLike,
    M: ArrayLike,
    y: ArrayLike,
    R: ArrayLike,
    Sigma: ArrayLike,
    form: str = "derived",
) -> NDArray:
    r"""The same step, sorted into what the prediction and what the data contribute.

    .. math:: \hat{x}_1^* = (I - K M)\, \hat{x}_1 + K y, \qquad
              K = R^{-1} M^\top (M R^{-1} M^\top + \Sigma)^{-1}

    Args:
        x1_hat: ``(d,)``.
        M: ``(d, d)``, a mask.
        y: ``(d,)``.
        R: ``(d, d)``, positive definite.
        Sigma: ``(d, d)``, positive semidefinite.
        form: ``"derived"`` takes the pseudo-inverse, ``"printed"`` the inverse.

    Returns:
        ``(d,)``.

    Raises:
        ValueError: if shapes do not fit; in the printed form if the inverse does not exist.

    Source: ProjFlow eq. 44, second line, which the numbering counts as 45.
    """
    x1_hat, M, y, R, Sigma = linear_model("masked_average", x1_hat, M, y, R, Sigma)
    M, R_inv = diagonal_mask("masked_average", "M", M, len(x1_hat)), np.linalg.inv(R)
    K = R_inv @ M.T @ _inverse("masked_average", M @ R_inv @ M.T + Sigma, form)
    return (np.eye(len(M)) - K @ M) @ x1_hat + K @ y


def trust_from_variance(variance: ArrayLike, r: ArrayLike) -> NDArray:
    r"""Share of a misfit that a single observed coordinate corrects.

    .. math:: \pi_i = \frac{r_i}{r_i + \sigma_i^2}

    Args:
        variance: :math:`\sigma_i^2 \ge 0`, any shape.
        r: :math:`r_i > 0`, same shape, from `marginal_variance`.

    Raises:
        ValueError: if shapes differ or a value has the wrong sign.

    Source: ProjFlow eq. 46.
    """
    variance, r = same_shape("trust_from_variance", variance=variance, r=r)
    if (variance < 0).any() or (r <= 0).any():
        raise ValueError("trust_from_variance: variance must not be negative, r positive")
    return r / (r + variance)


def variance_from_trust(pi: ArrayLike, r: ArrayLike) -> NDArray:
    r"""Variance that makes a single observed coordinate correct a given share of its misfit.

    .. math:: \sigma_i^2 = r_i \frac{1 - \pi_i}{\pi_i}
              = r_i \Bigl(\frac{1}{\pi_i} - 1\Bigr)

    Args:
        pi: trust in (0, 1], any shape; 1 gives variance 0, a hard row.
        r: :math:`r_i > 0`, same shape, from `marginal_variance`.

    Raises:
        ValueError: if shapes differ, `r` is not positive, or a trust leaves (0, 1]: above 1 the
            formula would return a negative variance.

    Source: ProjFlow eq. 18 and 47.
    """
    pi, r = same_shape("variance_from_trust", pi=pi, r=r)
    if ((pi <= 0) | (pi > 1)).any() or (r <= 0).any():
        raise ValueError("variance_from_trust: pi must be in (0, 1], clip it first; r positive")
    return r * (1 - pi) / pi


def _inverse(who: str, S: NDArray, form: str) -> NDArray:
    """Invert S, or, in the derived form, the part of it that can be inverted."""
    one_of(who, form, ("derived", "printed"))
    if form == "derived":
        return np.linalg.pinv(S, rcond=1e-13, hermitian=True)
    if np.linalg.matrix_rank(S, hermitian=True) < len(S):
        raise ValueError(f"{who}: the matrix to invert is singular; use form='derived'")
    return np.linalg.inv(S)


def _masked_model(
    who: str, x1_hat: ArrayLike, M: ArrayLike, y: ArrayLike, Sigma: ArrayLike
) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Check the four arrays of a masked measurement."""
    x1_hat = real_array(who, "x1_hat", x1_hat, (None,))
    d = len(x1_hat)
    Sigma = positive_semidefinite(who, "Sigma", real_array(who, "Sigma", Sigma, (d, d)))
    return x1_hat, diagonal_mask(who, "M", M, d), real_array(who, "y", y, (d,)), Sigma
