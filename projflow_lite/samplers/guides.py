r"""Guides between sparse keyframes: soft rows that fade as sampling goes on (ProjFlow eq. 13-18).

A keyframe alone pulls one frame and leaves its neighbours behind: the joint pops. So the straight
line between keyframes is asked for as well, softly, near the keyframes, and less and less:

.. math:: \sigma_i^2(t) = r_i \left(\frac{1}{\pi_i(t)} - 1\right)

with the trust :math:`\pi_i(t)` low where the predicted motion bends, and falling with time. Every
function here is a batched twin of one in ``equations/``, which the tests hold it against.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np
import torch
from numpy.typing import NDArray
from scipy import sparse

from projflow_lite.constraints import Rows, coordinate_rows, is_coordinate
from projflow_lite.equations import influence_weights, marginal_variance
from projflow_lite.skeleton import N_JOINTS, shown


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
        ValueError: for another form, a constant that is no finite number, or one out of range.
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
            raise ValueError(f"guides: form is 'printed' or 'released', not {shown(self.form)}")
        for field in fields(self):
            value = getattr(self, field.name)
            number = isinstance(value, int | float) and not isinstance(value, bool)
            if field.name != "form" and not (number and math.isfinite(value)):
                raise ValueError(f"guides: {field.name} is a finite number, not {shown(value)}")
        if not 0 <= self.l_min <= self.l_max:
            raise ValueError(
                f"guides: radii are 0 <= l_min <= l_max, not {self.l_min} and {self.l_max}"
            )
        if not 0 <= self.tau_min <= 1:
            raise ValueError(f"guides: tau_min is a share of 0 to 1, not {self.tau_min}")
        if self.c0 < 0 or self.lambda_s < 0 or self.p <= 0:
            raise ValueError(
                "guides: c0 and lambda_s are at least 0 and p above, "
                f"not {self.c0}, {self.lambda_s} and {self.p}"
            )
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
        as_tensor = lambda value: torch.tensor(np.array(value), dtype=dtype)  # noqa: E731
        frame, joint = np.divmod(place.column // 3, N_JOINTS)
        q = influence_weights(R_J, self.settings.form)
        self.frame, self.distance = torch.as_tensor(frame), as_tensor(place.distance)
        self.q, self.r = as_tensor(q[joint]), as_tensor(marginal_variance(R_J)[joint])
        # Trust is shared out among joints: one takes part where any of its axes has a guide near.
        point, of_row = np.unique(place.column // 3, return_inverse=True)
        nearest = np.full(len(point), np.inf)
        np.minimum.at(nearest, of_row, place.distance)
        self.point_frame = torch.as_tensor(point // N_JOINTS)
        self.point_distance, self.point_q = as_tensor(nearest), as_tensor(q[point % N_JOINTS])
        # With R_J = C Cᵀ, the length of eq. 17 is that of Cᵀ times the bend: one product of all.
        self.C = as_tensor(np.kron(np.linalg.cholesky(R_J), np.eye(3)))
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
        radius = (1 - t) * c.l_max + t * c.l_min  # eq. 14
        budget = self.frame_trust(x1_hat, t)
        if c.form == "released":
            budget = budget.clamp(c.pi_min, c.pi_max)
        q_near = self.point_q * (self.point_distance < radius)
        total = self.q.new_zeros(self.frames).index_add(0, self.point_frame, q_near)
        budget = budget / total.clamp(min=1e-12)
        pi = (budget.index_select(1, self.frame) * self.q).clamp(c.pi_min, c.pi_max)  # eq. 52
        sigma2 = self.r * (1 / pi - 1)  # eq. 18, 47
        soft = sigma2.masked_fill(self.distance >= radius, torch.inf)
        return torch.cat([self.given.expand(len(soft), -1), soft], dim=1)

    def frame_trust(self, x1_hat: torch.Tensor, t: float) -> torch.Tensor:
        """Trust in the guides of each frame before it is shared out, ``(batch, frames)``."""
        c = self.settings
        tau = c.tau_min + (1 - c.tau_min) * (1 - t)  # eq. 16
        if self.frames < 3:
            return torch.full_like(x1_hat[..., 0, 0], tau * c.c0)
        bend = x1_hat.flatten(2).diff(n=2, dim=1)
        s = torch.linalg.vector_norm(bend @ self.C, dim=2)  # eq. 17
        s = torch.cat([s[:, :1], s, s[:, -1:]], dim=1)
        ratio = (s / middle(s, c.form)).masked_fill(s == 0, 0.0)
        return tau * c.c0 / (1 + c.lambda_s * ratio**c.p)  # eq. 15


def middle(s: torch.Tensor, form: str) -> torch.Tensor:
    """Median along the last dimension, ``(..., 1)``; released: the lower one of an even number."""
    rising = s.sort(dim=-1).values
    low = (s.shape[-1] - 1) // 2
    high = low if form == "released" else s.shape[-1] // 2
    return (rising[..., low, None] + rising[..., high, None]) / 2


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
    coordinates, line = np.unique(pinned % (N_JOINTS * 3), return_inverse=True)
    pin = np.full((len(coordinates), frames), -1)
    pin[line, pinned // (N_JOINTS * 3)] = np.arange(len(pinned))
    frame = np.arange(frames)
    left = np.maximum.accumulate(np.where(pin >= 0, frame, -1), axis=1)
    right = np.minimum.accumulate(np.where(pin >= 0, frame, frames)[:, ::-1], axis=1)[:, ::-1]
    line, free = np.nonzero(pin < 0)
    left, right = left[line, free], right[line, free]
    # Outside the first and the last keyframe there is one neighbour, which stands for both.
    left, right = np.where(left < 0, right, left), np.where(right == frames, left, right)
    return Between(
        column=free * N_JOINTS * 3 + coordinates[line],
        before=pin[line, left],
        after=pin[line, right],
        share=(free - left) / np.maximum(right - left, 1) * (left != right),
        distance=np.minimum(np.abs(free - left), np.abs(right - free)),
    )
