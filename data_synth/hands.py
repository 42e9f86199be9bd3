"""What hands do while the feet stand: wave, reach, point, clap, throw, punch, carry, draw."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from data_synth.body import Made, Pose
from data_synth.curves import acts, bump, coin, ease, hold, seconds, through, uniform, wander
from data_synth.standing import arm_reach, move_hand, settle, shoulder_width, stand
from projflow_lite.skeleton import FPS


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
    up, _ = hold(random, n, frames, (0.35, 0.65))
    reach = arm_reach(bones)
    rate, width = uniform(random, 0.9, 2.0, n), uniform(random, 0.12, 0.28, n)
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
    act = acts(random, n, frames, (1.4, 2.5), most=3)
    out = act.strength * bump(act.phase, 0.0, 0.38, 0.58, 1.0)
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
    return settle(pose, bones), {
        "side": side[:, 0], "kind": kind.astype(float), "times": act.times[:, 0],
    }  # fmt: skip


def point(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Point ahead, up or to the side with a straight arm; the trunk stays upright."""
    pose, side = stand(random, n, frames, bones), coin(random, n)
    kind = point_with(random, pose, side, frames, bones)
    return settle(pose, bones), {"side": side[:, 0], "kind": kind}


def point_with(
    random: np.random.Generator, pose: Pose, side: NDArray, frames: int, bones: NDArray
) -> NDArray:
    """Point with the left hand (+1) or the right one (-1); returns whither, ``(n,)``."""
    n = len(side)
    out, _ = hold(random, n, frames, (0.35, 0.6))
    kind = random.integers(0, 3, n)
    centre = np.array([[-0.15, 0.05, 1.0], [0.1, 0.9, 0.45], [0.95, 0.08, 0.2]])
    direction = centre[kind] + random.normal(0, 0.06, (n, 3))
    direction = direction / np.linalg.norm(direction, axis=-1, keepdims=True)
    drift = np.stack([wander(random, n, frames, 0.015, 0.9) for _ in range(3)], axis=-1)
    target = 1.04 * arm_reach(bones) * (direction[:, None] + drift)
    move_hand(pose, side, out, target)
    pose.twist = pose.twist - 0.10 * side * out * direction[:, 2:]
    pose.nod = pose.nod - 0.30 * out * direction[:, 1:2]
    pose.look = pose.look + 0.45 * out * side * direction[:, :1]
    return kind.astype(float)


