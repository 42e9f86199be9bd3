"""Imputation: in every step overwrite the known coordinates of the predicted motion.

Diffusion's ancestral sampling with GMD's imputation (section 4.1 (c)), and neither its emphasis nor
its guidance; motion diffusion models edit motions in this way. `gmd` has the rest, and a table of
what imputation alone does: it is ignored, or it tears a frame off.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import torch

from projflow_lite.prior.model import Text
from projflow_lite.samplers.gmd import gmd
from projflow_lite.samplers.gmd_imputation import Imputation
from projflow_lite.samplers.options import check_callback
from projflow_lite.samplers.projflow import Step, Velocity


def imputation(
    velocity: Velocity,
    known: Imputation,
    x0: torch.Tensor,
    times: Sequence[float],
    generator: torch.Generator | None = None,
    text: Text = None,
    until: float = 1.0,
    noise_std: float | torch.Tensor = 1.0,
    callback: Callable[[Step], None] | None = None,
) -> torch.Tensor:
    """Sample motions whose pinned coordinates are overwritten in every prediction.

    Args:
        velocity: the flow, ``velocity(x_t, t, text)`` on ``(batch, frames, 22, 3)``.
        known: the pinned coordinates.
        x0: noise to begin with, ``(batch, frames, 22, 3)``, metres.
        times: flow times from 0 to 1, rising.
        generator: where fresh noise is drawn from.
        text: prompts.
        until: flow time from which nothing is overwritten any more; at 1 pins are exact at the end.
        noise_std: standard deviation of the flow's noise, metres.
        callback: called with every `Step`.

    Raises:
        ValueError: if `until` is no flow time.

    Source: GMD section 4.1 (c).
    """
    check_callback("imputation", callback)
    return gmd(
        velocity, known, x0, times, generator, text,
        pull=0.0, until=until, noise_std=noise_std, callback=callback,
    )  # fmt: skip
