"""Lift-and-control: guess the depth of every drawn point, then lead ProjFlow through the points.

A small network looks at single frames: at the points drawn there, at the drawn pose of frame 0, and
at the time between the two. It answers with the depth of all joints. Since the camera is known, the
guessed points lie exactly where they were drawn, and the sampler that follows is ProjFlow with
pins. So this row differs from ProjFlow's own in one thing only: depth is decided beforehand, by a
regression that knows neither the prompt nor the frames between, and not by the flow. Sketch2Anim's
baseline lifts with MotionBERT and controls with a trained branch instead.
"""

from __future__ import annotations

from functools import reduce
from operator import and_

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from projflow_lite.constraints import Wish, pin
from projflow_lite.samplers import ProjectionStep
from projflow_lite.skeleton import FPS, N_JOINTS
from projflow_lite.studies.lifting_lessons import Drawn, Lesson, as_drawn, teach
from projflow_lite.studies.lifting_pictures import Shot, in_space

STEPS = 1200


class Lifter(nn.Module):
    """Three layers: a drawn frame, the drawn pose, the line of sight and the time to depths."""

    def __init__(self, width: int = 256) -> None:
        super().__init__()
        inputs = 2 * N_JOINTS + N_JOINTS + 2 * N_JOINTS + 3 + 1
        self.layers = nn.Sequential(
            nn.Linear(inputs, width), nn.SiLU(), nn.Linear(width, width), nn.SiLU(),
            nn.Linear(width, N_JOINTS),
        )  # fmt: skip

    def forward(self, drawn: Drawn) -> torch.Tensor:
        """Depth ``(clips, frames, 22)`` of joints along the line of sight, metres."""
        picture = drawn.picture.flatten(2)
        pose = picture[:, :1].expand_as(picture)
        sight = drawn.sight[:, None].expand(-1, picture.shape[1], -1)
        seconds = torch.arange(picture.shape[1])[:, None].expand(len(picture), -1, -1) / FPS
        return self.layers(torch.cat([picture, drawn.asked, pose, sight, seconds], dim=2))


def learn(lifter: Lifter, frames: int, steps: int = STEPS) -> None:
    """Teach a lifter: mean square of what it misses, over the drawn points."""

    def loss(lesson: Lesson) -> torch.Tensor:
        depth = (lesson.positions * lesson.drawn.sight[:, None, None]).sum(-1)
        miss = (lifter(lesson.drawn) - depth).square() * lesson.drawn.asked
        return miss.sum() / lesson.drawn.asked.sum()

    teach(lifter, loss, steps, frames)


def lifted(lifter: Lifter, shot: Shot, drawings: NDArray) -> NDArray:
    """Where the lifter thinks that joints are, ``(clips, frames, 22, 3)`` metres.

    Only what is drawn is meant; the rest is to be left alone.
    """
    with torch.inference_mode():
        depth = lifter(as_drawn([shot] * len(drawings), drawings)).numpy()
    return in_space(shot.camera, drawings, depth.astype(np.float64))


def pins(shot: Shot, points: NDArray) -> Wish:
    """That the pose and the paths be where they are lifted to, for one motion."""
    later = range(1, len(points))
    paths = [pin(j, later, points[1:, j]) for j in shot.joints]
    return reduce(and_, [pin(range(N_JOINTS), 0, points[0]), *paths])


def aim(shot: Shot, points: NDArray) -> ProjectionStep:
    """What the sampler asks in every step.

    Args:
        shot: how the motions were drawn.
        points: ``(clips, frames, 22, 3)`` where their joints are thought to be, metres.
    """
    first = [points[:, 0], *(points[:, 1:, j] for j in shot.joints)]
    y = np.concatenate([part.reshape(len(points), -1) for part in first], axis=1)
    return ProjectionStep(pins(shot, points[0]), points.shape[1]).aimed_at(y)
