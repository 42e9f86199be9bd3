"""Flow matching and the recomposition step, derived again: ProjFlow eq. 1, 2, 3, 5, 9, 10."""

from __future__ import annotations

import math
from collections.abc import Callable
from decimal import Decimal, localcontext
from fractions import Fraction
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad, solve_ivp
from scipy.stats import norm

from projflow_lite import equations as eq

from .problems import gap, largest, sympy
from .registry import derives

SAMPLES = 100_000


@derives(1, "Euler's steps, extrapolated to none, and scipy's ODE solver", 1e-8)
def limit_of_small_steps(random: np.random.Generator) -> float:
    """Euler's error is a power series in the step: halve it and take out one power after another.

    What is left must be the solution of the differential equation, which scipy finds its own way.
    """
    x0, turn = random.normal(size=3), random.normal(size=(3, 3))

    def field(x: NDArray, t: float) -> NDArray:
        return np.cos(3 * t) * np.tanh(turn @ x)

    ends = [eq.flow_map(field, x0, np.linspace(0, 1, 2**k + 1))[-1] for k in range(4, 12)]
    order = 1
    while len(ends) > 1:
        ends = [(2**order * fine - coarse) / (2**order - 1) for coarse, fine in pairwise(ends)]
        order += 1
    solution = solve_ivp(
        lambda t, x: field(x, t), (0, 1), x0, method="DOP853", rtol=1e-12, atol=1e-13
    )
    return gap(ends[0], solution.y[:, -1])


@derives(1, "dx/dt = a x in fractions: each step h multiplies by 1 + a h", 1e-13)
def compound_interest(random: np.random.Generator) -> float:
    """On dx/dt = a x the steps can be taken in exact arithmetic, uneven ones and none included."""
    a, capital = random.normal(), random.normal()
    deviations = []
    for steps in (0, 1, 7):
        times = np.cumsum(random.uniform(0.01, 0.1, steps + 1))
        value, path = Fraction(capital), [capital]
        for t, t_next in pairwise(times):
            value *= 1 + Fraction(a) * (Fraction(t_next) - Fraction(t))
            path.append(float(value))
        ours = eq.flow_map(lambda x, t: a * x, [capital], times)
        deviations.append(gap(ours, np.array(path)[:, None]))
    return largest(deviations)


@derives(2, "coordinate by coordinate in fractions, both ends included", 1e-14)
def straight_line_in_fractions(random: np.random.Generator) -> float:
    """Start at the noise and go the share t of the way to the data."""
    x0, x1 = random.normal(size=(2, 4, 5))
    times = [0.0, *random.uniform(size=2), 1.0]
    walked = np.zeros((4, 5))
    for i, j in np.ndindex(4, 5):
        start, end = Fraction(x0[i, j]), Fraction(x1[i, j])
        walked[i, j] = start + Fraction(times[i]) * (end - start)
    return gap(eq.interpolate(x0, x1, times), walked)


@derives(2, "slope of the path by differences: x1 - x0 everywhere", 1e-12)
def slope_of_the_path(random: np.random.Generator) -> float:
    """A straight line is the path whose velocity, the target of eq. 3, never changes."""
    x0, x1 = random.normal(size=(2, 6))
    h, times = 0.125, random.uniform(0.2, 0.8, 4)
    slopes = [
        (eq.interpolate(x0, x1, t + h) - eq.interpolate(x0, x1, t - h)) / (2 * h) for t in times
    ]
    return largest(gap(slope, x1 - x0) for slope in slopes)


@derives(3, "squares summed one by one, with no rounding on the way (fsum)", 1e-11)
def loss_term_by_term(random: np.random.Generator) -> float:
    """Three nested loops over samples, joints and axes; also for a batch of one."""
    deviations = []
    for batch in (1, 6):
        v, x0, x1 = random.normal(size=(3, batch, 4, 3))
        squares = [(v[i] - (x1[i] - x0[i])) ** 2 for i in np.ndindex(v.shape)]
        deviations.append(abs(eq.flow_matching_loss(v, x0, x1) - math.fsum(squares) / batch))
    return largest(deviations)


@derives(3, "drawn: the best velocity's loss is known (standard errors)", 5)
def loss_of_the_best_velocity(random: np.random.Generator) -> float:
    """For normal data and noise, x1 - x0 given x_t has a mean linear in x_t and a known variance.

    The mean is the best possible answer, so its loss is that variance, 1 / ((1 - t)^2 + t^2).
    """
    x0, x1 = random.normal(size=(2, SAMPLES, 1))
    t = random.uniform(0.1, 0.9)
    spread = (1 - t) ** 2 + t**2
    v = (2 * t - 1) / spread * ((1 - t) * x0 + t * x1)
    standard_error = ((v - (x1 - x0)) ** 2).std() / math.sqrt(SAMPLES)
    return abs(eq.flow_matching_loss(v, x0, x1) - 1 / spread) / standard_error


