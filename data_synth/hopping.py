"""Hopping on one leg: every flight is a parabola, every landing is taken up by the knee."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from data_synth.body import Made
from data_synth.curves import coin, ease, hermite, knots, seconds, uniform
from data_synth.jumping import GRAVITY
from data_synth.standing import settle, shift_weight, stand, swing_arm
from projflow_lite.skeleton import FPS

MOST = 3
"""Hops in a clip, at most."""


def hop(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Hop on one leg, on the spot or ahead, up to `MOST` times."""
    pose, side, t = stand(random, n, frames, bones), coin(random, n), seconds(frames)
    length = frames / FPS
    scale = min(1.0, length / 1.8)
    air, ground = uniform(random, 0.18, 0.28, n) * scale**0.5, uniform(random, 0.22, 0.28, n)
    before, after = 0.55 * scale, 0.55 * scale
    fit = np.floor((0.98 * length - before - after + ground) / (air + ground)).clip(1, MOST)
    times = 1 + np.floor(random.random((n, 1)) * fit)
    total = before + times * (air + ground) - ground + after
    begin = random.random((n, 1)) * (0.98 * length - total).clip(0)
    first = begin + before  # take-off of the first hop
    height, air_share = heights(t, first, air, ground, times, scale)
    ahead = uniform(random, 0.15, 0.40, n) * scale * (random.random((n, 1)) < 0.5)
    last = first + times * (air + ground) - ground  # last landing
    travelled = ahead * air_share
    pose.toe[..., 2] += travelled[..., None]
    going = smoothed_travel(t, first, last, air, ahead * times)
    pose.pelvis[..., 2] += going
    flight = np.maximum(height, 0) * ((air_share % 1.0) > 0)
    pose.toe[..., 1] += flight[..., None]
    pose.pelvis[..., 1] += height - 0.03
    up = ease((t - begin) / (0.75 * before)) * ease((last + 0.9 * after - t) / (0.75 * after))
    held, back = uniform(random, 0.16, 0.32, n), uniform(random, -0.32, 0.05, n)
    shift_weight(pose, side, ease(1.3 * up))
    heel_up = 0.5 * np.tanh(flight / 0.1)
    for s, sign in enumerate((1.0, -1.0)):
        free = np.where(side == sign, 0.0, up)
        pose.toe[:, :, s, 1] += held * free
        pose.toe[:, :, s, 2] += back * free**2
        pose.foot_pitch[:, :, s] += np.where(side == sign, heel_up, 0.8 * free)
        swing_arm(pose, sign, uniform(random, 0.2, 0.5, n) * up + 2.0 * height * up)
    pose.bend, pose.pitch = pose.bend + 0.10 * up, pose.pitch + 0.08 * up
    return settle(pose, bones), {"side": side[:, 0], "times": times[:, 0], "ahead": ahead[:, 0]}


def heights(
    t: NDArray, first: NDArray, air: NDArray, ground: NDArray, times: NDArray, scale: float
) -> tuple[NDArray, NDArray]:
    """Height of the body over standing, and how many hops have been flown; ``(n, frames)``.

    Args:
        t: ``(1, frames)`` seconds.
        first: ``(n, 1)`` when the first hop takes off.
        air: ``(n, 1)`` seconds in the air.
        ground: ``(n, 1)`` seconds on the floor between two hops.
        times: ``(n, 1)`` how many hops.
        scale: 1, or less where the clip is short.
    """
    speed = GRAVITY * air / 2
    zero = np.zeros_like(first)
    dip = speed * ground / np.pi
    when = [first - 0.45 * scale, first - 0.5 * ground]
    value, slope = [zero, -dip], [zero, zero]
    for k in range(MOST):
        counts = k < times
        takes_off = first + k * (air + ground)
        last = k == times - 1
        middle = takes_off + air + 0.5 * ground
        end = first + times * (air + ground) - ground + 0.5 * scale + 1e-6 * k
        when += [np.where(counts, takes_off, end), np.where(counts, takes_off + air, end)]
        when += [np.where(counts, middle, end)]
        value += [zero, zero, np.where(counts, -dip * np.where(last, 1.2, 1.0), zero)]
        slope += [np.where(counts, speed, zero), np.where(counts, -speed, zero), zero]
    when.append(first + times * (air + ground) - ground + 0.5 * scale + 1e-5)
    y = hermite(t, knots(*when), knots(*value, zero), knots(*slope, zero))
    flown = np.zeros_like(y)
    for k in range(MOST):
        since = ((t - first - k * (air + ground)) / air).clip(0, 1) * (k < times)
        flown += ease(since)
        flying = (since > 0) & (since < 1)
        y = np.where(flying, 0.5 * GRAVITY * air**2 * since * (1 - since), y)
    return y, flown


def smoothed_travel(
    t: NDArray, first: NDArray, last: NDArray, air: NDArray, distance: NDArray
) -> NDArray:
    """How far the body has come: it starts with the first hop and stops after the last one."""
    share = (t - first + 0.1) / (last - first + 0.2)
    return distance * ease(share)
