r"""The same prior in diffusion's clothes: any flow on the straight Gaussian path is a diffusion.

A state of the flow is :math:`x_t = t\, x_1 + (1 - t)\, n` with noise
:math:`n \sim \mathcal N(0, s^2 I)`. Divided by :math:`\kappa_t = \sqrt{t^2 + (1 - t)^2}` it is

.. math:: \frac{x_t}{\kappa_t} = \sqrt{\bar\alpha}\, x_1 + \sqrt{1 - \bar\alpha}\, n, \qquad
          \bar\alpha = \frac{t^2}{t^2 + (1 - t)^2}

the state of a diffusion that keeps its variance (GMD section 4.1 (b)), at the same ratio of signal
to noise. So the network needs no retraining. Its endpoint (ProjFlow eq. 5) is the denoiser
:math:`f(x_t) = \mathbb E[x_1 \mid x_t]`. What is left is the way back, one step from t to t'.

Diffusion goes from clean to noisy by adding independent noise. In :math:`x_t / t = x_1 + b_t\, n`,
with :math:`b_t = (1 - t) / t`, that noise makes a small :math:`b_{t'} n'` grow into the larger
:math:`b_t\, n`. So n and n' are correlated, by :math:`r = b_{t'} / b_t`: the variance that they
share is the smaller one. Who knows :math:`x_1` and :math:`x_t` knows n, and therefore
:math:`n' \sim \mathcal N(r n, (1 - r^2) s^2 I)`:

.. math:: x_{t'} \sim \mathcal N\Bigl(t'\, x_1 + (1 - t')\, r\, \frac{x_t - t\, x_1}{1 - t},\;
          (1 - t')^2 (1 - r^2)\, s^2 I\Bigr), \qquad r = \frac{t (1 - t')}{t' (1 - t)}

This is the posterior of DDPM (`projflow_lite.equations.ddpm_posterior`), times :math:`\kappa_{t'}`.
It stays in the flow's units, so that motions remain metres. Ancestral sampling draws from it with
:math:`f(x_t)` in the place of :math:`x_1`: the flow without its differential equation.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import torch

from projflow_lite.prior.model import Text
from projflow_lite.samplers.projflow import Velocity

Number = float | torch.Tensor


def denoise(velocity: Velocity, x_t: torch.Tensor, t: float, text: Text = None) -> torch.Tensor:
    r"""Predict the clean motion, :math:`f(x_t) = x_t + (1 - t)\, v(x_t, t)`.

    Args:
        velocity: the flow, ``velocity(x_t, t, text)``.
        x_t: state of the flow, ``(batch, frames, joints, 3)``.
        t: flow time, from 0 to below 1.
        text: prompts.

    Source: ProjFlow eq. 5, for the denoiser of GMD section 4.2.
    """
    return x_t + (1 - t) * velocity(x_t, t, text)


def posterior(
    x1: torch.Tensor, x_t: torch.Tensor, t: float, t_next: float, noise_std: Number = 1.0
) -> tuple[torch.Tensor, torch.Tensor]:
    """Mean and variance of the next state, given where the path should end.

    Args:
        x1: the clean motion, predicted or imputed, any shape.
        x_t: state of the flow at `t`, same shape.
        t: flow time, from 0 to below 1.
        t_next: the next one, above `t` and at most 1.
        noise_std: standard deviation of the flow's noise, metres; a number, or something that
            broadcasts.

    Returns:
        The mean, same shape, and the variance, a tensor shaped like `noise_std`: 0 at the end,
        where the mean is `x1`.

    Raises:
        ValueError: if the times are not in this order.

    Source: the posterior of DDPM, which GMD section 4.1 calls eq. 1.
    """
    if not 0 <= t < t_next <= 1:
        raise ValueError(f"posterior: expected 0 <= t < t_next <= 1, not {t} and {t_next}")
    r = t * (1 - t_next) / (t_next * (1 - t))
    mean = t_next * x1 + (1 - t_next) * r * (x_t - t * x1) / (1 - t)
    spread = torch.as_tensor(noise_std, dtype=x_t.dtype, device=x_t.device)
    return mean, (1 - t_next) ** 2 * (1 - r**2) * spread**2


def draw(
    mean: torch.Tensor, variance: torch.Tensor, generator: torch.Generator | None
) -> torch.Tensor:
    """Draw a state around `mean`."""
    fresh = torch.randn(mean.shape, generator=generator, dtype=mean.dtype, device=mean.device)
    return mean + variance**0.5 * fresh


def ancestral(
    velocity: Velocity,
    x0: torch.Tensor,
    times: Sequence[float],
    generator: torch.Generator | None = None,
    text: Text = None,
    noise_std: Number = 1.0,
) -> torch.Tensor:
    r"""Sample by diffusion: predict the clean motion, draw the next state, and so on.

    With small steps its samples are distributed as those of `euler`. With few, both are too close
    together, this one more so: every step replaces :math:`x_1` by its mean.

    Args:
        velocity: the flow, ``velocity(x_t, t, text)``.
        x0: noise to begin with, ``(batch, frames, joints, 3)``. At t = 0 it says nothing about the
            motion, so all that is kept of it is what the first prediction made of it.
        times: flow times from 0 to 1, rising. A diffusion's own schedule of noise becomes one by
            `projflow_lite.equations.time_at`.
        generator: where fresh noise is drawn from.
        text: prompts.
        noise_std: standard deviation of the flow's noise, metres.

    Source: DDPM's sampler, on the path of ProjFlow eq. 2.
    """
    x_t = x0
    for t, t_next in itertools.pairwise(times):
        x1_hat = denoise(velocity, x_t, t, text)
        x_t = draw(*posterior(x1_hat, x_t, t, t_next, noise_std), generator)
    return x_t
