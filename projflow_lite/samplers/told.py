r"""Following a flow that is told what is known: the loop of `control_branch` and `condmdi`.

.. math:: v = v_\theta(x_t, t, \text{text}, y), \qquad \hat x_1 = x_t + (1 - t)\, v, \qquad
          x_{t'} = x_t + (t' - t) \Bigl(v + \frac{\tilde x_1 - \hat x_1}{1 - t}\Bigr)

The flow goes towards :math:`\tilde x_1`. If that is :math:`\hat x_1`, the loop is Euler's.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import torch

from projflow_lite.prior.model import Text
from projflow_lite.samplers.projflow import Step

Told = Callable[[torch.Tensor, float, Text, torch.Tensor], torch.Tensor]
"""A velocity that is told what is known: ``velocity(x_t, t, text, observed)``."""


def unchanged(t: float, x1_hat: torch.Tensor) -> torch.Tensor:
    """The predicted motion as it is."""
    return x1_hat


def follow(
    velocity: Told,
    observed: torch.Tensor,
    x0: torch.Tensor,
    times: Sequence[float],
    text: Text = None,
    callback: Callable[[Step], None] | None = None,
    changed: Callable[[float, torch.Tensor], torch.Tensor] = unchanged,
) -> torch.Tensor:
    """Go from noise to motions, ``(batch, frames, 22, 3)``, metres.

    Args:
        velocity: the flow.
        observed: what is known, ``(frames, 22, 3)`` or one for each motion, NaN where nothing is.
        x0: noise to begin with, ``(batch, frames, 22, 3)``, metres.
        times: flow times from 0 to 1, rising.
        text: prompts.
        callback: called with every `Step`.
        changed: makes of a flow time and the motion predicted there the motion to go towards.
    """
    x_t = x0
    for t, t_next in itertools.pairwise(times):
        v = velocity(x_t, t, text, observed)
        x1_hat = x_t + (1 - t) * v
        x1 = changed(t, x1_hat)
        if callback:
            callback(Step(t, t_next, x_t, x1_hat, x1))
        x_t = x_t + (t_next - t) * (v + (x1 - x1_hat) / (1 - t))
    return x_t
