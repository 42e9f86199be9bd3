"""Actions in place: the feet stand, the trunk and the hands act."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from data_synth.body import TOE_HEIGHT, Pose, lower_into_reach, standing_height
from data_synth.curves import uniform, wander
from data_synth.gait import hang


def stand(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Pose:
    """Standing at ease: breathing, swaying, arms hanging; never frozen.

    Everything in the pose may be overwritten by an action; call `settle` when done.
    """
    w = lambda size, fastest=0.7: wander(random, n, frames, size, fastest)  # noqa: E731
    zero = np.zeros((n, frames))
    sway = w(0.015, 0.5)
    pelvis = np.zeros((n, frames, 3))
    pelvis[..., 0], pelvis[..., 2] = sway, w(0.008, 0.4)
    pelvis[..., 1] = (standing_height(bones) * uniform(random, 0.97, 0.985, n)[:, 0])[:, None]
    toe, foot_yaw = feet(random, n, frames)
    hands = np.zeros((n, frames, 2, 3))
    flex, elbow = uniform(random, -0.08, 0.10, n), uniform(random, 0.12, 0.45, n)
    out = uniform(random, 0.08, 0.18, n)
    for s, sign in enumerate((1.0, -1.0)):
        hands[:, :, s] = hang(flex + w(0.05), elbow + w(0.07), sign * out, bones)
    lean = uniform(random, -0.03, 0.06, n)
    return Pose(
        pelvis=pelvis,
        yaw=w(0.015),
        pitch=lean + zero,
        roll=sway * 0.8,
        bend=w(0.02, 0.4),
        twist=w(0.035),
        tilt=-sway * 0.8,
        nod=w(0.03),
        look=w(0.08),
        toe=toe,
        foot_yaw=foot_yaw,
        foot_pitch=np.zeros((n, frames, 2)),
        hand=hands,
    )


def feet(random: np.random.Generator, n: int, frames: int) -> tuple[NDArray, NDArray]:
    """Two feet side by side on the floor: toes ``(n, frames, 2, 3)``, yaw ``(n, frames, 2)``."""
    width = uniform(random, 0.16, 0.30, n)
    toe = np.zeros((n, frames, 2, 3))
    toe[..., 1] = TOE_HEIGHT
    yaw = np.zeros((n, frames, 2))
    for s, sign in enumerate((1.0, -1.0)):
        yaw[:, :, s] = sign * uniform(random, 0.05, 0.35, n)
        toe[:, :, s, 0] = sign * width / 2 + sign * 0.12 * np.sin(np.abs(yaw[:, :, s]))
        toe[:, :, s, 2] = 0.105 + uniform(random, -0.04, 0.04, n)
    return toe, yaw


def settle(pose: Pose, bones: NDArray) -> Pose:
    """Lower the pelvis where the legs would not reach; return the pose."""
    lower_into_reach(pose, bones)
    return pose


def move_hand(pose: Pose, side: NDArray, share: NDArray, target: NDArray) -> None:
    """Bring one hand towards a target.

    Args:
        pose: changed in place.
        side: ``(n, 1)`` +1 for the left hand, -1 for the right.
        share: ``(n, frames)`` 0 leaves the hand where it was, 1 puts it on the target.
        target: ``(n, frames, 3)`` relative to the shoulder in the chest's axes, as if for the left
            hand: mirrored for the right one.
    """
    for s, sign in enumerate((1.0, -1.0)):
        part = (share * (side == sign))[..., None]
        mirrored = target * [sign, 1, 1]
        old = pose.hand[:, :, s]
        # Hands move on arcs: between rest and target they swing out ahead of the body.
        arc = part * (1 - part) * np.array([0.25 * sign, 0.0, 0.45])
        pose.hand[:, :, s] = old + part * (mirrored - old) + arc


def arm_reach(bones: NDArray) -> NDArray:
    """Length of a straight arm, ``(n, 1, 1)`` metres."""
    return np.linalg.norm(bones[:, [18, 20]], axis=-1).sum(-1)[:, None, None]
