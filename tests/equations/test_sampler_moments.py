"""The exact law of the sampler against the real loop, against torch, and against limits by hand."""

from itertools import pairwise

import numpy as np
import pytest
import torch

from projflow_lite import equations as eq
from projflow_lite.samplers.projflow import projflow

MEAN, COVARIANCE = np.array([0.3, -0.2]), np.array([[0.25, 0.2], [0.2, 0.36]])
A, Y = np.array([[1.0, 0.4]]), np.array([0.8])
HARD, SOFT = np.zeros((1, 1)), np.array([[0.04]])
METRIC = np.array([[2.0, 0.5], [0.5, 1.0]])
NO_WISH = np.zeros((0, 2)), np.zeros(0), np.eye(2), np.zeros((0, 0))
WEIGHTS = np.array([0.3, 0.7])
MEANS = np.array([[-1.0, 0.5], [1.0, 0.0]])
COVARIANCES = np.array([[[0.2, 0.1], [0.1, 0.3]], [[0.4, -0.2], [-0.2, 0.2]]])


def velocity(x, t):
    return eq.gaussian_velocity(x, t, MEAN, COVARIANCE)


def real_loop(x0, times, Sigma, noise, eta, rng):
    """The sampler as a student would write it, from the printed equations, a sample at a time."""
    x = x0
    for t, t_next in pairwise(times):
        v = velocity(x, t)
        x1_hat = eq.tweedie_endpoint(x, v, t)
        x1 = np.stack([eq.project(one, A, Y, METRIC, Sigma) for one in x1_hat])
        source = {
            "original": x0,
            "implied": eq.implied_noise(x, v, t),
            "guided": eq.implied_noise(x, (x1 - x) / (1 - t), t),
        }[noise]
        share = eq.noise_mixing(t_next) if eta is None else eta
        x = eq.recompose(x1, eq.mix_noise(source, rng.normal(size=x.shape), share), t_next)
    return x


def assert_has_law(samples, mean, covariance):
    """Sample mean and covariance within five standard errors."""
    n = len(samples)
    error = 5 * np.sqrt(np.diag(covariance) / n) + 1e-9
    assert (np.abs(samples.mean(0) - mean) < error).all()
    spread = np.outer(np.diag(covariance), np.diag(covariance)) + covariance**2
    assert (np.abs(np.cov(samples.T) - covariance) < 5 * np.sqrt(spread / n) + 1e-9).all()


@pytest.mark.parametrize("noise", ["original", "implied", "guided"])
@pytest.mark.parametrize("eta", [0.0, None, 0.4])
@pytest.mark.parametrize("Sigma", [HARD, SOFT], ids=["hard", "soft"])
def test_the_real_loop_has_this_law(noise, eta, Sigma):
    rng = np.random.default_rng(0)
    times = np.linspace(0, 1, 5)
    samples = real_loop(rng.normal(size=(600, 2)), times, Sigma, noise, eta, rng)
    projection = eq.projection_map(A, Y, METRIC, Sigma)
    moments = eq.sampler_moments(MEAN, COVARIANCE, times, lambda t: projection, noise, eta)
    assert_has_law(samples, *moments)


@pytest.mark.parametrize("noise", ["original", "implied"])
@pytest.mark.parametrize("eta", [0.0, None])
def test_the_torch_sampler_has_this_law(noise, eta):
    generator = torch.Generator().manual_seed(0)
    x0 = torch.randn((200_000, 2), generator=generator, dtype=torch.float64)
    M, c = eq.projection_map(A, Y, METRIC, HARD)
    matrix, offset = torch.tensor(M.T), torch.tensor(c)
    times = np.linspace(0, 1, 21)
    x = projflow(
        lambda x, t, text: torch.from_numpy(velocity(x.numpy(), t)),
        lambda x1_hat, t: x1_hat @ matrix + offset,
        x0, times.tolist(), generator, noise=noise, eta="paper" if eta is None else eta,
    )  # fmt: skip
    moments = eq.sampler_moments(MEAN, COVARIANCE, times, lambda t: (M, c), noise, eta)
    assert_has_law(x.numpy(), *moments)


