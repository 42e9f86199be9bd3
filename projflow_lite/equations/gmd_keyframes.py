r"""Being somewhere at some time: GMD section 5.2.

A keyframe fixes the trajectory z ``(L, M)`` at one of its M steps; a mask says where.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import one_of, real_array, same_shape, true_or_false, whole_number
from .gmd_goals import fill_trajectory, motion_matrix, take_trajectory


def keyframe_goal(
    z: ArrayLike, y: ArrayLike, mask: ArrayLike, p: float = 1.0, form: str = "derived"
) -> float:
    r"""How far a trajectory is from its keyframes, summed over steps.

    .. math:: G_z(z) = \sum_i \lVert (M_y \odot (z - y))^{(i)} \rVert_p

    Args:
        z: ``(L, M)``.
        y: ``(L, M)``, wanted values, anything finite where the mask is false.
        mask: booleans ``(L, M)``, :math:`M_y`.
        p: which norm, from 1 on. The paper leaves it open.
        form: ``"derived"`` as above. ``"printed"`` multiplies the mask and the difference as
            matrices, which is possible only if L = M and then means nothing. ``"released"`` is the
            mean over observed coordinates at p = 1.

    Raises:
        ValueError: if shapes differ, p is below 1, or the form has no value for these arguments.

    Source: GMD section 5.2 (a).
    """
    one_of("keyframe_goal", form, ("printed", "derived", "released"))
    z, y, M_y, p = _keyframes("keyframe_goal", z, y, mask, p)
    if form == "printed":
        if M_y.shape[1] != len(z):
            raise ValueError(f"keyframe_goal: M_y {M_y.shape} times z - y {z.shape} has no value")
        return float(np.linalg.norm(M_y @ (z - y), p, axis=0).sum())
    total = float(np.linalg.norm(M_y * (z - y), p, axis=0).sum())
    if form == "derived":
        return total
    if p != 1 or not M_y.any():
        raise ValueError("keyframe_goal: the released form needs p = 1 and a keyframe")
    return total / float(M_y.sum())


def keyframe_goal_of_motion(
    x: ArrayLike,
    y: ArrayLike,
    mask: ArrayLike,
    rows: Sequence[int],
    p: float = 1.0,
    form: str = "derived",
) -> float:
    r"""How far the trajectory of a motion is from its keyframes.

    .. math:: G_x(x) = \sum_i \lVert (M_y \odot (P_x^z x - y))^{(i)} \rVert_p

    Args:
        x: ``(N, M)``.
        y: ``(L, M)``, wanted values.
        mask: booleans ``(L, M)``.
        rows: which L features of x are the trajectory.
        p: which norm, from 1 on.
        form: ``"derived"``, ``"printed"`` or ``"released"``, see `keyframe_goal`.

    Raises:
        ValueError: as `take_trajectory` and `keyframe_goal`.

    Source: GMD eq. 12.
    """
    return keyframe_goal(take_trajectory(x, rows), y, mask, p, form)


def keyframe_gradient(z: ArrayLike, y: ArrayLike, mask: ArrayLike, p: float = 1.0) -> NDArray:
    r"""Direction in which the keyframe goal grows fastest.

    .. math:: \nabla_z G_z = \frac{e\, |e|^{p-2}}{\lVert e \rVert_p^{p-1}} \text{ step by step},
              \qquad e = M_y \odot (z - y)

    Its size does not depend on the distance: at p = 1 every entry is -1, 0 or 1.

    Args:
        z: ``(L, M)``.
        y: ``(L, M)``, wanted values.
        mask: booleans ``(L, M)``.
        p: which norm, from 1 on.

    Returns:
        ``(L, M)``; 0 where a keyframe is met, the middle of the possible slopes there.

    Raises:
        ValueError: if shapes differ or p is below 1.

    Source: the gradient of GMD section 5.2 (a).
    """
    z, y, M_y, p = _keyframes("keyframe_gradient", z, y, mask, p)
    e = M_y * (z - y)
    size = np.linalg.norm(e, p, axis=0)
    return np.sign(e) * (np.abs(e) / np.where(size > 0, size, 1)) ** (p - 1)


def imputation_region(
    mask: ArrayLike, rows: Sequence[int], features: int, form: str = "derived"
) -> NDArray:
    r"""Where on a motion the keyframes of a trajectory are imputed.

    .. math:: M_y^x = P_z^x\, M_y^z

    Args:
        mask: booleans ``(L, M)``, where the trajectory is known.
        rows: which L features of the motion are the trajectory.
        features: N.
        form: ``"derived"`` as above. ``"printed"`` uses :math:`P_x^z`, which takes rows out of a
            motion and cannot act on L rows unless L = N.

    Returns:
        Booleans ``(N, M)``.

    Raises:
        ValueError: if shapes do not fit, as they never do in the printed form with L below N.

    Source: GMD section 5.2 (b).
    """
    one_of("imputation_region", form, ("printed", "derived"))
    known = true_or_false("imputation_region", "mask", mask)
    if form == "derived":
        return fill_trajectory(known, rows, features).astype(bool)
    if len(known) != features:
        raise ValueError(f"imputation_region: P_x^z acts on {features} rows, not on {len(known)}")
    return take_trajectory(known, rows).astype(bool)


def point_to_point(
    frames: Sequence[int], positions: ArrayLike, steps: int, form: str = "derived"
) -> tuple[NDArray, NDArray]:
    r"""Straight lines from each keyframe to the next.

    .. math:: z^{(i)} = \frac{(n' - i)\, y^{(n)} + (i - n)\, y^{(n')}}{n' - n},
              \qquad n \le i \le n' \text{ consecutive keyframes}

    Args:
        frames: K steps at which there is a keyframe, increasing, counted from 0.
        positions: ``(K, L)``, where to be then.
        steps: M.
        form: ``"derived"`` as above. ``"released"`` also starts from the origin at step 0.

    Returns:
        z ``(L, M)`` and booleans ``(L, M)``: false, with zeros in z, before the first keyframe
        and after the last.

    Raises:
        ValueError: if frames do not increase or leave 0..M - 1, or shapes do not fit.

    Source: GMD section 5.2 (c).
    """
    one_of("point_to_point", form, ("derived", "released"))
    n = np.asarray(frames, dtype=int)
    y = real_array("point_to_point", "positions", positions, (len(n), None))
    i = np.arange(whole_number("point_to_point", "steps", steps))
    if len(n) == 0 or (np.diff(n) <= 0).any() or n[0] < 0 or n[-1] >= steps:
        raise ValueError(f"point_to_point: frames {n} must increase within 0..{steps - 1}")
    if form == "released" and n[0] > 0:
        n, y = np.append(0, n), np.vstack([np.zeros(y.shape[1]), y])
    between = (i >= n[0]) & (i <= n[-1])
    lines = np.array([np.interp(i, n, axis) for axis in y.T])
    return lines * between, np.broadcast_to(between, lines.shape)


def _keyframes(
    who: str, z: ArrayLike, y: ArrayLike, mask: ArrayLike, p: float
) -> tuple[NDArray, NDArray, NDArray, float]:
    """Check what a goal of keyframes is made of; the mask comes back as zeros and ones."""
    z, y, M_y = same_shape(who, z=z, y=y, mask=mask)
    if not 1 <= p < np.inf:
        raise ValueError(f"{who}: p = {p}, expected a finite number from 1 on")
    motion_matrix(who, "z", z)
    return z, y, true_or_false(who, "mask", M_y).astype(np.float64), float(p)
