"""The projection, derived again: ProjFlow eq. 7, 8, 21–25 and 34."""

from __future__ import annotations

import numpy as np
from scipy.linalg import null_space
from scipy.optimize import minimize
from scipy.sparse.linalg import lsqr

from projflow_lite import equations as eq

from .problems import (
    STICK,
    STICK_JOINTS,
    exact,
    gap,
    lagrange,
    largest,
    linear_model,
    metric_by_bones,
    numbers,
    quarters,
    sympy,
    unproved,
)
from .registry import derives


@derives(7, "Lagrange's conditions of eq. 6 solved as one linear system", 1e-11)
def one_linear_system(random: np.random.Generator) -> float:
    """Correction and forces as unknowns side by side: nothing is inverted, nothing eliminated."""
    deviations = []
    for hardness in ([1, 1, 1], [0, 0, 0], [1, 0, 1]):
        x1_hat, A, y, R, Sigma = linear_model(random)
        Sigma = np.diag(hardness) @ Sigma @ np.diag(hardness)
        ours = eq.projection_correction(x1_hat, A, y, R, Sigma)
        deviations.append(gap(ours, lagrange(x1_hat, A, y, R, Sigma)))
    return largest(deviations)


@derives(7, "no row, empty and repeated rows, all rows, a loop of two keys", 1e-10)
def degenerate_rows(random: np.random.Generator) -> float:
    """Rows that add nothing must change nothing; then only y is left, or only the prediction."""
    x1_hat, A, y, R, _ = linear_model(random)
    project, none = eq.projection_correction, np.zeros((0, 7))
    once = lagrange(x1_hat, A, y, R, np.zeros((3, 3)))
    repeated, asked = np.vstack([A, A[0] - A[1], 0 * A[2]]), np.append(y, [y[0] - y[1], 0])
    everything = random.normal(size=7)
    body = metric_by_bones(2, STICK_JOINTS, STICK, 10.0, 1.0)
    pose, ends = random.normal(size=24), np.eye(24)[[0, 12]]
    loop = np.vstack([ends, ends[0] - ends[1]])
    return largest(
        [
            gap(project(x1_hat, none, [], R, np.zeros((0, 0))), np.zeros(7)),
            gap(project(x1_hat, repeated, asked, R, np.zeros((5, 5))), once),
            gap(project(x1_hat, np.eye(7), everything, R, np.zeros((7, 7))), everything - x1_hat),
            gap(
                project(pose, loop, [1, 1, 0], body, np.zeros((3, 3))),
                lagrange(pose, ends, [1, 1], body, np.zeros((2, 2))),
            ),
        ]
    )


@derives(8, "shortest correction under A x = y, by scipy's SLSQP", 1e-6)
def generic_optimiser(random: np.random.Generator) -> float:
    """Hard rows turn eq. 6 into a constrained minimum: a general-purpose solver walks to it."""
    x1_hat, A, y, R, _ = linear_model(random)
    found = minimize(
        lambda x: 0.5 * (x - x1_hat) @ R @ (x - x1_hat),
        x1_hat,
        jac=lambda x: R @ (x - x1_hat),
        constraints={"type": "eq", "fun": lambda x: A @ x - y, "jac": lambda x: A},
        method="SLSQP",
        options={"ftol": 1e-15, "maxiter": 500},
    )
    return gap(eq.project(x1_hat, A, y, R, np.zeros((3, 3))), found.x)


@derives(22, "along the null space, with the noise as further unknowns", 1e-11)
def null_space_method(random: np.random.Generator) -> float:
    """Any u = (correction, noise) with [A I] u = y - A x1_hat will do; the cheapest is wanted.

    Start at one of them and walk along the directions that [A I] does not see.
    """
    x1_hat, A, y, R, Sigma = linear_model(random)
    both = np.hstack([A, np.eye(3)])
    price = np.block([[R, np.zeros((7, 3))], [np.zeros((3, 7)), np.linalg.inv(Sigma)]])
    start, free = np.linalg.lstsq(both, y - A @ x1_hat)[0], null_space(both)
    best = start - free @ np.linalg.solve(free.T @ price @ free, free.T @ price @ start)
    return gap(eq.project(x1_hat, A, y, R, Sigma), x1_hat + best[:7])


@derives(34, "sympy proves that eq. 33 and eq. 7 are one formula", 1e-13)
def push_through(random: np.random.Generator) -> float:
    """Two coordinates, one measurement, a letter for every number; then numbers put in."""
    sp = sympy()
    r1, r2, s = sp.symbols("r1 r2 s", positive=True)
    r12, a1, a2 = sp.symbols("r12 a1 a2", real=True)
    R, A, Sigma = sp.Matrix([[r1, r12], [r12, r2]]), sp.Matrix([[a1, a2]]), sp.Matrix([[s]])
    gain_33 = (R + A.T * Sigma.inv() * A).inv() * A.T * Sigma.inv()
    gain_7 = R.inv() * A.T * (A * R.inv() * A.T + Sigma).inv()
    values = [*random.uniform(1, 2, 3), *random.uniform(-0.9, 0.9, 3)]
    point = dict(zip((r1, r2, s, r12, a1, a2), map(sp.Rational, values), strict=True))
    x1_hat, y = random.normal(size=2), random.normal(size=1)
    R_, A_, Sigma_ = (np.array(M.subs(point).tolist(), dtype=float) for M in (R, A, Sigma))
    moved = x1_hat + numbers(gain_33.subs(point)) * (y - A_ @ x1_hat)
    return largest(
        [unproved(gain_33 - gain_7, point), gap(eq.project(x1_hat, A_, y, R_, Sigma_), moved)]
    )


