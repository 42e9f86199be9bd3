"""A data card: how fast, how high and how smoothly bodies move, from joint positions alone.

The same function measures synthetic and recorded clips, so that the two can stand side by side.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from data_synth.body import joint
from projflow_lite.skeleton import EDGES, FPS, JOINTS

Distribution = dict[str, float]
"""Median, 10th and 90th percentile over clips: the keys are ``median``, ``p10``, ``p90``."""

BANDS = ((0.0, 1.0), (1.0, 2.0), (2.0, 4.0), (4.0, 6.0), (6.0, 10.0))
"""Bands of the spectrum, Hz."""

UNITS = {
    "speed": "m/s",
    "cadence": "steps/s",
    "stride": "m",
    "bob": "m",
    "sway": "m",
    "wrist_swing": "m",
    "ankle_lift": "m",
    "step_width": "m",
    "arm_leg_correlation": "",
    "pelvis_height": "m",
}
"""What is measured of every clip that steps; NaN where a clip has fewer than three steps."""


def statistics(positions: ArrayLike | Sequence[ArrayLike]) -> dict[str, Any]:
    """Measure a set of clips.

    Args:
        positions: ``(n, frames, 22, 3)`` metres, y up, 20 frames a second, at least 10 frames; or
            a list of clips ``(frames, 22, 3)`` of different lengths.

    Returns:
        For each name of `UNITS` a `Distribution` over clips; ``acceleration_mean``,
        ``acceleration_p95`` (m/s²), ``jerk_mean`` and ``jerk_p95`` (m/s³) over all joints and
        frames; ``spectrum``, the share of root-relative movement in each band; ``bones``, the
        median length of every bone, metres.

    Raises:
        ValueError: for another shape, or values that are not finite.
    """
    clips = as_clips(positions)
    gait = {name: spread(values) for name, values in gait_of(clips).items()}
    acceleration, jerk = (
        np.concatenate([size_of_difference(x[None], order).ravel() for x in clips])
        for order in (2, 3)
    )
    return {
        "clips": len(clips),
        **gait,
        "acceleration_mean": float(acceleration.mean()),
        "acceleration_p95": float(np.percentile(acceleration, 95)),
        "jerk_mean": float(jerk.mean()),
        "jerk_p95": float(np.percentile(jerk, 95)),
        "spectrum": spectrum(clips),
        "bones": bones_of(clips),
    }


def as_clips(positions: ArrayLike | Sequence[ArrayLike]) -> list[NDArray]:
    """Single clips of any lengths, each checked by `refuse_bad_shapes`."""
    if isinstance(positions, list | tuple) and len({np.shape(clip) for clip in positions}) > 1:
        return [refuse_bad_shapes([clip])[0] for clip in positions]
    return list(refuse_bad_shapes(np.asarray(positions, dtype=float)))


def refuse_bad_shapes(positions: ArrayLike) -> NDArray:
    """The clips as float64, or one line on what is wrong with them."""
    x = np.asarray(positions, dtype=float)
    if x.ndim != 4 or x.shape[2:] != (len(JOINTS), 3) or x.shape[0] < 1 or x.shape[1] < 10:
        raise ValueError(
            "statistics: positions has shape (clips, at least 10 frames, 22, 3), "
            f"not {np.shape(positions)}"
        )
    if not np.isfinite(x).all():
        raise ValueError("statistics: positions holds values that are not finite")
    return x


def spread(values: NDArray) -> Distribution:
    """Median and the 10th and 90th percentile of the finite values; NaN if there are none."""
    values = values[np.isfinite(values)]
    if len(values) == 0:
        return {"median": np.nan, "p10": np.nan, "p90": np.nan}
    p10, median, p90 = np.percentile(values, [10, 50, 90])
    return {"median": float(median), "p10": float(p10), "p90": float(p90)}


def size_of_difference(x: NDArray, order: int) -> NDArray:
    """Length of the `order`-th derivative of every joint in time, by differences."""
    return np.linalg.norm(np.diff(x, order, axis=1), axis=-1) * FPS**order


def spectrum(clips: Sequence[NDArray]) -> dict[str, float]:
    """Share of the root-relative movement (the mean pose taken off) in each band of `BANDS`."""
    names = [f"{low:g}-{high:g} Hz" for low, high in BANDS]
    shares = np.zeros(len(BANDS))
    for clip in clips:
        frequency, power = power_of(clip)
        band = np.digitize(frequency[1:], [low for low, _ in BANDS]) - 1
        np.add.at(shares, band, power[1:])
    return dict(zip(names, (shares / max(shares.sum(), 1e-30)).tolist(), strict=True))


def power_of(clip: NDArray) -> tuple[NDArray, NDArray]:
    """Frequencies, Hz, and how much root-relative movement of one clip there is in each."""
    relative = clip - clip[:, :1]
    relative = relative - relative.mean(axis=0)
    power = (np.abs(np.fft.rfft(relative, axis=0)) ** 2).sum(axis=(1, 2)) / len(clip)
    return np.fft.rfftfreq(len(clip), 1 / FPS), power


def bones_of(clips: Sequence[NDArray]) -> dict[str, float]:
    """Median length of every bone, metres, by the name of the joint it ends in."""
    x = np.concatenate(clips)
    return {
        JOINTS[child]: float(np.median(np.linalg.norm(x[:, child] - x[:, parent], axis=-1)))
        for parent, child in EDGES
    }


def gait_of(clips: Sequence[NDArray] | NDArray) -> dict[str, NDArray]:
    """The measures of `UNITS`, ``(n,)`` each."""
    rows = [gait_of_one(clip) for clip in clips]
    return {name: np.array([row[name] for row in rows]) for name in UNITS}


def gait_of_one(x: NDArray) -> dict[str, float]:
    """Measure how one clip ``(frames, 22, 3)`` steps.

    A step begins where one ankle passes the other; a stride is two steps.
    """
    ahead, left = body_axes(x)
    about = x - x[:, :1]
    along, across = (about * ahead[:, None]).sum(-1), (about * left[:, None]).sum(-1)
    ankles = [joint("left_ankle"), joint("right_ankle")]
    wrists = [joint("left_wrist"), joint("right_wrist")]
    apart = along[:, ankles[0]] - along[:, ankles[1]]
    passing = crossings(apart)
    pelvis = x[:, 0]
    half = min(FPS // 2, len(x) - 1)
    travel = np.linalg.norm((pelvis[half:] - pelvis[:-half])[:, [0, 2]], axis=-1)
    out = dict.fromkeys(UNITS, np.nan)
    out["speed"] = float(travel.mean()) * FPS / half
    out["pelvis_height"] = float(np.median(pelvis[:, 1]))
    out["ankle_lift"] = float(np.ptp(x[:, ankles, 1], axis=0).mean())
    if len(passing) < 3:
        return out
    step, stride = windows(passing, 1), windows(passing, 2)
    sideways = (pelvis * left.mean(0)).sum(-1)
    out["cadence"] = (len(passing) - 1) * FPS / (passing[-1] - passing[0])
    out["stride"] = 2 * out["speed"] / out["cadence"]
    out["bob"] = float(np.median([np.ptp(straightened(pelvis[w, 1])) for w in step]))
    out["sway"] = float(np.median([np.ptp(straightened(sideways[w])) for w in stride]))
    out["wrist_swing"] = float(np.median([np.ptp(along[w][:, wrists], axis=0) for w in stride]))
    out["step_width"] = float(np.median([step_width(apart, across[:, ankles], w) for w in step]))
    out["arm_leg_correlation"] = float(np.corrcoef(along[:, wrists[0]], along[:, ankles[1]])[0, 1])
    return out


def body_axes(x: NDArray) -> tuple[NDArray, NDArray]:
    """Unit vectors ahead and to the left of the pelvis, ``(frames, 3)``, smoothed over 0.6 s."""
    left = x[:, joint("left_hip")] - x[:, joint("right_hip")]
    left[:, 1] = 0
    left = left / np.linalg.norm(left, axis=-1, keepdims=True).clip(1e-9)
    width = min(12, len(x))
    padded = np.pad(left, ((width // 2, width - 1 - width // 2), (0, 0)), mode="edge")
    left = np.lib.stride_tricks.sliding_window_view(padded, width, axis=0).mean(-1)
    left = left / np.linalg.norm(left, axis=-1, keepdims=True).clip(1e-9)
    return np.stack([-left[:, 2], 0 * left[:, 0], left[:, 0]], axis=-1), left


def crossings(apart: NDArray) -> NDArray:
    """Fractional frames at which one foot passes the other.

    Two passings make a step only if the feet come 5 cm apart in between: the rest is shuffling.
    """
    places = np.flatnonzero(np.diff(np.signbit(apart)))
    exact = places + apart[places] / (apart[places] - apart[places + 1])
    is_step = [
        np.abs(apart[before + 1 : after + 1]).max() > 0.05 for before, after in pairwise(places)
    ]
    ends = [k for k, step in enumerate(is_step) if step]
    return exact[sorted({*ends, *(k + 1 for k in ends)})]


def windows(passing: NDArray, steps: int) -> list[slice]:
    """Frames of every run of `steps` steps."""
    edges = np.round(passing).astype(int)
    return [
        slice(a, b + 1) for a, b in zip(edges[:-steps], edges[steps:], strict=True) if b - a >= 2
    ]


def straightened(values: NDArray) -> NDArray:
    """A curve less the straight line between its ends."""
    return values - np.linspace(values[0], values[-1], len(values))


def step_width(apart: NDArray, across: NDArray, window: slice) -> float:
    """Sideways distance of the ankles where the feet are furthest apart in a step, metres."""
    widest = window.start + int(np.abs(apart[window]).argmax())
    return float(abs(across[widest, 0] - across[widest, 1]))


def table(columns: Mapping[str, Mapping[str, Any]]) -> str:
    """Set statistics side by side.

    Args:
        columns: what `statistics` returned, by the name to print over each column.

    Returns:
        A table in Markdown; medians with ``[p10..p90]``.
    """
    rows = [["", *columns], ["---"] * (len(columns) + 1)]
    for name, unit in UNITS.items():
        label = name.replace("_", " ") + (f", {unit}" if unit else "")
        rows.append([label, *(spelled(c[name]) for c in columns.values())])
    for name, unit in (("acceleration", "m/s²"), ("jerk", "m/s³")):
        cells = [f"{c[name + '_mean']:.1f}, {c[name + '_p95']:.1f}" for c in columns.values()]
        rows.append([f"{name} mean, p95, {unit}", *cells])
    for band in next(iter(columns.values()))["spectrum"]:
        rows.append([band, *(f"{100 * c['spectrum'][band]:.1f} %" for c in columns.values())])
    for bone in (JOINTS[child] for _, child in EDGES):
        if not bone.startswith("right"):
            rows.append(
                [f"bone to {bone}, m", *(f"{c['bones'][bone]:.3f}" for c in columns.values())]
            )
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def spelled(values: Distribution) -> str:
    """A distribution as ``median [p10..p90]``."""
    if not np.isfinite(values["median"]):
        return "-"
    return f"{values['median']:.3g} [{values['p10']:.3g}..{values['p90']:.3g}]"
