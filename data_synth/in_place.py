"""The whole body on the spot: squat, sit, bow, lunge, kick, stand on one leg, sway, idle."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from data_synth.body import Made, standing_height
from data_synth.curves import acts, bump, coin, ease, hold, seconds, through, uniform, wander
from data_synth.standing import (
    arm_reach,
    hang_down,
    move_hand,
    settle,
    shift_weight,
    stand,
    swing_arm,
)
from projflow_lite.skeleton import FPS


def squat(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Bend the knees and come up again, up to three times, arms ahead for balance."""
    pose = stand(random, n, frames, bones)
    act = acts(random, n, frames, (1.0, 2.0))
    depth = uniform(random, 0.22, 0.46, n) * act.strength
    down = bump(act.phase, 0.0, 0.48, 0.54, 1.0)
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
    return settle(pose, bones), {"depth": depth[:, 0], "times": act.times[:, 0]}


def bow(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Bend forward from the hips and come up again; arms hang."""
    pose = stand(random, n, frames, bones)
    act = acts(random, n, frames, (1.2, 2.3))
    depth = uniform(random, 0.5, 1.2, n) * act.strength
    down = depth * bump(act.phase, 0.0, 0.42, 0.56, 1.0)
    pose.pitch = pose.pitch + 0.45 * down
    pose.bend = pose.bend + 0.6 * down
    pose.nod = pose.nod + 0.15 * down
    pose.pelvis[..., 2] -= 0.10 * down
    pose.pelvis[..., 1] -= 0.02 * down
    hang_down(pose, uniform(random, 0.75, 1.0, n) * down)
    return settle(pose, bones), {"depth": depth[:, 0], "times": act.times[:, 0]}


def sit(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Sit down on a chair (which is not shown), stand up from it, or both."""
    pose, t = stand(random, n, frames, bones), seconds(frames)
    length = frames / FPS
    kind = random.integers(0, 3 if length >= 2.6 else 2, (n, 1))  # down, up, down and up
    lasting = uniform(random, 1.0, 1.5, n) * min(1.0, length / 2.6)
    down_at = uniform(random, 0.03, 0.12, n) * length
    up_at = np.where(
        kind == 1,
        uniform(random, 0.1, 0.35, n) * length,
        np.maximum(uniform(random, 0.5, 0.6, n) * length, down_at + lasting),
    )
    lasting = np.where(kind == 2, np.minimum(lasting, 0.97 * length - up_at), lasting)
    down = np.where(kind == 1, 1.0, ease((t - down_at) / lasting))
    up = np.where(kind == 0, 0.0, ease((t - up_at) / lasting))
    seated = down - up
    seat = uniform(random, 0.47, 0.56, n)
    drop = standing_height(bones)[:, None] - seat
    between = 4 * seated * (1 - seated)
    back = uniform(random, 0.30, 0.38, n)
    pose.pelvis[..., 1] -= drop * (0.6 * seated + 0.4 * seated**2)
    pose.pelvis[..., 2] -= back * (1.2 * seated - 0.2 * seated**2)
    lean = uniform(random, 0.45, 0.65, n)
    pose.pitch = pose.pitch + lean * between - 0.1 * seated
    pose.bend = pose.bend + 0.45 * lean * between + 0.1 * seated
    pose.nod = pose.nod - 0.5 * lean * between
    reach = arm_reach(bones)
    onto = reach * np.array([-0.08, -0.58, 0.58])
    for side in (1.0, -1.0):
        move_hand(pose, np.full((n, 1), side), seated, np.broadcast_to(onto, (n, frames, 3)))
    return settle(pose, bones), {"kind": kind[:, 0].astype(float)}


def lunge(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Step far ahead with one leg, go down over it, and step back."""
    pose, side = stand(random, n, frames, bones), coin(random, n)
    act = acts(random, n, frames, (1.9, 2.8))
    s = act.phase
    ahead = uniform(random, 0.55, 0.80, n) * act.strength
    out = bump(s, 0.04, 0.32, 0.66, 0.95)
    deep = bump(s, 0.10, 0.48, 0.54, 0.92)
    lift = 0.09 * act.strength * (bump(s, 0.02, 0.17, 0.19, 0.34) + bump(s, 0.64, 0.80, 0.82, 0.97))
    for k, sign in enumerate((1.0, -1.0)):
        leads = side == sign
        pose.toe[:, :, k, 2] += leads * ahead * out
        pose.toe[:, :, k, 1] += leads * lift
        pose.foot_pitch[:, :, k] += np.where(leads, 0.0, 0.9 * deep * ahead)
    pose.pelvis[..., 2] += 0.52 * ahead * deep
    pose.pelvis[..., 1] -= uniform(random, 0.42, 0.56, n) * ahead * deep
    pose.bend = pose.bend + 0.12 * deep
    shift_weight(pose, -side, 0.5 * bump(s, 0.0, 0.12, 0.22, 0.42))
    hands = arm_reach(bones) * np.array([0.25, -0.62, 0.15])
    on_hips = random.random((n, 1)) < 0.4
    for sign in (1.0, -1.0):
        target = np.broadcast_to(hands, (n, frames, 3))
        move_hand(pose, np.full((n, 1), sign), on_hips * act.envelope, target)
    return settle(pose, bones), {"side": side[:, 0], "times": act.times[:, 0]}


def kick(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Kick ahead with one leg, low or high, once or several times."""
    pose, side = stand(random, n, frames, bones), coin(random, n)
    act = acts(random, n, frames, (1.2, 1.8))
    s = act.phase
    height, ahead = uniform(random, 0.15, 0.70, n), uniform(random, 0.52, 0.68, n)
    path = through(
        s,
        [(0.0, (0, 0, 0)), (0.11, (0, 0, 0)), (0.28, (0, 0, -0.26)), (0.40, (0, 0, 0.10)),
         (0.54, (0, 0, 1)), (0.72, (0, 0, 0.24)), (0.90, (0, 0, 0)), (1.0, (0, 0, 0))],
    )[..., 2]  # fmt: skip
    # The foot goes from a low place to the height of the kick only while it is ahead.
    high = bump(s, 0.36, 0.54, 0.55, 0.80)
    up = 0.14 * bump(s, 0.0, 0.20, 0.70, 1.0) + (height - 0.14) * high
    away = path * np.where(path > 0, ahead, 1.0)
    toes = 1.1 * bump(s, 0.03, 0.25, 0.32, 0.50)
    for k, sign in enumerate((1.0, -1.0)):
        kicks = side == sign
        pose.toe[:, :, k, 1] += kicks * act.strength * up
        pose.toe[:, :, k, 2] += kicks * act.strength * away
        pose.foot_pitch[:, :, k] += kicks * act.strength * toes
    shift_weight(pose, -side, act.envelope)
    struck = act.strength * bump(s, 0.34, 0.54, 0.58, 0.9)
    wound = act.strength * bump(s, 0.0, 0.26, 0.30, 0.5)
    pose.pitch = pose.pitch - 0.20 * struck * height / 0.5 + 0.1 * wound
    pose.bend = pose.bend + 0.16 * struck - 0.05 * wound
    pose.yaw = pose.yaw - 0.15 * side * (struck - wound)
    pose.twist = pose.twist + 0.3 * side * (struck - wound)
    for sign in (1.0, -1.0):
        swing_arm(pose, sign, 0.7 * np.where(side == sign, -1, 1) * (struck - 0.6 * wound))
    return settle(pose, bones), {
        "side": side[:, 0], "times": act.times[:, 0], "height": (act.strength * height)[:, 0],
    }  # fmt: skip


def balance(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Stand on one leg, the other foot held up, arms out."""
    pose, side = stand(random, n, frames, bones), coin(random, n)
    up, _ = hold(random, n, frames, (0.5, 0.9))
    shift_weight(pose, side, ease(1.35 * up))
    high, ahead = uniform(random, 0.18, 0.45, n), uniform(random, -0.15, 0.22, n)
    for k, sign in enumerate((1.0, -1.0)):
        free = (side != sign) * up
        pose.toe[:, :, k, 1] += high * free
        pose.toe[:, :, k, 2] += ahead * free**2
        pose.foot_pitch[:, :, k] += 0.7 * free
    spread = uniform(random, 0.0, 1.0, n) * up
    target = arm_reach(bones) * np.array([0.88, 0.0, 0.25])
    drift = np.stack([wander(random, n, frames, 0.03, 0.9) for _ in range(3)], axis=-1)
    for sign in (1.0, -1.0):
        move_hand(pose, np.full((n, 1), sign), spread, target + drift)
    pose.tilt = pose.tilt + up * wander(random, n, frames, 0.03, 0.9)
    return settle(pose, bones), {"side": side[:, 0]}


def sway(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Sway from side to side with the hips and the arms."""
    pose, t = stand(random, n, frames, bones), seconds(frames)
    rate = uniform(random, 0.35, 0.85, n)
    on = 0.3 + 0.7 * ease(t / min(0.6, 0.4 * frames / FPS))
    angle = 2 * np.pi * (rate * t + uniform(random, 0, 1, n))
    swing = on * np.sin(angle)
    pose.pelvis[..., 0] += uniform(random, 0.04, 0.08, n) * swing
    pose.pelvis[..., 1] -= uniform(random, 0.005, 0.02, n) * on * (1 - np.cos(2 * angle)) / 2
    turns, leans = uniform(random, 0.0, 0.35, n), uniform(random, 0.05, 0.12, n)
    pose.roll, pose.tilt = pose.roll - leans * swing, pose.tilt + 1.6 * leans * swing
    pose.twist = pose.twist + turns * on * np.sin(angle - 0.6)
    for sign in (1.0, -1.0):
        swing_arm(pose, sign, -0.9 * sign * turns * on * np.sin(angle - 0.9))
    return settle(pose, bones), {"rate": rate[:, 0]}


def idle(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Stand, shifting the weight from one leg to the other and looking around."""
    pose = stand(random, n, frames, bones)
    shift = wander(random, n, frames, 0.035, 0.4)
    pose.pelvis[..., 0] += shift
    pose.roll, pose.tilt = pose.roll + shift, pose.tilt - shift
    pose.look = pose.look + wander(random, n, frames, 0.35, 0.6)
    return settle(pose, bones), {}
