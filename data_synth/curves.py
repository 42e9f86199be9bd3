"""Smooth functions of time that actions are made of; all arrays are ``(n, frames)``."""

from __future__ import annotations

from typing import NamedTuple

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


def bump(s: NDArray, rise: float, up: float, down: float, fall: float) -> NDArray:
    """From 0 to 1 between `rise` and `up`, and back to 0 between `down` and `fall`."""
    return ease((s - rise) / (up - rise)) * (1 - ease((s - down) / (fall - down)))


def knots(*columns: NDArray) -> NDArray:
    """Put ``(n, 1)`` columns side by side, as `hermite` takes them."""
    return np.concatenate(np.broadcast_arrays(*columns), axis=1)


class Acts(NamedTuple):
    """One thing done once or several times in a clip.

    Attributes:
        phase: ``(n, frames)`` 0 before each time, 1 after it.
        done: ``(n, frames)`` how many times were finished before.
        times: ``(n, 1)`` how often it is done.
        strength: ``(n, 1)`` 1, or less where the clip is too short to do it in full.
        envelope: ``(n, frames)`` 1 from the first time to the last, rising before, falling after.
    """

    phase: NDArray
    done: NDArray
    times: NDArray
    strength: NDArray
    envelope: NDArray


def acts(
    random: np.random.Generator,
    n: int,
    frames: int,
    lasting: tuple[float, float],
    most: int = 3,
    margin: float = 0.08,
) -> Acts:
    """Draw when an act is done, so that it fits into the clip whatever its length.

    Args:
        random: where timing is drawn from.
        n: clips.
        frames: of the clip.
        lasting: shortest and longest time that one act takes, seconds.
        most: how often it may be done.
        margin: share of the clip that stays free for preparing and recovering.
    """
    length = frames / FPS
    room = length * (1 - margin)
    each = uniform(random, *lasting, n)
    fit = np.floor(room / each).clip(1, most)
    times = 1 + np.floor(random.random((n, 1)) * fit)
    wanted = each
    each = np.minimum(each, room / times)
    begin = 0.5 * margin * length + random.random((n, 1)) * (room - each * times)
    t = seconds(frames)
    since = ((t - begin) / each).clip(0, times)
    done = np.floor(since).clip(0, times - 1)
    lead = np.minimum(0.5, 0.25 * length)
    end = begin + each * times
    envelope = ease((t - begin + 0.5 * lead) / lead) * ease((end + 0.5 * lead - t) / lead)
    return Acts(since - done, done, times, (each / wanted) ** 0.7, envelope)


def through(s: NDArray, points: list[tuple[float, tuple[float, float, float]]]) -> NDArray:
    """A smooth path ``(n, frames, 3)`` through points at given phases, at rest at both ends.

    Args:
        s: ``(n, frames)`` phase.
        points: phase, and what the three coordinates are there.
    """
    where = np.array([phase for phase, _ in points])
    value = np.array([point for _, point in points])
    slope = np.zeros_like(value)
    slope[1:-1] = (value[2:] - value[:-2]) / (where[2:] - where[:-2])[:, None]
    k = np.searchsorted(where, s, side="right").clip(1, len(where) - 1) - 1
    width = (where[k + 1] - where[k])[..., None]
    u = ((s - where[k])[..., None] / width).clip(0, 1)
    return (
        (1 + 2 * u) * (1 - u) ** 2 * value[k] + u * (1 - u) ** 2 * slope[k] * width
        + u**2 * (3 - 2 * u) * value[k + 1] + u**2 * (u - 1) * slope[k + 1] * width
    )  # fmt: skip


def hold(
    random: np.random.Generator, n: int, frames: int, rise: tuple[float, float]
) -> tuple[NDArray, NDArray]:
    """An envelope that rises from 0 to 1, stays, and falls back; and when it has risen.

    It fits into the clip whatever its length.

    Args:
        random: where timing is drawn from.
        n: clips.
        frames: of the clip.
        rise: shortest and longest time to rise, seconds; as little as 0.6 of it in a short clip.
    """
    length = frames / FPS
    scale = min(1.0, max(0.6, length / 3.0))
    begin = uniform(random, 0.02, 0.12, n) * length
    up = begin + uniform(random, *rise, n) * scale
    down = uniform(random, 0.62, 0.75, n) * length
    down = np.maximum(down, up + 0.1 * scale)
    end = np.minimum(down + uniform(random, *rise, n) * scale * 1.1, 0.99 * length + 0.3)
    knots = np.concatenate([begin, up, down, end], axis=1)
    values = np.tile([0.0, 1.0, 1.0, 0.0], (n, 1))
    return hermite(seconds(frames), knots, values), up
