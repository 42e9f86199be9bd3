r"""Round obstacles on the ground, for GMD's third task.

The paper's overview names the task; the penalty below is read off the public code.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import one_of, real_array


def signed_distance(z: ArrayLike, centres: ArrayLike, radii: ArrayLike) -> NDArray:
    r"""Distance to the nearest circle, negative inside one.

    .. math:: d(z^{(i)}) = \min_k \bigl(\lVert z^{(i)} - c_k \rVert_2 - r_k\bigr)

    Inside several circles at once it names the deepest of them; the way out of their union can
    be longer.

    Args:
        z: ``(L, M)``, a trajectory, metres.
        centres: ``(K, L)``, metres; at least one.
        radii: ``(K,)``, metres.

    Returns:
        ``(M,)``, metres.

    Raises:
        ValueError: if shapes do not fit, there is no circle or a radius is negative.

    Source: GMD section 4, the task of avoiding obstacles.
    """
    z, c, r = _circles("signed_distance", z, centres, radii)
    return (np.linalg.norm(z.T[:, None] - c, axis=-1) - r).min(axis=1)


def obstacle_goal(
    z: ArrayLike,
    centres: ArrayLike,
    radii: ArrayLike,
    margin: float = 0.0,
    form: str = "derived",
) -> float:
    r"""How deep a trajectory is inside obstacles, summed over steps.

    .. math:: G_z(z) = \sum_i \max\bigl(m - d(z^{(i)}),\, 0\bigr)

    Args:
        z: ``(L, M)``, metres.
        centres: ``(K, L)``, metres.
        radii: ``(K,)``, metres.
        margin: m, how far to stay away from every circle, metres.
        form: ``"derived"`` as above. ``"released"`` adds the depths of all circles that a point is
            in, takes the mean over steps and five times that.

    Raises:
        ValueError: as `signed_distance`.

    Source: GMD section 4, the task of avoiding obstacles.
    """
    one_of("obstacle_goal", form, ("derived", "released"))
    if form == "derived":
        return float(np.maximum(margin - signed_distance(z, centres, radii), 0).sum())
    z, c, r = _circles("obstacle_goal", z, centres, radii)
    depth = np.maximum(margin + r - np.linalg.norm(z.T[:, None] - c, axis=-1), 0)
    return float(5 * depth.sum(axis=1).mean())


def obstacle_gradient(
    z: ArrayLike, centres: ArrayLike, radii: ArrayLike, margin: float = 0.0
) -> NDArray:
    r"""Direction in which the obstacle goal grows fastest: towards the centre, at length 1.

    .. math:: \nabla_z G_z = -\frac{z^{(i)} - c_k}{\lVert z^{(i)} - c_k \rVert_2}
              \text{ where } d(z^{(i)}) < m,\; k \text{ the nearest circle}

    Args:
        z: ``(L, M)``, metres.
        centres: ``(K, L)``, metres.
        radii: ``(K,)``, metres.
        margin: m, metres.

    Returns:
        ``(L, M)``; 0 outside, and 0 in the very centre, where every way out is as long.

    Raises:
        ValueError: as `signed_distance`.

    Source: the gradient of `obstacle_goal`.
    """
    z, c, r = _circles("obstacle_gradient", z, centres, radii)
    away = z.T[:, None] - c
    length = np.linalg.norm(away, axis=-1)
    k, i = (length - r).argmin(axis=1), np.arange(z.shape[1])
    away, length = away[i, k], length[i, k]
    active = (length - r[k] < margin) & (length > 0)
    return -(away * (active / np.where(length > 0, length, 1))[:, None]).T


def _circles(
    who: str, z: ArrayLike, centres: ArrayLike, radii: ArrayLike
) -> tuple[NDArray, NDArray, NDArray]:
    """Check a trajectory and circles beside it."""
    z = real_array(who, "z", z, (None, None))
    c = real_array(who, "centres", centres, (None, len(z)))
    r = real_array(who, "radii", radii, (len(c),))
    if len(c) == 0 or (r < 0).any():
        raise ValueError(f"{who}: expected at least one circle and no negative radius")
    return z, c, r
