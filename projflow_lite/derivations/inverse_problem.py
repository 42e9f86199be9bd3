"""Measuring, and the price of a correction, derived again: ProjFlow eq. 4, 6 and 27."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
from scipy.stats import multivariate_normal

from projflow_lite import equations as eq

from .problems import exact, gap, largest, linear_model, numbers, precision, quarters
from .registry import derives

DRAWS = 4000


@derives(4, "row by row in fractions; no row, a row of zeros, all rows", 1e-14)
def measurement_in_fractions(random: np.random.Generator) -> float:
    """A measurement is a weighted sum of coordinates, plus what the noise adds."""
    x = random.normal(size=5).tolist()
    deviations = []
    for A in (random.normal(size=(3, 5)), np.zeros((0, 5)), np.zeros((1, 5)), np.eye(5)):
        noise = random.normal(size=len(A))
        y = [Fraction(e) for e in noise.tolist()]
        for k, row in enumerate(A.tolist()):
            y[k] += sum(Fraction(a) * Fraction(x_i) for a, x_i in zip(row, x, strict=True))
        deviations.append(gap(eq.observe(x, A, noise), list(map(float, y))))
    return largest(deviations)


@derives(6, "both lengths in fractions, Sigma inverted without rounding", 1e-12)
def price_in_fractions(random: np.random.Generator) -> float:
    """Sympy multiplies the printed formula out in whole numbers over whole numbers."""
    delta, x1_hat, y = quarters(random, 4), quarters(random, 4), quarters(random, 2)
    A, R, Sigma = quarters(random, 2, 4), precision(random, 4), precision(random, 2)
    u, misfit = exact(delta), exact(y) - exact(A) * (exact(x1_hat) + exact(delta))
    price = (u.T * exact(R) * u + misfit.T * exact(Sigma).inv() * misfit) / 2
    ours = eq.projection_objective(delta, x1_hat, A, y, R, Sigma)
    return abs(ours / numbers(price)[0] - 1)


@derives(6, "minus log densities of scipy's Gaussians, up to a constant", 1e-10)
def price_is_improbability(random: np.random.Generator) -> float:
    """Correction and misfit are Gaussian: what is dear is improbable, and logarithms add up."""
    x1_hat, A, y, R, Sigma = linear_model(random)
    correction = multivariate_normal(np.zeros(7), np.linalg.inv(R))
    noise = multivariate_normal(np.zeros(3), Sigma)

    def price(delta: np.ndarray) -> float:
        return -correction.logpdf(delta) - noise.logpdf(y - A @ (x1_hat + delta))

    def ours(delta: np.ndarray) -> float:
        return eq.projection_objective(delta, x1_hat, A, y, R, Sigma)

    nothing = np.zeros(7)
    return largest(
        abs((ours(delta) - ours(nothing)) - (price(delta) - price(nothing)))
        for delta in random.normal(size=(5, 7))
    )


@derives(27, "drawn: mean and covariance of measurements (standard errors)", 5)
def scatter_of_measurements(random: np.random.Generator) -> float:
    """Measurements of one motion scatter around A x1 as their noise does around nothing."""
    x1, A, _, _, Sigma = linear_model(random)
    noise = random.multivariate_normal(np.zeros(3), Sigma, size=DRAWS)
    y = np.array([eq.observe(x1, A, e) for e in noise])
    variance = np.diag(Sigma)
    expected = [math.fsum(row * x1) for row in A]
    off_mean = np.abs(y.mean(axis=0) - expected) / np.sqrt(variance / DRAWS)
    spread = np.sqrt((np.outer(variance, variance) + Sigma**2) / DRAWS)  # of a sample covariance
    off_covariance = np.abs(np.cov(y.T) - Sigma) / spread
    return largest([off_mean.max(), off_covariance.max()])
