"""Samplers on a flow whose answer is known: Gaussian noise to Gaussian motion."""

from itertools import pairwise

import numpy as np
import pytest
import sympy
import torch

import projflow_lite as pf
from projflow_lite import equations
from projflow_lite.samplers import euler, flow_times, guided, projflow
from projflow_lite.samplers.euler import lead
from projflow_lite.samplers.projflow import fresh_share

MEAN = torch.randn(12, 22, 3, generator=torch.Generator().manual_seed(1), dtype=torch.float64)
NOISE_STD, DATA_STD = 0.7, 0.2


def gaussian_velocity(x_t, t, text=None):
    """Exact velocity for noise N(0, 0.7²) and motions N(MEAN, 0.2²)."""
    gain = t * DATA_STD**2 / ((1 - t) ** 2 * NOISE_STD**2 + t**2 * DATA_STD**2)
    mean = MEAN.to(x_t.dtype)
    return (mean + gain * (x_t - t * mean) - x_t) / (1 - t)


gaussian_velocity.noise_std = NOISE_STD


def sample(wish=None, **options):
    return pf.sample(gaussian_velocity, wish, frames=12, **({"steps": 20} | options))


def test_euler_reaches_the_data():
    motion = sample(batch=400, steps=200, dtype=torch.float64)
    error = motion.positions - MEAN.numpy()
    count = error.size
    assert abs(error.mean()) < 4 * DATA_STD / np.sqrt(count)
    assert error.std() == pytest.approx(DATA_STD, rel=0.02)


def test_without_wish_or_fresh_noise_the_recomposition_is_an_euler_step():
    x0 = torch.randn(2, 12, 22, 3, dtype=torch.float64)
    times = [0.0, 0.3, 0.55, 0.8, 1.0]
    ours = projflow(gaussian_velocity, lambda x, t: x, x0, times, torch.Generator(), eta=0.0)
    torch.testing.assert_close(ours, euler(gaussian_velocity, x0, times), atol=1e-12, rtol=0)


@pytest.mark.parametrize("noise", ["original", "implied"])
def test_every_step_is_the_equations(noise):
    """Replay each step in numpy from what the callback saw, drawing the same fresh noise."""
    wish, steps = pf.pin("head", [2, 9], [[1, 2, 3], [4, 5, 6]]), []
    common = {"callback": steps.append, "dtype": torch.float64, "seed": 5}
    sample(wish, noise=noise, eta="paper", solver="euler", **common)
    random = torch.Generator().manual_seed(5)
    shape = (1, 12, 22, 3)
    x0 = NOISE_STD * torch.randn(shape, generator=random, dtype=torch.float64).numpy()
    assert len(steps) == 20
    np.testing.assert_array_equal(steps[0].x_t.numpy(), x0)
    for step, following in pairwise(steps):
        x_t, v = step.x_t.numpy(), gaussian_velocity(step.x_t, step.t).numpy()
        x1_hat = equations.tweedie_endpoint(x_t, v, step.t)
        np.testing.assert_allclose(step.x1_hat.numpy(), x1_hat, atol=1e-12)
        fresh = NOISE_STD * torch.randn(shape, generator=random, dtype=torch.float64).numpy()
        source = x0 if noise == "original" else x_t - step.t * v
        mixed = equations.mix_noise(source, fresh, eta=step.t_next)
        expected = equations.recompose(step.x1_projected.numpy(), mixed, step.t_next)
        np.testing.assert_allclose(following.x_t.numpy(), expected, atol=1e-12)


@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
@pytest.mark.parametrize("share", [1, 2, 5, 0.25, 1.0])
@pytest.mark.parametrize("joints", [["left_wrist"], ["pelvis", "head", "right_foot"]])
@pytest.mark.parametrize("steps", [1, 7])
def test_pins_are_met_exactly(dtype, share, joints, steps):
    random = np.random.default_rng(0)
    count = share if isinstance(share, int) else round(share * 12)
    frames = random.choice(12, count, replace=False)
    target = random.normal(size=(count, len(joints), 3))
    motion = sample(pf.pin(joints, frames, target), steps=steps, dtype=dtype, batch=2)
    assert motion.residual <= (1e-12 if dtype == torch.float64 else 1e-6)


def spread_away_from_the_pin(**options):
    """Mean and spread of coordinates that the wish leaves alone and that do not depend on it."""
    wish = pf.pin("left_wrist", 3, [2, 2, 2])
    error = (sample(wish, batch=150, guides=False, **options).positions - MEAN.numpy())[:, 8]
    assert abs(error.mean()) < 4 * DATA_STD / np.sqrt(error.size)
    return error.std()


def test_without_fresh_noise_what_a_pin_leaves_free_keeps_its_spread():
    spread = spread_away_from_the_pin(noise="implied", eta=0.0, steps=200)
    assert spread == pytest.approx(DATA_STD, rel=0.03)


