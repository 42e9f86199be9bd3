"""Direct 2D-to-motion: a regression from the drawing and the prompt to the whole motion.

A few convolutions over time answer with the motion that is right on average. Of all that could
be meant by a drawing it can say one thing only, so it answers with something like their mean:
limbs get short, and nothing makes the answer agree with the drawing. Sketch2Anim's baseline is a
diffusion model that was trained on drawings; this one is a regression, which is weaker.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn
from torch.nn import functional

from projflow_lite.prior.text import TextEncoder, Vocabulary
from projflow_lite.skeleton import N_JOINTS
from projflow_lite.studies.lifting_lessons import Drawn, Lesson, as_drawn, teach
from projflow_lite.studies.lifting_pictures import Shot

STEPS = 1200


class Direct(nn.Module):
    """Convolutions over time, each looking twice as far as the one before.

    Args:
        vocabulary: the words of prompts.
        width: channels.
        words: length of the vector that stands for the prompt.
    """

    def __init__(self, vocabulary: Vocabulary, width: int = 96, words: int = 48) -> None:
        super().__init__()
        self.vocabulary = vocabulary
        self.text = TextEncoder(len(vocabulary), words)
        drawing = 2 * N_JOINTS + N_JOINTS
        self.first = nn.Conv1d(2 * drawing + 3 + words, width, 1)
        self.blocks = nn.ModuleList(
            nn.Conv1d(width, width, 5, padding=2 * reach, dilation=reach) for reach in (1, 2, 4, 8)
        )
        self.last = nn.Conv1d(width, 3 * N_JOINTS, 1)

    def forward(self, drawn: Drawn, prompts: list[str]) -> torch.Tensor:
        """Motions ``(clips, frames, 22, 3)``, metres."""
        frames = torch.cat([drawn.picture.flatten(2), drawn.asked], dim=2).mT
        pose = frames[:, :, :1].expand_as(frames)
        words = self.text(self.vocabulary.encode(prompts, "regression"))
        rest = torch.cat([drawn.sight, words], dim=1)
        rest = rest[:, :, None].expand(-1, -1, frames.shape[2])
        x = self.first(torch.cat([frames, pose, rest], dim=1))
        for block in self.blocks:
            x = x + functional.silu(block(x))
        return self.last(x).mT.unflatten(2, (N_JOINTS, 3))


def learn(direct: Direct, frames: int, steps: int = STEPS) -> None:
    """Teach it: mean square of what it misses."""

    def loss(lesson: Lesson) -> torch.Tensor:
        return (direct(lesson.drawn, lesson.captions) - lesson.positions).square().mean()

    teach(direct, loss, steps, frames)


def answered(direct: Direct, shot: Shot, drawings: NDArray, prompts: list[str]) -> NDArray:
    """A motion for every drawing, ``(clips, frames, 22, 3)`` metres."""
    with torch.inference_mode():
        x = direct(as_drawn([shot] * len(drawings), drawings), prompts)
    return x.numpy().astype(np.float32)
