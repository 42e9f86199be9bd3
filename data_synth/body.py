"""The body that moves: proportions, a trunk by forward kinematics, arms and legs by two-bone IK."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from projflow_lite.skeleton import JOINTS, N_JOINTS, PARENTS

# Bone vectors of an upright body with arms hanging, metres: +x is the body's left, +z ahead. Two
# builds that motion data come in: HumanML3D's one skeleton, and the people of a capture studio.
REST = {
    "left_hip": ((0.070, -0.077, 0.020), (0.096, -0.108, 0.024)),
    "spine1": ((0.0, 0.131, -0.003), (0.0, 0.115, -0.003)),
    "left_knee": ((0.006, -0.392, 0.0), (0.006, -0.420, 0.0)),
    "spine2": ((0.0, 0.142, 0.006), (0.0, 0.115, 0.006)),
    "left_ankle": ((0.0, -0.429, 0.0), (0.0, -0.444, 0.0)),
    "spine3": ((0.0, 0.057, 0.003), (0.0, 0.041, 0.002)),
    "left_foot": ((0.010, -0.045, 0.138), (0.010, -0.042, 0.120)),
    "neck": ((0.0, 0.219, -0.006), (0.0, 0.171, -0.006)),
    "left_collar": ((0.087, 0.110, -0.006), (0.082, 0.105, -0.007)),
    "head": ((0.0, 0.102, 0.015), (0.0, 0.096, 0.010)),
    "left_shoulder": ((0.120, 0.040, -0.013), (0.104, 0.036, -0.012)),
    "left_elbow": ((0.0, -0.260, 0.0), (0.0, -0.290, 0.0)),
    "left_wrist": ((0.0, -0.268, 0.0), (0.0, -0.296, 0.0)),
}
SIDES = ("left", "right")
LONGEST_LEG = 0.990
"""Distance from hip to ankle, as a share of thigh plus shank: no knee is ever quite straight."""

ANKLE_UP, ANKLE_DOWN = np.radians(46.0), np.radians(-50.0)
"""How far a foot may come up to its shank, and go down from it, counted from a flat foot."""

TOE_HEIGHT = 0.012
"""Height of the toe joint of a foot flat on the floor, metres."""


def joint(name: str) -> int:
    """Index of a joint by name."""
    return JOINTS.index(name)


def sample_bones(random: np.random.Generator, n: int) -> NDArray:
    """Bone vectors at rest for `n` bodies, ``(n, 22, 3)`` metres, left and right alike.

    Every body lies somewhere between the two builds of `REST`, and is a little taller or shorter.
    """
    size = random.normal(1.0, 0.025, n).clip(0.94, 1.06)
    build = random.uniform(0.0, 1.0, (n, 1))
    bones = np.zeros((n, N_JOINTS, 3))
    for name, (one, other) in REST.items():
        length = size * random.normal(1.0, 0.015, n).clip(0.96, 1.04)
        vector = (1 - build) * np.array(one) + build * np.array(other)
        bones[:, joint(name)] = length[:, None] * vector
        if name.startswith("left"):
            mirrored = joint(name.replace("left", "right"))
            bones[:, mirrored] = bones[:, joint(name)] * [-1, 1, 1]
    return bones


@dataclass
class Pose:
    """All that decides where the joints of `n` clips are in every frame.

    Angles are radians, positions metres; the third axis of `toe`, `foot_*`, `hand` is left, right.

    Attributes:
        pelvis: ``(n, frames, 3)``.
        yaw, pitch, roll: ``(n, frames)`` of the pelvis: turn left, lean ahead, list left.
        bend, twist, tilt: ``(n, frames)`` of the spine from pelvis to chest, in the same sense.
        nod, look: ``(n, frames)`` of the head on the neck.
        toe: ``(n, frames, 2, 3)`` where the toe joint would be if the foot were flat.
        foot_yaw, foot_pitch: ``(n, frames, 2)``; pitch > 0 lifts the heel about the toe, pitch < 0
            the toe about the heel.
        hand: ``(n, frames, 2, 3)`` wrist relative to its shoulder, in the chest's axes.
    """

    pelvis: NDArray
    yaw: NDArray
    pitch: NDArray
    roll: NDArray
    bend: NDArray
    twist: NDArray
    tilt: NDArray
    nod: NDArray
    look: NDArray
    toe: NDArray
    foot_yaw: NDArray
    foot_pitch: NDArray
    hand: NDArray


Made = tuple[Pose, dict[str, NDArray]]
"""What an action makes: a pose, and the parameters that were drawn, ``(n,)`` each."""


def turn(yaw: NDArray, pitch: NDArray | float = 0.0, roll: NDArray | float = 0.0) -> NDArray:
    """Rotations ``(..., 3, 3)``: first roll about z, then pitch about x, then yaw about y."""
    yaw, pitch, roll = np.broadcast_arrays(yaw, pitch, roll)
    cy, sy, cp, sp = np.cos(yaw), np.sin(yaw), np.cos(pitch), np.sin(pitch)
    cr, sr = np.cos(-roll), np.sin(-roll)
    rows = [
        [cy * cr + sy * sp * sr, -cy * sr + sy * sp * cr, sy * cp],
        [cp * sr, cp * cr, -sp],
        [-sy * cr + cy * sp * sr, sy * sr + cy * sp * cr, cy * cp],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def rotate(matrix: NDArray, vector: NDArray) -> NDArray:
    """Apply rotations ``(..., 3, 3)`` to vectors ``(..., 3)``."""
    return (matrix @ vector[..., None])[..., 0]


def two_bones(
    root: NDArray, end: NDArray, upper: NDArray, lower: NDArray, pole: NDArray
) -> NDArray:
    """Where the middle joint of a limb goes, so that both bones keep their length.

    Args:
        root: ``(..., 3)`` first joint.
        end: ``(..., 3)`` last joint, within reach.
        upper: ``(...)`` length of the first bone.
        lower: ``(...)`` length of the second.
        pole: ``(..., 3)`` direction to which the limb bends.
    """
    along = end - root
    distance = np.linalg.norm(along, axis=-1)
    along = along / distance[..., None]
    cosine = (distance**2 + upper**2 - lower**2) / (2 * distance * upper)
    cosine = cosine.clip(-1, 1)
    side = pole - (pole * along).sum(-1, keepdims=True) * along
    side = side / np.linalg.norm(side, axis=-1, keepdims=True)
    sine = np.sqrt(1 - cosine**2)
    return root + upper[..., None] * (cosine[..., None] * along + sine[..., None] * side)


def within_reach(offset: NDArray, reach: NDArray) -> NDArray:
    """Shorten offsets ``(..., 3)`` smoothly so that none is longer than `reach`."""
    distance = np.linalg.norm(offset, axis=-1)
    knee = 0.95 * reach  # below this nothing changes; above it the limb approaches full stretch
    beyond = np.maximum(distance - knee, 0)
    soft = knee + (reach - knee) * (1 - np.exp(-beyond / (reach - knee)))
    return offset * (np.where(distance > knee, soft, distance) / distance)[..., None]


def foot_joints(pose: Pose, bones: NDArray) -> tuple[NDArray, NDArray]:
    """Ankles and toes, each ``(n, frames, 2, 3)``."""
    vector = np.stack([bones[:, joint(f"{side}_foot")] for side in SIDES], axis=1)[:, None]
    flat = turn(pose.foot_yaw)
    pitched = turn(pose.foot_yaw, pose.foot_pitch)
    heel_up = (pose.foot_pitch > 0)[..., None]
    ankle = pose.toe - rotate(np.where(heel_up[..., None], pitched, flat), vector)
    toe = np.where(heel_up, pose.toe, ankle + rotate(pitched, vector))
    return ankle, toe


def legs(pose: Pose, bones: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Knees, ankles and toes, each ``(n, frames, 2, 3)``."""
    ankles, toes = foot_joints(pose, bones)
    pelvis = turn(pose.yaw, pose.pitch, pose.roll)
    sides = [[joint(f"{side}_{part}") for side in SIDES] for part in ("hip", "knee", "ankle")]
    hips, thighs, shanks = (bones[:, numbers] for numbers in sides)
    hips = pose.pelvis[:, :, None] + rotate(pelvis[:, :, None], hips[:, None])
    upper, lower = (np.linalg.norm(part, axis=-1)[:, None] for part in (thighs, shanks))
    ahead = 0.5 * (pelvis[:, :, None, :, 2] + turn(pose.foot_yaw)[..., 2])
    return two_bones(hips, ankles, upper, lower, ahead), ankles, toes


