r"""The exact solve of ProjFlow eq. 7, fast enough to drag.

.. math:: \hat x_1^* = \hat x_1 + R^{-1} A^\top (A R^{-1} A^\top + \Sigma)^{-1} (y - A \hat x_1)

The metric couples joints, never frames or axes: :math:`R^{-1} = I_N \otimes R_J^{-1} \otimes I_3`.
So :math:`S = A R^{-1} A^\top + \Sigma` falls apart into small blocks of rows that share a frame and
an axis. Blocks are found once and inverted once; a later projection is two sparse products, a
small matrix for each block and one 22 x 22 product for each frame. Where :math:`\Sigma` changes,
only the blocks are inverted anew.
"""

from __future__ import annotations

import math
import warnings
from copy import copy

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray
from scipy import sparse

from projflow_lite.constraints import Rows, is_coordinate
from projflow_lite.equations import joint_metric, kinematic_laplacian
from projflow_lite.projection_checks import (
    as_targets,
    check_batch,
    check_device,
    check_motion,
    check_precision,
    check_rows,
    check_solved,
    check_variance,
    holds,
)
from projflow_lite.row_blocks import (
    blocks_of_rows,
    dense_blocks,
    independent_rows,
    name_nearest,
    observed_covariance,
)
from projflow_lite.skeleton import EDGES, N_JOINTS, number_array, shown


def kinematic_joint_metric(w_kin: float = 10.0, ridge: float = 1.0) -> NDArray:
    r"""The skeleton's metric on one frame and axis, :math:`R_J = w L + \lambda I` (eq. 50)."""
    return joint_metric(kinematic_laplacian(EDGES, N_JOINTS), w_kin, ridge)


NEARLY_DEPENDENT = 1e3
"""Condition number of the rows above which a person is warned."""


