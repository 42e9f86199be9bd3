import numpy as np
import pytest
import scipy.stats
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from projflow_lite import equations as eq

from .bodies import random_problem


def test_map_objective_is_twice_the_projection_objective():
    x1_hat, A, y, R, Sigma = random_problem(4)
    delta = np.random.default_rng(4).normal(size=7)
    assert eq.map_objective(x1_hat + delta, x1_hat, A, y, R, Sigma) == pytest.approx(
        2 * eq.projection_objective(delta, x1_hat, A, y, R, Sigma), rel=1e-12
    )


def test_map_objective_by_double_sums():
    x1_hat, A, y, R, Sigma = random_problem(13)
    x1, W = np.random.default_rng(13).normal(size=7), np.linalg.inv(Sigma)
    misfit = [y[k] - sum(float(A[k, i] * x1[i]) for i in range(7)) for k in range(3)]
    price = sum(
        float((x1[i] - x1_hat[i]) * R[i, j] * (x1[j] - x1_hat[j]))
        for i in range(7)
        for j in range(7)
    ) + sum(float(misfit[k] * W[k, l] * misfit[l]) for k in range(3) for l in range(3))
    assert eq.map_objective(x1, x1_hat, A, y, R, Sigma) == pytest.approx(price, rel=1e-12)


def test_log_prior_is_scipys_gaussian():
    x1_hat, _, _, R, _ = random_problem(5)
    gaussian = scipy.stats.multivariate_normal(x1_hat, np.linalg.inv(R))
    for x1 in np.random.default_rng(5).normal(size=(5, 7)):
        assert eq.log_prior(x1, x1_hat, R) == pytest.approx(gaussian.logpdf(x1), rel=1e-10)


def test_log_likelihood_is_scipys_gaussian():
    x1, A, y, _, Sigma = random_problem(6)
    gaussian = scipy.stats.multivariate_normal(A @ x1, Sigma)
    assert eq.log_likelihood(y, x1, A, Sigma) == pytest.approx(gaussian.logpdf(y), rel=1e-10)


def test_posterior_is_prior_times_likelihood():
    """Bayes: the three log densities differ by one constant, wherever they are evaluated."""
    x1_hat, A, y, R, Sigma = random_problem(7)
    cov = np.linalg.inv(R)
    prior, evidence = (
        scipy.stats.multivariate_normal(x1_hat, cov),
        scipy.stats.multivariate_normal(A @ x1_hat, A @ cov @ A.T + Sigma),
    )
    offsets = [
        prior.logpdf(x1)
        + scipy.stats.multivariate_normal(A @ x1, Sigma).logpdf(y)
        - eq.log_posterior_unnormalised(x1, x1_hat, A, y, R, Sigma)
        for x1 in np.random.default_rng(7).normal(size=(6, 7))
    ]
    np.testing.assert_allclose(offsets, offsets[0], rtol=1e-9)
    # With the normalising constant it is the posterior's own density.
    x1 = np.zeros(7)
    posterior = scipy.stats.multivariate_normal(
        eq.project(x1_hat, A, y, R, Sigma), eq.posterior_covariance(A, R, Sigma)
    )
    ours = eq.log_posterior_unnormalised(x1, x1_hat, A, y, R, Sigma) + offsets[0]
    assert ours - evidence.logpdf(y) == pytest.approx(posterior.logpdf(x1), rel=1e-9)


def test_eq_7_and_eq_32_are_one_formula_symbolically():
    """Push-through identity, with no number in it: two coordinates, one measurement."""
    r1, r2, s = sp.symbols("r1 r2 s", positive=True)
    r12, a1, a2 = sp.symbols("r12 a1 a2", real=True)
    R, A = sp.Matrix([[r1, r12], [r12, r2]]), sp.Matrix([[a1, a2]])
    gain_7 = R.inv() * A.T * (A * R.inv() * A.T + sp.Matrix([[s]])).inv()
    gain_33 = (R + A.T * A / s).inv() * A.T / s
    assert sp.simplify(gain_7 - gain_33) == sp.zeros(2, 1)
    values = {r1: 2.0, r2: 1.5, r12: 0.3, a1: 1.0, a2: -2.0, s: 0.7}
    expected = np.array(gain_7.subs(values), dtype=float) @ [0.8]
    R_, A_ = (np.array(M.subs(values), dtype=float) for M in (R, A))
    problem = ([0.0, 0.0], A_, [0.8], R_, [[0.7]])
    np.testing.assert_allclose(eq.project(*problem), expected.ravel(), rtol=0, atol=1e-15)
    np.testing.assert_allclose(
        eq.map_estimate_as_correction(*problem), expected.ravel(), rtol=0, atol=1e-15
    )