def test_with_no_fresh_noise_one_step_map_carries_every_single_sample():
    rng = np.random.default_rng(1)
    x0, x_t = rng.normal(size=(2, 4, 2))
    for noise in ("original", "implied", "guided"):
        projection = eq.projection_map(A, Y, METRIC, SOFT)
        F, f = eq.sampler_step(0.3, 0.45, MEAN, COVARIANCE, projection, noise, 0.0)
        v = velocity(x_t, 0.3)
        x1_hat = eq.tweedie_endpoint(x_t, v, 0.3)
        x1 = np.stack([eq.project(one, A, Y, METRIC, SOFT) for one in x1_hat])
        source = {
            "original": x0, "implied": x_t - 0.3 * v, "guided": (x_t - 0.3 * x1) / 0.7,
        }[noise]  # fmt: skip
        step = np.hstack([x_t, x0]) @ F.T + f
        np.testing.assert_allclose(step[:, :2], 0.45 * x1 + 0.55 * source, rtol=0, atol=1e-12)
        np.testing.assert_array_equal(step[:, 2:], x0)


def test_the_map_of_the_projection_is_the_projection():
    rng = np.random.default_rng(2)
    for Sigma in (HARD, SOFT):
        M, c = eq.projection_map(A, Y, METRIC, Sigma)
        for x in rng.normal(size=(3, 2)):
            right = eq.project(x, A, Y, METRIC, Sigma)
            np.testing.assert_allclose(M @ x + c, right, rtol=0, atol=1e-12)


def test_without_a_wish_the_deterministic_sampler_is_eulers_method():
    times = np.linspace(0, 1, 8)
    none = eq.projection_map(*NO_WISH)
    mean, covariance = eq.sampler_moments(MEAN, COVARIANCE, times, lambda t: none, "implied", 0.0)
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    ends = eq.flow_map(velocity, corners, times)[-1]
    np.testing.assert_allclose(mean, ends[0], rtol=0, atol=1e-12)
    F = (ends[1:] - ends[0]).T
    np.testing.assert_allclose(covariance, F @ F.T, rtol=0, atol=1e-12)


def spread_without_a_wish(std, steps, noise, eta):
    none = eq.projection_map(np.zeros((0, 1)), [], np.eye(1), np.zeros((0, 0)))
    times = np.linspace(0, 1, steps + 1)
    _, covariance = eq.sampler_moments([0.0], [[std**2]], times, lambda t: none, noise, eta)
    return float(np.sqrt(covariance[0, 0])) / std


@pytest.mark.parametrize("eta", [0.3, 0.75, 1.0])
def test_a_fixed_share_of_fresh_noise_narrows_the_data_however_many_steps(eta):
    """By hand: in the limit the variance shrinks to (1 + sqrt(1 - eta)) / 2 of the true one."""
    expected = np.sqrt((1 + np.sqrt(1 - eta)) / 2)
    errors = [abs(spread_without_a_wish(0.5, n, "implied", eta) - expected) for n in (200, 4000)]
    assert errors[1] < 0.01
    assert errors[1] < 0.5 * errors[0]


def test_a_share_in_proportion_to_the_step_keeps_the_spread():
    errors = [abs(spread_without_a_wish(0.5, n, "implied", 3 / n) - 1) for n in (100, 400, 1600)]
    assert errors[2] < 0.002
    assert errors[1] / errors[0] == pytest.approx(0.25, abs=0.05)
    assert errors[2] / errors[1] == pytest.approx(0.25, abs=0.05)


def test_the_original_noise_alone_spreads_without_bound():
    """By hand: the spread grows like Gamma(2/3) (c N / 3)^(1/3) with the number of steps N."""
    grown = spread_without_a_wish(0.5, 8000, "original", 0.0)
    by_hand = 1.3541179394264 * (0.5 * 8000 / 3) ** (1 / 3)
    assert grown == pytest.approx(by_hand, rel=0.03)


@pytest.mark.parametrize("Sigma", [HARD, SOFT], ids=["hard", "soft"])
def test_the_moving_metric_with_guided_noise_is_the_posterior(Sigma):
    """Its mean at any number of steps; its covariance in the limit, with an error like 1 / N."""
    mean, covariance = eq.gaussian_posterior(MEAN, COVARIANCE, A, Y, Sigma)

    def projection(t):
        return eq.projection_map(A, Y, eq.endpoint_precision(t, COVARIANCE), Sigma)

    errors = []
    for steps in (5, 100, 400):
        times = np.linspace(0, 1, steps + 1)
        ours = eq.sampler_moments(MEAN, COVARIANCE, times, projection, "guided", 0.0)
        np.testing.assert_allclose(ours[0], mean, rtol=0, atol=1e-10)
        errors.append(np.abs(ours[1] - covariance).max())
    assert errors[2] < 0.003
    assert errors[2] / errors[1] == pytest.approx(0.25, abs=0.03)


