r"""Wishes drawn in a picture: what a camera sees of a joint, as rows on where the joint is.

The camera's axes are right, up and towards the viewer. Both cameras are linear in the world: the
orthographic one as it is (ProjFlow eq. 19-20), the perspective one after multiplying by the depth.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from projflow_lite.constraints.checks import (
    check_frames,
    check_numbers,
    check_std,
    check_values,
    every_frame,
    how_exactly,
    in_words,
    is_number,
)
from projflow_lite.constraints.wish import Rows, Term, Wish, columns_of, weighted_rows
from projflow_lite.skeleton import JOINTS, joint_index, shown


def rotation(pitch: float, yaw: float, roll: float) -> NDArray[np.float64]:
    r"""World to camera, ``(3, 3)``: :math:`R_{cam} = R_z(roll)\, R_x(pitch)\, R_y(-yaw)`.

    All angles are degrees. At 0 the camera looks at the front of a body that faces it, along
    -z, with the picture's x to the body's left. A positive yaw walks the camera round to the
    body's left, a positive pitch lifts it and looks down, a positive roll turns the picture
    anticlockwise.
    """
    p, y, r = np.radians([pitch, yaw, roll])
    around_y = np.array([[np.cos(y), 0, -np.sin(y)], [0, 1, 0], [np.sin(y), 0, np.cos(y)]])
    around_x = np.array([[1, 0, 0], [0, np.cos(p), -np.sin(p)], [0, np.sin(p), np.cos(p)]])
    around_z = np.array([[np.cos(r), -np.sin(r), 0], [np.sin(r), np.cos(r), 0], [0, 0, 1]])
    return around_z @ around_x @ around_y


@dataclass(frozen=True)
class Orthographic:
    r"""A distant camera: :math:`(u, v) = s\, P\, R_{cam}\, x` (ProjFlow eq. 19).

    Attributes:
        pitch, yaw, roll: degrees, see `rotation`.
        scale: picture units a metre, above 0.
    """

    pitch: float = 0.0
    yaw: float = 0.0
    roll: float = 0.0
    scale: float = 1.0

    def __post_init__(self) -> None:
        check_angles("Orthographic", self.pitch, self.yaw, self.roll)
        check_above_zero("Orthographic: scale", self.scale)

    def project(self, x: NDArray) -> NDArray[np.float64]:
        """Picture ``(..., 2)`` of points ``(..., 3)``, metres."""
        points = check_points("Orthographic", x)
        return self.scale * (points @ rotation(self.pitch, self.yaw, self.roll)[:2].T)

    def equations(self, points: NDArray) -> tuple[NDArray, NDArray]:
        """Weights ``(k, 2, 3)`` and targets ``(k, 2)``, metres, that points ``(k, 2)`` ask for."""
        weights = rotation(self.pitch, self.yaw, self.roll)[:2]
        return np.broadcast_to(weights, (len(points), 2, 3)), points / self.scale


@dataclass(frozen=True)
class Perspective:
    r"""A pinhole camera at a finite distance.

    With camera coordinates :math:`(a, b, c) = R_{cam}\, (x - \text{position})` and the picture's
    :math:`u = u_0 - f a / c` (c is negative ahead of the camera, which looks along its -c), the
    point :math:`(u, v)` asks that

    .. math:: \Bigl(R_0 + \frac{u - u_0}{f} R_2\Bigr)\, (x - \text{position}) = 0,

    and the same for v with :math:`R_1`: a linear row, though the picture is not linear in x.

    Attributes:
        position: ``(3,)`` of the camera, metres.
        pitch, yaw, roll: degrees, see `rotation`.
        focal: focal length, picture units.
        centre: ``(u0, v0)`` of the picture.
    """

    position: tuple[float, float, float] = (0.0, 1.0, 4.0)
    pitch: float = 0.0
    yaw: float = 0.0
    roll: float = 0.0
    focal: float = 1.0
    centre: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        check_angles("Perspective", self.pitch, self.yaw, self.roll)
        check_above_zero("Perspective: focal", self.focal)
        for name, value, count in (("position", self.position, 3), ("centre", self.centre, 2)):
            given = check_numbers(value, f"Perspective: {name}")
            if given.shape != (count,) or not np.isfinite(given).all():
                number = {2: "two", 3: "three"}[count]
                raise ValueError(f"Perspective: {name} is {number} numbers, not {shown(value)}")

    def project(self, x: NDArray) -> NDArray[np.float64]:
        """Picture ``(..., 2)`` of points ``(..., 3)``, metres.

        Raises:
            ValueError: for a point that is not ahead of the camera.
        """
        points = check_points("Perspective", x)
        seen = (points - self.position) @ rotation(self.pitch, self.yaw, self.roll).T
        if (seen[..., 2] >= 0).any():
            raise ValueError("Perspective: a point is not ahead of the camera")
        return np.asarray(self.centre) - self.focal * seen[..., :2] / seen[..., 2:]

    def equations(self, points: NDArray) -> tuple[NDArray, NDArray]:
        """Weights ``(k, 2, 3)`` and targets ``(k, 2)``, metres, that points ``(k, 2)`` ask for."""
        R = rotation(self.pitch, self.yaw, self.roll)
        slope = (points - self.centre) / self.focal
        weights = R[:2] + slope[..., None] * R[2]
        return weights, weights @ np.asarray(self.position, dtype=np.float64)


def lift(
    camera: Orthographic | Perspective,
    joint: str | int,
    frames: int | Iterable[int] | None,
    points: ArrayLike,
    std: float = 0.0,
) -> Wish:
    """Ask that a camera see a joint at given points of its picture (ProjFlow eq. 19-20).

    How far from the camera the joint is stays open: the flow decides it.

    Args:
        camera: an `Orthographic` or a `Perspective` camera.
        joint: one joint.
        frames: one frame, a list of frames, or None for every frame.
        points: ``(frames, 2)`` in the picture; for a single frame the first dimension is left out.
        std: standard deviation in metres, measured across the line of sight (under perspective:
            in the plane one metre from the camera, times the depth); 0 means exactly.

    Raises:
        ValueError: for something that is no camera, and as for `pin`.
    """
    if not isinstance(camera, Orthographic | Perspective):
        raise ValueError(
            f"lift: camera is Orthographic(...) or Perspective(...), not {shown(camera)}"
        )
    j = joint_index(joint, "lift")
    check_std(std, "lift")
    listed, single = check_frames(frames, "lift")
    drawn = check_values(points, listed, single, None, "uv", "lift: points")[:, 0]
    if not np.isfinite(drawn).all():
        raise ValueError("lift: points has a value that is not finite")
    weights, targets = camera.equations(drawn)

    def build(total: int) -> Rows:
        frame = every_frame(listed, len(drawn), total, "lift", "points")
        columns = np.repeat(columns_of(frame[:, None], j, np.arange(3)), 2, axis=0)
        return weighted_rows(columns, weights.reshape(-1, 3), targets.ravel(), total, std)

    kind = type(camera).__name__.lower()
    words = f"{JOINTS[j]} drawn in the picture of an {kind} camera at {in_words(listed)}"
    return Wish((Term(f"{words.replace('an p', 'a p')}, {how_exactly(std)}", build),))


def check_angles(who: str, *angles: float) -> None:
    """Refuse an angle that is no number."""
    if not all(is_number(angle) for angle in angles):
        raise ValueError(f"{who}: pitch, yaw and roll are degrees, not {shown(angles)}")


def check_above_zero(what: str, value: float) -> None:
    """Refuse what is not a positive number."""
    if not is_number(value) or value <= 0:
        raise ValueError(f"{what} is a number above 0, not {shown(value)}")


def check_points(who: str, x: ArrayLike) -> NDArray[np.float64]:
    """Points of space as an array ``(..., 3)``, or say what is wrong with them."""
    points = check_numbers(x, f"{who}: x")
    if points.shape[-1:] != (3,):
        raise ValueError(f"{who}: points have shape (..., 3), not {points.shape}")
    if not np.isfinite(points).all():
        raise ValueError(f"{who}: a point is not finite")
    return points
