r"""Flow matching and the recomposition step: ProjFlow eq. 1, 2, 3, 5, 9, 10.

Everything here acts on arrays of any shape. A time ``t`` is one number for all, or one number
per sample (its shape is then how the shape of ``x`` begins).
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import fraction, one_of, real_array, same_shape, whole_number


def flow_map(
    velocity: Callable[[NDArray, float], ArrayLike], x0: ArrayLike, times: ArrayLike
) -> NDArray:
    r"""Carry points along a velocity field by Euler's method.

    .. math:: \frac{d\psi_t(x_0)}{dt} = v(\psi_t(x_0), t), \qquad \psi_0(x_0) = x_0

    Args:
        velocity: function of a point (shape of `x0`) and a time, returning the shape of `x0`.
        x0: starting points, any shape.
        times: ``(T + 1,)`` increasing; T steps are taken, the first from ``times[0]``.

    Returns:
        ``(T + 1, *x0.shape)``, the points at every time. The error shrinks like the step size.

    Raises:
        ValueError: if times do not increase or the velocity has another shape than `x0`.

    Source: ProjFlow eq. 1.
    """
    x, times = real_array("flow_map", "x0", x0), real_array("flow_map", "times", times, (None,))
    if len(times) == 0 or (np.diff(times) <= 0).any():
        raise ValueError("flow_map: times must increase from one entry to the next")
    path = [x]
    for t, t_next in pairwise(times):
        v = real_array("flow_map", "velocity", velocity(path[-1], float(t)), x.shape)
        path.append(path[-1] + (t_next - t) * v)
    return np.stack(path)


def interpolate(x0: ArrayLike, x1: ArrayLike, t: ArrayLike) -> NDArray:
    r"""Walk the straight path from noise to data.

    .. math:: x_t = (1 - t)\, x_0 + t\, x_1

    Args:
        x0: noise, any shape.
        x1: data, same shape.
        t: in [0, 1], scalar or one per sample.

    Raises:
        ValueError: if shapes differ or `t` leaves [0, 1].

    Source: ProjFlow eq. 2.
    """
    x0, x1 = same_shape("interpolate", x0=x0, x1=x1)
    t = fraction("interpolate", "t", t, x0)
    return (1 - t) * x0 + t * x1


def flow_matching_loss(v: ArrayLike, x0: ArrayLike, x1: ArrayLike) -> float:
    r"""Mean squared distance between a predicted velocity and the straight one.

    .. math:: \mathcal{L} = \mathbb{E}\,\lVert v(x_t, t) - (x_1 - x_0) \rVert_2^2

    The squares are summed within a sample and averaged over samples.

    Args:
        v: ``(batch, ...)``, the network's answers at ``interpolate(x0, x1, t)``.
        x0: noise, same shape.
        x1: data, same shape.

    Raises:
        ValueError: if shapes differ or there is no sample.

    Source: ProjFlow eq. 3.
    """
    v, x0, x1 = same_shape("flow_matching_loss", v=v, x0=x0, x1=x1)
    if v.ndim == 0 or len(v) == 0:
        raise ValueError("flow_matching_loss: expected (batch, ...) with at least one sample")
    return float(np.sum((v - (x1 - x0)) ** 2) / len(v))


def tweedie_endpoint(x_t: ArrayLike, v: ArrayLike, t: ArrayLike) -> NDArray:
    r"""Where the path would end if the velocity stayed as it is: the predicted clean motion.

    .. math:: \hat{x}_1 = x_t + (1 - t)\, v(x_t, t) = \mathbb{E}[x_1 \mid x_t]

    Args:
        x_t: state, any shape.
        v: velocity at that state, same shape.
        t: in [0, 1], scalar or one per sample.

    Raises:
        ValueError: if shapes differ or `t` leaves [0, 1].

    Source: ProjFlow eq. 5.
    """
    x_t, v = same_shape("tweedie_endpoint", x_t=x_t, v=v)
    return x_t + (1 - fraction("tweedie_endpoint", "t", t, x_t)) * v


def implied_noise(x_t: ArrayLike, v: ArrayLike, t: ArrayLike) -> NDArray:
    r"""Where the path would have started: the noise that the current state implies.

    .. math:: \hat{x}_0 = x_t - t\, v(x_t, t) = \mathbb{E}[x_0 \mid x_t]

    Printed eq. 9 mixes the noise that the run started from; the released code mixes this one.

    Args:
        x_t: state, any shape.
        v: velocity at that state, same shape.
        t: in [0, 1], scalar or one per sample.

    Raises:
        ValueError: if shapes differ or `t` leaves [0, 1].

    Source: the counterpart of ProjFlow eq. 5 at the other end of the path.
    """
    x_t, v = same_shape("implied_noise", x_t=x_t, v=v)
    return x_t - fraction("implied_noise", "t", t, x_t) * v


def mix_noise(x0: ArrayLike, eps: ArrayLike, eta: ArrayLike) -> NDArray:
    r"""Replace a share of the noise by fresh noise without changing its variance.

    .. math:: \tilde{x}_0 = \sqrt{1 - \eta}\, x_0 + \sqrt{\eta}\, \epsilon

    The variance stays 1 only if `x0` has variance 1 and is independent of `eps`. The noise the
    run started from is so; `implied_noise` is a conditional mean and has less variance.

    Args:
        x0: noise, any shape: the original one (as printed) or `implied_noise` (as released).
        eps: fresh standard normal noise, same shape.
        eta: in [0, 1], scalar or one per sample: 0 keeps `x0`, 1 keeps `eps`.

    Raises:
        ValueError: if shapes differ or `eta` leaves [0, 1].

    Source: ProjFlow eq. 9.
    """
    x0, eps = same_shape("mix_noise", x0=x0, eps=eps)
    eta = fraction("mix_noise", "eta", eta, x0)
    return np.sqrt(1 - eta) * x0 + np.sqrt(eta) * eps


def recompose(x1: ArrayLike, noise: ArrayLike, t_next: ArrayLike) -> NDArray:
    r"""Put the corrected endpoint back on a path, at the next time.

    .. math:: x_{t+\Delta t} = \alpha\, \hat{x}_1^* + \sigma\, \tilde{x}_0, \qquad
              \alpha = t + \Delta t, \quad \sigma = 1 - (t + \Delta t)

    Args:
        x1: corrected clean endpoint, any shape.
        noise: mixed noise, same shape.
        t_next: :math:`t + \Delta t` in [0, 1], scalar or one per sample.

    Raises:
        ValueError: if shapes differ or `t_next` leaves [0, 1].

    Source: ProjFlow eq. 10.
    """
    x1, noise = same_shape("recompose", x1=x1, noise=noise)
    alpha = fraction("recompose", "t_next", t_next, x1)
    sigma = 1 - alpha
    return alpha * x1 + sigma * noise


def noise_mixing(t_next: ArrayLike) -> NDArray:
    r"""Share of fresh noise in a step: it grows as the noise level falls.

    .. math:: \eta_t = 1 - \sigma_{t + \Delta t} = t + \Delta t

    Args:
        t_next: :math:`t + \Delta t` in [0, 1].

    Raises:
        ValueError: if `t_next` leaves [0, 1].

    Source: ProjFlow Table 5.
    """
    sigma = 1 - fraction("noise_mixing", "t_next", t_next)
    return 1 - sigma


def time_grid(steps: int, form: str = "derived") -> NDArray:
    r"""Times at which a run of T updates stops.

    .. math:: t_k = k / T, \qquad k = 0, \dots, T

    Args:
        steps: T, the number of updates wanted.
        form: ``"derived"`` has T + 1 times and so T updates. ``"released"`` has T times: the
            public code calls T = 100 what are 99 updates.

    Raises:
        ValueError: if `steps` is not a whole number from 1 on (2 in the released form).

    Source: ProjFlow section C.1.
    """
    one_of("time_grid", form, ("derived", "released"))
    steps = whole_number("time_grid", "steps", steps, 1 if form == "derived" else 2)
    return np.linspace(0, 1, steps + 1 if form == "derived" else steps)
