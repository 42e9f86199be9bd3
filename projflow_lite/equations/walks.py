r"""A metric that knows about time: how far a correction of one frame reaches into the others.

ProjFlow's metric (eq. 11) couples the joints of a frame and leaves every frame to itself. So a
keyframe moves one frame, and what stands around it must be dragged along by guides (eq. 12-18).
But a body that is elsewhere in frame 20 is elsewhere in frame 19 as well. The Gaussian behind
eq. 26-28 can say that too: its covariance is then that of a walk.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import positive_definite, real_array, whole_number
from .sampler_moments import endpoint_precision


def walk_covariance(
    frames: int, start: float, speed: float, memory: float, frame_rate: float = 20.0
) -> NDArray:
    r"""How the places of a walker hang together over time, on one axis.

    The walker begins about the origin, and its velocity is an Ornstein-Uhlenbeck process: it is
    forgotten within `memory` seconds. Its place is the integral of that velocity, so it is smooth.

    .. math:: S_{ab} = s_0^2 + s_v^2 \tau \bigl[ 2 \min(a, b)
              - \tau (1 - e^{-a/\tau} - e^{-b/\tau} + e^{-|a - b|/\tau}) \bigr]

    Args:
        frames: N.
        start: :math:`s_0`, standard deviation of the first place, metres, above 0.
        speed: :math:`s_v`, standard deviation of the velocity, metres a second, above 0.
        memory: :math:`\tau`, seconds, above 0.
        frame_rate: frames a second; a and b are times of frames in seconds.

    Returns:
        ``(N, N)`` square metres, positive definite.

    Raises:
        ValueError: if a number is not above 0.

    Source: ours; the integral of an Ornstein-Uhlenbeck covariance over both times.
    """
    a = np.arange(whole_number("walk_covariance", "frames", frames)) / frame_rate
    for name, value in (("start", start), ("speed", speed), ("memory", memory)):
        if not real_array("walk_covariance", name, value, ()) > 0:
            raise ValueError(f"walk_covariance: {name} is above 0, not {value}")
    forgotten = np.exp(-a / memory)
    between = np.exp(-np.abs(a[:, None] - a) / memory)
    bend = 1 - forgotten[:, None] - forgotten + between
    return start**2 + speed**2 * memory * (2 * np.minimum(a[:, None], a) - memory * bend)


def metric_over_time(t: float, walk: ArrayLike, R_J: ArrayLike, noise_std: float) -> NDArray:
    r"""The metric of whole motions that couples frames as a walk does, and joints as eq. 50 does.

    .. math:: R_t = \Bigl(S^{-1} + \frac{t^2}{\sigma^2 (1 - t)^2} I_N\Bigr) \otimes
              (R_J^{-1})_{00}\, R_J \otimes I_3

    The first factor is the precision of a walk that has been seen through the flow's noise: at
    t = 0 a correction is spread over the whole walk, later over the neighbours. The second gives
    the walk to the pelvis, joint 0. With :math:`S = I` and t = 0 nothing is left but eq. 11.

    Args:
        t: flow time, in [0, 1).
        walk: ``(N, N)``, S, square metres, positive definite; see `walk_covariance`.
        R_J: ``(J, J)`` joint metric, positive definite.
        noise_std: :math:`\sigma`, standard deviation of the flow's noise, metres.

    Returns:
        ``(3 N J, 3 N J)`` one over square metres, for `project`.

    Raises:
        ValueError: if a matrix is not positive definite, `t` not in [0, 1) or `noise_std` not
            above 0.

    Source: ours; Cov(x1 | x_t) of ProjFlow eq. 2, with noise as coloured over joints as motion is.
    """
    if not real_array("metric_over_time", "noise_std", noise_std, ()) > 0:
        raise ValueError(f"metric_over_time: noise_std is above 0, not {noise_std}")
    S = real_array("metric_over_time", "walk", walk, (None, None))
    R = real_array("metric_over_time", "R_J", R_J, (None, None))
    R = positive_definite("metric_over_time", "R_J", R)
    over_frames = endpoint_precision(t, S / noise_std**2) / noise_std**2
    over_joints = R * np.linalg.inv(R)[0, 0]
    return np.kron(np.kron(over_frames, over_joints), np.eye(3))
