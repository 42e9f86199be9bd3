"""The flow as a diffusion: against DDPM's formulas, and against laws that are known exactly."""

from itertools import pairwise

import numpy as np
import pytest
import torch

from projflow_lite import equations as eq
from projflow_lite.samplers import ancestral, euler, flow_times
from projflow_lite.samplers.diffusion import denoise, posterior

MEAN = np.array([0.5, -1.0, 2.0])
COVARIANCE = np.array([[1.0, 0.6, 0.1], [0.6, 0.8, 0.0], [0.1, 0.0, 0.2]])
MIXTURE = (
    np.array([0.3, 0.7]),
    np.array([[-2.0, 0.0, 0.5], [1.5, 1.0, 0.0]]),
    np.array([np.diag([0.3, 0.5, 0.1]), COVARIANCE]),
)


def on_points(velocity):
    """A velocity of points (n, 3) as one of motions of one frame and one joint."""

    def field(x_t, t, text=None):
        return torch.as_tensor(velocity(x_t.numpy()[:, 0, 0], t))[:, None, None]

    return field


gaussian = on_points(lambda x, t: eq.gaussian_velocity(x, t, MEAN, COVARIANCE))
mixture = on_points(lambda x, t: eq.mixture_velocity(x, t, *MIXTURE))


def draws(sampler, velocity, steps, count, seed=0):
    generator = torch.Generator().manual_seed(seed)
    x0 = torch.randn(count, 1, 1, 3, generator=generator, dtype=torch.float64)
    more = (generator,) if sampler is ancestral else ()
    return sampler(velocity, x0, flow_times(steps), *more).numpy()[:, 0, 0]


def test_a_step_is_ddpms_posterior_in_other_units():
    """Scaled to a diffusion's state at the same ratio of signal to noise, and back."""
    random = np.random.default_rng(0)
    for t, t_next in [(0.0, 0.1), (0.2, 0.35), (0.5, 0.9), (0.9, 1.0)]:
        x1, x_t = random.normal(size=(2, 4, 3))
        level, level_next = eq.alpha_bar_at(t), eq.alpha_bar_at(t_next)
        mean, variance = eq.ddpm_posterior(x1, eq.diffusion_state(x_t, t), level, level_next)
        unit = 1 / (np.sqrt(level_next) + np.sqrt(1 - level_next))
        ours, our_variance = posterior(torch.tensor(x1), torch.tensor(x_t), t, t_next)
        np.testing.assert_allclose(ours, eq.flow_state(mean, level_next), atol=1e-12)
        assert our_variance.item() == pytest.approx(unit**2 * variance, abs=1e-15)


def test_the_posterior_is_that_of_the_path_it_reverses():
    """Noise t' to t by hand, draw many triples, and regress the cleaner state on the other two."""
    random, t, t_next, spread, n = np.random.default_rng(1), 0.4, 0.55, 0.7, 200_000
    b, b_next = (1 - t) / t, (1 - t_next) / t_next
    x1 = random.normal(size=n)
    cleaner = x1 + b_next * spread * random.normal(size=n)
    noisier = cleaner + np.sqrt(b**2 - b_next**2) * spread * random.normal(size=n)
    inputs = np.stack([x1, t * noisier], 1)
    weights, (rest,), *_ = np.linalg.lstsq(inputs, t_next * cleaner, rcond=None)
    on_x1, zero = torch.tensor([1.0, 0.0]).double(), torch.tensor([0.0, 1.0]).double()
    ours, variance = posterior(on_x1, zero, t, t_next, spread)
    np.testing.assert_allclose(weights, ours, atol=0.01)
    assert rest / n == pytest.approx(variance.item(), rel=0.02)


def test_the_endpoint_is_the_conditional_mean():
    x_t = torch.tensor([[0.3, 0.1, -0.4]]).double()[:, None, None]
    expected, _ = eq.mixture_endpoint(x_t.numpy()[0, 0, 0], 0.6, *MIXTURE)
    np.testing.assert_allclose(denoise(mixture, x_t, 0.6)[0, 0, 0], expected, atol=1e-12)


def exact_law(steps):
    """Mean and covariance of ancestral sampling, by a recursion in the diffusion's own state."""
    mu, P = np.zeros(3), np.eye(3)
    levels = eq.alpha_bar_at(flow_times(steps))
    for level, level_next in pairwise(levels.tolist()):
        a = np.sqrt(level)
        S = a**2 * COVARIANCE + (1 - level) * np.eye(3)
        E = a * np.linalg.solve(S, COVARIANCE).T  # f(x) = m + E (x - a m)
        one, zero = np.eye(3), np.zeros((3, 3))
        on_x1, variance = eq.ddpm_posterior(one, zero, level, level_next)
        on_state, _ = eq.ddpm_posterior(zero, one, level, level_next)
        mu = on_x1 @ (MEAN + E @ (mu - a * MEAN)) + on_state @ mu
        F = on_x1 @ E + on_state
        P = F @ P @ F.T + variance * one
    return mu, P


