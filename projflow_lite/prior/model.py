r"""The prior a sampler asks: a velocity field on motions, in metres and world coordinates.

The flow runs from noise :math:`x_0 \sim \mathcal N(0, s^2 I)`, with :math:`s` metres the spread
of the data, to motions :math:`x_1`. Noise in metres, rather than normalised motion, keeps every
formula of the paper as it is written: rows, metric and residual are all in the same world.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torch
from torch import nn

from projflow_lite.prior.network import Network
from projflow_lite.prior.text import Vocabulary
from projflow_lite.skeleton import N_JOINTS

Text = str | Sequence[str | None] | None


class Prior(nn.Module):
    r"""A flow that predicts the clean endpoint :math:`\hat x_1 = E[x_1 \mid x_t]`.

    Calling it gives the velocity: ``prior(x_t, t, text)``.

    Args:
        vocabulary: the words it was trained with.
        mean: ``(22, 3)`` mean position of every joint in the data, metres.
        noise_std: standard deviation :math:`s` of the noise, metres.
        lengths: shortest and longest motion it was trained on, frames.
        network: sizes of the network, see `Network`.
        recipe: how it was trained, for the record.

    Attributes:
        network_type: what predicts.
        points: in a frame of what the flow is on, and their coordinates.
    """

    network_type = Network
    points: tuple[int, int] = (N_JOINTS, 3)

    def __init__(
        self,
        vocabulary: Vocabulary,
        mean: torch.Tensor,
        noise_std: float,
        lengths: tuple[int, int],
        network: dict[str, Any] | None = None,
        recipe: dict[str, Any] | None = None,
    ) -> None:
        super().__init__()
        self.vocabulary = vocabulary
        self.sizes = network or {}
        self.network = self.network_type(len(vocabulary), mean=mean / noise_std, **self.sizes)
        self.mean: torch.Tensor
        self.register_buffer("mean", mean.float())
        self.noise_std = float(noise_std)
        self.lengths = lengths
        self.recipe = recipe or {}

    def endpoint(
        self, x_t: torch.Tensor, t: float | torch.Tensor, text: Text = None
    ) -> torch.Tensor:
        r"""Predict the clean motion :math:`\hat x_1` from a noisy one.

        Args:
            x_t: ``(batch, frames, 22, 3)`` metres.
            t: flow time, one number or ``(batch,)``; 0 is noise, 1 is data.
            text: a prompt, one for each motion, or None.

        Raises:
            ValueError: for a shape or a length that the prior does not know.
        """
        return self.asked(x_t, t, text)

    def asked(
        self, x_t: torch.Tensor, t: float | torch.Tensor, text: Text, *more: torch.Tensor
    ) -> torch.Tensor:
        """What the network says of a state in metres, in metres; `more` is for the network."""
        self.check(x_t)
        t = torch.as_tensor(t, dtype=x_t.dtype, device=x_t.device).expand(len(x_t))
        ids = self.vocabulary.encode(as_prompts(text, len(x_t))).to(x_t.device)
        # Noise has mean 0 and data has mean `mean`, so x_t has mean t * mean: take it out.
        centred = (x_t - t.view(-1, 1, 1, 1) * self.mean) / self.noise_std
        out = self.network(centred.to(self.mean.dtype), t.to(self.mean.dtype), ids, *more)
        return (self.mean + self.noise_std * out).to(x_t.dtype)

    def forward(
        self, x_t: torch.Tensor, t: float | torch.Tensor, text: Text = None
    ) -> torch.Tensor:
        r"""Velocity :math:`v = (\hat x_1 - x_t) / (1 - t)`, same shape as ``x_t``, for t < 1."""
        remaining = 1 - torch.as_tensor(t, dtype=x_t.dtype, device=x_t.device).view(-1, 1, 1, 1)
        return (self.endpoint(x_t, t, text) - x_t) / remaining

    velocity = forward

    def check(self, x_t: torch.Tensor) -> None:
        """Refuse a shape or a length that the prior was not made for."""
        if x_t.ndim != 4 or x_t.shape[-2:] != self.points:
            points = "{}, {}".format(*self.points)
            raise ValueError(
                f"prior: expected shape (batch, frames, {points}), got {tuple(x_t.shape)}"
            )
        self.check_frames(x_t.shape[1])

    def check_frames(self, frames: int) -> None:
        """Refuse a length outside those of the training data."""
        shortest, longest = self.lengths
        if not shortest <= frames <= longest:
            raise ValueError(
                f"prior: {frames} frames; it was trained on motions of {shortest} to {longest}"
            )


def as_prompts(text: Text, batch: int) -> list[str | None]:
    """One prompt for each motion of a batch.

    Raises:
        ValueError: if several prompts were given and their number is not the batch size.
    """
    if text is None or isinstance(text, str):
        return [text] * batch
    if not isinstance(text, Sequence) or not all(p is None or isinstance(p, str) for p in text):
        raise ValueError(f"prompt: a prompt is a text, or a list of them, not {text!r}")
    prompts = list(text)
    if len(prompts) != batch:
        raise ValueError(f"prompt: {len(prompts)} prompts for {batch} motions")
    return prompts
