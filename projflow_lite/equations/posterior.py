r"""The projection as an estimate: prior, likelihood, posterior, ProjFlow eq. 26–33.

Here a motion is a vector of length d (see `vectorise`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import linear_model, positive_definite, real_array
from .inverse_problem import SINGULAR, observe, squared_norm


def log_prior(x1: ArrayLike, x1_hat: ArrayLike, R: ArrayLike) -> float:
    r"""Log density of the Gaussian around the predicted endpoint, with precision R.

    .. math:: \log \mathcal{N}(x_1 \mid \hat{x}_1, R^{-1})
              = -\tfrac12 \lVert x_1 - \hat{x}_1 \rVert_R^2 + \tfrac12 \log\det R
                - \tfrac d2 \log 2\pi

    Args:
        x1: ``(d,)``.
        x1_hat: ``(d,)``.
        R: ``(d, d)``, positive definite: an *inverse* covariance.

    Raises:
        ValueError: if shapes do not fit or R is not positive definite.

    Source: ProjFlow eq. 26.
    """
    x1 = real_array("log_prior", "x1", x1, (None,))
    u, d = x1 - real_array("log_prior", "x1_hat", x1_hat, x1.shape), len(x1)
    R = positive_definite("log_prior", "R", real_array("log_prior", "R", R, (d, d)))
    log_det_R = np.linalg.slogdet(R).logabsdet
    return 0.5 * float(log_det_R - squared_norm(u, R) - d * np.log(2 * np.pi))


def log_likelihood(y: ArrayLike, x1: ArrayLike, A: ArrayLike, Sigma: ArrayLike) -> float:
    r"""Log density of a measurement, given the motion.

    .. math:: \log \mathcal{N}(y \mid A x_1, \Sigma)

    Args:
        y: ``(m,)``.
        x1: ``(d,)``.
        A: ``(m, d)``.
        Sigma: ``(m, m)``, positive definite.

    Raises:
        ValueError: if shapes do not fit or Sigma is singular.

    Source: ProjFlow eq. 28.
    """
    A = real_array("log_likelihood", "A", A, (None, None))
    A_x1 = observe(x1, A, np.zeros(len(A)))
    Sigma = real_array("log_likelihood", "Sigma", Sigma, (len(A_x1), len(A_x1)))
    positive_definite("log_likelihood", "Sigma", Sigma, SINGULAR)
    return log_prior(y, A_x1, np.linalg.inv(Sigma))


def log_posterior_unnormalised(
    x1: ArrayLike, x1_hat: ArrayLike, A: ArrayLike, y: ArrayLike, R: ArrayLike, Sigma: ArrayLike
) -> float:
    r"""Log of what the posterior is proportional to.

    .. math:: -\tfrac12 \lVert x_1 - \hat{x}_1 \rVert_R^2
              - \tfrac12 \lVert y - A x_1 \rVert_{\Sigma^{-1}}^2

    Args:
        x1: ``(d,)``, where to evaluate.
        x1_hat: ``(d,)``, the predicted endpoint.
        A: ``(m, d)``.
        y: ``(m,)``.
        R: ``(d, d)``, positive definite.
        Sigma: ``(m, m)``, positive definite.

    Raises:
        ValueError: if shapes do not fit or Sigma is singular.

    Source: ProjFlow eq. 29.
    """
    return -0.5 * map_objective(x1, x1_hat, A, y, R, Sigma)


def map_objective(
    x1: ArrayLike, x1_hat: ArrayLike, A: ArrayLike, y: ArrayLike, R: ArrayLike, Sigma: ArrayLike
) -> float:
    r"""What the most probable motion minimises: twice eq. 6, in :math:`x_1 = \hat{x}_1 + \Delta`.

    .. math:: \lVert x_1 - \hat{x}_1 \rVert_R^2 + \lVert y - A x_1 \rVert_{\Sigma^{-1}}^2

    Args:
        x1: ``(d,)``, where to evaluate.
        x1_hat: ``(d,)``, the predicted endpoint.
        A: ``(m, d)``.
        y: ``(m,)``.
        R: ``(d, d)``, positive definite.
        Sigma: ``(m, m)``, positive definite.

    Raises:
        ValueError: if shapes do not fit or Sigma is singular.

    Source: ProjFlow eq. 30.
    """
    x1_hat, A, y, R, Sigma = linear_model("map_objective", x1_hat, A, y, R, Sigma)
    positive_definite("map_objective", "Sigma", Sigma, SINGULAR)
    x1 = real_array("map_objective", "x1", x1, x1_hat.shape)
    return squared_norm(x1 - x1_hat, R) + squared_norm(y - A @ x1, np.linalg.inv(Sigma))


def map_normal_equations(
    x1_hat: ArrayLike, A: ArrayLike, y: ArrayLike, R: ArrayLike, Sigma: ArrayLike
) -> tuple[NDArray, NDArray]:
    r"""Linear system that the most probable motion solves: H x = b.

    .. math:: (R + A^\top \Sigma^{-1} A)\, x_1 = R \hat{x}_1 + A^\top \Sigma^{-1} y

    Args:
        x1_hat: ``(d,)``.
        A: ``(m, d)``.
        y: ``(m,)``.
        R: ``(d, d)``, positive definite.
        Sigma: ``(m, m)``, positive definite: unlike eq. 7 this form has no limit at 0.

    Returns:
        H ``(d, d)`` and b ``(d,)``.

    Raises:
        ValueError: if shapes do not fit or Sigma is singular.

    Source: ProjFlow eq. 31.
    """
    x1_hat, A, y, R, Sigma = linear_model("map_normal_equations", x1_hat, A, y, R, Sigma)
    positive_definite("map_normal_equations", "Sigma", Sigma, SINGULAR)
    At_Sigma_inv = np.linalg.solve(Sigma, A).T
    return R + At_Sigma_inv @ A, R @ x1_hat + At_Sigma_inv @ y


def map_estimate(
    x1_hat: ArrayLike, A: ArrayLike, y: ArrayLike, R: ArrayLike, Sigma: ArrayLike
) -> NDArray:
    r"""Most probable motion, from its normal equations.

    .. math:: x_1^{MAP} = (R + A^\top \Sigma^{-1} A)^{-1}
              (R \hat{x}_1 + A^\top \Sigma^{-1} y)

    Args:
        x1_hat: ``(d,)``.
        A: ``(m, d)``.
        y: ``(m,)``.
        R: ``(d, d)``, positive definite.
        Sigma: ``(m, m)``, positive definite.

    Returns:
        ``(d,)``.

    Raises:
        ValueError: if shapes do not fit or Sigma is singular.

    Source: ProjFlow eq. 32.
    """
    H, b = map_normal_equations(x1_hat, A, y, R, Sigma)
    return np.linalg.solve(H, b)


def map_estimate_as_correction(
    x1_hat: ArrayLike, A: ArrayLike, y: ArrayLike, R: ArrayLike, Sigma: ArrayLike
) -> NDArray:
    r"""Most probable motion, as the prediction plus a correction.

    .. math:: x_1^{MAP} = \hat{x}_1 + (R + A^\top \Sigma^{-1} A)^{-1} A^\top \Sigma^{-1}
              (y - A \hat{x}_1)

    Args:
        x1_hat: ``(d,)``.
        A: ``(m, d)``.
        y: ``(m,)``.
        R: ``(d, d)``, positive definite.
        Sigma: ``(m, m)``, positive definite.

    Returns:
        ``(d,)``.

    Raises:
        ValueError: if shapes do not fit or Sigma is singular.

    Source: ProjFlow eq. 33.
    """
    H, _ = map_normal_equations(x1_hat, A, y, R, Sigma)
    x1_hat, A, y, R, Sigma = linear_model("map_estimate", x1_hat, A, y, R, Sigma)
    return x1_hat + np.linalg.solve(H, A.T @ np.linalg.solve(Sigma, y - A @ x1_hat))


def posterior_covariance(A: ArrayLike, R: ArrayLike, Sigma: ArrayLike) -> NDArray:
    r"""What is left of the prior's covariance once the measurement is known.

    .. math:: \mathrm{Cov}[x_1 \mid y]
              = R^{-1} - R^{-1} A^\top (A R^{-1} A^\top + \Sigma)^{-1} A R^{-1}

    The posterior of eq. 29 is the Gaussian with this covariance around the mean `project`.

    Args:
        A: ``(m, d)``.
        R: ``(d, d)``, positive definite.
        Sigma: ``(m, m)``, positive semidefinite.

    Returns:
        ``(d, d)``.

    Raises:
        ValueError: if shapes do not fit or a matrix is not definite.

    Source: completes ProjFlow eq. 29.
    """
    A = real_array("posterior_covariance", "A", A, (None, None))
    nothing, zero = np.zeros(A.shape[1]), np.zeros(A.shape[0])  # the covariance needs neither
    _, _, _, R, Sigma = linear_model("posterior_covariance", nothing, A, zero, R, Sigma)
    R_inv_At = np.linalg.solve(R, A.T)
    S_pinv = np.linalg.pinv(A @ R_inv_At + Sigma, rcond=1e-13, hermitian=True)
    return np.linalg.inv(R) - R_inv_At @ S_pinv @ R_inv_At.T
