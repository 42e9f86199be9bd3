"""The sampled half of the posterior study: three modes in the plane."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist
from tqdm.auto import tqdm

from projflow_lite.scores import interval
from projflow_lite.studies import posterior_worlds as worlds
from projflow_lite.studies.posterior_exact import plain
from projflow_lite.studies.posterior_worlds import CHOICES, World


def energy_distance(a: NDArray, b: NDArray) -> float:
    """Energy distance of two sets of samples ``(n, d)`` and ``(m, d)``; in units of x."""
    squared = 2 * cdist(a, b).mean() - cdist(a, a).mean() - cdist(b, b).mean()
    return float(np.sqrt(max(squared, 0)))


def compare(world: World, x: NDArray, seed: int) -> dict[str, Any]:
    """Hold samples against as many exact ones, and their modes against the exact weights."""
    shares, weights = worlds.shares_of_modes(world, x), world.posterior[0]
    exact = worlds.exact_samples(world, len(x), seed + 1000)
    return {
        "energy distance": energy_distance(x, exact),
        "weight misplaced": float(np.abs(shares - weights).sum() / 2),
        "weights": shares,
    }


def repeat(make: Callable[[int], NDArray], world: World, seeds: int) -> dict[str, Any]:
    """Mean of each score over seeds, and half the width of its 95 % interval."""
    columns = [compare(world, make(seed), seed) for seed in range(seeds)]
    scores: dict[str, Any] = {}
    for name in ("energy distance", "weight misplaced"):
        mean, half = interval([column[name] for column in columns])
        scores[name] = {"mean": plain(mean), "half width": plain(half)}
    weights = np.mean([column["weights"] for column in columns], axis=0)
    return scores | {"weights": [plain(w) for w in weights]}


def mixture_rows(steps: int, count: int, seeds: int, progress: bool = True) -> list[dict[str, Any]]:
    """Every choice on the mixture, below exact samples and the exact flow of the posterior."""
    world = worlds.three_modes()
    base = {"world": "three modes", "wish": "hard", "steps": steps}
    exact = {
        "exact samples": partial(worlds.exact_samples, world, count),
        "exact flow": partial(worlds.exact_flow, world, steps, count),
    }
    rows = [
        base | {"method": name, "scores": repeat(make, world, seeds)}
        for name, make in exact.items()
    ]
    grid = list(itertools.product(("euclid", "data", "moving"), CHOICES))
    for metric, (noise, eta) in tqdm(grid, unit="row", disable=not progress, desc="three modes"):
        choice = (metric, noise, eta)
        make = partial(worlds.sample_ends, world, *choice, steps, count)
        row = base | {"method": "projection", "metric": metric, "noise": noise, "eta": eta}
        rows.append(row | {"scores": repeat(make, world, seeds)})
    return rows