def test_fresh_noise_narrows_the_samples():
    """A finding to teach: the paper's schedule draws too close to the mean, with any step count.

    Noising the mean again, instead of a draw around it, loses the spread that the draw would have.
    """
    for steps in (20, 200):
        narrow = spread_away_from_the_pin(eta="paper", steps=steps, solver="euler")
        assert narrow < 0.85 * DATA_STD


def test_looking_ahead_gives_the_spread_back():
    """What a step loses by noising the mean again, the next one's extrapolation finds missing."""
    for steps in (10, 20, 200):
        for eta in (0.0, "paper"):
            spread = spread_away_from_the_pin(eta=eta, steps=steps)
            assert spread == pytest.approx(DATA_STD, rel=0.05)


def test_half_a_step_ahead_is_what_the_spread_needs():
    """Notebook 04: where variance settles near t = 1, as a function of how far a step looks ahead.

    A step is x' = x - u w x + h u (x - before) + noise of variance c² w eta, with eta = u (2 - u).
    """
    u, w, h, c, V, C = sympy.symbols("u w h c V C", positive=True)  # C: covariance of neighbours
    first, second, noise = 1 - u * w + h * u, -h * u, c**2 * w * u * (2 - u)
    settled = sympy.solve(
        [
            (first**2 + second**2) * V + 2 * first * second * C + noise - V,
            first * V + second * C - C,
        ],
        [V, C],
    )[V]
    limit = sympy.limit(settled, w, 0)
    assert sympy.simplify(limit - c**2 * (2 - u) / (2 - 2 * h * u)) == 0
    assert sympy.simplify(limit.subs(h, sympy.Rational(1, 2)) - c**2) == 0
    assert lead(0.5, 0.501) / 0.001 == pytest.approx(0.5, abs=1e-3)


def test_diffusions_share_of_fresh_noise_keeps_the_spread():
    few, many = (spread_away_from_the_pin(eta="ddpm", steps=n, solver="euler") for n in (20, 200))
    assert many == pytest.approx(DATA_STD, rel=0.03)
    assert abs(few - DATA_STD) > abs(many - DATA_STD)


def test_diffusions_share_is_the_equations():
    grid = np.linspace(0, 1, 12)[1:-1]
    for t, t_next in pairwise(grid):
        assert fresh_share("ddpm", t, t_next) == pytest.approx(
            float(equations.ddpm_noise_share(t, t_next)), rel=1e-12
        )
    assert fresh_share("ddpm", 0.0, 0.1) == fresh_share("ddpm", 0.9, 1.0) == 1


def test_the_original_noise_without_fresh_noise_widens_them_with_every_step():
    """Adding all of x0 back at each step piles it up."""
    few, many = (spread_away_from_the_pin(noise="original", eta=0.0, steps=n) for n in (20, 80))
    assert many > 1.4 * few > 1.4 * DATA_STD


def test_a_callback_sees_variances_and_residuals():
    wish, steps = pf.pin("head", [2, 9], [[1, 2, 3], [4, 5, 6]]), []
    sample(wish, callback=steps.append, dtype=torch.float64)
    assert max(step.residual for step in steps) < 1e-12
    assert [step.variance.shape for step in steps] == [(1, 36)] * 20
    soft = torch.stack([step.variance[0, 6:] for step in steps])
    assert torch.isinf(soft).sum(1).diff().min() >= 0  # the halo only shrinks
    assert not steps[3].variance[0, :6].any()
    plain = []
    sample(pf.pin("head", 2, [1, 2, 3], std=0.1), callback=plain.append)
    torch.testing.assert_close(plain[0].variance, torch.full((1, 3), 0.01))


def test_times_may_be_given():
    wish = pf.pin("head", 3, [0, 1, 2])
    even = sample(wish, steps=4).positions
    np.testing.assert_array_equal(even, sample(wish, steps=flow_times(4, 3)).positions)
    assert flow_times(4) == [0, 0.4375, 0.75, 0.9375, 1]
    uneven = sample(wish, steps=np.array([0, 0.5, 0.8, 0.95, 1.0]))
    assert uneven.residual < 1e-6
    assert np.abs(even - uneven.positions).max() > 1e-3


def test_every_method_has_its_pace():
    """Ten cubic multistep calls for projflow and without a wish; 25 of Euler's for the others."""
    wish, asked = pf.pin("head", 3, [0, 1, 2]), []

    def counted(x_t, t, text=None):
        asked.append(t)
        return gaussian_velocity(x_t, t)

    counted.noise_std = NOISE_STD
    calls = {}
    for name, wanted, method in (("free", None, "projflow"), ("projflow", wish, "projflow"),
                                 ("ddnm", wish, "ddnm"), ("gmd", wish, "gmd")):  # fmt: skip
        asked.clear()
        pf.sample(counted, wanted, frames=12, method=method)
        calls[name] = list(asked)
    assert calls["free"] == calls["projflow"] == flow_times(10, 3)[:-1]
    assert calls["ddnm"] == calls["gmd"] == flow_times(25)[:-1]