def test_woodbury_between_33_and_34_with_correlated_noise_symbolically():
    """Two measurements whose errors are correlated: (33) - (34) simplifies to zero."""
    s1, s2, r = sp.symbols("s1 s2 r", positive=True)
    c, a, b = sp.symbols("c a b", real=True)
    R, A = sp.Matrix([[r, 0], [0, 1]]), sp.Matrix([[1, a], [b, 1]])
    Sigma = sp.Matrix([[s1, c], [c, s2]])
    left = (R + A.T * Sigma.inv() * A).inv() * A.T * Sigma.inv()
    right = R.inv() * A.T * (A * R.inv() * A.T + Sigma).inv()
    assert sp.simplify(left - right) == sp.zeros(2, 2)
    values = {s1: 0.5, s2: 0.8, c: 0.2, r: 3.0, a: -1.0, b: 0.4}
    gain, R_, A_, Sigma_ = (np.array(M.subs(values), float) for M in (right, R, A, Sigma))
    x1_hat, y = np.array([1.0, -2.0]), np.array([0.3, 0.9])
    ours = eq.map_estimate_as_correction(x1_hat, A_, y, R_, Sigma_)
    np.testing.assert_allclose(ours, x1_hat + gain @ (y - A_ @ x1_hat), rtol=0, atol=1e-14)


@given(st.integers(1, 6), st.integers(0, 6), st.integers(0, 2**32 - 1))
@settings(max_examples=60)
def test_all_forms_agree_where_all_exist(d, m, seed):
    x1_hat, A, y, R, Sigma = random_problem(seed, d, m)
    ours = eq.project(x1_hat, A, y, R, Sigma)
    np.testing.assert_allclose(eq.map_estimate(x1_hat, A, y, R, Sigma), ours, rtol=0, atol=1e-9)
    np.testing.assert_allclose(
        eq.map_estimate_as_correction(x1_hat, A, y, R, Sigma), ours, rtol=0, atol=1e-9
    )


def numerical_gradient(f, x, h=1e-5):
    return np.array([(f(x + h * e) - f(x - h * e)) / (2 * h) for e in np.eye(len(x))])


def test_normal_equations_are_the_stationary_point_of_eq_30():
    x1_hat, A, y, R, Sigma = random_problem(8)
    H, b = eq.map_normal_equations(x1_hat, A, y, R, Sigma)
    for x1 in np.random.default_rng(8).normal(size=(4, 7)):
        slope = numerical_gradient(lambda x: eq.map_objective(x, x1_hat, A, y, R, Sigma), x1)
        np.testing.assert_allclose(slope, 2 * (H @ x1 - b), rtol=0, atol=1e-7)


def test_map_estimate_has_no_slope_left():
    x1_hat, A, y, R, Sigma = random_problem(9)
    for point in (eq.map_estimate, eq.map_estimate_as_correction, eq.project):
        x1 = point(x1_hat, A, y, R, Sigma)
        slope = numerical_gradient(
            lambda x: eq.log_posterior_unnormalised(x, x1_hat, A, y, R, Sigma), x1
        )
        np.testing.assert_allclose(slope, 0, rtol=0, atol=1e-8)


def test_posterior_mean_and_covariance_by_conditioning_samples():
    """Monte Carlo, no formula: draw motions and measurements together, keep those near y."""
    rng, n = np.random.default_rng(10), 400_000
    R, A, Sigma = np.array([[2.0, 0.8], [0.8, 1.0]]), np.array([[1.0, -0.5]]), np.array([[0.3]])
    x1_hat, y = np.array([0.5, -1.0]), np.array([1.6])
    x1 = rng.multivariate_normal(x1_hat, np.linalg.inv(R), size=n)
    measured = x1 @ A.T + rng.normal(size=(n, 1)) * Sigma**0.5
    kept = x1[np.abs(measured[:, 0] - y[0]) < 0.03]
    error = kept.std(axis=0) / np.sqrt(len(kept))
    assert (np.abs(kept.mean(axis=0) - eq.project(x1_hat, A, y, R, Sigma)) < 4 * error).all()
    covariance = eq.posterior_covariance(A, R, Sigma)
    np.testing.assert_allclose(
        np.cov(kept.T), covariance, rtol=0, atol=5 * 2**0.5 / len(kept) ** 0.5
    )


def test_posterior_covariance_from_precisions():
    _, A, _, R, Sigma = random_problem(11)
    precision = R + A.T @ np.linalg.inv(Sigma) @ A
    np.testing.assert_allclose(
        eq.posterior_covariance(A, R, Sigma) @ precision, np.eye(7), rtol=0, atol=1e-12
    )
    hard = eq.posterior_covariance(A, R, np.zeros((3, 3)))
    np.testing.assert_allclose(
        A @ hard, 0, rtol=0, atol=1e-13
    )  # what is measured exactly does not vary


def test_small_noise_tends_to_the_hard_constraint():
    """Erratum of eq. 31-33: only eq. 7 survives Sigma = 0; the others refuse."""
    x1_hat, A, y, R, Sigma = random_problem(12)
    hard = eq.project(x1_hat, A, y, R, 0 * Sigma)
    gaps = [
        np.linalg.norm(eq.project(x1_hat, A, y, R, s * Sigma) - hard) for s in (1e-2, 1e-4, 1e-6)
    ]
    np.testing.assert_allclose([gaps[0] / gaps[1], gaps[1] / gaps[2]], 100, rtol=0.1)
    for function in (eq.map_normal_equations, eq.map_estimate, eq.map_estimate_as_correction):
        with pytest.raises(ValueError, match="use eq. 7"):
            function(x1_hat, A, y, R, 0 * Sigma)
