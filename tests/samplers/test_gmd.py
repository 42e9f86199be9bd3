"""GMD's sampler on a prior whose answers are known, step by step and in law."""

from itertools import pairwise

import numpy as np
import pytest
import torch

from projflow_lite import equations as eq
from projflow_lite.samplers import flow_times, gmd
from projflow_lite.samplers.gmd import look
from projflow_lite.samplers.gmd_imputation import Imputation

FRAMES, JOINTS = 5, 2
SIZE = FRAMES * JOINTS * 3
RANDOM = np.random.default_rng(7)
MEAN = RANDOM.normal(size=SIZE)
ROOT = RANDOM.normal(size=(SIZE, 2 * SIZE)) / np.sqrt(2 * SIZE)
COVARIANCE = ROOT @ ROOT.T
NOISE_STD = 0.7
TIMES = flow_times(8)


def endpoint_map(t):
    """E and e of E[x1 | x_t] = E x_t + e, for noise of NOISE_STD."""
    S = (1 - t) ** 2 * NOISE_STD**2 * np.eye(SIZE) + t**2 * COVARIANCE
    E = t * np.linalg.solve(S, COVARIANCE).T
    return E, MEAN - t * E @ MEAN


def velocity(x_t, t, text=None):
    E, e = (torch.as_tensor(part).to(x_t.dtype) for part in endpoint_map(t))
    return ((x_t.flatten(1) @ E.T + e).view_as(x_t) - x_t) / (1 - t)


def known(*places):
    """Imputation of single coordinates: (frame, joint, axis, value)."""
    mask = torch.zeros(FRAMES, JOINTS, 3, dtype=torch.bool)
    values = torch.zeros(FRAMES, JOINTS, 3, dtype=torch.float64)
    for *place, value in places:
        mask[tuple(place)], values[tuple(place)] = True, value
    return Imputation(mask, values)


NOTHING = known()
KEYS = known((1, 0, 0, 1.5), (1, 0, 2, -0.5), (4, 0, 0, 0.2), (4, 0, 2, 0.8))


def sample(known=KEYS, batch=1, seed=0, times=TIMES, **options):
    generator = torch.Generator().manual_seed(seed)
    shape = (batch, FRAMES, JOINTS, 3)
    x0 = NOISE_STD * torch.randn(shape, generator=generator, dtype=torch.float64)
    return gmd(velocity, known, x0, times, generator, noise_std=NOISE_STD, **options)


def as_paper(x):
    """A motion (frames, joints, 3) as GMD's matrix of features by steps."""
    return np.asarray(x).reshape(FRAMES, -1).T


def test_every_step_is_the_equations():
    """Replay each step with the formulas of the paper, drawing the same fresh noise."""
    rows, pull, steps = [0, 2], 0.9, []
    mask, y = as_paper(KEYS.mask), as_paper(KEYS.values)[rows]
    end = sample(pull=pull, until=1.0, callback=steps.append, seed=5)
    random = torch.Generator().manual_seed(5)
    shape = (1, FRAMES, JOINTS, 3)
    torch.randn(shape, generator=random, dtype=torch.float64)
    assert len(steps) == len(TIMES) - 1
    for step, x_next in zip(steps, [s.x_t for s in steps[1:]] + [end], strict=True):
        t, t_next, x_t = step.t, step.t_next, step.x_t[0]
        E, e = endpoint_map(t)
        x1_hat = (E @ x_t.numpy().ravel() + e).reshape(FRAMES, JOINTS, 3)
        np.testing.assert_allclose(step.x1_hat[0], x1_hat, atol=1e-12)
        x1 = eq.impute(as_paper(x1_hat), y, mask, rows)  # 4.1 (c)
        np.testing.assert_allclose(as_paper(step.x1_projected[0]), x1, atol=1e-12)
        level, level_next = eq.alpha_bar_at(t), eq.alpha_bar_at(t_next)
        state = as_paper(eq.diffusion_state(x_t.numpy(), t))
        mean, variance = eq.ddpm_posterior(x1, state, level, level_next)
        mean = eq.flow_state(mean, level_next)
        variance *= NOISE_STD**2 * float(eq.flow_state(1.0, level_next)) ** 2
        order = np.arange(SIZE).reshape(FRAMES, -1).T.ravel()  # features by steps, vectorised

        def slope(z):
            return eq.keyframe_gradient(z, y, mask[rows])

        gradient = eq.state_gradient(as_paper(x1_hat), E[np.ix_(order, order)], slope, rows)
        mean = eq.guided_mean(mean, gradient, mask, pull, variance)  # 4.2 (b)
        fresh = torch.randn(shape, generator=random, dtype=torch.float64)[0].numpy()
        expected = mean + np.sqrt(variance) * as_paper(fresh)
        np.testing.assert_allclose(as_paper(x_next[0]), expected, atol=1e-11)