@derives(34, "one row after another, as a Kalman filter; one of them hard", 1e-11)
def one_row_at_a_time(random: np.random.Generator) -> float:
    """Each row moves the mean and takes away variance; a row by itself needs only a division."""
    x1_hat, A, y, R, _ = linear_model(random)
    variance = np.array([0.0, *random.uniform(0.1, 1, 2)])
    mean, covariance = x1_hat, np.linalg.inv(R)
    for row, value, s in zip(A, y, variance, strict=True):
        gain = covariance @ row / (row @ covariance @ row + s)
        mean = mean + gain * (value - row @ mean)
        covariance = covariance - np.outer(gain, row @ covariance)
    return gap(eq.project(x1_hat, A, y, R, np.diag(variance)), mean)


@derives(21, "least squares of least length; dependent, contrary, no rows", 1e-11)
def shortest_least_squares(random: np.random.Generator) -> float:
    """Of all corrections that come nearest to y, DDNM makes the shortest."""
    x1_hat, A, y, _, _ = linear_model(random)
    deviations = []
    for rows, asked in (
        (A, y),
        (np.vstack([A, A[0] + A[1]]), np.append(y, 5.0)),  # contradictory: nearest, not met
        (A[:0], y[:0]),
    ):
        nearest = x1_hat + np.linalg.lstsq(rows, asked - rows @ x1_hat, rcond=1e-12)[0]
        deviations.append(gap(eq.ddnm(x1_hat, rows, asked), nearest))
    return largest(deviations)


@derives(25, "sympy's pseudo-inverse in fractions; dependent rows too", 1e-12)
def pseudo_inverse_in_fractions(random: np.random.Generator) -> float:
    """Moore and Penrose's matrix, factored without rounding, so that rank is no matter of taste."""
    sp = sympy()
    full = np.hstack([np.eye(2), quarters(random, 2, 3)])
    deviations = []
    for A in (full, np.vstack([full, full[0] - 2 * full[1]])):
        x1_hat, y = quarters(random, 5), quarters(random, len(A))
        A_pinv = exact(A).pinv()
        kept = A_pinv * exact(y) + (sp.eye(5) - A_pinv * exact(A)) * exact(x1_hat)
        deviations.append(gap(eq.ddnm(x1_hat, A, y), numbers(kept)))
    return largest(deviations)


@derives(23, "Kaczmarz: onto one row after another until nothing moves", 1e-9)
def alternating_projections(random: np.random.Generator) -> float:
    """Each visit drops a perpendicular on one plane; the limit is the nearest common point."""
    x1_hat, A, y, _, _ = linear_model(random)
    A = np.vstack([A[0], A[1] + 0.5 * A[0], A[2] - 0.5 * A[1]])  # no right angles to help
    x = x1_hat
    for _ in range(1000):
        for row, value in zip(A, y, strict=True):
            x = x + row * (value - row @ x) / (row @ row)
    return gap(eq.euclidean_projection(x1_hat, A, y), x)


@derives(24, "LSQR, which forms no pseudo-inverse; dependent rows too", 1e-9)
def iterated_least_squares(random: np.random.Generator) -> float:
    """Started at nothing it never leaves the range of the transpose: the shortest solution."""
    x1_hat, A, y, _, _ = linear_model(random)
    deviations = []
    for rows, asked in ((A, y), (np.vstack([A, A[0] - A[2]]), np.append(y, y[0] - y[2]))):
        delta = lsqr(rows, asked - rows @ x1_hat, atol=1e-15, btol=1e-15, iter_lim=200)[0]
        ours = eq.euclidean_projection_expanded(x1_hat, rows, asked)
        deviations.append(gap(ours, x1_hat + delta))
    return largest(deviations)


@derives(23, "sympy proves that eq. 23, 24 and 25 are one formula", 1e-12)
def three_ways_of_writing(random: np.random.Generator) -> float:
    """With full row rank the pseudo-inverse is a product, and the three lines only sort terms."""
    sp = sympy()
    A, y = sp.Matrix([sp.symbols("a1:4", positive=True)]), sp.Matrix([sp.Symbol("y")])
    x = sp.Matrix(sp.symbols("x1:4", real=True))
    A_pinv = A.T * (A * A.T).inv()
    line_23 = x + A.T * (A * A.T).inv() * (y - A * x)
    line_24 = x + A_pinv * y - A_pinv * A * x
    line_25 = A_pinv * y + (sp.eye(3) - A_pinv * A) * x
    values = random.uniform(0.5, 2, 7)
    point = dict(zip((*A, *x, *y), map(sp.Rational, values), strict=True))
    arguments = (values[3:6], values[None, :3], values[6:])
    return largest(
        [
            unproved(line_23 - line_24, point),
            unproved(line_24 - line_25, point),
            gap(eq.euclidean_projection(*arguments), numbers(line_25.subs(point))),
        ]
    )
