"""Teach the tiny flow: from a seed, with a log, losing a minute at most when interrupted.

Everything random in step k comes from the seed and k alone: a run that was stopped and resumed
makes the same steps as one that was not.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Generator
from contextlib import closing
from copy import deepcopy
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import torch
from tqdm.auto import tqdm

from data_synth import make_clips
from data_synth.captions import phrases
from projflow_lite.prior.checkpoint import load_prior, read, save_prior, write
from projflow_lite.prior.loss import FOOT_WEIGHT, loss_of
from projflow_lite.prior.loss_log import LossLog
from projflow_lite.prior.model import Prior
from projflow_lite.prior.processes import Processes, join
from projflow_lite.prior.signals import undivided
from projflow_lite.prior.text import Vocabulary

ROUNDS = 12
"""Batches of each length that are made at once."""

REUSE = 3
"""How often a batch is shown, each time with other noise: making clips costs a third of a step."""

SAVE_EVERY = 60.0
"""Seconds between two checkpoints."""


@dataclass(frozen=True)
class Recipe:
    """Everything that decides what a training run produces.

    Attributes:
        steps: optimiser steps.
        batch: motions in a step.
        learning_rate: highest learning rate; it warms up, stays, and falls to 0 over `decay`.
        decay: last share of the steps, over which the learning rate falls.
        restart: step at which a second round begins, or 0 for none: the learning rate starts anew
            at half its height and falls at once, and feet begin to count more.
        prompt_dropout: share of motions shown without their prompt, for guidance.
        ema: decay of the average of the weights that is saved.
        lengths: frames; the steps take them in turn.
        widths: of the network, see `Network`.
        bfloat16: multiply in bfloat16: half as fast again on processors that can, and after 400
            steps the loss is the same (0.158 against 0.156).
        seed: of everything.
    """

    steps: int
    batch: int = 48
    learning_rate: float = 8e-4
    decay: float = 0.5
    restart: int = 0
    prompt_dropout: float = 0.1
    ema: float = 0.999
    lengths: tuple[int, ...] = (20, 60, 32, 80, 60, 120, 48, 60, 80, 196)
    widths: tuple[int, int] = (160, 240)
    bfloat16: bool = False
    seed: int = 0

    def second_round(self, step: int) -> bool:
        """Whether a step belongs to the second round."""
        return 0 < self.restart <= step

    def trainer(self, here: Processes | None = None) -> Trainer:
        """A new run of this recipe."""
        return Trainer(self, here)


RECIPES = {
    "smoke": Recipe(steps=20, batch=8, widths=(16, 24)),
    "classroom": Recipe(
        steps=4000,
        learning_rate=1e-3,
        lengths=(20, 60, 40, 60, 80),
        widths=(128, 192),
        bfloat16=True,
    ),
    "shipped": Recipe(steps=24000, learning_rate=1e-3, restart=16000, bfloat16=True),
}


def learning_rate(recipe: Recipe, step: int) -> float:
    """Warm up over 200 steps, stay, then fall along a half cosine to 0; see `Recipe.restart`."""
    if recipe.second_round(step):
        fall = (step - recipe.restart) / (recipe.steps - recipe.restart)
        return 0.25 * recipe.learning_rate * (1 + math.cos(math.pi * fall))
    steps = recipe.restart or recipe.steps
    warm = min(1.0, (step + 1) / min(200, steps))
    begin = steps * (1 - recipe.decay)
    fall = max(0.0, (step - begin) / max(1.0, steps - begin))
    return recipe.learning_rate * warm * 0.5 * (1 + math.cos(math.pi * fall))


@cache
def look_at_data(seed: int) -> torch.Tensor:
    """Motions to find the scale of data with, ``(2048, 60, 22, 3)`` metres."""
    return torch.as_tensor(make_clips(2048, frames=60, seed=seed).positions)


def scale_of(positions: torch.Tensor) -> tuple[torch.Tensor, float]:
    """Mean position of every joint, ``(22, 3)`` metres, and the spread around it, metres."""
    mean = positions.mean((0, 1))
    return mean, float((positions - mean).square().mean().sqrt())


class Trainer:
    """A training run: its state, one step of it, and how it is stored.

    Args:
        recipe: what to train.
        here: the processes that share the work; by default there is this one only.

    Raises:
        ValueError: if a batch cannot be shared equally.
    """

    def __init__(self, recipe: Recipe, here: Processes | None = None) -> None:
        self.recipe, self.step, self.smooth = recipe, 0, math.nan
        self.here = here or Processes()
        self.part = self.here.part(recipe.batch)
        torch.manual_seed(recipe.seed)
        self.prior = self.untrained()
        self.network = self.prior.network.to(self.here.device)
        self.average = {k: v.detach().clone() for k, v in self.network.named_parameters()}
        self.optimiser = torch.optim.AdamW(self.network.parameters(), weight_decay=0.01, fused=True)
        self.chunk: tuple[int, list[tuple[torch.Tensor, torch.Tensor]]] | None = None

    def untrained(self, kind: type[Prior] = Prior) -> Prior:
        """The prior that the run begins with."""
        recipe = self.recipe
        return kind(
            Vocabulary.of(phrases()),
            *scale_of(self.states(look_at_data(recipe.seed))),
            (min(recipe.lengths), max(recipe.lengths)),
            {"widths": list(recipe.widths)},
            asdict(recipe),
        )

    def states(self, motions: torch.Tensor) -> torch.Tensor:
        """What of motions ``(clips, frames, 22, 3)`` the flow is on: all of it."""
        return motions

    def batch(self) -> tuple[torch.Tensor, torch.Tensor]:
        """Motions and prompts of the current step, those of all processes."""
        lengths = self.recipe.lengths
        number, place = divmod(self.step, REUSE * ROUNDS * len(lengths))
        if self.chunk is None or self.chunk[0] != number:
            random = np.random.default_rng([self.recipe.seed, number])
            self.chunk = number, [self.clips(frames, random) for frames in lengths]
        turn, which = divmod(place, len(lengths))
        first = turn % ROUNDS * self.recipe.batch
        part = slice(first, first + self.recipe.batch)
        u1, ids = self.chunk[1][which]
        return u1[part].to(self.here.device), ids[part].to(self.here.device)

    def clips(self, frames: int, random: np.random.Generator) -> tuple[torch.Tensor, torch.Tensor]:
        """Fresh motions of one length, centred and scaled, and their prompts, some left out."""
        made = make_clips(self.recipe.batch * ROUNDS, frames, seed=int(random.integers(2**31)))
        states = self.states(torch.as_tensor(made.positions))
        u1 = (states - self.prior.mean) / self.prior.noise_std
        dropped = random.random(len(u1)) < self.recipe.prompt_dropout
        prompts = [None if d else c for c, d in zip(made.captions, dropped, strict=True)]
        return u1, self.prior.vocabulary.encode(prompts)

    def loss(self, u1: torch.Tensor, ids: torch.Tensor, random: torch.Generator) -> torch.Tensor:
        """Loss of this process' part of a batch at the current step, see `loss_of`."""
        feet = FOOT_WEIGHT if self.recipe.second_round(self.step) else 1.0
        return loss_of(self.network, u1, ids, random, feet, self.part)

    def advance(self) -> float:
        """Make one step; return its loss."""
        random = torch.Generator().manual_seed(self.recipe.seed * 1_000_003 + self.step)
        kind = self.here.device.type
        with torch.autocast(kind, torch.bfloat16, enabled=self.recipe.bfloat16):
            loss = self.loss(*self.batch(), random)
        self.optimiser.zero_grad()
        loss.backward()
        gradients = [w.grad for w in self.network.parameters() if w.grad is not None]
        self.here.average([loss, *gradients])
        if not torch.isfinite(loss):
            raise ValueError(f"train: the loss is {loss.item()} at step {self.step}; learn slower")
        torch.nn.utils.clip_grad_norm_(self.network.parameters(), 1.0)
        for group in self.optimiser.param_groups:
            group["lr"] = learning_rate(self.recipe, self.step)
        self.optimiser.step()
        self.step += 1
        keep = min(self.recipe.ema, (1 + self.step) / (10 + self.step))
        with torch.no_grad():
            for name, weight in self.network.named_parameters():
                self.average[name].lerp_(weight, 1 - keep)
        now = float(loss.detach())
        self.smooth = now if math.isnan(self.smooth) else 0.98 * self.smooth + 0.02 * now
        return now

    def save(self, path: Path) -> None:
        """Store the run, so that `resume` goes on exactly from here."""
        moments = self.optimiser.state_dict()["state"]
        tensors = {f"average.{k}": v for k, v in self.average.items()}
        tensors |= {f"weight.{k}": v.detach() for k, v in self.network.named_parameters()}
        tensors |= {f"moment.{i}.{k}": v for i, s in moments.items() for k, v in s.items()}
        about = {"step": str(self.step), "recipe": json.dumps(asdict(self.recipe))}
        about |= {"smooth": repr(self.smooth), "words": json.dumps(self.prior.vocabulary.words)}
        write({k: v.contiguous() for k, v in tensors.items()}, about, path)

    def resume(self, path: Path) -> None:
        """Go on from a stored run.

        Raises:
            ValueError: if the file is damaged, or belongs to another recipe or network.
        """
        tensors, about = read(path)
        if about.get("recipe") != json.dumps(asdict(self.recipe)):
            raise ValueError(f"train: {path} was made by another recipe; choose another folder")
        average, weights = part_of(tensors, "average."), part_of(tensors, "weight.")
        shapes = {name: weight.shape for name, weight in self.network.named_parameters()}
        words = about.get("words", json.dumps(self.prior.vocabulary.words))
        if any({k: w.shape for k, w in stored.items()} != shapes for stored in (average, weights)):
            raise ValueError(f"train: {path} belongs to another network; choose another folder")
        if words != json.dumps(self.prior.vocabulary.words):
            raise ValueError(f"train: {path} knows other words; choose another folder")
        self.network.load_state_dict(weights, strict=False)
        self.average = {k: v.to(self.here.device) for k, v in average.items()}
        state: dict[int, dict[str, torch.Tensor]] = {}
        for name, value in part_of(tensors, "moment.").items():
            number, key = name.split(".")
            state.setdefault(int(number), {})[key] = value
        self.optimiser.load_state_dict(self.optimiser.state_dict() | {"state": state})
        self.step, self.smooth = int(about["step"]), float(about.get("smooth", "nan"))

    def result(self) -> Prior:
        """A prior with the averaged weights of this moment; training may go on."""
        prior = deepcopy(self.prior).cpu()
        prior.network.load_state_dict(self.average, strict=False)
        return prior.eval().requires_grad_(False)

    def write(self, path: Path) -> None:
        """Store what the run has led to."""
        save_prior(self.result(), path)

    def read(self, path: Path) -> Any:
        """Load what `write` has stored."""
        return load_prior(path)


