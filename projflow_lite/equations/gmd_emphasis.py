r"""A few features that count more: GMD section 4.1.

The matrix A acts on the features of every step by itself: ``A @ x`` with x ``(N, M)``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import one_of, real_array, same_shape, true_or_false
from .gmd_goals import feature_rows, fill_trajectory, motion_matrix


def emphasis_matrix(A_prime: ArrayLike, emphasised: Sequence[int], c: float) -> NDArray:
    r"""Mix all features at random, some of them c times as large as the others.

    .. math:: A = A' B, \qquad B_{jj} = c \text{ if } j \text{ is emphasised, else } 1

    Args:
        A_prime: ``(N, N)``, drawn from a standard normal distribution.
        emphasised: which features count more: in the paper rotation and ground location of the
            pelvis, 3 of N = 263.
        c: how much more, positive; 10 in the public code.

    Returns:
        ``(N, N)``. (More rows than columns are accepted, for the limit in `emphasis_metric`.)

    Raises:
        ValueError: if a feature does not exist or c is not positive.

    Source: GMD section 4.1 (a).
    """
    A_prime = real_array("emphasis_matrix", "A_prime", A_prime, (None, None))
    return A_prime * _weights("emphasis_matrix", A_prime.shape[1], emphasised, c)


def emphasis_scale(
    features: int, emphasised: Sequence[int], c: float, form: str = "derived"
) -> float:
    r"""Factor that brings the projected motion back to unit variance.

    .. math:: k = \frac{1}{\sqrt{N - 3 + 3 c^2}}

    One projected coordinate adds N independent terms, of variance :math:`c^2` or 1; 3 stands for
    however many features are emphasised. The variance is 1 on average over the draw of A'. A
    single coordinate's own has a standard deviation of about 0.44 at N = 263 and c = 10.

    Args:
        features: N.
        emphasised: which features count more.
        c: how much more, positive.
        form: ``"derived"`` as above, as also in the public code. ``"printed"`` leaves out the
            root, and the projected motion has a standard deviation of 0.042 instead of 1.

    Raises:
        ValueError: if a feature does not exist or c is not positive.

    Source: GMD section 4.1 (a).
    """
    one_of("emphasis_scale", form, ("printed", "derived"))
    total = float((_weights("emphasis_scale", features, emphasised, c) ** 2).sum())
    return 1 / total if form == "printed" else 1 / np.sqrt(total)


def emphasise(x: ArrayLike, A: ArrayLike, scale: float) -> NDArray:
    r"""Project a motion.

    .. math:: x^{proj} = k A x

    Args:
        x: ``(..., N, M)``, normalised to unit variance per feature.
        A: ``(N, N)``, from `emphasis_matrix`.
        scale: k, from `emphasis_scale`.

    Returns:
        ``(..., N, M)``.

    Raises:
        ValueError: if shapes do not fit.

    Source: GMD section 4.1 (a).
    """
    A = real_array("emphasise", "A", A, (None, None))
    x = motion_matrix("emphasise", "x", x)
    if x.shape[-2] != A.shape[1]:
        raise ValueError(f"emphasise: x has {x.shape[-2]} features, A expects {A.shape[1]}")
    return scale * (A @ x)


def unemphasise(x_proj: ArrayLike, A: ArrayLike, scale: float, form: str = "derived") -> NDArray:
    r"""Undo the projection, its factor included.

    .. math:: x = \frac{1}{k} A^{+} x^{proj}

    A square random matrix is far from orthogonal: at N = 263 the largest stretch is typically
    more than a thousand times the smallest, so errors in some directions grow a lot.

    Args:
        x_proj: ``(..., N, M)``.
        A: ``(N, N)`` of full rank; :math:`A^{+}` is its inverse.
        scale: k, from `emphasis_scale`.
        form: ``"derived"`` as above. ``"printed"`` leaves out the factor and returns k x.

    Returns:
        ``(..., N, M)``.

    Raises:
        ValueError: if shapes do not fit, k is 0 or A loses a direction for good.

    Source: GMD section 4.1 (d).
    """
    one_of("unemphasise", form, ("printed", "derived"))
    A, k = undoable("unemphasise", A, scale)
    x_proj = motion_matrix("unemphasise", "x_proj", x_proj)
    if x_proj.shape[-2] != len(A):
        raise ValueError(f"unemphasise: x_proj has {x_proj.shape[-2]} features, A gives {len(A)}")
    x = np.linalg.pinv(A) @ x_proj
    return x if form == "printed" else x / k


def impute(x0: ArrayLike, z: ArrayLike, mask: ArrayLike, rows: Sequence[int]) -> NDArray:
    r"""Overwrite what is known of a predicted motion.

    .. math:: \tilde{x}_0 = (1 - M_z^x) \odot x_{0,\theta} + M_z^x \odot P_z^x z^*

    Args:
        x0: ``(N, M)``, the predicted clean motion.
        z: ``(L, M)``, the wanted trajectory, anything finite where nothing is imputed.
        mask: booleans ``(N, M)``, from `imputation_region`.
        rows: which L features of the motion are the trajectory.

    Returns:
        ``(N, M)``.

    Raises:
        ValueError: if shapes do not fit or the mask leaves the trajectory's rows.

    Source: GMD section 4.1 (c).
    """
    x0 = real_array("impute", "x0", x0, (None, None))
    x0, M, wanted = same_shape("impute", x0=x0, mask=mask, z=fill_trajectory(z, rows, len(x0)))
    M = true_or_false("impute", "mask", M)
    for row in set(np.flatnonzero(M.any(axis=1))) - set(feature_rows("impute", rows, len(x0))):
        raise ValueError(f"impute: mask covers feature {row}, which z says nothing about")
    return np.where(M, wanted, x0)


def impute_emphasised(
    x0_proj: ArrayLike,
    z: ArrayLike,
    mask: ArrayLike,
    rows: Sequence[int],
    A: ArrayLike,
    scale: float,
    form: str = "derived",
) -> NDArray:
    r"""Overwrite what is known of a projected motion.

    .. math:: \tilde{x}_0^{proj} = k A \bigl((1 - M_z^x) \odot (\tfrac{1}{k} A^{-1} x_0^{proj})
              + M_z^x \odot P_z^x z^*\bigr)

    Seen in motion space this is `impute`, whatever A and c are: see `emphasis_metric`.

    Args:
        x0_proj: ``(N, M)``, the predicted clean motion, projected.
        z: ``(L, M)``, the wanted trajectory, not projected.
        mask: booleans ``(N, M)``, in motion space.
        rows: which L features of the motion are the trajectory.
        A: ``(N, N)``.
        scale: k.
        form: ``"derived"`` as above. ``"printed"`` has no factor on either side; the trajectory
            then arrives 1 / k times too large, 24 times at N = 263 and c = 10.

    Returns:
        ``(N, M)``.

    Raises:
        ValueError: as `impute` and `unemphasise`.

    Source: GMD section 4.1 (e).
    """
    one_of("impute_emphasised", form, ("printed", "derived"))
    k = 1.0 if form == "printed" else scale
    return emphasise(impute(unemphasise(x0_proj, A, k), z, mask, rows), A, k)


def _weights(who: str, features: int, emphasised: Sequence[int], c: float) -> NDArray:
    """Return the diagonal of B."""
    if not 0 < c < np.inf:
        raise ValueError(f"{who}: c = {c}, expected a positive number")
    weights = np.ones(features)
    weights[feature_rows(who, emphasised, features)] = c
    return weights


def undoable(who: str, A: ArrayLike, scale: float) -> tuple[NDArray, float]:
    """Refuse a projection that cannot be undone."""
    A = real_array(who, "A", A, (None, None))
    if not np.isfinite(scale) or scale == 0:
        raise ValueError(f"{who}: scale is {scale}, expected a number other than 0")
    if np.linalg.matrix_rank(A) < A.shape[1]:
        raise ValueError(f"{who}: columns of A are dependent, so it cannot be undone")
    return A, float(scale)
