r"""How far a motion is from a linear wish, for methods that walk downhill on it.

.. math:: F(x) = \tfrac12 \sum_i w_i\, (A x - y)_i^2, \qquad \nabla F(x) = A^\top W (A x - y)

A soft row counts less, :math:`w = 1 / (1 + \sigma^2)` with the variance in square metres: a full
step on a lone soft pin then goes as far as ProjFlow's eq. 7 does with R = I.

No step length suits pins and averages over a whole body alike. So steps are given as shares of
:math:`1 / \beta`, where :math:`\beta` is the largest eigenvalue of :math:`A^\top W A`: a step of 1
never overshoots, and on pins it arrives.
"""

from __future__ import annotations

from copy import copy

import numpy as np
import torch
from numpy.typing import ArrayLike

from projflow_lite.constraints import Rows, Wish
from projflow_lite.projection_checks import as_targets, check_batch, check_motion, check_rows
from projflow_lite.row_blocks import blocks_of_rows, dense_blocks, independent_rows
from projflow_lite.skeleton import N_JOINTS, shown
from projflow_lite.sparse_map import SparseMap


class Misfit:
    """The rows of a wish as a function that torch can differentiate, and its gradient.

    Args:
        wish: what should hold. Rows that others imply are left out.
        frames: of the motion.
        dtype: of the motions.

    Attributes:
        weight: ``(m,)`` of each row, w.
        steepness: largest eigenvalue of the curvature of F.

    Raises:
        ValueError: for a wish that does not fit the motion or contradicts itself.
    """

    def __init__(self, wish: Wish, frames: int, dtype: torch.dtype = torch.float32) -> None:
        if not isinstance(wish, Wish):
            raise ValueError(f"Misfit: a wish is made by pin and others, not {shown(wish)}")
        rows = check_rows(wish.rows(frames), dtype)
        self.frames, self.dtype, self.given = frames, dtype, len(rows.y)
        keep = np.sort(independent_rows(rows, np.eye(N_JOINTS)).keep)
        rows = Rows(rows.A[keep], rows.y[keep], rows.variance[keep])
        weight = 1 / (1 + rows.variance)
        self.steepness = largest_curvature(rows, weight)
        self.A, self.back = (SparseMap.of(matrix, dtype) for matrix in (rows.A, rows.A.T))
        self.y, self.weight = (torch.as_tensor(v, dtype=dtype) for v in (rows.y, weight))
        self.hard = torch.as_tensor(rows.variance == 0)

    def __call__(self, x: torch.Tensor) -> torch.Tensor:
        """What is missed by every row, :math:`A x - y`, ``(batch, m)``; gradients flow through.

        Args:
            x: ``(batch, frames, 22, 3)``, metres.
        """
        check_motion(x, self.frames, self.dtype, self.y.device)
        check_batch(self.y, len(x), "targets")
        return self.A(x.flatten(1)) - self.y

    def loss(self, x: torch.Tensor) -> torch.Tensor:
        """F of each motion, ``(batch,)``; gradients flow through."""
        return 0.5 * (self.weight * self(x).square()).sum(1)

    def gradient(self, x: torch.Tensor) -> torch.Tensor:
        """Gradient of F, the shape of `x`."""
        return self.back(self.weight * self(x)).view_as(x)

    def descend(self, x: torch.Tensor, step: float = 1.0) -> torch.Tensor:
        """Take one gradient step on F.

        Args:
            x: ``(batch, frames, 22, 3)``, metres.
            step: its length, in units in which 1 never overshoots.
        """
        return x - step / self.steepness * self.gradient(x)

    def residual(self, x: torch.Tensor) -> float:
        """Largest miss of a hard row, metres; 0 if there is none."""
        return float(self(x).abs()[:, self.hard].max()) if self.hard.any() else 0.0

    def aimed_at(self, y: ArrayLike) -> Misfit:
        """The same rows with other targets, one set for each motion of a batch.

        Args:
            y: ``(batch, m)``, in the order of the wish's rows.

        Raises:
            ValueError: if rows were redundant, or the number of targets does not match.
        """
        if len(self.weight) != self.given:
            raise ValueError("Misfit: redundant rows cannot be aimed elsewhere")
        other = copy(self)
        other.y = as_targets(y, self.given).to(self.y)
        return other


def largest_curvature(rows: Rows, weight: np.ndarray) -> float:
    r"""Largest eigenvalue of :math:`A^\top W A`, which is that of :math:`W^{1/2} A A^\top W^{1/2}`.

    The latter falls apart into small blocks of rows.
    """
    scaled = rows.A.multiply(np.sqrt(weight)[:, None]).tocsr()
    squares = (scaled @ scaled.T).tocsr()
    blocks = [dense_blocks(squares, index) for index in blocks_of_rows(rows.A)]
    return max(float(np.linalg.eigvalsh(block).max()) for block in blocks)
