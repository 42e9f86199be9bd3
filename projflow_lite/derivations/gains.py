"""How far a measurement moves a coordinate, derived again: ProjFlow eq. 18 and 39–47."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize_scalar

from projflow_lite import equations as eq

from .problems import (
    STICK,
    STICK_JOINTS,
    exact,
    gap,
    lagrange,
    largest,
    metric_by_bones,
    numbers,
    precision,
    sympy,
    unproved,
)
from .registry import derives

SAMPLES = 100_000


def masked(
    random: np.random.Generator, softness: float, seen: tuple[int, ...] = (0, 2, 3)
) -> tuple[NDArray, NDArray, NDArray, NDArray, list[int]]:
    """Random x1_hat, mask, y and Sigma that leave gaps, and the list of what is observed."""
    m = np.zeros(6)
    m[list(seen)] = 1
    y, variance = m * random.normal(size=6), softness * m * random.uniform(0.1, 2, 6)
    return random.normal(size=6), np.diag(m), y, np.diag(variance), list(seen)


def share_corrected(i: int, variance: float, R: NDArray) -> float:
    """Share of a misfit of 1 that a lone row on coordinate i corrects, by Lagrange's conditions."""
    row = np.eye(len(R))[[i]]
    return float(lagrange(np.zeros(len(R)), row, [1.0], R, [[variance]])[i])


