"""Actions that travel: each draws a gait and a ground path and walks the body over it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from data_synth.body import Made, Pose, standing_height
from data_synth.curves import coin, uniform, wander
from data_synth.gait import MARGIN, Gait, Path, path_of, walk_over
from data_synth.in_place import wave_hands
from projflow_lite.skeleton import FPS


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


def walk_and_wave(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Walk straight ahead and wave one hand."""
    pose, drawn = walk(random, n, frames, bones)
    side = coin(random, n)
    wave_hands(random, pose, side, frames, bones)
    return pose, {**drawn, "side": side[:, 0]}
