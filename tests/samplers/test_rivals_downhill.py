"""Rivals that walk downhill do what defines them, step by step, against other computations."""

from itertools import pairwise

import numpy as np
import pytest
import torch
from rival_flow import (
    FRAMES,
    PINS,
    RANDOM,
    REACHABLE,
    ROWS,
    SHAPE,
    SIZE,
    SOFT,
    STD,
    STEPS,
    bent,
    dense,
    differences,
    fresh_noise,
    miss_of,
    replayed,
    sample,
    velocity,
)

import projflow_lite as pf
from projflow_lite import equations
from projflow_lite.samplers import Misfit, dno, euler, flow_times
from projflow_lite.samplers.dno import correlation, share_of_rate, thinned
from projflow_lite.samplers.dps import predict


@pytest.mark.parametrize("wish", [PINS, ROWS, SOFT], ids=["pins", "rows", "soft"])
def test_the_misfit_and_its_slope_are_those_written_out(wish):
    misfit = Misfit(wish, FRAMES, torch.float64)
    x = RANDOM.normal(size=SHAPE)
    state = torch.as_tensor(x).requires_grad_()
    loss = misfit.loss(state)
    assert loss.shape == (1,)
    assert loss.item() == pytest.approx(miss_of(wish, x), rel=1e-10)
    slope = misfit.gradient(torch.as_tensor(x))
    torch.testing.assert_close(torch.autograd.grad(loss.sum(), state)[0], slope)
    A, _, _ = dense(wish)
    places = [*np.flatnonzero(A.any(0))[:12], 100, SIZE - 1]
    expected = differences(lambda x: miss_of(wish, x), x, places)
    np.testing.assert_allclose(slope.numpy().ravel()[places], expected, atol=1e-8)


@pytest.mark.parametrize("wish", [PINS, ROWS, SOFT], ids=["pins", "rows", "soft"])
def test_the_steepness_is_the_largest_eigenvalue(wish):
    A, _, variance = dense(wish)
    largest = np.linalg.eigvalsh(A.T @ (A / (1 + variance[:, None])))[-1]
    assert Misfit(wish, FRAMES, torch.float64).steepness == pytest.approx(largest, rel=1e-9)


def test_a_full_step_on_a_soft_pin_is_the_projection_with_r_the_identity():
    wish = pf.pin("head", 3, [1, 2, 3], std=0.6)
    A, y, variance = dense(wish)
    x = RANDOM.normal(size=SHAPE)
    expected = equations.project(x.ravel(), A, y, np.eye(SIZE), np.diag(variance))
    misfit = Misfit(wish, FRAMES, torch.float64)
    steepness = misfit.steepness
    assert steepness == pytest.approx(1 / 1.36)
    got = misfit.descend(torch.as_tensor(x), steepness)
    np.testing.assert_allclose(got.numpy().ravel(), expected, atol=1e-12)


def test_every_motion_of_a_batch_may_have_targets_of_its_own():
    y = RANDOM.normal(size=(2, 3))
    misfit = Misfit(pf.pin("head", 3, [1, 2, 3]), FRAMES, torch.float64).aimed_at(y)
    x = torch.as_tensor(RANDOM.normal(size=(2, *SHAPE[1:])))
    np.testing.assert_allclose(misfit.descend(x)[:, 3, 15].numpy(), y, atol=1e-12)
    with pytest.raises(ValueError, match="2 sets of targets for 3 motions"):
        misfit(torch.zeros(3, *SHAPE[1:], dtype=torch.float64))


def test_flowdps_is_its_equations():
    """Replay each step in numpy, with dense rows and the same fresh noise."""
    A, y, variance = dense(SOFT)
    curvature = A.T @ (A / (1 + variance[:, None]))
    step_length = 0.8 / np.linalg.eigvalsh(curvature)[-1]
    steps, states = replayed(wish=SOFT, method="flowdps", step=0.8, iterations=2)
    noise = fresh_noise()
    next(noise)
    for step, x_next, fresh in zip(steps, states, noise, strict=False):
        x_t, t, t_next = step.x_t.numpy(), step.t, step.t_next
        v = velocity(step.x_t, t).numpy()
        clean = equations.tweedie_endpoint(x_t, v, t).ravel()
        pulled = clean
        for _ in range(2):
            pulled = pulled - step_length * (A.T @ ((A @ pulled - y) / (1 + variance)))
        clean = t * clean + (1 - t) * pulled
        mixed = equations.mix_noise(x_t - t * v, fresh, eta=t_next)
        expected = equations.recompose(clean.reshape(SHAPE), mixed, t_next)
        np.testing.assert_allclose(x_next, expected, atol=1e-12)


