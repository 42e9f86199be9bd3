r"""Guides between sparse keyframes, and how far to trust them: ProjFlow eq. 14–17, 48 and 52.

Frames come first: observed flags and values are ``(N, ...)``, one per joint ``(N, J)`` or one
per coordinate ``(N, J, 3)``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import fraction, one_of, positive_definite, real_array, true_or_false

TABLE_5 = {
    "w_kin": 10.0, "ridge": 1.0, "l_min": 3.0, "l_max": 10.0, "tau_min": 0.1, "c0": 3.0,
    "lambda_s": 1.0, "p": 2.0, "pi_min": 0.02, "pi_max": 1.0, "steps": 100,
}  # fmt: skip
"""The constants that ProjFlow's Table 5 lists for inpainting, under the names used here."""


def interpolate_observations(y: ArrayLike, observed: ArrayLike) -> tuple[NDArray, NDArray]:
    r"""Straight lines between observed frames, copies before the first and after the last.

    .. math:: y_{src, n} = \frac{(n_+ - n)\, y_{n_-} + (n - n_-)\, y_{n_+}}{n_+ - n_-},
              \qquad n_- < n < n_+ \text{ the nearest observed frames}

    Args:
        y: ``(N, ...)``, observed values, anything finite elsewhere.
        observed: booleans, one per value or, as ``(N, J)``, one per joint.

    Returns:
        Guides ``(N, ...)`` and booleans of the same shape, false where a column was never
        observed and so has no guide (its entries are 0).

    Raises:
        ValueError: if shapes do not fit.

    Source: ProjFlow section B.2.1.
    """
    y = real_array("interpolate_observations", "y", y)
    observed = true_or_false("interpolate_observations", "observed", observed)
    if observed.ndim == 0 or observed.shape != y.shape[: observed.ndim]:
        raise ValueError(f"interpolate_observations: flags {observed.shape}, values {y.shape}")
    per_axis = observed.reshape(observed.shape + (1,) * (y.ndim - observed.ndim))
    observed = np.broadcast_to(per_axis, y.shape)
    y_src, n = np.zeros_like(y), np.arange(len(y))
    for place in np.ndindex(y.shape[1:]):
        column = (slice(None), *place)
        seen = observed[column]
        if seen.any():
            y_src[column] = np.interp(n, n[seen], y[column][seen])
    return y_src, np.broadcast_to(observed.any(axis=0), y.shape)


def halo_radius(t: ArrayLike, l_min: float, l_max: float) -> NDArray:
    r"""How many frames around a keyframe the guides reach at time t.

    .. math:: \ell(t) = (1 - t)\, \ell_{max} + t\, \ell_{min}

    It ends at :math:`\ell_{min}`. With the 3 of Table 5, guides two frames to either side of a
    keyframe never vanish, whatever the surrounding text says; they do only for a radius of at
    most 1.

    Args:
        t: flow time in [0, 1], any shape.
        l_min: radius at the end, frames.
        l_max: radius at the start, frames.

    Raises:
        ValueError: if `t` leaves [0, 1] or the radii are not 0 <= l_min <= l_max.

    Source: ProjFlow eq. 14.
    """
    t = fraction("halo_radius", "t", t)
    if not 0 <= l_min <= l_max < np.inf:
        raise ValueError(f"halo_radius: expected 0 <= l_min <= l_max, got {l_min} and {l_max}")
    return (1 - t) * l_max + t * l_min


def time_decay(t: ArrayLike, tau_min: ArrayLike) -> NDArray:
    r"""Trust that every guide loses as sampling goes on.

    .. math:: \tau(t) = \tau_{min} + (1 - \tau_{min})(1 - t)

    Args:
        t: flow time in [0, 1], any shape.
        tau_min: what is left at the end, a number in [0, 1].

    Raises:
        ValueError: if an argument leaves [0, 1].

    Source: ProjFlow eq. 16.
    """
    t, tau_min = fraction("time_decay", "t", t), fraction("time_decay", "tau_min", tau_min)
    return tau_min + (1 - tau_min) * (1 - t)


def curvature(x1_hat: ArrayLike, R_J: ArrayLike) -> NDArray:
    r"""How sharply the predicted motion bends at each frame, in the skeleton's metric.

    .. math:: s_n = \lVert x_{n+1} - 2 x_n + x_{n-1} \rVert_R, \qquad
              \lVert a \rVert_R^2 = \sum_c a_c^\top R_J\, a_c

    The norm takes the block of R that belongs to one frame: R itself has the size of a whole
    motion. The first and last frame have one neighbour only and copy the value beside them, as
    the public code does; fewer than three frames do not bend, and give zeros.

    Args:
        x1_hat: ``(N, J, 3)``, metres.
        R_J: ``(J, J)``, from `joint_metric`.

    Returns:
        ``(N,)``, metres per frame squared times the square root of the metric's weight.

    Raises:
        ValueError: if shapes do not fit or R_J is not positive definite.

    Source: ProjFlow eq. 17.
    """
    x = real_array("curvature", "x1_hat", x1_hat, (None, None, 3))
    R_J = real_array("curvature", "R_J", R_J, (x.shape[1], x.shape[1]))
    positive_definite("curvature", "R_J", R_J)
    if len(x) < 3:
        return np.zeros(len(x))
    a = x[2:] - 2 * x[1:-1] + x[:-2]
    s = np.sqrt(np.einsum("njc,jk,nkc->n", a, R_J, a))
    return np.concatenate([s[:1], s, s[-1:]])


