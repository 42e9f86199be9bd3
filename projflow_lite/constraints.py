r"""What a person asks for, turned into linear rows ``A x = y``.

Every constraint is one function that returns a `Wish`; ``&`` stacks wishes. A wish knows nothing of
how long the motion will be until ``wish.rows(frames)`` writes its rows down:

.. math:: y = A x + \epsilon, \qquad \epsilon \sim \mathcal N(0, \Sigma)

with :math:`x` the motion in frame-major order, index ``(frame * 22 + joint) * 3 + axis``, metres,
and :math:`\Sigma` diagonal (ProjFlow eq. 4). A row of variance 0 is hard: it must hold exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse

from projflow_lite.skeleton import JOINTS, N_JOINTS, joint_index, joint_indices

AXES = "xyz"


class Rows(NamedTuple):
    """A linear wish about a motion of known length.

    Attributes:
        A: ``(m, frames * 22 * 3)`` sparse matrix.
        y: ``(m,)`` targets, metres.
        variance: ``(m,)`` variance of each target, square metres; 0 means exactly.
    """

    A: sparse.csr_matrix
    y: NDArray[np.float64]
    variance: NDArray[np.float64]


class Markers(NamedTuple):
    """The points of space that a wish names: one entry for each pinned frame and joint.

    Attributes:
        frame: ``(k,)`` frame of each point.
        joint: ``(k,)`` joint of each point.
        target: ``(k, 3)`` metres; NaN on an axis that is left free.
        std: ``(k,)`` standard deviation, metres; 0 means exactly.
    """

    frame: NDArray[np.int64]
    joint: NDArray[np.int64]
    target: NDArray[np.float64]
    std: NDArray[np.float64]


class Term(NamedTuple):
    """One constraint: a sentence for people, and the rows for a motion of a given length."""

    sentence: str
    build: Callable[[int], Rows]


@dataclass(frozen=True, repr=False)
class Wish:
    """One or several constraints, stacked with ``&``. Make one with `pin`, `offset` or `loop`."""

    terms: tuple[Term, ...]

    def __and__(self, other: Wish) -> Wish:
        """Ask for both."""
        if not isinstance(other, Wish):
            return NotImplemented
        return Wish(self.terms + other.terms)

    def __repr__(self) -> str:
        """Say in words what is asked for."""
        return "Wish: " + "; ".join(term.sentence for term in self.terms)

    def rows(self, frames: int) -> Rows:
        """Write the wish as rows for a motion of `frames` frames.

        Raises:
            ValueError: if a constraint names a frame that the motion does not have.
        """
        if not isinstance(frames, int | np.integer) or frames < 1:
            raise ValueError(f"rows: frames is a whole number of at least 1, not {frames!r}")
        parts = [term.build(int(frames)) for term in self.terms]
        return Rows(
            sparse.vstack([part.A for part in parts], format="csr"),
            np.concatenate([part.y for part in parts]),
            np.concatenate([part.variance for part in parts]),
        )

    def residual(self, positions: NDArray) -> float:
        """Largest ``|A x - y|`` over the hard rows, metres.

        Args:
            positions: ``(..., frames, 22, 3)``, metres.
        """
        A, y, variance = self.rows(positions.shape[-3])
        hard = variance == 0
        if not hard.any():
            return 0.0
        x = positions.reshape(-1, A.shape[1]).astype(np.float64)
        return float(np.abs(A[hard] @ x.T - y[hard, None]).max())

    def markers(self, frames: int) -> Markers:
        """Every point that the wish names, for drawing it: see `Markers`."""
        A, y, variance = self.rows(frames)
        single = is_coordinate(A)
        column = A.indices[A.indptr[:-1][single]]
        joint_frames, point = np.unique(column // 3, return_inverse=True)
        target = np.full((len(joint_frames), 3), np.nan)
        target[point, column % 3] = y[single]
        std = np.zeros(len(joint_frames))
        np.maximum.at(std, point, np.sqrt(variance[single]))
        return Markers(joint_frames // N_JOINTS, joint_frames % N_JOINTS, target, std)


def is_coordinate(A: sparse.csr_matrix) -> NDArray[np.bool_]:
    """Which rows of ``A`` read off a single coordinate, ``(m,)`` bool: one entry, equal to 1."""
    single = np.diff(A.indptr) == 1
    single[single] = A.data[A.indptr[:-1][single]] == 1.0
    return single


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
    columns = check_axes(axes)
    check_std(std)
    listed, single_frame = check_frames(frames)
    values = check_numbers(positions, "pin: positions")
    shape = values.shape if not single_frame else (1, *values.shape)
    wanted = ("frames" if listed is None else len(listed), *([len(joints)] * several), len(axes))
    if (
        len(shape) != len(wanted)
        or shape[1:] != wanted[1:]
        or wanted[0] not in ("frames", shape[0])
    ):
        text = ", ".join(str(n) for n in (wanted[1:] if single_frame else wanted))
        raise ValueError(f"pin: positions should have shape ({text}), not {values.shape}")
    values = values.reshape(shape[0], len(joints), len(axes))
    if not np.isfinite(values).all():
        n, j, c = np.argwhere(~np.isfinite(values))[0]
        frame = n if listed is None else listed[n]
        raise ValueError(
            f"pin: {JOINTS[joints[j]]}, frame {frame}, {axes[c]} is {values[n, j, c]}, not a number"
        )

    def build(total: int) -> Rows:
        every = np.arange(total) if listed is None else listed
        if len(every) != len(values):
            raise ValueError(f"pin: {len(values)} positions for a motion of {total} frames")
        inside(every, total, "pin")
        column = (every[:, None, None] * N_JOINTS + np.array(joints)[:, None]) * 3 + columns
        return coordinate_rows(column.ravel(), values.ravel(), total, std)

    names = " and ".join(JOINTS[j] for j in joints)
    when = "every frame" if listed is None else frames_in_words(listed)
    how = "exactly" if std == 0 else f"within about {std:g} m"
    return Wish((Term(f"{names} pinned in {axes} at {when}, {how}", build),))


def offset(
    joint_a: str | int, joint_b: str | int, d: ArrayLike, frames: Iterable[int] | None = None
) -> Wish:
    r"""Ask for a fixed vector between two joints: :math:`x_a - x_b = d` (ProjFlow eq. 35-36).

    Args:
        joint_a: where the vector ends.
        joint_b: where it begins; another joint than `joint_a`.
        d: ``(3,)`` the same in every frame, or ``(frames, 3)``, metres.
        frames: a list of frames, or None for every frame of the motion.

    Raises:
        ValueError: for an unknown joint, the same joint twice, a frame that is no frame, a shape
            that does not match or a value that is not finite.
    """
    a, b = joint_index(joint_a, "offset"), joint_index(joint_b, "offset")
    if a == b:
        raise ValueError(f"offset: {JOINTS[a]} is named twice; an offset needs two joints")
    listed, _ = check_frames(frames, "offset")
    vector = check_numbers(d, "offset: d")
    count = "frames" if listed is None else len(listed)
    if vector.shape != (3,) and (vector.ndim != 2 or vector.shape[1] != 3):
        raise ValueError(f"offset: d should have shape (3,) or ({count}, 3), not {vector.shape}")
    if not np.isfinite(vector).all():
        raise ValueError("offset: d has a value that is not finite")

    def build(total: int) -> Rows:
        every = np.arange(total) if listed is None else listed
        inside(every, total, "offset")
        if vector.ndim == 2 and len(vector) != len(every):
            raise ValueError(f"offset: {len(vector)} vectors for {len(every)} frames")
        targets = np.broadcast_to(vector, (len(every), 3)).ravel()
        plus = ((every[:, None] * N_JOINTS + a) * 3 + np.arange(3)).ravel()
        return difference_rows(plus, plus + (b - a) * 3, targets, total)

    when = "every frame" if listed is None else frames_in_words(listed)
    return Wish((Term(f"{JOINTS[a]} at a given offset from {JOINTS[b]} at {when}", build),))


def loop(
    joints: str | int | Sequence[str | int] | None = None, shift: ArrayLike | None = None
) -> Wish:
    r"""Ask that the last frame meet the first: :math:`x_{N-1} - x_0 = \text{shift}` (eq. 37-38).

    Args:
        joints: the joints that must meet; None for the whole body.
        shift: ``(3,)`` metres by which the body may have moved on; None for no shift.

    Raises:
        ValueError: for an unknown joint, or a shift that is not three finite numbers.
    """
    chosen = np.array(joint_indices(range(N_JOINTS) if joints is None else joints, "loop"))
    vector = np.zeros(3) if shift is None else check_numbers(shift, "loop: shift")
    if vector.shape != (3,) or not np.isfinite(vector).all():
        raise ValueError(f"loop: shift should be three finite numbers, not {shift!r}")

    def build(total: int) -> Rows:
        if total < 2:
            raise ValueError("loop: a loop needs at least two frames")
        first = (chosen[:, None] * 3 + np.arange(3)).ravel()
        last = first + (total - 1) * N_JOINTS * 3
        return difference_rows(last, first, np.tile(vector, len(chosen)), total)

    who = "the whole body" if joints is None else " and ".join(JOINTS[j] for j in chosen)
    return Wish((Term(f"{who} ends where it began", build),))


def coordinate_rows(columns: NDArray, y: NDArray, frames: int, std: float = 0.0) -> Rows:
    """Rows that read off single coordinates: ``x[columns] = y``."""
    m = len(columns)
    A = sparse.csr_matrix((np.ones(m), (np.arange(m), columns)), (m, frames * N_JOINTS * 3))
    return Rows(A, y, np.full(m, std**2))


def difference_rows(plus: NDArray, minus: NDArray, y: NDArray, frames: int) -> Rows:
    """Hard rows on differences of two coordinates: ``x[plus] - x[minus] = y``."""
    m = len(plus)
    entries = np.concatenate([np.ones(m), -np.ones(m)])
    index = (np.tile(np.arange(m), 2), np.concatenate([plus, minus]))
    A = sparse.csr_matrix((entries, index), (m, frames * N_JOINTS * 3))
    return Rows(A, y, np.zeros(m))


def describe_row(A: sparse.csr_matrix, row: int) -> str:
    """Say which joint, frame and axis a row is about."""
    parts = []
    for k in range(A.indptr[row], A.indptr[row + 1]):
        point, axis = divmod(A.indices[k], 3)
        frame, joint = divmod(point, N_JOINTS)
        weight = "" if A.data[k] == 1 else f"{A.data[k]:g} * "
        parts.append(f"{weight}{JOINTS[joint]}, frame {frame}, {AXES[axis]}")
    return " + ".join(parts)


def check_axes(axes: str) -> NDArray[np.int64]:
    """Turn "xz" into ``[0, 2]``, or refuse it."""
    if not isinstance(axes, str) or not axes or set(axes) - set(AXES) or len(set(axes)) < len(axes):
        raise ValueError(f"pin: axes is some of 'xyz', each once, not {axes!r}")
    return np.array([AXES.index(axis) for axis in axes])


def check_numbers(value: ArrayLike, what: str) -> NDArray[np.float64]:
    """An array of numbers, or an error that says what is not one."""
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"{what} should be a regular array of numbers") from None


def check_std(std: float) -> None:
    """Refuse a standard deviation that is negative or not finite."""
    if not isinstance(std, int | float | np.number) or not 0 <= std < np.inf:
        raise ValueError(f"pin: std is a length in metres, 0 or more, not {std!r}")


def check_frames(
    frames: int | Iterable[int] | None, who: str = "pin"
) -> tuple[NDArray | None, bool]:
    """Frames as an integer array (None stands for all of them), and whether it was just one."""
    if frames is None:
        return None, False
    if not isinstance(frames, int | np.integer | Iterable):
        raise ValueError(f"{who}: frames is an integer or a list of integers, not {frames!r}")
    listed = np.array([frames] if isinstance(frames, int | np.integer) else list(frames))
    if listed.ndim != 1 or len(listed) == 0 or listed.dtype.kind not in "iu":
        raise ValueError(f"{who}: frames is an integer or a list of integers, not {frames!r}")
    return listed.astype(np.int64), isinstance(frames, int | np.integer)


def inside(listed: NDArray, total: int, who: str) -> None:
    """Refuse a frame that a motion of `total` frames does not have."""
    outside = listed[(listed < 0) | (listed >= total)]
    if len(outside):
        raise ValueError(f"{who}: frame {outside[0]} is outside 0..{total - 1}")


def frames_in_words(listed: NDArray) -> str:
    """A short name for a list of frames."""
    if len(listed) <= 4:
        return "frame " + ", ".join(str(n) for n in listed)
    return f"{len(listed)} frames from {listed.min()} to {listed.max()}"
