r"""FlowDPS: pull the clean estimate towards the wish, mix fresh noise into the noise estimate.

Tweedie's formula splits the state into what it says of the motion and of the noise,

.. math:: \hat x_1 = x_t + (1 - t)\, v, \qquad \hat x_0 = x_t - t\, v

Gradient steps on the misfit make :math:`\hat x_1(y)` of the one, and as time goes on less of it is
believed; fresh noise is mixed into the other; both are put together again:

.. math:: \tilde x_1 = t\, \hat x_1 + (1 - t)\, \hat x_1(y), \qquad
          \tilde x_0 = \sqrt{1 - t'}\, \hat x_0 + \sqrt{t'}\, \epsilon, \qquad
          x_{t'} = t'\, \tilde x_1 + (1 - t')\, \tilde x_0

ProjFlow kept the last two and replaced the first by a projection, because this one fades: the last
steps hardly pull, and what the network then drifts is not made up for.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import torch

from projflow_lite.prior.model import Text
from projflow_lite.samplers.misfit import Misfit
from projflow_lite.samplers.options import check_callback, check_count, check_number
from projflow_lite.samplers.projflow import Step, Velocity


def flowdps(
    velocity: Velocity,
    misfit: Misfit,
    x0: torch.Tensor,
    times: Sequence[float],
    generator: torch.Generator | None = None,
    text: Text = None,
    step: float = 1.0,
    iterations: int = 3,
    noise_std: float | torch.Tensor = 1.0,
    callback: Callable[[Step], None] | None = None,
) -> torch.Tensor:
    """Sample motions that are pulled towards a linear wish.

    Args:
        velocity: the flow, ``velocity(x_t, t, text)`` on ``(batch, frames, 22, 3)``.
        misfit: from the wish.
        x0: noise to begin with, ``(batch, frames, 22, 3)``, metres.
        times: flow times from 0 to 1, rising.
        generator: where fresh noise is drawn from.
        text: prompts.
        step: length of a gradient step, 0 to 2; 1 never overshoots, and arrives on pins.
        iterations: gradient steps on each clean estimate; released code takes 3.
        noise_std: standard deviation of the flow's noise, metres.
        callback: called with every `Step`.

    Raises:
        ValueError: for a step or a number of iterations that makes no sense.

    Source: FlowDPS (Kim, Kim, Ye, 2025); its renoising is ProjFlow eq. 9 and 10.
    """
    check_number("flowdps", "step", step, 2)
    check_count("flowdps", "iterations", iterations)
    check_callback("flowdps", callback)
    x_t = x0
    for t, t_next in itertools.pairwise(times):
        v = velocity(x_t, t, text)
        x1_hat, x0_hat = x_t + (1 - t) * v, x_t - t * v
        x1_y = x1_hat
        for _ in range(iterations):
            x1_y = misfit.descend(x1_y, step)
        x1 = t * x1_hat + (1 - t) * x1_y
        fresh = noise_std * torch.randn(x0.shape, generator=generator, dtype=x0.dtype)
        noise = (1 - t_next) ** 0.5 * x0_hat + t_next**0.5 * fresh
        if callback:
            callback(Step(t, t_next, x_t, x1_hat, x1, residual=misfit.residual(x1)))
        x_t = t_next * x1 + (1 - t_next) * noise
    return x_t
