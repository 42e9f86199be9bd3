"""Small skeletons and random problems that the tests of the equations share."""

from __future__ import annotations

import numpy as np

from projflow_lite.skeleton import EDGES

FULL_BODY = (EDGES, 22)
STICK = (((0, 1), (1, 2), (1, 3)), 4)  # a hip, a chest and two hands


def random_precision(rng: np.random.Generator, d: int) -> np.ndarray:
    """A well-conditioned positive definite matrix with no structure."""
    Q, _ = np.linalg.qr(rng.normal(size=(d, d)))
    return Q @ np.diag(rng.uniform(0.5, 4, d)) @ Q.T


def random_problem(seed: int, d: int = 7, m: int = 3):
    """Return x1_hat, A, y, R, Sigma of a linear-Gaussian model with correlated noise."""
    rng = np.random.default_rng(seed)
    x1_hat, A, y = rng.normal(size=d), rng.normal(size=(m, d)), rng.normal(size=m)
    return x1_hat, A, y, random_precision(rng, d), 0.3 * random_precision(rng, m)
