r"""A projection that spreads a correction over time as well as over the body.

ProjFlow moves the frame of a keyframe and asks guides to drag the neighbours along (eq. 12-18).
Here the metric does it (`projflow_lite.equations.metric_over_time`): a keyframe's correction
reaches the other frames as far as one place of a walk tells of another, in one solve, without
guides and their constants.
"""

from __future__ import annotations

import math
from copy import copy
from dataclasses import dataclass, fields

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray
from scipy import sparse

from projflow_lite.constraints import Rows, Wish
from projflow_lite.equations import walk_covariance
from projflow_lite.joint_metric import check_metric
from projflow_lite.projection import Projector
from projflow_lite.projection_checks import check_motion
from projflow_lite.samplers.guides import GuideSettings
from projflow_lite.samplers.step import ProjectionStep
from projflow_lite.skeleton import FPS, N_JOINTS, shown
from projflow_lite.sparse_map import SparseMap

MOST_ENTRIES = 6000
"""Of A: the rows are solved together, which takes its square of memory and its cube of time."""


@dataclass(frozen=True)
class MovingMetric:
    """The constants of a metric over time.

    The synthetic data's pelvis moves at about 0.5 m/s on an axis of the ground, a velocity that it
    forgets in about 5 s. All of its clips start over the origin; a wish may start elsewhere, and
    so may the walk.

    Attributes:
        start: standard deviation of the walk's first place, metres; for this and the next two see
            `projflow_lite.equations.walk_covariance`.
        speed: standard deviation of its velocity, metres a second.
        memory: how long it keeps a velocity, seconds.
        until: flow time after which the metric stays as it is. At 1 it would end as one without
            time, and the last steps would pull single frames out of line.
        noise_std: of the flow's noise, metres.

    Raises:
        ValueError: for a constant that is no number above 0, or an `until` of 1 or more.
    """

    start: float = 0.3
    speed: float = 0.5
    memory: float = 5.0
    until: float = 0.95
    noise_std: float = 0.76

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            number = isinstance(value, int | float) and not isinstance(value, bool)
            if not number or not math.isfinite(value) or not value > 0:
                raise ValueError(
                    f"moving metric: {field.name} is a number above 0, not {shown(value)}"
                )
        if self.until >= 1:
            raise ValueError(f"moving metric: until is below 1, not {self.until}")


class MovingStep(ProjectionStep):
    """A `ProjectionStep` whose metric couples frames, and changes with flow time.

    All rows are first met together, in the metric over time; then hard ones are landed on once
    more, so that not even rounding is left.

    Args:
        wish: what must hold.
        frames: of the motion.
        metric: of time.
        dtype: of the motions.
        joints: metric of a frame, see `Projector`.

    Raises:
        ValueError: as `Projector`, and for a wish with more than `MOST_ENTRIES` numbers in it.
    """

    def __init__(
        self,
        wish: Wish,
        frames: int,
        metric: MovingMetric | None = None,
        dtype: torch.dtype = torch.float32,
        joints: str | ArrayLike = "kinematic",
    ) -> None:
        super().__init__(wish, frames, joints, dtype, guides=False)
        self.metric, rows = metric or MovingMetric(), wish.rows(frames)
        if rows.A.nnz > MOST_ENTRIES:
            raise ValueError(
                f"MovingStep: the wish has {rows.A.nnz} numbers, and at most {MOST_ENTRIES} can be "
                "solved together over time; ask for fewer frames, or take the kinematic metric"
            )
        hard = np.flatnonzero(rows.variance == 0)
        self.hard, self.landing = hard, self.projector
        if len(hard) < len(rows.y):
            firm = Rows(rows.A[hard], rows.y[hard], rows.variance[hard])
            self.landing = Projector(firm, joints, dtype)
        self.reach = Reach(rows, self.projector.keep, check_metric(joints), self.metric)

    def __call__(self, x1_hat: torch.Tensor, t: float) -> torch.Tensor:
        """Project ``(batch, frames, 22, 3)``, metres, as asked for at flow time `t`."""
        check_motion(x1_hat, self.projector.frames, self.projector.dtype, self.reach.y.device)
        x = x1_hat.reshape(-1, *x1_hat.shape[-3:])
        moved = x + self.reach.correction(x.double(), t).to(x.dtype)
        return self.landing.project(moved).view_as(x1_hat)

    def aimed_at(self, y: ArrayLike) -> MovingStep:
        """The same step with other targets, one set for each motion of a batch; see `Projector`."""
        y = np.asarray(y, float)
        other = copy(self)
        other.projector = self.projector.aimed_at(y)
        other.landing = self.landing.aimed_at(y[..., self.hard])
        other.reach = self.reach.aimed_at(y)
        return other


