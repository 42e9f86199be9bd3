"""Closed forms against integrals done by brute force, and against the flow they generate."""

import numpy as np
import pytest
from scipy import integrate, stats

from projflow_lite import equations as eq

MEAN, COVARIANCE = np.array([0.5, -1.0]), np.array([[1.0, 0.6], [0.6, 0.5]])
WEIGHTS = np.array([0.3, 0.7])
MEANS = np.array([[-1.0, 0.5], [1.0, 0.0]])
COVARIANCES = np.array([[[0.2, 0.1], [0.1, 0.3]], [[0.4, -0.2], [-0.2, 0.2]]])


def conditional_mean(x_t, t, density):
    """E[x1 - x0 | x_t] and E[x1 | x_t] in one dimension, by quadrature over x1."""

    def joint(x1):
        return density(x1) * stats.norm.pdf((x_t - t * x1) / (1 - t))

    total, first = (
        integrate.quad(lambda x1, k=k: joint(x1) * x1**k, -8, 8, points=[0], limit=200)[0]
        for k in (0, 1)
    )
    x1 = first / total
    return x1 - (x_t - t * x1) / (1 - t), x1


@pytest.mark.parametrize("t", [0.0, 0.3, 0.7, 0.9])
@pytest.mark.parametrize("x_t", [-0.7, 0.4])
def test_velocity_and_endpoint_by_quadrature(t, x_t):
    v, x1 = conditional_mean(x_t, t, stats.norm(0.5, 0.6).pdf)
    arguments = (np.array([x_t]), t, [0.5], [[0.36]])
    assert eq.gaussian_velocity(*arguments) == pytest.approx(v, abs=1e-7)
    assert eq.gaussian_endpoint(*arguments) == pytest.approx(x1, abs=1e-7)

    def mixture(x):
        return 0.3 * stats.norm.pdf(x, -1, 0.4) + 0.7 * stats.norm.pdf(x, 1, 0.6)

    v, _ = conditional_mean(x_t, t, mixture)
    ours = eq.mixture_velocity(
        np.array([x_t]), t, [0.3, 0.7], [[-1.0], [1.0]], [[[0.16]], [[0.36]]]
    )
    assert ours == pytest.approx(v, abs=1e-7)


def test_the_flow_carries_noise_to_the_data():
    x0 = np.random.default_rng(0).normal(size=(20_000, 2))
    ends = eq.flow_map(
        lambda x, t: eq.gaussian_velocity(x, t, MEAN, COVARIANCE), x0, np.linspace(0, 1, 201)
    )
    np.testing.assert_allclose(ends[-1].mean(0), MEAN, rtol=0, atol=0.03)
    np.testing.assert_allclose(np.cov(ends[-1].T), COVARIANCE, rtol=0, atol=0.03)


def test_the_flow_carries_noise_to_both_components_of_a_mixture():
    x0 = np.random.default_rng(0).normal(size=(4000, 2))
    field = lambda x, t: eq.mixture_velocity(x, t, WEIGHTS, MEANS, COVARIANCES)  # noqa: E731
    end = eq.flow_map(field, x0, np.linspace(0, 1, 201))[-1]
    expected = WEIGHTS @ MEANS
    np.testing.assert_allclose(end.mean(0), expected, rtol=0, atol=0.05)
    spread = sum(
        w * (C + np.outer(m - expected, m - expected))
        for w, m, C in zip(WEIGHTS, MEANS, COVARIANCES, strict=True)
    )
    np.testing.assert_allclose(np.cov(end.T), spread, rtol=0, atol=0.08)


def grid_moments(density, y, A, noise):
    """Mean and covariance of two-dimensional data given A x = y + noise, on a fine grid."""
    side = np.linspace(-9, 9, 901)
    x = np.stack(np.meshgrid(side, side, indexing="ij"), axis=-1).reshape(-1, 2)
    weight = density(x) * stats.norm.pdf((y - x @ A[0]) / noise)
    weight /= weight.sum()
    mean = weight @ x
    return mean, (x - mean).T @ ((x - mean) * weight[:, None])


def test_posteriors_on_a_grid():
    A, y, noise = np.array([[1.0, -2.0]]), np.array([0.7]), 0.5
    normal = stats.multivariate_normal
    mean, covariance = grid_moments(normal(MEAN, COVARIANCE).pdf, y, A, noise)
    ours = eq.gaussian_posterior(MEAN, COVARIANCE, A, y, [[noise**2]])
    np.testing.assert_allclose(ours[0], mean, rtol=0, atol=1e-6)
    np.testing.assert_allclose(ours[1], covariance, rtol=0, atol=1e-6)

    def mixture(x):
        return sum(
            w * normal(m, C).pdf(x) for w, m, C in zip(WEIGHTS, MEANS, COVARIANCES, strict=True)
        )

    mean, _ = grid_moments(mixture, y, A, noise)
    w, m, _ = eq.mixture_posterior(WEIGHTS, MEANS, COVARIANCES, A, y, [[noise**2]])
    np.testing.assert_allclose(w @ m, mean, rtol=0, atol=1e-6)


def test_an_exact_measurement_leaves_no_spread_where_it_looks():
    A = np.array([[1.0, -2.0]])
    mean, covariance = eq.gaussian_posterior(MEAN, COVARIANCE, A, [0.7], [[0.0]])
    assert A @ mean == pytest.approx(0.7)
    assert A @ covariance @ A.T == pytest.approx(0, abs=1e-12)


def test_the_posterior_mean_is_the_projection_of_the_mean():
    """The bridge to ProjFlow: with R the inverse covariance, eq. 7 is conditioning."""
    A, y, Sigma = np.array([[1.0, -2.0]]), np.array([0.7]), np.array([[0.3]])
    mean, _ = eq.gaussian_posterior(MEAN, COVARIANCE, A, y, Sigma)
    projected = eq.project(MEAN, A, y, np.linalg.inv(COVARIANCE), Sigma)
    np.testing.assert_allclose(projected, mean, rtol=0, atol=1e-12)


def test_log_density_is_scipys():
    x = np.random.default_rng(0).normal(size=(5, 2))
    theirs = stats.multivariate_normal(MEAN, COVARIANCE).logpdf(x)
    np.testing.assert_allclose(eq.log_density(x, MEAN, COVARIANCE), theirs, rtol=1e-12, atol=0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: eq.gaussian_velocity([0.0], 1.5, [0.0], [[1.0]]), "gaussian_velocity: t = 1.5 is outside 0..1"),
        (lambda: eq.gaussian_endpoint([0.0], 0.5, [0.0], [[-1.0]]), "covariance is not positive definite"),
        (lambda: eq.mixture_velocity([0.0], 0.5, [0.5, 0.6], [[0.0], [1.0]], [[[1.0]], [[1.0]]]), "weights must be positive and sum to 1"),
        (lambda: eq.gaussian_posterior([0.0], [[1.0]], [[1.0, 2.0]], [0.0], [[0.0]]), "A has shape"),
    ],
)  # fmt: skip
def test_wrong_arguments_are_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()
