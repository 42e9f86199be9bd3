r"""Guides between sparse keyframes: soft rows that fade as sampling goes on (ProjFlow eq. 13-18).

A keyframe alone pulls one frame and leaves its neighbours behind: the joint pops. So the straight
line between keyframes is asked for as well, softly, near the keyframes, and less and less:

.. math:: \sigma_i^2(t) = r_i \left(\frac{1}{\pi_i(t)} - 1\right)

with the trust :math:`\pi_i(t)` low where the predicted motion bends, and falling with time. Every
function here is a batched twin of one in ``equations/``, which the tests hold it against.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from scipy import sparse

from projflow_lite.constraints import Rows, coordinate_rows, is_coordinate
from projflow_lite.equations import influence_weights, marginal_variance
from projflow_lite.skeleton import N_JOINTS


@dataclass(frozen=True)
class GuideSettings:
    """The constants of ProjFlow's Table 5.

    Attributes:
        l_min, l_max: radius around a keyframe at the end and at the start, frames (eq. 14).
        tau_min: share of the trust that is left at the end (eq. 16).
        c0: strength (eq. 15).
        lambda_s, p: how much curvature lowers the trust (eq. 15).
        pi_min, pi_max: bounds of the trust (eq. 52). Table 5 has 1 for the upper one, which makes
            early guides as hard as keyframes; at 0.99 they stay soft.
        form: "printed" as in the paper, or "released" as in its public code: the lower median of
            the curvatures (eq. 15), squared norms (eq. 51), and a budget that is clipped before it
            is shared out as well as after (eq. 52).

    Raises:
        ValueError: for another form, or bounds that are not 0 < pi_min <= pi_max <= 1.
    """

    l_min: float = 3.0
    l_max: float = 10.0
    tau_min: float = 0.1
    c0: float = 3.0
    lambda_s: float = 1.0
    p: float = 2.0
    pi_min: float = 0.02
    pi_max: float = 0.99
    form: str = "printed"

    def __post_init__(self) -> None:
        if self.form not in ("printed", "released"):
            raise ValueError(f"guides: form is 'printed' or 'released', not {self.form!r}")
        if not 0 < self.pi_min <= self.pi_max <= 1:
            raise ValueError(
                "guides: trust is bounded by 0 < pi_min <= pi_max <= 1, "
                f"not {self.pi_min} and {self.pi_max}"
            )


class Guides:
    """The guides that belong to the hard pins of a wish.

    Args:
        rows: the wish as rows.
        R_J: ``(22, 22)`` joint metric.
        settings: constants, see `GuideSettings`.
        dtype: of the motions.
    """

    def __init__(
        self,
        rows: Rows,
        R_J: NDArray,
        settings: GuideSettings | None = None,
        dtype: torch.dtype = torch.float32,
    ) -> None:
        self.settings = settings or GuideSettings()
        self.frames = rows.A.shape[1] // (N_JOINTS * 3)
        pins = np.flatnonzero((rows.variance == 0) & is_coordinate(rows.A))
        place = between_keyframes(rows.A.indices[rows.A.indptr[pins]], self.frames)
        self.before, self.after, self.share = pins[place.before], pins[place.after], place.share
        guides = coordinate_rows(
            place.column, self.targets(rows.y)[len(rows.y) :], self.frames, 1.0
        )
        self.rows = Rows(
            sparse.vstack([rows.A, guides.A], format="csr"),
            np.concatenate([rows.y, guides.y]),
            np.concatenate([rows.variance, guides.variance]),
        )
        frame, joint = np.divmod(place.column // 3, N_JOINTS)
        as_tensor = lambda value: torch.tensor(np.array(value), dtype=dtype)  # noqa: E731
        self.frame, self.joint = torch.as_tensor(frame), torch.as_tensor(joint)
        self.distance = as_tensor(place.distance)
        self.R_J, self.q = as_tensor(R_J), as_tensor(influence_weights(R_J, self.settings.form))
        self.r = as_tensor(marginal_variance(R_J))
        self.given = as_tensor(rows.variance)

    def __len__(self) -> int:
        """Number of guides."""
        return len(self.distance)

    def targets(self, y: NDArray) -> NDArray:
        """Targets of all rows, ``(..., m + guides)``, for targets ``(..., m)`` of the wish."""
        line = (1 - self.share) * y[..., self.before] + self.share * y[..., self.after]
        return np.concatenate([y, line], axis=-1)

    def variance(self, x1_hat: torch.Tensor, t: float) -> torch.Tensor:
        """Variance of every row at time `t`, ``(batch, m + guides)``; infinity where none acts.

        Args:
            x1_hat: ``(batch, frames, 22, 3)`` predicted motion, metres.
            t: flow time.
        """
        c = self.settings
        near = self.distance < (1 - t) * c.l_max + t * c.l_min  # eq. 14
        budget = self.frame_trust(x1_hat, t)[:, self.frame]
        if c.form == "released":
            budget = budget.clamp(c.pi_min, c.pi_max)
        active = torch.zeros(self.frames, N_JOINTS, dtype=self.q.dtype)
        active[self.frame[near], self.joint[near]] = 1.0
        total = (active * self.q).sum(1)[self.frame].clamp(min=1e-12)
        pi = (budget * self.q[self.joint] / total).clamp(c.pi_min, c.pi_max)  # eq. 52
        sigma2 = self.r[self.joint] * (1 / pi - 1)  # eq. 18, 47
        soft = torch.where(near, sigma2, torch.inf)
        return torch.cat([self.given.expand(len(soft), -1), soft], dim=1)

    def frame_trust(self, x1_hat: torch.Tensor, t: float) -> torch.Tensor:
        """Trust in the guides of each frame before it is shared out, ``(batch, frames)``."""
        c = self.settings
        if self.frames < 3:
            ratio = torch.zeros(len(x1_hat), self.frames, dtype=x1_hat.dtype)
        else:
            bend = x1_hat.diff(n=2, dim=1)
            s = torch.einsum("bnjc,jk,bnkc->bn", bend, self.R_J, bend).clamp(min=0).sqrt()  # eq. 17
            s = torch.cat([s[:, :1], s, s[:, -1:]], dim=1)
            median = "midpoint" if c.form == "printed" else "lower"
            middle = s.quantile(0.5, dim=1, keepdim=True, interpolation=median)
            ratio = torch.where(s > 0, s / middle, 0.0)
        tau = c.tau_min + (1 - c.tau_min) * (1 - t)  # eq. 16
        return tau * c.c0 / (1 + c.lambda_s * ratio**c.p)  # eq. 15


@dataclass(frozen=True)
class Between:
    """Free coordinates of pinned joints and their nearest keyframes; every array is ``(guides,)``.

    Attributes:
        column: of the coordinate in a motion.
        before, after: position in the list of pins of the keyframes around it.
        share: how far it is from the one to the other, 0..1.
        distance: to the nearer one, frames.
    """

    column: NDArray
    before: NDArray
    after: NDArray
    share: NDArray
    distance: NDArray


def between_keyframes(pinned: NDArray, frames: int) -> Between:
    """Find the free frames of every pinned coordinate and the keyframes around them (B.2.1).

    Args:
        pinned: ``(pins,)`` columns of the pinned coordinates.
        frames: of the motion.
    """
    stride = N_JOINTS * 3
    parts: list[list[NDArray]] = [[np.zeros(0, int)] * 3 + [np.zeros(0)] * 2]
    for coordinate in np.unique(pinned % stride):
        mine = np.flatnonzero(pinned % stride == coordinate)
        mine = mine[np.argsort(pinned[mine], kind="stable")]
        keys = pinned[mine] // stride
        free = np.setdiff1d(np.arange(frames), keys)
        right = np.searchsorted(keys, free)
        left, right = (right - 1).clip(0), right.clip(max=len(keys) - 1)
        gap = np.maximum(keys[right] - keys[left], 1)
        share = np.where(left == right, 0.0, (free - keys[left]) / gap)
        distance = np.minimum(np.abs(free - keys[left]), np.abs(keys[right] - free))
        parts.append([free * stride + coordinate, mine[left], mine[right], share, distance])
    return Between(*(np.concatenate(column) for column in zip(*parts, strict=True)))
