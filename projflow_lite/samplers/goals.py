r"""What a motion should reach, as a function: anything that torch can differentiate.

A goal takes motions ``(batch, frames, 22, 3)`` in metres and returns ``(batch,)`` numbers, 0 where
it is reached (GMD section 4). Write one like this::

    def hands_together(x):
        return (x[:, :, 20] - x[:, :, 21]).norm(dim=-1).sum(1)

or take one of those below. A goal that looks at nothing but the pelvis in x and z, `on_ground`, is
one of a ground trajectory, and can guide a model of trajectories as well.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

import torch

from projflow_lite.constraints import Rows, Wish, is_coordinate
from projflow_lite.skeleton import FPS, joint_index
from projflow_lite.sparse_map import SparseMap

Goal = Callable[[torch.Tensor], torch.Tensor]


def reach(wish: Wish, p: float = 1.0) -> Goal:
    r"""Come close to a wish: for pins the goal of keyframes, and whatever else rows can say.

    .. math:: G(x) = \sum_i \lVert (A x - y)^{(i)} \rVert_p

    A group i is one pinned joint in one frame; a row that is no pin is a group by itself. A row's
    variance plays no part.

    Args:
        wish: rows on motions of the length that will be sampled.
        p: which norm, 1 or more.

    Raises:
        ValueError: if p is below 1.

    Source: GMD eq. 12, for any linear wish.
    """
    if not 1 <= p < float("inf"):
        raise ValueError(f"reach: p is a finite number of at least 1, not {p}")

    @lru_cache(maxsize=4)
    def prepared(frames: int) -> tuple[SparseMap, torch.Tensor, torch.Tensor]:
        rows = wish.rows(frames)
        return SparseMap.of(rows.A, torch.float64), torch.as_tensor(rows.y), groups_of(rows)

    def goal(x: torch.Tensor) -> torch.Tensor:
        A, y, group = prepared(x.shape[1])
        miss = (A(x.flatten(1).double()) - y).abs().to(x.dtype)
        if p == 1:
            return miss.sum(1)
        total = miss.new_zeros(len(x), int(group.max()) + 1).index_add(1, group, miss**p)
        # A root of 0 has no slope. Where a keyframe is met, 1 stands in for it and counts as 0.
        return torch.where(total > 0, total, 1.0).pow(1 / p).mul(total > 0).sum(1)

    return goal


def groups_of(rows: Rows) -> torch.Tensor:
    """Number of the group that each row belongs to, see `reach`, ``(m,)``."""
    single = is_coordinate(rows.A)
    first = rows.A.indices[rows.A.indptr[:-1]] // 3
    names = [
        f"point {n}" if pin else f"row {i}"
        for i, (n, pin) in enumerate(zip(first, single, strict=True))
    ]
    number = {name: i for i, name in enumerate(dict.fromkeys(names))}
    return torch.tensor([number[name] for name in names])


def keep_speed(speed: float, joint: str | int = "pelvis", fps: float = FPS) -> Goal:
    r"""Move over the ground at a given speed.

    .. math:: G(x) = \sum_n \bigl| \lVert z^{(n + 1)} - z^{(n)} \rVert_2 - v / f \bigr|

    in metres, as the other goals, so that the same strength suits them all.

    Args:
        speed: v, metres a second.
        joint: whose.
        fps: f, frames a second.

    Raises:
        ValueError: for an unknown joint or a negative speed.
    """
    index = joint_index(joint, "keep_speed")
    if not 0 <= speed < float("inf"):
        raise ValueError(f"keep_speed: speed is 0 or more metres a second, not {speed}")

    def goal(x: torch.Tensor) -> torch.Tensor:
        step = on_ground(x, index).diff(dim=1)
        return (torch.linalg.vector_norm(step, dim=-1) - speed / fps).abs().sum(1)

    return goal


class Together:
    """Several goals at once: their sum, each times its weight.

    Args:
        goals: callables.
        weights: one for each; 1 by default.

    Raises:
        ValueError: if there are not as many weights as goals.
    """

    def __init__(self, *goals: Goal, weights: Sequence[float] | None = None) -> None:
        self.goals = goals
        self.weights = [1.0] * len(goals) if weights is None else list(weights)
        if len(self.weights) != len(goals) or not goals:
            raise ValueError(f"Together: {len(self.weights)} weights for {len(goals)} goals")

    def __call__(self, x: torch.Tensor) -> torch.Tensor:
        """Return ``(batch,)``."""
        parts = [w * value_of(g, x) for w, g in zip(self.weights, self.goals, strict=True)]
        return torch.stack(parts).sum(0)

    def check_pins(self, mask: torch.Tensor, values: torch.Tensor) -> None:
        """Let every goal look at the pins that has something to say about them."""
        for goal in self.goals:
            check_pins(goal, mask, values)


def check_pins(goal: Goal | None, mask: torch.Tensor, values: torch.Tensor) -> None:
    """Let a goal refuse pins that it cannot be reached with; `Avoid` does."""
    look = getattr(goal, "check_pins", None)
    if look is not None:
        look(mask, values)


def on_ground(x: torch.Tensor, joint: int = 0) -> torch.Tensor:
    """Where a joint is on the ground, x and z: ``(..., joints, 3)`` to ``(..., 2)``."""
    return x[..., joint, :][..., [0, 2]]


def value_of(goal: Goal, x: torch.Tensor) -> torch.Tensor:
    """Value of a goal, ``(batch,)``, checked.

    Args:
        goal: a callable.
        x: ``(batch, frames, 22, 3)``, metres.

    Raises:
        ValueError: if it is no function of torch tensors, has another shape or is not finite, or
            if torch follows `x` and loses its track.
    """
    name = getattr(goal, "__name__", type(goal).__name__)
    try:
        value = goal(x)
    except (RuntimeError, TypeError) as error:
        if "numpy" in str(error):
            raise ValueError(f"goal '{name}' leaves torch: use torch's functions only") from error
        raise
    if not isinstance(value, torch.Tensor) or value.shape != (len(x),):
        what = f"shape {tuple(value.shape)}" if isinstance(value, torch.Tensor) else repr(value)
        raise ValueError(
            f"goal '{name}' returned {what}; expected shape ({len(x)},), one number for each motion"
        )
    if not torch.isfinite(value).all():
        bad = int((~torch.isfinite(value)).nonzero()[0])
        raise ValueError(f"goal '{name}' is {value[bad].item()} for motion {bad} of the batch")
    if x.requires_grad and not value.requires_grad:
        raise ValueError(
            f"goal '{name}' is not differentiable: torch cannot follow its value back to the "
            "motion; leave out .detach(), and do not only count or compare"
        )
    return value


def slope_of(goal: Goal, x: torch.Tensor, at: torch.Tensor) -> torch.Tensor:
    """Gradient of a goal with respect to something that `x` was made of, checked.

    Args:
        goal: a callable.
        x: ``(batch, frames, 22, 3)``, metres, made of `at`.
        at: a tensor that requires a gradient.

    Returns:
        The shape of `at`.

    Raises:
        ValueError: as `value_of`, or if the gradient is not finite.
    """
    total = value_of(goal, x).sum()
    (slope,) = torch.autograd.grad(total, at, allow_unused=True, materialize_grads=True)
    if not torch.isfinite(slope).all():
        name = getattr(goal, "__name__", type(goal).__name__)
        raise ValueError(
            f"goal '{name}' has a gradient that is not a number; a square root of 0 does that"
        )
    return slope
