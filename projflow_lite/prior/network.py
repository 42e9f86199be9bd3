r"""The tiny flow's network: from a noisy motion, a time and a prompt to the clean motion.

A U-Net over time. It sees the motion as 66 channels at 20 frames a second, halves the frame rate
twice on the way in and doubles it once on the way out; every block is told the flow time and the
prompt. Its last layer speaks in control points, one for every two frames, of the pelvis and of 21
bone vectors. Two fixed linear maps turn them into a motion: a cubic B-spline draws a curve through
time, so that nothing can tremble faster than people move, and a sum along the skeleton puts bone
to bone, so that their lengths are easy to learn.

Near the end of the flow the best answer is nearly the input itself. A few smoothed copies of it go
straight to the control points, each as loud as the condition says (`smooth` and `gate`); without
them the narrow middle of the net would have to remember every millimetre.
"""

from __future__ import annotations

import math

import torch
from torch import nn
from torch.nn import functional

from projflow_lite.prior.text import TextEncoder
from projflow_lite.skeleton import N_JOINTS, PARENTS

CHANNELS = N_JOINTS * 3
COPIES = 3

LIMB = 0.013
"""How well lengths of limbs are predicted, in units of the noise: about half a centimetre."""


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


class Inward(nn.Module):
    """The way in: from what is seen of a motion to features at half and quarter frame rate."""

    enter: nn.Conv1d
    half_in: nn.ModuleList
    to_quarter: nn.Conv1d
    quarter: nn.ModuleList
    attention: Attention

    def inward(
        self, seen: torch.Tensor, condition: torch.Tensor, hint: torch.Tensor | None = None
    ) -> tuple[torch.Tensor, torch.Tensor]:
        """Features at half and at quarter frame rate.

        Args:
            seen: ``(batch, channels + 2, frames)`` from `Network.look`.
            condition: ``(batch, condition)`` from `Network.told`.
            hint: added at the door, ``(batch, width, frames / 2)``.
        """
        # A body may be ten metres away and move by millimetres: half precision is for the middle.
        with torch.autocast(seen.device.type, enabled=False):
            h = self.enter(seen) if hint is None else self.enter(seen) + hint
        half = through(self.half_in, h, condition)
        h = self.quarter[0](self.to_quarter(half), condition)
        return half, self.quarter[1](self.attention(h), condition)


