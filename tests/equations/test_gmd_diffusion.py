"""One prior in two costumes, against closed forms, symbols and drawn samples."""

from itertools import pairwise

import numpy as np
import pytest
import sympy as sp
from scipy.optimize import brentq

from projflow_lite import equations as eq

MEAN, COVARIANCE = np.array([0.4, -0.3]), np.array([[0.5, 0.3], [0.3, 0.9]])
SAMPLES = 40_000


def velocity(x, t):
    return eq.gaussian_velocity(x, t, MEAN, COVARIANCE)


def test_noising_in_one_go_is_noising_step_by_step():
    """Three steps x <- sqrt(a) x + sqrt(1 - a) e have the law of one step of their product."""
    rng = np.random.default_rng(0)
    alphas, x0 = [0.9, 0.7, 0.8], np.array([2.0, -1.0, 0.5])
    x = np.tile(x0, (SAMPLES, 1))
    for a in alphas:
        x = np.sqrt(a) * x + np.sqrt(1 - a) * rng.normal(size=x.shape)
    alpha_bar = np.prod(alphas)
    mean = eq.diffuse(x0, np.zeros(3), alpha_bar)
    deviation = eq.diffuse(np.zeros(3), np.ones(3), alpha_bar)
    assert (np.abs(x.mean(0) - mean) < 5 * deviation / np.sqrt(SAMPLES)).all()
    assert (np.abs(x.var(0) / deviation**2 - 1) < 5 * np.sqrt(2 / SAMPLES)).all()
    of_one_step = eq.diffuse(x0, np.zeros(3), alphas[-1])
    assert np.abs(x.mean(0) - of_one_step).max() > 0.2


@pytest.mark.parametrize("t", [0.0, 0.2, 0.5, 0.9, 1.0])
def test_signal_to_noise_is_the_same(t):
    alpha_bar = float(eq.alpha_bar_at(t))
    assert t**2 * (1 - alpha_bar) == pytest.approx(alpha_bar * (1 - t) ** 2)
    found = brentq(lambda s: eq.alpha_bar_at(s) - alpha_bar, 0, 1, xtol=1e-14)
    assert eq.time_at(alpha_bar) == pytest.approx(found, abs=1e-7)


def test_states_are_the_same_path():
    rng = np.random.default_rng(1)
    noise, data, t = rng.normal(size=(3, 4)), rng.normal(size=(3, 4)), np.array([0.0, 0.35, 1.0])
    x_t, alpha_bar = eq.interpolate(noise, data, t), eq.alpha_bar_at(t)
    diffusion = np.sqrt(alpha_bar)[:, None] * data + np.sqrt(1 - alpha_bar)[:, None] * noise
    assert np.allclose(eq.diffusion_state(x_t, t), diffusion)
    assert np.allclose(eq.flow_state(diffusion, alpha_bar), x_t)


@pytest.mark.parametrize("alpha_bar", [0.0, 0.1, 0.8, 1.0])
def test_denoiser_is_the_conditional_mean(alpha_bar):
    """Data and state are jointly Gaussian: `gaussian_posterior` knows the mean of one given one."""
    x = np.array([0.7, -1.2])
    a, noise = np.sqrt(alpha_bar) * np.eye(2), (1 - alpha_bar) * np.eye(2)
    if alpha_bar == 1:
        expected = x
    else:
        expected, _ = eq.gaussian_posterior(MEAN, COVARIANCE, a, x, noise)
    assert np.allclose(eq.denoise(x, alpha_bar, velocity), expected)


def test_ddpm_posterior_by_bayes_rule_with_symbols():
    """log q(x' | x0) + log q(x | x') as a parabola in x': its top and its width."""
    x, x0, u = sp.symbols("x x0 u")
    for level, level_next in ((0.2, 0.5), (0.0, 0.3), (0.9, 0.95)):
        a, b = sp.Rational(str(level)), sp.Rational(str(level_next))
        exponent = (u - sp.sqrt(b) * x0) ** 2 / (1 - b)
        exponent += (x - sp.sqrt(a / b) * u) ** 2 / (1 - a / b)
        width = 2 / sp.diff(exponent, u, 2)
        top = sp.solve(sp.diff(exponent, u), u)[0].subs({x: 1.3, x0: -0.4})
        mean, variance = eq.ddpm_posterior([-0.4], [1.3], level, level_next)
        assert mean[0] == pytest.approx(float(top))
        assert variance == pytest.approx(float(width))


def test_last_step_lands_on_the_prediction():
    mean, variance = eq.ddpm_posterior([2.0], [7.0], 0.9, 1.0)
    assert mean[0] == pytest.approx(2)
    assert variance == 0


