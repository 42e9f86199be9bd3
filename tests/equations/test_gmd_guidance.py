import numpy as np
import pytest
from scipy.optimize import approx_fprime

from projflow_lite import equations as eq

ROWS, EMPHASISED = [1, 2], [0, 1, 2]
N, M = 5, 3
TARGET = np.array([[0.5, 1.0, -0.5], [0.0, 0.2, 0.4]])


def goal(z):
    return ((z - TARGET) ** 2).sum() + np.sin(z[0, 0] * z[1, 2])


def goal_gradient(z):
    g = 2 * (z - TARGET)
    slope = np.cos(z[0, 0] * z[1, 2])
    g[0, 0] += slope * z[1, 2]
    g[1, 2] += slope * z[0, 0]
    return g


def setting(seed, c=4.0):
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(N, M))
    mask = eq.imputation_region(rng.integers(0, 2, (2, M)), ROWS, N)
    A = eq.emphasis_matrix(rng.normal(size=(N, N)) + 2 * np.eye(N), EMPHASISED, c)
    return rng, x, mask, A, eq.emphasis_scale(N, EMPHASISED, c)


def numerical(function, x):
    return approx_fprime(x.ravel(), lambda v: function(v.reshape(x.shape)), 1e-7).reshape(x.shape)


def test_goal_step_goes_down_the_numerical_gradient():
    _, x, _, _, _ = setting(0)
    down = x - numerical(lambda u: eq.motion_goal(u, goal, ROWS), x)
    assert np.allclose(eq.goal_step(x, goal_gradient, ROWS), down, atol=1e-5)


def test_goal_step_has_no_step_size():
    """A keyframe one centimetre away: eq. 12 at p = 1 sends the motion a metre in its direction."""
    x, y = np.zeros((N, M)), np.full((2, M), 0.01)
    moved = eq.goal_step(x, lambda z: eq.keyframe_gradient(z, y, np.ones_like(y)), ROWS)
    assert np.array_equal(moved, eq.fill_trajectory(np.ones((2, M)), ROWS, N))


def test_printed_projection_does_not_fit():
    with pytest.raises(ValueError, match="z has 5 features, expected 2"):
        eq.goal_step(np.zeros((N, M)), goal_gradient, ROWS, form="printed")
    with pytest.raises(ValueError, match="z has 5 features, expected 2"):
        eq.state_gradient(np.zeros((N, M)), np.eye(N * M), goal_gradient, ROWS, form="printed")


def test_gradient_through_a_denoiser_by_finite_differences():
    rng, x, _, _, _ = setting(1)
    W = rng.normal(size=(N * M, N * M)) / 4

    def f(x_t):
        return np.tanh(W @ x_t.ravel()).reshape(N, M)

    jacobian = (1 - f(x).ravel() ** 2)[:, None] * W
    ours = eq.state_gradient(f(x), jacobian, goal_gradient, ROWS)
    assert np.allclose(ours, numerical(lambda u: goal(f(u)[ROWS]), x), atol=1e-5)
    assert np.count_nonzero(ours) == N * M  # dense, though the goal sees two rows


def test_guided_mean_entry_by_entry():
    rng, mean, mask, _, _ = setting(2)
    gradient = rng.normal(size=(N, M))
    ours = eq.guided_mean(mean, gradient, mask, s=3.0, variance=0.2)
    for place in np.ndindex(N, M):
        step = 0 if mask[place] else 3.0 * 0.2 * gradient[place]
        assert ours[place] == pytest.approx(mean[place] - step)


def test_guiding_everywhere_and_imputing_the_mean_afterwards_is_the_same():
    """The order of the public code, in projected space, against the order of the paper."""
    rng, x0, mask, A, k = setting(3)
    z, x_t, gradient = rng.normal(size=(2, M)), rng.normal(size=(N, M)), rng.normal(size=(N, M))
    x0_proj, levels = eq.emphasise(x0, A, k), (0.3, 0.6)

    imputed = eq.impute_emphasised(x0_proj, z, mask, ROWS, A, k)
    mean, variance = eq.ddpm_posterior(imputed, x_t, *levels)
    delta = eq.unprojected_step(gradient, A, k, 2.0, variance)
    paper = eq.guided_mean_emphasised(mean, delta, mask, A, k)

    guided = eq.ddpm_posterior(x0_proj, x_t, *levels)[0] - 2.0 * variance * gradient
    both = (np.linalg.solve(k * A, m) for m in (guided, mean))
    code = k * A @ np.where(mask, *reversed(list(both)))
    assert np.allclose(paper, code)


