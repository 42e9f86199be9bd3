"""Could a body have moved like this?"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from projflow_lite.skeleton import FPS, JOINTS, bone_lengths, check_positions

FEET = (JOINTS.index("left_foot"), JOINTS.index("right_foot"))


def bone_length_error(positions: NDArray, reference: NDArray | None = None) -> NDArray:
    """Mean relative change of bone length.

    Args:
        positions: ``(..., frames, 22, 3)``, metres.
        reference: ``(..., 21)`` true lengths, metres; by default each bone's own median over time.

    Returns:
        ``(...)``, a share: 0.01 means that bones are off by 1 % on average.
    """
    lengths = bone_lengths(check_positions(positions, "bone_length_error"))
    true = np.median(lengths, axis=-2) if reference is None else np.asarray(reference)
    return (np.abs(lengths - true[..., None, :]) / true[..., None, :]).mean((-2, -1))


def foot_skating(positions: NDArray, fps: float = FPS) -> NDArray:
    """Share of frames in which a foot slides over the ground.

    A foot skates between two frames when its height is below 5 cm in both, its horizontal speed
    exceeds 0.5 m/s, and so does its mean speed over 5 frames. Either foot counts. Real motion
    scores around 0.1.

    Args:
        positions: ``(..., frames, 22, 3)``, metres.
        fps: frames per second.

    Source: the skating ratio of GMD and OmniControl.
    """
    feet = check_positions(positions, "foot_skating")[..., FEET, :]
    low = feet[..., 1] < 0.05
    velocity = np.diff(feet[..., [0, 2]], axis=-3) * fps
    speed = np.linalg.norm(velocity, axis=-1)
    padded = np.concatenate([speed[..., :1, :]] * 2 + [speed] + [speed[..., -1:, :]] * 2, axis=-2)
    mean = np.lib.stride_tricks.sliding_window_view(padded, 5, axis=-2).mean(-1)
    slides = low[..., :-1, :] & low[..., 1:, :] & (speed > 0.5) & (mean > 0.5)
    return slides.any(-1).mean(-1)


def worst_acceleration(positions: NDArray, fps: float = FPS) -> NDArray:
    """Largest acceleration of any joint, ``(...)``, m/s²: it sees a keyframe that pops."""
    second = np.diff(check_positions(positions, "worst_acceleration"), 2, axis=-3) * fps**2
    return np.linalg.norm(second, axis=-1).max((-2, -1))


def mean_jerk(positions: NDArray, fps: float = FPS) -> NDArray:
    """Mean size of the third derivative over joints and frames, ``(...)``, m/s³."""
    third = np.diff(check_positions(positions, "mean_jerk"), 3, axis=-3) * fps**3
    return np.linalg.norm(third, axis=-1).mean((-2, -1))
