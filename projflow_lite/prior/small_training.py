r"""Teach the models of GMD: a prior on emphasised motion, and a planner of trajectories.

Both are runs of the prior's own trainer: ``projflow-lite train --recipe emphasis_10``. All recipes
of the package come together here, those of `conditioned_training` too.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import torch

from projflow_lite.prior import conditioned_training, training
from projflow_lite.prior.checkpoint import load_prior
from projflow_lite.prior.emphasis import EmphasisedPrior, load_emphasised, save_emphasised
from projflow_lite.prior.features import EMPHASISED, mixing_matrix, spreads_of
from projflow_lite.prior.loss import FOOT_WEIGHT, loss_of, size_of
from projflow_lite.prior.model import Prior
from projflow_lite.prior.processes import Processes
from projflow_lite.prior.training import Recipe, Trainer, look_at_data
from projflow_lite.prior.trajectory import (
    GROUND,
    TrajectoryModel,
    load_trajectory_model,
    save_trajectory_model,
)


@dataclass(frozen=True)
class EmphasisRecipe(Recipe):
    """A recipe for an emphasised prior.

    Attributes:
        c: how much more the pelvis' x and z count.
        start: the prior whose network is taught the other noise: "shipped", or a path. Its widths
            count then, not those of the recipe. Empty: begin with nothing.
    """

    c: float = 10.0
    start: str = ""

    def trainer(self, here: Processes | None = None) -> Trainer:
        """A new run of this recipe."""
        return EmphasisTrainer(self, here)


@dataclass(frozen=True)
class TrajectoryRecipe(Recipe):
    """A recipe for a model of trajectories."""

    def trainer(self, here: Processes | None = None) -> Trainer:
        """A new run of this recipe."""
        return TrajectoryTrainer(self, here)


class EmphasisTrainer(Trainer):
    """Teaches an `EmphasisedPrior`: motions and loss of the plain prior, noise that is white
    projected.
    """

    recipe: EmphasisRecipe

    def untrained(self, kind: type[Prior] = Prior) -> Prior:
        """The plain prior that the run begins with; its network is to learn the other noise."""
        start = self.recipe.start
        if start:
            prior = load_prior(None if start == "shipped" else start)
            prior = prior.train().requires_grad_(True)
            prior.recipe = asdict(self.recipe)
        else:
            prior = super().untrained(kind)
        look = look_at_data(self.recipe.seed)
        A, scale = mixing_matrix(self.recipe.c, self.recipe.seed)
        spreads = spreads_of(look - look.mean((0, 1)))
        self.model = EmphasisedPrior(prior, torch.as_tensor(A), scale, self.recipe.c, spreads)
        return prior

    def colour(self, white: torch.Tensor) -> torch.Tensor:
        """Noise on joint positions, scaled, of white noise in projected space, any shape."""
        one = self.model.g * self.prior.noise_std
        return self.model.coloured(white.flatten(2)) / one

    def size(self, error: torch.Tensor, feet: float = 1.0) -> torch.Tensor:
        """`size_of` an error in which the pelvis' place counts by the noise on it.

        So errors are as far apart as in projected space, and yet there are bones and feet. Either
        space has the same best prediction, the conditional mean. But where noise on the place is
        loud it is the last thing to be known: until then all else would go unheard.
        """
        place, axes = torch.zeros(3), list(EMPHASISED)
        louder = self.model.noise[0, axes].float() / (self.model.g * self.prior.noise_std)
        place[axes] = 1 / louder - 1
        return size_of(error + error[:, :, :1] * place.to(error), feet)

    def loss(self, u1: torch.Tensor, ids: torch.Tensor, random: torch.Generator) -> torch.Tensor:
        """The loss of the plain prior's second round, with other noise."""
        return loss_of(
            self.network, u1, ids, random, FOOT_WEIGHT, self.part, self.colour, self.size
        )

    def write(self, path: Path) -> None:
        """Store the emphasised prior."""
        model = self.model
        prior = EmphasisedPrior(self.result(), model.A, model.scale, model.c, model.spreads)
        save_emphasised(prior, path)

    def read(self, path: Path) -> Any:
        """Load it."""
        return load_emphasised(path)


class TrajectoryTrainer(Trainer):
    """Teaches a `TrajectoryModel` where bodies go, without the bodies."""

    def untrained(self, kind: type[Prior] = Prior) -> Prior:
        """A planner of trajectories, on their own scale."""
        return super().untrained(TrajectoryModel)

    def states(self, motions: torch.Tensor) -> torch.Tensor:
        """Trajectories ``(clips, frames, 1, 2)``, metres."""
        return motions[:, :, :1, list(GROUND)]

    def size(self, error: torch.Tensor, feet: float = 1.0) -> torch.Tensor:
        """Places, velocities and accelerations: a trajectory has no bones.

        A pelvis sways by a centimetre, which places hardly show.
        """
        return (
            error.square().mean((1, 2, 3))
            + 8 * error.diff(dim=1).square().mean((1, 2, 3))
            + 32 * error.diff(n=2, dim=1).square().mean((1, 2, 3))
        )

    def loss(self, u1: torch.Tensor, ids: torch.Tensor, random: torch.Generator) -> torch.Tensor:
        """As `loss_of`, with another size of errors."""
        return loss_of(self.network, u1, ids, random, part=self.part, size=self.size)

    def write(self, path: Path) -> None:
        """Store the planner."""
        result = self.result()
        assert isinstance(result, TrajectoryModel)
        save_trajectory_model(result, path)

    def read(self, path: Path) -> TrajectoryModel:
        """Load it."""
        return load_trajectory_model(path)


RECIPES: dict[str, Recipe] = training.RECIPES | {
    "emphasis_10": EmphasisRecipe(1500, learning_rate=5e-4, bfloat16=True, start="shipped"),
    "emphasis_1": EmphasisRecipe(1500, learning_rate=5e-4, bfloat16=True, start="shipped", c=1.0),
    "emphasis_classroom": EmphasisRecipe(3000, widths=(96, 144), bfloat16=True),
    "trajectory": TrajectoryRecipe(4000, widths=(40, 64), learning_rate=2e-3),
    **conditioned_training.RECIPES,
}
"""The prior's own recipes, those of GMD, and those of the trained rivals of zero-shot control."""