def test_unprojected_step_is_a_gradient_step_in_another_metric():
    """Numerical gradients of one goal, along the projected state and along the motion."""
    _, x, _, A, k = setting(4)

    def of_projected(u):
        return goal(np.linalg.solve(k * A, u)[ROWS])

    along_projected = numerical(of_projected, k * A @ x)
    along_motion = numerical(lambda u: goal(u[ROWS]), x)
    ours = eq.unprojected_step(along_projected, A, k, s=2.0, variance=0.3)
    R = eq.emphasis_metric(A, k)
    assert np.allclose(ours, -2.0 * 0.3 * np.linalg.solve(R, along_motion), atol=1e-4)


def test_emphasised_features_are_pushed_less():
    """With A' orthogonal: c^2 times less than at c = 1, relative to an ordinary feature."""
    rng, _, _, _, _ = setting(5)
    Q, _ = np.linalg.qr(rng.normal(size=(N, N)))
    pushed = {}
    for c in (1.0, 10.0):
        A, k = eq.emphasis_matrix(Q, EMPHASISED, c), eq.emphasis_scale(N, EMPHASISED, c)
        along_projected = np.linalg.solve(k * A.T, np.ones((N, 1)))  # of the sum of all features
        step = eq.unprojected_step(along_projected, A, k, 1.0, 1.0)
        pushed[c] = step[0, 0] / step[4, 0]
    assert pushed[1.0] == pytest.approx(1)
    assert pushed[10.0] == pytest.approx(1 / 100)


def test_imputed_coordinates_stay_and_the_others_follow_the_step():
    rng, mean, mask, A, k = setting(6)
    delta = rng.normal(size=(N, M))
    moved = eq.guided_mean_emphasised(k * A @ mean, delta, mask, A, k)
    motion = np.linalg.solve(k * A, moved)
    assert mask.any()
    assert np.allclose(motion[mask], mean[mask])
    assert np.allclose(motion[~mask], (mean + delta)[~mask])


def test_printed_order_moves_what_is_imputed():
    """By hand: A = [[1, 1], [0, 1]], feature 0 imputed, a step of 1 in both features.

    A (1 - M) is (1, 1), so a step of (2, 1) moves the motion by A^-1 (2, 1) = (1, 1), and what
    was imputed has moved by 1. Masked first, the step is (0, 1).
    """
    A, mask, mean = np.array([[1.0, 1.0], [0.0, 1.0]]), np.array([[1], [0]]), np.zeros((2, 1))
    delta = np.array([[2.0], [1.0]])
    printed = eq.guided_mean_emphasised(mean, delta, mask, A, 1.0, form="printed")
    assert np.allclose(np.linalg.solve(A, printed).ravel(), [1, 1])
    derived = eq.guided_mean_emphasised(mean, delta, mask, A, 1.0)
    assert np.allclose(np.linalg.solve(A, derived).ravel(), [0, 1])


def test_the_factor_cancels_only_if_both_formulas_leave_it_out():
    rng, mean, mask, A, k = setting(7)
    gradient = rng.normal(size=(N, M))
    steps = {f: eq.unprojected_step(gradient, A, k, 1.0, 0.5, f) for f in ("derived", "printed")}
    derived = eq.guided_mean_emphasised(mean, steps["derived"], mask, A, k)
    assert np.allclose(eq.guided_mean_emphasised(mean, steps["printed"], mask, A, 1.0), derived)
    assert not np.allclose(eq.guided_mean_emphasised(mean, steps["printed"], mask, A, k), derived)
    assert np.allclose(steps["printed"], k * steps["derived"])


@pytest.mark.parametrize("variance", [-1.0, np.inf, np.nan])
def test_a_variance_that_is_none_is_refused(variance):
    ones = np.ones((2, 2))
    with pytest.raises(ValueError, match="guided_mean: variance is"):
        eq.guided_mean(ones, ones, ones, 1.0, variance)
    with pytest.raises(ValueError, match="unprojected_step: variance is"):
        eq.unprojected_step(ones, np.eye(2), 1.0, 1.0, variance)


def test_a_form_that_does_not_exist_is_refused():
    ones = np.ones((2, 2))
    with pytest.raises(ValueError, match="form is 'new'"):
        eq.goal_step(ones, np.asarray, [0, 1], form="new")