def part_of(tensors: dict[str, torch.Tensor], prefix: str) -> dict[str, torch.Tensor]:
    """The tensors whose name begins with `prefix`, without it."""
    return {k.removeprefix(prefix): v for k, v in tensors.items() if k.startswith(prefix)}


def begin(recipe: Recipe, folder: str | Path) -> Trainer:
    """A new run, or the one that a folder holds, where it was left.

    Args:
        recipe: what to train.
        folder: made if it does not exist; see `train` for what is in it.

    Raises:
        ValueError: if the folder holds a damaged run, or one of another recipe; or if a batch
            cannot be shared equally among the processes.
    """
    folder = Path(folder)
    trainer = recipe.trainer(join())
    folder.mkdir(parents=True, exist_ok=True)
    if (folder / "run.safetensors").exists():
        trainer.resume(folder / "run.safetensors")
    return trainer


def steps_of(trainer: Trainer, folder: str | Path) -> Generator[float, None, None]:
    """Make the remaining steps of a run; yield the loss of each.

    The run is stored once a minute, at the end, and when nobody asks for a step any more: close
    the iterator to stop, and begin again to go on.

    Args:
        trainer: the run, from `begin`.
        folder: where it was begun.

    Raises:
        ValueError: if the loss is no number any more.
    """
    run, saved, first = Path(folder) / "run.safetensors", time.monotonic(), trainer.here.first
    log = LossLog(Path(folder) / "loss.jsonl", trainer.step) if first else None
    try:
        while trainer.step < trainer.recipe.steps:
            with undivided():
                loss = trainer.advance()
                if log:
                    log.note(trainer.step, trainer.smooth)
            if first and time.monotonic() - saved > SAVE_EVERY:
                trainer.save(run)
                saved = time.monotonic()
            yield loss
    finally:
        if first:
            trainer.save(run)


