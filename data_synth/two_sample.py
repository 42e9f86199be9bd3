"""A two-sample test: can a simple classifier tell two sets of clips apart, and by what?

If it cannot do better than tossing a coin, the sets look alike in everything it is shown. That is
all it says: what it is not shown may still differ.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize

from data_synth.body import joint
from data_synth.card import UNITS, body_axes, gait_of, refuse_bad_shapes, size_of_difference

FOLDS = 5
GROUPS = {
    "pelvis": ("pelvis",),
    "head": ("head",),
    "wrists": ("left_wrist", "right_wrist"),
    "elbows": ("left_elbow", "right_elbow"),
    "knees": ("left_knee", "right_knee"),
    "feet": ("left_foot", "right_foot"),
}
"""Joints whose speed, acceleration and jerk are looked at together."""

ANGLES = {
    "knee": ("hip", "knee", "ankle"),
    "ankle": ("knee", "ankle", "foot"),
    "elbow": ("shoulder", "elbow", "wrist"),
    "upper arm": ("collar", "shoulder", "elbow"),
}
"""Three joints of each side whose middle one bends."""


KINDS = {
    "gait": tuple(name.replace("_", " ") for name in UNITS),
    "joint angles": ("bend of", "lean of"),
    "speeds": ("speed of",),
    "accelerations": ("acceleration of",),
    "jerks": ("jerk of",),
}
"""What the names of the features of each kind begin with."""


def two_sample_test(
    a: ArrayLike, b: ArrayLike, seed: int = 0, kinds: Sequence[str] = tuple(KINDS)
) -> dict[str, Any]:
    """Train a classifier to tell two sets of clips apart, and test it on clips it has not seen.

    Windows cut from one recording are alike: several of them in one set make it easier to tell.

    Args:
        a: ``(n, frames, 22, 3)`` metres, at least 10 clips.
        b: ``(m, frames, 22, 3)``, the same number of frames.
        seed: decides which clips are tested together.
        kinds: names of `KINDS`: what the classifier is shown; by default everything.

    Returns:
        ``accuracy``, the mean over both sets of the share of clips that were told rightly when
        they were left out (0.5 is chance); ``interval``, its 95 % interval; ``features``, a list of
        ``(name, difference)``, the largest first: how far the mean of `b` lies above that of `a`,
        in standard deviations.

    Raises:
        ValueError: for other shapes, values that are not finite, or too few clips.
    """
    first, second = refuse_bad_shapes(a), refuse_bad_shapes(b)
    if first.shape[1] != second.shape[1]:
        raise ValueError(
            f"two_sample_test: clips of {first.shape[1]} and of {second.shape[1]} frames; "
            "cut both to one length"
        )
    if min(len(first), len(second)) < 2 * FOLDS:
        raise ValueError(f"two_sample_test: needs at least {2 * FOLDS} clips of each set")
    one, other = features_of(first), features_of(second)
    names = [name for name in one if kind_of(name) in kinds]
    if not names:
        raise ValueError(f"two_sample_test: kinds are {', '.join(KINDS)}, not {kinds!r}")
    x = np.concatenate([np.stack([s[k] for k in names], axis=1) for s in (one, other)])
    y = np.repeat([0.0, 1.0], [len(first), len(second)])
    told = cross_validated(x, y, np.random.default_rng(seed))
    accuracy, interval = balanced_accuracy(told == y, y)
    x = filled_and_scaled(x, x)
    apart = x[y == 1].mean(0) - x[y == 0].mean(0)
    within = np.sqrt(0.5 * (x[y == 1].var(0) + x[y == 0].var(0))).clip(1e-9)
    ranking = sorted(zip(names, apart / within, strict=True), key=lambda row: -abs(row[1]))
    return {
        "accuracy": accuracy,
        "interval": interval,
        "features": [(name, float(difference)) for name, difference in ranking],
    }


def kind_of(name: str) -> str:
    """The kind of a feature."""
    # The last kind is asked first: "speed" is gait, and "speed of wrists" is not.
    return next(kind for kind in reversed(KINDS) if name.startswith(KINDS[kind]))


def features_of(x: NDArray) -> dict[str, NDArray]:
    """What the classifier is shown of each clip, ``(n,)`` each; NaN where there is no gait."""
    features = {name.replace("_", " "): values for name, values in gait_of(x).items()}
    about = x.copy()
    about[:, :, 1:] -= x[:, :, :1]
    for order, what in ((1, "speed"), (2, "acceleration"), (3, "jerk")):
        size = size_of_difference(about, order)
        for name, joints in GROUPS.items():
            chosen = size[:, :, [joint(j) for j in joints]].reshape(len(x), -1)
            features[f"{what} of {name}, log mean"] = np.log(chosen.mean(1) + 1e-3)
            peak = np.percentile(chosen, 95, axis=1)
            features[f"{what} of {name}, log peak over mean"] = np.log(
                (peak + 1e-3) / (chosen.mean(1) + 1e-3)
            )
    for name, joints in ANGLES.items():
        bend = np.concatenate([bend_of(x, [f"{s}_{j}" for j in joints]) for s in ("left", "right")])
        left, right = np.split(bend, 2)
        for what, measure in (("mean", np.mean), ("spread", np.std), ("most", np.max)):
            values = 0.5 * (measure(left, axis=1) + measure(right, axis=1))
            features[f"bend of {name}, {what}"] = values
    lean = np.stack([trunk_lean(clip) for clip in x])
    features["lean of trunk, mean"], features["lean of trunk, spread"] = lean.mean(1), lean.std(1)
    return features


def bend_of(x: NDArray, names: list[str]) -> NDArray:
    """How far a joint is from straight, radians, ``(n, frames)``."""
    before, at, after = (x[:, :, joint(name)] for name in names)
    one, other = at - before, after - at
    size = np.linalg.norm(one, axis=-1) * np.linalg.norm(other, axis=-1)
    return np.arccos(((one * other).sum(-1) / size.clip(1e-9)).clip(-1, 1))


def trunk_lean(x: NDArray) -> NDArray:
    """How far the neck is ahead of the pelvis, radians, ``(frames,)``."""
    ahead, _ = body_axes(x)
    trunk = x[:, joint("neck")] - x[:, 0]
    return np.arctan2((trunk * ahead).sum(-1), trunk[:, 1])


def filled_and_scaled(x: NDArray, by: NDArray) -> NDArray:
    """Put the median where a value is missing, and scale as the rows of `by` are spread."""
    known = np.isfinite(by).any(0)
    middle = np.zeros(by.shape[1])
    middle[known] = np.nanmedian(by[:, known], axis=0)
    fill = [np.where(np.isfinite(rows), rows, middle) for rows in (x, by)]
    return (fill[0] - fill[1].mean(0)) / (fill[1].std(0) + 1e-9)


def cross_validated(x: NDArray, y: NDArray, random: np.random.Generator) -> NDArray:
    """What a classifier says of each clip that was trained without it, 0 or 1."""
    fold = np.zeros(len(y), dtype=int)
    for label in (0, 1):
        members = np.flatnonzero(y == label)
        fold[random.permutation(members)] = np.arange(len(members)) % FOLDS
    told = np.zeros(len(y))
    for k in range(FOLDS):
        train, test = fold != k, fold == k
        weights = logistic_regression(filled_and_scaled(x[train], x[train]), y[train])
        told[test] = (filled_and_scaled(x[test], x[train]) @ weights[1:] + weights[0]) > 0
    return told


def logistic_regression(x: NDArray, y: NDArray, ridge: float = 0.05) -> NDArray:
    """Intercept and weights that tell 0 from 1, both sets counting alike.

    Args:
        x: ``(n, k)`` scaled features.
        y: ``(n,)`` 0 or 1.
        ridge: how much large weights cost.
    """
    share = np.where(y == 1, 0.5 / y.sum(), 0.5 / (len(y) - y.sum()))
    sign = 2 * y - 1

    def loss(w: NDArray) -> tuple[float, NDArray]:
        margin = sign * (x @ w[1:] + w[0])
        value = (share * np.logaddexp(0, -margin)).sum() + 0.5 * ridge * (w[1:] ** 2).sum()
        pull = -share * sign * np.exp(-np.logaddexp(0, margin))
        return float(value), np.concatenate([[pull.sum()], x.T @ pull + ridge * w[1:]])

    return minimize(loss, np.zeros(x.shape[1] + 1), jac=True, method="L-BFGS-B").x


def balanced_accuracy(right: NDArray, y: NDArray) -> tuple[float, tuple[float, float]]:
    """Mean of the two sets' accuracies, with a 95 % interval that holds near 0 and 1 too.

    Two rights and two wrongs are added to each set for the interval, as Agresti and Coull advise.
    """
    rates, centres, variances = [], [], []
    for label in (0, 1):
        told = right[y == label]
        rates.append(told.mean())
        p, n = (told.sum() + 2) / (len(told) + 4), len(told) + 4
        centres.append(p)
        variances.append(p * (1 - p) / n)
    half = 1.96 * 0.5 * float(np.sqrt(sum(variances)))
    middle = float(np.mean(centres))
    return float(np.mean(rates)), (max(0.0, middle - half), min(1.0, middle + half))
