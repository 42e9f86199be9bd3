"""One function for every action: draw its parameters, make its pose, say what was drawn.

To add an action: write a function here, add it to `MAKERS`, and give it captions in captions.py.
Each takes ``(random, n, frames, bones)`` and returns a `Pose` and a dict of ``(n,)`` parameters.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from data_synth.body import Pose, standing_height
from data_synth.curves import coin, hermite, hold, seconds, uniform, wander
from data_synth.gait import MARGIN, Gait, Path, ease, path_of, walk_over
from data_synth.standing import arm_reach, move_hand, settle, stand
from projflow_lite.skeleton import FPS

Made = tuple[Pose, dict[str, NDArray]]
Maker = Callable[[np.random.Generator, int, int, NDArray], Made]
GRAVITY = 9.81


def stretch(bones: NDArray) -> NDArray:
    """How tall each body is compared with the mean one, ``(n,)``."""
    return standing_height(bones) / 1.01


def walking_gait(random: np.random.Generator, speed: NDArray, bones: NDArray) -> Gait:
    """A gait that suits a walking speed ``(n,)``: faster means longer and more frequent steps."""
    n, tall = len(speed), stretch(bones)
    stride = (0.55 + 0.66 * speed) * tall * random.normal(1, 0.05, n)
    return Gait(
        cadence=(2 * np.abs(speed) / stride).clip(1.0, 2.6),
        phase=random.uniform(0, 1, n),
        duty=(0.66 - 0.04 * speed).clip(0.56, 0.66),
        width=random.uniform(0.09, 0.16, n),
        lift=random.uniform(0.05, 0.09, n),
        bob=random.uniform(0.010, 0.019, n),
        sway=random.uniform(0.014, 0.030, n),
        pitch=(0.35 + 0.55 * speed).clip(0.35, 1.1),
        swing=(0.10 + 0.20 * speed) * random.uniform(0.6, 1.3, n),
        elbow=random.uniform(0.15, 0.55, n),
        lean=random.uniform(-0.01, 0.09, n),
        crouch=random.uniform(0.025, 0.045, n) * tall,
    )


def running_gait(random: np.random.Generator, speed: NDArray, bones: NDArray) -> Gait:
    """A gait that suits a running speed ``(n,)``, with a flight phase between the steps."""
    n, tall = len(speed), stretch(bones)
    cadence = random.normal(2.70, 0.10, n)
    return Gait(
        cadence=cadence,
        phase=random.uniform(0, 1, n),
        duty=random.uniform(0.30, 0.36, n),
        width=random.uniform(0.06, 0.13, n),
        lift=random.uniform(0.14, 0.24, n),
        bob=random.uniform(0.034, 0.048, n),
        sway=random.uniform(0.005, 0.012, n),
        pitch=random.uniform(0.8, 1.0, n),
        swing=random.uniform(0.45, 0.75, n),
        elbow=random.uniform(1.2, 1.6, n),
        lean=random.uniform(0.10, 0.24, n),
        crouch=random.uniform(0.08, 0.11, n) * tall,
        running=True,
    )


def steady(
    value: NDArray, frames: int, random: np.random.Generator, wobble: float = 0.03
) -> NDArray:
    """A nearly constant curve on the frames of a path, ``(n, frames + 2 MARGIN)``."""
    long = frames + 2 * MARGIN
    return value[:, None] * (1 + wander(random, len(value), long, wobble, 0.4))


def straight(random: np.random.Generator, speed: NDArray, frames: int) -> Path:
    """A nearly straight path."""
    long = frames + 2 * MARGIN
    heading = wander(random, len(speed), long, 0.05, 0.3)
    return path_of(steady(speed, frames, random), np.zeros((len(speed), long)), heading)


def loosen(random: np.random.Generator, pose: Pose) -> None:
    """Slow drift of trunk, head and hands over a gait: no two strides are alike."""
    n, frames = pose.look.shape
    pose.twist = pose.twist + wander(random, n, frames, 0.03, 0.5)
    pose.bend = pose.bend + wander(random, n, frames, 0.03, 0.5)
    pose.tilt = pose.tilt + wander(random, n, frames, 0.03, 0.5)
    pose.look = pose.look + wander(random, n, frames, 0.12, 0.5)
    for s in range(2):
        for axis, size in ((0, 0.012), (1, 0.008), (2, 0.010)):
            pose.hand[:, :, s, axis] += wander(random, n, frames, size, 0.5)


def walk(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Walk straight ahead."""
    speed = random.normal(1.2, 0.24, n).clip(0.55, 1.8)
    pose = walk_over(walking_gait(random, speed, bones), straight(random, speed, frames), bones)
    loosen(random, pose)
    return pose, {"speed": speed}


