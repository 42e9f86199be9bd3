r"""PnP-Flow: pull a motion towards the wish, noise it, let the flow denoise it, and again.

.. math:: z = x_1 - \gamma_t \nabla F(x_1), \qquad
          \hat x_1 = D_t\bigl(t\, z + (1 - t)\, \epsilon\bigr), \qquad
          D_t(x) = x + (1 - t)\, v(x, t)

The flow is used as a denoiser and never followed: every step starts from fresh noise, so nothing
but the mean of many futures is carried over. The denoiser has the last word, and with it the miss.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import torch

from projflow_lite.prior.model import Text
from projflow_lite.samplers.diffusion import denoise
from projflow_lite.samplers.misfit import Misfit
from projflow_lite.samplers.options import check_callback, check_count, check_number
from projflow_lite.samplers.projflow import Step, Velocity


def pnp_flow(
    velocity: Velocity,
    misfit: Misfit,
    x0: torch.Tensor,
    times: Sequence[float],
    generator: torch.Generator | None = None,
    text: Text = None,
    step: float = 1.0,
    alpha: float = 1.0,
    draws: int = 1,
    noise_std: float | torch.Tensor = 1.0,
    callback: Callable[[Step], None] | None = None,
) -> torch.Tensor:
    r"""Restore motions from a linear wish and a prompt.

    Args:
        velocity: the flow, ``velocity(x_t, t, text)`` on ``(batch, frames, 22, 3)``.
        misfit: from the wish.
        x0: noise of the first draw, ``(batch, frames, 22, 3)``, metres.
        times: flow times from 0 to 1, rising; the last is where the last step would lead.
        generator: where all other noise is drawn from.
        text: prompts.
        step: length of a gradient step at time 0, 0 to 2; 1 never overshoots.
        alpha: it shrinks as :math:`(1 - t)^\alpha`.
        draws: how many noises each step averages over; released code takes 5. More is calmer, and
            dearer.
        noise_std: standard deviation of the flow's noise, metres.
        callback: called with every `Step`: the last draw's state, the mean of what the denoiser
            made, and, as projected motion, what was noised.

    Raises:
        ValueError: for a step, an exponent or a number of draws that makes no sense.

    Source: PnP-Flow (Martin, Gagneux, Hagemann, Steidl, 2025).
    """
    check_number("pnp_flow", "step", step, 2)
    check_number("pnp_flow", "alpha", alpha)
    check_count("pnp_flow", "draws", draws)
    check_callback("pnp_flow", callback)
    x1, noise = torch.zeros_like(x0), x0
    for t, t_next in itertools.pairwise(times):
        pulled = misfit.descend(x1, step * (1 - t) ** alpha)
        ends = torch.zeros_like(x0)
        for _ in range(draws):
            x_t = t * pulled + (1 - t) * noise
            ends = ends + denoise(velocity, x_t, t, text)
            noise = noise_std * torch.randn(x0.shape, generator=generator, dtype=x0.dtype)
        x1 = ends / draws
        if callback:
            callback(Step(t, t_next, x_t, x1, pulled, residual=misfit.residual(pulled)))
    return x1