def assemble(pose: Pose, bones: NDArray) -> NDArray:
    """Joint positions ``(n, frames, 22, 3)`` of a pose.

    Args:
        pose: what the body does.
        bones: ``(n, 22, 3)`` bone vectors at rest.
    """
    x = np.zeros((*pose.pelvis.shape[:2], N_JOINTS, 3))
    pelvis = turn(pose.yaw, pose.pitch, pose.roll)
    chest = pelvis @ turn(pose.twist, pose.bend, pose.tilt)
    third, two_thirds = (
        pelvis @ turn(pose.twist * s, pose.bend * s, pose.tilt * s) for s in (1 / 3, 2 / 3)
    )
    head = chest @ turn(pose.look, pose.nod)
    frame_of = {"spine1": pelvis, "spine2": third, "spine3": two_thirds, "head": head}
    x[:, :, 0] = pose.pelvis
    for name in (
        "left_hip", "right_hip", "spine1", "spine2", "spine3", "neck", "head",
        "left_collar", "right_collar", "left_shoulder", "right_shoulder",
    ):  # fmt: skip
        rotation = pelvis if name.endswith("hip") else frame_of.get(name, chest)
        j = joint(name)
        x[:, :, j] = x[:, :, PARENTS[j]] + rotate(rotation, bones[:, None, j])
    lengths = np.linalg.norm(bones, axis=-1)
    knees, ankles, toes = legs(pose, bones)
    for s, side in enumerate(SIDES):
        for part, places in (("knee", knees), ("ankle", ankles), ("foot", toes)):
            x[:, :, joint(f"{side}_{part}")] = places[:, :, s]
        shoulder, elbow, wrist = (
            joint(f"{side}_{part}") for part in ("shoulder", "elbow", "wrist")
        )
        upper, lower = lengths[:, None, elbow], lengths[:, None, wrist]
        hand = within_reach(pose.hand[:, :, s], 0.985 * (upper + lower))
        x[:, :, wrist] = x[:, :, shoulder] + rotate(chest, hand)
        pole = rotate(chest, elbow_pole(hand, 1.0 if side == "left" else -1.0))
        x[:, :, elbow] = two_bones(x[:, :, shoulder], x[:, :, wrist], upper, lower, pole)
    return x


