"""Many small systems at once: the blocks of rows that share a frame and an axis."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import torch
from numpy.typing import NDArray


def axis_by_axis(block: NDArray, dense: NDArray) -> tuple[NDArray, NDArray, int]:
    """Put all blocks of x before those of y before those of z, where the three are alike.

    Args:
        block: ``(blocks, size)`` rows, frame after frame, see `row_blocks.blocks_of_rows`.
        dense: ``(blocks, size, size)`` their parts of A R⁻¹ Aᵀ.

    Returns:
        Both in that order, and how many axes are alike: 3; or as they are, and 1.
    """
    in_threes = np.arange(len(dense) // 3 * 3).reshape(-1, 3)
    if len(dense) % 3 or not (dense[in_threes] == dense[in_threes[:, :1]]).all():
        return block, dense, 1
    order = in_threes.T.ravel()
    return block[order], dense[order], 3


class Block:
    """Blocks of equal size, each coupling the rows of one frame and axis.

    Args:
        dense: ``(blocks, size, size)``, their parts of A R⁻¹ Aᵀ.
        variance: ``(blocks, size)`` of their rows.
        own: where their rows are: the first row of every block, then the second of every one.
        axes: how many equal parts the blocks come in, see `axis_by_axis`.
        dtype: of the residuals that come later.
        device: where they live.
    """

    def __init__(
        self,
        dense: NDArray,
        variance: NDArray,
        own: slice,
        axes: int,
        dtype: torch.dtype,
        device: str | torch.device,
    ) -> None:
        self.own, self.axes, (self.count, self.size) = own, axes, variance.shape
        self.observed, self.variance = dense, variance
        rows_first = np.moveaxis(dense, 0, -1)
        self.dense = torch.tensor(rows_first, dtype=dtype, device=device)

    @cached_property
    def inverse(self) -> torch.Tensor:
        """Of every block with the variance of its rows, ``(blocks, size, size)``."""
        inverse = np.linalg.inv(self.observed + self.variance[..., None] * np.eye(self.size))
        return torch.as_tensor(inverse, dtype=self.dense.dtype, device=self.dense.device)

    def axes_alike(self, table: torch.Tensor) -> bool:
        """Whether the rows of all axes have equal columns in a table ``(k, m)``."""
        own = table[:, self.own].unflatten(1, (self.size, self.axes, -1))
        return bool((own == own[:, :, :1]).all())

    def solve(
        self, residual: torch.Tensor, variance: torch.Tensor | None, alike: bool = False
    ) -> torch.Tensor:
        """Solve every block for ``(batch, m)`` residuals, ``(batch, own rows)``.

        Args:
            residual: ``(batch, m)``.
            variance: ``(batch, m)``, infinite where a row is left out; None for that of the rows.
            alike: whether the variances of all axes are equal. Then one elimination serves three.
        """
        batch = len(residual)
        if variance is None:
            r = residual[:, self.own].unflatten(1, (self.size, self.count)).permute(2, 1, 0)
            # For a single motion torch's product of matrices pays a call for each block.
            z = (self.inverse * r.mT).sum(2, keepdim=True) if batch == 1 else self.inverse @ r
            return z.permute(2, 1, 0).flatten(1)
        # Rows first, then motions, then blocks: every turn of the elimination is then a product of
        # long contiguous stretches.
        shape = (self.size, self.axes if alike else 1, -1)
        r = residual[:, self.own].unflatten(1, shape).permute(1, 2, 0, 3)
        v = variance[:, self.own].unflatten(1, shape)[:, :, 0].movedim(1, 0)
        C = self.dense[..., : v.shape[-1]].unsqueeze(2).expand(-1, -1, batch, -1)
        return eliminate(C, v, r).permute(2, 0, 1, 3).flatten(1)


LARGEST_IN_LOCKSTEP = 12
"""Rows of a block up to which blocks are eliminated together; more are worth a call of LAPACK."""


def eliminate(C: torch.Tensor, variance: torch.Tensor, r: torch.Tensor) -> torch.Tensor:
    r"""Solve :math:`(C + \operatorname{diag} \sigma^2)\, z = r` for many small C at once.

    Gauss and Jordan, in lockstep: the first row explains what it can of all others and goes to the
    end. After as many turns as a block has rows they are in their old order, and what is left is z.
    So hundreds of blocks take as many steps as one block has rows, instead of a call of LAPACK for
    each. Being positive definite, C needs no pivoting. A row of infinite variance explains nothing
    and gets z = 0, by the rules of arithmetic.

    Args:
        C: ``(n, n, ...)`` positive semidefinite.
        variance: ``(n, ...)``, 0 to infinity.
        r: ``(n, k, ...)``, k right-hand sides for each.
    """
    if len(C) > LARGEST_IN_LOCKSTEP:
        return solve_one_by_one(C, variance, r)
    system = torch.cat([C, r], 1)
    for own in variance:
        first = system[0, 1:] / (system[0, 0] + own)
        others = torch.addcmul(system[1:, 1:], system[1:, :1], first, value=-1)
        system = torch.cat([others, first[None]])
    return system


def solve_one_by_one(C: torch.Tensor, variance: torch.Tensor, r: torch.Tensor) -> torch.Tensor:
    """The same for large blocks, by LAPACK; rows of infinite variance are cut out."""
    C, r = (part.movedim((0, 1), (-2, -1)) for part in (C, r))
    variance = variance.movedim(0, -1)
    active = torch.isfinite(variance)
    mask = active[..., :, None] & active[..., None, :]
    S = C * mask + torch.diag_embed(torch.where(active, variance, 1.0))
    return (torch.linalg.solve(S, r) * active[..., None]).movedim((-2, -1), (0, 1))