@derives(18, "the variance at which a lone row corrects pi, by bracketing", 1e-8)
def variance_by_bracketing(random: np.random.Generator) -> float:
    """Turn the variance up until one observed coordinate corrects just the share asked for."""
    R, ridge = metric_by_bones(2, STICK_JOINTS, STICK, 10.0, 1.0), 1.0
    R_J = eq.joint_metric(eq.kinematic_laplacian(STICK, STICK_JOINTS), 10.0, ridge)
    r = eq.marginal_variance(R_J)
    deviations = [gap(eq.variance_from_trust(1.0, r[0]), 0.0)]
    for i in random.choice(24, 4, replace=False):
        pi = random.uniform(0.1, 0.9)
        root = brentq(lambda v, i=i, pi=pi: share_corrected(i, v, R) - pi, 0, 100, xtol=1e-13)
        ours = eq.variance_from_trust(pi, r[i // 3 % STICK_JOINTS])
        deviations.append(abs(float(ours) - root))
    return largest(deviations)


@derives(39, "Lagrange's conditions; gaps, hard and soft rows, none, all", 1e-10)
def masked_step_by_forces(random: np.random.Generator) -> float:
    """Take the observed coordinates as rows, with no empty row among them, and R = I."""
    deviations = []
    for softness, seen in ((0.0, (0, 2, 3)), (1.0, (0, 2, 3)), (0.0, ()), (0.0, tuple(range(6)))):
        x1_hat, M, y, Sigma, rows = masked(random, softness, seen)
        delta = lagrange(x1_hat, np.eye(6)[rows], y[rows], np.eye(6), Sigma[np.ix_(rows, rows)])
        deviations.append(gap(eq.euclidean_masked_update(x1_hat, M, y, Sigma), x1_hat + delta))
    return largest(deviations)


@derives(39, "sympy proves that eq. 39, 40 and 41 are one formula", 1e-13)
def letters_from_39_to_41(random: np.random.Generator) -> float:
    """Two coordinates, one observed, a letter for every number; then numbers put in."""
    sp = sympy()
    x1, x2, y1, s1, s2 = letters = sp.symbols("x1 x2 y1 s1 s2", positive=True)
    x, y, M, Sigma = sp.Matrix([x1, x2]), sp.Matrix([y1, 0]), sp.diag(1, 0), sp.diag(s1, s2)
    line_39 = x + M * (M + Sigma).inv() * (y - M * x)
    line_40 = (sp.eye(2) - M * (M + Sigma).inv() * M) * x + M * (M + Sigma).inv() * y
    line_41 = sp.Matrix([(1 - 1 / (1 + s1)) * x1 + y1 / (1 + s1), x2])
    values = random.uniform(0.1, 2, 5)
    point = dict(zip(letters, map(sp.Rational, values), strict=True))
    arguments = (values[:2], np.diag([1, 0]), [values[2], 0], np.diag(values[3:]))
    return largest(
        [
            unproved(line_39 - line_40, point),
            unproved(line_40 - line_41, point),
            gap(eq.euclidean_masked_update(*arguments), numbers(line_41.subs(point))),
        ]
    )


@derives(40, "correlated noise, solved in fractions", 1e-12)
def shares_in_fractions(random: np.random.Generator) -> float:
    """Where every row is noisy the printed inverse exists, and sympy forms it without rounding."""
    sp = sympy()
    x1_hat, M, y, _, _ = masked(random, 1.0)
    Sigma = precision(random, 6)
    gain = exact(M) * (exact(M) + exact(Sigma)).inv()
    best = (sp.eye(6) - gain * exact(M)) * exact(x1_hat) + gain * exact(y)
    return gap(eq.euclidean_masked_average(x1_hat, M, y, Sigma), numbers(best))


@derives(40, "coordinate by coordinate: gaps, hard rows, soft rows", 1e-13)
def shares_by_coordinate(random: np.random.Generator) -> float:
    """Without correlation each coordinate weighs two numbers by their precisions, 1 and 1/s."""
    deviations = []
    for softness in (0.0, 1.0):
        x1_hat, M, y, Sigma, rows = masked(random, softness)
        best = x1_hat.copy()
        for i in rows:
            s = Sigma[i, i]
            best[i] = y[i] if s == 0 else (x1_hat[i] + y[i] / s) / (1 + 1 / s)
        deviations.append(gap(eq.euclidean_masked_average(x1_hat, M, y, Sigma), best))
    return largest(deviations)


@derives(41, "lowest point of (x - x_i)^2 + (x - y_i)^2 / s, by line search", 1e-6)
def lowest_point(random: np.random.Generator) -> float:
    """Between prediction and data, as a compromise of two springs; a hard row (s = 0) is y."""
    deviations = [gap(eq.euclidean_coordinate_update([3.0], [5.0], [0.0]), [5.0])]
    for x_i, y_i in random.normal(size=(4, 2)):
        s = random.uniform(0.05, 3)
        found = minimize_scalar(
            lambda x, x_i=x_i, y_i=y_i, s=s: (x - x_i) ** 2 + (x - y_i) ** 2 / s, tol=1e-10
        )
        deviations.append(gap(eq.euclidean_coordinate_update([x_i], [y_i], [s]), [found.x]))
    return largest(deviations)


@derives(42, "drawn: slope of truth on noisy readings (standard errors)", 5)
def slope_of_a_regression(random: np.random.Generator) -> float:
    """Truth of variance 1 read with variance s: the best linear guess takes this share of it."""
    deviations = []
    for s in (0.25, 1.0, 4.0):
        truth, noise = random.normal(size=(2, SAMPLES))
        reading = truth + math.sqrt(s) * noise
        slope = (truth @ reading) / (reading @ reading)
        unexplained = (truth - slope * reading).std()
        standard_error = unexplained / math.sqrt(SAMPLES * (1 + s))
        deviations.append(abs(float(eq.euclidean_gain(s)) - slope) / standard_error)
    return largest(deviations)


@derives(42, "one over one plus s, in fractions; s = 0 included", 1e-15)
def gain_in_fractions(random: np.random.Generator) -> float:
    """A hard row gets the whole weight, a hopeless one next to nothing."""
    variances = [0.0, *random.uniform(0, 3, 4), 1e12]
    return gap(eq.euclidean_gain(variances), [float(1 / (1 + Fraction(s))) for s in variances])


@derives(43, "the share pi of the way to the data, in fractions", 1e-14)
def part_of_the_way(random: np.random.Generator) -> float:
    """No trust stays, full trust arrives."""
    x, y = random.normal(size=(2, 5))
    pi = [0.0, *random.uniform(size=3), 1.0]
    way = [
        float(Fraction(a) + Fraction(share) * (Fraction(b) - Fraction(a)))
        for a, b, share in zip(x, y, pi, strict=True)
    ]
    return gap(eq.weighted_average(x, y, pi), way)


@derives(44, "Lagrange's conditions; gaps, hard and soft rows, none, all", 1e-10)
def masked_step_in_a_metric(random: np.random.Generator) -> float:
    """The empty rows of a mask say nothing, so the minimum is that of the other rows."""
    deviations = []
    for softness, seen in ((0.0, (0, 2, 3)), (1.0, (0, 2, 3)), (0.0, ()), (0.0, tuple(range(6)))):
        x1_hat, M, y, Sigma, rows = masked(random, softness, seen)
        R = precision(random, 6)
        delta = lagrange(x1_hat, np.eye(6)[rows], y[rows], R, Sigma[np.ix_(rows, rows)])
        deviations.append(gap(eq.masked_update(x1_hat, M, y, R, Sigma), x1_hat + delta))
    return largest(deviations)


@derives(45, "free coordinates settle where hard ones pull them, in blocks", 1e-11)
def conditional_mean(random: np.random.Generator) -> float:
    """With the observed ones in place, the rest is cheapest where R_ff u_f = -R_fo u_o."""
    x1_hat, M, y, Sigma, seen = masked(random, 0.0)
    R, free = precision(random, 6), [1, 4, 5]
    best = y.copy()
    pull = R[np.ix_(free, seen)] @ (y - x1_hat)[seen]
    best[free] = x1_hat[free] - np.linalg.solve(R[np.ix_(free, free)], pull)
    return gap(eq.masked_average(x1_hat, M, y, R, Sigma), best)


@derives(45, "sympy proves that eq. 44 and 45 are one formula", 1e-13)
def letters_from_44_to_45(random: np.random.Generator) -> float:
    """Two coordinates that the metric couples, one observed; then numbers put in."""
    sp = sympy()
    r1, r2, s, r12, y1, x1, x2 = letters = sp.symbols("r1 r2 s r12 y1 x1 x2", real=True)
    x, y, M, Sigma = sp.Matrix([x1, x2]), sp.Matrix([y1, 0]), sp.diag(1, 0), sp.diag(s, 1)
    R_inv = sp.Matrix([[r1, r12], [r12, r2]]).inv()
    K = R_inv * M.T * (M * R_inv * M.T + Sigma).inv()
    line_44, line_45 = x + K * (y - M * x), (sp.eye(2) - K * M) * x + K * y
    values = [*random.uniform(1, 2, 3), *random.uniform(-0.9, 0.9, 4)]
    point = dict(zip(letters, map(sp.Rational, values), strict=True))
    R = np.array([[values[0], values[3]], [values[3], values[1]]])
    arguments = (values[5:], np.diag([1, 0]), [values[4], 0], R, np.diag([values[2], 1]))
    proof = unproved(line_44 - line_45, point)
    return largest([proof, gap(eq.masked_average(*arguments), numbers(line_44.subs(point)))])


@derives(46, "measured: share of a misfit corrected by a lone row", 1e-10)
def share_measured(random: np.random.Generator) -> float:
    """Observe one coordinate of a stick figure, solve for the forces, see how far it went."""
    R = metric_by_bones(2, STICK_JOINTS, STICK, 10.0, 1.0)
    deviations = []
    for i in random.choice(24, 6, replace=False):
        r = np.linalg.solve(R, np.eye(24)[i])[i]
        for variance in (0.0, random.uniform(0, 1)):
            ours = float(eq.trust_from_variance(variance, r))
            deviations.append(abs(ours - share_corrected(i, variance, R)))
    return largest(deviations)


@derives(47, "sympy solves eq. 46 for the variance", 1e-12)
def trust_turned_round(random: np.random.Generator) -> float:
    """One equation, one unknown, one solution; full trust leaves no variance."""
    sp = sympy()
    pi, r, variance = sp.symbols("pi r variance", positive=True)
    (solved,) = sp.solve(sp.Eq(pi, r / (r + variance)), variance)
    law = sp.lambdify((pi, r), solved)
    trusts, priors = np.array([*random.uniform(0.05, 1, 5), 1.0]), random.uniform(0.05, 3, 6)
    return gap(eq.variance_from_trust(trusts, priors), law(trusts, priors))