def assert_moments(x, mean, covariance):
    """Sample moments within four standard errors of what they should be."""
    n, spread = len(x), np.sqrt(np.diag(covariance))
    assert (np.abs(x.mean(0) - mean) < 4 * spread / np.sqrt(n)).all()
    allowed = 4 * np.sqrt((np.outer(spread, spread) ** 2 + covariance**2) / n)
    assert (np.abs(np.cov(x.T) - covariance) < allowed).all()


def test_ancestral_sampling_has_its_exact_law():
    assert_moments(draws(ancestral, gaussian, 12, 20_000), *exact_law(12))


def test_projections_sampler_without_a_wish_has_the_same_law():
    """Noise implied by the state and diffusion's share of fresh noise: ProjFlow eq. 9 is DDPM."""
    times = flow_times(12)
    share = {t_next: eq.ddpm_noise_share(t, t_next) for t, t_next in pairwise(times)}
    nothing = (np.eye(3), np.zeros(3))
    moments = eq.sampler_moments(MEAN, COVARIANCE, times, lambda t: nothing, "implied", share.get)
    for ours, theirs in zip(exact_law(12), moments, strict=True):
        np.testing.assert_allclose(ours, theirs, atol=1e-12)


def euler_law(steps):
    nothing = (np.eye(3), np.zeros(3))
    return eq.sampler_moments(MEAN, COVARIANCE, flow_times(steps), lambda t: nothing, "implied", 0)


def test_with_small_steps_both_samplers_draw_from_the_gaussian():
    """Exactly, without a draw: the error is of first order in the step, for both."""
    for law in (exact_law, euler_law):
        errors = [np.abs(law(steps)[1] - COVARIANCE).max() for steps in (100, 200, 400)]
        assert errors[0] < 0.06
        assert errors[1] / errors[0] == pytest.approx(0.5, abs=0.06)
        assert errors[2] / errors[1] == pytest.approx(0.5, abs=0.03)
        np.testing.assert_allclose(law(400)[0], MEAN, atol=1e-2)


def test_with_few_steps_both_are_too_narrow_and_diffusion_more_so():
    def narrowing(law):
        return np.trace(law(10)[1]) / np.trace(COVARIANCE)

    assert narrowing(exact_law) < narrowing(euler_law) < 1


def test_both_samplers_draw_the_same_mixture():
    w, m, C = MIXTURE
    mean = w @ m
    covariance = np.einsum("k,kij->ij", w, C + np.einsum("ki,kj->kij", m - mean, m - mean))
    flow, diffusion = (draws(s, mixture, 250, 4000) for s in (euler, ancestral))
    for x in (flow, diffusion):
        # A first-order bias on top of the Monte Carlo error of 4000 draws.
        np.testing.assert_allclose(x.mean(0), mean, atol=0.12)
        np.testing.assert_allclose(np.cov(x.T), covariance, atol=0.2)
        first = np.mean(x[:, 0] < -0.5)
        exact = sum(
            w_k * norm_cdf((-0.5 - m_k[0]) / np.sqrt(C_k[0, 0]))
            for w_k, m_k, C_k in zip(w, m, C, strict=True)
        )
        assert first == pytest.approx(exact, abs=4 * np.sqrt(exact * (1 - exact) / 4000) + 0.01)
    for axis in range(3):
        assert kolmogorov(flow[:, axis], diffusion[:, axis]) > 1e-3


def norm_cdf(z):
    from scipy.stats import norm

    return norm.cdf(z)


def kolmogorov(a, b):
    from scipy.stats import ks_2samp

    return ks_2samp(a, b).pvalue


def test_noise_of_another_size_is_a_change_of_units():
    wide = on_points(lambda x, t: 5 * eq.gaussian_velocity(x / 5, t, MEAN, COVARIANCE))
    ends = []
    for velocity, unit in ((gaussian, 1.0), (wide, 5.0)):
        generator = torch.Generator().manual_seed(3)
        x0 = unit * torch.randn(4, 1, 1, 3, generator=generator, dtype=torch.float64)
        ends.append(ancestral(velocity, x0, flow_times(9), generator, noise_std=unit) / unit)
    torch.testing.assert_close(*ends, atol=1e-10, rtol=0)


@pytest.mark.parametrize("times", [(0.5, 0.5), (0.6, 0.5), (-0.1, 0.5), (0.5, 1.1)])
def test_times_out_of_order_are_refused(times):
    with pytest.raises(ValueError, match="posterior: expected 0 <= t < t_next <= 1"):
        posterior(torch.zeros(3), torch.zeros(3), *times)
