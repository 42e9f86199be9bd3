"""Keyframes that are spread evenly, and a projection onto those of a whole batch of clips."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from projflow_lite.constraints import pin
from projflow_lite.samplers import ProjectionStep
from projflow_lite.samplers.moving import projection_step
from projflow_lite.skeleton import joint_index

FRAMES = 60
"""Of the motions of all studies: three seconds."""


def keyframes(count: int) -> NDArray[np.int64]:
    """`count` frames spread evenly, neither end included unless every frame is asked for."""
    if count == FRAMES:
        return np.arange(FRAMES)
    return np.linspace(0, FRAMES - 1, count + 2).round().astype(int)[1:-1]


def through_keyframes(
    positions: NDArray, joint: str, keys: int, metric: str = "kinematic"
) -> ProjectionStep:
    """A projection step that leads every clip of a batch through keyframes of its own.

    The rows, their factorisation and the guides are shared; only the targets differ.

    Args:
        positions: ``(clips, frames, 22, 3)`` metres: where the targets are taken from.
        joint: the joint that is pinned.
        keys: number of keyframes, see `keyframes`.
        metric: see `projflow_lite.samplers.sample`.
    """
    frames = keyframes(keys)
    targets = positions[:, frames, joint_index(joint, "keyframes")]
    step = projection_step(pin(joint, frames, targets[0]), FRAMES, metric)
    return step.aimed_at(targets.reshape(len(targets), -1))
