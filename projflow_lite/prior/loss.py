r"""What the tiny flow is asked for, and when: the loss, and the flow times it is drawn at.

The network predicts :math:`x_1`, so the flow-matching loss (ProjFlow eq. 3) becomes

.. math:: \lVert v_\theta - (x_1 - x_0) \rVert^2
          = \frac{\lVert \hat x_1 - x_1 \rVert^2}{(1 - t)^2}.
"""

from __future__ import annotations

from collections.abc import Callable

import torch

from projflow_lite.skeleton import ANKLES, FEET, N_JOINTS, PARENTS

FOOT_WEIGHT = 8.0
"""How much ankles and toes count in the second round of a recipe, where others count 1."""


def flow_times(count: int, random: torch.Generator) -> torch.Tensor:
    """Draw flow times, ``(count,)``, where there is most to learn.

    Most lean to 1: the noise is a metre wide and limbs move by decimetres, so they are decided
    late. But a fifth crowds at 0: there the state says nothing yet, and only the prompt can tell a
    run from a step on the spot. Without them the prompt is ignored just when it matters.
    """
    late = torch.sigmoid(torch.randn(count, generator=random) * 1.2 + 1.0)
    early = 0.2 * torch.rand(count, generator=random) ** 3
    return torch.where(torch.rand(count, generator=random) < 0.2, early, late)


def size_of(error: torch.Tensor, feet: float = 1.0) -> torch.Tensor:
    """How large errors ``(batch, frames, 22, 3)`` are, ``(batch,)``.

    Besides positions, the error of velocities and of bone vectors is counted, and feet may count
    more than the rest: a swinging foot that is two centimetres too low slides over the ground. All
    is a quadratic form of the same error, so the best prediction stays the conditional mean.

    Args:
        error: in any scale.
        feet: how much ankles and toes count, where other joints count 1.
    """
    bones = error[:, :, 1:] - error[:, :, list(PARENTS[1:])]
    weight = torch.ones(N_JOINTS, 1, device=error.device)
    weight[list(ANKLES + FEET)] = feet
    weight = weight / weight.mean()
    return (
        (weight * error.square()).mean((1, 2, 3))
        + 2 * (weight * error.diff(dim=1).square()).mean((1, 2, 3))
        + 2 * bones.square().mean((1, 2, 3))
    )


def loss_of(
    network: Callable[..., torch.Tensor],
    u1: torch.Tensor,
    ids: torch.Tensor,
    random: torch.Generator,
    feet: float = 1.0,
    part: slice = slice(None),
    colour: Callable[[torch.Tensor], torch.Tensor] = torch.positive,
    size: Callable[[torch.Tensor, float], torch.Tensor] = size_of,
) -> torch.Tensor:
    """Flow-matching loss of a batch of motions.

    Args:
        network: what is trained.
        u1: ``(batch, frames, 22, 3)`` clean motions, centred and scaled.
        ids: ``(batch, words)`` their prompts.
        random: where flow times and noise are drawn from.
        feet: how much ankles and toes count, where other joints count 1.
        part: the motions that this process answers for. Times and noise are drawn for all, so
            that they are the same for any number of processes.
        colour: makes of white noise the noise of the flow; by default it stays white.
        size: of errors, given them and `feet`.
    """
    t = flow_times(len(u1), random)
    u0 = colour(torch.randn(u1.shape, generator=random))
    u0, u1, t, ids = (each[part].to(u1.device) for each in (u0, u1, t, ids))
    share = t.view(-1, 1, 1, 1)
    error = network((1 - share) * u0 + share * u1, t, ids) - u1
    # Eq. 3 divides by (1 - t)^2; the small constant keeps the last moments from drowning the rest.
    return (size(error, feet) / ((1 - t).square() + 0.005)).mean()
