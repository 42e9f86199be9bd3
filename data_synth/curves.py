"""Smooth functions of time that actions are made of; all arrays are ``(n, frames)``."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from projflow_lite.skeleton import FPS


def uniform(random: np.random.Generator, low: float, high: float, n: int) -> NDArray:
    """`n` numbers between two bounds, ``(n, 1)``, ready to multiply a curve."""
    return random.uniform(low, high, (n, 1))


def coin(random: np.random.Generator, n: int) -> NDArray:
    """`n` signs, +1 or -1, ``(n, 1)``: left or right."""
    return random.choice([-1.0, 1.0], (n, 1))


def seconds(frames: int) -> NDArray:
    """Time of every frame, ``(1, frames)``."""
    return np.arange(frames)[None] / FPS


def ease(s: NDArray) -> NDArray:
    """From 0 to 1 with zero velocity and acceleration at both ends."""
    s = s.clip(0, 1)
    return s**3 * (10 - 15 * s + 6 * s**2)


def hermite(t: NDArray, when: NDArray, value: NDArray, slope: NDArray | None = None) -> NDArray:
    """Piecewise cubic through knots, constant before the first and after the last.

    Args:
        t: ``(1, frames)`` seconds.
        when: ``(n, knots)`` rising times of the knots.
        value: ``(n, knots)``.
        slope: ``(n, knots)`` a second; by default 0, so that every knot is a rest.
    """
    slope = np.zeros_like(value) if slope is None else slope
    out = np.broadcast_to(value[:, :1], (len(value), t.shape[1])).copy()
    for k in range(when.shape[1] - 1):
        width = np.maximum(when[:, k + 1] - when[:, k], 1e-9)[:, None]
        s = ((t - when[:, k, None]) / width).clip(0, 1)
        v0, v1 = value[:, k, None], value[:, k + 1, None]
        d0, d1 = slope[:, k, None] * width, slope[:, k + 1, None] * width
        cubic = (
            (1 + 2 * s) * (1 - s) ** 2 * v0 + s * (1 - s) ** 2 * d0
            + s**2 * (3 - 2 * s) * v1 + s**2 * (s - 1) * d1
        )  # fmt: skip
        out = np.where(t >= when[:, k, None], cubic, out)
    return out


def wander(
    random: np.random.Generator, n: int, frames: int, size: float, fastest: float = 0.7
) -> NDArray:
    """Slow irregular drift of standard deviation `size`: nobody stands still."""
    t = seconds(frames)
    total = np.zeros((n, frames))
    for _ in range(4):
        frequency = uniform(random, 0.1, fastest, n)
        total += np.sin(2 * np.pi * (frequency * t + uniform(random, 0, 1, n)))
    return size * total / np.sqrt(2)


def hold(
    random: np.random.Generator, n: int, frames: int, rise: tuple[float, float]
) -> tuple[NDArray, NDArray]:
    """An envelope that rises from 0 to 1, stays, and falls back; and when it has risen.

    It fits into the clip whatever its length.

    Args:
        random: where timing is drawn from.
        n: clips.
        frames: of the clip.
        rise: shortest and longest time to rise, seconds, for a clip of three seconds or more.
    """
    length = frames / FPS
    scale = min(1.0, length / 3.0)
    begin = uniform(random, 0.02, 0.12, n) * length
    up = begin + uniform(random, *rise, n) * scale
    down = uniform(random, 0.62, 0.75, n) * length
    down = np.maximum(down, up + 0.1 * scale)
    end = np.minimum(down + uniform(random, *rise, n) * scale * 1.1, 0.99 * length + 0.3)
    knots = np.concatenate([begin, up, down, end], axis=1)
    values = np.tile([0.0, 1.0, 1.0, 0.0], (n, 1))
    return hermite(seconds(frames), knots, values), up
