"""Classifier-free guidance for any velocity field: lean further towards the prompt."""

from __future__ import annotations

import math

import torch

from projflow_lite.prior.model import Text, as_prompts
from projflow_lite.samplers.projflow import Velocity
from projflow_lite.skeleton import shown


def guided(velocity: Velocity, scale: float) -> Velocity:
    r"""The field :math:`v(\varnothing) + \text{scale} \, (v(\text{text}) - v(\varnothing))`.

    Both velocities come from one call on a doubled batch. A scale of 1 is the plain conditional
    field and costs nothing extra.

    Args:
        velocity: any ``velocity(x_t, t, text)`` that takes a list of prompts, None among them.
            What else a sampler tells it, it is told as well.
        scale: 0 ignores the prompt, 1 follows it, more exaggerates it.

    Raises:
        ValueError: for a scale that is no finite number.
    """
    if not isinstance(scale, int | float) or not math.isfinite(scale):
        raise ValueError(f"guided: scale is a number, usually 0 to 5, not {shown(scale)}")
    if scale == 1.0:
        return velocity

    def field(
        x_t: torch.Tensor, t: float, text: Text = None, *observed: torch.Tensor
    ) -> torch.Tensor:
        prompts = as_prompts(text, len(x_t))
        if all(prompt is None for prompt in prompts):
            return velocity(x_t, t, None, *observed)
        both = velocity(torch.cat([x_t, x_t]), t, [*prompts, *[None] * len(x_t)], *observed)
        with_text, without = both.chunk(2)
        return without + scale * (with_text - without)

    return field


def checked(velocity: Velocity) -> Velocity:
    """The same field; a shape that torch would stretch to that of the state is an error."""

    def field(
        x_t: torch.Tensor, t: float, text: Text = None, *observed: torch.Tensor
    ) -> torch.Tensor:
        v = velocity(x_t, t, text, *observed)
        if not isinstance(v, torch.Tensor) or v.shape != x_t.shape:
            raise ValueError(
                f"sample: the prior returned {shown(v)} for a state of shape {tuple(x_t.shape)}"
            )
        return v

    return field
