r"""CondMDI: a network that was trained to see keyframes, and if one likes, imputation on top.

The loop is that of `control_branch`, see `told`. Until a chosen time what is known also overwrites
the predicted motion, as in `imputation`, but here the network has been told and has made it fit:

.. math:: \tilde x_1 = (1 - M) \odot \hat x_1 + M \odot y
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import torch

from projflow_lite.prior.model import Text
from projflow_lite.samplers.gmd_imputation import Imputation
from projflow_lite.samplers.options import check_callback, check_number
from projflow_lite.samplers.projflow import Step
from projflow_lite.samplers.told import Told, follow


def condmdi(
    velocity: Told,
    known: Imputation,
    x0: torch.Tensor,
    times: Sequence[float],
    generator: torch.Generator | None = None,
    text: Text = None,
    until: float = 0.0,
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
        until: flow time from which nothing is overwritten any more: at 0 nothing ever is; at 1 pins
            are exact at the end.
        noise_std: not needed.
        callback: called with every `Step`; "projected" is overwritten.

    Raises:
        ValueError: if `until` is no flow time.

    Source: CondMDI (Cohan et al., 2024), as a flow.
    """
    check_number("condmdi", "until", until, 1)
    check_callback("condmdi", callback)

    def overwritten(t: float, x1_hat: torch.Tensor) -> torch.Tensor:
        return known(x1_hat) if t < until else x1_hat

    x1 = follow(velocity, known.observed, x0, times, text, callback, overwritten)
    # The last step ends at the overwritten motion but for rounding.
    return known(x1) if until == 1 else x1