def test_pnp_flow_without_a_pull_noises_and_denoises():
    steps, states = replayed(method="pnp_flow", step=0.0)
    x1, noise = np.zeros(SHAPE), fresh_noise()
    for step, n in zip(steps, noise, strict=False):
        x_t = equations.interpolate(n, x1, step.t)
        x1 = equations.tweedie_endpoint(x_t, velocity(torch.as_tensor(x_t), step.t).numpy(), step.t)
        np.testing.assert_allclose(step.x1_hat.numpy(), x1, atol=1e-12)
    np.testing.assert_allclose(states[-1], x1, atol=1e-12)


def test_pnp_flow_pulls_by_less_and_less_and_averages_draws():
    A, y, _ = dense(ROWS)
    length = np.linalg.eigvalsh(A @ A.T)[-1]
    steps, _ = replayed(wish=ROWS, method="pnp_flow", step=1.5, alpha=2.0, draws=2)
    noise = fresh_noise()
    for before, step in pairwise(steps):
        x1 = before.x1_hat.numpy().ravel()
        pulled = x1 - 1.5 * (1 - step.t) ** 2 / length * A.T @ (A @ x1 - y)
        np.testing.assert_allclose(step.x1_projected.numpy().ravel(), pulled, atol=1e-12)
    last = steps[-1]
    draws = [n for n, _ in zip(noise, range(2 * STEPS), strict=False)][-2:]
    ends = []
    for n in draws:
        x_t = torch.as_tensor(last.t * last.x1_projected.numpy() + (1 - last.t) * n)
        ends.append((x_t + (1 - last.t) * velocity(x_t, last.t)).numpy())
    np.testing.assert_allclose(last.x1_hat.numpy(), np.mean(ends, 0), atol=1e-12)


def test_flowchef_goes_down_the_slope_at_the_endpoint_and_not_through_the_network():
    A, _, _ = dense(ROWS)
    steepness = np.linalg.eigvalsh(A @ A.T)[-1]
    steps, states = replayed(wish=ROWS, prior=bent, method="flowchef", step=0.6)
    places = np.flatnonzero(A.any(0))[:8]
    away = np.flatnonzero(~A.any(0))
    for step, x_next in list(zip(steps, states, strict=True))[::3]:
        followed = (step.x_t + (step.t_next - step.t) * bent(step.x_t, step.t)).numpy()
        push = (x_next - followed).ravel()
        slope = differences(lambda x: miss_of(ROWS, x), step.x1_hat.numpy(), places)
        np.testing.assert_allclose(push[places], -0.6 / steepness * slope, atol=1e-8)
        np.testing.assert_allclose(push[away], 0, atol=1e-12)


def test_a_full_step_of_flowchef_meets_pins():
    assert sample(method="flowchef", step=1.0).residual < 1e-12
    assert sample(method="flowchef", step=0.5).residual > 1e-3


def test_dps_pushes_down_the_slope_through_the_network():
    x_t, t = RANDOM.normal(size=SHAPE), 0.6
    misfit = Misfit(SOFT, FRAMES, torch.float64)

    def through(x):
        state = torch.as_tensor(x)
        return miss_of(SOFT, (state + (1 - t) * bent(state, t)).numpy())

    x1_hat, slope = predict(bent, misfit, torch.as_tensor(x_t), t, None, "network")
    places = RANDOM.choice(SIZE, 15, replace=False)
    np.testing.assert_allclose(
        slope.numpy().ravel()[places], differences(through, x_t, places), atol=1e-7
    )
    assert not x1_hat.requires_grad
    _, cheap = predict(bent, misfit, torch.as_tensor(x_t), t, None, "endpoint")
    torch.testing.assert_close(cheap, misfit.gradient(x1_hat))
    frame_of_rows = np.flatnonzero(cheap.numpy().any((0, 2, 3)))
    assert frame_of_rows.tolist() == [1, 2, 3]
    assert np.abs(slope.numpy()[0, 2, 5]).min() > 1e-6  # a knee that no row looks at moves as well
    assert not cheap.numpy()[0, 2, 5].any()


@pytest.mark.parametrize("scale", [0.3, 4.0])
@pytest.mark.parametrize("through", ["network", "endpoint"])
def test_dps_is_ancestral_sampling_and_a_push_that_stops_where_it_arrives(through, scale):
    wish = PINS if through == "endpoint" else ROWS
    steps, states = replayed(wish=wish, method="dps", scale=scale, through=through)
    noise, misfit, capped = fresh_noise(), Misfit(wish, FRAMES, torch.float64), 0
    longest = scale / np.linalg.eigvalsh(dense(wish)[0] @ dense(wish)[0].T)[-1]
    next(noise)
    for step, x_next, fresh in zip(steps, states, noise, strict=False):
        t, t_next = step.t, step.t_next
        slope = predict(velocity, misfit, step.x_t, t, None, through)[1].numpy()
        r = t * (1 - t_next) / (t_next * (1 - t))
        x_t, x1_hat = step.x_t.numpy(), step.x1_hat.numpy()
        arrives = 2 * miss_of(wish, x1_hat) / max(np.sum(slope**2), 1e-20)
        capped += arrives < longest
        mean = t_next * x1_hat + (1 - t_next) * r * (x_t - t * x1_hat) / (1 - t)
        spread = (1 - t_next) * np.sqrt(1 - r**2) * fresh
        expected = mean + spread - min(longest, arrives) * slope
        np.testing.assert_allclose(x_next, expected, atol=1e-11)
    if through == "endpoint":
        assert capped == (0 if scale < 1 else len(steps))  # on pins a push of 1 arrives


