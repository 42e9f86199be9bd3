r"""The exact solve of ProjFlow eq. 7, fast enough to drag.

.. math:: \hat x_1^* = \hat x_1 + R^{-1} A^\top (A R^{-1} A^\top + \Sigma)^{-1} (y - A \hat x_1)

The metric couples joints, never frames or axes: :math:`R^{-1} = I_N \otimes R_J^{-1} \otimes I_3`.
So :math:`S = A R^{-1} A^\top + \Sigma` falls apart into small blocks of rows that share a frame and
an axis. Blocks are found once and inverted once; a later projection is two sparse products, a
small matrix for each block and one product with :math:`R_J^{-1} \otimes I_3` for each frame. Where
:math:`\Sigma` changes, only the blocks are eliminated anew, all of them at once.
"""

from __future__ import annotations

import math
import warnings
from copy import copy
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray

from projflow_lite.constraints import Rows, is_coordinate
from projflow_lite.elimination import Block, axis_by_axis
from projflow_lite.joint_metric import of_metric
from projflow_lite.projection_checks import (
    as_targets,
    check_batch,
    check_device,
    check_motion,
    check_precision,
    check_rows,
    check_solved,
    check_variance,
    lowest,
)
from projflow_lite.row_blocks import independent_rows, name_nearest, numbered
from projflow_lite.skeleton import N_JOINTS
from projflow_lite.sparse_map import SparseMap, entries_of

NEARLY_DEPENDENT = 1e3
"""Condition number of the rows above which a person is warned."""


class NearlyDependentRows(UserWarning):
    """Rows all but repeat each other: a small disagreement of their targets moves the body far."""


class Softness(NamedTuple):
    """What is known of the variances of a step before anybody looks.

    Attributes:
        firmest: the smallest of a soft row, or less, square metres.
        alike: whether x, y and z of what is asked for have the same, see `Projector.axes_alike`.
    """

    firmest: float
    alike: bool = False


AS_GIVEN = Softness(math.inf)
"""Of the rows' own variances, which were looked at when the projector was made."""


