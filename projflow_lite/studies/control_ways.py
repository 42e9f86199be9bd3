"""The ways to make a motion keep an appointment that the study of control compares."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import fields
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray

from data_synth import Clips
from projflow_lite.constraints import pin
from projflow_lite.joint_metric import kinematic_joint_metric
from projflow_lite.prior.model import Text
from projflow_lite.samplers import (
    METHODS,
    GuideSettings,
    Imputation,
    MovingMetric,
    euler,
    flow_times,
    guided,
)
from projflow_lite.samplers.projflow import Velocity
from projflow_lite.skeleton import LOWER_BODY, joint_indices
from projflow_lite.studies.cells import Rival, Scores
from projflow_lite.studies.claims import TIME
from projflow_lite.studies.readings import READINGS

BATCH = 64
"""Clips that are made at once. They share the frames of their keyframes, not the targets."""


FREE = Rival("no wish", "")

RIVALS = (
    FREE,
    Rival("projflow", "projflow"),
    Rival("ddnm", "ddnm"),
    Rival("replacement", "replacement"),
    Rival("imputation", "imputation"),
    Rival("gmd", "gmd"),
    Rival("flowdps", "flowdps"),
    Rival("pnp_flow", "pnp_flow"),
    Rival("flowchef", "flowchef"),
    Rival("dps", "dps"),
    Rival("dps, endpoint", "dps", (("through", "endpoint"), ("scale", 0.3))),
    Rival("dno", "dno", (("iterations", 30), ("solver_steps", 5), ("rate", 0.2))),
)
"""Every method that needs no training of its own."""

OURS = (Rival("metric over time", "projflow", (("metric", "moving"),)),)
"""ProjFlow as we would set it: see `projflow_lite.samplers.MovingMetric`."""

TUNED = (
    Rival(
        "projflow, tuned", "projflow",
        (("eta", 0.0), ("c0", 3.0), ("tau_min", 1.0), ("lambda_s", 0.0), ("w_kin", 3.0)),
    ),
)  # fmt: skip
"""The paper's method with constants that `control_tuning` chose on clips of its own: no fresh
noise, guides that never fade and do not look at the curvature, and bones that are softer."""

TRAINED = (
    Rival("control branch", "control_branch", model="control_branch"),
    Rival("condmdi", "condmdi", model="masked"),
)
"""Methods that need a model that was trained for them, see `control_models`."""

ABLATIONS = (
    Rival("euclid", "projflow", (("metric", "euclidean"),)),
    Rival("no fresh noise", "projflow", (("eta", 0.0),)),
    Rival("plain masking", "projflow", (("guides", False),)),
)
"""ProjFlow without one of its parts, as in its Table 6."""

QUICK_DNO = Rival("dno", "dno", (("iterations", 10), ("solver_steps", 5)))


EDIT = "upper-body edit"
"""Pelvis and legs stay where they are in every frame, and the prompt moves the rest."""

AND = " and "
"""Between the names of joints that are asked for at once."""


class Task(NamedTuple):
    """What is asked for: one joint, or the lower body, at some keyframes.

    Attributes:
        joint: its name, the names of several with `AND` between them, or `EDIT`.
        keys: number of keyframes.
        frames: of the motions.
    """

    joint: str
    keys: int
    frames: int

    @property
    def joints(self) -> list[int]:
        """Indices of the joints that are asked for."""
        names = LOWER_BODY if self.joint == EDIT else self.joint.split(AND)
        return joint_indices(names, "control")

    def keyframes(self, seed: int) -> NDArray[np.int64]:
        """Frames of the keyframes, drawn without repetition, rising."""
        random = np.random.default_rng([seed, self.keys])
        return np.sort(random.choice(self.frames, self.keys, replace=False))


class Made(NamedTuple):
    """Motions and what was asked of them; both ``(clips, frames, 22, 3)``, metres.

    Attributes:
        positions: the motions.
        targets: NaN where nothing was asked for.
    """

    positions: NDArray
    targets: NDArray


def make(
    velocity: Velocity,
    noise_std: float | torch.Tensor,
    rival: Rival,
    task: Task,
    clips: Clips,
    steps: int,
    seed: int,
) -> Made:
    """A motion for every clip, from its prompt and its own position at the keyframes.

    Keyframes and the noise of the start depend on the seed alone: all rivals have the same.

    Args:
        velocity: the flow, of the model that the rival brings if it brings one.
        noise_std: standard deviation of its noise, metres.
        rival: how.
        task: what is asked for.
        clips: where prompts and targets are taken from.
        steps: of sampling.
        seed: of keyframes and noise.
    """
    joints = task.joints
    positions, targets = [], np.full(clips.positions.shape, np.nan)
    for start in range(0, len(clips.captions), BATCH):
        batch = slice(start, start + BATCH)
        frames = task.keyframes(10_000 * seed + start)
        wanted = clips.positions[batch][:, frames[:, None], joints]
        generator = torch.Generator().manual_seed(10_000 * seed + start)
        x0 = noise_std * torch.randn(clips.positions[batch].shape, generator=generator)
        texts = clips.captions[batch]
        with torch.no_grad():
            x1 = sampled(
                velocity, noise_std, rival, (task, frames, wanted), x0, steps, generator, texts
            )
        positions.append(x1.numpy())
        targets[batch, frames[:, None], joints] = wanted
    return Made(np.concatenate(positions), targets)


def sampled(
    velocity: Velocity,
    noise_std: float | torch.Tensor,
    rival: Rival,
    wanted: tuple[Task, NDArray, NDArray],
    x0: torch.Tensor,
    steps: int,
    generator: torch.Generator,
    texts: Text,
) -> torch.Tensor:
    """One batch of one rival."""
    options = dict(rival.options)
    times = flow_times(options.pop("steps", steps))
    velocity = guided(velocity, options.pop("guidance", 1.0))
    if not rival.method:
        return euler(velocity, x0, times, texts)
    options = of_sampler(options)
    return METHODS[rival.method].sampler(
        velocity, aim(rival, *wanted), x0, times, generator, texts, noise_std=noise_std, **options
    )


OF_GUIDES = tuple(field.name for field in fields(GuideSettings))
OF_METRIC = ("w_kin", "ridge")
OF_TIME = tuple(field.name for field in fields(MovingMetric))
OF_AIM = ("metric", "guides", "reading", *OF_GUIDES, *OF_METRIC)
"""Options of ProjFlow that are not the sampler's: they say what it asks for in every step."""


