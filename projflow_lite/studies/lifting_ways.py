"""The ways from a drawing to a motion that the study of lifting compares."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray

from data_synth import Clips
from projflow_lite.prior.text import Vocabulary
from projflow_lite.samplers import METHODS, euler, flow_times
from projflow_lite.samplers.projflow import Velocity
from projflow_lite.studies import lifting_depths, lifting_direct, lifting_retrieval
from projflow_lite.studies.cells import Rival
from projflow_lite.studies.control_ways import RIVALS, guides_of, metric_of, of_sampler
from projflow_lite.studies.lifting_depths import Lifter
from projflow_lite.studies.lifting_direct import Direct, answered
from projflow_lite.studies.lifting_lessons import CLIPS, SEED, kept, textbook
from projflow_lite.studies.lifting_paper import DIRECT, LIFT, RETRIEVAL
from projflow_lite.studies.lifting_pictures import Errors, Shot, draw_shot, errors_of
from projflow_lite.studies.lifting_retrieval import retrieve

BATCH = 16
"""Clips that are made at once. They share their camera and the joints drawn, not the drawings."""

BASELINES = (
    Rival(RETRIEVAL, "retrieval"),
    Rival(LIFT, "lifter"),
    Rival(DIRECT, "direct"),
)

OVERWRITERS = ("replacement", "imputation", "gmd")
"""Methods that cannot: they overwrite coordinates, and a drawn point is a sum of three."""

RIVALS_OF_LIFTING = (
    *(rival for rival in RIVALS if rival.method not in OVERWRITERS),
    *BASELINES,
    Rival("euclid", "projflow", (("metric", "euclidean"),)),
    Rival("no fresh noise", "projflow", (("eta", 0.0),)),
)
"""Of the ablations, plain masking is no other method: a drawn path has no gaps to bridge."""


class Learnt(NamedTuple):
    """What the baselines know before they see a drawing.

    Attributes:
        stock: clips to choose from.
        lifter: depths from single frames.
        direct: motions from drawings.
    """

    stock: Clips
    lifter: Lifter
    direct: Direct


class Effort(NamedTuple):
    """How much the baselines may learn.

    Attributes:
        stock: clips to choose from.
        lifter, direct: optimiser steps.
    """

    stock: int = lifting_retrieval.SIZE
    lifter: int = lifting_depths.STEPS
    direct: int = lifting_direct.STEPS

    @property
    def spelled(self) -> str:
        """For a file's name."""
        return f"{self.stock}-{self.lifter}-{self.direct}"


def school(frames: int, effort: Effort, folder: Path) -> Learnt:
    """Let the baselines learn, or take what they have learnt from its files."""
    with torch.random.fork_rng():
        torch.manual_seed(SEED)
        lifter = Lifter()
        direct = Direct(Vocabulary.of(textbook(CLIPS, frames).captions))
    kept(
        lifter,
        folder / f"lifter-{frames}-{effort.lifter}.safetensors",
        partial(lifting_depths.learn, frames=frames, steps=effort.lifter),
    )
    kept(
        direct,
        folder / f"direct-{frames}-{effort.direct}.safetensors",
        partial(lifting_direct.learn, frames=frames, steps=effort.direct),
    )
    return Learnt(lifting_retrieval.stock(effort.stock, frames), lifter, direct)


class Made(NamedTuple):
    """Motions ``(clips, frames, 22, 3)``, metres, and how far they are from the drawings."""

    positions: NDArray
    errors: Errors


def make(
    velocity: Velocity,
    noise_std: float | torch.Tensor,
    rival: Rival,
    task: str,
    clips: Clips,
    steps: int,
    seed: int,
    learnt: Learnt,
) -> Made:
    """A motion for every clip, from its prompt and the drawing of it.

    Camera, drawn joints and the noise of the start depend on the seed alone: all rivals have the
    same.

    Args:
        velocity: the flow.
        noise_std: standard deviation of its noise, metres.
        rival: how.
        task: whose path is drawn: a joint, or "cross".
        clips: where prompts and drawings are taken from.
        steps: of sampling.
        seed: of cameras, joints and noise.
        learnt: what the baselines know.
    """
    positions, errors = [], []
    for start in range(0, len(clips.captions), BATCH):
        batch, number = slice(start, start + BATCH), 10_000 * seed + start
        x, shot = clips.positions[batch], draw_shot(task, number)
        generator = torch.Generator().manual_seed(number)
        x0 = noise_std * torch.randn(x.shape, generator=generator)
        order = Order(shot, shot.drawn(x), clips.captions[batch], x0, generator)
        made = answer(velocity, noise_std, rival, order, steps, learnt)
        positions.append(made)
        errors.append(errors_of(shot, made, x))
    parts = zip(*errors, strict=True)
    return Made(np.concatenate(positions), Errors(*(np.concatenate(part) for part in parts)))


class Order(NamedTuple):
    """What is given for one batch.

    Attributes:
        shot: how it was drawn.
        drawings: ``(clips, frames, 22, 2)``, metres; only what the shot asks for is looked at.
        prompts: one for each.
        x0: noise to begin with.
        generator: where more noise comes from.
    """

    shot: Shot
    drawings: NDArray
    prompts: list[str]
    x0: torch.Tensor
    generator: torch.Generator


def answer(
    velocity: Velocity,
    noise_std: float | torch.Tensor,
    rival: Rival,
    order: Order,
    steps: int,
    learnt: Learnt,
) -> NDArray:
    """One batch of one rival."""
    if rival.method == "retrieval":
        return retrieve(learnt.stock, order.shot, order.drawings, order.prompts)
    if rival.method == "direct":
        return answered(learnt.direct, order.shot, order.drawings, order.prompts)
    times = flow_times(steps)
    options = of_sampler(dict(rival.options))
    with torch.no_grad():
        if not rival.method:
            return euler(velocity, order.x0, times, order.prompts).numpy()
        sampler = METHODS["projflow" if rival.method == "lifter" else rival.method].sampler
        x1 = sampler(
            velocity, aim(rival, order, learnt), order.x0, times, order.generator, order.prompts,
            noise_std=noise_std, **options,
        )  # fmt: skip
    return x1.numpy()


def aim(rival: Rival, order: Order, learnt: Learnt) -> Any:
    """What a method asks in every step: the drawing itself, or the points that it was lifted to."""
    shot, drawings = order.shot, order.drawings
    if rival.method == "lifter":
        return lifting_depths.aim(shot, lifting_depths.lifted(learnt.lifter, shot, drawings))
    one, frames = shot.wish(drawings[0]), drawings.shape[1]
    asked = METHODS[rival.method].aim(
        one, frames, metric_of(rival), torch.float32, guides_of(rival)
    )
    return asked.aimed_at(shot.targets(drawings))
