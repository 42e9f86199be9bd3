"""What the two learnt baselines of the study of lifting learn from, and how they are kept.

A lesson is a batch of training clips, each drawn by a camera of its own and with paths of its own
choice of joints, as in the task "cross"; one path alone is one of the choices.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch
from torch import nn

from data_synth import Clips, make_clips
from projflow_lite.prior.checkpoint import read, write
from projflow_lite.studies.lifting_pictures import Shot, draw_camera, draw_joints, line_of_sight
from projflow_lite.studies.shares import is_first, wait_for

BATCH, CLIPS = 32, 2048
"""Clips of a lesson, and how many there are in all."""

SEED = 77_002
"""Of the clips: training data, like all seeds of `make_clips`."""


class Drawn(NamedTuple):
    """Drawings as a network sees them.

    Attributes:
        picture: ``(clips, frames, 22, 2)`` metres, 0 where nothing is drawn.
        asked: ``(clips, frames, 22)``, 1 where something is.
        sight: ``(clips, 3)`` line of sight.
    """

    picture: torch.Tensor
    asked: torch.Tensor
    sight: torch.Tensor


class Lesson(NamedTuple):
    """Drawings, what they are drawings of ``(clips, frames, 22, 3)`` metres, and its captions."""

    drawn: Drawn
    positions: torch.Tensor
    captions: list[str]


def as_drawn(shots: list[Shot], drawings: np.ndarray) -> Drawn:
    """Drawings ``(clips, frames, 22, 2)``, metres, with what is not asked for left out."""
    asked = np.stack([shot.asked(drawings.shape[1]) for shot in shots])
    sight = np.stack([line_of_sight(shot.camera) for shot in shots])
    parts = (np.where(asked[..., None], drawings, 0.0), asked, sight)
    return Drawn(*(torch.as_tensor(part, dtype=torch.float32) for part in parts))


@cache
def textbook(clips: int, frames: int, seed: int = SEED) -> Clips:
    """What lessons are taken from."""
    return make_clips(clips, frames, seed)


def lessons(steps: int, frames: int, seed: int = SEED, clips: int = CLIPS) -> Iterator[Lesson]:
    """So many batches, the same ones for the same seed."""
    random = np.random.default_rng([seed, 3])
    data = textbook(clips, frames, seed)
    for _ in range(steps):
        chosen = random.choice(clips, min(BATCH, clips), replace=False)
        x = data.positions[chosen]
        shots = [Shot(draw_camera(random), draw_joints(random)) for _ in chosen]
        drawings = np.stack([shot.drawn(clip) for shot, clip in zip(shots, x, strict=True)])
        captions = [data.captions[k] for k in chosen]
        yield Lesson(as_drawn(shots, drawings), torch.from_numpy(x), captions)


def teach(
    network: nn.Module,
    loss: Callable[[Lesson], torch.Tensor],
    steps: int,
    frames: int,
    rate: float = 2e-3,
) -> None:
    """Adam on lessons, the learning rate falling to 0 along a half cosine."""
    optimiser = torch.optim.Adam(network.parameters(), lr=rate)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, steps)
    with torch.enable_grad():
        for lesson in lessons(steps, frames):
            optimiser.zero_grad()
            loss(lesson).backward()
            nn.utils.clip_grad_norm_(network.parameters(), 1.0)
            optimiser.step()
            schedule.step()
    network.eval().requires_grad_(False)


def kept(network: nn.Module, path: Path, learn: Callable[[nn.Module], Any]) -> None:
    """Take what a network has learnt from its file; or let it learn, and store it.

    Of several processes the first one learns.
    """
    if not is_first():
        wait_for(path)
    if path.exists():
        network.load_state_dict(read(path)[0])
        network.eval().requires_grad_(False)
        return
    learn(network)
    weights = {name: value.contiguous() for name, value in network.state_dict().items()}
    write(weights, {"about": json.dumps({"what": type(network).__name__})}, path)