def test_what_is_imputed_to_the_end_is_exact_and_otherwise_it_is_not():
    def misses(**options):
        x = sample(batch=20, **options)
        return (x - KEYS.values)[:, KEYS.mask].abs()

    assert misses(pull=0.0, until=1.0).max() == misses(pull=2.0, until=1.0).max() == 0
    early = misses(pull=0.0, until=0.9)
    assert early.min() > 1e-6
    assert early.mean() < 0.5 * misses(pull=0.0, until=0.0).mean()


def test_imputation_has_its_exact_law_and_that_is_not_the_posterior():
    """Overwriting is projection with R = I, and the noise that leads to what was overwritten."""
    steps, count = 8, 30_000
    times = flow_times(steps)
    place = np.flatnonzero(KEYS.mask.numpy())
    A, y = np.eye(SIZE)[place], KEYS.values.numpy().ravel()[place]
    # The recursion is for noise of standard deviation 1: the same world in units of NOISE_STD.
    m, C = MEAN / NOISE_STD, COVARIANCE / NOISE_STD**2
    overwrite = eq.projection_map(A, y / NOISE_STD, np.eye(SIZE), np.zeros((len(y),) * 2))
    share = {t_next: eq.ddpm_noise_share(t, t_next) for t, t_next in pairwise(times)}
    mean, P = eq.sampler_moments(m, C, times, lambda t: overwrite, "guided", share.get)
    x = sample(batch=count, times=times, pull=0.0, until=1.0).flatten(1).numpy() / NOISE_STD
    spread = np.sqrt(np.diag(P))
    assert (np.abs(x.mean(0) - mean) <= 4.5 * spread / np.sqrt(count) + 1e-12).all()
    allowed = 4.5 * np.sqrt((np.outer(spread, spread) ** 2 + P**2) / count) + 1e-12
    assert (np.abs(np.cov(x.T) - P) <= allowed).all()
    free = np.setdiff1d(np.arange(SIZE), place)
    fine = flow_times(400)
    share = {t_next: eq.ddpm_noise_share(t, t_next) for t, t_next in pairwise(fine)}
    limit, _ = eq.sampler_moments(m, C, fine, lambda t: overwrite, "guided", share.get)
    exact, _ = eq.gaussian_posterior(m, C, A, y / NOISE_STD, np.zeros((len(y),) * 2))
    missing = np.linalg.norm((limit - exact)[free]) / np.linalg.norm((exact - m)[free])
    assert 0.3 < missing < 0.9  # the body follows what was overwritten, but only part of the way


def coordinate(x):
    """A goal: one coordinate at 2, squared."""
    return (x[:, 2, 1, 0] - 2.0).square() / 2


def test_a_stronger_push_leaves_less_of_the_goal():
    values = [coordinate(sample(NOTHING, 200, goal=coordinate, scale=s)) for s in (0, 1, 2, 4, 8)]
    means = [value.mean().item() for value in values]
    assert means == sorted(means, reverse=True)
    assert means[-1] < 0.3 * means[0]


def guided_law(steps, m, v, y, s):
    """Mean and variance of guidance on a Gaussian number and (x - y)² / 2, by recursion."""
    mu, P = 0.0, 1.0
    for t, t_next in pairwise(flow_times(steps)):
        S = (1 - t) ** 2 + t**2 * v
        E = t * v / S
        level, level_next = float(eq.alpha_bar_at(t)), float(eq.alpha_bar_at(t_next))
        unit, unit_next = np.hypot(t, 1 - t), np.hypot(t_next, 1 - t_next)
        on_x1, variance = eq.ddpm_posterior(1.0, 0.0, level, level_next)
        on_state, _ = eq.ddpm_posterior(0.0, 1.0, level, level_next)
        on_x1, on_state = unit_next * on_x1, unit_next / unit * on_state
        variance *= unit_next**2
        push = s * variance * E  # times x1_hat - y
        slope, offset = on_x1 - push, push * y
        mu = slope * (m + E * (mu - t * m)) + offset + on_state * mu
        P = (slope * E + on_state) ** 2 * P + variance
    return mu, P


