r"""Guidance: diffusion's steps, each pushed downhill on the misfit of the predicted motion.

.. math:: x_{t'} = \text{ancestral step} - \lambda\, g, \qquad
          g = \nabla_{x_t} F\bigl(\hat x_1(x_t)\bigr), \qquad
          F(x) = \tfrac12 \lVert A x - y \rVert^2

Through the network (DPS) the whole body moves so that the prediction moves; it costs a pass back
through the network. At the endpoint (as OmniControl does at test time) the slope is that with
respect to the prediction, costs nothing, and moves only what the wish looks at.

How long should the push be? Early the prediction hardly follows the state and a long push is
needed; late it follows closely and the same push would diverge. So it is
:math:`\lambda = \min(s / \beta,\; 2 F / \lVert g \rVert^2)`: never further than to where the misfit
would be gone if there were but one row and the prediction followed in a straight line.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import torch

from projflow_lite.prior.model import Text
from projflow_lite.samplers.diffusion import denoise, draw, posterior
from projflow_lite.samplers.misfit import Misfit
from projflow_lite.samplers.options import check_callback, check_choice, check_number
from projflow_lite.samplers.projflow import Step, Velocity


def dps(
    velocity: Velocity,
    misfit: Misfit,
    x0: torch.Tensor,
    times: Sequence[float],
    generator: torch.Generator | None = None,
    text: Text = None,
    scale: float = 30.0,
    through: str = "network",
    noise_std: float | torch.Tensor = 1.0,
    callback: Callable[[Step], None] | None = None,
) -> torch.Tensor:
    """Sample motions that are pushed towards a linear wish.

    Args:
        velocity: the flow, ``velocity(x_t, t, text)`` on ``(batch, frames, 22, 3)``.
        misfit: from the wish.
        x0: noise to begin with, ``(batch, frames, 22, 3)``, metres.
        times: flow times from 0 to 1, rising.
        generator: where fresh noise is drawn from.
        text: prompts.
        scale: s, the longest push, see above.
        through: "network" or "endpoint", see above.
        noise_std: standard deviation of the flow's noise, metres.
        callback: called with every `Step`; the prediction is moved by nothing, so it is there
            twice.

    Raises:
        ValueError: for another `through`, or a scale that makes no sense.

    Source: DPS (Chung et al., 2023); the endpoint as in OmniControl (Xie et al., 2024). Both have
    rules of their own for the length.
    """
    check_number("dps", "scale", scale)
    check_choice("dps", "through", through, ("network", "endpoint"))
    check_callback("dps", callback)
    x_t = x0
    for t, t_next in itertools.pairwise(times):
        x1_hat, slope = predict(velocity, misfit, x_t, t, text, through)
        push = length(misfit, x1_hat, slope, scale) * slope
        mean, variance = posterior(x1_hat, x_t, t, t_next, noise_std)
        if callback:
            residual = misfit.residual(x1_hat)
            callback(Step(t, t_next, x_t, x1_hat, x1_hat, residual=residual))
        x_t = draw(mean - push, variance, generator)
    return x_t


def predict(
    velocity: Velocity, misfit: Misfit, x_t: torch.Tensor, t: float, text: Text, through: str
) -> tuple[torch.Tensor, torch.Tensor]:
    """The predicted motion, and the slope of its misfit; both of the shape of `x_t`."""
    if through == "endpoint":
        x1_hat = denoise(velocity, x_t, t, text)
        return x1_hat, misfit.gradient(x1_hat)
    with torch.enable_grad():
        state = x_t.detach().requires_grad_()
        x1_hat = denoise(velocity, state, t, text)
        (slope,) = torch.autograd.grad(misfit.loss(x1_hat).sum(), state)
    return x1_hat.detach(), slope


def length(misfit: Misfit, x1_hat: torch.Tensor, slope: torch.Tensor, scale: float) -> torch.Tensor:
    """What the slope of each motion is multiplied by, ``(batch, 1, 1, 1)``."""
    squared = slope.flatten(1).square().sum(1).clamp(min=1e-20)
    arrives = 2 * misfit.loss(x1_hat) / squared
    return arrives.clamp(max=scale / misfit.steepness).view(-1, 1, 1, 1)
