r"""Data whose posterior is known, and the sampler on it: the ground of the posterior study.

Data is Gaussian or a mixture of Gaussians, the velocity of its flow is exact, and so is the
posterior given a wish. What differs from it is the sampler's doing. Units are those of the noise,
which is standard normal.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from projflow_lite import equations as eq
from projflow_lite.equations.sampler_moments import NOISE_READINGS

METRICS = ("euclid", "data", "opposite", "moving")
"""What the inverse of R is: the identity; the covariance of the data; that covariance with the
sign of every second coordinate turned, which is plainly wrong; the covariance of the clean
endpoint given the state, Cov(x1 | x_t), which moves with time and for a mixture with the state."""

ETAS: dict[str, Callable[[float, int], float]] = {
    "0": lambda t_next, steps: 0.0,
    "paper": lambda t_next, steps: float(eq.noise_mixing(t_next)),
    "1": lambda t_next, steps: 1.0,
    "2/steps": lambda t_next, steps: min(1.0, 2 / steps),
}
"""Share of fresh noise, given the next time and the number of steps."""

CHOICES = [
    (noise, eta)
    for noise, eta in product(NOISE_READINGS, ETAS)
    # Where all noise is fresh nothing is read, so the readings are one.
    if eta != "1" or noise == "implied"
]
"""What eq. 9 mixes, and how much of it is fresh."""


class World(NamedTuple):
    """A mixture of K Gaussians in d dimensions, and a linear wish.

    Attributes:
        weights: ``(K,)``.
        means: ``(K, d)``.
        covariances: ``(K, d, d)``.
        A, y, Sigma: ``(m, d)``, ``(m,)``, ``(m, m)``: the wish, the same for all times.
    """

    weights: NDArray
    means: NDArray
    covariances: NDArray
    A: NDArray
    y: NDArray
    Sigma: NDArray

    @property
    def data(self) -> tuple[NDArray, NDArray, NDArray]:
        """The parameters of the data alone."""
        return self.weights, self.means, self.covariances

    @property
    def moments(self) -> tuple[NDArray, NDArray]:
        """Mean ``(d,)`` and covariance ``(d, d)`` of the data as a whole."""
        mean = self.weights @ self.means
        off = self.means - mean
        between = np.einsum("k,ki,kj->ij", self.weights, off, off)
        return mean, np.einsum("k,kij->ij", self.weights, self.covariances) + between

    @property
    def posterior(self) -> tuple[NDArray, NDArray, NDArray]:
        """Weights, means and covariances of the data given the wish."""
        return eq.mixture_posterior(*self.data, self.A, self.y, self.Sigma)


def gaussian(covariance: NDArray, A: NDArray, y: NDArray, variance: float = 0.0) -> World:
    """A world of one Gaussian around 0, every row with the same variance."""
    d = len(covariance)
    return World(np.ones(1), np.zeros((1, d)), covariance[None], A, y, variance * np.eye(len(y)))


def line() -> World:
    """One number of standard deviation 0.2, and no wish."""
    return gaussian(np.array([[0.04]]), np.zeros((0, 1)), np.zeros(0))


def plane(variance: float = 0.0) -> World:
    """Two numbers of standard deviation 0.5 and correlation 0.8; the first should be 0.8."""
    covariance = 0.25 * np.array([[1.0, 0.8], [0.8, 1.0]])
    return gaussian(covariance, np.array([[1.0, 0.0]]), np.array([0.8]), variance)


def path(frames: int = 16, keys: tuple[int, int] = (3, 12)) -> World:
    """A smooth path of one coordinate, two of whose frames are keyframes."""
    n = np.arange(frames)
    smooth = 0.25 * np.exp(-0.5 * ((n[:, None] - n) / 2.5) ** 2)
    return gaussian(smooth + 0.0025 * np.eye(frames), np.eye(frames)[list(keys)], np.r_[0.5, -0.3])


def three_modes(y: float = 0.1, variance: float = 0.0) -> World:
    """Three modes in the plane; the wish gives the first coordinate."""
    means = np.array([[-0.6, -0.8], [0.7, 1.0], [0.5, -0.3]])
    std = np.array([0.35, 0.30])
    tilt = 0.7 * std[0] * std[1] * np.array([[0.0, 1.0], [1.0, 0.0]])
    covariances = [np.diag(std**2) + tilt, np.diag(std**2) - tilt, 0.25**2 * np.eye(2)]
    wish = np.array([[1.0, 0.0]]), np.array([y]), variance * np.eye(1)
    return World(np.array([0.5, 0.3, 0.2]), means, np.stack(covariances), *wish)


def inverse_metric(world: World, metric: str, x_t: NDArray, t: float) -> NDArray:
    """The inverse of R: ``(d, d)``, or ``(..., d, d)`` for states ``(..., d)`` where it moves."""
    covariance = world.moments[1]
    if metric == "moving":
        return eq.mixture_endpoint(x_t, t, *world.data)[1]
    sign = (-1.0) ** np.arange(len(covariance))
    return {
        "euclid": np.eye(len(covariance)),
        "data": covariance,
        "opposite": sign[:, None] * covariance * sign,
    }[metric]


def project_all(x1_hat: NDArray, world: World, R_inverse: NDArray) -> NDArray:
    """ProjFlow eq. 7 for many endpoints ``(..., d)`` at once; one metric or one for each."""
    R_inv_At = R_inverse @ world.A.T
    S = world.A @ R_inv_At + world.Sigma
    residual = world.y - x1_hat @ world.A.T
    return x1_hat + (R_inv_At @ np.linalg.solve(S, residual[..., None]))[..., 0]


class Trace(NamedTuple):
    """All that happens on the way, one entry a step; samples are ``(steps, n, d)``."""

    times: NDArray
    x_t: NDArray
    x1_hat: NDArray
    x1: NDArray
    x_next: NDArray


def sample(
    world: World,
    metric: str = "euclid",
    noise: str = "implied",
    eta: str = "paper",
    steps: int = 50,
    count: int = 500,
    seed: int = 0,
) -> Trace:
    """Run the sampler on exact velocities: eq. 5, 7, 9 and 10, as a loop.

    Args:
        world: data and wish.
        metric: one of `METRICS`.
        noise: one of `projflow_lite.equations.sampler_moments.NOISE_READINGS`.
        eta: one of `ETAS`.
        steps: number of steps.
        count: number of samples.
        seed: of all randomness; the noise to begin with depends on nothing else.
    """
    rng = np.random.default_rng(seed)
    times = eq.time_grid(steps)
    x = x0 = rng.normal(size=(count, world.means.shape[1]))
    kept = []
    for t, t_next in pairwise(times):
        v = eq.mixture_velocity(x, t, *world.data)
        x1_hat = eq.tweedie_endpoint(x, v, t)
        x1 = project_all(x1_hat, world, inverse_metric(world, metric, x, t))
        if noise == "original":
            source = x0
        else:  # the noise that leads from this state to the endpoint before or after projection
            toward = v if noise == "implied" else (x1 - x) / (1 - t)
            source = eq.implied_noise(x, toward, t)
        mixed = eq.mix_noise(source, rng.normal(size=x.shape), ETAS[eta](t_next, steps))
        kept.append((x, x1_hat, x1, eq.recompose(x1, mixed, t_next)))
        x = kept[-1][-1]
    return Trace(times, *(np.stack(part) for part in zip(*kept, strict=True)))


def sample_ends(
    world: World, metric: str, noise: str, eta: str, steps: int, count: int, seed: int
) -> NDArray:
    """Only what `sample` ends with, ``(count, d)``."""
    return sample(world, metric, noise, eta, steps, count, seed).x_next[-1]


def exact_samples(world: World, count: int, seed: int) -> NDArray:
    """Samples ``(count, d)`` of the exact posterior, in no order."""
    rng = np.random.default_rng(seed)
    weights, means, covariances = world.posterior
    mode = rng.choice(len(weights), size=count, p=weights)
    # Square roots by eigenvalues: along exact rows the posterior is flat, which Cholesky refuses.
    size, axes = np.linalg.eigh(covariances)
    roots = axes * np.sqrt(np.clip(size, 0, None))[:, None, :]
    white = rng.normal(size=(count, means.shape[1]))
    return means[mode] + np.einsum("nij,nj->ni", roots[mode], white)


def exact_flow(world: World, steps: int, count: int, seed: int) -> NDArray:
    """Euler's method on the exact flow of p(x | y): what projection sampling would like to be.

    Only where the rows give the first coordinate exactly: what is left is a mixture beyond it.
    """
    weights, means, covariances = world.posterior
    beyond = weights, means[:, 1:], covariances[:, 1:, 1:]
    x0 = np.random.default_rng(seed).normal(size=(count, means.shape[1] - 1))
    end = eq.flow_map(lambda x, t: eq.mixture_velocity(x, t, *beyond), x0, eq.time_grid(steps))[-1]
    return np.hstack([np.full((count, 1), world.y[0]), end])


def shares_of_modes(world: World, x: NDArray) -> NDArray:
    """Share of each mode ``(K,)`` in samples ``(n, d)``: mean of p(k | x) under the data.

    For exact samples of the posterior its expectation is exactly the posterior weight.
    """
    logs = np.stack(
        [np.log(w) + eq.log_density(x, m, C) for w, m, C in zip(*world.data, strict=True)]
    )
    share = np.exp(logs - logs.max(axis=0))
    return (share / share.sum(axis=0)).mean(axis=1)