@derives(5, "expected data and velocity given x_t, by integration", 1e-8)
def endpoint_by_integration(random: np.random.Generator) -> float:
    """Bayes' rule, integrated numerically: E[x1 | x_t] must be where E[x1 - x0 | x_t] leads.

    The data lies anywhere in -1..2 with equal chance; the noise that explains x_t is normal.
    """

    def integral(weigh: Callable[[float, float], float], x_t: float, t: float) -> float:
        def integrand(x1: float) -> float:
            x0 = (x_t - t * x1) / (1 - t)
            return weigh(x0, x1) * norm.pdf(x0)

        return quad(integrand, -1, 2, epsabs=1e-13)[0]

    deviations = []
    for x_t, t in zip(random.normal(size=3), random.uniform(0.1, 0.7, 3), strict=True):
        total = integral(lambda x0, x1: 1, x_t, t)
        v = integral(lambda x0, x1: x1 - x0, x_t, t) / total
        x1_hat = integral(lambda x0, x1: x1, x_t, t) / total
        deviations.append(gap(eq.tweedie_endpoint([x_t], [v], t), [x1_hat]))
    return largest(deviations)


@derives(5, "in fractions; at t = 1 the state is the endpoint", 1e-14)
def endpoint_in_fractions(random: np.random.Generator) -> float:
    """The rest of the way takes the time 1 - t at the velocity v."""
    x, v = random.normal(size=(2, 4))
    times = [0.0, *random.uniform(size=2), 1.0]
    ends = [
        float(Fraction(a) + (1 - Fraction(t)) * Fraction(b))
        for a, b, t in zip(x, v, times, strict=True)
    ]
    return gap(eq.tweedie_endpoint(x, v, times), ends)


@derives(9, "decimals of 40 digits; eta = 0 and eta = 1 too", 1e-14)
def mixing_in_decimals(random: np.random.Generator) -> float:
    """Both square roots to forty digits, then the two products."""
    x0, eps = random.normal(size=(2, 4))
    shares = [0.0, *random.uniform(size=2), 1.0]
    with localcontext(prec=40):
        mixed = [
            float((1 - Decimal(s)).sqrt() * Decimal(a) + Decimal(s).sqrt() * Decimal(b))
            for a, b, s in zip(x0, eps, shares, strict=True)
        ]
    return gap(eq.mix_noise(x0, eps, shares), mixed)


@derives(9, "drawn: variance 1, correlation sqrt(1 - eta) (standard errors)", 5)
def mixing_keeps_the_variance(random: np.random.Generator) -> float:
    """Why square roots: variances of independent noises add up, (1 - eta) + eta = 1."""
    x0, eps = random.normal(size=(2, SAMPLES))
    deviations = []
    for eta in (0.1, 0.5, 0.9):
        mixed = eq.mix_noise(x0, eps, eta)
        deviations.append(abs(mixed.var() - 1) / math.sqrt(2 / SAMPLES))
        correlation = np.corrcoef(mixed, x0)[0, 1]
        deviations.append(abs(correlation - math.sqrt(1 - eta)) / (eta / math.sqrt(SAMPLES)))
    return largest(deviations)


@derives(10, "sympy: with nothing fresh or projected, one step of Euler", 1e-13)
def recomposition_is_a_step(random: np.random.Generator) -> float:
    """Endpoint and implied noise are the two ends of one line; the step only moves along it."""
    sp = sympy()
    x_t, v, t, dt = sp.symbols("x_t v t dt")
    line = (t + dt) * (x_t + (1 - t) * v) + (1 - t - dt) * (x_t - t * v)
    left_over = sp.expand(line - (x_t + dt * v))
    if left_over != 0:
        return math.inf
    step = sp.lambdify((x_t, v, t, dt), x_t + dt * v)
    x, velocity, time = random.normal(), random.normal(), 0.3
    end, start = x + (1 - time) * velocity, x - time * velocity
    return largest(
        gap(eq.recompose([end], [start], time + h), [step(x, velocity, time, h)])
        for h in (0.0, 0.2, 0.7)
    )


@derives(10, "in fractions; only noise at time 0, only endpoint at time 1", 1e-14)
def recomposition_in_fractions(random: np.random.Generator) -> float:
    """Data and noise enter with the weights of eq. 2 at the next time."""
    x1, noise = random.normal(size=(2, 4))
    times = [0.0, *random.uniform(size=2), 1.0]
    mixed = [
        float(Fraction(t) * Fraction(a) + (1 - Fraction(t)) * Fraction(b))
        for a, b, t in zip(x1, noise, times, strict=True)
    ]
    return gap(eq.recompose(x1, noise, times), mixed)
