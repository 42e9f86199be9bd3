"""From a prior and a wish to a motion: one door, one file per method behind it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import torch
from numpy.typing import ArrayLike

from projflow_lite.constraints import Wish
from projflow_lite.motion import Motion
from projflow_lite.prior.model import as_prompts
from projflow_lite.samplers.adapter import Adapter
from projflow_lite.samplers.aims import any_rows, exact_pins, exact_rows, pins_to_impute
from projflow_lite.samplers.condmdi import condmdi
from projflow_lite.samplers.control_branch import control_branch
from projflow_lite.samplers.ddnm import ddnm
from projflow_lite.samplers.diffusion import ancestral
from projflow_lite.samplers.dno import dno
from projflow_lite.samplers.dps import dps
from projflow_lite.samplers.euler import euler
from projflow_lite.samplers.flowchef import flowchef
from projflow_lite.samplers.flowdps import flowdps
from projflow_lite.samplers.gmd import Metres, draw_noise, gmd
from projflow_lite.samplers.gmd_imputation import Imputation
from projflow_lite.samplers.gmd_keyframes import gmd_keyframes
from projflow_lite.samplers.gmd_obstacles import Avoid, box, circles, union
from projflow_lite.samplers.goals import Goal, Together, check_pins, keep_speed, on_ground, reach
from projflow_lite.samplers.guidance import checked, guided
from projflow_lite.samplers.guides import Guides, GuideSettings
from projflow_lite.samplers.imputation import imputation
from projflow_lite.samplers.misfit import Misfit
from projflow_lite.samplers.moving import MovingMetric, MovingStep, projection_step
from projflow_lite.samplers.pace import QUICK, SOLVERS, Pace, check_solver, flow_times
from projflow_lite.samplers.pnp_flow import pnp_flow
from projflow_lite.samplers.projflow import Step, Velocity, projflow
from projflow_lite.samplers.replacement import replacement
from projflow_lite.samplers.step import ProjectionStep
from projflow_lite.skeleton import N_JOINTS, shown

__all__ = [
    "METHODS",
    "Adapter",
    "Avoid",
    "GuideSettings",
    "Guides",
    "Imputation",
    "Misfit",
    "MovingMetric",
    "MovingStep",
    "ProjectionStep",
    "Step",
    "Together",
    "ancestral",
    "box",
    "circles",
    "condmdi",
    "control_branch",
    "ddnm",
    "dno",
    "dps",
    "euler",
    "flow_times",
    "flowchef",
    "flowdps",
    "gmd",
    "gmd_keyframes",
    "guided",
    "imputation",
    "keep_speed",
    "on_ground",
    "pnp_flow",
    "projflow",
    "reach",
    "replacement",
    "sample",
    "union",
]


class Method(NamedTuple):
    """A way to obey.

    Attributes:
        sampler: the loop: ``sampler(velocity, aim, x0, times, generator, text, **options)``.
        aim: makes of a wish what the loop asks in every step: ``aim(wish, frames, metric, dtype,
            guides)``.
        takes_goals: whether the loop takes `goal`, with or without a wish, and `space`, for priors
            that are not on motions in metres.
        model: what loads a prior that was trained for it; empty if it takes any prior.
        pace: how it goes through flow time if nobody says.
    """

    sampler: Callable[..., torch.Tensor]
    aim: Callable[..., Any]
    takes_goals: bool
    model: str = ""
    pace: Pace = Pace()


METHODS = {
    "projflow": Method(projflow, projection_step, takes_goals=False, pace=QUICK),
    "gmd": Method(gmd, pins_to_impute, takes_goals=True),
    "gmd_keyframes": Method(gmd_keyframes, pins_to_impute, takes_goals=True),
    "ddnm": Method(ddnm, partial(exact_rows, "ddnm"), takes_goals=False),
    "replacement": Method(replacement, partial(exact_pins, "replacement"), takes_goals=False),
    "imputation": Method(imputation, partial(exact_pins, "imputation"), takes_goals=False),
    "flowdps": Method(flowdps, partial(any_rows, "flowdps"), takes_goals=False),
    "pnp_flow": Method(pnp_flow, partial(any_rows, "pnp_flow"), takes_goals=False),
    "flowchef": Method(flowchef, partial(any_rows, "flowchef"), takes_goals=False),
    "dps": Method(dps, partial(any_rows, "dps"), takes_goals=False),
    "dno": Method(dno, partial(any_rows, "dno"), takes_goals=False),
    "control_branch": Method(
        control_branch,
        partial(exact_pins, "control_branch"),
        takes_goals=False,
        model="load_control_branch",
    ),
    "condmdi": Method(
        condmdi, partial(exact_pins, "condmdi"), takes_goals=False, model="load_masked_prior"
    ),
}
"""Methods that obey a wish, by the name that `sample` takes."""


def sample(
    prior: Velocity,
    wish: Wish | None = None,
    prompt: str | Sequence[str | None] | None = None,
    frames: int = 60,
    steps: int | Sequence[float] | None = None,
    seed: int = 0,
    method: str = "projflow",
    *,
    solver: str | None = None,
    goal: Goal | None = None,
    batch: int | None = None,
    guidance: float = 1.0,
    guides: bool | GuideSettings = True,
    metric: str | ArrayLike | MovingMetric = "kinematic",
    dtype: torch.dtype = torch.float32,
    **options: Any,
) -> Motion:
    """Generate a motion that obeys a wish: exactly, if the method is "projflow".

    Args:
        prior: a `Prior`, or any callable ``velocity(x_t, t, text)`` on
            ``(batch, frames, 22, 3)``; its noise has the standard deviation
            ``prior.noise_std`` metres, or 1 if it has no such attribute. For a model that lives in
            another layout or normalisation see `Adapter`. A prior on projected motion brings
            ``project`` and ``unproject``, see `projflow_lite.samplers.gmd.Space`.
        wish: what must hold; None for an unconstrained sample.
        prompt: what the motion should be; one text, or one for each motion of the batch.
        frames: length of the motion, at 20 frames a second.
        steps: how many sampling steps, see `flow_times`; or their flow times, from 0 to 1. None for
            as many as are enough: ten for projflow and without a wish, 25 for other methods.
        seed: the same seed gives the same motion.
        method: a name of `METHODS`: "projflow"; or "gmd" and "gmd_keyframes", which overwrite
            exact pins, and push; or a rival: "ddnm", exact for any hard wish; "replacement" and
            "imputation", for exact pins; "flowdps", "pnp_flow", "flowchef", "dps" and "dno", which
            come near to any wish; or "control_branch" and "condmdi", which come near to exact pins
            with a prior that was trained for that, see `projflow_lite.prior.conditioned_files`.
        solver: "multistep", whose steps look ahead (see `projflow_lite.samplers.euler.multistep`),
            or "euler". None for the first with projflow and without a wish, and for Euler's steps
            with other methods.
        goal: what else to reach, as a function of motions, see `goals`; with or without a wish.
            For the methods of GMD.
        batch: how many motions; None for one, without a batch dimension.
        guidance: how strongly the prompt is followed, see `guided`. The shipped prior follows at 1;
            more exaggerates, and costs a second call of the network in every step.
        guides: whether sparse keyframes are helped by soft rows around them, see `Guides`; or the
            constants to do it with. For projflow.
        metric: of the projection, see `Projector`; or "moving" or a `MovingMetric`, which spreads
            keyframes over time by itself, without guides. For projflow.
        dtype: of the sampler's arithmetic: torch.float32 or torch.float64.
        options: further arguments of the method, see its file in ``samplers/``. With projflow one
            differs from there: `eta` is 0 unless given, so that no fresh noise is drawn; ``eta=
            "paper"`` draws as much as the paper.

    Raises:
        ValueError: for a wish that does not fit the motion or contradicts itself, an unknown
            method, a goal that cannot be used, or numbers that make no sense.
    """
    check_numbers(frames, steps, guidance, batch, seed)
    if wish is None and goal is None and options:
        raise ValueError(
            f"sample: without a wish there is no {', '.join(options)}; leave it out, or add a wish"
        )
    check_choices(prior, wish, method, dtype, guides)
    check_model(prior, method)
    as_prompts(prompt, batch or 1)
    check_method(prior, wish, goal, method)
    if hasattr(prior, "check_frames"):
        prior.check_frames(frames)
    sampler, make_aim, takes_goals, _, pace = METHODS[method]
    pace = QUICK if wish is None and not takes_goals else pace
    check_solver(solver, method, pace)
    times = pace.times(steps)
    options = ({} if pace.eta is None else {"eta": pace.eta}) | options
    space: Any = prior if hasattr(prior, "unproject") else Metres()
    noise_std = torch.as_tensor(getattr(prior, "noise_std", 1.0), dtype=dtype)
    aim: Any = None
    if wish is not None or takes_goals:
        if isinstance(metric, str) and metric == "moving":
            metric = MovingMetric(noise_std=float(noise_std.mean()))
        aim = make_aim(wish, frames, metric, dtype, guides)
    if takes_goals:
        check_pins(goal, aim.mask, aim.values)
        options |= {"goal": goal, "space": space}
    generator = torch.Generator().manual_seed(seed)
    x0 = draw_noise(space, noise_std, (batch or 1, frames, N_JOINTS, 3), dtype, generator)
    velocity = SOLVERS[solver or pace.solver](checked(guided(prior, guidance)), times)
    with torch.no_grad():  # and not inference mode: a goal's gradient goes through these tensors
        if aim is None:
            x1 = space.unproject(euler(velocity, x0, times, prompt))
        else:
            x1 = sampler(
                velocity, aim, x0, times, generator, prompt, noise_std=noise_std, **options
            )
    positions = x1.numpy() if batch is not None else x1[0].numpy()
    texts = prompt if prompt is None or isinstance(prompt, str) else list(prompt)
    return Motion(positions, texts, wish)  # type: ignore[arg-type]


def check_numbers(
    frames: int, steps: int | Sequence[float] | None, guidance: float, batch: int | None, seed: int
) -> None:
    """Refuse a count below 1, or a guidance or seed that is not a number."""
    for name, value in (("frames", frames), ("steps", steps), ("batch", batch)):
        given_times = name == "steps" and isinstance(value, Sequence | np.ndarray | torch.Tensor)
        if (value is None and name != "frames") or (given_times and not isinstance(value, str)):
            continue
        if isinstance(value, bool) or not isinstance(value, int) or value < 1:
            raise ValueError(f"sample: {name} is a whole number of at least 1, not {shown(value)}")
    number = isinstance(guidance, int | float) and not isinstance(guidance, bool)
    if not number or not -100 < guidance < 100:
        raise ValueError(f"sample: guidance is a number, usually 0 to 5, not {shown(guidance)}")
    if isinstance(seed, bool) or not isinstance(seed, int) or not -(2**63) <= seed < 2**63:
        raise ValueError(f"sample: seed is a whole number, not {shown(seed)}")


def check_method(prior: Velocity, wish: Wish | None, goal: Goal | None, method: str) -> None:
    """Refuse a goal that is no function, and what the method has no use for."""
    able = ", ".join(name for name in METHODS if METHODS[name].takes_goals)
    if goal is not None and not callable(goal):
        raise ValueError(f"sample: goal is a function of motions, not a {type(goal).__name__}")
    if METHODS[method].takes_goals:
        return
    if goal is not None:
        raise ValueError(f"sample: {method} takes wishes and no goal; for goals take {able}")
    if wish is not None and hasattr(prior, "unproject"):
        raise ValueError(
            f"sample: {method} needs a prior on motions in metres, and this one is on projected "
            f"motion; take {able}"
        )


def check_model(prior: Velocity, method: str) -> None:
    """Refuse a prior that was not trained for a method that needs one."""
    wanted = METHODS[method].model
    if wanted and getattr(prior, "trained_for", "") != method:
        raise ValueError(
            f"sample: {method} needs a prior that was trained to see keyframes; take {wanted}() "
            "from projflow_lite.prior.conditioned_files, or another method"
        )


def check_choices(
    prior: Velocity,
    wish: Wish | None,
    method: str,
    dtype: torch.dtype,
    guides: bool | GuideSettings,
) -> None:
    """Refuse what is not a prior, a wish, a method, a precision or a setting of guides."""
    if not callable(prior):
        raise ValueError("sample: prior is a callable velocity(x_t, t, text); try pf.load_prior()")
    if wish is not None and not isinstance(wish, Wish):
        raise ValueError(
            f"sample: wish is made by pin and its neighbours, not a {type(wish).__name__}"
        )
    if not isinstance(method, str) or method not in METHODS:
        raise ValueError(f"sample: method is one of {', '.join(METHODS)}, not {shown(method)}")
    if dtype not in (torch.float32, torch.float64):
        raise ValueError(f"sample: dtype is torch.float32 or torch.float64, not {dtype}")
    if not isinstance(guides, bool | GuideSettings):
        raise ValueError(f"sample: guides is True, False or GuideSettings(...), not {guides!r}")