def run(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Run straight ahead."""
    speed = random.normal(3.0, 0.35, n).clip(2.2, 3.8)
    pose = walk_over(running_gait(random, speed, bones), straight(random, speed, frames), bones)
    loosen(random, pose)
    return pose, {"speed": speed}


def walk_curve(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Walk along a curve to one side, or along an S."""
    speed = random.normal(1.1, 0.18, n).clip(0.6, 1.5)
    side, s_curve = coin(random, n), random.random((n, 1)) < 0.35
    long = np.arange(-MARGIN, frames + MARGIN)[None] / FPS
    rate = uniform(random, 0.35, 0.85, n)  # radians a second: 1 to 3 m of radius
    wave = 2 * np.pi * long / (frames / FPS)
    heading = side * rate * np.where(s_curve, 1.6 * np.sin(wave) / (2 * np.pi) * frames / FPS, long)
    path = path_of(steady(speed, frames, random), np.zeros_like(heading), heading)
    pose = walk_over(walking_gait(random, speed, bones), path, bones)
    loosen(random, pose)
    pose.look = pose.look + 0.15 * side * ~s_curve
    return pose, {"speed": speed, "side": side[:, 0], "s_curve": s_curve[:, 0].astype(float)}


def walk_backward(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Walk backwards, with short steps."""
    speed = random.normal(0.75, 0.12, n).clip(0.45, 1.1)
    gait = walking_gait(random, speed, bones)
    gait.pitch, gait.swing = gait.pitch * 0.35, gait.swing * 0.6
    pose = walk_over(gait, straight(random, -speed, frames), bones)
    loosen(random, pose)
    return pose, {"speed": -speed}


def sidestep(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Step to one side, facing ahead; the feet meet and part but never cross."""
    speed, side = random.normal(0.45, 0.07, n).clip(0.3, 0.65), coin(random, n)
    gait = walking_gait(random, speed * 0.8, bones)
    gait.cadence = random.normal(1.75, 0.12, n)
    gait.pitch, gait.swing = gait.pitch * 0.3, gait.swing * 0.25
    gait.sway, gait.crouch = gait.sway * 0.5, gait.crouch + 0.03
    gait.width = 0.11 + speed / gait.cadence  # at their closest the feet still stand side by side
    gait.elbow = random.uniform(0.3, 0.8, n)
    zero = np.zeros((n, frames + 2 * MARGIN))
    drift = steady(speed * side[:, 0], frames, random)
    pose = walk_over(gait, path_of(zero, drift, wander(random, n, zero.shape[1], 0.02, 0.3)), bones)
    loosen(random, pose)
    pose.look = pose.look + 0.35 * side
    return pose, {"speed": speed, "side": side[:, 0]}


def jump(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Crouch, take off, fly under gravity, land and recover; in place or ahead."""
    pose, t = stand(random, n, frames, bones), seconds(frames)
    scale = min(1.0, frames / FPS / 2.2)
    height = uniform(random, 0.10, 0.34, n) * scale
    ahead = uniform(random, 0.3, 1.0, n) * scale * (random.random((n, 1)) < 0.5)
    speed = np.sqrt(2 * GRAVITY * height)
    air = 2 * speed / GRAVITY
    crouch = uniform(random, 0.45, 0.65, n) * scale
    push = uniform(random, 0.24, 0.30, n)
    absorb = uniform(random, 0.22, 0.3, n)
    total = crouch + push + air + absorb + 0.5 * scale
    begin = uniform(random, 0.02, 0.95, n) * np.maximum(frames / FPS - total, 0.0)
    start = pose.pelvis[:, :1, 1]
    low, rise = start - uniform(random, 0.20, 0.34, n) * (0.6 + height), start + 0.02
    off = begin + crouch + push
    land = off + air
    knots = [
        begin,
        begin + crouch,
        off,
        land,
        land + absorb,
        land + absorb + uniform(random, 0.5, 0.8, n) * scale,
    ]
    values = [start, low, rise, rise, start - 0.55 * (start - low), start]
    zero = np.zeros_like(begin)
    slopes = [zero, zero, speed, -speed, zero, zero]
    y = hermite(t, *(np.concatenate(k, axis=1) for k in (knots, values, slopes)))
    flight = (t - off).clip(0, None) * (t < land) + (t >= land) * 0.0
    ballistic = rise + speed * flight - 0.5 * GRAVITY * flight**2
    flying = (t >= off) & (t < land)
    y = np.where(flying, ballistic, y)
    pose.pelvis[..., 1] = y
    share = ((t - off) / air).clip(0, 1)
    # Before take-off and after landing the body is carried over the feet; in the air it coasts.
    carried = hermite(
        t,
        np.concatenate([begin + crouch, off, land, land + absorb + 0.2], axis=1),
        np.concatenate([zero, 0.16 * ahead, 0.84 * ahead, ahead], axis=1),
        np.concatenate([zero, 0.68 * ahead / air, 0.68 * ahead / air, zero], axis=1),
    )
    pose.pelvis[..., 2] += carried
    tuck = uniform(random, 0.02, 0.10, n) * np.sin(np.pi * share) ** 2
    pose.toe[..., 2] += (ahead * ease(share))[..., None]
    pose.toe[..., 1] += (np.where(flying, ballistic - rise, 0) + tuck)[..., None]
    heel_off = hermite(
        t, np.concatenate([off - 0.16, off, off + 0.5 * air, land, land + 0.12], axis=1),
        np.concatenate([zero, zero + 0.85, zero + 0.85, zero + 0.6, zero], axis=1),
    )  # fmt: skip
    pose.foot_pitch += heel_off[..., None]
    depth = ((start - y) / 0.3).clip(0, 1.2)
    pose.pitch, pose.bend = pose.pitch + 0.5 * depth, pose.bend + 0.35 * depth
    pose.pelvis[..., 2] -= 0.10 * depth
    pose.nod = pose.nod - 0.5 * depth
    swing_arms(pose, t, begin, crouch, off, land, absorb, random)
    return settle(pose, bones), {"height": height[:, 0], "ahead": ahead[:, 0]}


def swing_arms(
    pose: Pose, t, begin, crouch, off, land, absorb, random: np.random.Generator
) -> None:
    """Arms go back in the crouch, up in the take-off, and come down after landing."""
    n = len(begin)
    zero = np.zeros_like(begin)
    up = uniform(random, 0.7, 1.5, n)
    angle = hermite(
        t, np.concatenate([begin, begin + crouch, off + 0.12, land, land + absorb + 0.35], axis=1),
        np.concatenate([zero, zero - 0.7, up, 0.6 * up, zero], axis=1),
    )  # fmt: skip
    for s in range(2):
        x, y, z = np.moveaxis(pose.hand[:, :, s], -1, 0)
        c, sn = np.cos(angle), np.sin(angle)
        pose.hand[:, :, s] = np.stack([x, c * y + sn * z, -sn * y + c * z], axis=-1)


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


def walk_and_wave(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Walk straight ahead and wave one hand."""
    pose, drawn = walk(random, n, frames, bones)
    side = coin(random, n)
    wave_hands(random, pose, side, frames, bones)
    return pose, {**drawn, "side": side[:, 0]}


MAKERS: dict[str, Maker] = {
    maker.__name__: maker
    for maker in (
        walk, run, walk_curve, walk_backward, sidestep, walk_and_wave,
        jump, squat, wave, reach, idle,
    )
}  # fmt: skip
