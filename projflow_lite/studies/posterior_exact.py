"""The exact half of the posterior study: Gaussian data, where nothing has to be sampled."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm.auto import tqdm

from projflow_lite import equations as eq
from projflow_lite.studies import posterior_worlds as worlds
from projflow_lite.studies.posterior_worlds import CHOICES, ETAS, METRICS, World

Map = tuple[NDArray, NDArray]
Rows = tuple[NDArray, NDArray, NDArray]


def free_directions(world: World) -> NDArray:
    """Orthonormal ``(d, f)``: where the posterior of one Gaussian has any spread."""
    size, axes = np.linalg.eigh(world.posterior[2][0])
    return axes[:, size > 1e-9 * size.max()]


def distances(world: World, mean: NDArray, covariance: NDArray) -> dict[str, float]:
    """How far a Gaussian is from the posterior of a world of one Gaussian.

    Returns:
        "mean error": root mean square over free directions, in posterior standard deviations.
        "spread": root of the ratio of the traces of the covariances; 1 is right.
        "spread along rows": the same for A x alone, NaN where that is exact.
        "W2": the 2-Wasserstein distance.
        "KL": of the sampler's law to the posterior, in the free directions, nats.
    """
    _, means, covariances = world.posterior
    N = free_directions(world)
    true = N.T @ covariances[0] @ N
    ours = N.T @ covariance @ N
    off = N.T @ (mean - means[0])
    relative = np.linalg.solve(true, ours)
    squared = float(off @ np.linalg.solve(true, off))
    along = np.trace(world.A @ covariances[0] @ world.A.T)
    rows = np.trace(world.A @ covariance @ world.A.T)
    size, axes = np.linalg.eigh(true)
    root = (axes * np.sqrt(size)) @ axes.T
    cross = np.sqrt(np.clip(np.linalg.eigvalsh(root @ ours @ root), 0, None)).sum()
    transport = off @ off + np.trace(true) + np.trace(ours) - 2 * cross
    log_det = np.linalg.slogdet(relative)[1]
    return {
        "mean error": float(np.sqrt(squared / len(off))),
        "spread": float(np.sqrt(np.trace(ours) / np.trace(true))),
        "spread along rows": float(np.sqrt(rows / along)) if along > 1e-12 else float("nan"),
        "W2": float(np.sqrt(max(transport, 0))),
        "KL": 0.5 * float(np.trace(relative) + squared - len(off) - log_det),
    }


def projection_of(world: World, metric: str, guides: bool = False) -> Callable[[float], Map]:
    """The projection at every time as an affine map, with or without guides between keyframes."""

    @cache  # every reading of the noise asks for the same times
    def at(t: float) -> Map:
        R_inverse = worlds.inverse_metric(world, metric, world.means[0], t)
        A, y, Sigma = with_guides(world, R_inverse, t) if guides else world[3:]
        return eq.projection_map(A, y, np.linalg.inv(R_inverse), Sigma)

    return at if metric == "moving" or guides else lambda t: at(0.0)


def with_guides(world: World, R_inverse: NDArray, t: float) -> Rows:
    """Keyframes of a path, and soft rows on straight lines between them, fading (eq. 13-18).

    Every frame is taken to bend like the median one: then the trust does not depend on the
    samples and the step stays affine. Constants are those of Table 5, but for an upper bound of
    the trust of 0.99, which keeps the guides soft.
    """
    table = eq.TABLE_5
    frames = np.arange(world.A.shape[1])
    keys = world.A.argmax(axis=1)
    y_src, _ = eq.interpolate_observations(world.A.T @ world.y, world.A.sum(axis=0) > 0)
    away = np.abs(frames[:, None] - keys).min(axis=1)
    active = (away > 0) & (away < eq.halo_radius(t, table["l_min"], table["l_max"]))
    bend, c0, lambda_s = np.ones(len(frames)), table["c0"], table["lambda_s"]
    trust = eq.frame_trust(bend, t, c0, lambda_s, table["p"], table["tau_min"])
    trust = eq.clip_trust(trust, table["pi_min"], 0.99)[active]
    variance = eq.variance_from_trust(trust, np.diag(R_inverse)[active])
    A = np.vstack([world.A, np.eye(len(frames))[active]])
    Sigma = np.diag(np.concatenate([np.zeros(len(keys)), variance]))
    return A, np.concatenate([world.y, y_src[active]]), Sigma


def exact_row(
    world: World, projection: Callable[[float], Map], noise: str, eta: str, steps: tuple[int, ...]
) -> dict[str, list[float | None]]:
    """The distances of one choice over numbers of steps; no Monte Carlo."""
    columns = []
    for count in steps:

        def share(t_next: float, count: int = count) -> float:
            return ETAS[eta](t_next, count)

        mean, covariance = world.means[0], world.covariances[0]
        law = eq.sampler_moments(mean, covariance, eq.time_grid(count), projection, noise, share)
        columns.append(distances(world, *law))
    return {name: [plain(column[name]) for column in columns] for name in columns[0]}


def plain(value: float) -> float | None:
    """Five digits for a file; what does not exist becomes None, since JSON has no NaN."""
    return None if np.isnan(value) else float(f"{value:.5g}")


def gaussian_rows(steps: tuple[int, ...], progress: bool = True) -> list[dict[str, Any]]:
    """Every choice on Gaussian data: without a wish, with a hard one, with a soft one."""
    grid = [("none", "none")] + list(itertools.product(("hard", "soft"), METRICS))
    rows = []
    for wish, metric in tqdm(grid, unit="metric", disable=not progress, desc="plane"):
        world = {"none": worlds.line(), "hard": worlds.plane(), "soft": worlds.plane(0.0625)}[wish]
        base = {"world": "line" if wish == "none" else "plane", "wish": wish, "metric": metric}
        projection = projection_of(world, "euclid" if wish == "none" else metric)
        rows += rows_of(base, world, projection, CHOICES, steps)
    return rows


def path_rows(steps: tuple[int, ...], progress: bool = True) -> list[dict[str, Any]]:
    """A path between two keyframes, with and without guides between them."""
    choices = [("implied", "paper"), ("implied", "0"), ("guided", "0")]
    grid = list(itertools.product((False, True), ("euclid", "data", "moving")))
    rows = []
    for guides, metric in tqdm(grid, unit="metric", disable=not progress, desc="path"):
        world, wish = worlds.path(), "hard and guides" if guides else "hard"
        base = {"world": "path", "wish": wish, "metric": metric}
        rows += rows_of(base, world, projection_of(world, metric, guides), choices, steps)
    return rows


def rows_of(
    base: dict[str, Any],
    world: World,
    projection: Callable[[float], Map],
    choices: list[tuple[str, str]],
    steps: tuple[int, ...],
) -> list[dict[str, Any]]:
    """One record for every choice of noise and eta under one projection."""
    rows = []
    for noise, eta in choices:
        scores = exact_row(world, projection, noise, eta, steps)
        rows.append(base | {"noise": noise, "eta": eta, "steps": list(steps), "scores": scores})
    return rows