def test_the_euclidean_metric_comes_to_the_posterior_slowly_and_the_datas_own_does_not():
    """By hand: with implied noise and none fresh the mean is off like N^(-1/3), or for good."""
    mean, covariance = eq.gaussian_posterior(MEAN, COVARIANCE, A, Y, HARD)
    free = np.array([0.4, -1.0]) / np.hypot(0.4, 1.0)  # A free = 0
    std = np.sqrt(free @ covariance @ free)

    def error(R, steps):
        step = eq.projection_map(A, Y, R, HARD)
        times = np.linspace(0, 1, steps + 1)
        m, C = eq.sampler_moments(MEAN, COVARIANCE, times, lambda t: step, "implied", 0.0)
        return abs(free @ (m - mean)) / std, np.sqrt(free @ C @ free) / std

    (first, _), (last, spread) = error(np.eye(2), 500), error(np.eye(2), 4000)
    assert last / first == pytest.approx(8 ** (-1 / 3), rel=0.1)
    assert spread == pytest.approx(1, abs=0.003)
    own = np.linalg.inv(COVARIANCE)
    assert error(own, 4000)[0] > 0.1
    assert error(own, 4000)[0] == pytest.approx(error(own, 1000)[0], rel=0.05)


def test_endpoint_precision_inverts_a_covariance_that_was_sampled():
    rng = np.random.default_rng(3)
    x1 = rng.multivariate_normal(MEAN, COVARIANCE, size=200_000)
    x_t = 0.4 * x1 + 0.6 * rng.normal(size=x1.shape)
    rest = x1 - eq.gaussian_endpoint(x_t, 0.4, MEAN, COVARIANCE)
    sampled = np.cov(rest.T)
    np.testing.assert_allclose(
        np.linalg.inv(eq.endpoint_precision(0.4, COVARIANCE)), sampled, rtol=0, atol=0.003
    )


@pytest.mark.parametrize("t", [0.2, 0.6, 0.9])
def test_endpoint_of_a_mixture_by_brute_force(t):
    """Mean and covariance of x1 given x_t, on a fine grid of x1."""
    side = np.linspace(-5, 5, 1001)
    x1 = np.stack(np.meshgrid(side, side, indexing="ij"), axis=-1).reshape(-1, 2)
    x_t = np.array([0.2, 0.1])
    prior = sum(
        w * np.exp(eq.log_density(x1, m, C))
        for w, m, C in zip(WEIGHTS, MEANS, COVARIANCES, strict=True)
    )
    weight = prior * np.exp(-0.5 * (((x_t - t * x1) / (1 - t)) ** 2).sum(-1))
    weight /= weight.sum()
    mean = weight @ x1
    covariance = (x1 - mean).T @ ((x1 - mean) * weight[:, None])
    ours = eq.mixture_endpoint(np.stack([x_t, x_t + 1]), t, WEIGHTS, MEANS, COVARIANCES)
    np.testing.assert_allclose(ours[0][0], mean, rtol=0, atol=1e-6)
    np.testing.assert_allclose(ours[1][0], covariance, rtol=0, atol=1e-6)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: eq.endpoint_precision(1.0, [[1.0]]), "endpoint_precision: t = 1.0 is not in"),
        (lambda: eq.endpoint_precision(0.5, [[-1.0]]), "covariance is not positive definite"),
        (lambda: eq.projection_map([[1.0], [1.0]], [0.0, 0.0], [[1.0]], np.zeros((2, 2))), "is not positive definite"),
        (lambda: eq.projection_map([[1.0]], [0.0, 1.0], [[1.0]], [[0.0]]), "projection_map: y has shape"),
        (lambda: eq.sampler_step(0.0, 0.5, [0.0], [[1.0]], (np.eye(1), np.zeros(1)), "fresh", 0.0), "noise is 'fresh', expected one of original"),
        (lambda: eq.sampler_step(0.0, 1.5, [0.0], [[1.0]], (np.eye(1), np.zeros(1)), "implied", 0.0), "t_next = 1.5 is outside"),
        (lambda: eq.sampler_step(0.0, 0.5, [0.0], [[1.0]], (np.eye(1), np.zeros(1)), "implied", 2.0), "share = 2.0 is outside"),
        (lambda: eq.mixture_endpoint([0.0], 0.5, [0.5, 0.6], [[0.0], [1.0]], [[[1.0]], [[1.0]]]), "sum to 1"),
    ],
)  # fmt: skip
def test_wrong_arguments_are_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()
