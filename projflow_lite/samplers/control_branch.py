r"""Control by a trained branch: tell the network what is known, follow the flow, hope for the best.

.. math:: x_{t'} = x_t + (t' - t)\, v_\theta(x_t, t, \text{text}, y)

The loop is plain Euler's, see `told`: all that is known of control is in the network. It was
trained to come near the keyframes, and nothing checks that it does. Each step asks the branch too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import torch

from projflow_lite.prior.model import Text
from projflow_lite.samplers.gmd_imputation import Imputation
from projflow_lite.samplers.options import check_callback
from projflow_lite.samplers.projflow import Step
from projflow_lite.samplers.told import Told, follow


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
    return follow(velocity, known.observed, x0, times, text, callback)
