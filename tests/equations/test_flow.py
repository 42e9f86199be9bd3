import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from projflow_lite import equations as eq


def test_flow_map_meets_the_known_solution_of_a_rotating_field():
    # dx/dt = a x with a rotation: x(t) = exp(a t) x0, known without any solver.
    omega, x0 = 2.0, np.array([1.0, 0.5])

    def field(x, t):
        return omega * np.array([-x[1], x[0]])

    exact = np.array([[np.cos(omega), -np.sin(omega)], [np.sin(omega), np.cos(omega)]]) @ x0
    errors = [
        np.linalg.norm(eq.flow_map(field, x0, np.linspace(0, 1, n + 1))[-1] - exact)
        for n in (200, 400, 800)
    ]
    assert errors[-1] < 4e-3
    # A method of first order halves its error when the step is halved.
    np.testing.assert_allclose([errors[0] / errors[1], errors[1] / errors[2]], 2, rtol=0.02)


def test_flow_map_uses_the_time_it_is_at():
    # dx/dt = 2 t; Euler from the left gives the sum of 2 t_k dt, by hand 0 + 0.5 * 0.5.
    path = eq.flow_map(lambda x, t: np.full_like(x, 2 * t), np.zeros(2), [0, 0.5, 1])
    np.testing.assert_allclose(path, [[0, 0], [0, 0], [0.5, 0.5]], rtol=0, atol=0)


def test_flow_map_starts_where_it_is_told():
    np.testing.assert_array_equal(eq.flow_map(lambda x, t: x, [3.0], [0.0]), [[3.0]])
    with pytest.raises(ValueError, match="times must increase"):
        eq.flow_map(lambda x, t: x, [3.0], [0.0, 0.0])
    with pytest.raises(ValueError, match="velocity has shape"):
        eq.flow_map(lambda x, t: np.zeros((2, 2)), np.zeros(2), [0, 1])


def test_interpolate_coordinate_by_coordinate():
    rng = np.random.default_rng(0)
    x0, x1, t = rng.normal(size=(3, 2, 4, 3)), rng.normal(size=(3, 2, 4, 3)), [0, 0.3, 1]
    x_t = eq.interpolate(x0, x1, t)
    for index in np.ndindex(x_t.shape):
        a, b, s = float(x0[index]), float(x1[index]), t[index[0]]
        assert x_t[index] == pytest.approx(a + s * (b - a), abs=1e-15)
    np.testing.assert_array_equal(x_t[0], x0[0])
    np.testing.assert_array_equal(x_t[2], x1[2])


def test_interpolate_has_the_straight_velocity_everywhere():
    rng = np.random.default_rng(1)
    x0, x1, h = rng.normal(size=5), rng.normal(size=5), 1e-6
    for t in (0.1, 0.5, 0.9):
        slope = (eq.interpolate(x0, x1, t + h) - eq.interpolate(x0, x1, t - h)) / (2 * h)
        np.testing.assert_allclose(slope, x1 - x0, rtol=0, atol=1e-9)


def test_flow_matching_loss_by_hand():
    x0, x1 = np.array([[0.0, 0.0], [1.0, 1.0]]), np.array([[1.0, 2.0], [1.0, 1.0]])
    v = np.array([[1.0, 0.0], [3.0, -4.0]])
    # Sample 1 misses (1, 2) by (0, -2): 4. Sample 2 misses (0, 0) by (3, -4): 25. Mean 14.5.
    assert eq.flow_matching_loss(v, x0, x1) == pytest.approx(14.5)
    assert eq.flow_matching_loss(x1 - x0, x0, x1) == 0