def elbow_pole(hand: NDArray, sign: float) -> NDArray:
    """Where an elbow points, in the chest's axes: back from a hanging arm, down from a raised one.

    One fixed direction would not do: an arm that passes it would flip its elbow in one frame.
    """
    height = hand[..., 1] / np.linalg.norm(hand, axis=-1)
    raised = ((height + 0.95) / 0.7).clip(0, 1)[..., None]
    raised = raised**2 * (3 - 2 * raised)
    hanging = np.array([0.05 * sign, -0.2, -1.0])
    return hanging + raised * (np.array([0.6 * sign, -0.75, 0.2]) - hanging)


def leg_length(bones: NDArray) -> NDArray:
    """Thigh plus shank, ``(n,)`` metres."""
    return np.linalg.norm(bones[:, [joint("left_knee"), joint("left_ankle")]], axis=-1).sum(-1)


def standing_height(bones: NDArray) -> NDArray:
    """Height of the pelvis with straight legs on flat feet, ``(n,)`` metres."""
    ankle = TOE_HEIGHT - bones[:, joint("left_foot"), 1]
    return ankle + leg_length(bones) - bones[:, joint("left_hip"), 1]


def lower_into_reach(pose: Pose, bones: NDArray, level: float = 0.0) -> None:
    """Lower the pelvis until both legs reach their feet.

    Args:
        pose: changed in place.
        bones: ``(n, 22, 3)`` bone vectors at rest.
        level: share of the largest lowering that the whole clip gets, so that a walk keeps its bob;
            the rest is done smoothly and only where it is needed.
    """
    ankles, _ = foot_joints(pose, bones)
    pelvis = turn(pose.yaw, pose.pitch, pose.roll)
    room = np.full(pose.pelvis.shape[:2], np.inf)
    for s, side in enumerate(SIDES):
        hip = rotate(
            pelvis, np.broadcast_to(bones[:, None, joint(f"{side}_hip")], pose.pelvis.shape)
        )
        flat = np.square((pose.pelvis + hip - ankles[:, :, s])[..., [0, 2]]).sum(-1)
        reach = (LONGEST_LEG * leg_length(bones))[:, None] ** 2 - flat
        top = ankles[:, :, s, 1] + np.sqrt(reach.clip(0.05)) - hip[..., 1]
        room = np.minimum(room, top)
    excess = (pose.pelvis[..., 1] - room).clip(0)
    whole = level * excess.max(axis=1, keepdims=True)
    pose.pelvis[..., 1] -= whole + smooth(widest((excess - whole).clip(0), 3), 1.6)