def of_sampler(options: dict[str, Any]) -> dict[str, Any]:
    """The options of a rival that its sampler takes; `until` is one of several samplers."""
    aimed = OF_AIM + (OF_TIME if options.get("metric") == "moving" else ())
    return {name: value for name, value in options.items() if name not in aimed}


def aim(rival: Rival, task: Task, frames: NDArray, targets: NDArray) -> Any:
    """What a method asks in every step, with targets for each motion of a batch.

    Args:
        rival: the method and its settings.
        task: the joints and the length of the motions.
        frames: ``(keys,)`` of the keyframes, rising.
        targets: ``(clips, keys, 3)`` or ``(clips, keys, joints, 3)``, metres.
    """
    wanted = targets.reshape(len(targets), len(frames), len(task.joints), 3)
    one = pin(task.joints, frames, wanted[0])
    metric, guides = metric_of(rival), guides_of(rival)
    reading = dict(rival.options).get("reading")
    asking = READINGS[reading] if reading else METHODS[rival.method].aim
    asked = asking(one, task.frames, metric, torch.float32, guides)
    y = targets.reshape(len(targets), -1)
    if not isinstance(asked, Imputation):
        return asked.aimed_at(y)
    values = asked.values.expand(len(targets), *asked.values.shape).clone()
    values[:, asked.mask] = torch.as_tensor(y, dtype=values.dtype)  # by frame, joint and axis
    return Imputation(asked.mask, values)


def metric_of(rival: Rival) -> Any:
    """The metric that a rival projects with."""
    options = dict(rival.options)
    if options.get("metric") == "moving":
        return MovingMetric(**{name: options[name] for name in OF_TIME if name in options})
    weights = {name: options[name] for name in OF_METRIC if name in options}
    return kinematic_joint_metric(**weights) if weights else options.get("metric", "kinematic")


def guides_of(rival: Rival) -> bool | GuideSettings:
    """The guides that help a rival."""
    options = dict(rival.options)
    constants = {name: options[name] for name in OF_GUIDES if name in options}
    return GuideSettings(**constants) if constants else options.get("guides", True)


def time_ratio(work: Callable[[], Any], reference: Callable[[], Any], turns: int = 3) -> float:
    """How many times as long one piece of work takes as another, in turns, each at its best."""
    seconds = np.empty((turns, 2))
    for turn in range(turns):
        for k, function in enumerate((work, reference)):
            start = time.perf_counter()
            function()
            seconds[turn, k] = time.perf_counter() - start
    best = seconds.min(0)
    return float(best[0] / best[1])


def timed(rival: Rival, make: Callable[[Rival], Any]) -> Scores:
    """What `make` takes of a method, over what it takes of a sample without a wish, in turns."""
    return {TIME: 1.0 if rival == FREE else time_ratio(partial(make, rival), partial(make, FREE))}


def elsewhere(prior: Any, device: str) -> Velocity:
    """The prior's velocity computed on another device; everything else stays on the processor."""
    if device == "cpu":
        return prior
    moved = prior.to(device)

    def field(
        x_t: torch.Tensor, t: float, text: Text = None, *observed: torch.Tensor
    ) -> torch.Tensor:
        return moved(x_t.to(device), t, text, *(known.to(device) for known in observed)).to("cpu")

    return field