def clap(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Clap with both hands before the chest."""
    pose, t = stand(random, n, frames, bones), seconds(frames)
    up, _ = hold(random, n, frames, (0.35, 0.6))
    rate, width = uniform(random, 1.2, 2.4, n), uniform(random, 0.08, 0.20, n)
    beat = np.cos(2 * np.pi * (rate * t + uniform(random, 0, 1, n)))
    gap = 0.035 + width * (1 - beat) / 2
    arm, height, front = (
        arm_reach(bones)[..., 0],
        uniform(random, -0.30, 0.05, n),
        uniform(random, 0.50, 0.66, n),
    )
    target = np.stack(
        [gap - shoulder_width(bones), arm * height + 0 * gap, arm * front + 0 * gap], axis=-1
    )
    for sign in (1.0, -1.0):
        move_hand(pose, np.full((n, 1), sign), up, target)
    pose.bend = pose.bend + up * (0.03 + 0.015 * beat)
    pose.nod = pose.nod + 0.05 * up
    return settle(pose, bones), {"rate": rate[:, 0]}


def throw(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Throw something ahead with one hand, from behind the shoulder."""
    pose, side = stand(random, n, frames, bones), coin(random, n)
    act = acts(random, n, frames, (1.6, 2.3), most=3)
    s, size = act.phase, act.strength
    path = through(
        s,
        [(0.0, (0.20, -0.92, 0.10)), (0.18, (0.46, -0.30, 0.05)), (0.36, (0.48, 0.40, -0.20)),
         (0.50, (0.32, 0.62, 0.20)), (0.63, (0.0, 0.28, 0.86)), (0.78, (-0.25, -0.45, 0.66)),
         (1.0, (0.20, -0.92, 0.10))],
    )  # fmt: skip
    share = bump(s, 0.0, 0.20, 0.74, 1.0) * size
    target = arm_reach(bones) * path
    move_hand(pose, side, share, target)
    other = arm_reach(bones) * np.array([0.15, -0.10, 0.75])
    aims = size * bump(s, 0.10, 0.38, 0.45, 0.75)
    move_hand(pose, -side, aims * uniform(random, 0.4, 0.9, n), np.broadcast_to(other, path.shape))
    wound, thrown = size * bump(s, 0.05, 0.38, 0.42, 0.60), size * bump(s, 0.45, 0.66, 0.70, 1.0)
    turned = uniform(random, 0.35, 0.6, n) * (wound - 0.8 * thrown)
    pose.twist, pose.yaw = pose.twist + side * turned, pose.yaw + 0.3 * side * turned
    pose.look = pose.look - side * turned
    pose.bend = pose.bend - 0.12 * wound + 0.28 * thrown
    pose.pelvis[..., 2] += -0.05 * wound + 0.06 * thrown
    return settle(pose, bones), {"side": side[:, 0], "times": act.times[:, 0]}


def punch(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Raise both fists and punch ahead with one of them, or with one after the other."""
    pose = stand(random, n, frames, bones)
    side = random.choice([-1.0, 0.0, 1.0], (n, 1), p=[0.36, 0.28, 0.36])
    act = acts(random, n, frames, (0.65, 0.95), most=3, margin=0.3)
    first = coin(random, n)
    hits = np.where(side == 0, first * np.where(act.done % 2 == 0, 1.0, -1.0), side)
    arm = arm_reach(bones)
    guard = arm * np.array([-0.12, -0.02, 0.44])
    aim = arm * np.stack(
        [np.full((n, 1), -0.22), uniform(random, -0.10, 0.18, n), np.full((n, 1), 0.92)], axis=-1
    )
    out = act.strength * bump(act.phase, 0.05, 0.45, 0.48, 0.95)
    for sign in (1.0, -1.0):
        each = out * (hits == sign)
        target = guard + each[..., None] * (aim - guard)
        move_hand(pose, np.full((n, 1), sign), act.envelope, target)
    pose.twist = pose.twist - 0.30 * hits * out
    pose.look = pose.look + 0.30 * hits * out
    pose.bend = pose.bend + 0.10 * act.envelope + 0.06 * out
    pose.pelvis[..., 2] += 0.04 * out
    pose.pelvis[..., 1] -= 0.03 * act.envelope
    times = np.where(side == 0, np.nan, act.times)
    # One punch with either hand is a punch with the hand that did it.
    only = (side == 0) & (act.times == 1)
    side, times = np.where(only, first, side), np.where(only, 1.0, times)
    return settle(pose, bones), {"side": side[:, 0], "times": times[:, 0]}


def carry(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Stand and hold something with both hands, lifting and lowering it a little."""
    pose = stand(random, n, frames, bones)
    hold_with_both(random, pose, bones, lively=1.0)
    shift = wander(random, n, frames, 0.03, 0.6)
    pose.pelvis[..., 0] += shift
    pose.roll, pose.tilt = pose.roll + shift, pose.tilt - shift
    return settle(pose, bones), {}


def hold_with_both(
    random: np.random.Generator, pose: Pose, bones: NDArray, lively: float = 0.4
) -> None:
    """Hold something before the body with both hands, as far apart as it is wide."""
    n, frames = pose.look.shape
    half = uniform(random, 0.12, 0.22, n)
    arm = arm_reach(bones)[..., 0]
    height = uniform(random, -0.55, -0.30, n) + lively * wander(random, n, frames, 0.11, 0.8)
    front = uniform(random, 0.52, 0.68, n) + lively * wander(random, n, frames, 0.05, 0.8)
    target = np.stack([half - shoulder_width(bones) + 0 * front, arm * height, arm * front], -1)
    for s, sign in enumerate((1.0, -1.0)):
        pose.hand[:, :, s] = target * [sign, 1, 1]
    pose.twist = 0.4 * pose.twist  # hands that hold one thing go together, and shoulders with them
    pose.bend = pose.bend - 0.03


def draw(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Draw in the air with one hand: a circle, a figure eight, or a line up and down."""
    pose, side, t = stand(random, n, frames, bones), coin(random, n), seconds(frames)
    kind = random.integers(0, 3, (n, 1))
    length = frames / FPS
    up = ease(t / min(0.6, 0.25 * length)) * ease((length - t) / min(0.6, 0.25 * length))
    rate = np.maximum(uniform(random, 0.5, 1.1, n), 1.15 / length)
    size, way = uniform(random, 0.22, 0.42, n), coin(random, n)
    angle = way * 2 * np.pi * (rate * t + uniform(random, 0, 1, n))
    x = np.choose(kind, [np.cos(angle), np.sin(angle), 0.05 * np.cos(angle)])
    y = np.choose(kind, [np.sin(angle), 0.55 * np.sin(2 * angle), np.sin(angle)])
    centre = np.array([0.0, 0.05, 0.72])
    target = arm_reach(bones) * (centre + np.stack([size * x, size * y, -0.12 * size * x], axis=-1))
    move_hand(pose, side, up, target)
    pose.twist = pose.twist - 0.12 * side * up
    pose.look = pose.look + 0.12 * side * up + 0.06 * up * x * side
    pose.tilt = pose.tilt + 0.03 * up * x * side
    return settle(pose, bones), {"side": side[:, 0], "kind": kind[:, 0].astype(float)}


def raise_arms(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Lift both arms out to the sides, ahead, or over the head, and lower them."""
    pose = stand(random, n, frames, bones)
    kind = random.integers(0, 3, n)
    act = acts(random, n, frames, (1.3, 2.5))
    up = act.strength * bump(act.phase, 0.0, 0.40, 0.58, 1.0)
    centre = np.array([[0.97, 0.02, 0.12], [0.02, 0.02, 0.97], [0.18, 0.93, 0.12]])
    direction = centre[kind] + random.normal(0, 0.04, (n, 3))
    direction = direction / np.linalg.norm(direction, axis=-1, keepdims=True)
    straight = uniform(random, 0.95, 1.06, n)[..., None]
    target = straight * arm_reach(bones) * direction[:, None]
    for sign in (1.0, -1.0):
        move_hand(pose, np.full((n, 1), sign), up, np.broadcast_to(target, (n, frames, 3)))
    overhead = up * (kind == 2)[:, None]
    pose.bend = pose.bend - 0.06 * up - 0.05 * overhead
    pose.nod = pose.nod - 0.12 * overhead
    return settle(pose, bones), {"kind": kind.astype(float), "times": act.times[:, 0]}
