"""Is a set of motions like another set?"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from projflow_lite.scores.physics import check_long_enough
from projflow_lite.skeleton import CONTROLLED, FPS, check_positions, joint_indices, number_array

STILL_SPEED, STILL_ACCELERATION = 0.03, 0.3
"""m/s and m/s²: what a motion-capture marker on a standing foot shows. Less is not seen as less."""

ENDS = joint_indices(CONTROLLED)


def frechet_distance(a: ArrayLike, b: ArrayLike) -> float:
    r"""Fréchet distance between Gaussians fitted to two sets of features.

    .. math:: \lVert \mu_a - \mu_b \rVert^2
              + \operatorname{tr}\left(C_a + C_b - 2 (C_a C_b)^{1/2}\right)

    Args:
        a: ``(samples, features)``.
        b: ``(other samples, features)``.

    Raises:
        ValueError: if the features differ in number or there are fewer than two samples.
    """
    a, b = (number_array(s, "frechet_distance: features").astype(float) for s in (a, b))
    if a.ndim != 2 or b.ndim != 2 or a.shape[1] != b.shape[1] or min(len(a), len(b)) < 2:
        raise ValueError(
            f"frechet_distance: two sets of at least two feature vectors of one length, "
            f"not {a.shape} and {b.shape}"
        )
    if not (np.isfinite(a).all() and np.isfinite(b).all()):
        raise ValueError("frechet_distance: a feature is not finite")
    C_a, C_b = np.atleast_2d(np.cov(a.T)), np.atleast_2d(np.cov(b.T))
    # tr (C_a C_b)^1/2 through symmetric matrices: their square roots are real even if singular.
    size, axes = np.linalg.eigh(C_a)
    root = (axes * np.sqrt(np.clip(size, 0, None))) @ axes.T
    cross = np.sqrt(np.clip(np.linalg.eigvalsh(root @ C_b @ root), 0, None)).sum()
    shift = a.mean(0) - b.mean(0)
    return float(shift @ shift + np.trace(C_a) + np.trace(C_b) - 2 * cross)


def kinetic_features(positions: NDArray, fps: float = FPS) -> NDArray:
    """Log of the root-mean-square speed and acceleration of pelvis, feet, head and wrists.

    A distance on these features sees spikes and jitter, which an embedding of poses hardly does.

    Args:
        positions: ``(..., frames, 22, 3)``, metres.
        fps: frames per second.

    Returns:
        ``(..., 12)``.
    """
    ends = check_positions(positions, "kinetic_features")[..., ENDS, :]
    check_long_enough("kinetic_features", ends, 3, fps)
    speed = np.square(np.diff(ends, axis=-3) * fps).sum(-1).mean(-2)
    acceleration = np.square(np.diff(ends, 2, axis=-3) * fps**2).sum(-1).mean(-2)
    floor = np.repeat([STILL_SPEED**2, STILL_ACCELERATION**2], len(ENDS))
    return 0.5 * np.log(np.concatenate([speed, acceleration], axis=-1) + floor)


def pose_features(positions: NDArray) -> NDArray:
    """Mean and spread over time of feet, head and wrists around the pelvis, and where it goes.

    A hand-made stand-in for a learned embedding: it knows nothing of prompts.

    Args:
        positions: ``(..., frames, 22, 3)``, metres.

    Returns:
        ``(..., 36)``, metres.
    """
    ends = check_positions(positions, "pose_features")[..., ENDS, :]
    around = ends[..., 1:, :] - ends[..., :1, :]
    travel = ends[..., -1, 0, :] - ends[..., 0, 0, :]
    height = ends[..., 0, 1]
    parts = [around.mean(-3), around.std(-3)]
    flat = [part.reshape(*part.shape[:-2], -1) for part in parts]
    pelvis = np.stack([height.mean(-1), height.std(-1), np.ptp(height, axis=-1)], axis=-1)
    return np.concatenate([*flat, travel, pelvis], axis=-1)
