r"""DNO: leave the sampler alone, and search for the noise that it turns into what is wished.

.. math:: z^* = \arg\min_z \; \bigl\langle \lvert A\, x_1(z) - y \rvert \bigr\rangle + w\, C(z),
          \qquad x_1(z) = \text{all steps of Euler from } z

Whatever comes out is a sample of the prior, so bodies stay whole; but a pass through every step and
back for each look, hundreds of looks, and noise that is no longer quite noise. C keeps neighbouring
frames of z from growing alike, which is how an optimiser would cheat first.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import torch
from torch.utils.checkpoint import checkpoint
from tqdm.auto import trange

from projflow_lite.prior.model import Text
from projflow_lite.samplers.euler import euler
from projflow_lite.samplers.misfit import Misfit
from projflow_lite.samplers.options import check_callback, check_count, check_number
from projflow_lite.samplers.projflow import Step, Velocity


def dno(
    velocity: Velocity,
    misfit: Misfit,
    x0: torch.Tensor,
    times: Sequence[float],
    generator: torch.Generator | None = None,
    text: Text = None,
    iterations: int = 100,
    rate: float = 0.05,
    solver_steps: int = 10,
    decorrelate: float = 1000.0,
    save_memory: bool = False,
    progress: bool = False,
    noise_std: float | torch.Tensor = 1.0,
    callback: Callable[[Step], None] | None = None,
) -> torch.Tensor:
    """Sample motions near a linear wish, by optimising the noise that they come from.

    Args:
        velocity: the flow, ``velocity(x_t, t, text)`` on ``(batch, frames, 22, 3)``.
        misfit: from the wish.
        x0: noise to begin the search with, ``(batch, frames, 22, 3)``, metres.
        times: flow times from 0 to 1, rising.
        generator: not used: no noise is drawn.
        text: prompts.
        iterations: of the optimiser; released code takes 500 to 800.
        rate: Adam's, on noise of variance 1 and slopes of length 1: it warms up over the first
            tenth of the iterations and then falls to 0 along a cosine.
        solver_steps: how many of the times are used at most, spread evenly among them; in the
            search and in the end, so that what was searched for is what is returned.
        decorrelate: weight w of C, see `correlation`.
        save_memory: compute every step twice instead of keeping what its slope needs.
        progress: whether to show a bar.
        noise_std: standard deviation of the flow's noise, metres.
        callback: called with one `Step` an iteration, from 0 to 1: the noise and where it led.

    Raises:
        ValueError: for numbers that make no sense.

    Source: DNO (Karunratanakul et al., 2024), with its settings.
    """
    check_count("dno", "iterations", iterations)
    check_count("dno", "solver_steps", solver_steps)
    check_number("dno", "rate", rate)
    check_number("dno", "decorrelate", decorrelate)
    check_callback("dno", callback)
    few = thinned(times, solver_steps)
    field = saving_memory(velocity) if save_memory else velocity
    z = (x0 / noise_std).detach().clone().requires_grad_()
    adam = torch.optim.Adam([z], lr=rate)
    for k in trange(iterations, disable=not progress, desc="dno", leave=False):
        with torch.enable_grad():
            x1 = euler(field, noise_std * z, few, text)
            goal = (misfit.weight * misfit(x1).abs()).mean(1)
            loss = goal + decorrelate * correlation(z)
            (slope,) = torch.autograd.grad(loss.sum(), z)
        if callback:
            x1 = x1.detach()
            state = noise_std * z.detach().clone()
            callback(Step(0.0, 1.0, state, x1, x1, residual=misfit.residual(x1)))
        z.grad = slope / slope.flatten(1).norm(dim=1).clamp(min=1e-12).view(-1, 1, 1, 1)
        adam.param_groups[0]["lr"] = rate * share_of_rate(k, iterations)
        adam.step()
    return euler(velocity, noise_std * z.detach(), few, text)


def thinned(times: Sequence[float], steps: int) -> list[float]:
    """At most `steps` steps of the given times, the first and the last among them."""
    kept = np.linspace(0, len(times) - 1, min(steps, len(times) - 1) + 1).round().astype(int)
    return [times[k] for k in kept]


def share_of_rate(k: int, iterations: int) -> float:
    """Share of the rate in iteration `k`: up in a tenth of them, then down to 0 along a cosine."""
    warm = max(1, iterations // 10)
    return min(1.0, (k + 1) / warm) * (1 + math.cos(math.pi * k / iterations)) / 2


def correlation(z: torch.Tensor) -> torch.Tensor:
    r"""How alike neighbouring frames of the noise are, at every scale of time, ``(batch,)``.

    .. math:: C(z) = \sum_{\text{scales}} \Bigl\langle z^{(n)} z^{(n - 1)} \Bigr\rangle^2

    where each scale is the mean of two frames of the one before.

    Args:
        z: ``(batch, frames, 22, 3)``, of variance 1.
    """
    total = z.new_zeros(len(z))
    while z.shape[1] > 2:
        total = total + (z * z.roll(1, dims=1)).flatten(1).mean(1).square()
        pairs = z.shape[1] // 2
        z = z[:, : 2 * pairs].unflatten(1, (pairs, 2)).mean(2)
    return total


def saving_memory(velocity: Velocity) -> Velocity:
    """The same field, evaluated again when its slope is asked for."""

    def field(x_t: torch.Tensor, t: float, text: Text = None) -> torch.Tensor:
        return checkpoint(velocity, x_t, t, text, use_reentrant=False)

    return field
