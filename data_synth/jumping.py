"""The jump: crouch, take off, fly under gravity, land, recover."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from data_synth.body import Made, Pose
from data_synth.curves import ease, hermite, knots, seconds, uniform
from data_synth.standing import settle, stand, swing_arm
from projflow_lite.skeleton import FPS

GRAVITY = 9.81


class Jump(NamedTuple):
    """When things happen in a jump, seconds, how high and how far it goes, metres; ``(n, 1)``."""

    begin: NDArray
    lowest: NDArray
    off: NDArray
    land: NDArray
    absorbed: NDArray
    height: NDArray
    ahead: NDArray

    @property
    def speed(self) -> NDArray:
        """Upward speed at take-off, m/s."""
        return np.sqrt(2 * GRAVITY * self.height)


def plan(random: np.random.Generator, n: int, frames: int) -> Jump:
    """Draw jumps that fit into the clip; short clips have low and quick ones."""
    scale = min(1.0, frames / FPS / 2.2)
    height = uniform(random, 0.12, 0.42, n) * scale
    ahead = uniform(random, 0.3, 1.0, n) * scale * (random.random((n, 1)) < 0.5)
    air = 2 * np.sqrt(2 * height / GRAVITY)
    crouch = uniform(random, 0.38, 0.60, n) * scale
    push = uniform(random, 0.24, 0.30, n)
    absorb = uniform(random, 0.22, 0.3, n)
    total = crouch + push + air + absorb + 0.5 * scale
    begin = uniform(random, 0.02, 0.95, n) * np.maximum(frames / FPS - total, 0.0)
    off = begin + crouch + push
    return Jump(begin, begin + crouch, off, off + air, off + air + absorb, height, ahead)


def pelvis_height(
    random: np.random.Generator, plan: Jump, start: NDArray, frames: int
) -> tuple[NDArray, NDArray]:
    """Height of the pelvis over time, and how much of it the feet share in the air.

    Both are ``(n, frames)`` metres.
    """
    n, t, zero = len(start), seconds(frames), np.zeros_like(start)
    low = start - uniform(random, 0.20, 0.34, n) * (0.6 + plan.height)
    top = start + 0.02  # legs straight, heels up
    up_again = plan.absorbed + uniform(random, 0.5, 0.8, n) * min(1.0, frames / FPS / 2.2)
    y = hermite(
        t,
        knots(plan.begin, plan.lowest, plan.off, plan.land, plan.absorbed, up_again),
        knots(start, low, top, top, start - 0.55 * (start - low), start),
        knots(zero, zero, plan.speed, -plan.speed, zero, zero),
    )
    flying = (t >= plan.off) & (t < plan.land)
    since = np.where(flying, t - plan.off, 0)
    flight = plan.speed * since - 0.5 * GRAVITY * since**2
    return np.where(flying, top + flight, y), flight


def jump(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Jump in place or ahead."""
    pose, t = stand(random, n, frames, bones), seconds(frames)
    when = plan(random, n, frames)
    start, zero = pose.pelvis[:, :1, 1].copy(), np.zeros((n, 1))
    y, flight = pelvis_height(random, when, start, frames)
    pose.pelvis[..., 1] = y
    air = when.land - when.off
    # Before take-off and after landing the body is carried over the feet; in the air it coasts.
    pose.pelvis[..., 2] += hermite(
        t,
        knots(when.lowest, when.off, when.land, when.absorbed + 0.2),
        knots(zero, 0.16 * when.ahead, 0.84 * when.ahead, when.ahead),
        knots(zero, 0.68 * when.ahead / air, 0.68 * when.ahead / air, zero),
    )
    share = ((t - when.off) / air).clip(0, 1)
    tuck = uniform(random, 0.02, 0.10, n) * np.sin(np.pi * share) ** 2
    pose.toe[..., 2] += (when.ahead * ease(share))[..., None]
    pose.toe[..., 1] += (flight + tuck)[..., None]
    heels = hermite(
        t,
        knots(when.off - 0.16, when.off, when.off + 0.5 * air, when.land, when.land + 0.12),
        knots(zero, zero + 0.85, zero + 0.85, zero + 0.6, zero),
    )
    pose.foot_pitch += heels[..., None]
    bow(pose, ((start - y) / 0.3).clip(0, 1.2))
    swing_arms(random, pose, when, t)
    return settle(pose, bones), {"height": when.height[:, 0], "ahead": when.ahead[:, 0]}


def bow(pose: Pose, depth: NDArray) -> None:
    """Bend the trunk over the knees in a crouch; `depth` is ``(n, frames)``, 0 when upright."""
    pose.pitch, pose.bend = pose.pitch + 0.5 * depth, pose.bend + 0.35 * depth
    pose.pelvis[..., 2] -= 0.10 * depth
    pose.nod = pose.nod - 0.5 * depth


def swing_arms(random: np.random.Generator, pose: Pose, when: Jump, t: NDArray) -> None:
    """Arms go back in the crouch, up in the take-off, and come down after landing."""
    zero = np.zeros_like(when.begin)
    up = uniform(random, 0.7, 1.5, len(zero))
    angle = hermite(
        t,
        knots(when.begin, when.lowest, when.off + 0.12, when.land, when.absorbed + 0.35),
        knots(zero, zero - 0.7, up, 0.6 * up, zero),
    )
    for side in (1.0, -1.0):
        swing_arm(pose, side, angle)