class NearlyDependentRows(UserWarning):
    """Rows all but repeat each other: a small disagreement of their targets moves the body far."""


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
        covariance = np.linalg.inv(check_metric(metric))
        self.keep, self.condition, worst = independent_rows(rows, covariance)
        if self.condition > NEARLY_DEPENDENT:
            warnings.warn(
                f"{name_nearest(rows, covariance, worst)} are nearly dependent: condition number "
                f"{self.condition:.3g}", NearlyDependentRows, stacklevel=2,
            )  # fmt: skip
        inner = torch.float64 if self.condition > WELL_CONDITIONED else dtype
        self.solves = solves_needed(self.condition, inner)
        self.pinned, exact = pinned_coordinates(rows, device)
        self.exact = torch.as_tensor(exact, device=device)
        self.kept = torch.as_tensor(self.keep, device=device)
        self.pins = torch.as_tensor(rows.y[exact], dtype=dtype, device=device)
        rows = Rows(rows.A[self.keep], rows.y[self.keep], rows.variance[self.keep])
        self.frames = rows.A.shape[1] // (N_JOINTS * 3)
        self.A = SparseMap(rows.A, inner, device)
        self.back = SparseMap(rows.A.T.tocsr()[joints_last(self.frames)], inner, device)
        self.covariance = torch.as_tensor(covariance, dtype=inner, device=device)
        self.y = torch.as_tensor(rows.y, dtype=inner, device=device)
        self.noise = torch.as_tensor(rows.variance, dtype=inner, device=device)
        self.hard = torch.as_tensor(rows.variance == 0, device=device)
        self.firm = math.sqrt(torch.finfo(inner).eps)
        observed = observed_covariance(rows.A, covariance)
        self.blocks = [
            Block(observed, rows.variance, index, inner, device) for index in blocks_of_rows(rows.A)
        ]

    def project(self, x1_hat: torch.Tensor, variance: torch.Tensor | None = None) -> torch.Tensor:
        """Move a motion, or a batch, the shortest way onto the rows.

        Args:
            x1_hat: ``(..., frames, 22, 3)`` metres, in the projector's precision and on its device.
            variance: ``(m,)`` or ``(batch, m)`` square metres, instead of that of the rows:
                0 makes a row hard, infinity leaves it out. Hard rows stay hard.

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
        if variance is not None:
            variance = check_variance(variance, self.given, len(x)).to(self.y)
            variance = torch.where(self.hard, 0.0, variance[..., self.kept]).expand(len(x), -1)
        inverses = [block.inverse_for(variance) for block in self.blocks]
        noise = self.noise if variance is None else torch.where(variance < torch.inf, variance, 0.0)
        z = self.solve(self.y - self.A(x), inverses)
        x = x + self.spread(z)
        # Iterative refinement: what rounding left over of S z = y - A x1_hat, removed.
        for _ in range(self.solves - 1):
            more = self.solve(self.y - self.A(x) - noise * z, inverses)
            x, z = x + self.spread(more), z + more
        if variance is not None and not holds(variance + self.hard > self.firm):
            check_solved((self.y - self.A(x) - noise * z) * (variance < torch.inf), self.firm)
        # The exact value is known, so the last bit need not be left to arithmetic.
        exact = self.pins.expand(len(x), -1)
        return x.to(self.dtype).index_copy(-1, self.pinned, exact).reshape(x1_hat.shape)

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

    def solve(self, residual: torch.Tensor, inverses: list[torch.Tensor]) -> torch.Tensor:
        r"""Solve :math:`(A R^{-1} A^\top + \Sigma) z = r`, block by block, for ``(batch, m)``."""
        z = torch.zeros_like(residual)
        for block, inverse in zip(self.blocks, inverses, strict=True):
            part = (inverse * residual[:, block.index].unsqueeze(-2)).sum(-1)
            z = z.index_copy(1, block.index.flatten(), part.flatten(1))
        return z

    def spread(self, z: torch.Tensor) -> torch.Tensor:
        r"""Apply :math:`R^{-1} A^\top` to ``(batch, m)``: put it on the joints, let it spread."""
        pulled = self.back(z).view(len(z), self.frames, 3, N_JOINTS)
        return (pulled @ self.covariance).mT.flatten(1)

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
        other.y, other.pins = targets, targets[..., self.exact].to(self.dtype)
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


def joints_last(frames: int) -> NDArray:
    """Coordinates of a motion in the order (frame, axis, joint), in which the metric is a block."""
    return np.arange(frames * N_JOINTS * 3).reshape(frames, N_JOINTS, 3).swapaxes(1, 2).ravel()


class Block:
    """Blocks of equal size, each coupling the rows of one frame and axis.

    Args:
        observed: ``(m, m)``, the matrix A R⁻¹ Aᵀ.
        variance: ``(m,)`` of the rows.
        index: ``(blocks, size)`` the rows of each block.
        dtype: of the residuals that come later.
        device: where they live.
    """

    def __init__(
        self,
        observed: sparse.csr_matrix,
        variance: NDArray,
        index: NDArray,
        dtype: torch.dtype,
        device: str | torch.device,
    ) -> None:
        dense = dense_blocks(observed, index)
        inverse = np.linalg.inv(dense + variance[index][..., None] * np.eye(index.shape[1]))
        self.index = torch.as_tensor(index, device=device)
        self.dense = torch.as_tensor(dense, dtype=dtype, device=device)
        self.inverse = torch.as_tensor(inverse, dtype=dtype, device=device)

    def inverse_for(self, variance: torch.Tensor | None) -> torch.Tensor:
        """Inverse of every block, ``(blocks, size, size)``, or one set for each motion.

        Args:
            variance: ``(batch, m)``, or None for that of the rows.
        """
        if variance is None:
            return self.inverse
        v = variance[:, self.index]
        active = torch.isfinite(v)
        # A row without information is cut out: it neither couples to the others nor acts.
        mask = active[..., :, None] & active[..., None, :]
        S = self.dense * mask + torch.diag_embed(torch.where(active, v, 1.0))
        return invert(S) * mask


LARGEST_IN_LOCKSTEP = 12


def invert(S: torch.Tensor) -> torch.Tensor:
    """Invert positive definite matrices ``(..., n, n)``.

    A projection has hundreds of small ones, and a call of LAPACK for each costs more than its
    arithmetic. So small ones are eliminated (Gauss and Jordan) all at once, column by column;
    being positive definite, they need no pivoting.
    """
    n = S.shape[-1]
    if n > LARGEST_IN_LOCKSTEP:
        return torch.linalg.inv(S)
    inverse = torch.eye(n, dtype=S.dtype, device=S.device).expand_as(S)
    for k in range(n):
        pivot = S[..., k : k + 1, k : k + 1]
        row, row_inverse = S[..., k : k + 1, :] / pivot, inverse[..., k : k + 1, :] / pivot
        # Every row loses its multiple of row k; row k itself is left with its scaled self.
        factor = S[..., :, k : k + 1] - torch.eye(n, dtype=S.dtype, device=S.device)[:, k : k + 1]
        S, inverse = S - factor * row, inverse - factor * row_inverse
    return inverse


class SparseMap:
    """A sparse matrix applied to the last dimension of a dense batch, with gradients.

    Written as gather, multiply, scatter-add because torch's own sparse product takes only one
    layout per device; three lines serve them all.
    """

    def __init__(
        self, matrix: sparse.spmatrix, dtype: torch.dtype, device: str | torch.device
    ) -> None:
        entries = sparse.coo_matrix(matrix)
        self.shape = entries.shape
        self.row = torch.as_tensor(entries.row, device=device).long()
        self.column = torch.as_tensor(entries.col, device=device).long()
        self.value = torch.as_tensor(entries.data, dtype=dtype, device=device)

    def __call__(self, x: torch.Tensor) -> torch.Tensor:
        """Return ``matrix @ x`` for every vector of the batch ``(batch, columns)``."""
        products = x[:, self.column] * self.value
        return x.new_zeros(len(x), self.shape[0]).index_add(1, self.row, products)


def check_metric(metric: str | ArrayLike) -> NDArray:
    """The joint metric as a positive definite ``(22, 22)`` array, or an error that says why not."""
    if isinstance(metric, str):
        known = {"kinematic": kinematic_joint_metric(), "euclidean": np.eye(N_JOINTS)}
        if metric not in known:
            raise ValueError(f"Projector: metric is one of {', '.join(known)}, not {shown(metric)}")
        return known[metric]
    R_J = number_array(metric, "Projector: the metric").astype(np.float64)
    if R_J.shape != (N_JOINTS, N_JOINTS) or not np.isfinite(R_J).all():
        raise ValueError(f"Projector: a metric is a symmetric ({N_JOINTS}, {N_JOINTS}) matrix")
    if not np.allclose(R_J, R_J.T, rtol=1e-10, atol=1e-12 * np.abs(R_J).max()):
        raise ValueError("Projector: the metric is not symmetric")
    eigenvalues = np.linalg.eigvalsh(R_J)
    # A negative eigenvalue's rounding is that of the largest.
    if eigenvalues[0] <= 1e-13 * eigenvalues[-1]:
        raise ValueError("Projector: the metric is not positive definite")
    return R_J
