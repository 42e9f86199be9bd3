"""Actions in place: squat, wave, reach, stand."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from data_synth.body import Made, Pose
from data_synth.curves import coin, ease, hold, seconds, uniform, wander
from data_synth.standing import arm_reach, move_hand, settle, stand
from projflow_lite.skeleton import FPS


def squat(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Bend the knees and come up again, once or twice, arms ahead for balance."""
    pose, t = stand(random, n, frames, bones), seconds(frames)
    length = frames / FPS
    times = np.where((random.random((n, 1)) < 0.4) & (length > 2.4), 2, 1)
    depth = uniform(random, 0.22, 0.46, n)
    begin, span = uniform(random, 0.03, 0.12, n) * length, uniform(random, 0.8, 0.87, n) * length
    cycle = ((t - begin) / span).clip(0, 1) * times
    down = ease((1 - np.abs(2 * (cycle % 1.0) - 1)) * (cycle < times) * 1.25)
    pose.pelvis[..., 1] -= depth * down
    pose.pelvis[..., 2] -= 0.42 * depth * down
    pose.pitch = pose.pitch + 0.9 * depth * down
    pose.bend = pose.bend + 0.7 * depth * down
    pose.nod = pose.nod - 1.0 * depth * down
    reach = arm_reach(bones) * uniform(random, 0.75, 0.92, n)[..., None]
    lift = uniform(random, -0.15, 0.15, n)
    direction = np.stack(
        [-0.1 + 0 * down, lift - 0.1 + 0 * down, np.sqrt(0.97 - lift**2) + 0 * down], axis=-1
    )
    for side in (1.0, -1.0):
        move_hand(pose, np.full((n, 1), side), down * uniform(random, 0.6, 1, n), reach * direction)
    return settle(pose, bones), {"depth": depth[:, 0], "times": times[:, 0].astype(float)}


def wave(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Raise one hand, or both, and wave."""
    pose = stand(random, n, frames, bones)
    side = random.choice([-1.0, 0.0, 1.0], (n, 1), p=[0.42, 0.16, 0.42])
    wave_hands(random, pose, side, frames, bones)
    return settle(pose, bones), {"side": side[:, 0]}


def wave_hands(
    random: np.random.Generator, pose: Pose, side: NDArray, frames: int, bones: NDArray
) -> None:
    """Wave the left hand (+1), the right one (-1) or both (0)."""
    n, t = len(side), seconds(frames)
    up, _ = hold(random, n, frames, (0.4, 0.75))
    reach = arm_reach(bones)
    rate, width = uniform(random, 0.9, 1.9, n), uniform(random, 0.10, 0.24, n)
    swing = np.sin(2 * np.pi * (rate * t + uniform(random, 0, 1, n)))
    out, high, front = (
        uniform(random, *bounds, n) for bounds in ((0.25, 0.5), (0.25, 0.65), (0.2, 0.4))
    )
    target = np.stack(
        [out + width * swing / 0.6, high - 0.12 * width * swing**2, front + 0 * swing], axis=-1
    )
    for sign in (1.0, -1.0):
        chosen = (side == sign) | (side == 0)
        move_hand(pose, np.full((n, 1), sign), up * chosen, reach * target)
    pose.tilt = pose.tilt - 0.05 * up * side
    pose.look = pose.look + 0.1 * up * side


def reach(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Stretch one hand to a place ahead, above, below or beside, and take it back."""
    pose, side = stand(random, n, frames, bones), coin(random, n)
    out, _ = hold(random, n, frames, (0.45, 0.8))
    kind = random.integers(0, 4, n)
    centre = np.array(
        [[-0.1, -0.05, 1.0], [0.05, 0.95, 0.35], [0.05, -0.62, 0.75], [0.95, 0.1, 0.25]]
    )
    direction = centre[kind] + random.normal(0, 0.10, (n, 3))
    direction = direction / np.linalg.norm(direction, axis=-1, keepdims=True)
    length = arm_reach(bones) * uniform(random, 0.85, 0.96, n)[..., None]
    target = np.broadcast_to((length[:, 0] * direction)[:, None], (n, frames, 3))
    move_hand(pose, side, out, target)
    lean = uniform(random, 0.5, 1.0, n) * out
    pose.twist = pose.twist - 0.25 * side * lean * direction[:, 2:]
    pose.bend = pose.bend + lean * (0.2 * direction[:, 2:] - 0.42 * direction[:, 1:2].clip(None, 0))
    pose.pitch = pose.pitch - 0.25 * lean * direction[:, 1:2].clip(None, 0)
    pose.tilt = pose.tilt + 0.22 * side * lean * direction[:, :1] * (np.abs(direction[:, :1]) > 0.5)
    pose.pelvis[..., 1] += 0.12 * lean * direction[:, 1:2].clip(None, 0)
    pose.pelvis[..., 2] -= 0.05 * lean * direction[:, 2:]
    pose.nod = pose.nod - 0.35 * out * direction[:, 1:2]
    pose.look = pose.look + 0.35 * out * side * direction[:, :1]
    return settle(pose, bones), {"side": side[:, 0], "kind": kind.astype(float)}


def idle(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Stand, shifting the weight from one leg to the other."""
    pose = stand(random, n, frames, bones)
    shift = wander(random, n, frames, 0.025, 0.3)
    pose.pelvis[..., 0] += shift
    pose.roll, pose.tilt = pose.roll + shift, pose.tilt - shift
    pose.look = pose.look + wander(random, n, frames, 0.25, 0.4)
    return settle(pose, bones), {}