def test_without_being_asked_no_noise_is_fresh():
    wish = pf.pin("head", 3, [0, 1, 2])
    usual, drawn = sample(wish).positions, sample(wish, eta="paper").positions
    np.testing.assert_array_equal(usual, sample(wish, eta=0.0).positions)
    assert np.abs(usual - drawn).max() > 1e-3


def test_a_solver_is_chosen_by_name():
    wish = pf.pin("head", 3, [0, 1, 2])
    usual, plain = sample(wish), sample(wish, solver="euler")
    np.testing.assert_array_equal(usual.positions, sample(wish, solver="multistep").positions)
    assert np.abs(usual.positions - plain.positions).max() > 1e-3


def test_the_seed_decides():
    wish = pf.pin("head", 0, [0, 2, 0])
    first, again, other = sample(wish, seed=1), sample(wish, seed=1), sample(wish, seed=2)
    np.testing.assert_array_equal(first.positions, again.positions)
    assert np.abs(first.positions - other.positions).max() > 0.01


def test_a_batch_has_a_batch_dimension_and_one_motion_has_none():
    assert sample().positions.shape == (12, 22, 3)
    assert sample(batch=3, prompt=["a", "b", "c"]).positions.shape == (3, 12, 22, 3)


def test_guidance_is_the_line_through_two_velocities():
    def velocity(x_t, t, text=None):
        prompts = text if isinstance(text, list) else [text] * len(x_t)
        return torch.stack(
            [torch.full_like(x, len(p or "")) for x, p in zip(x_t, prompts, strict=True)]
        )

    x = torch.zeros(2, 3, 22, 3)
    for scale in (0.0, 0.5, 1.0, 3.0):
        v = guided(velocity, scale)(x, 0.5, ["four", "sixsix"])
        torch.testing.assert_close(v[:, 0, 0, 0], scale * torch.tensor([4.0, 6.0]))
    assert not guided(velocity, 3.0)(x, 0.5, None).any()


WRONG = [
    (lambda: sample(pf.pin("head", 12, [0, 0, 0])), "pin: frame 12 is outside 0..11"),
    (
        lambda: sample(pf.pin("head", [1, 1], [[0, 0, 0], [0, 0, 1]])),
        "rows 2 and 5 contradict each other: head, frame 1, z = 0 and 1",
    ),
    (
        lambda: sample(method="projflo"),
        "sample: method is one of projflow, gmd, gmd_keyframes, ddnm, replacement, imputation, flowdps, pnp_flow, flowchef, dps, dno, control_branch, condmdi, not 'projflo'",
    ),
    (lambda: sample("left_wrist"), "sample: wish is made by pin and its neighbours, not a str"),
    (lambda: sample(steps=0), "sample: steps is a whole number of at least 1, not 0"),
    (lambda: sample(steps=2.5), "sample: steps is a whole number of at least 1, not 2.5"),
    (lambda: sample(steps=True), "sample: steps is a whole number of at least 1, not True"),
    (lambda: sample(steps="20"), "sample: steps is a whole number of at least 1, not '20'"),
    (
        lambda: sample(steps=[0, 0.5]),
        "sample: steps is a whole number, or flow times that rise from 0 to 1",
    ),
    (
        lambda: sample(steps=[0, 0.6, 0.5, 1]),
        "sample: steps is a whole number, or flow times that rise from 0 to 1",
    ),
    (
        lambda: sample(eta=0.5),
        "sample: without a wish there is no eta; leave it out, or add a wish",
    ),
    (lambda: sample(batch=0), "sample: batch is a whole number of at least 1, not 0"),
    (
        lambda: sample(guidance=float("nan")),
        "sample: guidance is a number, usually 0 to 5, not nan",
    ),
    (
        lambda: sample(noise="orignal", wish=pf.loop()),
        "projflow: noise is 'original' or 'implied', not 'orignal'",
    ),
    (
        lambda: pf.sample(None),
        "sample: prior is a callable velocity(x_t, t, text); try pf.load_prior()",
    ),
    (lambda: sample(seed="a"), "sample: seed is a whole number, not 'a'"),
    (
        lambda: sample(dtype=torch.int32),
        "sample: dtype is torch.float32 or torch.float64, not torch.int32",
    ),
    (lambda: sample(guides=3), "sample: guides is True, False or GuideSettings(...), not 3"),
    (lambda: sample(guidance="x"), "sample: guidance is a number, usually 0 to 5, not 'x'"),
    (lambda: sample(eta=1.5, wish=pf.loop()), "projflow: eta is a share of 0 to 1, not 1.5"),
    (
        lambda: sample(eta="papper", wish=pf.loop()),
        "projflow: eta is 'paper', 'ddpm', a number or a function, not 'papper'",
    ),
]


@pytest.mark.parametrize(("make", "message"), WRONG, ids=[m for _, m in WRONG])
def test_wrong_arguments_say_what_and_what_to_do(make, message):
    with pytest.raises(ValueError, match=".") as caught:
        make()
    assert str(caught.value) == message
