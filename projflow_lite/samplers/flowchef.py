r"""FlowChef: steer the state by the slope at the endpoint, as if the network were not there.

.. math:: \hat x_1 = x_t + (1 - t)\, v, \qquad
          x_{t'} = x_t + (t' - t)\, v - s\, \nabla F(\hat x_1)

The exact slope with respect to the state would go back through the network. On a straight path the
velocity does not depend on the state, and both slopes are the same; this method takes them for the
same everywhere. It costs nothing, and moves only what the wish looks at.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import torch

from projflow_lite.prior.model import Text
from projflow_lite.samplers.misfit import Misfit
from projflow_lite.samplers.options import check_callback, check_number
from projflow_lite.samplers.projflow import Step, Velocity


def flowchef(
    velocity: Velocity,
    misfit: Misfit,
    x0: torch.Tensor,
    times: Sequence[float],
    generator: torch.Generator | None = None,
    text: Text = None,
    step: float = 0.5,
    noise_std: float | torch.Tensor = 1.0,
    callback: Callable[[Step], None] | None = None,
) -> torch.Tensor:
    """Sample motions that are steered towards a linear wish.

    Args:
        velocity: the flow, ``velocity(x_t, t, text)`` on ``(batch, frames, 22, 3)``.
        misfit: from the wish.
        x0: noise to begin with, ``(batch, frames, 22, 3)``, metres.
        times: flow times from 0 to 1, rising.
        generator: not used: no noise is drawn.
        text: prompts.
        step: s, length of a gradient step, 0 to 2. At 1 pins are exact at the end, because the
            last step has nothing after it that could miss again.
        noise_std: not used.
        callback: called with every `Step`; the projected motion is where the steered state points
            to.

    Raises:
        ValueError: for a step that makes no sense.

    Source: FlowChef (Patel, Wen, Metaxas, Yang, 2025).
    """
    check_number("flowchef", "step", step, 2)
    check_callback("flowchef", callback)
    x_t = x0
    for t, t_next in itertools.pairwise(times):
        v = velocity(x_t, t, text)
        x1_hat = x_t + (1 - t) * v
        x1 = misfit.descend(x1_hat, step)
        if callback:
            callback(Step(t, t_next, x_t, x1_hat, x1, residual=misfit.residual(x1)))
        x_t = x_t + (t_next - t) * v + (x1 - x1_hat)
    return x_t
