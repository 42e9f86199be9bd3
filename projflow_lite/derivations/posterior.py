"""Prior, likelihood and posterior, derived again: ProjFlow eq. 26 and 28–33."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear, minimize
from scipy.stats import multivariate_normal

from projflow_lite import equations as eq

from .problems import (
    exact,
    gap,
    lagrange,
    largest,
    linear_model,
    numbers,
    precision,
    quarters,
    sympy,
)
from .registry import derives


def grid_moments(
    log_density: Callable[[NDArray], float], centre: NDArray
) -> tuple[float, NDArray, NDArray]:
    """Total, mean and covariance of a density in the plane, summed over a fine grid.

    For a Gaussian such a sum is as good as the integral once steps are shorter than its width.
    """
    side, step = np.linspace(-11, 11, 73, retstep=True)
    points = centre + np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    weight = np.exp([log_density(x) for x in points]) * step**2
    total = weight.sum()
    mean = weight @ points / total
    away = points - mean
    return float(total), mean, away.T @ (weight[:, None] * away) / total


@derives(26, "scipy's Gaussian, given the inverse of R as its covariance", 1e-10)
def prior_by_scipy(random: np.random.Generator) -> float:
    """R is a precision: the covariance is its inverse. One coordinate is the bell curve."""
    deviations = []
    for d in (1, 7):
        x1_hat, R = random.normal(size=d), precision(random, d)
        scipys = multivariate_normal(x1_hat, np.linalg.inv(R))
        for x1 in random.normal(size=(4, d)):
            deviations.append(abs(eq.log_prior(x1, x1_hat, R) - scipys.logpdf(x1)))
    return largest(deviations)


@derives(26, "summed over a grid: total 1, mean x1_hat, covariance R^-1", 1e-9)
def prior_on_a_grid(random: np.random.Generator) -> float:
    """What makes it a density around the prediction, whatever its formula."""
    x1_hat, R = random.normal(size=2), precision(random, 2)
    total, mean, covariance = grid_moments(lambda x: eq.log_prior(x, x1_hat, R), x1_hat)
    return largest([abs(total - 1), gap(mean, x1_hat), gap(covariance @ R, np.eye(2))])


@derives(28, "scipy's Gaussian around A x1 with covariance Sigma", 1e-10)
def likelihood_by_scipy(random: np.random.Generator) -> float:
    """Given the motion, only the noise is left to chance."""
    x1, A, y, _, Sigma = linear_model(random)
    scipys = multivariate_normal(A @ x1, Sigma)
    return largest(
        abs(eq.log_likelihood(y + e, x1, A, Sigma) - scipys.logpdf(y + e))
        for e in random.normal(size=(5, 3))
    )


@derives(29, "Bayes: scipy's prior times likelihood, up to known constants", 1e-10)
def bayes_rule(random: np.random.Generator) -> float:
    """Logarithms add; what does not depend on x1 is the two Gaussians' factors of 2 pi and det."""
    x1_hat, A, y, R, Sigma = linear_model(random)
    covariance = np.linalg.inv(R)
    constants = sum(0.5 * np.linalg.slogdet(2 * np.pi * C).logabsdet for C in (covariance, Sigma))
    prior = multivariate_normal(x1_hat, covariance)
    return largest(
        abs(
            eq.log_posterior_unnormalised(x1, x1_hat, A, y, R, Sigma)
            - (prior.logpdf(x1) + multivariate_normal(A @ x1, Sigma).logpdf(y) + constants)
        )
        for x1 in random.normal(size=(5, 7))
    )


@derives(29, "summed over a grid: mean is the projection; its covariance", 1e-8)
def posterior_on_a_grid(random: np.random.Generator) -> float:
    """The projection is not only the top of the posterior: it is also its centre of mass."""
    x1_hat, A, y, R, _ = linear_model(random, d=2, m=1)
    problem = (x1_hat, A, y, R, np.eye(1))
    best = x1_hat + lagrange(*problem)
    _, mean, covariance = grid_moments(lambda x: eq.log_posterior_unnormalised(x, *problem), best)
    return largest([gap(mean, best), gap(covariance, eq.posterior_covariance(A, R, np.eye(1)))])


@derives(30, "both lengths in fractions, Sigma inverted without rounding", 1e-12)
def objective_in_fractions(random: np.random.Generator) -> float:
    """Sympy multiplies the printed formula out in whole numbers over whole numbers."""
    x1, x1_hat, y = quarters(random, 4), quarters(random, 4), quarters(random, 2)
    A, R, Sigma = quarters(random, 2, 4), precision(random, 4), precision(random, 2)
    away, misfit = exact(x1) - exact(x1_hat), exact(y) - exact(A) * exact(x1)
    price = away.T * exact(R) * away + misfit.T * exact(Sigma).inv() * misfit
    return abs(eq.map_objective(x1, x1_hat, A, y, R, Sigma) / numbers(price)[0] - 1)