@pytest.mark.parametrize("s", [0.5, 2.0])
def test_guidance_has_its_exact_law_and_goes_too_far(s):
    """What one would like is p(x) exp(-s G(x)). The push takes the goal at the mean of what x
    may be, not the mean of exp(-s G) over it: too strong, most so early, when x may be anything."""
    m, v, y, count = -1.0, 1.3, 2.0, 40_000

    def number(x_t, t, text=None):
        return torch.as_tensor(m + (t * v - (1 - t)) / ((1 - t) ** 2 + t**2 * v)) * 0 + (
            m + (t * v - (1 - t)) / ((1 - t) ** 2 + t**2 * v) * (x_t - t * m)
        )

    def goal(x):
        return (x - y).square().sum((1, 2, 3)) / 2

    x0 = torch.randn(
        count, 1, 1, 1, dtype=torch.float64, generator=torch.Generator().manual_seed(2)
    )
    nothing = Imputation(torch.zeros(1, 1, 1, dtype=torch.bool), torch.zeros(1, 1, 1).double())
    generator = torch.Generator().manual_seed(3)
    x = gmd(number, nothing, x0, flow_times(15), generator, goal=goal, scale=s).numpy()
    mean, variance = guided_law(15, m, v, y, s)
    assert x.mean() == pytest.approx(mean, abs=4 * np.sqrt(variance / count))
    assert x.var() == pytest.approx(variance, rel=4 * np.sqrt(2 / count))
    tilted_mean, tilted_variance = (m / v + s * y) / (1 / v + s), 1 / (1 / v + s)
    mean, variance = guided_law(800, m, v, y, s)  # the limit of small steps
    assert tilted_mean < mean < y
    assert variance < tilted_variance


def test_a_hint_at_one_coordinate_moves_all_that_depend_on_it():
    """Through the denoiser the slope is J^T; at the endpoint it is where the goal looks."""
    from projflow_lite.samplers.gmd import Metres

    x_t = torch.randn(1, FRAMES, JOINTS, 3, dtype=torch.float64)
    t, space = 0.6, Metres()
    hat, dense = look(velocity, x_t, t, None, space, coordinate, "network")
    same, sparse = look(velocity, x_t, t, None, space, coordinate, "endpoint")
    torch.testing.assert_close(hat, same)
    E, _ = endpoint_map(t)
    torch.testing.assert_close(dense.flatten(), torch.as_tensor(E.T) @ sparse.flatten())
    assert sparse.count_nonzero() == 1
    assert dense.count_nonzero() == SIZE
    assert not hat.requires_grad
    assert not dense.requires_grad


class Emphasised:
    """A stand-in for an emphasised prior: x_proj = k A x, and the flow that goes with it."""

    noise_std = 1.0

    def __init__(self, c=3.0):
        A_prime = np.random.default_rng(3).normal(size=(JOINTS * 3,) * 2)
        self.A, self.scale = eq.emphasis_matrix(A_prime, [0, 2], c), eq.emphasis_scale(6, [0, 2], c)
        kA = self.scale * np.kron(np.eye(FRAMES), self.A)
        self.mean, self.covariance = kA @ MEAN, kA @ COVARIANCE @ kA.T

    def project(self, motion):
        return motion.flatten(2) @ torch.as_tensor(self.scale * self.A).T

    def unproject(self, x_proj):
        back = torch.as_tensor(np.linalg.inv(self.scale * self.A))
        return (x_proj @ back.T).unflatten(-1, (JOINTS, 3))

    def gain(self, t):
        S = (1 - t) ** 2 * np.eye(SIZE) + t**2 * self.covariance
        return t * np.linalg.solve(S, self.covariance).T

    def __call__(self, x_t, t, text=None):
        E, e = self.gain(t), self.mean - t * self.gain(t) @ self.mean
        x1 = (x_t.flatten(1) @ torch.as_tensor(E).T + torch.as_tensor(e)).view_as(x_t)
        return (x1 - x_t) / (1 - t)


