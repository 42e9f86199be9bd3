"""Teach priors to see keyframes: ``projflow-lite train --recipe control_branch``, or ``masked``.

A run of the prior's own trainer that begins with the shipped prior. In every step each motion is
shown with some of its coordinates as they are, drawn by `draw_known`; the loss is the prior's, and
known coordinates count once more, or one keyframe would drown among a hundred free ones. A known
coordinate can be predicted without any error, so that changes how fast the network learns to look,
and not what it is to say of the rest.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import torch

from projflow_lite.prior.checkpoint import load_prior
from projflow_lite.prior.conditioned import ConditionedPrior, ControlledPrior, MaskedPrior
from projflow_lite.prior.conditioned_files import (
    load_control_branch,
    load_masked_prior,
    save_control_branch,
    save_masked_prior,
)
from projflow_lite.prior.loss import FOOT_WEIGHT, loss_of, size_of
from projflow_lite.prior.model import Prior
from projflow_lite.prior.processes import Processes
from projflow_lite.prior.training import Recipe, Trainer
from projflow_lite.skeleton import CONTROLLED, JOINTS, LOWER_BODY, N_JOINTS

NOTHING, EDIT, SOME_AXES = 0.1, 0.1, 0.1
"""Shares of motions of which nothing is known, of which the lower body is known in all frames, and
of which only one or two axes are known."""

KNOWN = 1.0
"""How much the mean square error of known coordinates counts."""


def draw_known(count: int, frames: int, random: torch.Generator) -> torch.Tensor:
    """Draw what is known of motions, ``(count, frames, 22, 3)`` booleans.

    One to six of `CONTROLLED`, few more often than many; in one frame, in all of them (of a
    seventh of the motions), or in any number between, evenly on a logarithmic scale. A tenth knows
    pelvis and legs instead, in every frame, as one who edits an upper body; and a tenth nothing.

    Args:
        count: of motions.
        frames: of each.
        random: where everything is drawn from.
    """

    def some(of: int, how_many: torch.Tensor) -> torch.Tensor:
        """So many of a row of things, ``(count, of)``."""
        places = torch.rand(count, of, generator=random).argsort(1).argsort(1)
        return places < how_many[:, None]

    def uniform() -> torch.Tensor:
        return torch.rand(count, generator=random)

    joints = torch.zeros(count, N_JOINTS, dtype=torch.bool)
    controlled = [JOINTS.index(name) for name in CONTROLLED]
    joints[:, controlled] = some(len(controlled), 1 + (6 * uniform().square()).floor())
    keys = some(frames, ((2.0 * frames) ** uniform()).floor())
    axes = some(3, torch.where(uniform() < SOME_AXES, 1 + (2 * uniform()).floor(), 3))
    kind = uniform()
    legs = torch.tensor([name in LOWER_BODY for name in JOINTS])
    edit, nothing = kind < EDIT, kind > 1 - NOTHING
    joints[edit], keys[edit], axes[edit] = legs, True, True
    keys[nothing] = False
    return keys[:, :, None, None] & joints[:, None, :, None] & axes[:, None, None, :]


@dataclass(frozen=True)
class ConditionedRecipe(Recipe):
    """A recipe for a prior that sees keyframes.

    Attributes:
        branch: whether a branch is trained beside the frozen prior, or the prior itself.
        start: the prior to begin with: "shipped", or a path. Its widths and lengths count then.
            Empty: begin with nothing.
    """

    branch: bool = False
    start: str = "shipped"

    def trainer(self, here: Processes | None = None) -> Trainer:
        """A new run of this recipe."""
        return ConditionedTrainer(self, here)


class ConditionedTrainer(Trainer):
    """Teaches a prior what is known of a motion."""

    recipe: ConditionedRecipe

    def untrained(self, kind: type[Prior] = Prior) -> Prior:
        """The prior that the run begins with, ready to be shown what is known."""
        start = self.recipe.start
        model_type = ControlledPrior if self.recipe.branch else MaskedPrior
        plain = load_prior(None if start == "shipped" else start) if start else super().untrained()
        self.plain = plain
        model: ConditionedPrior = model_type.of(plain)
        model.recipe = asdict(self.recipe)
        for weight in model.learning():
            weight.requires_grad_(True)
        return model

    def loss(self, u1: torch.Tensor, ids: torch.Tensor, random: torch.Generator) -> torch.Tensor:
        """The loss of the plain prior's second round, and that of known coordinates."""
        known = draw_known(len(u1), u1.shape[1], random)[self.part].to(u1.device)
        observed = torch.where(known, u1[self.part], torch.nan)
        network = partial(self.network, observed=observed)

        def size(error: torch.Tensor, feet: float = 1.0) -> torch.Tensor:
            of_known = (error * known).square().sum((1, 2, 3)) / known.sum((1, 2, 3)).clamp(min=1)
            return size_of(error, feet) + KNOWN * of_known

        return loss_of(network, u1, ids, random, FOOT_WEIGHT, self.part, size=size)

    def write(self, path: Path) -> None:
        """Store the model, or its branch alone."""
        result: Any = self.result()
        (save_control_branch if self.recipe.branch else save_masked_prior)(result, path)

    def read(self, path: Path) -> Any:
        """Load it."""
        if not self.recipe.branch:
            return load_masked_prior(path)
        return load_control_branch(path, self.plain)


RECIPES: dict[str, Recipe] = {
    "control_branch": ConditionedRecipe(2500, learning_rate=1e-3, bfloat16=True, branch=True),
    "masked": ConditionedRecipe(1700, learning_rate=5e-4, restart=1300, ema=0.998, bfloat16=True),
}
"""The trained rivals of zero-shot control."""