def finish(trainer: Trainer, folder: str | Path) -> Any:
    """Write the prior that a run has led to, and load it."""
    path = Path(folder) / "prior.safetensors"
    if trainer.here.first:
        trainer.write(path)
    trainer.here.wait()
    return trainer.read(path)


def train(
    recipe: Recipe,
    folder: str | Path,
    progress: bool = True,
    on_step: Callable[[int, float], None] | None = None,
) -> Any:
    """Train a prior, or go on with a run that was interrupted.

    Args:
        recipe: what to train.
        folder: where ``run.safetensors`` (to resume), ``loss.jsonl`` (the log) and, at the end,
            ``prior.safetensors`` are written.
        progress: show a progress bar.
        on_step: called with the number of steps made and the loss of the last one.

    Returns:
        The trained prior, of the kind that the recipe makes.

    Raises:
        ValueError: if the folder holds a damaged run, or one of another recipe; or if a batch
            cannot be shared equally among the processes.
    """
    trainer = begin(recipe, folder)
    silent = not (progress and trainer.here.first)
    with (
        closing(steps_of(trainer, folder)) as steps,
        tqdm(total=recipe.steps, initial=trainer.step, disable=silent, unit="step") as bar,
    ):
        for loss in steps:
            bar.update()
            if trainer.step % 50 == 0:
                bar.set_postfix(loss=f"{trainer.smooth:.4f}")
            if on_step:
                on_step(trainer.step, loss)
    return finish(trainer, folder)
