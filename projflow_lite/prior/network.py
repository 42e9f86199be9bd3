r"""The tiny flow's network: from a noisy motion, a time and a prompt to the clean motion.

A U-Net over time. It sees the motion as 66 channels at 20 frames a second, halves the frame rate
twice on the way in and doubles it twice on the way out; every block is told the flow time and the
prompt. Its last layer does not speak in joint positions but in the pelvis and 21 bone vectors,
which a fixed linear map adds up along the skeleton: lengths of bones are then easy to learn.
"""

from __future__ import annotations

import math

import torch
from torch import nn
from torch.nn import functional

from projflow_lite.prior.text import TextEncoder
from projflow_lite.skeleton import N_JOINTS, PARENTS

CHANNELS = N_JOINTS * 3


def bones_to_positions() -> torch.Tensor:
    """``(22, 22)``: adds bone vectors up from the pelvis, row = joint, column = bone to add."""
    add_up = torch.eye(N_JOINTS)
    for child, parent in enumerate(PARENTS):
        if parent >= 0:
            add_up[child] += add_up[parent]
    return add_up


def time_features(t: torch.Tensor, width: int) -> torch.Tensor:
    """Sines and cosines of the flow time ``(batch,)``, at octaves, as ``(batch, width)``."""
    octaves = math.pi * 2.0 ** torch.linspace(-1, 7, width // 2, device=t.device)
    angle = t[:, None] * octaves
    return torch.cat([angle.sin(), angle.cos()], dim=1)


class Block(nn.Module):
    """Two convolutions over time with a residual connection, steered by the condition.

    The condition scales and shifts every channel (FiLM) between the two.
    """

    def __init__(self, inputs: int, outputs: int, condition: int, kernel: int = 5) -> None:
        super().__init__()
        self.first = nn.Conv1d(inputs, outputs, kernel, padding=kernel // 2)
        self.second = nn.Conv1d(outputs, outputs, kernel, padding=kernel // 2)
        self.norm_in = nn.GroupNorm(8, inputs)
        self.norm = nn.GroupNorm(8, outputs)
        self.steer = nn.Linear(condition, 2 * outputs)
        self.shortcut = nn.Conv1d(inputs, outputs, 1) if inputs != outputs else nn.Identity()
        nn.init.zeros_(self.second.weight)

    def forward(self, x: torch.Tensor, condition: torch.Tensor) -> torch.Tensor:
        """``(batch, inputs, frames)`` to ``(batch, outputs, frames)``."""
        scale, shift = self.steer(condition).unsqueeze(-1).chunk(2, dim=1)
        h = self.first(functional.silu(self.norm_in(x)))
        h = functional.silu(self.norm(h) * (1 + scale) + shift)
        return self.shortcut(x) + self.second(h)


class Attention(nn.Module):
    """Every frame looks at every other: what a wave of the arm at the start says of the end."""

    def __init__(self, width: int, heads: int = 4) -> None:
        super().__init__()
        self.norm = nn.GroupNorm(8, width)
        self.queries_keys_values = nn.Linear(width, 3 * width)
        self.out = nn.Linear(width, width)
        self.heads = heads
        nn.init.zeros_(self.out.weight)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        """``(batch, width, frames)``, same shape out."""
        batch, width, frames = x.shape
        three = self.queries_keys_values(self.norm(x).mT)
        q, k, v = three.view(batch, frames, 3, self.heads, -1).permute(2, 0, 3, 1, 4)
        mixed = (
            functional.scaled_dot_product_attention(q, k, v)
            .transpose(1, 2)
            .reshape(batch, frames, width)
        )
        return x + self.out(mixed).mT


class Network(nn.Module):
    r"""Predicts the clean endpoint :math:`\hat x_1` of the flow from :math:`(x_t, t, \text{text})`.

    Args:
        words: size of the vocabulary, padding included.
        widths: channels at full, half and quarter frame rate.
        condition: length of the vector that carries flow time and prompt.
    """

    def __init__(
        self, words: int, widths: tuple[int, int, int] = (96, 192, 256), condition: int = 256
    ) -> None:
        super().__init__()
        a, b, c = widths
        self.text = TextEncoder(words, condition)
        self.time = nn.Sequential(
            nn.Linear(64, condition), nn.SiLU(), nn.Linear(condition, condition)
        )
        self.enter = nn.Conv1d(CHANNELS + 2, a, 3, padding=1)
        self.full_in, self.to_half = Block(a, a, condition), nn.Conv1d(a, b, 4, 2, 1)
        self.half_in, self.to_quarter = Block(b, b, condition), nn.Conv1d(b, c, 4, 2, 1)
        self.quarter = nn.ModuleList([Block(c, c, condition), Block(c, c, condition)])
        self.attention = Attention(c)
        self.from_quarter, self.half_out = nn.Conv1d(c, b, 1), Block(2 * b, b, condition)
        self.from_half, self.full_out = nn.Conv1d(b, a, 1), Block(2 * a, a, condition)
        self.leave = nn.Sequential(
            nn.GroupNorm(8, a), nn.SiLU(), nn.Conv1d(a, CHANNELS, 3, padding=1)
        )
        self.register_buffer("add_up", bones_to_positions(), persistent=False)

    def forward(self, x: torch.Tensor, t: torch.Tensor, ids: torch.Tensor) -> torch.Tensor:
        """Predict the clean motion.

        Args:
            x: ``(batch, frames, 22, 3)`` noisy motion, centred and scaled.
            t: ``(batch,)`` flow time in 0..1.
            ids: ``(batch, words)`` word numbers, see `Vocabulary.encode`.
        """
        frames = x.shape[1]
        condition = functional.silu(self.time(time_features(t, 64)) + self.text(ids))
        h = torch.cat([x.flatten(2).mT, clock(x)], dim=1)
        h = functional.pad(h, (0, -frames % 4), mode="replicate")
        full = self.full_in(self.enter(h), condition)
        half = self.half_in(self.to_half(full), condition)
        h = self.quarter[0](self.to_quarter(half), condition)
        h = self.quarter[1](self.attention(h), condition)
        h = self.half_out(torch.cat([half, twice(self.from_quarter(h))], dim=1), condition)
        h = self.full_out(torch.cat([full, twice(self.from_half(h))], dim=1), condition)
        bones = self.leave(h)[..., :frames].mT.unflatten(-1, (N_JOINTS, 3))
        return self.add_up @ bones


def twice(x: torch.Tensor) -> torch.Tensor:
    """Double the frame rate by repeating every frame."""
    return x.repeat_interleave(2, dim=-1)


def clock(x: torch.Tensor) -> torch.Tensor:
    """Seconds since the start and until the end, ``(batch, 2, frames)``, a third of them.

    Absolute coordinates need it: the body stands at the origin in frame 0, not later.
    """
    batch, frames = x.shape[:2]
    since = torch.arange(frames, device=x.device, dtype=x.dtype) / 60
    return torch.stack([since, since.flip(0)]).expand(batch, 2, frames)
