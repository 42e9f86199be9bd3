r"""Guided motion diffusion: overwrite what is known, push towards what is wanted, draw, repeat.

Each step of diffusion (`diffusion`) is led twice: its belief about the clean motion is imputed
(GMD section 4.1), and its mean is pushed downhill on a goal, outside the imputed coordinates (4.2):

.. math:: \mu_t = \tilde\mu_t - (1 - M) \odot s\, \Sigma_t\, \nabla_{x_t} G(f(x_t))

Both are soft: the body follows because the network sees the changed state in the next step.

**What it costs to be soft.** A few imputed frames are ignored when imputation ends before the flow
does, and torn off the body when it does not; the gradient is what leads. At the endpoint it does as
well as through the network and costs half, but only where nothing is imputed: it moves exactly the
coordinates that imputation protects. Notebook 14 shows GMD beside nine other methods.

**What the push samples** is not quite :math:`p(x)\, e^{-s G(x)}`. The goal is taken at the mean of
what x may still be, and not averaged over it, so the push is too strong, most so early. On data
:math:`\mathcal N(-1, 1.3)` with the goal :math:`(x - 2)^2 / 2` at s = 2 the law in the limit of
small steps is :math:`\mathcal N(1.77, 0.25)`, where one would like :math:`\mathcal N(1.17, 0.36)`.
State and variance are the flow's here. In a diffusion's own units the push is
:math:`\kappa_t / \kappa_{t'}` times as long, which goes to 1 with small steps.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import Protocol

import torch

from projflow_lite.prior.model import Text
from projflow_lite.samplers.diffusion import Number, denoise, draw, posterior
from projflow_lite.samplers.gmd_imputation import Imputation
from projflow_lite.samplers.goals import Goal, Together, slope_of
from projflow_lite.samplers.projflow import Step, Velocity


class Space(Protocol):
    """What a flow is on, if not motions in metres: two affine maps, there and back.

    Projected motion, for an emphasised prior (GMD section 4.1), or a trajectory.
    """

    def project(self, motion: torch.Tensor) -> torch.Tensor:
        """Bring motions ``(batch, frames, 22, 3)`` in metres to what the flow is on."""

    def unproject(self, x_proj: torch.Tensor) -> torch.Tensor:
        """Bring what the flow is on back to motions, unknown coordinates being 0."""


class Metres:
    """The flow is on motions in metres."""

    def project(self, motion: torch.Tensor) -> torch.Tensor:
        """Leave it as it is."""
        return motion

    unproject = project


def gmd(
    velocity: Velocity,
    known: Imputation,
    x0: torch.Tensor,
    times: Sequence[float],
    generator: torch.Generator | None = None,
    text: Text = None,
    goal: Goal | None = None,
    scale: float = 10.0,
    pull: float = 20.0,
    through: str = "network",
    early: tuple[Imputation, float] | None = None,
    until: float = 0.99,
    along: bool | None = None,
    space: Space | None = None,
    noise_std: Number = 1.0,
    callback: Callable[[Step], None] | None = None,
) -> torch.Tensor:
    r"""Sample motions with known coordinates imputed, pushed towards a goal.

    Args:
        velocity: the flow, ``velocity(x_t, t, text)`` on ``(batch, frames, 22, 3)``, or on what
            `space` says.
        known: coordinates that are imputed in every step.
        x0: noise to begin with, of the shape that the flow takes.
        times: flow times from 0 to 1, rising.
        generator: where fresh noise is drawn from.
        text: prompts.
        goal: what else to reach: ``goal(x)`` of motions in metres, see `goals`.
        scale: s, strength of `goal`, in 1 / metres if the goal is in metres;
            ``projflow-lite reproduce gmd-table`` counts who clears a post at which.
        pull: strength of a goal that comes with the imputation, its distance from what is known
            (eq. 12 at p = 1): it makes the sparse signal dense. At 0 there is imputation alone.
            More brings the mean of the keyframes nearer, until the worst of them gets worse.
            An emphasised prior wants less: with c = 10, 20 overshoots, and 5 is enough.
        through: "network" takes the gradient with respect to the state, through the denoiser, as
            the paper does; "endpoint" with respect to the predicted motion, which costs no second
            pass through the network and moves only what the goal looks at.
        early: more to impute, and the flow time (tau) before which: the point-to-point trajectory.
        until: flow time from which nothing is imputed any more. At 1 what is known is exact at the
            end. Below, the network may mend the seams, and misses by as much as it moves.
        along: whether the body goes along with an imputed pelvis, see `Imputation`. None: if the
            flow is on features as GMD's are, such as those of an emphasised prior.
        space: what the flow is on; None for motions in metres. An emphasised prior is one itself.
        noise_std: standard deviation of the flow's noise, a number, or something that broadcasts.
        callback: called with every `Step`; the state is as the flow has it, the
            predicted and the imputed motion are in metres.

    Returns:
        ``(batch, frames, 22, 3)``, metres.

    Raises:
        ValueError: for another `through`, a negative strength, or a goal that cannot be used (see
            `goals`).

    Source: GMD sections 4.1 and 4.2.
    """
    check_options(scale, pull, through, until)
    space = space or Metres()
    known = known.taking_along(getattr(space, "along", False) if along is None else along)
    wanted = total_goal(known, pull, goal, scale)
    x_t = x0
    for t, t_next in itertools.pairwise(times):
        now = imputed_at(t, known, early, until)
        x1_hat, slope = look(velocity, x_t, t, text, space, wanted, through)
        x1 = space.project(now(space.unproject(x1_hat)))  # 4.1 (c), (e)
        mean, variance = posterior(x1, x_t, t, t_next, noise_std)
        if slope is not None:
            push = now.protect(linear(space.unproject, -variance * slope))  # 4.2 (c)
            mean = mean + linear(space.project, push)  # 4.2 (b), (d)
        if callback:
            callback(Step(t, t_next, x_t, space.unproject(x1_hat), space.unproject(x1)))
        x_t = draw(mean, variance, generator)
    return now(space.unproject(x_t))


def look(
    velocity: Velocity,
    x_t: torch.Tensor,
    t: float,
    text: Text,
    space: Space,
    goal: Goal | None,
    through: str,
) -> tuple[torch.Tensor, torch.Tensor | None]:
    r"""Predict the clean motion and see which way a goal grows.

    Returns:
        The prediction, and the gradient of the goal, both of the shape of `x_t`; None without a
        goal.

    Source: the gradient in GMD section 4.2 (b) and (c).
    """
    if goal is None:
        return denoise(velocity, x_t, t, text), None
    with torch.set_grad_enabled(through == "network"):
        state = x_t.detach().requires_grad_()
        x1_hat = denoise(velocity, state, t, text)
    with torch.enable_grad():
        source = state if through == "network" else x1_hat.detach().requires_grad_()
        end = x1_hat if through == "network" else source
        slope = slope_of(goal, space.unproject(end), source)
    return x1_hat.detach(), slope


def total_goal(known: Imputation, pull: float, goal: Goal | None, scale: float) -> Goal | None:
    """Everything to walk down: the distance from what is known, and the goal; or None."""
    parts: list[tuple[float, Goal]] = []
    if pull and known.mask.any():
        parts.append((pull, known.miss))
    if scale and goal is not None:
        parts.append((scale, goal))
    if not parts:
        return None
    return Together(*(part for _, part in parts), weights=[weight for weight, _ in parts])


def imputed_at(
    t: float, known: Imputation, early: tuple[Imputation, float] | None, until: float
) -> Imputation:
    """What is overwritten at flow time `t`."""
    if t >= until:
        return Imputation(torch.zeros_like(known.mask), known.values, known.along)
    return known.over(early[0]) if early and t < early[1] else known


def linear(function: Callable[[torch.Tensor], torch.Tensor], change: torch.Tensor) -> torch.Tensor:
    """Apply an affine map to a change: its offset drops out."""
    return function(change) - function(torch.zeros_like(change))


def draw_noise(
    space: Space,
    noise_std: Number,
    shape: tuple[int, ...],
    dtype: torch.dtype,
    generator: torch.Generator | None,
) -> torch.Tensor:
    """Noise to begin with, for motions of this shape ``(batch, frames, 22, 3)``."""
    shape = space.project(torch.zeros(shape, dtype=dtype)).shape
    return noise_std * torch.randn(shape, generator=generator, dtype=dtype)


def check_options(scale: float, pull: float, through: str, until: float) -> None:
    """Refuse strengths and times that make no sense."""
    for name, value in (("scale", scale), ("pull", pull)):
        if not isinstance(value, int | float) or not 0 <= value < float("inf"):
            raise ValueError(f"gmd: {name} is a number from 0 on, not {value!r}")
    if through not in ("network", "endpoint"):
        raise ValueError(f"gmd: through is 'network' or 'endpoint', not {through!r}")
    if not 0 <= until <= 1:
        raise ValueError(f"gmd: until is a flow time from 0 to 1, not {until!r}")