def ease_ankles(pose: Pose, bones: NDArray) -> None:
    """Lift the heel where a foot would have to bend up further than an ankle does, or lower it.

    Args:
        pose: changed in place; toes that stand stay where they are.
        bones: ``(n, 22, 3)`` bone vectors at rest.
    """
    for _ in range(3):  # a lifted heel moves the knee, too
        up = ankle_angle(pose, bones)
        beyond = (up - ANKLE_UP).clip(0) - (ANKLE_DOWN - up).clip(0)
        if not beyond.any():
            return
        for s in range(len(SIDES)):
            for sign in (1.0, -1.0):
                needed = widest((sign * beyond[..., s]).clip(0), 2)
                pose.foot_pitch[..., s] += sign * smooth(needed, 1.0)


def ankle_angle(pose: Pose, bones: NDArray) -> NDArray:
    """How far each foot is bent up from a right angle and its own slope, ``(n, frames, 2)``."""
    knees, ankles, toes = legs(pose, bones)
    shank, foot = knees - ankles, toes - ankles
    size = np.linalg.norm(shank, axis=-1) * np.linalg.norm(foot, axis=-1)
    flat = bones[:, None, [joint(f"{side}_foot") for side in SIDES]]
    slope = np.arctan2(-flat[..., 1], np.hypot(flat[..., 0], flat[..., 2]))
    return np.pi / 2 + slope - np.arccos(((shank * foot).sum(-1) / size).clip(-1, 1))


def widest(x: NDArray, radius: int) -> NDArray:
    """Largest value within `radius` frames, along the last axis."""
    padded = np.pad(x, ((0, 0), (radius, radius)), mode="edge")
    return np.lib.stride_tricks.sliding_window_view(padded, 2 * radius + 1, axis=-1).max(-1)


def smooth(x: NDArray, sigma: float) -> NDArray:
    """Gaussian smoothing along the last axis, standard deviation in frames."""
    radius = int(np.ceil(3 * sigma))
    kernel = np.exp(-0.5 * (np.arange(-radius, radius + 1) / sigma) ** 2)
    padded = np.pad(x, ((0, 0), (radius, radius)), mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * radius + 1, axis=-1)
    return windows @ (kernel / kernel.sum())
