"""Random ingredients that several exercises share."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray


def metric(rng: Generator, size: int) -> NDArray:
    """Draw a symmetric positive definite matrix that is neither diagonal nor badly scaled."""
    B = rng.normal(size=(size, size))
    return B @ B.T + size * np.eye(size)


def covariance(rng: Generator, size: int) -> NDArray:
    """Draw a correlated covariance of measurements, of the size of a few centimetres squared."""
    return 0.1 * metric(rng, size)


def laplacian(rng: Generator, joints: int) -> NDArray:
    """Draw a skeleton: every joint but the first hangs on an earlier one."""
    L = np.zeros((joints, joints))
    for child in range(1, joints):
        parent = int(rng.integers(child))
        L[child, child] += 1
        L[parent, parent] += 1
        L[child, parent] -= 1
        L[parent, child] -= 1
    return L


def joint_metric(rng: Generator, joints: int) -> NDArray:
    """Draw the metric of a skeleton with weights between those of most applications."""
    weight, ridge = rng.uniform(2, 10), rng.uniform(0.5, 1.5)
    return weight * laplacian(rng, joints) + ridge * np.eye(joints)
