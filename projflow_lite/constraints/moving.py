"""Wishes about how joints move, and about the body as a whole: velocity, acceleration, balance."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from projflow_lite.constraints.checks import (
    check_axes,
    check_finite,
    check_frames,
    check_numbers,
    check_std,
    check_values,
    every_frame,
    how_exactly,
    in_words,
)
from projflow_lite.constraints.wish import Rows, Term, Wish, columns_of, weighted_rows
from projflow_lite.skeleton import FPS, JOINTS, MASS, N_JOINTS, joint_indices

STENCILS = {"velocity": ((0, 1), (-1.0, 1.0)), "acceleration": ((-1, 0, 1), (1.0, -2.0, 1.0))}
"""Frames around the one that is meant, and their weights; times fps, or fps squared."""


def velocity(
    joint: str | int | Sequence[str | int],
    frames: int | Iterable[int],
    values: ArrayLike,
    axes: str = "xyz",
    std: float = 0.0,
) -> Wish:
    r"""Ask how fast joints move from a frame to the next: :math:`f\,(x_{n+1} - x_n) = v`.

    The rows are written in metres a frame, so that residuals are metres as everywhere. A foot
    that stands has velocity 0.

    Args:
        joint: one joint, or a list of joints.
        frames: one frame, or a list of frames; not the last one of the motion.
        values: metres a second, shaped as the positions of `pin`.
        axes: which coordinates are asked for.
        std: standard deviation in metres a second; 0 means exactly.

    Raises:
        ValueError: as for `pin`; for a frame without a next one.
    """
    return derivative("velocity", joint, frames, values, axes, std)


def acceleration(
    joint: str | int | Sequence[str | int],
    frames: int | Iterable[int],
    values: ArrayLike,
    axes: str = "xyz",
    std: float = 0.0,
) -> Wish:
    r"""Ask for an acceleration: :math:`f^2 (x_{n+1} - 2 x_n + x_{n-1}) = a`.

    The rows are written in metres a frame squared, so that residuals are metres as everywhere.

    Args:
        joint: one joint, or a list of joints.
        frames: one frame, or a list of frames; neither the first nor the last of the motion.
        values: metres a second squared, shaped as the positions of `pin`.
        axes: which coordinates are asked for.
        std: standard deviation in metres a second squared; 0 means exactly.

    Raises:
        ValueError: as for `pin`; for a frame without a neighbour on either side.
    """
    return derivative("acceleration", joint, frames, values, axes, std)


def derivative(
    who: str,
    joint: str | int | Sequence[str | int],
    frames: int | Iterable[int],
    values: ArrayLike,
    axes: str,
    std: float,
) -> Wish:
    """Rows on differences over time; see `velocity` and `acceleration`."""
    steps, weights = STENCILS[who]
    unit, rate = ("m/s", FPS) if who == "velocity" else ("m/s²", FPS**2)
    joints = joint_indices(joint, who)
    several = not isinstance(joint, str | int | np.integer)
    axis = check_axes(axes, who)
    check_std(std, who, unit)
    if frames is None:
        raise ValueError(f"{who}: frames is an integer or a list of integers, not None")
    listed, single = check_frames(frames, who)
    given = check_values(
        values, listed, single, joints if several else None, axes, f"{who}: values"
    )
    check_finite(given, listed, joints, axes, who)

    def build(total: int) -> Rows:
        frame = every_frame(listed, len(given), total, who, "values")
        for n in frame:
            if n + steps[0] < 0 or n + steps[-1] >= total:
                raise ValueError(f"{who}: frame {n} of 0..{total - 1} has no neighbour to compare")
        centre = columns_of(frame[:, None, None], np.array(joints)[:, None], axis).reshape(-1, 1)
        columns = centre + np.array(steps) * N_JOINTS * 3
        return weighted_rows(columns, np.array(weights), given.ravel() / rate, total, std / rate)

    names = " and ".join(JOINTS[j] for j in joints)
    words = f"{who} of {names} in {axes} given at {in_words(listed)}, {how_exactly(std, unit)}"
    return Wish((Term(words, build),))


def centre_of_mass(
    frames: int | Iterable[int] | None,
    positions: ArrayLike,
    axes: str = "xyz",
    std: float = 0.0,
    mass: ArrayLike | None = None,
) -> Wish:
    r"""Ask where the centre of mass is: :math:`\sum_j m_j x_j = y`.

    Over the standing foot for balance; on a parabola for a leap.

    Args:
        frames: one frame, a list of frames, or None for every frame.
        positions: metres, ``(frames, axes)``; for a single frame the first dimension is left out.
        axes: which coordinates are asked for.
        std: standard deviation in metres; 0 means exactly.
        mass: ``(22,)`` share of the body's mass at every joint; ``skeleton.MASS`` by default.

    Raises:
        ValueError: as for `pin`; for masses that are negative or do not sum to 1.
    """
    who = "centre_of_mass"
    share = check_numbers(MASS if mass is None else mass, f"{who}: mass")
    if share.shape != (N_JOINTS,) or not (share >= 0).all() or abs(share.sum() - 1) > 1e-6:
        raise ValueError(f"{who}: mass is {N_JOINTS} shares, none negative, that sum to 1")
    axis = check_axes(axes, who)
    check_std(std, who)
    listed, single = check_frames(frames, who)
    values = check_values(positions, listed, single, None, axes, f"{who}: positions")
    if not np.isfinite(values).all():
        raise ValueError(f"{who}: positions has a value that is not finite")

    def build(total: int) -> Rows:
        frame = every_frame(listed, len(values), total, who, "positions")
        first = columns_of(frame[:, None], 0, axis).reshape(-1, 1)
        columns = first + 3 * np.arange(N_JOINTS)
        return weighted_rows(columns, share, values.ravel(), total, std)

    words = f"centre of mass in {axes} given at {in_words(listed)}, {how_exactly(std)}"
    return Wish((Term(words, build),))