def sample_emphasised(prior, seed, batch=1, times=TIMES, **options):
    generator = torch.Generator().manual_seed(seed)
    x0 = torch.randn(batch, FRAMES, JOINTS * 3, generator=generator, dtype=torch.float64)
    return gmd(prior, KEYS, x0, times, generator, space=prior, noise_std=1.0, **options)


def test_every_projected_step_is_the_equations():
    """Imputation and guidance under emphasis: sections 4.1 (e), 4.2 (c) and (d)."""
    prior, steps, rows, pull = Emphasised(), [], [0, 2], 0.3
    A, k = prior.A, prior.scale
    mask, y = as_paper(KEYS.mask), as_paper(KEYS.values)[rows]
    end = sample_emphasised(prior, 6, pull=pull, until=1.0, callback=steps.append)
    random = torch.Generator().manual_seed(6)
    torch.randn(1, FRAMES, JOINTS * 3, generator=random, dtype=torch.float64)
    for step, following in pairwise([*steps, None]):
        t, t_next, x_t = step.t, step.t_next, step.x_t[0].numpy()
        E = prior.gain(t)
        x1_hat = (E @ (x_t.ravel() - t * prior.mean) + prior.mean).reshape(FRAMES, -1)
        x1 = eq.impute_emphasised(x1_hat.T, y, mask, rows, A, k)
        level, level_next = eq.alpha_bar_at(t), eq.alpha_bar_at(t_next)
        mean, variance = eq.ddpm_posterior(x1, eq.diffusion_state(x_t, t).T, level, level_next)
        mean = eq.flow_state(mean, level_next)
        variance *= float(eq.flow_state(1.0, level_next)) ** 2
        motion = eq.unemphasise(x1_hat.T, A, k)
        slope = np.zeros_like(motion)
        slope[rows] = eq.keyframe_gradient(motion[rows], y, mask[rows])
        pulled = np.linalg.inv(k * A).T @ slope  # through the un-projection, then the denoiser
        gradient = (E.T @ pulled.T.ravel()).reshape(FRAMES, -1).T
        delta = eq.unprojected_step(gradient, A, k, pull, variance)
        mean = eq.guided_mean_emphasised(mean, delta, mask, A, k)
        fresh = torch.randn(1, FRAMES, JOINTS * 3, generator=random, dtype=torch.float64)[0]
        expected = mean + np.sqrt(variance) * fresh.numpy().T
        if following is None:
            break
        np.testing.assert_allclose(following.x_t[0].T, expected, atol=1e-9)
    np.testing.assert_allclose(as_paper(end[0]), eq.unemphasise(expected, A, k), atol=1e-9)


def test_what_is_imputed_under_emphasis_is_exact_to_the_last_bit():
    x = sample_emphasised(Emphasised(), 1, batch=10, until=1.0)
    assert (x - KEYS.values)[:, KEYS.mask].abs().max() == 0


def test_emphasis_makes_the_body_follow():
    """The share of the posterior's answer that imputation misses, with and without emphasis."""

    def missed(x):
        place = np.flatnonzero(KEYS.mask.numpy())
        y = KEYS.values.numpy().ravel()[place]
        exact, _ = eq.gaussian_posterior(
            MEAN, COVARIANCE, np.eye(SIZE)[place], y, np.zeros((len(y),) * 2)
        )
        return np.linalg.norm(x.flatten(1).numpy().mean(0) - exact) / np.linalg.norm(exact - MEAN)

    times = flow_times(25)
    plain = missed(sample(batch=3000, times=times, pull=0.0, until=1.0))
    emphasised = {
        c: missed(sample_emphasised(Emphasised(c), 1, 3000, times, pull=0.0, until=1.0))
        for c in (1, 10)
    }
    assert emphasised[10] < 0.7 * plain < 0.7 * emphasised[1]


WRONG = [
    ({"through": "state"}, "gmd: through is 'network' or 'endpoint', not 'state'"),
    ({"pull": -1}, "gmd: pull is a number from 0 on, not -1"),
    ({"scale": float("nan")}, "gmd: scale is a number from 0 on, not nan"),
    ({"until": 1.5}, "gmd: until is a flow time from 0 to 1, not 1.5"),
]


@pytest.mark.parametrize(("options", "message"), WRONG, ids=[m for _, m in WRONG])
def test_wrong_options_say_what_and_what_to_do(options, message):
    with pytest.raises(ValueError, match=".") as caught:
        sample(**options)
    assert str(caught.value) == message
