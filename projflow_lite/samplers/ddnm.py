r"""DDNM: keep what the wish does not see of a predicted motion, and replace the rest.

.. math:: \hat x_1^* = A^+ y + (I - A^+ A)\, \hat x_1

This is ProjFlow with R = I, :math:`\Sigma = 0`, no guides, the noise that the state implies, and
none of it fresh. A pinned wrist moves alone: no arm comes along with it in the same step.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import torch

from projflow_lite.prior.model import Text
from projflow_lite.samplers.options import check_callback
from projflow_lite.samplers.projflow import Step, Velocity, fresh_share, mix
from projflow_lite.samplers.step import ProjectionStep


def ddnm(
    velocity: Velocity,
    project: ProjectionStep,
    x0: torch.Tensor,
    times: Sequence[float],
    generator: torch.Generator | None = None,
    text: Text = None,
    eta: float | str = 0.0,
    noise_std: float | torch.Tensor = 1.0,
    callback: Callable[[Step], None] | None = None,
) -> torch.Tensor:
    """Sample motions that obey a linear wish exactly, by null-space projection.

    Args:
        velocity: the flow, ``velocity(x_t, t, text)`` on ``(batch, frames, 22, 3)``.
        project: onto exact rows, under the Euclidean metric and without guides.
        x0: noise to begin with, ``(batch, frames, 22, 3)``, metres.
        times: flow times from 0 to 1, rising.
        generator: where fresh noise is drawn from.
        text: prompts.
        eta: share of fresh noise, see `projflow`. 0 follows the flow between projections; "ddpm"
            is diffusion's ancestral sampling between them.
        noise_std: standard deviation of the flow's noise, metres.
        callback: called with every `Step`.

    Source: ProjFlow eq. 21, between the steps of a flow instead of a diffusion.
    """
    check_callback("ddnm", callback)
    x_t, spread = x0, torch.as_tensor(noise_std, dtype=x0.dtype)
    for t, t_next in itertools.pairwise(times):
        v = velocity(x_t, t, text)
        x1_hat, noise = torch.add(x_t, v, alpha=1 - t), torch.sub(x_t, v, alpha=t)
        x1 = project(x1_hat, t)
        share = fresh_share(eta, t, t_next)
        if t_next < 1:
            noise = mix(noise, share, spread, generator)
        if callback:
            callback(Step(t, t_next, x_t, x1_hat, x1, residual=project.residual(x1)))
        x_t = torch.lerp(noise, x1, t_next)
    return x_t
