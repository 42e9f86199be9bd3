"""Locomotion that changes direction: curves, turns on the way, turns on the spot."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from data_synth.body import Made
from data_synth.curves import coin, uniform, wander
from data_synth.gait import MARGIN, path_of, walk_over
from data_synth.locomotion import loosen, ramp, steady, walking_gait
from projflow_lite.skeleton import FPS


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


def walk_turn(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Walk, turn a corner to one side or right round, and walk on."""
    length = frames / FPS
    speed, side = random.normal(1.05, 0.15, n).clip(0.7, 1.4), coin(random, n)
    back = (random.random((n, 1)) < 0.4) & (length > 1.9)
    angle = np.where(back, uniform(random, 2.8, 3.3, n), uniform(random, 1.2, 1.75, n))
    angle = angle * min(1.0, length / 1.6)
    lasting = np.minimum(np.where(back, 2.0, 1.25), 0.8 * length)
    turning = ramp(frames, uniform(random, 0.42, 0.56, n) * length, lasting)
    slower = 1 - np.where(back, 0.5, 0.25) * 4 * turning * (1 - turning)
    velocity = steady(speed, frames, random) * slower
    gait = walking_gait(random, speed, bones)
    gait.width = gait.width + 0.03
    path = path_of(velocity, np.zeros_like(velocity), side * angle * turning)
    pose = walk_over(gait, path, bones)
    loosen(random, pose)
    soon = (turning * (1 - turning))[:, MARGIN + 4 : MARGIN + 4 + frames]
    pose.look = pose.look + 1.2 * side * soon  # the eyes go first
    return pose, {"speed": speed, "side": side[:, 0], "angle": angle[:, 0]}


def turn_on_spot(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Turn to one side with small steps on the spot, a quarter or half round."""
    length, side = frames / FPS, coin(random, n)
    back = (random.random((n, 1)) < 0.4) & (length > 2.4)
    angle = np.where(back, uniform(random, 2.7, 3.3, n), uniform(random, 1.1, 1.75, n))
    angle = angle * min(1.0, length / 1.8)
    lasting = np.minimum(1.5 * angle, 0.85 * length)
    middle = 0.05 * length + lasting / 2 + random.random((n, 1)) * (0.9 * length - lasting).clip(0)
    turning = ramp(frames, middle, lasting)
    effort = 0.5 * (4 * turning * (1 - turning)) ** 0.7
    gait = walking_gait(random, np.full(n, 0.7), bones)
    gait.cadence = random.normal(2.1, 0.12, n)
    gait.width, gait.pitch = random.uniform(0.18, 0.24, n), gait.pitch * 0.4
    zero = np.zeros_like(turning)
    gait.surge, gait.crouch = np.zeros(n), gait.crouch + 0.02
    drift = wander(random, n, turning.shape[1], 0.02, 0.3)
    pose = walk_over(gait, path_of(zero, zero, side * angle * turning + drift, effort), bones)
    loosen(random, pose)
    soon = (turning * (1 - turning))[:, MARGIN + 3 : MARGIN + 3 + frames]
    pose.look = pose.look + 1.5 * side * soon
    return pose, {"side": side[:, 0], "angle": angle[:, 0]}
