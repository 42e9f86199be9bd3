r"""A prior whose answers are closed forms: Gaussian and Gaussian-mixture data.

For such data the exact velocity of the flow and the exact posterior given a measurement are known.
A sampler can then be asked what no trained network allows to be asked: does it draw from
:math:`p(x \mid y)`? Noise is standard normal, :math:`x_0 \sim \mathcal N(0, I)`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import positive_definite, positive_semidefinite, real_array


def gaussian_endpoint(x_t: ArrayLike, t: float, mean: ArrayLike, covariance: ArrayLike) -> NDArray:
    r"""Expected clean endpoint where the data is Gaussian.

    .. math:: \mathbb E[x_1 \mid x_t] = m + t\, C S_t^{-1} (x_t - t m), \qquad
              S_t = (1 - t)^2 I + t^2 C

    Args:
        x_t: ``(..., d)``.
        t: flow time in [0, 1].
        mean: ``(d,)``, m.
        covariance: ``(d, d)``, C, positive definite.

    Raises:
        ValueError: if shapes do not fit, C is not positive definite or `t` leaves [0, 1].

    Source: conditioning of jointly Gaussian variables on eq. 2.
    """
    m, C = _gaussian("gaussian_endpoint", mean, covariance)
    t = _time("gaussian_endpoint", t)
    x_t = real_array("gaussian_endpoint", "x_t", x_t)
    S_t = (1 - t) ** 2 * np.eye(len(m)) + t**2 * C
    return m + t * (x_t - t * m) @ np.linalg.solve(S_t, C)


def gaussian_velocity(x_t: ArrayLike, t: float, mean: ArrayLike, covariance: ArrayLike) -> NDArray:
    r"""Exact velocity where the data is Gaussian; defined at both ends of the path.

    .. math:: v(x_t, t) = \mathbb E[x_1 - x_0 \mid x_t]
              = m + (t\, C - (1 - t) I)\, S_t^{-1} (x_t - t m)

    Args:
        x_t: ``(..., d)``.
        t: flow time in [0, 1].
        mean: ``(d,)``, m.
        covariance: ``(d, d)``, C, positive definite.

    Raises:
        ValueError: if shapes do not fit, C is not positive definite or `t` leaves [0, 1].

    Source: the minimiser of ProjFlow eq. 3.
    """
    m, C = _gaussian("gaussian_velocity", mean, covariance)
    t = _time("gaussian_velocity", t)
    x_t = real_array("gaussian_velocity", "x_t", x_t)
    S_t = (1 - t) ** 2 * np.eye(len(m)) + t**2 * C
    return m + (x_t - t * m) @ np.linalg.solve(S_t, t * C - (1 - t) * np.eye(len(m)))


def gaussian_posterior(
    mean: ArrayLike, covariance: ArrayLike, A: ArrayLike, y: ArrayLike, Sigma: ArrayLike
) -> tuple[NDArray, NDArray]:
    r"""Mean and covariance of Gaussian data given a linear measurement.

    .. math:: K = C A^\top (A C A^\top + \Sigma)^{-1}, \qquad
              \mathcal N\bigl(m + K (y - A m),\; C - K A C\bigr)

    With :math:`C = R^{-1}` the mean is the projection of m (eq. 7).

    Args:
        mean: ``(d,)``.
        covariance: ``(d, d)``, positive definite.
        A: ``(k, d)`` of full row rank where Sigma is 0.
        y: ``(k,)``.
        Sigma: ``(k, k)``, positive semidefinite; 0 is an exact measurement.

    Returns:
        ``(d,)`` and ``(d, d)``.

    Raises:
        ValueError: if shapes do not fit or a matrix is not (semi)definite.

    Source: ProjFlow eq. 26-29.
    """
    m, C = _gaussian("gaussian_posterior", mean, covariance)
    A, y, Sigma = _measurement("gaussian_posterior", A, y, Sigma, len(m))
    K = np.linalg.solve(A @ C @ A.T + Sigma, A @ C).T
    return m + K @ (y - A @ m), C - K @ A @ C


def log_density(x: ArrayLike, mean: ArrayLike, covariance: ArrayLike) -> NDArray:
    r"""Log density of a Gaussian.

    .. math:: -\tfrac12 (x - m)^\top C^{-1} (x - m) - \tfrac12 \log \det (2 \pi C)

    Args:
        x: ``(..., d)``.
        mean: ``(d,)``.
        covariance: ``(d, d)``, positive definite.

    Raises:
        ValueError: if shapes do not fit or C is not positive definite.

    Source: ProjFlow eq. 26.
    """
    m, C = _gaussian("log_density", mean, covariance)
    e = real_array("log_density", "x", x) - m
    squared = (e * np.linalg.solve(C, e[..., None])[..., 0]).sum(-1)
    return -0.5 * (squared + np.linalg.slogdet(2 * np.pi * C)[1])


def mixture_velocity(
    x_t: ArrayLike, t: float, weights: ArrayLike, means: ArrayLike, covariances: ArrayLike
) -> NDArray:
    r"""Exact velocity where the data is a mixture of Gaussians.

    .. math:: v(x_t, t) = \sum_k p(k \mid x_t)\, v_k(x_t, t), \qquad
              p(k \mid x_t) \propto w_k\, \mathcal N(x_t;\, t m_k,\, (1 - t)^2 I + t^2 C_k)

    Args:
        x_t: ``(..., d)``.
        t: flow time in [0, 1].
        weights: ``(K,)``, positive, summing to 1.
        means: ``(K, d)``.
        covariances: ``(K, d, d)``, positive definite.

    Raises:
        ValueError: if shapes do not fit, a weight is not positive or a C is not positive definite.

    Source: the minimiser of ProjFlow eq. 3.
    """
    w, m, C = _mixture("mixture_velocity", weights, means, covariances)
    eye = np.eye(m.shape[1])
    spread = [(1 - t) ** 2 * eye + t**2 * C_k for C_k in C]
    logs = [
        np.log(w_k) + log_density(x_t, t * m_k, S) for w_k, m_k, S in zip(w, m, spread, strict=True)
    ]
    share = _normalise(np.stack(logs))
    v = np.stack([gaussian_velocity(x_t, t, m_k, C_k) for m_k, C_k in zip(m, C, strict=True)])
    return (share[..., None] * v).sum(axis=0)


def mixture_posterior(
    weights: ArrayLike,
    means: ArrayLike,
    covariances: ArrayLike,
    A: ArrayLike,
    y: ArrayLike,
    Sigma: ArrayLike,
) -> tuple[NDArray, NDArray, NDArray]:
    r"""Posterior of a mixture given a linear measurement: again a mixture.

    .. math:: w_k' \propto w_k\, \mathcal N(y;\, A m_k,\, A C_k A^\top + \Sigma)

    and every component becomes its own posterior, see `gaussian_posterior`.

    Args:
        weights: ``(K,)``, positive, summing to 1.
        means: ``(K, d)``.
        covariances: ``(K, d, d)``, positive definite.
        A: ``(k, d)`` of full row rank where Sigma is 0.
        y: ``(k,)``.
        Sigma: ``(k, k)``, positive semidefinite.

    Returns:
        ``(K,)``, ``(K, d)`` and ``(K, d, d)``.

    Raises:
        ValueError: if shapes do not fit, a weight is not positive or a C is not positive definite.

    Source: Bayes' rule on ProjFlow eq. 28.
    """
    w, m, C = _mixture("mixture_posterior", weights, means, covariances)
    A, y, Sigma = _measurement("mixture_posterior", A, y, Sigma, m.shape[1])
    evidence = [
        np.log(w_k) + log_density(y, A @ m_k, A @ C_k @ A.T + Sigma)
        for w_k, m_k, C_k in zip(w, m, C, strict=True)
    ]
    parts = [gaussian_posterior(m_k, C_k, A, y, Sigma) for m_k, C_k in zip(m, C, strict=True)]
    new_means, new_covariances = (np.stack(part) for part in zip(*parts, strict=True))
    return _normalise(np.array(evidence)), new_means, new_covariances


def _normalise(logs: NDArray) -> NDArray:
    """Turn log weights along the first axis into weights that sum to 1."""
    share = np.exp(logs - logs.max(axis=0))
    return share / share.sum(axis=0)


def _time(who: str, t: float) -> float:
    """Refuse a time outside [0, 1]."""
    if not 0 <= t <= 1:
        raise ValueError(f"{who}: t = {t} is outside 0..1")
    return t


def _gaussian(who: str, mean: ArrayLike, covariance: ArrayLike) -> tuple[NDArray, NDArray]:
    """Check mean and covariance of a Gaussian."""
    m = real_array(who, "mean", mean, (None,))
    C = real_array(who, "covariance", covariance, (len(m), len(m)))
    return m, positive_definite(who, "covariance", C)


def _mixture(
    who: str, weights: ArrayLike, means: ArrayLike, covariances: ArrayLike
) -> tuple[NDArray, NDArray, NDArray]:
    """Check the parameters of a mixture; components are checked where they are used."""
    w = real_array(who, "weights", weights, (None,))
    m = real_array(who, "means", means, (len(w), None))
    C = real_array(who, "covariances", covariances, (len(w), m.shape[1], m.shape[1]))
    if (w <= 0).any() or abs(w.sum() - 1) > 1e-9:
        raise ValueError(f"{who}: weights must be positive and sum to 1, not {w}")
    return w, m, C


def _measurement(
    who: str, A: ArrayLike, y: ArrayLike, Sigma: ArrayLike, d: int
) -> tuple[NDArray, NDArray, NDArray]:
    """Check a linear measurement of a d-dimensional vector."""
    A = real_array(who, "A", A, (None, d))
    y = real_array(who, "y", y, (len(A),))
    return A, y, positive_semidefinite(who, "Sigma", real_array(who, "Sigma", Sigma, (len(A),) * 2))
