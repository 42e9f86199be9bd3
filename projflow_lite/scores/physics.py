"""Could a body have moved like this?"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from projflow_lite.skeleton import ANKLES, EDGES, FEET, FPS, bone_lengths, check_positions, shown

HEEL_DROP = 0.05
"""Metres from the ankle joint of a flat foot down to its heel, which no joint marks."""


def bone_length_error(positions: NDArray, reference: NDArray | None = None) -> NDArray:
    """Mean relative change of bone length.

    Args:
        positions: ``(..., frames, 22, 3)``, metres.
        reference: ``(..., 21)`` true lengths, metres; by default each bone's own median over time.

    Returns:
        ``(...)``, a share: 0.01 means that bones are off by 1 % on average.
    """
    lengths = bone_lengths(check_positions(positions, "bone_length_error"))
    true = np.median(lengths, axis=-2) if reference is None else np.asarray(reference, float)
    if true.shape[-1:] != (len(EDGES),) or not (np.isfinite(true) & (true > 0)).all():
        raise ValueError("bone_length_error: reference is 21 lengths, all above 0")
    return (np.abs(lengths - true[..., None, :]) / true[..., None, :]).mean((-2, -1))


def foot_skating(positions: NDArray, fps: float = FPS, definition: str = "gmd") -> NDArray:
    """Share of frames in which a foot slides over the ground.

    Two definitions are in use, and their numbers must not be compared with each other:

    - ``"gmd"``: a foot skates between two frames when its height is below 5 cm in both, its
      horizontal speed exceeds 0.5 m/s, and so does its mean speed over 5 frames. Either foot
      counts. Real motion scores around 0.1.
    - ``"bmm"``: both heels are within 5 cm of the floor and move over it at more than 7.5 cm/s, at
      the same time. The skeleton has no heel: `HEEL_DROP` below the ankle stands for it. A heel
      that rises over its toe moves too, so real walks score 0.17, and a body that waves 0.

    Args:
        positions: ``(..., frames, 22, 3)``, metres.
        fps: frames per second.
        definition: ``"gmd"`` or ``"bmm"``.

    Returns:
        ``(...)``; the frames counted are the steps from one frame to the next, ``frames - 1``.

    Raises:
        ValueError: for another definition, fewer than two frames, or a wrong shape.

    Source: the skating ratio of GMD and OmniControl; BMM appendix B.
    """
    if definition not in SKATING:
        raise ValueError(f"foot_skating: definition is 'gmd' or 'bmm', not {definition!r}")
    x = check_positions(positions, "foot_skating")
    if x.shape[-3] < 2:
        raise ValueError("foot_skating: a motion of one frame has no speed")
    check_long_enough("foot_skating", x, 2, fps)
    return SKATING[definition](x, fps).mean(-1)


def either_toe_slides(positions: NDArray, fps: float) -> NDArray:
    """GMD's and OmniControl's condition, ``(..., frames - 1)``."""
    low, speed = low_and_speed(positions[..., FEET, :], fps)
    padded = np.concatenate([speed[..., :1, :]] * 2 + [speed] + [speed[..., -1:, :]] * 2, axis=-2)
    mean = np.lib.stride_tricks.sliding_window_view(padded, 5, axis=-2).mean(-1)
    return np.any(low & (speed > 0.5) & (mean > 0.5), axis=-1)


def both_heels_slide(positions: NDArray, fps: float) -> NDArray:
    """BMM's condition, ``(..., frames - 1)``."""
    low, speed = low_and_speed(positions[..., ANKLES, :] - [0.0, HEEL_DROP, 0.0], fps)
    return np.all(low & (speed > 0.075), axis=-1)


def low_and_speed(points: NDArray, fps: float) -> tuple[NDArray, NDArray]:
    """Below 5 cm in both of two frames? And how fast over the ground, m/s; by pairs of frames."""
    below: NDArray = points[..., 1] < 0.05
    speed = np.linalg.norm(np.diff(points[..., [0, 2]], axis=-3), axis=-1) * fps
    return below[..., :-1, :] & below[..., 1:, :], speed


SKATING = {"gmd": either_toe_slides, "bmm": both_heels_slide}


def worst_acceleration(positions: NDArray, fps: float = FPS) -> NDArray:
    """Largest acceleration of any joint, ``(...)``, m/s²: it sees a keyframe that pops."""
    x = check_positions(positions, "worst_acceleration")
    check_long_enough("worst_acceleration", x, 3, fps)
    second = np.diff(x, 2, axis=-3) * fps**2
    return np.linalg.norm(second, axis=-1).max((-2, -1))


def mean_jerk(positions: NDArray, fps: float = FPS) -> NDArray:
    """Mean size of the third derivative over joints and frames, ``(...)``, m/s³."""
    x = check_positions(positions, "mean_jerk")
    check_long_enough("mean_jerk", x, 4, fps)
    third = np.diff(x, 3, axis=-3) * fps**3
    return np.linalg.norm(third, axis=-1).mean((-2, -1))


def check_long_enough(who: str, positions: NDArray, frames: int, fps: float) -> None:
    """Refuse a motion with too few frames for a derivative, and a frame rate that is none."""
    if positions.shape[-3] < frames:
        raise ValueError(f"{who}: needs at least {frames} frames, not {positions.shape[-3]}")
    if not isinstance(fps, int | float | np.number) or not 0 < fps < np.inf:
        raise ValueError(f"{who}: fps is a number above 0, not {shown(fps)}")
