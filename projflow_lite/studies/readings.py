"""ProjFlow's step with one of its formulas read otherwise than the sampler reads it.

For comparisons only: one is an index order that couples strangers, the other nobody's formula.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray

from projflow_lite.constraints import Rows, Wish
from projflow_lite.equations import influence_weights, marginal_variance
from projflow_lite.joint_metric import check_metric
from projflow_lite.projection import Projector, Softness
from projflow_lite.samplers import GuideSettings, ProjectionStep
from projflow_lite.skeleton import N_JOINTS

PER_FRAME = 3 * N_JOINTS


def as_printed(column: NDArray) -> NDArray:
    r"""Which coordinate the printed metric of eq. 11 takes a coordinate for.

    :math:`I_3 \otimes I_N \otimes L` belongs to a vector sorted by axis, frame and joint, so it
    couples every 22 neighbours of a vector as if they were the joints. A frame has 66 coordinates,
    three such groups: read with joints last, the k-th of them is joint k mod 22 on axis k // 22.

    Args:
        column: numbers of coordinates of a motion sorted by frame, joint and axis.
    """
    frame, k = np.divmod(column, PER_FRAME)
    return frame * PER_FRAME + 3 * (k % N_JOINTS) + k // N_JOINTS


class PrintedOrder:
    """A projector whose metric is eq. 11 as printed, on motions sorted frame by frame.

    Args:
        rows: what must hold.
        metric, dtype: see `Projector`.
    """

    def __init__(
        self, rows: Rows, metric: str | ArrayLike = "kinematic", dtype: torch.dtype = torch.float32
    ) -> None:
        A = rows.A.tocsr().copy()
        A.indices = as_printed(A.indices).astype(A.indices.dtype)
        A.has_sorted_indices = False
        A.sort_indices()
        self.projector = Projector(Rows(A, rows.y, rows.variance), metric, dtype)

    def project(
        self,
        x1_hat: torch.Tensor,
        variance: torch.Tensor | None = None,
        known: Softness | None = None,
    ) -> torch.Tensor:
        """Project ``(batch, frames, 22, 3)``, metres, as `Projector.project` does."""
        taken = x1_hat.flatten(-2).unflatten(-1, (3, N_JOINTS)).mT
        return self.projector.project(taken, variance, known).mT.reshape(x1_hat.shape)

    def aimed_at(self, y: ArrayLike) -> PrintedOrder:
        """The same rows with other targets, one set for each motion of a batch."""
        other = copy(self)
        other.projector = self.projector.aimed_at(y)
        return other


class OrderAsPrinted(ProjectionStep):
    """Eq. 11 as printed, wherever R is used: in the projection, and in eq. 17 and 18 of guides.

    Args:
        wish, frames, metric, dtype, guides: see `ProjectionStep`.
    """

    def __init__(
        self,
        wish: Wish,
        frames: int,
        metric: str | ArrayLike = "kinematic",
        dtype: torch.dtype = torch.float32,
        guides: bool | GuideSettings = True,
    ) -> None:
        super().__init__(wish, frames, metric, dtype, guides)
        R_J = check_metric(metric)
        if self.guides:
            taken_for = as_printed(self.guides.column) % PER_FRAME // 3
            r = torch.as_tensor(marginal_variance(R_J)[taken_for]).to(dtype)
            self.guides.r = torch.cat([torch.zeros(len(self.given), dtype=dtype), r])
            self.guides.share_out(influence_weights(R_J, self.guides.settings.form))
            self.guides.C = torch.as_tensor(np.kron(np.eye(3), np.linalg.cholesky(R_J))).to(dtype)
            self.known = Softness(self.guides.firmest)  # x, y and z are no longer alike
        rows = self.guides.rows if self.guides else wish.rows(frames)
        self.projector = PrintedOrder(rows, metric, dtype)  # type: ignore[assignment]


class SharesAsSaid(ProjectionStep):
    r"""Eq. 51 as the words around it have it: who moves many others gets a *smaller* share.

    So :math:`q_j = \lVert c_j \rVert` instead of its inverse.

    Args:
        wish, frames, metric, dtype, guides: see `ProjectionStep`.
    """

    def __init__(
        self,
        wish: Wish,
        frames: int,
        metric: str | ArrayLike = "kinematic",
        dtype: torch.dtype = torch.float32,
        guides: bool | GuideSettings = True,
    ) -> None:
        super().__init__(wish, frames, metric, dtype, guides)
        if self.guides:
            self.guides.share_out(1 / influence_weights(check_metric(metric)))


READINGS: dict[str, Callable[..., ProjectionStep]] = {
    "order as printed": OrderAsPrinted,
    "shares as said": SharesAsSaid,
}
"""What the option "reading" of a `Rival` with ProjFlow's method may be."""
