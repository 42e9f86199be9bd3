r"""Keyframes in two stages: first where the body walks, then how (GMD section 5.2).

A handful of keyframes is too little to impute: a motion that was made of noise alone does not know
that it is late for one. So there is a trajectory first, and it is imputed in every frame. It comes
from straight lines, from a small model of trajectories, or from the model led by the lines:

====================  =====================================  ==============================
`trajectory_model`    `switch` (tau)                         name in the paper
====================  =====================================  ==============================
None                  lines lead the motion before tau       point-to-point trajectory
a model               0: no lines                            trajectory DPM
a model               lines lead the trajectory before tau   both combined
====================  =====================================  ==============================
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import torch

from projflow_lite.prior.model import Text
from projflow_lite.samplers.gmd import Space, draw_noise, gmd
from projflow_lite.samplers.gmd_imputation import GROUND, Imputation
from projflow_lite.samplers.goals import Goal
from projflow_lite.samplers.projflow import Velocity


class Planner(Space, Protocol):
    """A flow of trajectories, such as `projflow_lite.prior.trajectory.TrajectoryModel`.

    Attributes:
        noise_std: standard deviation of its noise, metres.
    """

    noise_std: float

    def __call__(self, z_t: torch.Tensor, t: float, text: Text = None) -> torch.Tensor:
        """Velocity at the trajectories ``z_t``, same shape."""


def gmd_keyframes(
    velocity: Velocity,
    known: Imputation,
    x0: torch.Tensor,
    times: Sequence[float],
    generator: torch.Generator | None = None,
    text: Text = None,
    goal: Goal | None = None,
    scale: float = 10.0,
    pull: float = 20.0,
    trajectory_model: Planner | None = None,
    switch: float = 0.5,
    **options: Any,
) -> torch.Tensor:
    r"""Sample motions through keyframes of the pelvis, by way of a whole trajectory.

    Args:
        velocity: the flow of motions, see `gmd`.
        known: the keyframes; what they pin of the pelvis in x and z makes the trajectory.
        x0: noise to begin with, see `gmd`.
        times: flow times from 0 to 1, rising; of both stages.
        generator: where fresh noise is drawn from.
        text: prompts, for both models.
        goal: what else to reach, such as `Avoid`. It guides the trajectory; then what is left of it
            when the pelvis keeps to that guides the motion.
        scale: strength of `goal`. Trajectories give way more easily than motions, and a body
            cannot keep to every plan: then the keyframe is missed.
        pull: strength with which both stages are drawn to what they impute, see `gmd`.
        trajectory_model: a flow of trajectories, see `Planner`; None if there is none.
        switch: tau, the flow time before which the straight lines are imputed; 0: never. See
            ``projflow-lite reproduce gmd-table`` for its effect. Before tau no goal acts between
            keyframes: what is imputed is not pushed.
        options: further ones of `gmd`, for the motion.

    Returns:
        ``(batch, frames, 22, 3)``, metres.

    Raises:
        ValueError: as `gmd`, for a switch outside 0..1, or if lines are wanted and
            the pelvis has no keyframe.

    Source: GMD section 5.2 and its algorithm of two stages.
    """
    if not 0 <= switch <= 1:
        raise ValueError(f"gmd_keyframes: switch is a flow time from 0 to 1, not {switch!r}")
    early = (known.line(), switch) if switch else None
    if trajectory_model is None:
        return gmd(
            velocity, known, x0, times, generator, text, goal, scale, pull, early=early, **options
        )
    shape = (len(x0), *known.mask.shape)
    z0 = draw_noise(trajectory_model, trajectory_model.noise_std, shape, x0.dtype, generator)
    z = gmd(
        trajectory_model, known, z0, times, generator, text, goal, scale, pull, early=early,
        until=1.0, space=trajectory_model, noise_std=trajectory_model.noise_std,
    )  # fmt: skip
    ground = torch.zeros_like(known.mask)
    ground[:, 0, GROUND] = True
    planned = known.over(Imputation(ground, z))

    def rest(x: torch.Tensor) -> torch.Tensor:
        """What is left of the goal for a body that keeps to the plan."""
        return goal(planned(x))  # type: ignore[misc]

    second = rest if goal else None
    return gmd(velocity, planned, x0, times, generator, text, second, scale, pull, **options)
