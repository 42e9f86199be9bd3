r"""One prior in two costumes: the straight path of a flow, and a diffusion that keeps its variance.

Both states are data plus Gaussian noise. They are the same up to a factor once signal and noise
stand in the same ratio. Flow time t runs from noise (0) to data (1); :math:`\bar\alpha` runs from
0 to 1 with it. GMD calls the clean motion :math:`x_0`, ProjFlow calls it :math:`x_1`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import fraction, real_array, same_shape
from .flow import tweedie_endpoint


def diffuse(x0: ArrayLike, eps: ArrayLike, alpha_bar: ArrayLike) -> NDArray:
    r"""Add noise to clean data without changing its variance.

    .. math:: x_t = \sqrt{\bar\alpha}\, x_0 + \sqrt{1 - \bar\alpha}\, \epsilon
              \sim \mathcal{N}(\sqrt{\bar\alpha}\, x_0, (1 - \bar\alpha) I)

    Args:
        x0: clean data, projected or not, any shape.
        eps: standard normal noise, same shape.
        alpha_bar: product of all steps' :math:`\alpha` so far, in [0, 1]; scalar or one per
            sample. Print writes :math:`\alpha_t`, which elsewhere names a single step's.

    Raises:
        ValueError: if shapes differ or `alpha_bar` leaves [0, 1].

    Source: GMD section 4.1 (b).
    """
    x0, eps = same_shape("diffuse", x0=x0, eps=eps)
    alpha_bar = fraction("diffuse", "alpha_bar", alpha_bar, x0)
    return np.sqrt(alpha_bar) * x0 + np.sqrt(1 - alpha_bar) * eps


def alpha_bar_at(t: ArrayLike) -> NDArray:
    r"""The diffusion's noise level that has the flow's ratio of signal to noise.

    .. math:: \bar\alpha(t) = \frac{t^2}{t^2 + (1 - t)^2}

    Args:
        t: flow time in [0, 1].

    Raises:
        ValueError: if `t` leaves [0, 1].

    Source: ProjFlow eq. 2 at the signal-to-noise ratio of GMD section 4.1 (b).
    """
    t = fraction("alpha_bar_at", "t", t)
    return t**2 / (t**2 + (1 - t) ** 2)


def time_at(alpha_bar: ArrayLike) -> NDArray:
    r"""The flow time that has a diffusion's ratio of signal to noise.

    .. math:: t = \frac{\sqrt{\bar\alpha}}{\sqrt{\bar\alpha} + \sqrt{1 - \bar\alpha}}

    Args:
        alpha_bar: in [0, 1].

    Raises:
        ValueError: if `alpha_bar` leaves [0, 1].

    Source: the inverse of `alpha_bar_at`.
    """
    alpha_bar = fraction("time_at", "alpha_bar", alpha_bar)
    signal, noise = np.sqrt(alpha_bar), np.sqrt(1 - alpha_bar)
    return signal / (signal + noise)


def diffusion_state(x_t: ArrayLike, t: ArrayLike) -> NDArray:
    r"""A state of the flow, scaled to be one of the diffusion.

    .. math:: \frac{x_t}{\sqrt{t^2 + (1 - t)^2}}
              = \sqrt{\bar\alpha}\, x_1 + \sqrt{1 - \bar\alpha}\, x_0

    Args:
        x_t: state of the flow, any shape.
        t: flow time in [0, 1], scalar or one per sample.

    Raises:
        ValueError: if `t` leaves [0, 1].

    Source: ProjFlow eq. 2, scaled to GMD section 4.1 (b).
    """
    x_t = real_array("diffusion_state", "x_t", x_t)
    t = fraction("diffusion_state", "t", t, x_t)
    return x_t / np.sqrt(t**2 + (1 - t) ** 2)


def flow_state(x: ArrayLike, alpha_bar: ArrayLike) -> NDArray:
    r"""A state of the diffusion, scaled to be one of the flow.

    .. math:: x_t = \frac{x}{\sqrt{\bar\alpha} + \sqrt{1 - \bar\alpha}}

    Args:
        x: state of the diffusion, any shape.
        alpha_bar: in [0, 1], scalar or one per sample.

    Raises:
        ValueError: if `alpha_bar` leaves [0, 1].

    Source: GMD section 4.1 (b), scaled to ProjFlow eq. 2; the inverse of `diffusion_state`.
    """
    x = real_array("flow_state", "x", x)
    alpha_bar = fraction("flow_state", "alpha_bar", alpha_bar, x)
    return x / (np.sqrt(alpha_bar) + np.sqrt(1 - alpha_bar))


def denoise(
    x: ArrayLike, alpha_bar: float, velocity: Callable[[NDArray, float], ArrayLike]
) -> NDArray:
    r"""Predict clean data from a state of the diffusion, with the velocity of a flow.

    .. math:: f(x) = x_t + (1 - t)\, v(x_t, t), \qquad t = t(\bar\alpha), \quad
              x_t = \frac{x}{\sqrt{\bar\alpha} + \sqrt{1 - \bar\alpha}}

    Args:
        x: state of the diffusion, any shape.
        alpha_bar: in [0, 1].
        velocity: function of a state of the flow and its time.

    Returns:
        :math:`\mathbb{E}[x_0 \mid x]`, same shape.

    Raises:
        ValueError: if the velocity has another shape or `alpha_bar` leaves [0, 1].

    Source: ProjFlow eq. 5, for the denoiser of GMD section 4.2.
    """
    t, x_t = float(time_at(alpha_bar)), flow_state(x, alpha_bar)
    return tweedie_endpoint(x_t, velocity(x_t, t), t)


def ddpm_posterior(
    x0: ArrayLike, x_t: ArrayLike, alpha_bar: float, alpha_bar_next: float
) -> tuple[NDArray, float]:
    r"""Mean and variance of the next state, given where the path should end.

    .. math:: \mu = \frac{\sqrt{\bar\alpha'}\, (1 - \alpha)}{1 - \bar\alpha}\, x_0
              + \frac{\sqrt{\alpha}\, (1 - \bar\alpha')}{1 - \bar\alpha}\, x_t, \qquad
              \Sigma_t = \frac{(1 - \alpha)(1 - \bar\alpha')}{1 - \bar\alpha}, \qquad
              \alpha = \frac{\bar\alpha}{\bar\alpha'}

    The mean is linear in x0. So imputing x0 and imputing the mean are the same thing, and the
    public code, which does the latter, does what the paper says.

    Args:
        x0: predicted (or imputed) clean data, any shape.
        x_t: state, same shape.
        alpha_bar: of the state, in [0, 1).
        alpha_bar_next: of the next, cleaner state, above `alpha_bar` and at most 1.

    Returns:
        The mean, same shape, and the variance, one number.

    Raises:
        ValueError: if shapes differ or the two levels are not in this order.

    Source: the posterior of DDPM, which GMD section 4.1 calls eq. 1.
    """
    x0, x_t = same_shape("ddpm_posterior", x0=x0, x_t=x_t)
    if not 0 <= alpha_bar < alpha_bar_next <= 1:
        raise ValueError(f"ddpm_posterior: expected 0 <= {alpha_bar} < {alpha_bar_next} <= 1")
    alpha = alpha_bar / alpha_bar_next
    beta, noise, noise_next = 1 - alpha, 1 - alpha_bar, 1 - alpha_bar_next
    mean = np.sqrt(alpha_bar_next) * beta / noise * x0 + np.sqrt(alpha) * noise_next / noise * x_t
    return mean, beta * noise_next / noise


def ddpm_noise_share(t: float, t_next: float) -> float:
    r"""Share of fresh noise with which ProjFlow's step is a step of DDPM.

    .. math:: \eta = 1 - \frac{t^2 / (1 - t)^2}{t'^2 / (1 - t')^2}

    ProjFlow eq. 9, with the noise that the state implies, and eq. 10 make the next state out of
    the predicted data, that noise and fresh noise. So does DDPM, and with this share both steps
    are one. It shrinks with the step, where Table 5's share, t', does not.

    Args:
        t: flow time of the state, in [0, 1).
        t_next: t', the next one, above `t` and at most 1.

    Raises:
        ValueError: if the two times are not in this order.

    Source: ProjFlow eq. 9 and 10, made equal to the DDPM posterior of GMD section 4.1.
    """
    if not 0 <= t < t_next <= 1:
        raise ValueError(f"ddpm_noise_share: expected 0 <= {t} < {t_next} <= 1")
    return 1 - (t * (1 - t_next) / (t_next * (1 - t))) ** 2
