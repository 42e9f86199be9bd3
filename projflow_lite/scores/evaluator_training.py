r"""Teach the evaluator: pull a motion and its caption together, push it away from all others.

With points :math:`u_i` of motions and :math:`w_j` of captions, the loss is InfoNCE on distances,

.. math:: -\log \frac{\exp(-\lVert u_i - w_i \rVert^2)}
                     {\sum_j \exp(-\lVert u_i - w_j \rVert^2)},

over captions and, mirrored, over motions. A caption that stands in a batch twice is not pushed away
from either motion.

Train again, after the data changed, with ``python -m projflow_lite.scores.evaluator_training``.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch.nn import functional
from tqdm.auto import tqdm

from data_synth import held_out, make_clips
from projflow_lite.prior.text import Vocabulary
from projflow_lite.scores.evaluator import (
    SHIPPED,
    Evaluator,
    Sizes,
    channels,
    load_evaluator,
    save_evaluator,
)
from projflow_lite.scores.retrieval import matching_score, r_precision


@dataclass(frozen=True)
class Recipe:
    """Everything that decides what a training run produces.

    Attributes:
        steps: optimiser steps.
        batch: motions in a step; each has the other captions as wrong answers.
        looks: how often a clip is shown before new ones are made.
        learning_rate: at its highest; it falls to 0 along a half cosine.
        lengths: frames; the steps take them in random turn.
        seed: of everything.
    """

    steps: int = 1500
    batch: int = 96
    looks: int = 3
    learning_rate: float = 1e-3
    lengths: tuple[int, ...] = (24, 40, 50, 60, 80, 100, 120)
    seed: int = 0


def batches(recipe: Recipe) -> Iterator[tuple[torch.Tensor, list[str]]]:
    """Motions of one length and their captions, without end."""
    random = np.random.default_rng(recipe.seed)
    while True:
        pool = [
            make_clips(4 * recipe.batch, frames, seed=int(random.integers(2**31)))
            for frames in recipe.lengths
        ]
        rounds = [
            (clips, part)
            for clips in pool
            for _ in range(recipe.looks)
            for part in random.permutation(4 * recipe.batch).reshape(4, -1)
        ]
        for k in random.permutation(len(rounds)):
            clips, part = rounds[k]
            yield torch.from_numpy(clips.positions[part]), [clips.captions[i] for i in part]


def contrastive_loss(motion: torch.Tensor, text: torch.Tensor, captions: list[str]) -> torch.Tensor:
    """InfoNCE on squared distances, in both directions.

    Args:
        motion: ``(batch, features)`` points of motions.
        text: ``(batch, features)`` points of their captions.
        captions: the captions; equal ones are not wrong answers for each other.
    """
    _, number = np.unique(captions, return_inverse=True)
    same = torch.from_numpy(number[:, None] == number) & ~torch.eye(len(captions), dtype=torch.bool)
    logits = -(motion[:, None] - text).square().sum(-1)
    logits = logits.masked_fill(same, -math.inf)
    right = torch.arange(len(captions))
    return functional.cross_entropy(logits, right) + functional.cross_entropy(logits.T, right)


def new_evaluator(recipe: Recipe, sizes: Sizes | None = None) -> Evaluator:
    """An evaluator that has learnt nothing, but knows the words and the scale of the data."""
    torch.manual_seed(recipe.seed)
    # Every length: some words, such as "twice", only long clips deserve.
    # One seed would draw the same captions for all of them.
    seeds = [2**31 + 1000 * recipe.seed + frames for frames in recipe.lengths]
    look = [make_clips(1024, *both) for both in zip(recipe.lengths, seeds, strict=True)]
    words = Vocabulary.of(text for clips in look for text in clips.captions)
    evaluator = Evaluator(words, sizes, asdict(recipe))
    x = torch.cat([channels(torch.from_numpy(clips.positions[:256])) for clips in look], dim=2)
    evaluator.motion.mean.copy_(x.mean((0, 2)).unsqueeze(-1))
    # What hardly moves has hardly any spread: do not blow up its noise.
    evaluator.motion.std.copy_(x.std((0, 2)).clamp(min=0.05).unsqueeze(-1))
    return evaluator


def train(
    path: str | Path,
    seed: int = 0,
    steps: int | None = None,
    progress: bool = True,
    recipe: Recipe | None = None,
) -> Evaluator:
    """Train an evaluator and store it; a few minutes on one core.

    Args:
        path: the file to write, ``.safetensors``.
        seed: of everything; the same seed on the same machine gives the same evaluator.
        steps: instead of the recipe's.
        progress: show a progress bar.
        recipe: everything else.

    Returns:
        The evaluator, as read back from the file.

    Raises:
        ValueError: if there is no step to make or the loss is no number any more.
    """
    recipe = replace(recipe or Recipe(), seed=seed)
    recipe = recipe if steps is None else replace(recipe, steps=steps)
    if recipe.steps < 1:
        raise ValueError(f"train: steps is at least 1, not {recipe.steps}")
    evaluator = new_evaluator(recipe)
    optimiser = torch.optim.AdamW(evaluator.parameters(), recipe.learning_rate, weight_decay=0.01)
    falling = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, recipe.steps)
    data = batches(recipe)
    with tqdm(range(recipe.steps), disable=not progress, unit="step") as bar:
        for _ in bar:
            positions, captions = next(data)
            text = evaluator.text(evaluator.vocabulary.encode(captions, "evaluator"))
            loss = contrastive_loss(evaluator.motion(positions), text, captions)
            if not torch.isfinite(loss):
                raise ValueError(f"train: the loss is {loss.item()}; learn slower")
            optimiser.zero_grad()
            loss.backward()
            torch.nn.utils.clip_grad_norm_(evaluator.parameters(), 1.0)
            optimiser.step()
            falling.step()
            bar.set_postfix(loss=f"{loss.item():.3f}")
    save_evaluator(evaluator, path)
    return load_evaluator(path)


def retrieval(
    evaluator: Evaluator, clips: int = 1024, frames: int = 60, seed: int = 0
) -> dict[str, dict[str, float]]:
    """How well held-out captions are found, and how well shuffled ones: those are at chance.

    Returns:
        For ``held-out`` and ``shuffled``: ``top1``, ``top2``, ``top3`` and ``matching``.
    """
    data = held_out(clips, frames, seed)
    motion, text = evaluator.embed_motion(data.positions), evaluator.embed_text(data.captions)
    order = np.random.default_rng(seed).permutation(clips)
    return {"held-out": numbers(text, motion), "shuffled": numbers(text[order], motion)}


def numbers(text: NDArray, motion: NDArray) -> dict[str, float]:
    """R-precision and matching score of two sets of points."""
    top1, top2, top3, _ = r_precision(text, motion)
    return {"top1": top1, "top2": top2, "top3": top3, "matching": matching_score(text, motion)}


def main() -> None:
    """Train the evaluator that is shipped, and print what it can do."""
    parser = argparse.ArgumentParser(description="Train the evaluator.")
    parser.add_argument("--out", type=Path, default=Path(__file__).with_name(SHIPPED))
    parser.add_argument("--steps", type=int, help="instead of the recipe's")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    evaluator = train(options.out, options.seed, options.steps)
    for frames in (20, 40, 60, 120, 196):
        for name, row in retrieval(evaluator, frames=frames).items():
            cells = "  ".join(f"{key} {value:.3f}" for key, value in row.items())
            print(f"{frames:3d} frames, {name:8s}  {cells}")


if __name__ == "__main__":
    main()
