r"""Plain sampling without a wish: follow the flow from noise to motion.

A step of Euler takes the velocity at its start for the whole step. A better velocity for the whole
step makes a better step, so every other solver is Euler's loop on another velocity field; and so
it works between projections too. `multistep` is the one that costs no call of the network.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import torch

from projflow_lite.prior.model import Text
from projflow_lite.samplers.projflow import Velocity


def euler(
    velocity: Velocity, x0: torch.Tensor, times: Sequence[float], text: Text = None
) -> torch.Tensor:
    """Integrate the flow's ordinary differential equation with Euler steps (ProjFlow eq. 1).

    Args:
        velocity: the flow, ``velocity(x_t, t, text)`` on ``(batch, frames, 22, 3)``.
        x0: noise to begin with, metres.
        times: flow times from 0 to 1, rising.
        text: prompts.
    """
    x_t = x0
    for t, t_next in itertools.pairwise(times):
        x_t = x_t + (t_next - t) * velocity(x_t, t, text)
    return x_t


def multistep(velocity: Velocity, times: Sequence[float]) -> Velocity:
    r"""A field whose Euler steps are of second order: where is the endpoint heading?

    The endpoint :math:`\hat x_1` moves during a step. Take it to go on as it went from the last
    step to this one,

    .. math:: \bar x_1 = \hat x_1 + \text{lead} \cdot
              \frac{\hat x_1 - \hat x_1^\text{before}}{t - t^\text{before}},

    with the `lead` that makes a step exact if it does. The first step has no step before it, and
    the last one ends in the network's own endpoint, unextrapolated: both are Euler's.

    Between projections it does one thing more: half a step ahead gives back exactly the spread that
    fresh noise takes from samples (notebook 04 derives it).

    Args:
        velocity: the flow, ``velocity(x_t, t, text)`` on ``(batch, frames, 22, 3)``.
        times: flow times from 0 to 1, rising; those that the field is then called with, in order.

    Raises:
        ValueError: when the field is called at another time.

    Source: the two-step formula of Adams and Bashforth on the endpoint, as DPM-Solver++ (2M) has
    it in another time.
    """
    following = dict(itertools.pairwise(times))
    before: tuple[float, torch.Tensor] | None = None

    def field(x_t: torch.Tensor, t: float, text: Text = None) -> torch.Tensor:
        nonlocal before
        if t not in following:
            raise ValueError(f"multistep: {t} is none of the times at which a step begins")
        x1_hat = torch.add(x_t, velocity(x_t, t, text), alpha=1 - t)
        ahead = x1_hat
        if before is not None and t > times[0] and following[t] < 1:
            t_before, x1_before = before
            ahead = torch.lerp(x1_before, x1_hat, 1 + lead(t, following[t]) / (t - t_before))
        before = t, x1_hat
        return (ahead - x_t) / (1 - t)

    return field


def lead(t: float, t_next: float) -> float:
    r"""How far ahead of :math:`t` the endpoint of a step to :math:`t'` is to be taken.

    If :math:`\hat x_1` moves at a constant rate, the solution of
    :math:`\dot x = (\hat x_1 - x) / (1 - t)` is that of a resting endpoint, taken at

    .. math:: t + (1 - t) \left(1 + \frac{r \ln r}{1 - r}\right), \qquad r = \frac{1 - t'}{1 - t},

    which is half a step ahead for a short step and the whole of it for a step up to 1.

    Args:
        t: flow time at the start of the step.
        t_next: at its end; between `t` and 1.
    """
    r = (1 - t_next) / (1 - t)
    return (1 - t) * (1 + r * math.log(r) / (1 - r))
