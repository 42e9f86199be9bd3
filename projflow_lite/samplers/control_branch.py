r"""Control by a trained branch: tell the network what is known, follow the flow, hope for the best.

.. math:: x_{t'} = x_t + (t' - t)\, v_\theta(x_t, t, \text{text}, y)

The loop is plain Euler's: all that is known of control is in the network. It was trained to come
near the keyframes, and nothing checks that it does. Each step asks the branch too.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import torch

from projflow_lite.prior.model import Text
from projflow_lite.samplers.gmd_imputation import Imputation
from projflow_lite.samplers.options import check_callback
from projflow_lite.samplers.projflow import Step

Told = Callable[[torch.Tensor, float, Text, torch.Tensor], torch.Tensor]
"""A velocity that is told what is known: ``velocity(x_t, t, text, observed)``."""


def control_branch(
    velocity: Told,
    known: Imputation,
    x0: torch.Tensor,
    times: Sequence[float],
    generator: torch.Generator | None = None,
    text: Text = None,
    noise_std: float | torch.Tensor = 1.0,
    callback: Callable[[Step], None] | None = None,
) -> torch.Tensor:
    """Sample motions with a flow that was trained to see keyframes.

    Args:
        velocity: such a flow, ``velocity(x_t, t, text, observed)``, see
            `projflow_lite.prior.conditioned`.
        known: the pinned coordinates.
        x0: noise to begin with, ``(batch, frames, 22, 3)``, metres.
        times: flow times from 0 to 1, rising.
        generator: not needed, no noise is drawn.
        text: prompts.
        noise_std: not needed.
        callback: called with every `Step`; nothing is projected.

    Source: OmniControl (Xie et al., 2024) without its guidance; ProjFlow Table 1, the rows of
    CtrlNet.
    """
    check_callback("control_branch", callback)
    observed, x_t = known.observed, x0
    for t, t_next in itertools.pairwise(times):
        v = velocity(x_t, t, text, observed)
        if callback:
            x1_hat = x_t + (1 - t) * v
            callback(Step(t, t_next, x_t, x1_hat, x1_hat))
        x_t = x_t + (t_next - t) * v
    return x_t
