"""How far joints bend, from joint positions alone, and how far a person's do.

Positions do not tell every angle: a bone has a direction but no twist about itself. So there are
no angles of the forearm or of the head about the neck's own axis here.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from data_synth.body import SIDES, joint


class Limits(NamedTuple):
    """Least and most of an angle that is asked of synthetic motion, degrees."""

    low: float
    high: float


HUMAN = {
    "trunk ahead": Limits(-35, 85),
    "trunk to the side": Limits(-35, 35),
    "trunk twist": Limits(-50, 50),
    "neck ahead": Limits(-50, 50),
    "neck to the side": Limits(-45, 45),
    "hip ahead": Limits(-35, 130),
    "hip aside": Limits(-35, 50),
    "knee": Limits(0, 150),
    "ankle up": Limits(-55, 50),
    "shoulder from hanging": Limits(0, 175),
    "elbow": Limits(0, 150),
}
"""What healthy adults reach, in textbooks' ranges of motion and loaded by their own weight.

A squat takes a hip and a deep lunge an ankle further than an examiner's hand does, and joint
positions tell an angle to five degrees or so: the limits allow for both.
"""


def joint_angles(positions: ArrayLike) -> dict[str, NDArray]:
    """Angles of the joints, degrees, by the names of `HUMAN`.

    Trunk and shoulders are measured against the pelvis and the chest, not against the room.

    Args:
        positions: ``(..., 22, 3)``, metres, y up.

    Returns:
        ``(...)`` for trunk and neck; ``(..., 2)``, left and right, for the others. Ahead, aside
        (away from the body) and up are positive; a straight knee or elbow has 0.
    """
    x = np.asarray(positions, float)
    pelvis = axes_of(x, "pelvis", "spine1", "hip")
    chest = axes_of(x, "spine3", "neck", "shoulder")
    up, left = seen_in(pelvis, chest[..., 1, :]), seen_in(pelvis, chest[..., 0, :])
    neck = seen_in(chest, bone(x, "neck", "head"))
    thigh, upper_arm = (
        np.stack([seen_in(axes, bone(x, f"{s}_{a}", f"{s}_{b}")) for s in SIDES], axis=-2)
        for axes, a, b in ((pelvis, "hip", "knee"), (chest, "shoulder", "elbow"))
    )
    return {
        "trunk ahead": degrees(up[..., 2], up[..., 1]),
        "trunk to the side": degrees(up[..., 0], np.hypot(up[..., 1], up[..., 2])),
        "trunk twist": degrees(-left[..., 2], left[..., 0]),
        "neck ahead": degrees(neck[..., 2], neck[..., 1]),
        "neck to the side": degrees(neck[..., 0], np.hypot(neck[..., 1], neck[..., 2])),
        "hip ahead": degrees(thigh[..., 2], -thigh[..., 1]),
        "hip aside": degrees(thigh[..., 0] * [1, -1], np.hypot(thigh[..., 1], thigh[..., 2])),
        "knee": bend(x, "hip", "knee", "ankle"),
        "ankle up": 90 + FOOT_SLOPE - (180 - bend(x, "knee", "ankle", "foot")),
        "shoulder from hanging": degrees(
            np.hypot(upper_arm[..., 0], upper_arm[..., 2]), -upper_arm[..., 1]
        ),
        "elbow": bend(x, "shoulder", "elbow", "wrist"),
    }


FOOT_SLOPE = 18.5
"""Degrees by which the line from ankle to toe of a foot flat on the floor falls."""


def axes_of(x: NDArray, low: str, high: str, pair: str) -> NDArray:
    """Left, up and ahead of pelvis or chest as rows, ``(..., 3, 3)``."""
    up = unit(bone(x, low, high))
    across = bone(x, f"right_{pair}", f"left_{pair}")
    left = unit(across - (across * up).sum(-1, keepdims=True) * up)
    return np.stack([left, up, np.cross(left, up)], axis=-2)


def bone(x: NDArray, start: str, end: str) -> NDArray:
    """From one joint to another, ``(..., 3)`` metres."""
    return x[..., joint(end), :] - x[..., joint(start), :]


def unit(vector: NDArray) -> NDArray:
    """The direction of a vector."""
    return vector / np.linalg.norm(vector, axis=-1, keepdims=True).clip(1e-9)


def seen_in(axes: NDArray, vector: NDArray) -> NDArray:
    """Coordinates of a vector along three axes."""
    return (axes @ vector[..., None])[..., 0]


def degrees(opposite: NDArray, adjacent: NDArray) -> NDArray:
    """The angle of a right-angled triangle, -180 to 180."""
    return np.degrees(np.arctan2(opposite, adjacent))


def bend(x: NDArray, before: str, at: str, after: str) -> NDArray:
    """How far the bones of both sides are from a straight line, ``(..., 2)`` degrees."""
    pairs = [
        (bone(x, f"{s}_{before}", f"{s}_{at}"), bone(x, f"{s}_{at}", f"{s}_{after}")) for s in SIDES
    ]
    return np.stack(
        [degrees(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(-1)) for a, b in pairs],
        axis=-1,
    )