class Reach:
    r"""How far corrections reach: :math:`C A^\top (A C A^\top + \Sigma)^{-1} (y - A \hat x_1)`.

    C, the inverse of the metric, is a covariance over frames times one over joints. It is never
    written down: A has few numbers, and only what C says of their places is needed.

    Args:
        rows: of the wish.
        keep: which of them are independent.
        R_J: ``(22, 22)`` joint metric.
        metric: of time.
    """

    def __init__(self, rows: Rows, keep: NDArray, R_J: NDArray, metric: MovingMetric) -> None:
        A, spread = rows.A[keep], np.linalg.inv(R_J)
        self.metric, self.keep = metric, keep
        self.frames = A.shape[1] // (N_JOINTS * 3)
        walk = walk_covariance(self.frames, metric.start, metric.speed, metric.memory, FPS)
        self.sizes, self.waves = np.linalg.eigh(walk)
        self.joints = np.kron(spread / spread[0, 0], np.eye(3))
        self.A = SparseMap.of(A, torch.float64)
        self.back = SparseMap.of(A.T, torch.float64)
        entries = sparse.coo_matrix(A)
        self.frame, place = np.divmod(entries.col, N_JOINTS * 3)
        self.between = self.joints[np.ix_(place, place)]
        own = entries.row, np.arange(entries.nnz)
        self.collect = sparse.csr_matrix((entries.data, own), (len(keep), entries.nnz))
        self.noise = np.diag(rows.variance[keep])
        self.y = torch.as_tensor(rows.y[keep])

    def over_frames(self, t: float) -> NDArray:
        """Covariance ``(frames, frames)`` of the walk seen through the noise of flow time `t`."""
        t = min(t, self.metric.until)
        seen = (t / (1 - t) / self.metric.noise_std) ** 2
        return (self.waves * (self.sizes / (1 + seen * self.sizes))) @ self.waves.T

    def correction(self, x: torch.Tensor, t: float) -> torch.Tensor:
        """What to add to motions ``(batch, frames, 22, 3)`` at flow time `t`; all in float64."""
        C = self.over_frames(t)
        entries = C[np.ix_(self.frame, self.frame)] * self.between
        S = self.collect @ (self.collect @ entries).T + self.noise
        miss = self.y - self.A(x.flatten(1))
        z = torch.linalg.solve(torch.as_tensor(S), miss.mT).mT
        pulled = self.back(z).view(len(x), self.frames, -1)
        return (torch.as_tensor(C) @ pulled @ torch.as_tensor(self.joints)).view_as(x)

    def aimed_at(self, y: NDArray) -> Reach:
        """The same for other targets ``(batch, m)``."""
        other = copy(self)
        other.y = torch.as_tensor(y[..., self.keep])
        return other


def projection_step(
    wish: Wish,
    frames: int,
    metric: str | ArrayLike | MovingMetric = "kinematic",
    dtype: torch.dtype = torch.float32,
    guides: bool | GuideSettings = True,
) -> ProjectionStep:
    """The step of a wish: a `MovingStep` for a metric over time, else a `ProjectionStep`.

    Raises:
        ValueError: if constants of guides come with a metric over time, which needs no guides.
    """
    if isinstance(metric, str) and metric == "moving":
        metric = MovingMetric()
    if not isinstance(metric, MovingMetric):
        return ProjectionStep(wish, frames, metric, dtype, guides)
    if isinstance(guides, GuideSettings):
        raise ValueError("sample: a moving metric spreads keyframes itself; leave guides out")
    return MovingStep(wish, frames, metric, dtype)