def frame_trust(
    s: ArrayLike,
    t: ArrayLike,
    c0: float,
    lambda_s: float,
    p: float,
    tau_min: float,
    form: str = "printed",
) -> NDArray:
    r"""Trust in the guides of each frame: less where the motion bends, less as time goes on.

    .. math:: \tilde\pi_n = \tau(t)\, \frac{c_0}{1 + \lambda_s (s_n / s_{med})^p}

    It is not clipped, and at the start it exceeds 1 for ordinary frames: with Table 5 it is 1.5
    at the median curvature and 3 where nothing bends. Where the median is 0, at least half of
    the frames do not bend: those count as ratio 0, all others as ratio infinity, which is the
    limit of a small median.

    Args:
        s: ``(N,)``, from `curvature`.
        t: flow time in [0, 1], one number.
        c0: strength.
        lambda_s: how much curvature counts, >= 0.
        p: power of the curvature, > 0.
        tau_min: see `time_decay`.
        form: ``"printed"`` takes the median; ``"released"`` the lower one of the two middle
            values, which matters only for an even number of frames.

    Returns:
        ``(N,)``, not clipped.

    Raises:
        ValueError: if there is no frame, a curvature or a constant is negative, or `p` is 0.

    Source: ProjFlow eq. 15 and 48.
    """
    one_of("frame_trust", form, ("printed", "released"))
    s, t = real_array("frame_trust", "s", s, (None,)), real_array("frame_trust", "t", t, ())
    if len(s) == 0 or (s < 0).any() or min(c0, lambda_s) < 0 or p <= 0:
        raise ValueError("frame_trust: needs frames; s, c0, lambda_s not negative; p positive")
    middle = np.sort(s)[[(len(s) - 1) // 2, len(s) // 2]]
    s_med = middle[0] if form == "released" else middle.mean()
    with np.errstate(over="ignore"):  # what overflows is the infinity of the limit
        ratio = s / s_med if s_med > 0 else np.where(s > 0, np.inf, 0)
        penalty = lambda_s * ratio**p if lambda_s > 0 else np.zeros(len(s))
    return time_decay(t, tau_min) * c0 / (1 + penalty)


def clip_trust(pi: ArrayLike, pi_min: float, pi_max: float) -> NDArray:
    r"""Keep a trust between its bounds.

    .. math:: \pi_n = \mathrm{clip}(\tilde\pi_n, \pi_{min}, \pi_{max})

    Table 5 sets :math:`\pi_{max} = 1`: the variance of a fully trusted guide is then 0, and the
    guide is as hard as a keyframe. A guide that stays soft needs :math:`\pi_{max} < 1`.

    Args:
        pi: any shape.
        pi_min: lower bound, above 0.
        pi_max: upper bound, at most 1.

    Raises:
        ValueError: if the bounds are not 0 < pi_min <= pi_max <= 1.

    Source: ProjFlow section 4.3.1, the text below eq. 17.
    """
    if not 0 < pi_min <= pi_max <= 1:
        raise ValueError(f"clip_trust: expected 0 < pi_min <= pi_max <= 1, got {pi_min}, {pi_max}")
    return np.clip(real_array("clip_trust", "pi", pi), pi_min, pi_max)


def joint_trust(
    pi_frame: ArrayLike,
    q: ArrayLike,
    active: ArrayLike,
    pi_min: float,
    pi_max: float,
    form: str = "printed",
) -> NDArray:
    r"""Share a frame's trust among its active joints, and clip.

    .. math:: \pi_{n,j} = \mathrm{clip}\Bigl(\tilde\pi_n \frac{q_j}{\sum_{k \in H_n} q_k},
              \pi_{min}, \pi_{max}\Bigr)

    Args:
        pi_frame: ``(N,)``, from `frame_trust`, not clipped.
        q: ``(J,)``, from `influence_weights`.
        active: booleans ``(N, J)``, the set :math:`H_n` of each frame.
        pi_min: lower bound, above 0.
        pi_max: upper bound, at most 1.
        form: ``"printed"`` shares the raw budget; ``"released"`` clips it first, as section 4.3.1
            says: with several joints the guides are then much weaker early on.

    Returns:
        ``(N, J)``; 0, no trust at all, where a joint is not active.

    Raises:
        ValueError: if shapes do not fit, a weight is not positive or the bounds are wrong.

    Source: ProjFlow eq. 52.
    """
    one_of("joint_trust", form, ("printed", "released"))
    q = real_array("joint_trust", "q", q, (None,))
    pi_frame = real_array("joint_trust", "pi_frame", pi_frame, (None,))[:, None]
    active = real_array("joint_trust", "active", active, (len(pi_frame), len(q)))
    active = true_or_false("joint_trust", "active", active)
    if (q <= 0).any():
        raise ValueError("joint_trust: a weight in q is not positive")
    budget = clip_trust(pi_frame, pi_min, pi_max) if form == "released" else pi_frame
    total = (q * active).sum(axis=1, keepdims=True)
    share = np.divide(q * active, total, out=np.zeros(active.shape), where=total > 0)
    return np.where(active, clip_trust(budget * share, pi_min, pi_max), 0)