@derives(30, "place and depth of its lowest point, by scipy's BFGS", 1e-5)
def walking_downhill(random: np.random.Generator) -> float:
    """The bottom must be where Lagrange's conditions put it, and as deep as forces say.

    At the bottom the price is the work of the forces: y - A x1_hat times z, z = (y - A x) / Sigma.
    """
    x1_hat, A, y, _, Sigma = problem = linear_model(random)
    found = minimize(eq.map_objective, x1_hat, args=problem, options={"gtol": 1e-7})
    best = x1_hat + lagrange(*problem)
    depth = (y - A @ x1_hat) @ np.linalg.solve(Sigma, y - A @ best)
    return largest([gap(found.x, best), abs(found.fun - depth)])


@derives(31, "sympy differentiates the price twice, in fractions", 1e-12)
def half_the_second_derivative(random: np.random.Generator) -> float:
    """Half the gradient of eq. 30 is H x - b: H half its derivatives, -b its value at x = 0."""
    sp = sympy()
    x1_hat, A, y = quarters(random, 3), quarters(random, 2, 3), quarters(random, 2)
    R, Sigma = precision(random, 3), precision(random, 2)
    x = sp.Matrix(sp.symbols("x1:4"))
    away, misfit = x - exact(x1_hat), exact(y) - exact(A) * x
    (price,) = away.T * exact(R) * away + misfit.T * exact(Sigma).inv() * misfit
    at_zero = dict.fromkeys(x, 0)
    H = sp.hessian(price, list(x)) / 2
    b = -sp.Matrix([sp.diff(price, x_i) for x_i in x]).subs(at_zero) / 2
    ours_H, ours_b = eq.map_normal_equations(x1_hat, A, y, R, Sigma)
    size = largest([1, np.abs(ours_H).max(), np.abs(ours_b).max()])
    return largest([gap(ours_H, numbers(H)), gap(ours_b, numbers(b))]) / size


@derives(32, "one least-squares system of whitened rows (lsq_linear)", 1e-9)
def whitened_rows(random: np.random.Generator) -> float:
    """Cholesky factors turn metrics into lengths: prior and data become rows of one system."""
    x1_hat, A, y, R, Sigma = linear_model(random)
    of_prior, of_noise = np.linalg.cholesky(R).T, np.linalg.inv(np.linalg.cholesky(Sigma))
    rows = np.vstack([of_prior, of_noise @ A])
    right = np.concatenate([of_prior @ x1_hat, of_noise @ y])
    best = lsq_linear(rows, right, tol=1e-14).x
    return gap(eq.map_estimate(x1_hat, A, y, R, Sigma), best)


@derives(32, "limit for Sigma to 0, extrapolated: the hard constraint", 1e-8)
def limit_of_small_noise(random: np.random.Generator) -> float:
    """Eq. 32 has no value at 0, but a limit: a power series, taken apart as Euler's error is."""
    x1_hat, A, y, R, Sigma = linear_model(random)
    shrink = [0.01 / 2**k for k in range(6)]
    points = [eq.map_estimate(x1_hat, A, y, R, s * Sigma) for s in shrink]
    order = 1
    while len(points) > 1:
        points = [(2**order * near - far) / (2**order - 1) for far, near in pairwise(points)]
        order += 1
    return gap(points[0], x1_hat + lagrange(x1_hat, A, y, R, np.zeros((3, 3))))


@derives(33, "stationarity solved in fractions, with correlated noise", 1e-12)
def stationary_in_fractions(random: np.random.Generator) -> float:
    """Elimination without rounding: R u = A' z and the misfit left over is Sigma z."""
    sp = sympy()
    x1_hat, A, y = quarters(random, 3), quarters(random, 2, 3), quarters(random, 2)
    R, Sigma = precision(random, 3), precision(random, 2)
    system = sp.Matrix.vstack(
        sp.Matrix.hstack(exact(R), -exact(A).T), sp.Matrix.hstack(exact(A), exact(Sigma))
    )
    right = sp.Matrix.vstack(sp.zeros(3, 1), exact(y) - exact(A) * exact(x1_hat))
    best = exact(x1_hat) + system.LUsolve(right)[:3, :]
    return gap(eq.map_estimate_as_correction(x1_hat, A, y, R, Sigma), numbers(best))


@derives(33, "by differences: no slope of the price is left, anywhere", 1e-8)
def no_slope_left(random: np.random.Generator) -> float:
    """A difference across the top is exactly 0 for a parabola; the price is written out here."""
    x1_hat, A, y, R, Sigma = linear_model(random)
    top, h = eq.map_estimate_as_correction(x1_hat, A, y, R, Sigma), 0.1
    weight = np.linalg.inv(Sigma)

    def price(x: NDArray) -> float:
        return (x - x1_hat) @ R @ (x - x1_hat) + (y - A @ x) @ weight @ (y - A @ x)

    return largest(
        abs(price(top + h * e) - price(top - h * e)) / (2 * h)
        for e in [*np.eye(7), *random.normal(size=(3, 7))]
    )
