"""What several derivations share: random problems, distances, and solvers that know no eq. 7."""

from __future__ import annotations

from collections.abc import Iterable
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

STICK = ((0, 1), (1, 2), (1, 3))
"""Bones of a stick figure of four joints: a hip, a chest and two hands."""
STICK_JOINTS = 4


def gap(ours: ArrayLike, theirs: ArrayLike) -> float:
    """Largest absolute difference; infinite if the shapes differ, 0 if there is nothing in them."""
    ours, theirs = np.asarray(ours, dtype=np.float64), np.asarray(theirs, dtype=np.float64)
    if ours.shape != theirs.shape:
        return np.inf
    return float(np.abs(ours - theirs).max(initial=0))


def largest(deviations: Iterable[float]) -> float:
    """Largest of several deviations; not a number if one of them is not."""
    return float(np.max(list(deviations)))


def sympy() -> Any:
    """Return sympy, which loads only when a derivation computes with symbols.

    Raises:
        ModuleNotFoundError: if it is not installed; the message says how to install it.
    """
    try:
        return import_module("sympy")
    except ModuleNotFoundError:
        raise ModuleNotFoundError("derivations need sympy; run: pip install sympy") from None


def exact(values: ArrayLike) -> Any:
    """Write numbers as a sympy matrix of fractions: every float is a fraction, exactly."""
    sp = sympy()
    return sp.Matrix(np.asarray(values, dtype=np.float64).tolist()).applyfunc(sp.Rational)


def numbers(matrix: Any) -> NDArray:
    """Round a sympy matrix without symbols to an array; a column becomes a vector."""
    values = np.array(matrix.evalf(20).tolist(), dtype=np.float64).reshape(matrix.shape)
    return values[:, 0] if matrix.shape[1] == 1 else values


def unproved(difference: Any, point: dict) -> float:
    """Return 0.0 if sympy proves that a matrix is zero, else its largest value at a point."""
    sp = sympy()
    if sp.simplify(difference) == sp.zeros(*difference.shape):
        return 0.0
    return float(np.abs(numbers(difference.subs(point))).max())


def quarters(random: np.random.Generator, *shape: int) -> NDArray:
    """Random multiples of 1/4 between -3 and 3: as fractions they stay short."""
    return random.integers(-12, 13, shape) / 4


def precision(random: np.random.Generator, d: int) -> NDArray:
    """Random positive definite matrix with eigenvalues between 0.5 and 4 and no structure."""
    axes, _ = np.linalg.qr(random.normal(size=(d, d)))
    matrix = axes @ np.diag(random.uniform(0.5, 4, d)) @ axes.T
    return (matrix + matrix.T) / 2


def linear_model(
    random: np.random.Generator, d: int = 7, m: int = 3
) -> tuple[NDArray, NDArray, NDArray, NDArray, NDArray]:
    """Random x1_hat, A, y, R and Sigma: m measurements of d coordinates, with correlated noise."""
    x1_hat, y = random.normal(size=d), random.normal(size=m)
    rows, _ = np.linalg.qr(random.normal(size=(d, m)))  # far from dependent on one another
    A = random.uniform(0.5, 2, (m, 1)) * rows.T
    return x1_hat, A, y, precision(random, d), 0.3 * precision(random, m)


def lagrange(
    x1_hat: ArrayLike, A: ArrayLike, y: ArrayLike, R: ArrayLike, Sigma: ArrayLike
) -> NDArray:
    r"""Solve Lagrange's conditions of eq. 6 for the correction, as one linear system.

    The minimum has :math:`R \Delta = A^\top z` and :math:`y - A (\hat x_1 + \Delta) = \Sigma z`
    for some forces z, one per row. Hard rows (Sigma = 0) and repeated rows need no special case:
    then z is not unique, but the correction is.
    """
    x1_hat, A, R = np.asarray(x1_hat, float), np.asarray(A, float), np.asarray(R, float)
    d = A.shape[1]
    system = np.block([[R, -A.T], [A, np.asarray(Sigma, float)]])
    right = np.concatenate([np.zeros(d), np.asarray(y, float) - A @ x1_hat])
    return np.linalg.lstsq(system, right, rcond=1e-12)[0][:d]


def elastic_energy(u: NDArray, bones: Iterable[tuple[int, int]], w_kin: Any, ridge: Any) -> Any:
    """Price of a motion ``(N, J, 3)``, bone by bone and joint by joint, without any matrix.

    Numbers and sympy's symbols will both do.
    """
    frames, joints, axes = u.shape
    total = 0 * ridge
    for n in range(frames):
        for c in range(axes):
            for a, b in bones:
                total = total + w_kin * (u[n, a, c] - u[n, b, c]) ** 2
            for j in range(joints):
                total = total + ridge * u[n, j, c] ** 2
    return total


def metric_by_bones(
    frames: int, joints: int, bones: Iterable[tuple[int, int]], w_kin: float, ridge: float
) -> NDArray:
    """Matrix of that price, entry by entry: vector index (n J + j) 3 + c, no Kronecker product."""
    R = np.zeros((3 * frames * joints,) * 2)
    for n in range(frames):
        for c in range(3):
            place = [(n * joints + j) * 3 + c for j in range(joints)]
            for i in place:
                R[i, i] += ridge
            for a, b in bones:
                for i, k in ((place[a], place[b]), (place[b], place[a])):
                    R[i, i] += w_kin
                    R[i, k] -= w_kin
    return R
