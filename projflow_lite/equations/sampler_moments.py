r"""The law of what projection sampling returns, exactly, where the data is Gaussian.

Every step of ProjFlow (eq. 5, 7, 9, 10) is then an affine map with Gaussian noise added, so mean
and covariance follow from a recursion and nothing has to be sampled. Noise is standard normal.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import fraction, linear_model, positive_definite, real_array
from .flow import noise_mixing
from .known_answers import _gaussian, _mixture, _normalise, gaussian_endpoint, log_density

NOISE_READINGS = ("original", "implied", "guided")
"""What eq. 9 may mix: see `sampler_step`."""


def endpoint_precision(t: float, covariance: ArrayLike) -> NDArray:
    r"""Precision of the clean endpoint at time t: the metric that makes eq. 7 conditioning.

    .. math:: R_t = \mathrm{Cov}(x_1 \mid x_t)^{-1} = C^{-1} + \frac{t^2}{(1 - t)^2} I

    It begins as the precision of the data and ends as a large multiple of the identity.

    Args:
        t: flow time, at least 0 and below 1, where it is infinite.
        covariance: ``(d, d)``, C, positive definite.

    Raises:
        ValueError: if C is not positive definite or `t` is not in [0, 1).

    Source: conditioning of jointly Gaussian variables on ProjFlow eq. 2.
    """
    _before_the_end("endpoint_precision", t)
    C = real_array("endpoint_precision", "covariance", covariance, (None, None))
    C = positive_definite("endpoint_precision", "covariance", C)
    P = np.linalg.inv(C)
    P = (P + P.T) / 2  # an inverse is symmetric up to rounding only, and much of it for a bad C
    return P + t**2 / (1 - t) ** 2 * np.eye(len(C))


def mixture_endpoint(
    x_t: ArrayLike, t: float, weights: ArrayLike, means: ArrayLike, covariances: ArrayLike
) -> tuple[NDArray, NDArray]:
    r"""Mean and covariance of the clean endpoint where the data is a mixture of Gaussians.

    .. math:: \mathbb E[x_1 \mid x_t] = \sum_k p_k\, e_k, \qquad \mathrm{Cov}(x_1 \mid x_t)
              = \sum_k p_k \bigl((1 - t)^2 C_k S_k^{-1} + e_k e_k^\top\bigr) - \mathbb E\,
              \mathbb E^\top

    with :math:`p_k = p(k \mid x_t)`, and :math:`e_k` and :math:`S_k` as in `gaussian_endpoint`.

    Args:
        x_t: ``(..., d)``.
        t: flow time in [0, 1].
        weights: ``(K,)``, positive, summing to 1.
        means: ``(K, d)``.
        covariances: ``(K, d, d)``, positive definite.

    Returns:
        ``(..., d)`` and ``(..., d, d)``.

    Raises:
        ValueError: if shapes do not fit, a weight is not positive or a C is not positive definite.

    Source: the law of total covariance, on ProjFlow eq. 2.
    """
    w, m, C = _mixture("mixture_endpoint", weights, means, covariances)
    S = (1 - t) ** 2 * np.eye(m.shape[1]) + t**2 * C
    parts = zip(w, m, S, strict=True)
    logs = [np.log(w_k) + log_density(x_t, t * m_k, S_k) for w_k, m_k, S_k in parts]
    p = _normalise(np.stack(logs))[..., None]
    e = np.stack([gaussian_endpoint(x_t, t, m_k, C_k) for m_k, C_k in zip(m, C, strict=True)])
    mean = (p * e).sum(axis=0)
    within = np.einsum("k...i,kij->...ij", p, (1 - t) ** 2 * np.linalg.solve(S, C))
    off = e - mean  # about the mean, and not as printed above: nothing large cancels
    return mean, within + np.einsum("k...i,k...j->...ij", p * off, off)


def projection_map(
    A: ArrayLike, y: ArrayLike, R: ArrayLike, Sigma: ArrayLike
) -> tuple[NDArray, NDArray]:
    r"""The projection as an affine map of the prediction.

    .. math:: \hat{x}_1^* = M \hat{x}_1 + c, \qquad M = I - G A, \quad c = G y, \qquad
              G = R^{-1} A^\top (A R^{-1} A^\top + \Sigma)^{-1}

    Args:
        A: ``(m, d)``, of full row rank where Sigma is 0; m = 0 is no wish.
        y: ``(m,)``.
        R: ``(d, d)``, positive definite.
        Sigma: ``(m, m)``, positive semidefinite.

    Returns:
        ``(d, d)`` and ``(d,)``.

    Raises:
        ValueError: if shapes do not fit, a matrix is not (semi)definite or exact rows depend on
            each other.

    Source: ProjFlow eq. 7.
    """
    zero = np.zeros(np.shape(A)[-1])
    _, A, y, R, Sigma = linear_model("projection_map", zero, A, y, R, Sigma)
    R_inv_At = np.linalg.solve(R, A.T)
    S = positive_definite("projection_map", "A R^-1 A^T + Sigma", A @ R_inv_At + Sigma)
    G = np.linalg.solve(S, R_inv_At.T).T
    return np.eye(len(zero)) - G @ A, G @ y


def sampler_step(
    t: float,
    t_next: float,
    mean: ArrayLike,
    covariance: ArrayLike,
    projection: tuple[NDArray, NDArray],
    noise: str,
    share: float,
) -> tuple[NDArray, NDArray]:
    r"""One step of the sampler on Gaussian data, fresh noise aside, as an affine map.

    .. math:: \begin{bmatrix} x_{t + \Delta t} \\ x_0 \end{bmatrix}
              = F \begin{bmatrix} x_t \\ x_0 \end{bmatrix} + f
              + (1 - t - \Delta t) \sqrt{\eta} \begin{bmatrix} \epsilon \\ 0 \end{bmatrix}

    Args:
        t: flow time, at least 0 and below 1.
        t_next: the next one, at most 1.
        mean: ``(d,)``, of the data.
        covariance: ``(d, d)``, of the data, positive definite.
        projection: M ``(d, d)`` and c ``(d,)``, see `projection_map`.
        noise: what eq. 9 mixes. ``"original"`` is :math:`x_0`, as printed; ``"implied"`` is
            :math:`x_t - t v`, as released; ``"guided"`` is the same for the velocity
            :math:`(\hat{x}_1^* - x_t) / (1 - t)` that leads to the projected endpoint.
        share: eta, in [0, 1].

    Returns:
        F ``(2 d, 2 d)`` and f ``(2 d,)``.

    Raises:
        ValueError: if shapes do not fit, a time or share is out of range, or for another `noise`.

    Source: ProjFlow eq. 5, 7, 9 and 10.
    """
    _noise_reading("sampler_step", noise)
    E, e = _endpoint_map(t, mean, covariance)  # x1_hat = E x_t + e, eq. 5
    M, c = projection
    P, p = M @ E, M @ e + c  # x1 = P x_t + p, eq. 7
    I, zero = np.eye(len(e)), np.zeros((len(e), len(e)))
    N, n, H = {
        "original": (zero, 0 * e, I),
        "implied": ((I - t * E) / (1 - t), -t * e / (1 - t), zero),
        "guided": ((I - t * P) / (1 - t), -t * p / (1 - t), zero),
    }[noise]
    sigma = 1 - fraction("sampler_step", "t_next", t_next)
    keep = sigma * np.sqrt(1 - fraction("sampler_step", "share", share))  # eq. 9
    F = np.block([[t_next * P + keep * N, keep * H], [zero, I]])  # eq. 10
    return F, np.concatenate([t_next * p + keep * n, 0 * e])


def sampler_moments(
    mean: ArrayLike,
    covariance: ArrayLike,
    times: ArrayLike,
    projection: Callable[[float], tuple[NDArray, NDArray]],
    noise: str = "implied",
    eta: Callable[[float], float] | float | None = None,
) -> tuple[NDArray, NDArray]:
    r"""Mean and covariance of what the sampler returns on Gaussian data, without sampling.

    .. math:: \mu_{t + \Delta t} = F \mu_t + f, \qquad P_{t + \Delta t} = F P_t F^\top
              + (1 - t - \Delta t)^2\, \eta \begin{bmatrix} I & 0 \\ 0 & 0 \end{bmatrix}

    for the pair of state and first noise; both begin as the same :math:`x_0`.

    Args:
        mean: ``(d,)``, of the data.
        covariance: ``(d, d)``, of the data, positive definite.
        times: ``(T + 1,)``, rising from 0 to 1.
        projection: for every time the pair of `projection_map`.
        noise: see `sampler_step`.
        eta: share of fresh noise: a number, or a function of the next time; by default
            `noise_mixing`.

    Returns:
        ``(d,)`` and ``(d, d)``.

    Raises:
        ValueError: as `sampler_step`.

    Source: ProjFlow eq. 5, 7, 9 and 10.
    """
    d = len(np.asarray(mean))
    mu, P = np.zeros(2 * d), np.tile(np.eye(d), (2, 2))
    for t, t_next in pairwise(real_array("sampler_moments", "times", times, (None,)).tolist()):
        rule = eta(t_next) if callable(eta) else eta
        share = float(noise_mixing(t_next)) if rule is None else rule
        F, f = sampler_step(t, t_next, mean, covariance, projection(t), noise, share)
        mu, P = F @ mu + f, F @ P @ F.T
        P[:d, :d] += (1 - t_next) ** 2 * share * np.eye(d)
    return mu[:d], P[:d, :d]


def _endpoint_map(t: float, mean: ArrayLike, covariance: ArrayLike) -> tuple[NDArray, NDArray]:
    """`gaussian_endpoint` as a matrix and an offset."""
    _before_the_end("sampler_step", t)
    m, C = _gaussian("sampler_step", mean, covariance)
    E = t * np.linalg.solve((1 - t) ** 2 * np.eye(len(m)) + t**2 * C, C)
    return E, m - t * E @ m


def _noise_reading(who: str, noise: str) -> None:
    """Refuse a reading of eq. 9 that does not exist."""
    if noise not in NOISE_READINGS:
        raise ValueError(f"{who}: noise is {noise!r}, expected one of {', '.join(NOISE_READINGS)}")


def _before_the_end(who: str, t: float) -> None:
    """Refuse a time outside [0, 1)."""
    if not 0 <= t < 1:
        raise ValueError(f"{who}: t = {t} is not in 0 <= t < 1")
