r"""Walking around things: a goal that keeps a joint outside obstacles, GMD's third task.

An obstacle is a signed distance, positive outside and negative inside. It takes points
``(..., 2)``, x and z in metres, and returns ``(...)`` metres; any function of that kind will do.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import torch
from numpy.typing import ArrayLike

from projflow_lite.constraints.checks import check_numbers
from projflow_lite.samplers.goals import on_ground
from projflow_lite.skeleton import joint_index

Distance = Callable[[torch.Tensor], torch.Tensor]


class Avoid:
    r"""Stay outside obstacles.

    .. math:: G(x) = \sum_n \max\bigl(m - d(z^{(n)}),\, 0\bigr)

    with z where the joint is on the ground, and d the distance to what must be avoided.

    Args:
        distance: signed distance: ``circles(...)``, ``box(...)``, or any function of points
            ``(..., 2)``.
        margin: m, how far to stay away, metres.
        joint: which one has to stay outside.
        start: where motions begin, ``(x, z)`` metres; those of the shipped prior do so at the
            origin. None if it is not known. A pin in frame 0 goes first.

    Raises:
        ValueError: for an unknown joint or a margin that is negative.

    Source: GMD section 4, the task of avoiding obstacles.
    """

    def __init__(
        self,
        distance: Distance,
        margin: float = 0.0,
        joint: str | int = "pelvis",
        start: Sequence[float] | None = (0.0, 0.0),
    ) -> None:
        if not callable(distance):
            raise ValueError("Avoid: distance is a function of points, such as circles(...)")
        if not 0 <= margin < float("inf"):
            raise ValueError(f"Avoid: margin is 0 or more metres, not {margin}")
        self.distance, self.margin, self.start = distance, margin, start
        self.joint = joint_index(joint, "Avoid")

    def __call__(self, x: torch.Tensor) -> torch.Tensor:
        """Return ``(batch,)``: how far inside the margin, summed over frames."""
        return (self.margin - self.distance(on_ground(x, self.joint))).clamp(min=0).sum(1)

    def depth(self, positions: ArrayLike) -> torch.Tensor:
        """How deep inside an obstacle, ``(..., frames)`` metres; 0 outside, whatever the margin.

        Args:
            positions: ``(..., frames, joints, 3)``, metres.
        """
        x = torch.as_tensor(positions)
        return (-self.distance(on_ground(x, self.joint))).clamp(min=0)

    def check_pins(self, mask: torch.Tensor, values: torch.Tensor) -> None:
        """Refuse obstacles that cover a place where the motion has to be.

        Args:
            mask: ``(frames, joints, 3)``, which coordinates are pinned.
            values: ``(..., frames, joints, 3)``, where, metres.

        Raises:
            ValueError: if a pin, or the start, lies inside an obstacle.
        """
        pinned = on_ground(mask, self.joint).all(-1).nonzero()[:, 0].tolist()
        places = {n: on_ground(values, self.joint)[..., n, :] for n in pinned}
        if 0 not in places and self.start is not None:
            places[0] = values.new_tensor(self.start)
        for frame, points in sorted(places.items()):
            points = points.reshape(-1, 2)
            inside, deepest = (-self.distance(points)).max(0)
            if inside > 0:
                point, where = points[deepest], "the start point" if frame == 0 else "a keyframe"
                raise ValueError(
                    f"Avoid: an obstacle covers {where}: frame {frame}, x = {point[0]:.2f}, "
                    f"z = {point[1]:.2f} is {inside:.2f} m inside; move one of the two"
                )


def circles(centres: ArrayLike, radii: ArrayLike) -> Distance:
    r"""Distance to the nearest circle, :math:`d(z) = \min_k (\lVert z - c_k \rVert_2 - r_k)`.

    Args:
        centres: ``(K, 2)``, x and z, metres; at least one.
        radii: ``(K,)``, or one number for all, metres.

    Raises:
        ValueError: if shapes do not fit, a value is not finite or a radius is not above 0.

    Source: GMD section 4, the task of avoiding obstacles.
    """
    c = torch.as_tensor(check_numbers(centres, "circles: centres"))
    r = torch.as_tensor(check_numbers(radii, "circles: radii"))
    if c.ndim != 2 or c.shape[1] != 2 or len(c) == 0 or r.shape not in ((), (len(c),)):
        raise ValueError(
            f"circles: centres are (K, 2) and radii (K,), not {tuple(c.shape)} and {tuple(r.shape)}"
        )
    if not (torch.isfinite(c).all() and torch.isfinite(r).all() and (r > 0).all()):
        raise ValueError("circles: centres must be finite and radii finite and above 0")

    def distance(points: torch.Tensor) -> torch.Tensor:
        away = points.unsqueeze(-2) - c.to(points)
        return (torch.linalg.vector_norm(away, dim=-1) - r.to(points)).amin(-1)

    return distance


def box(centre: ArrayLike, size: ArrayLike) -> Distance:
    """Distance to a rectangle whose sides run along x and z, such as a table.

    Args:
        centre: ``(2,)``, x and z, metres.
        size: ``(2,)``, length of its sides, metres.

    Raises:
        ValueError: if a shape is another, a value is not finite or a side is not above 0.
    """
    c = torch.as_tensor(check_numbers(centre, "box: centre"))
    half = torch.as_tensor(check_numbers(size, "box: size")) / 2
    if c.shape != (2,) or half.shape != (2,):
        raise ValueError(
            f"box: centre and size are (2,), not {tuple(c.shape)}, {tuple(half.shape)}"
        )
    if not (torch.isfinite(c).all() and torch.isfinite(half).all() and (half > 0).all()):
        raise ValueError("box: centre must be finite and sides finite and above 0")

    def distance(points: torch.Tensor) -> torch.Tensor:
        beyond = (points - c.to(points)).abs() - half.to(points)
        outside = torch.linalg.vector_norm(beyond.clamp(min=0), dim=-1)
        return outside + beyond.amax(-1).clamp(max=0)

    return distance


def union(*distances: Distance) -> Distance:
    """Distance to the nearest of several obstacles.

    Raises:
        ValueError: if there is none.
    """
    if not distances:
        raise ValueError("union: there is no obstacle")
    return lambda points: torch.stack([d(points) for d in distances]).amin(0)
