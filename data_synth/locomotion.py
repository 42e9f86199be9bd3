"""Actions that travel: each draws a gait and a ground path and walks the body over it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from data_synth.body import Made, Pose, standing_height
from data_synth.curves import coin, ease, uniform, wander
from data_synth.gait import MARGIN, Gait, Path, path_of, walk_over
from data_synth.standing import drifting, hang_down
from projflow_lite.skeleton import FPS


def stretch(bones: NDArray) -> NDArray:
    """How tall each body is compared with the mean one, ``(n,)``."""
    return standing_height(bones) / 0.97


def walking_gait(random: np.random.Generator, speed: NDArray, bones: NDArray) -> Gait:
    """A gait that suits a walking speed ``(n,)``: faster means longer and more frequent steps."""
    n, tall = len(speed), stretch(bones)
    stride = (0.55 + 0.66 * speed) * tall * random.normal(1, 0.05, n)
    return Gait(
        cadence=(2 * np.abs(speed) / stride).clip(1.0, 2.6),
        phase=random.uniform(0, 1, n),
        duty=(0.625 - 0.04 * speed).clip(0.56, 0.66),
        width=random.uniform(0.07, 0.15, n),
        lift=random.uniform(0.055, 0.088, n),
        bob=(0.005 + 0.0045 * speed) * random.uniform(0.7, 1.3, n),
        sway=random.uniform(0.014, 0.030, n),
        jolt=0.0045 * speed * random.uniform(0.5, 1.4, n),
        surge=0.0095 * speed * random.uniform(0.6, 1.3, n),
        pitch=(0.50 + 0.45 * speed).clip(0.5, 1.2) * random.uniform(0.9, 1.1, n),
        swing=(0.065 + 0.082 * speed) * random.lognormal(0, 0.38, n).clip(0.5, 2.4),
        elbow=random.uniform(0.25, 0.65, n),
        arms_out=random.uniform(0.07, 0.18, n),
        lean=random.uniform(-0.02, 0.08, n),
        crouch=random.uniform(0.002, 0.020, n) * tall,
    )


def running_gait(random: np.random.Generator, speed: NDArray, bones: NDArray) -> Gait:
    """A gait that suits a running speed ``(n,)``, with a flight phase between the steps."""
    n, tall = len(speed), stretch(bones)
    return Gait(
        cadence=random.normal(2.70, 0.10, n),
        phase=random.uniform(0, 1, n),
        duty=random.uniform(0.30, 0.36, n),
        width=random.uniform(0.09, 0.17, n),
        lift=random.uniform(0.18, 0.26, n),
        bob=random.uniform(0.036, 0.052, n),
        sway=random.uniform(0.005, 0.012, n),
        jolt=random.uniform(0.003, 0.008, n),
        surge=random.uniform(0.004, 0.010, n),
        pitch=random.uniform(0.8, 1.0, n),
        swing=random.uniform(0.18, 0.38, n),
        elbow=random.uniform(1.2, 1.6, n),
        arms_out=random.uniform(0.08, 0.18, n),
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
        pose.hand[:, :, s] += drifting(random, n, frames, 0.009, 3.0)
    pose.twist = pose.twist + wander(random, n, frames, 0.010, 3.0)
    pose.bend = pose.bend + wander(random, n, frames, 0.010, 3.0)
    pose.nod = pose.nod + wander(random, n, frames, 0.02, 2.0)


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


def jog(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Run slowly: shorter steps, softer landings, arms bent."""
    speed = random.normal(2.0, 0.2, n).clip(1.6, 2.4)
    gait = running_gait(random, speed, bones)
    gait.cadence = random.normal(2.5, 0.10, n)
    gait.duty, gait.lift = random.uniform(0.36, 0.42, n), random.uniform(0.10, 0.16, n)
    gait.bob, gait.pitch = random.uniform(0.028, 0.042, n), random.uniform(0.6, 0.8, n)
    gait.lean, gait.crouch = random.uniform(0.05, 0.15, n), gait.crouch * 0.8
    pose = walk_over(gait, straight(random, speed, frames), bones)
    loosen(random, pose)
    return pose, {"speed": speed}


def sneak(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Creep ahead: crouched, slow, feet lifted carefully, hands held before the body."""
    speed = random.normal(0.55, 0.08, n).clip(0.38, 0.75)
    gait = walking_gait(random, speed, bones)
    gait.cadence = random.normal(1.15, 0.10, n).clip(0.95, 1.4)
    gait.crouch = random.uniform(0.14, 0.24, n) * stretch(bones)
    gait.lift, gait.pitch = random.uniform(0.12, 0.20, n), random.uniform(0.4, 0.6, n)
    gait.lean, gait.elbow = random.uniform(0.35, 0.60, n), random.uniform(1.0, 1.6, n)
    gait.width, gait.duty = gait.width + 0.04, random.uniform(0.60, 0.66, n)
    pose = walk_over(gait, straight(random, speed, frames), bones)
    loosen(random, pose)
    hang_down(pose, np.broadcast_to(0.5 * gait.lean[:, None], pose.look.shape))
    return pose, {"speed": speed}


def march(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Step on the spot and lift the knees high."""
    gait = walking_gait(random, np.full(n, 1.1), bones)
    gait.cadence, gait.duty = random.normal(1.9, 0.2, n).clip(1.4, 2.3), np.full(n, 0.58)
    gait.lift, gait.pitch = random.uniform(0.18, 0.38, n), random.uniform(0.3, 0.5, n)
    gait.swing = random.uniform(0.25, 0.60, n)
    gait.elbow, gait.surge = random.uniform(0.4, 1.2, n), np.zeros(n)
    gait.width, gait.marching = random.uniform(0.13, 0.20, n), True
    zero = np.zeros((n, frames + 2 * MARGIN))
    pose = walk_over(gait, path_of(zero, zero, wander(random, n, zero.shape[1], 0.04, 0.3)), bones)
    loosen(random, pose)
    return pose, {"lift": gait.lift}


def ramp(frames: int, middle: NDArray, lasting: NDArray | float) -> NDArray:
    """From 0 to 1 on the frames of a path; `middle` and `lasting` are ``(n, 1)`` seconds."""
    long = np.arange(-MARGIN, frames + MARGIN)[None] / FPS
    return ease((long - middle) / lasting + 0.5)


def walk_start(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Stand, then walk off."""
    speed, length = random.normal(1.15, 0.2, n).clip(0.6, 1.6), frames / FPS
    going = ramp(frames, uniform(random, 0.18, 0.42, n) * length, 0.9)
    return change_of_pace(random, speed, going, frames, bones)


def walk_stop(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Walk, then stop and stand."""
    speed, length = random.normal(1.15, 0.2, n).clip(0.6, 1.6), frames / FPS
    going = 1 - ramp(frames, uniform(random, 0.48, 0.72, n) * length, 0.9)
    return change_of_pace(random, speed, going, frames, bones)


def change_of_pace(
    random: np.random.Generator, speed: NDArray, going: NDArray, frames: int, bones: NDArray
) -> Made:
    """Walk straight ahead where `going` ``(n, frames + 2 MARGIN)`` is 1, stand where it is 0."""
    velocity = steady(speed, frames, random) * going
    heading = wander(random, len(speed), going.shape[1], 0.04, 0.3)
    path = path_of(velocity, np.zeros_like(velocity), heading, going)
    gait = walking_gait(random, speed, bones)
    gait.width = gait.width + 0.03
    pose = walk_over(gait, path, bones)
    loosen(random, pose)
    return pose, {"speed": speed}


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
