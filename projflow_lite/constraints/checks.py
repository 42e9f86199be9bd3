"""What a person may pass to a constraint, and what is said when it is something else."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from projflow_lite.constraints.wish import AXES
from projflow_lite.skeleton import JOINTS


def check_axes(axes: str, who: str = "pin") -> NDArray[np.int64]:
    """Turn "xz" into ``[0, 2]``, or refuse it."""
    if not isinstance(axes, str) or not axes or set(axes) - set(AXES) or len(set(axes)) < len(axes):
        raise ValueError(f"{who}: axes is some of 'xyz', each once, not {axes!r}")
    return np.array([AXES.index(axis) for axis in axes])


def check_numbers(value: ArrayLike, what: str) -> NDArray[np.float64]:
    """An array of numbers, or an error that says what is not one."""
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"{what} should be a regular array of numbers") from None


def check_std(std: float, who: str = "pin", unit: str = "a length in metres") -> None:
    """Refuse a standard deviation that is negative or not finite."""
    if (
        isinstance(std, bool)
        or not isinstance(std, int | float | np.number)
        or not 0 <= std < np.inf
    ):
        raise ValueError(f"{who}: std is {unit}, 0 or more, not {std!r}")


def check_frames(
    frames: int | Iterable[int] | None, who: str = "pin"
) -> tuple[NDArray | None, bool]:
    """Frames as an integer array (None stands for all of them), and whether it was just one."""
    if frames is None:
        return None, False
    single = isinstance(frames, int | np.integer) and not isinstance(frames, bool)
    if not single and not isinstance(frames, Iterable):
        raise ValueError(f"{who}: frames is an integer or a list of integers, not {frames!r}")
    listed = np.array([frames] if single else list(frames))  # type: ignore[arg-type]
    if listed.ndim != 1 or len(listed) == 0 or listed.dtype.kind not in "iu":
        raise ValueError(f"{who}: frames is an integer or a list of integers, not {frames!r}")
    return listed.astype(np.int64), single


def check_values(
    values: ArrayLike,
    frames: NDArray | None,
    single_frame: bool,
    joints: list[int] | None,
    axes: str,
    what: str,
) -> NDArray[np.float64]:
    """Values as ``(frames, joints, axes)``; joints is None where the caller named just one.

    Raises:
        ValueError: if the shape is not that of the frames, joints and axes, or a value is not
            finite.
    """
    given = check_numbers(values, what)
    shape = given.shape if not single_frame else (1, *given.shape)
    several = [] if joints is None else [len(joints)]
    wanted = ("frames" if frames is None else len(frames), *several, len(axes))
    fits = len(shape) == len(wanted) and shape[1:] == wanted[1:]
    if not fits or wanted[0] not in ("frames", shape[0]):
        text = ", ".join(str(n) for n in (wanted[1:] if single_frame else wanted))
        raise ValueError(f"{what} should have shape ({text}), not {given.shape}")
    return given.reshape(shape[0], -1, len(axes))


def check_finite(
    values: NDArray, frames: NDArray | None, joints: list[int], axes: str, who: str
) -> None:
    """Refuse a value that is no number, saying where it is; values as `check_values` returns."""
    if not np.isfinite(values).all():
        n, j, c = np.argwhere(~np.isfinite(values))[0]
        frame = n if frames is None else frames[n]
        raise ValueError(
            f"{who}: {JOINTS[joints[j]]}, frame {frame}, {axes[c]} is {values[n, j, c]}, "
            "not a number"
        )


def every_frame(listed: NDArray | None, count: int, total: int, who: str, what: str) -> NDArray:
    """The frames that are meant in a motion of `total` frames.

    Args:
        listed: what `check_frames` returned.
        count: how many values there are.
        total: frames of the motion.
        who: the function to name in an error message.
        what: the values, in the plural.
    """
    if listed is None:
        if count != total:
            raise ValueError(f"{who}: {count} {what} for a motion of {total} frames")
        return np.arange(total)
    return inside(listed, total, who)


def inside(listed: NDArray, total: int, who: str) -> NDArray:
    """Refuse a frame that a motion of `total` frames does not have."""
    outside = listed[(listed < 0) | (listed >= total)]
    if len(outside):
        raise ValueError(f"{who}: frame {outside[0]} is outside 0..{total - 1}")
    return listed


def in_words(frames: NDArray | None) -> str:
    """A short name for a list of frames."""
    if frames is None:
        return "every frame"
    if len(frames) <= 4:
        return "frame " + ", ".join(str(n) for n in frames)
    return f"{len(frames)} frames from {frames.min()} to {frames.max()}"


def how_exactly(std: float, unit: str = "m") -> str:
    """Say how hard a row is."""
    return "exactly" if std == 0 else f"within about {std:g} {unit}"
