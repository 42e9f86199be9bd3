r"""GMD's emphasis seen as ProjFlow's metric: where the two papers meet, and where they do not."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import real_array
from .gmd_emphasis import undoable
from .projection import ddnm


def nearest_emphasised(
    x0_proj: ArrayLike, S: ArrayLike, y: ArrayLike, A: ArrayLike, scale: float
) -> NDArray:
    r"""Meet a wish about the motion by the shortest way in projected space.

    .. math:: \tilde{x}_0^{proj} = T^{+} y + (I - T^{+} T)\, x_0^{proj}, \qquad
              T = S\, (k A)^{+}

    Args:
        x0_proj: ``(D,)``, one step of a projected motion.
        S: ``(m, N)``, rows that act on the step before it is projected.
        y: ``(m,)``, what they should give.
        A: ``(D, N)`` of full column rank.
        scale: k.

    Returns:
        ``(D,)``.

    Raises:
        ValueError: if shapes do not fit, k is 0 or A loses a direction for good.

    Source: ProjFlow eq. 21, in the projected space of GMD section 4.1.
    """
    A, k = undoable("nearest_emphasised", A, scale)
    S = real_array("nearest_emphasised", "S", S, (None, A.shape[1]))
    return ddnm(x0_proj, S @ np.linalg.pinv(k * A), y)


def emphasis_metric(A: ArrayLike, scale: float) -> NDArray:
    r"""Metric of a step in which distances are those of the projected space.

    .. math:: R = k^2 A^\top A, \qquad \lVert \delta \rVert_R = \lVert k A\, \delta \rVert_2

    Three things hold exactly, for every c. Noise that is white in projected space has covariance
    :math:`R^{-1}` in motion space; so emphasis raises the signal-to-noise ratio of its features,
    against that of the others, by :math:`c^2`: they settle earlier in a run. Guidance there is a
    gradient step with :math:`R^{-1}` in front. And `nearest_emphasised`, undone, is ProjFlow's
    `project` with this R and Sigma = 0, where the factor k drops out.

    GMD's own imputation is not that one. It overwrites coordinates (`impute`), which is `project`
    with R = I. The two agree for every wish only if the columns of A that are imputed are
    orthogonal to those that are free: then R does not couple them. That is so where A' has
    orthogonal columns, and in the limit of a very tall A', where R becomes a multiple of
    :math:`B^2`; a square Gaussian A' is never near that limit. Elsewhere a correction r of the
    imputed coordinates I moves the free ones F as well:

    .. math:: \delta_F = -R_{FF}^{-1} R_{FI}\, r
              = -B_F^{-1} (A_F'^\top A_F')^{-1} A_F'^\top A_I'\, B_I\, r

    That is c times as much as without emphasis if the imputed features are the emphasised ones,
    with no limit as c grows; and only 1 / c as much for a free feature that is emphasised.

    Args:
        A: ``(D, N)`` of full column rank; D = N in the paper.
        scale: k.

    Returns:
        ``(N, N)``, symmetric positive definite; steps of a motion do not couple.

    Raises:
        ValueError: if k is 0 or A loses a direction for good: then R is singular.

    Source: GMD section 4.1 (e), read as ProjFlow eq. 7.
    """
    A, k = undoable("emphasis_metric", A, scale)
    return k**2 * A.T @ A