def test_flow_matching_loss_is_least_at_the_conditional_mean():
    # x0, x1 independent standard normals. Regressing x1 - x0 on x_t gives
    # E[x1 - x0 | x_t] = (2t - 1) / ((1 - t)^2 + t^2) x_t; its loss is the residual variance.
    rng, n = np.random.default_rng(2), 200_000
    x0, x1, t = rng.normal(size=(n, 1)), rng.normal(size=(n, 1)), 0.3
    x_t, spread = eq.interpolate(x0, x1, t), (1 - t) ** 2 + t**2
    best = (2 * t - 1) / spread
    squared = (best * x_t - (x1 - x0)) ** 2
    standard_error = squared.std() / np.sqrt(n)
    losses = [eq.flow_matching_loss((best + e) * x_t, x0, x1) for e in (-0.1, 0, 0.1)]
    assert abs(losses[1] - 1 / spread) < 4 * standard_error
    assert losses[1] < min(losses[0], losses[2])


def test_tweedie_endpoint_and_implied_noise_undo_the_interpolation():
    x0, x1, t = sp.symbols("x0 x1 t")
    x_t = (1 - t) * x0 + t * x1
    v = sp.diff(x_t, t)
    ends = [sp.lambdify((x0, x1, t), e) for e in (x_t, v, x_t + (1 - t) * v, x_t - t * v)]
    assert sp.expand(x_t + (1 - t) * v - x1) == 0
    assert sp.expand(x_t - t * v - x0) == 0
    a, b, s = np.array([0.2, -1.0]), np.array([3.0, 0.7]), 0.35
    state, velocity, end, start = (f(a, b, s) for f in ends)
    np.testing.assert_allclose(eq.tweedie_endpoint(state, velocity, s), end, rtol=0, atol=1e-15)
    np.testing.assert_allclose(eq.implied_noise(state, velocity, s), start, rtol=0, atol=1e-15)


def test_tweedie_endpoint_is_the_conditional_mean_of_gaussian_data():
    # Data N(mu, s^2). Bin many samples by x_t and compare with the mean of x1 in the bin.
    rng, n, mu, s, t = np.random.default_rng(3), 400_000, 1.5, 0.4, 0.6
    x0, x1 = rng.normal(size=n), mu + s * rng.normal(size=n)
    x_t = eq.interpolate(x0, x1, t)
    spread = (1 - t) ** 2 + t**2 * s**2
    mean_x1 = mu + t * s**2 / spread * (x_t - t * mu)
    v = (mean_x1 - x_t) / (1 - t)  # the exact velocity E[x1 - x0 | x_t]
    x1_hat = eq.tweedie_endpoint(x_t, v, t)
    for low in (0.4, 0.8, 1.2):
        here = (x_t > low) & (x_t < low + 0.1)
        standard_error = x1[here].std() / np.sqrt(here.sum())
        assert abs(x1[here].mean() - x1_hat[here].mean()) < 4 * standard_error


def test_mix_noise_keeps_unit_variance_of_independent_noise():
    rng, n = np.random.default_rng(4), 200_000
    x0, eps = rng.normal(size=n), rng.normal(size=n)
    for eta in (0.0, 0.2, 0.7, 1.0):
        mixed = eq.mix_noise(x0, eps, eta)
        assert abs(mixed.var() - 1) < 4 * np.sqrt(2 / n)
        # The share that survives shows as the correlation with the old noise.
        assert abs(np.corrcoef(mixed, x0)[0, 1] - (1 - eta) ** 0.5) < 4 / np.sqrt(n)
    np.testing.assert_array_equal(eq.mix_noise(x0, eps, 0), x0)
    np.testing.assert_array_equal(eq.mix_noise(x0, eps, 1), eps)


def test_mix_noise_by_hand():
    np.testing.assert_allclose(eq.mix_noise([1.0], [10.0], 0.36), [0.8 + 6.0], rtol=0, atol=1e-15)


def test_implied_noise_is_not_standard_normal():
    """Erratum of eq. 9: the released choice mixes noise of variance below 1."""
    rng, n, t = np.random.default_rng(5), 100_000, 0.5
    x0, x1 = rng.normal(size=n), rng.normal(size=n)
    x_t = eq.interpolate(x0, x1, t)
    v = np.zeros(n)  # E[x1 - x0 | x_t] vanishes at t = 1/2 for equal variances
    noise = eq.implied_noise(x_t, v, t)
    assert noise.var() == pytest.approx(0.5, abs=0.01)  # (1 - t)^2 + t^2
    assert eq.mix_noise(noise, rng.normal(size=n), 0.5).var() == pytest.approx(0.75, abs=0.02)
    assert eq.mix_noise(x0, rng.normal(size=n), 0.5).var() == pytest.approx(1, abs=0.02)


