"""Observed coordinates and guides side by side, derived again: ProjFlow eq. 12 and 13."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from projflow_lite import equations as eq

from .problems import gap, largest
from .registry import derives


@derives(12, "coordinate by coordinate; nothing and everything observed", 0)
def kept_or_zero(random: np.random.Generator) -> float:
    """A mask keeps or drops, it never computes: not even rounding may be different."""
    x = random.normal(size=(3, 4, 3))
    some = random.integers(0, 2, x.shape).astype(bool)
    deviations = []
    for observed in (some, np.zeros_like(some), np.ones_like(some)):
        kept = np.zeros(x.size)
        for n, j, c in np.ndindex(x.shape):
            if observed[n, j, c]:
                kept[(n * 4 + j) * 3 + c] = x[n, j, c]
        mask = eq.observation_mask(observed)
        deviations.append(gap(eq.masked_observation(eq.vectorise(x), mask), kept))
    return largest(deviations)


@derives(12, "against a list of what is observed; wishes about one axis", 0)
def picked_in_order(random: np.random.Generator) -> float:
    """Selected rows see the same values as the mask, in the same order, without its zeros."""
    x = random.normal(size=(3, 2, 3))
    some, height = random.integers(0, 2, (2, *x.shape)).astype(bool)
    height[..., [0, 2]] = False
    deviations = []
    for observed in (some, height, np.zeros_like(some)):
        picked = [x[place] for place in np.ndindex(x.shape) if observed[place]]
        mask = eq.observation_mask(observed)
        zeros_left = eq.masked_observation(eq.vectorise(x), mask)[observed.ravel()]
        rows = eq.selection_rows(observed)
        deviations += [gap(rows @ eq.vectorise(x), picked), gap(zeros_left, picked)]
    return largest(deviations)


@derives(13, "coordinate by coordinate: a keyframe, a guide or neither", 0)
def keyframe_guide_or_neither(random: np.random.Generator) -> float:
    """Keyframes and guides share no coordinate, so adding the masks only puts them together."""
    kinds = ["keyframe", "guide", "neither"]
    deviations = []
    for kind in (random.choice(kinds, 12), *(np.full(4, kind) for kind in kinds)):
        keys, guides = random.normal(size=(2, len(kind)))
        M_obs, M_aug = np.diag(kind == "keyframe") * 1.0, np.diag(kind == "guide") * 1.0
        told = {"keyframe": keys, "guide": guides, "neither": np.zeros(len(kind))}
        values = [told[kind_i][i] for i, kind_i in enumerate(kind)]
        active = np.zeros((len(kind), len(kind)))
        for i, kind_i in enumerate(kind):
            active[i, i] = kind_i != "neither"
        M, y = eq.combined_observation(M_obs, M_aug, M_obs @ keys, guides)
        deviations += [gap(M, active), gap(y, values)]
    return largest(deviations)


@derives(13, "guides around two keyframes, weighed by distance in fractions", 1e-14)
def guides_by_hand(random: np.random.Generator) -> float:
    """Between keyframes each counts by how near it is; before and after, the nearest is copied.

    Frames farther than the radius from both stay free.
    """
    frames, first, last, radius = 16, 4, 10, 3
    y = np.zeros((frames, 1, 3))
    y[[first, last]] = random.normal(size=(2, 1, 3))
    seen = np.zeros(y.shape, dtype=bool)
    seen[[first, last]] = True
    expected = np.zeros_like(y)
    for n in range(frames):
        if min(abs(n - first), abs(n - last)) < radius:
            share = Fraction(min(max(n, first), last) - first, last - first)
            for c in range(3):
                a, b = Fraction(y[first, 0, c]), Fraction(y[last, 0, c])
                expected[n, 0, c] = float((1 - share) * a + share * b)
    y_src, _ = eq.interpolate_observations(y, seen)
    M_obs, M_aug = eq.observation_mask(seen), eq.observation_mask(eq.halo(seen, radius))
    _, ours = eq.combined_observation(M_obs, M_aug, y.ravel(), y_src.ravel())
    return gap(ours, expected.ravel())
