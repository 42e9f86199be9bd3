"""Motion with one known fault, to find out which scores notice it and which are blind.

Every fault has a size, and of size 0 it is none. Positions are ``(..., frames, 22, 3)``, metres, y
up, facing +z; what comes back has the same shape.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.distance import cdist

from projflow_lite.skeleton import EDGES, FPS, N_JOINTS, check_positions, joint_index

FOREARM = joint_index("left_elbow"), joint_index("left_wrist")
FOOT = joint_index("left_foot")


def spike(positions: NDArray, size: float) -> NDArray:
    """One frame in which the left wrist is `size` metres too high, as where a keyframe pops.

    The frame is the middle one.
    """
    x = copied(positions, "spike")
    x[..., x.shape[-3] // 2, FOREARM[1], 1] += size
    return x


def slide(positions: NDArray, speed: float) -> NDArray:
    """The whole body glides to its left at `speed` metres a second, whatever its feet do."""
    x = copied(positions, "slide")
    x[..., 0] += speed * np.arange(x.shape[-3])[:, None] / FPS
    return x


def stretch(positions: NDArray, share: float) -> NDArray:
    """The left forearm is longer by a `share` of itself, in every frame alike."""
    x = copied(positions, "stretch")
    elbow, wrist = FOREARM
    x[..., wrist, :] += share * (x[..., wrist, :] - x[..., elbow, :])
    return x


def smooth(positions: NDArray, frames: float) -> NDArray:
    """Every joint's path smoothed by a Gaussian, the standard deviation of which is in frames."""
    x = copied(positions, "smooth")
    return gaussian_filter1d(x, frames, axis=-3, mode="nearest") if frames > 0 else x


def parrot(text_points: ArrayLike, motion_points: ArrayLike) -> NDArray[np.intp]:
    """A model that knows some clips by heart, and answers each prompt with the nearest of them.

    Args:
        text_points: ``(prompts, features)`` of an evaluator.
        motion_points: ``(known clips, features)`` of the same.

    Returns:
        ``(prompts,)``: which clip it answers with.
    """
    return cdist(np.asarray(text_points), np.asarray(motion_points)).argmin(axis=1)


def sliding_foot(speed: float, height: float, frames: int = 60, moving: int = 20) -> NDArray:
    """A body that stands stock-still but for its left foot: the skate in it is known beforehand.

    All other joints are high above the ground. The foot slides forward during `moving` steps from
    one frame to the next, in the middle of the clip.

    Args:
        speed: of the foot, metres a second.
        height: of the foot above the ground, metres.
        frames: length of the clip.
        moving: how many of its ``frames - 1`` steps the foot slides in; all, if it has fewer.

    Returns:
        ``(frames, 22, 3)`` metres.
    """
    body = np.zeros((N_JOINTS, 3))
    for parent, child in EDGES:
        body[child] = body[parent] + [0.06, 0.0, 0.08]
    body[:, 1] = 2.0
    body[FOOT, 1] = height
    x = np.repeat(body[None], frames, axis=0)
    since = np.arange(frames) - max(frames - 1 - moving, 0) // 2
    x[:, FOOT, 2] += np.clip(since, 0, moving) * speed / FPS
    return x


def copied(positions: NDArray, who: str) -> NDArray[np.float64]:
    """A copy that may be changed, checked."""
    return np.array(check_positions(positions, who), dtype=float)