class Network(Inward):
    r"""Predicts the clean endpoint :math:`\hat x_1` of the flow from :math:`(x_t, t, \text{text})`.

    Args:
        words: size of the vocabulary, padding included.
        widths: channels at half and quarter frame rate.
        condition: length of the vector that carries flow time and prompt.
        mean: ``(22, 3)`` what was taken out of the motion to centre it, in its scale: without it
            there is no telling how long a limb is.

    Attributes:
        channels: numbers in a frame.
    """

    channels = CHANNELS

    def __init__(
        self,
        words: int,
        widths: tuple[int, int] = (160, 240),
        condition: int = 256,
        mean: torch.Tensor | None = None,
    ) -> None:
        super().__init__()
        a, b = widths
        channels = self.channels
        self.text = TextEncoder(words, condition)
        self.time = nn.Sequential(
            nn.Linear(64, condition), nn.SiLU(), nn.Linear(condition, condition)
        )
        self.enter = nn.Conv1d(channels + 2, a, 4, 2, 1)
        self.half_in = nn.ModuleList([Block(a, a, condition), Block(a, a, condition)])
        self.to_quarter = nn.Conv1d(a, b, 4, 2, 1)
        self.quarter = nn.ModuleList([Block(b, b, condition), Block(b, b, condition)])
        self.attention = Attention(b)
        self.from_quarter = nn.Conv1d(b, a, 1)
        self.half_out = nn.ModuleList([Block(2 * a, a, condition), Block(a, a, condition)])
        self.leave = nn.Sequential(
            nn.GroupNorm(8, a), nn.SiLU(), nn.Conv1d(a, channels, 3, padding=1)
        )
        self.smooth = nn.Conv1d(channels, COPIES * channels, 8, 2, 3, groups=channels)
        self.gate = nn.Linear(condition, COPIES * channels)
        self.add_up: torch.Tensor
        self.take_apart: torch.Tensor
        self.spline: torch.Tensor
        self.register_buffer("add_up", bones_to_positions(), persistent=False)
        self.register_buffer("take_apart", bones_to_positions().inverse(), persistent=False)
        self.usual: torch.Tensor
        self.register_buffer("spline", spline_kernel(), persistent=False)
        centre = torch.zeros(N_JOINTS, 3) if mean is None else mean.float()
        self.register_buffer("usual", self.take_apart @ centre, persistent=False)

    def forward(self, x: torch.Tensor, t: torch.Tensor, ids: torch.Tensor) -> torch.Tensor:
        """Predict the clean motion.

        Args:
            x: ``(batch, frames, 22, 3)`` noisy motion, centred and scaled.
            t: ``(batch,)`` flow time in 0..1.
            ids: ``(batch, words)`` word numbers, see `Vocabulary.encode`.
        """
        seen, condition = self.look(x), self.told(t, ids)
        half, quarter = self.inward(seen, condition)
        return self.outward(half, quarter, seen, condition, t, x.shape[1])

    def look(self, x: torch.Tensor) -> torch.Tensor:
        """Motions as channels, with a clock, and with as many frames as two halvings need."""
        seen = torch.cat([self.see(x), clock(x)], dim=1)
        return functional.pad(seen, (0, -x.shape[1] % 4), mode="replicate")

    def told(self, t: torch.Tensor, ids: torch.Tensor) -> torch.Tensor:
        """Flow time and prompt as one vector, ``(batch, condition)``."""
        return functional.silu(self.time(time_features(t, 64)) + self.text(ids))

    def outward(
        self,
        half: torch.Tensor,
        quarter: torch.Tensor,
        seen: torch.Tensor,
        condition: torch.Tensor,
        t: torch.Tensor,
        frames: int,
    ) -> torch.Tensor:
        """The way out: from the features of `inward` to the clean motion."""
        both = torch.cat([half, twice(self.from_quarter(quarter))], 1)
        h = through(self.half_out, both, condition)
        with torch.autocast(half.device.type, enabled=False):
            loud = self.gate(condition.float()).unsqueeze(-1)
            copies = self.smooth(seen[:, : self.channels]) * loud
            points = self.leave(h.float()) + copies.unflatten(1, (self.channels, COPIES)).sum(2)
            return self.say(draw(points, self.spline)[..., :frames].mT, t)

    def see(self, x: torch.Tensor) -> torch.Tensor:
        """Motions as channels over time, ``(batch, channels, frames)``: bone by bone."""
        return (self.take_apart @ x).flatten(2).mT

    def say(self, curves: torch.Tensor, t: torch.Tensor) -> torch.Tensor:
        """Motions from what was drawn, ``(batch, frames, channels)``."""
        return self.add_up @ self.even_limbs(curves.unflatten(-1, (N_JOINTS, 3)), t)

    def even_limbs(self, bones: torch.Tensor, t: torch.Tensor) -> torch.Tensor:
        """Give every limb its mean length in all frames, the more so the less noise is left.

        Earlier a prediction is the mean of several poses, and the mean of limbs that point in
        different directions is shorter than a limb.

        Args:
            bones: ``(batch, frames, 22, 3)`` bone vectors, centred; the first is the pelvis.
            t: ``(batch,)`` flow time.
        """
        limbs = bones[:, :, 1:] + self.usual[1:]
        length = limbs.square().sum(-1, keepdim=True).clamp(min=1e-6).sqrt()
        noise = ((1 - t) / t.clamp(min=1e-3)).view(-1, 1, 1, 1)
        share = LIMB**2 / (LIMB**2 + noise.square())
        longer = limbs * share * (length.mean(1, keepdim=True) / length - 1)
        return torch.cat([bones[:, :, :1], bones[:, :, 1:] + longer], dim=2)


def through(blocks: nn.ModuleList, x: torch.Tensor, condition: torch.Tensor) -> torch.Tensor:
    """Pass features through blocks, one after the other."""
    for block in blocks:
        x = block(x, condition)
    return x


def spline_kernel() -> torch.Tensor:
    """Weights of a control point in the eight frames around it, ``(8,)``: a cubic B-spline.

    Control points lie midway between two frames and two frames apart.
    """
    u = (torch.arange(8) - 3.5).abs() / 2
    return torch.where(u < 1, 2 / 3 - u**2 + u**3 / 2, (2 - u).clamp(min=0) ** 3 / 6)


def draw(points: torch.Tensor, kernel: torch.Tensor) -> torch.Tensor:
    """Draw spline curves: control points ``(batch, channels, k)`` to ``(batch, channels, 2 k)``.

    Two more points at either end go on as straight lines.
    """
    first, second, last = points[..., :1], points[..., 1:2], points[..., -1:]
    ahead, back = last - points[..., -2:-1], first - second
    points = torch.cat([first + 2 * back, first + back, points, last + ahead, last + 2 * ahead], -1)
    channels = points.shape[1]
    weight = kernel.expand(channels, 1, 8)
    return functional.conv_transpose1d(points, weight, stride=2, groups=channels)[..., 7:-7]


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
