"""Does a motion go where it was asked to go?"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from projflow_lite.skeleton import number_array

MISS = 0.5
"""A keyframe missed by more than this, in metres, counts as lost."""


class ControlErrors(NamedTuple):
    """Control errors of one clip or, after averaging, of many."""

    trajectory: NDArray
    location: NDArray
    average: NDArray


def control_errors(positions: ArrayLike, targets: ArrayLike) -> ControlErrors:
    r"""Trajectory, location and average error of each clip.

    With :math:`e = \lVert p - p^* \rVert_2` over the observed frames and joints of a clip:
    the trajectory error is 1 if any :math:`e > 0.5` m, the location error is the share of
    :math:`e > 0.5` m, and the average error is the mean of :math:`e`.

    Args:
        positions: ``(..., frames, joints, 3)``, metres.
        targets: the same shape; NaN where nothing is asked for.

    Returns:
        Three arrays ``(...)``; the last in metres. Average them over clips.

    Raises:
        ValueError: if the shapes differ or a clip has no target at all.

    Source: OmniControl's definitions, as ProjFlow reports them.
    """
    p = number_array(positions, "control_errors: positions").astype(float)
    wanted = number_array(targets, "control_errors: targets").astype(float)
    if p.ndim < 3 or p.shape[-1] != 3:
        raise ValueError(f"control_errors: positions {p.shape} are not (..., frames, joints, 3)")
    if p.shape != wanted.shape:
        raise ValueError(f"control_errors: positions {p.shape} and targets {wanted.shape} differ")
    if not np.isfinite(p).all() or np.isinf(wanted).any():
        raise ValueError("control_errors: a position is not finite; only targets may be NaN")
    e = np.linalg.norm(p - wanted, axis=-1)
    observed = ~np.isnan(e)
    count = observed.sum(axis=(-2, -1))
    if np.any(count == 0):
        raise ValueError("control_errors: a clip has no target at all")
    lost = (e > MISS).sum(axis=(-2, -1))  # comparisons with NaN are false
    return ControlErrors((lost > 0).astype(float), lost / count, np.nansum(e, (-2, -1)) / count)
