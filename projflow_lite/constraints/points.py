"""Wishes about where joints are: pin, offset, loop, keep."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from projflow_lite.constraints.checks import (
    check_axes,
    check_finite,
    check_frames,
    check_numbers,
    check_std,
    check_values,
    check_yes_or_no,
    every_frame,
    how_exactly,
    in_words,
    inside,
)
from projflow_lite.constraints.wish import (
    Rows,
    Term,
    Wish,
    columns_of,
    coordinate_rows,
    difference_rows,
    stack,
    weighted_rows,
)
from projflow_lite.motion import Motion
from projflow_lite.skeleton import (
    JOINTS,
    N_JOINTS,
    check_positions,
    joint_index,
    joint_indices,
    shown,
)


def pin(
    joint: str | int | Sequence[str | int],
    frames: int | Iterable[int] | None,
    positions: ArrayLike,
    axes: str = "xyz",
    std: float = 0.0,
) -> Wish:
    """Ask that a joint, or several, be at given positions in given frames (ProjFlow eq. 12).

    Args:
        joint: one joint, or a list of joints.
        frames: one frame, a list of frames, or None for every frame of the motion.
        positions: metres in world coordinates, ``(frames, axes)`` for one joint,
            ``(frames, joints, axes)`` for a list; for a single frame the first dimension is
            left out.
        axes: which coordinates are asked for: "xyz", or fewer ("xz": a path on the ground).
        std: standard deviation in metres; 0 means exactly.

    Raises:
        ValueError: for an unknown joint, a frame that is no frame, a shape that does not match,
            an axis that is none of x, y, z, or a value that is not finite.
    """
    joints = joint_indices(joint, "pin")
    several = not isinstance(joint, str | int | np.integer)
    axis = check_axes(axes)
    check_std(std)
    listed, single = check_frames(frames)
    values = check_values(
        positions, listed, single, joints if several else None, axes, "pin: positions"
    )
    check_finite(values, listed, joints, axes, "pin")

    def build(total: int) -> Rows:
        frame = every_frame(listed, len(values), total, "pin", "positions")
        columns = columns_of(frame[:, None, None], np.array(joints)[:, None], axis)
        return coordinate_rows(columns.ravel(), values.ravel(), total, std)

    names = " and ".join(JOINTS[j] for j in joints)
    words = f"{names} pinned in {axes} at {in_words(listed)}, {how_exactly(std)}"
    return Wish((Term(words, build),))


def offset(
    joint_a: str | int,
    joint_b: str | int,
    d: ArrayLike,
    frames: Iterable[int] | None = None,
    std: float = 0.0,
) -> Wish:
    r"""Ask for a fixed vector between two joints: :math:`x_a - x_b = d` (ProjFlow eq. 35-36).

    Args:
        joint_a: where the vector ends.
        joint_b: where it begins; another joint than `joint_a`.
        d: ``(3,)`` the same in every frame, or ``(frames, 3)``, metres.
        frames: a list of frames, or None for every frame of the motion.
        std: standard deviation in metres; 0 means exactly.

    Raises:
        ValueError: for an unknown joint, the same joint twice, a frame that is no frame, a shape
            that does not match or a value that is not finite.
    """
    a, b = joint_index(joint_a, "offset"), joint_index(joint_b, "offset")
    if a == b:
        raise ValueError(f"offset: {JOINTS[a]} is named twice; an offset needs two joints")
    check_std(std, "offset")
    listed, _ = check_frames(frames, "offset")
    vector = check_numbers(d, "offset: d")
    count = "frames" if listed is None else len(listed)
    fits = vector.shape in ((3,), (count, 3)) or (listed is None and vector.shape[1:] == (3,))
    if not fits or vector.ndim > 2:
        raise ValueError(f"offset: d should have shape (3,) or ({count}, 3), not {vector.shape}")
    if not np.isfinite(vector).all():
        raise ValueError("offset: d has a value that is not finite")

    def build(total: int) -> Rows:
        frame = np.arange(total) if listed is None else inside(listed, total, "offset")
        if vector.ndim == 2 and len(vector) != len(frame):
            raise ValueError(f"offset: {len(vector)} vectors for {len(frame)} frames")
        targets = np.broadcast_to(vector, (len(frame), 3)).ravel()
        plus, minus = (columns_of(frame[:, None], j, np.arange(3)).ravel() for j in (a, b))
        return difference_rows(plus, minus, targets, total, std)

    words = f"{JOINTS[a]} at a given offset from {JOINTS[b]} at {in_words(listed)}"
    return Wish((Term(f"{words}, {how_exactly(std)}", build),))


def loop(
    joints: str | int | Sequence[str | int] | None = None,
    shift: ArrayLike | None = None,
    moving: bool = False,
    smooth: bool = False,
) -> Wish:
    r"""Ask that the last frame meet the first: :math:`x_{N-1} - x_0 = \text{shift}` (eq. 37-38).

    Args:
        joints: the joints that must meet; None for the whole body.
        shift: ``(3,)`` metres by which the body may have moved on; None for no shift.
        moving: leave open how far the body has moved over the ground: the pose about the pelvis
            and the pelvis's height must meet, so that the clip repeats with any step forward.
        smooth: ask as well that the velocity be the same on both sides of the seam,
            :math:`x_{N-1} - x_{N-2} = x_1 - x_0`. The paper's loop closes the pose alone.

    Raises:
        ValueError: for an unknown joint, a shift that is not three finite numbers, or a shift
            that is given and left open at once.
    """
    chosen = np.array(joint_indices(range(N_JOINTS) if joints is None else joints, "loop"))
    vector = np.zeros(3) if shift is None else check_numbers(shift, "loop: shift")
    if vector.shape != (3,) or not np.isfinite(vector).all():
        raise ValueError(f"loop: shift should be three finite numbers, not {shown(shift)}")
    check_yes_or_no("loop", moving=moving, smooth=smooth)
    if moving and shift is not None:
        raise ValueError("loop: a moving loop leaves the shift open; give shift or moving=True")

    def build(total: int) -> Rows:
        if total < (3 if smooth else 2):
            raise ValueError(
                "loop: a smooth loop needs at least three frames"
                if smooth
                else "loop: a loop needs at least two frames"
            )
        closing = pose_closes(chosen, total) if moving else point_closes(chosen, vector, total)
        return stack([closing, velocity_closes(chosen, total)]) if smooth else closing

    who = "the whole body" if joints is None else " and ".join(JOINTS[j] for j in chosen)
    moved = ", ".join(f"{value:g}" for value in vector)
    where = "where it began" if shift is None else f"({moved}) m from where it began"
    where = "in the pose in which it began" if moving else where
    words = f"{who} ends {where}" + (" and moves on as it did" if smooth else "")
    return Wish((Term(words, build),))


def point_closes(joints: NDArray, shift: NDArray, frames: int) -> Rows:
    """Rows by which joints end where they began, or a given vector from there."""
    first, last = (columns_of(n, joints[:, None], np.arange(3)).ravel() for n in (0, frames - 1))
    return difference_rows(last, first, np.tile(shift, len(joints)), frames)


def pose_closes(joints: NDArray, frames: int) -> Rows:
    """Rows by which joints end where they began as seen from the pelvis, at the same height."""
    others = joints[joints != 0]
    ends = [columns_of(n, others[:, None], np.arange(3)).ravel() for n in (frames - 1, 0)]
    pelvis = [np.tile(columns_of(n, 0, np.arange(3)), len(others)) for n in (frames - 1, 0)]
    columns = np.stack([ends[0], pelvis[0], ends[1], pelvis[1]], axis=1)
    weights = np.array([1.0, -1.0, -1.0, 1.0])
    pose = weighted_rows(columns, weights, np.zeros(len(columns)), frames)
    last, first = (np.array([columns_of(n, 0, 1)]) for n in (frames - 1, 0))
    height = difference_rows(last, first, np.zeros(1), frames)
    return stack([pose, height])


def velocity_closes(joints: NDArray, frames: int) -> Rows:
    """Rows by which joints leave the last frame as fast as they left the first."""
    at = [
        columns_of(n, joints[:, None], np.arange(3)).ravel() for n in (frames - 1, frames - 2, 1, 0)
    ]
    columns = np.stack(at, axis=1)
    weights = np.array([1.0, -1.0, -1.0, 1.0])
    return weighted_rows(columns, weights, np.zeros(len(columns)), frames)


def keep(
    motion: Motion | ArrayLike,
    joints: str | int | Sequence[str | int],
    frames: Iterable[int] | None = None,
    std: float = 0.0,
) -> Wish:
    """Ask that joints of a given motion stay as they are, while the rest may change.

    Args:
        motion: a `Motion`, or positions ``(frames, 22, 3)``, metres.
        joints: the joints to keep; ``skeleton.UPPER_BODY`` and ``LOWER_BODY`` are such lists.
        frames: a list of frames, or None for every frame.
        std: standard deviation in metres; 0 means exactly.

    Raises:
        ValueError: for an unknown joint, a batch of motions, or a frame that it does not have.
    """
    positions = check_positions(motion.positions if isinstance(motion, Motion) else motion, "keep")  # type: ignore[arg-type]
    if positions.ndim != 3:
        raise ValueError(f"keep: one motion (frames, 22, 3), not a batch {positions.shape}")
    chosen = joint_indices(joints, "keep")
    check_std(std, "keep")
    listed, _ = check_frames(frames, "keep")
    frame = np.arange(len(positions)) if listed is None else inside(listed, len(positions), "keep")
    values = positions[frame][:, chosen]
    wish = pin(chosen, None if listed is None else frame, values, std=std)

    def build(total: int) -> Rows:
        if listed is None and total != len(positions):
            raise ValueError(f"keep: {len(positions)} frames to keep in a motion of {total} frames")
        return wish.rows(total)

    names = ", ".join(JOINTS[j] for j in chosen)
    words = f"{names} kept as they are at {in_words(listed)}, {how_exactly(std)}"
    return Wish((Term(words, build),))