def ddpm_moments(times):
    """Exact mean and covariance of a DDPM run on Gaussian data: every step is affine."""
    mean, covariance = np.zeros(2), np.eye(2)
    for a, b in pairwise(map(float, eq.alpha_bar_at(times))):

        def step(x, a=a, b=b):
            return eq.ddpm_posterior(eq.denoise(x, a, velocity), x, a, b)

        shift, variance = step(np.zeros(2))
        slope = np.stack([step(e)[0] - shift for e in np.eye(2)], axis=1)
        mean, covariance = slope @ mean + shift, slope @ covariance @ slope.T + variance * np.eye(2)
    return mean, covariance


def assert_has_law(samples, mean, covariance):
    """Sample mean and covariance within five standard errors."""
    n = len(samples)
    assert (np.abs(samples.mean(0) - mean) < 5 * np.sqrt(np.diag(covariance) / n)).all()
    spread = np.outer(np.diag(covariance), np.diag(covariance)) + covariance**2
    assert (np.abs(np.cov(samples.T) - covariance) < 5 * np.sqrt(spread / n)).all()


def test_ddpm_and_euler_draw_from_the_same_gaussian():
    rng = np.random.default_rng(2)
    times = np.linspace(0, 1, 401)
    x = rng.normal(size=(SAMPLES // 4, 2))
    euler = eq.flow_map(velocity, x, times)[-1]
    for a, b in pairwise(map(float, eq.alpha_bar_at(times))):
        mean, variance = eq.ddpm_posterior(eq.denoise(x, a, velocity), x, a, b)
        x = mean + np.sqrt(variance) * rng.normal(size=x.shape)
    assert_has_law(x, MEAN, COVARIANCE)
    assert_has_law(euler, MEAN, COVARIANCE)


def test_ddpm_becomes_exact_as_steps_become_small():
    """The mean is right at once; the error of the covariance halves with the step."""
    found = []
    for steps in (50, 100, 200):
        mean, covariance = ddpm_moments(np.linspace(0, 1, steps + 1))
        assert np.allclose(mean, MEAN)
        found.append(covariance)
    errors = [np.abs(covariance - COVARIANCE).max() for covariance in found]
    assert errors[0] / errors[1] == pytest.approx(2, abs=0.2)
    assert errors[1] / errors[2] == pytest.approx(2, abs=0.2)
    limit = found[0] / 3 - 2 * found[1] + 8 / 3 * found[2]  # Richardson: errors of h and h^2 gone
    assert np.allclose(limit, COVARIANCE, atol=1e-3)


@pytest.mark.parametrize(("t", "t_next"), [(0.0, 0.1), (0.3, 0.45), (0.8, 0.81), (0.9, 1.0)])
def test_a_step_of_projflow_is_a_step_of_ddpm(t, t_next):
    """Eq. 9 with the implied noise, and eq. 10, scaled: the same mean and the same spread."""
    x = np.array([0.6, -0.8])
    v, eta = velocity(x, t), eq.ddpm_noise_share(t, t_next)
    x1_hat, noise = eq.tweedie_endpoint(x, v, t), eq.implied_noise(x, v, t)

    def projflow(eps):
        return eq.diffusion_state(
            eq.recompose(x1_hat, eq.mix_noise(noise, eps, eta), t_next), t_next
        )

    a, b = float(eq.alpha_bar_at(t)), float(eq.alpha_bar_at(t_next))
    state = eq.diffusion_state(x, t)
    mean, variance = eq.ddpm_posterior(eq.denoise(state, a, velocity), state, a, b)
    assert np.allclose(projflow(np.zeros(2)), mean)
    assert np.allclose((projflow(np.ones(2)) - mean) ** 2, variance)


def test_share_of_noise_shrinks_with_the_step_and_table_5_does_not():
    """From t = 1/2 the share is 1 - 1 / (ratio)^2, by hand 8 h for a small step h."""
    for h in (1e-2, 1e-3):
        exact = 1 - ((0.5 - h) / (0.5 + h)) ** 2
        assert eq.ddpm_noise_share(0.5, 0.5 + h) == pytest.approx(exact)
        assert exact == pytest.approx(8 * h, rel=0.05)
        assert eq.noise_mixing(0.5 + h) > 0.5
    assert eq.ddpm_noise_share(0.0, 0.01) == 1
    assert eq.ddpm_noise_share(0.5, 1.0) == 1


def test_levels_in_the_wrong_order_are_refused():
    with pytest.raises(ValueError, match="expected 0 <= 0.5 < 0.5 <= 1"):
        eq.ddpm_posterior([0.0], [0.0], 0.5, 0.5)
    with pytest.raises(ValueError, match="expected 0 <= 0.5 < 0.4 <= 1"):
        eq.ddpm_noise_share(0.5, 0.4)
    with pytest.raises(ValueError, match="alpha_bar = 1.5 is outside"):
        eq.diffuse([0.0], [0.0], 1.5)
