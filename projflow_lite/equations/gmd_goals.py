r"""What a motion should reach, as a number: GMD section 4.

GMD writes a motion as a matrix x of N features by M steps. Some of its rows are the trajectory z,
a matrix of L features by M steps, such as the ground location of the pelvis (L = 2).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import real_array

Goal = Callable[[NDArray], float]


def goal_conditioned(samples: ArrayLike, goal: Goal, tolerance: float) -> NDArray:
    r"""Keep the motions that reach a goal: conditioning, by its definition as a limit.

    .. math:: p(x \mid G_x(X) = 0) = p(x \mid G_x(X) \le \tau) \text{ in the limit } \tau = 0

    Where reaching the goal exactly has probability 0, the limit depends on the goal itself and
    not only on its zeros: multiplying G by a positive function of x changes the answer.

    Args:
        samples: ``(K, N, M)``, draws of p(x).
        goal: function of one motion ``(N, M)`` that returns a number, 0 where it is reached.
        tolerance: :math:`\tau`, in the unit of the goal.

    Returns:
        ``(k, N, M)``, those with a goal of at most `tolerance`, in their order.

    Raises:
        ValueError: if samples have another number of axes or the tolerance is negative.

    Source: GMD section 4 (a).
    """
    samples = real_array("goal_conditioned", "samples", samples, (None, None, None))
    if not tolerance >= 0:
        raise ValueError(f"goal_conditioned: tolerance is {tolerance}, expected 0 or more")
    reached = np.array([goal(x) <= tolerance for x in samples], dtype=bool)
    return samples[reached]


def motion_goal(x: ArrayLike, goal: Goal, rows: Sequence[int]) -> float:
    r"""Goal of a motion that only looks at its trajectory.

    .. math:: G_x(x) = G_z(P_x^z\, x)

    Args:
        x: ``(N, M)``.
        goal: :math:`G_z`, function of a trajectory ``(L, M)`` that returns a number.
        rows: which L features of x are the trajectory.

    Raises:
        ValueError: if a row does not exist.

    Source: GMD section 4 (b).
    """
    return float(goal(take_trajectory(x, rows)))


def take_trajectory(x: ArrayLike, rows: Sequence[int]) -> NDArray:
    r"""Take the trajectory out of a motion.

    .. math:: P_x^z\, x = (x_{r_1}, \dots, x_{r_L})

    Args:
        x: ``(..., N, M)``.
        rows: which L features are the trajectory, in the order of z.

    Returns:
        ``(..., L, M)``.

    Raises:
        ValueError: if a row does not exist or is named twice.

    Source: GMD section 4 (c).
    """
    x = motion_matrix("take_trajectory", "x", x)
    return x[..., feature_rows("take_trajectory", rows, x.shape[-2]), :]


def fill_trajectory(z: ArrayLike, rows: Sequence[int], features: int) -> NDArray:
    r"""Put a trajectory into an otherwise empty motion: the transpose of taking it out.

    .. math:: P_z^x\, z = (P_x^z)^\top z

    Args:
        z: ``(..., L, M)``.
        rows: where the L features go, in the order of z.
        features: N, features of the motion.

    Returns:
        ``(..., N, M)``, zeros outside the rows.

    Raises:
        ValueError: if a row does not exist or z has another number of rows.

    Source: GMD section 4 (d).
    """
    z = motion_matrix("fill_trajectory", "z", z)
    index = feature_rows("fill_trajectory", rows, features)
    if z.shape[-2] != len(index):
        raise ValueError(
            f"fill_trajectory: z has {z.shape[-2]} features, expected {len(index)}, one per row"
        )
    x = np.zeros((*z.shape[:-2], features, z.shape[-1]))
    x[..., index, :] = z
    return x


def motion_matrix(who: str, name: str, value: ArrayLike) -> NDArray:
    """Return a finite array of features by steps, with any axes before them."""
    matrix = real_array(who, name, value)
    if matrix.ndim < 2:
        raise ValueError(f"{who}: {name} has shape {matrix.shape}, expected (..., features, steps)")
    return matrix


def feature_rows(who: str, rows: Sequence[int], features: int) -> NDArray:
    """Return row numbers that exist and differ."""
    index = np.asarray(rows, dtype=int).reshape(-1)
    for row in index[(index < 0) | (index >= features)]:
        raise ValueError(f"{who}: row {row} is outside 0..{features - 1}")
    if len(np.unique(index)) < len(index):
        raise ValueError(f"{who}: a row is named twice in {index}")
    return index
