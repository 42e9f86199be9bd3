"""Lift-and-control: guess the depth of every drawn point, then lead ProjFlow through the points.

A small network looks at single frames: at the points drawn there, at the drawn pose of frame 0, and
at the time between the two. It answers with the depth of all joints. Since the camera is known, the
guessed points lie exactly where they were drawn, and the sampler that follows is ProjFlow with
pins. So this row differs from ProjFlow's own in one thing only: depth is decided beforehand, by a
regression that knows neither the prompt nor the frames between, and not by the flow. Sketch2Anim's
baseline lifts with MotionBERT and controls with a trained branch instead, which need not obey.
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
    r"""Depth of the drawn pose, and what a frame adds to it.

    One and the same network f is asked three times,

    .. math:: d_n = f(\text{pose}) + f(\text{frame } n) - f(\text{pose, seen as frame } n),

    so that depth begins with the pose's, and does not jump where fewer joints are drawn.
    """

    def __init__(self, width: int = 256) -> None:
        super().__init__()
        inputs = 2 * N_JOINTS + N_JOINTS + 2 * N_JOINTS + 3 + 1
        self.layers = nn.Sequential(
            nn.Linear(inputs, width), nn.SiLU(), nn.Linear(width, width), nn.SiLU(),
            nn.Linear(width, N_JOINTS),
        )  # fmt: skip

    def forward(self, drawn: Drawn) -> torch.Tensor:
        """Depth ``(clips, frames, 22)`` of joints along the line of sight, metres."""
        frames = drawn.picture.shape[1]
        pose = drawn.picture[:, :1].expand_as(drawn.picture)
        seconds = torch.arange(frames)[:, None].expand(len(pose), -1, -1) / FPS
        begun = self.look(pose[:, :1], drawn.asked[:, :1], pose[:, :1], drawn.sight, seconds[:, :1])
        now = self.look(drawn.picture, drawn.asked, pose, drawn.sight, seconds)
        then = self.look(pose, drawn.asked, pose, drawn.sight, 0 * seconds)
        return begun + now - then

    def look(
        self,
        picture: torch.Tensor,
        asked: torch.Tensor,
        pose: torch.Tensor,
        sight: torch.Tensor,
        seconds: torch.Tensor,
    ) -> torch.Tensor:
        """The network f: depths ``(clips, frames, 22)`` from single frames and the pose."""
        seen = (picture * asked[..., None]).flatten(2)
        along = sight[:, None].expand(-1, picture.shape[1], -1)
        return self.layers(torch.cat([seen, asked, pose.flatten(2), along, seconds], dim=2))


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
