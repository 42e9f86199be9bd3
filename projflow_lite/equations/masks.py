r"""Observing some coordinates and not others: ProjFlow eq. 12, 13, and the halo around keyframes.

A mask M is a d × d diagonal matrix of zeros and ones that acts on a motion written as a vector
(see `vectorise`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import diagonal_mask, one_of, real_array, same_shape, true_or_false


def observation_mask(observed: ArrayLike) -> NDArray:
    r"""Diagonal matrix with a 1 wherever a coordinate is observed.

    .. math:: M_{obs} = \mathrm{diag}(m), \qquad m_i \in \{0, 1\}

    Args:
        observed: booleans, ``(N, J, 3)``.

    Returns:
        ``(d, d)``.

    Raises:
        ValueError: if an entry is neither true nor false.

    Source: ProjFlow eq. 12.
    """
    m = true_or_false("observation_mask", "observed", observed).ravel()
    return np.diag(m.astype(np.float64))


def masked_observation(x: ArrayLike, M_obs: ArrayLike) -> NDArray:
    r"""Keep observed coordinates, put zeros elsewhere.

    .. math:: y_{obs} = M_{obs}\, x

    Args:
        x: ``(d,)``.
        M_obs: ``(d, d)``, from `observation_mask`.

    Returns:
        ``(d,)``.

    Raises:
        ValueError: if shapes do not fit or `M_obs` is not a mask.

    Source: ProjFlow eq. 12.
    """
    x = real_array("masked_observation", "x", x, (None,))
    return diagonal_mask("masked_observation", "M_obs", M_obs, len(x)) @ x


def selection_rows(observed: ArrayLike, form: str = "derived") -> NDArray:
    r"""Rows that pick the observed coordinates: eq. 12 without its empty rows.

    .. math:: A = \text{the rows } i \text{ of } I_d \text{ with } m_i = 1

    Args:
        observed: booleans, any shape: ``(N, J, 3)`` for coordinates of a motion.
        form: ``"derived"`` as above. ``"released"`` looks at the x axis alone, as the public
            code does, and takes its word for y and z: wrong for a wish about one axis.

    Returns:
        ``(m, d)``, one row per observed coordinate, in the order of the vector.

    Raises:
        ValueError: if an entry is neither true nor false.

    Source: ProjFlow eq. 12, and the selection of rows in eq. 20.
    """
    one_of("selection_rows", form, ("derived", "released"))
    observed = true_or_false("selection_rows", "observed", observed)
    if form == "released":
        observed = np.broadcast_to(observed[..., :1], observed.shape)
    return np.eye(observed.size)[observed.ravel()]


def combined_observation(
    M_obs: ArrayLike, M_aug: ArrayLike, y_obs: ArrayLike, y_src: ArrayLike
) -> tuple[NDArray, NDArray]:
    r"""Put guides beside what is observed.

    .. math:: M^{(t)} = M_{obs} + M_{aug}^{(t)}, \qquad y^{(t)} = y_{obs} + M_{aug}^{(t)} y_{src}

    Args:
        M_obs: ``(d, d)``, mask of what is observed.
        M_aug: ``(d, d)``, mask of the active guides; shares no coordinate with `M_obs`.
        y_obs: ``(d,)``, observed values, zeros elsewhere.
        y_src: ``(d,)``, guide values, from `interpolate_observations`.

    Returns:
        M ``(d, d)`` and y ``(d,)``.

    Raises:
        ValueError: if shapes do not fit, a matrix is not a mask, the two overlap, or `y_obs` has a
            value where nothing is observed.

    Source: ProjFlow eq. 13.
    """
    y_obs, y_src = same_shape("combined_observation", y_obs=y_obs, y_src=y_src)
    M_obs = diagonal_mask("combined_observation", "M_obs", M_obs, len(y_obs))
    M_aug = diagonal_mask("combined_observation", "M_aug", M_aug, len(y_obs))
    if (M_obs * M_aug).any():
        raise ValueError("combined_observation: M_obs and M_aug share a coordinate")
    if (M_obs @ y_obs != y_obs).any():
        raise ValueError("combined_observation: y_obs is not zero where nothing is observed")
    return M_obs + M_aug, y_obs + M_aug @ y_src


def halo(observed: ArrayLike, radius: float) -> NDArray:
    r"""Where guides are active: near an observed frame of the same column, but not on it.

    .. math:: 0 < \min_{m \text{ observed}} |n - m| < \ell(t)

    Args:
        observed: booleans, ``(N, ...)``.
        radius: :math:`\ell(t)`, frames.

    Returns:
        Booleans, same shape.

    Raises:
        ValueError: if an entry is neither true nor false.

    Source: ProjFlow section 4.3.1, the text below eq. 13 and 14.
    """
    observed = true_or_false("halo", "observed", observed)
    near, n = np.zeros_like(observed), np.arange(len(observed))
    for m in n:
        frames = np.abs(n - m) < radius
        near[frames] |= observed[m]
    return near & ~observed
