r"""Replacement: follow the flow, and overwrite the known coordinates of its state as it goes.

.. math:: x_{t'} \leftarrow (1 - M) \odot x_{t'} + M \odot \bigl(t'\, y + (1 - t')\, n\bigr)

The oldest way to inpaint with a generative model: what is known enters noised, as a training state
would hold it, and the network has to make the rest fit. Nothing tells the rest where to go but the
network's own sense of what belongs together, which is why a few pinned frames are hardly heard.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import torch

from projflow_lite.prior.model import Text
from projflow_lite.samplers.gmd_imputation import Imputation
from projflow_lite.samplers.options import check_callback, check_choice
from projflow_lite.samplers.projflow import Step, Velocity


def replacement(
    velocity: Velocity,
    known: Imputation,
    x0: torch.Tensor,
    times: Sequence[float],
    generator: torch.Generator | None = None,
    text: Text = None,
    noise: str = "original",
    noise_std: float | torch.Tensor = 1.0,
    callback: Callable[[Step], None] | None = None,
) -> torch.Tensor:
    """Sample motions whose pinned coordinates are exact at the end.

    Args:
        velocity: the flow, ``velocity(x_t, t, text)`` on ``(batch, frames, 22, 3)``.
        known: the pinned coordinates.
        x0: noise to begin with, ``(batch, frames, 22, 3)``, metres.
        times: flow times from 0 to 1, rising.
        generator: where fresh noise is drawn from.
        text: prompts.
        noise: which n the known coordinates get: "original", that of the start, so that they run
            along one straight path of the flow; or "fresh" in every step, as diffusions do it.
        noise_std: standard deviation of the flow's noise, metres.
        callback: called with every `Step`; the prediction is moved by nothing, so it is there
            twice.

    Raises:
        ValueError: for another `noise`.

    Source: the replacement method of score-based models, on the path of ProjFlow eq. 2.
    """
    check_choice("replacement", "noise", noise, ("original", "fresh"))
    check_callback("replacement", callback)
    x_t, n = x0, x0
    for t, t_next in itertools.pairwise(times):
        v = velocity(x_t, t, text)
        if callback:
            x1_hat = x_t + (1 - t) * v
            callback(Step(t, t_next, x_t, x1_hat, x1_hat))
        if noise == "fresh":
            n = noise_std * torch.randn(x0.shape, generator=generator, dtype=x0.dtype)
        there = t_next * known.values + (1 - t_next) * n
        x_t = torch.where(known.mask, there, x_t + (t_next - t) * v)
    return x_t
