"""One step's projection: a wish, its guides and the metric, ready to move a predicted motion."""

from __future__ import annotations

from copy import copy

import numpy as np
import torch
from numpy.typing import ArrayLike

from projflow_lite.constraints import Wish
from projflow_lite.joint_metric import check_metric
from projflow_lite.projection import Projector, Softness
from projflow_lite.samplers.guides import Guides, GuideSettings
from projflow_lite.skeleton import shown


class ProjectionStep:
    """The step that moves a predicted motion onto a wish: ``step(x1_hat, t)``.

    Args:
        wish: what must hold.
        frames: of the motion.
        metric: see `Projector`.
        dtype: of the motions.
        guides: whether sparse keyframes are helped by soft rows around them, see `Guides`; or the
            constants to do it with.

    Attributes:
        guides: the guides, or None where none are wanted or no frame lies between keyframes.
        projector: onto the rows of the wish and, after them, those of the guides.
    """

    def __init__(
        self,
        wish: Wish,
        frames: int,
        metric: str | ArrayLike = "kinematic",
        dtype: torch.dtype = torch.float32,
        guides: bool | GuideSettings = True,
    ) -> None:
        if not isinstance(wish, Wish):
            raise ValueError(f"ProjectionStep: a wish is made by pin and others, not {shown(wish)}")
        rows = wish.rows(frames)
        settings = guides if isinstance(guides, GuideSettings) else None
        guide = Guides(rows, check_metric(metric), settings, dtype) if guides else None
        self.guides = guide if guide else None
        self.given = torch.as_tensor(rows.variance, dtype=dtype)
        self.projector = Projector(self.guides.rows if self.guides else rows, metric, dtype)
        if self.guides:
            alike = self.projector.axes_alike(self.guides.table())
            self.known = Softness(self.guides.firmest, alike)

    def __call__(self, x1_hat: torch.Tensor, t: float) -> torch.Tensor:
        """Project ``(batch, frames, 22, 3)``, metres, as asked for at flow time `t`."""
        if not self.guides:
            return self.projector.project(x1_hat)
        variance = self.guides.variance(x1_hat, t)
        return self.projector.project(x1_hat, variance, self.known)

    def aimed_at(self, y: ArrayLike) -> ProjectionStep:
        """The same step with other targets, one set for each motion of a batch.

        Args:
            y: ``(batch, m)``, in the order of the wish's rows.
        """
        y = np.asarray(y, float)
        other = copy(self)
        other.projector = self.projector.aimed_at(self.guides.targets(y) if self.guides else y)
        return other

    def variance(self, x1_hat: torch.Tensor, t: float) -> torch.Tensor:
        """Variance of every row at time `t`, ``(batch, rows)``; infinity where a guide is idle."""
        if self.guides:
            return self.guides.variance(x1_hat, t)
        return self.given.expand(len(x1_hat), -1)

    def residual(self, x1: torch.Tensor) -> float:
        """Largest miss of a hard row, metres."""
        return self.projector.residual(x1)