class Projector:
    """Projection onto a set of rows, under a metric on the joints (ProjFlow eq. 6-8).

    Rows that others imply are dropped. Rows that nearly imply each other are met as exactly as all
    others, in float64 whatever the motions are in, and reported: see `condition`.

    Args:
        rows: what must hold; see `Wish.rows`.
        metric: "kinematic" (w = 10, ridge = 1), "euclidean", or any positive definite
            ``(22, 22)`` joint metric.
        dtype: of the motions that will be projected; the factorisation itself is float64.
        device: where they live.

    Attributes:
        keep: indices of the rows that stay; the others are implied by them.
        condition: the largest condition number of rows that couple, each scaled to unit length in
            the metric's inverse: 1 for orthogonal rows, :math:`\\cot(\\theta / 2)` for two at an
            angle :math:`\\theta`. Above 1000 there is a `NearlyDependentRows` warning.

    Raises:
        ValueError: if rows contradict each other, hardly differ, or are not finite, or the metric
            is not positive definite.
    """

    def __init__(
        self,
        rows: Rows,
        metric: str | ArrayLike = "kinematic",
        dtype: torch.dtype = torch.float32,
        device: str | torch.device = "cpu",
    ) -> None:
        check_precision(dtype)
        check_device(device)
        rows = check_rows(rows, dtype)
        self.given, self.dtype = len(rows.y), dtype
        covariance, spread, _ = of_metric(metric)
        self.keep, self.condition, worst, groups, observed = independent_rows(rows, covariance)
        if self.condition > NEARLY_DEPENDENT:
            warnings.warn(
                f"{name_nearest(rows, covariance, worst)} are nearly dependent: condition number "
                f"{self.condition:.3g}", NearlyDependentRows, stacklevel=2,
            )  # fmt: skip
        inner = torch.float64 if self.condition > WELL_CONDITIONED else dtype
        self.solves = solves_needed(self.condition, inner)
        self.pinned, exact = pinned_coordinates(rows, device)
        self.exact = torch.as_tensor(exact, device=device)
        self.pins = torch.as_tensor(rows.y[exact], dtype=dtype, device=device)
        # Block by block, so that the residual of a block is a slice and needs no gathering.
        laid_out = [axis_by_axis(*group) for group in zip(groups, observed, strict=True)]
        order = np.concatenate([self.keep[:0], *(block.T.ravel() for block, _, _ in laid_out)])
        self.blocks, first = [], 0
        for block, dense, axes in laid_out:
            own = slice(first, first + block.size)
            self.blocks.append(Block(dense, rows.variance[block], own, axes, inner, device))
            first += block.size
        self.order = torch.as_tensor(order, device=device)
        self.frames = rows.A.shape[1] // (N_JOINTS * 3)
        row, column, value = entries_of(rows.A, order)
        self.A = SparseMap(row, column, value, len(order), inner, device)
        # Of a frame, only the coordinates that some row reads are ever pulled.
        frame, coordinate = np.divmod(column, N_JOINTS * 3)
        pulled, place = numbered(coordinate, N_JOINTS * 3)
        column, size = frame * len(pulled) + place, self.frames * len(pulled)
        self.back = SparseMap(column, row, value, size, inner, device)
        self.covariance = torch.as_tensor(spread[pulled], dtype=inner, device=device)
        self.y = torch.as_tensor(rows.y[order], dtype=inner, device=device)
        self.noise = torch.as_tensor(rows.variance[order], dtype=inner, device=device)
        self.hard = torch.as_tensor(rows.variance[order] == 0, device=device)
        self.firm = math.sqrt(torch.finfo(inner).eps)
        combined = ((rows.variance == 0) & ~is_coordinate(rows.A))[self.keep]
        self.refines = self.condition > WELL_CONDITIONED or bool(combined.any())

    def project(
        self,
        x1_hat: torch.Tensor,
        variance: torch.Tensor | None = None,
        known: Softness | None = None,
    ) -> torch.Tensor:
        """Move a motion, or a batch, the shortest way onto the rows.

        Args:
            x1_hat: ``(..., frames, 22, 3)`` metres, in the projector's precision and on its device.
            variance: ``(m,)`` or ``(batch, m)`` square metres, instead of that of the rows:
                0 makes a row hard, infinity leaves it out. Hard rows stay hard.
            known: what is known of variances that are 0 for hard rows, so that nobody has to look
                at them.

        Returns:
            The same shape. Pinned coordinates are bit-exact; gradients flow through. Where a motion
            is not finite, neither is what comes back.

        Raises:
            ValueError: if the shape does not end in ``(frames, 22, 3)``, the number of variances is
                not the number of rows, or the batches differ; if soft rows became so firm that they
                imply or contradict others.
        """
        check_motion(x1_hat, self.frames, self.dtype, self.y.device)
        x = x1_hat.reshape(-1, self.frames * N_JOINTS * 3).to(self.y.dtype)
        check_batch(self.y, len(x), "targets")
        if variance is None:
            known = AS_GIVEN
        else:
            variance = check_variance(variance, self.given, len(x), known is not None).to(self.y)
            variance = variance.index_select(-1, self.order)
            if known is None:
                known = Softness(lowest(variance.masked_fill(self.hard, torch.inf)))
                variance = variance.masked_fill(self.hard, 0.0)
            variance = variance.expand(len(x), -1)
        z = self.solve(self.y - self.A(x), variance, known.alike)
        x = self.moved(x, z)
        # Iterative refinement: what rounding left over of S z = y - A x1_hat, removed. Where hard
        # rows are single coordinates and well conditioned there is no need: they are set below.
        for _ in range(self.solves - 1 if self.refines else 0):
            more = self.solve(self.left(x, z, variance), variance, known.alike)
            x, z = self.moved(x, more), z + more
        if variance is not None and known.firmest <= self.firm:
            check_solved(self.left(x, z, variance) * (variance < torch.inf), self.firm)
        # The exact value is known, so the last bit need not be left to arithmetic.
        exact = self.pins.expand(len(x), -1)
        return x.to(self.dtype).index_copy_(-1, self.pinned, exact).reshape(x1_hat.shape)

    def left(self, x: torch.Tensor, z: torch.Tensor, variance: torch.Tensor | None) -> torch.Tensor:
        r"""What is left over of :math:`S z = y - A \hat x_1` where `x` was moved by z."""
        if variance is None:
            return self.y - self.A(x) - self.noise * z
        return self.y - self.A(x) - torch.where(variance < torch.inf, variance, 0.0) * z

    def residual(self, x1: torch.Tensor) -> float:
        """Largest ``|A x - y|`` over the hard rows, metres; 0 if there are none.

        Args:
            x1: ``(..., frames, 22, 3)`` metres.
        """
        check_motion(x1, self.frames, self.dtype, self.y.device)
        x = x1.reshape(-1, self.frames * N_JOINTS * 3).to(self.y.dtype)
        check_batch(self.y, len(x), "targets")
        miss = (self.A(x) - self.y).abs()
        return float(miss[:, self.hard].max()) if self.hard.any() else 0.0

    def solve(
        self, residual: torch.Tensor, variance: torch.Tensor | None, alike: bool = False
    ) -> torch.Tensor:
        r"""Solve :math:`(A R^{-1} A^\top + \Sigma) z = r`, block by block, for ``(batch, m)``."""
        parts = [block.solve(residual, variance, alike) for block in self.blocks]
        return parts[0] if len(parts) == 1 else torch.cat([residual[:, :0], *parts], 1)

    def axes_alike(self, table: torch.Tensor) -> bool:
        """Whether rows that differ in axis only have equal columns in a table ``(k, m)``."""
        ordered = table[:, self.order]
        return all(block.axes_alike(ordered) for block in self.blocks)

    def moved(self, x: torch.Tensor, z: torch.Tensor) -> torch.Tensor:
        r"""Add :math:`R^{-1} A^\top z`: put ``(batch, m)`` on the joints, and let it spread."""
        pulled = self.back(z).view(len(z) * self.frames, len(self.covariance))
        coordinates = x.reshape(len(pulled), -1)
        return torch.addmm(coordinates, pulled, self.covariance).view_as(x)

    def aimed_at(self, y: ArrayLike | torch.Tensor) -> Projector:
        """The same rows with other targets, one set for each motion of a batch.

        The factorisation does not depend on the targets and is shared.

        Args:
            y: ``(batch, m)`` or ``(m,)``, metres, in the order of the rows. Gradients flow through
                a tensor.

        Raises:
            ValueError: if rows were redundant, for then new targets could contradict each other,
                or if their number does not match.
        """
        if len(self.keep) != self.given:
            raise ValueError("Projector: redundant rows cannot be aimed elsewhere")
        targets = as_targets(y, self.given).to(self.y)
        other = copy(self)
        other.y = targets.index_select(-1, self.order)
        other.pins = targets[..., self.exact].to(self.dtype)
        return other


def pinned_coordinates(rows: Rows, device: str | torch.device) -> tuple[torch.Tensor, NDArray]:
    """Columns of the coordinates that hard rows give alone, and one such row for each."""
    pins = np.flatnonzero((rows.variance == 0) & is_coordinate(rows.A))
    columns, first = np.unique(rows.A.indices[rows.A.indptr[pins]], return_index=True)
    return torch.as_tensor(columns, device=device).long(), pins[first]


WELL_CONDITIONED = 50.0
"""Up to this condition number two solves in float32 leave nothing but rounding."""


def solves_needed(condition: float, dtype: torch.dtype) -> int:
    """How often to solve until the hard rows are met to rounding, the first time included.

    A solve multiplies what is missing by about the precision times the square of the condition
    number, which is that of the matrix S.
    """
    precision = torch.finfo(dtype).eps
    return max(2, math.ceil(math.log(precision) / math.log(precision * condition**2)))