def test_recompose_weighs_data_with_the_next_time():
    np.testing.assert_allclose(eq.recompose([10.0], [1.0], 0.25), [2.5 + 0.75], rtol=0, atol=0)
    np.testing.assert_array_equal(eq.recompose([10.0], [1.0], 1), [10.0])
    np.testing.assert_array_equal(eq.recompose([10.0], [1.0], 0), [1.0])


def test_recompose_without_projection_and_fresh_noise_is_an_euler_step():
    # eta = 0 with the implied noise: the step must agree with following the velocity.
    x_t, v, t, dt = sp.symbols("x_t v t dt")
    endpoint, noise = x_t + (1 - t) * v, x_t - t * v
    step = (t + dt) * endpoint + (1 - t - dt) * noise
    assert sp.expand(step - (x_t + dt * v)) == 0
    rng = np.random.default_rng(6)
    state, velocity = rng.normal(size=(2, 4)), rng.normal(size=(2, 4))
    new = eq.recompose(
        eq.tweedie_endpoint(state, velocity, 0.3),
        eq.mix_noise(eq.implied_noise(state, velocity, 0.3), rng.normal(size=(2, 4)), 0),
        0.4,
    )
    euler = eq.flow_map(lambda x, t: velocity, state, [0.3, 0.4])[-1]
    np.testing.assert_allclose(new, euler, rtol=0, atol=1e-15)


def test_the_schedule_mixes_more_as_noise_falls():
    np.testing.assert_allclose(
        eq.noise_mixing([0.01, 0.5, 1.0]), [0.01, 0.5, 1.0], rtol=0, atol=1e-15
    )


def test_released_time_grid_makes_one_update_less_than_it_says():
    """Erratum of section C.1."""
    assert len(np.diff(eq.time_grid(100))) == 100
    assert len(np.diff(eq.time_grid(100, form="released"))) == 99
    for form in ("derived", "released"):
        grid = eq.time_grid(7, form=form)
        assert (grid[0], grid[-1]) == (0, 1)
        np.testing.assert_allclose(np.diff(grid), grid[1], rtol=0, atol=1e-15)
    np.testing.assert_array_equal(eq.time_grid(1), [0, 1])
    np.testing.assert_array_equal(eq.time_grid(2, form="released"), [0, 1])
    for steps, form in ((0, "derived"), (1, "released"), (2.5, "derived"), (3, "printed")):
        with pytest.raises(ValueError, match="time_grid"):
            eq.time_grid(steps, form=form)


@given(st.integers(0, 4), st.floats(0, 1), st.integers(0, 2**32 - 1))
def test_any_shape_goes_through(axes, t, seed):
    rng = np.random.default_rng(seed)
    x0, x1 = rng.normal(size=(2, *([2] * axes)))
    x_t = eq.interpolate(x0, x1, t)
    assert x_t.shape == (2,) * axes
    np.testing.assert_allclose(eq.tweedie_endpoint(x_t, x1 - x0, t), x1, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: eq.interpolate(np.zeros(3), np.zeros((3, 1)), 0.5), r"x0 \(3,\), x1 \(3, 1\)"),
        (lambda: eq.interpolate(np.zeros(3), np.zeros(3), 1.2), "t = 1.2 is outside 0..1"),
        (lambda: eq.interpolate(np.zeros((2, 3)), np.zeros((2, 3)), [0, 0, 0]), "leading"),
        (lambda: eq.recompose([np.nan], [0.0], 0.5), "x1 has a value that is not finite"),
        (lambda: eq.mix_noise([0.0], [0.0], -0.1), "eta"),
        (lambda: eq.flow_matching_loss(1.0, 0.0, 0.0), "at least one sample"),
        (lambda: eq.flow_matching_loss(*np.zeros((3, 0, 2))), "at least one sample"),
    ],
)
def test_wrong_arguments_are_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()
