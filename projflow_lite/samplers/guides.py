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
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from scipy import sparse

from projflow_lite.constraints import Rows, is_coordinate
from projflow_lite.equations import influence_weights
from projflow_lite.joint_metric import worked_out
from projflow_lite.row_blocks import numbered
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


class Halo(NamedTuple):
    """Which guides act around the keyframes at one radius; tensors ``(m + guides,)``.

    Attributes:
        parts: by what the trust of the frame is divided for this row; 1 for rows of the wish.
        start: what `r` over the trust is added to: minus `r`, infinity where no guide acts, and
            the given variance for rows of the wish.
    """

    parts: torch.Tensor
    start: torch.Tensor


@lru_cache(maxsize=8)
def shares(metric: bytes, form: str) -> NDArray:
    """Weights of the joints (eq. 51) of a joint metric, worked out once for each."""
    return influence_weights(np.frombuffer(metric).reshape(N_JOINTS, N_JOINTS), form)


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
        ones = np.ones(len(place.column))
        self.rows = Rows(
            with_coordinates(rows.A, place.column),
            self.targets(rows.y),
            np.concatenate([rows.variance, ones]),
        )
        self.distance = torch.as_tensor(place.distance)
        metric, self.column = np.asarray(R_J, float).tobytes(), place.column
        q = shares(metric, self.settings.form)
        covariance, _, root = worked_out(metric)
        r = np.diagonal(covariance)  # eq. 18
        # Every row of the wish stands in these tables too, with r = 0: its variance is given.
        frame, joint = np.divmod(place.column // 3, N_JOINTS)
        none = np.zeros(len(rows.y), dtype=int)
        self.frame = torch.as_tensor(np.concatenate([none, frame]))
        self.r = torch.as_tensor(np.concatenate([none, r[joint]]), dtype=dtype)
        self.C = torch.as_tensor(root, dtype=dtype)
        self.given = rows.variance
        self.share_out(q)

    def __len__(self) -> int:
        """Number of guides."""
        return len(self.distance)

    def share_out(self, q: NDArray) -> None:
        """Make the halos: a joint takes part where any of its axes has a guide near.

        Args:
            q: ``(22,)`` weights of the joints.
        """
        c, distance, self.q = self.settings, self.distance.numpy(), q
        # Distances are whole numbers: they are below a radius if they are below it rounded up.
        last = min(math.ceil(c.l_max), self.frames)
        self.smallest = min(math.ceil(c.l_min), last)
        radius = np.arange(self.smallest, last + 1)[:, None]
        nearest = np.full(self.frames * N_JOINTS, np.inf)
        np.minimum.at(nearest, self.column // 3, distance)
        near = nearest.reshape(self.frames, N_JOINTS) < radius[..., None]
        frame, joint = np.divmod(self.column // 3, N_JOINTS)
        parts = np.where(near, q, 0).sum(-1).clip(min=1e-12)[:, frame] / q[joint]
        r = self.r.numpy()[len(self.given) :]
        start = np.where(distance < radius, -r, np.inf)
        given = np.broadcast_to(self.given, (len(radius), len(self.given)))
        tables = (np.ones_like(given), parts), (given, start)
        as_rows = [torch.as_tensor(np.hstack(table), dtype=self.r.dtype) for table in tables]
        self.halos = [Halo(*rows) for rows in zip(*as_rows, strict=True)]
        soft = np.concatenate([self.given[self.given > 0], r * (1 / c.pi_max - 1)])
        self.firmest = float(soft.min(initial=np.inf))

    def table(self) -> torch.Tensor:
        """All that variances of rows depend on but the motion, ``(k, m + guides)``."""
        return torch.stack([self.frame, self.r, *(row for halo in self.halos for row in halo)])

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
        inverse = self.caution(x1_hat) / (self.tau(t) * c.c0)  # 1 / trust of the frame, eq. 15
        if c.form == "released":
            inverse = inverse.clamp(1 / c.pi_max, 1 / c.pi_min)
        halo = self.halos[min(math.ceil(radius) - self.smallest, len(self.halos) - 1)]
        inverse = inverse.index_select(1, self.frame) * halo.parts  # 1 / pi of the row, eq. 52
        inverse = inverse.clamp(1 / c.pi_max, 1 / c.pi_min)
        return torch.addcmul(halo.start, self.r, inverse)  # r / pi - r: eq. 18, 47

    def frame_trust(self, x1_hat: torch.Tensor, t: float) -> torch.Tensor:
        """Trust in the guides of each frame before it is shared out, ``(batch, frames)``."""
        return self.tau(t) * self.settings.c0 / self.caution(x1_hat)  # eq. 15

    def tau(self, t: float) -> float:
        """Share of the trust that is left at time `t` (eq. 16)."""
        return self.settings.tau_min + (1 - self.settings.tau_min) * (1 - t)

    def caution(self, x1_hat: torch.Tensor) -> torch.Tensor:
        """By how much the bend of each frame divides its trust, ``(batch, frames)``, 1 or more."""
        c = self.settings
        if self.frames < 3 or c.lambda_s == 0:
            return torch.ones_like(x1_hat[..., 0, 0])
        bend = x1_hat.flatten(2).diff(n=2, dim=1)
        s = torch.linalg.vector_norm(bend @ self.C, dim=2)  # eq. 17
        s = torch.cat([s[:, :1], s, s[:, -1:]], dim=1)
        # Where most frames rest the median is 0: those that bend are not trusted at all.
        ratio = s / middle(s, c.form).clamp(min=torch.finfo(s.dtype).tiny)
        return 1 + c.lambda_s * ratio**c.p  # the denominator of eq. 15


def middle(s: torch.Tensor, form: str) -> torch.Tensor:
    """Median along the last dimension, ``(..., 1)``; released: the lower one of an even number."""
    larger = s.topk(s.shape[-1] // 2 + 1, sorted=False).values
    if s.shape[-1] % 2 or form == "released":
        return larger.amin(-1, keepdim=True)
    return larger.topk(2, largest=False, sorted=False).values.mean(-1, keepdim=True)


def with_coordinates(A: sparse.csr_matrix, columns: NDArray) -> sparse.csr_matrix:
    """``A``, and below it rows that read off single coordinates."""
    data = np.concatenate([A.data, np.ones(len(columns))])
    ends = A.indptr[-1] + np.arange(1, len(columns) + 1)
    below = np.concatenate([A.indices, columns]), np.concatenate([A.indptr, ends])
    return sparse.csr_matrix((data, *below), (A.shape[0] + len(columns), A.shape[1]))


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
    coordinates, line = numbered(pinned % (N_JOINTS * 3), N_JOINTS * 3)
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
