"""Plain sampling without a wish: follow the flow from noise to motion."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import torch

from projflow_lite.prior.model import Text
from projflow_lite.samplers.projflow import Velocity


def euler(
    velocity: Velocity, x0: torch.Tensor, times: Sequence[float], text: Text = None
) -> torch.Tensor:
    """Integrate the flow's ordinary differential equation with Euler steps (ProjFlow eq. 1).

    Args:
        velocity: the flow, ``velocity(x_t, t, text)`` on ``(batch, frames, 22, 3)``.
        x0: noise to begin with, metres.
        times: flow times from 0 to 1, rising.
        text: prompts.
    """
    x_t = x0
    for t, t_next in itertools.pairwise(times):
        x_t = x_t + (t_next - t) * velocity(x_t, t, text)
    return x_t
