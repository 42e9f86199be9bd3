"""Actions in place: the feet stand, the trunk and the hands act."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from data_synth.body import TOE_HEIGHT, Pose, ease_ankles, lower_into_reach, standing_height
from data_synth.curves import uniform, wander
from data_synth.gait import hang


def stand(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Pose:
    """Standing at ease: breathing, swaying, arms hanging; never frozen.

    Everything in the pose may be overwritten by an action; call `settle` when done.
    """
    w = lambda size, fastest=0.8: wander(random, n, frames, 1.3 * size, fastest)  # noqa: E731
    zero = np.zeros((n, frames))
    sway = w(0.015, 0.5)
    pelvis = np.zeros((n, frames, 3))
    pelvis[..., 0], pelvis[..., 2] = sway, w(0.008, 0.4)
    pelvis[..., 1] = (standing_height(bones) * uniform(random, 0.978, 0.993, n)[:, 0])[:, None]
    toe, foot_yaw = feet(random, n, frames)
    hands = np.zeros((n, frames, 2, 3))
    flex, elbow = uniform(random, -0.08, 0.10, n), uniform(random, 0.12, 0.45, n)
    out = uniform(random, 0.08, 0.18, n)
    for s, sign in enumerate((1.0, -1.0)):
        hands[:, :, s] = hang(flex + w(0.05), elbow + w(0.07), sign * out, bones)
    lean = uniform(random, -0.03, 0.06, n)
    pelvis += drifting(random, n, frames, 0.005)
    for s in range(2):
        hands[:, :, s] += drifting(random, n, frames, 0.012)
    return Pose(
        pelvis=pelvis,
        yaw=w(0.015),
        pitch=lean + zero,
        roll=sway * 0.8,
        bend=w(0.02, 0.4) + w(0.010, 2.0),
        twist=w(0.035) + w(0.012, 2.0),
        tilt=-sway * 0.8,
        nod=w(0.03, 1.2),
        look=w(0.08, 1.0),
        toe=toe,
        foot_yaw=foot_yaw,
        foot_pitch=np.zeros((n, frames, 2)),
        hand=hands,
    )


def drifting(
    random: np.random.Generator, n: int, frames: int, size: float, fastest: float = 2.0
) -> NDArray:
    """Small restless movement in three directions, ``(n, frames, 3)``, at up to `fastest` Hz."""
    return np.stack([wander(random, n, frames, size, fastest) for _ in range(3)], axis=-1)


def feet(random: np.random.Generator, n: int, frames: int) -> tuple[NDArray, NDArray]:
    """Two feet side by side on the floor: toes ``(n, frames, 2, 3)``, yaw ``(n, frames, 2)``."""
    width = uniform(random, 0.16, 0.30, n)
    toe = np.zeros((n, frames, 2, 3))
    toe[..., 1] = TOE_HEIGHT
    yaw = np.zeros((n, frames, 2))
    for s, sign in enumerate((1.0, -1.0)):
        yaw[:, :, s] = sign * uniform(random, 0.05, 0.35, n)
        toe[:, :, s, 0] = sign * width / 2 + sign * 0.12 * np.sin(np.abs(yaw[:, :, s]))
        toe[:, :, s, 2] = 0.135 + uniform(random, -0.04, 0.04, n)
    return toe, yaw


def settle(pose: Pose, bones: NDArray) -> Pose:
    """Lower the pelvis where the legs would not reach, spare the ankles; return the pose."""
    lower_into_reach(pose, bones)
    ease_ankles(pose, bones)
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
        pose.hand[:, :, s] = on_an_arc(pose.hand[:, :, s], mirrored, part, sign)


def on_an_arc(old: NDArray, new: NDArray, share: NDArray, sign: float) -> NDArray:
    """Between two places of a hand, round its shoulder and never through it.

    Args:
        old, new: ``(n, frames, 3)`` relative to the shoulder.
        share: ``(n, frames, 1)`` 0 is the old place, 1 the new one.
        sign: +1 for the left hand, -1 for the right: between opposite places a hand passes ahead
            of the body and outside of it.
    """
    before, after = np.linalg.norm(old, axis=-1), np.linalg.norm(new, axis=-1)
    start, end = old / before[..., None], new / after[..., None]
    middle = (
        start + end + np.array([0.35 * sign, 0.0, 0.6]) * (1 - (start * end).sum(-1))[..., None]
    )
    middle = middle / np.linalg.norm(middle, axis=-1, keepdims=True)
    path = (1 - share) ** 2 * start + 2 * share * (1 - share) * middle + share**2 * end
    apart = 0.5 * (1 - (start * end).sum(-1))[..., None]
    length = before[..., None] + share * (after - before)[..., None]
    length = length * (1 - 0.3 * apart * 4 * share * (1 - share))  # an arm bends on its way
    return path / np.linalg.norm(path, axis=-1, keepdims=True) * length


def swing_arm(pose: Pose, side: float, angle: NDArray) -> None:
    """Swing a hand about its shoulder, ahead if `angle` ``(n, frames)`` radians is positive.

    Args:
        pose: changed in place.
        side: +1 for the left hand, -1 for the right.
        angle: how far.
    """
    s = 0 if side > 0 else 1
    x, y, z = np.moveaxis(pose.hand[:, :, s], -1, 0)
    c, sn = np.cos(angle), np.sin(angle)
    pose.hand[:, :, s] = np.stack([x, c * y + sn * z, -sn * y + c * z], axis=-1)


def hang_down(pose: Pose, pitch: NDArray) -> None:
    """Let both arms hang although the chest leans ahead by `pitch` ``(n, frames)`` radians."""
    for side in (1.0, -1.0):
        swing_arm(pose, side, pitch)


def shoulder_width(bones: NDArray) -> NDArray:
    """From the middle to a shoulder, ``(n, 1)`` metres."""
    return bones[:, [13, 16], 0].sum(-1)[:, None]


def shift_weight(pose: Pose, side: NDArray, share: NDArray) -> None:
    """Bring the pelvis over one foot and hold the balance.

    Args:
        pose: changed in place.
        side: ``(n, 1)`` +1 for the left foot, -1 for the right.
        share: ``(n, frames)`` 0 leaves the weight where it was, 1 puts all of it on that foot.
    """
    foot = np.where(side > 0, pose.toe[:, :, 0, 0], pose.toe[:, :, 1, 0])
    pose.pelvis[..., 0] += 0.85 * share * (foot - pose.pelvis[..., 0])
    pose.roll = pose.roll - 0.05 * side * share
    pose.tilt = pose.tilt + 0.09 * side * share


def arm_reach(bones: NDArray) -> NDArray:
    """Length of a straight arm, ``(n, 1, 1)`` metres."""
    return np.linalg.norm(bones[:, [18, 20]], axis=-1).sum(-1)[:, None, None]