def test_no_scale_makes_dps_diverge():
    wild = sample(SOFT, method="dps", scale=1e6, batch=4).positions
    assert np.abs(wild).max() < 20


@pytest.mark.parametrize("method", ["dps", "flowdps", "flowchef"])
def test_pulled_samples_come_nearer(method):
    free = sample(None, batch=8).positions
    near = sample(SOFT, method=method, batch=8).positions
    assert miss_each(near).mean() < 0.3 * miss_each(free).mean()


def miss_each(positions):
    return np.array([miss_of(SOFT, x) for x in positions])


def test_dno_finds_noise_that_leads_there():
    steps, settings = [], {"iterations": 60, "solver_steps": 4, "rate": 0.2, "decorrelate": 0.0}
    end = sample(REACHABLE, method="dno", callback=steps.append, **settings)
    misses = [step.residual for step in steps]
    assert len(misses) == 60
    assert end.residual < 0.1 * misses[0]
    np.testing.assert_array_equal(steps[0].x_t.numpy(), next(fresh_noise()))
    # What it looks at is a sample of the flow: its noise, through the same few steps.
    few = thinned(flow_times(STEPS), 4)
    assert few == flow_times(STEPS)[::2]
    for step in (steps[0], steps[-1]):
        torch.testing.assert_close(euler(velocity, step.x_t, few), step.x1_hat, atol=1e-12, rtol=0)
    again = sample(REACHABLE, method="dno", **settings)
    np.testing.assert_array_equal(end.positions, again.positions)


def test_dno_saves_memory_without_changing_anything():
    plain, saving = (
        sample(ROWS, method="dno", prior=bent, save_memory=save) for save in (False, True)
    )
    np.testing.assert_array_equal(plain.positions, saving.positions)


def test_dno_searches_for_every_motion_alone():
    x0 = STD * torch.as_tensor(RANDOM.normal(size=(3, *SHAPE[1:])))
    misfit, times = Misfit(ROWS, FRAMES, torch.float64), flow_times(STEPS)
    together = dno(velocity, misfit, x0, times, iterations=5, noise_std=STD)
    for k in range(3):
        alone = dno(velocity, misfit, x0[k : k + 1], times, iterations=5, noise_std=STD)
        torch.testing.assert_close(together[k : k + 1], alone, atol=1e-9, rtol=0)


def test_dno_takes_correlation_out_of_its_noise():
    x0 = STD * torch.as_tensor(RANDOM.normal(size=SHAPE).cumsum(1) / 2)
    left = []
    for weight in (0.0, 1e6):
        steps = []
        dno(
            velocity, Misfit(ROWS, FRAMES, torch.float64), x0, flow_times(4), iterations=40,
            decorrelate=weight, noise_std=STD, callback=steps.append,
        )  # fmt: skip
        left.append(correlation(steps[-1].x_t / STD).item() / correlation(x0 / STD).item())
    assert left[1] < 0.5 < left[0]


def test_the_correlation_of_noise_by_hand():
    """Frames 1, 2, 3, 4 everywhere: neighbours 4·1, 1·2, 2·3, 3·4, mean 6; halved, 1.5 and 3.5,
    there are only two frames and the search for correlations ends."""
    z = torch.tensor([1.0, 2, 3, 4]).view(1, 4, 1, 1).expand(1, 4, 22, 3)
    torch.testing.assert_close(correlation(z), torch.tensor([36.0]))
    calm = torch.randn(1, 64, 22, 3, generator=torch.Generator().manual_seed(0))
    smooth = calm.cumsum(1) / 4
    assert correlation(calm) < 0.01 * correlation(smooth)


def test_the_rate_warms_up_and_fades():
    shares = [share_of_rate(k, 100) for k in range(100)]
    assert shares[0] == pytest.approx(0.1)
    assert np.all(np.diff(shares[:10]) > 0)
    assert np.all(np.diff(shares[9:]) < 0)
    assert shares[-1] < 1e-3
    assert thinned([0.0, 0.3, 1.0], 10) == [0.0, 0.3, 1.0]
