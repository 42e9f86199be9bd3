"""What a person may pass to a constraint, and what is said when it is something else."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Set
from numbers import Real

import numpy as np
from numpy.typing import ArrayLike, NDArray

from projflow_lite.constraints.wish import AXES
from projflow_lite.skeleton import JOINTS, number_array, shown


def check_axes(axes: str, who: str = "pin") -> NDArray[np.int64]:
    """Turn "xz" into ``[0, 2]``, or refuse it."""
    if not isinstance(axes, str) or not axes or set(axes) - set(AXES) or len(set(axes)) < len(axes):
        raise ValueError(f"{who}: axes is some of 'xyz', each once, not {shown(axes)}")
    return np.array([AXES.index(axis) for axis in axes])


def check_numbers(value: ArrayLike, what: str) -> NDArray[np.float64]:
    """A float64 array of its own, or an error that says what is not one."""
    return number_array(value, what).astype(np.float64)


def is_number(value: object) -> bool:
    """Whether it is one finite real number; True and False are none."""
    number = isinstance(value, Real) and not isinstance(value, bool)
    return number and math.isfinite(value)  # type: ignore[arg-type]


def check_yes_or_no(who: str, **flags: bool) -> None:
    """Refuse what is neither True nor False: any text would count as True."""
    for name, flag in flags.items():
        if not isinstance(flag, bool | np.bool_):
            raise ValueError(f"{who}: {name} is True or False, not {shown(flag)}")


def check_std(std: float, who: str = "pin", unit: str = "a length in metres") -> None:
    """Refuse a standard deviation that is negative or not finite."""
    if not is_number(std) or std < 0:
        raise ValueError(f"{who}: std is {unit}, 0 or more, not {shown(std)}")
    # Its square has to be a number too: one that vanishes would make a soft row hard.
    if std != 0 and not 1e-100 < std < 1e100:
        raise ValueError(f"{who}: a std of {std!r} has no square; 0 means exactly")


def check_frames(
    frames: int | Iterable[int] | None, who: str = "pin"
) -> tuple[NDArray | None, bool]:
    """Frames as an integer array (None stands for all of them), and whether it was just one."""
    if frames is None:
        return None, False
    single = isinstance(frames, int | np.integer)
    # A set has no order in which positions could belong to its frames; 0-d arrays do not iterate.
    several = isinstance(frames, Iterable) and not isinstance(frames, str | Set | Mapping)
    listed: list = [frames] if single else []
    if several and np.ndim(frames) > 0:  # type: ignore[arg-type]
        listed = list(frames)  # type: ignore[arg-type]
    whole = all(isinstance(n, int | np.integer) and not isinstance(n, bool) for n in listed)
    if not listed or not whole or max(abs(n) for n in listed) > 2**31:
        raise ValueError(f"{who}: frames is an integer or a list of integers, not {shown(frames)}")
    return np.array(listed, dtype=np.int64), single


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
