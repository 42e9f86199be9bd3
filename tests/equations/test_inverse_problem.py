import numpy as np
import pytest
import scipy.stats
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize

from projflow_lite import equations as eq

from .bodies import random_problem


def test_vector_order_is_frame_then_joint_then_axis():
    N, J = 4, 5
    x = np.arange(N * J * 3.0).reshape(N, J, 3)
    flat = eq.vectorise(x)
    for n in range(N):
        for j in range(J):
            for c in range(3):
                assert flat[(n * J + j) * 3 + c] == x[n, j, c]


@given(st.integers(0, 2), st.integers(1, 4), st.integers(1, 4))
def test_vectorise_and_unvectorise_undo_each_other(batch_axes, frames, joints):
    shape = (2,) * batch_axes + (frames, joints, 3)
    x = np.random.default_rng(0).normal(size=shape)
    np.testing.assert_array_equal(eq.unvectorise(eq.vectorise(x), frames, joints), x)


def test_observe_entry_by_entry():
    rng = np.random.default_rng(0)
    x, A, noise = rng.normal(size=5), rng.normal(size=(3, 5)), rng.normal(size=3)
    for row, y in enumerate(eq.observe(x, A, noise)):
        by_hand = sum(float(A[row, i]) * float(x[i]) for i in range(5)) + noise[row]
        assert y == pytest.approx(by_hand, abs=1e-14)
    assert eq.observe(x, np.zeros((0, 5)), []).shape == (0,)


def test_observations_scatter_as_the_likelihood_says():
    rng, n = np.random.default_rng(1), 100_000
    x, A, _, _, Sigma = random_problem(1)
    noise = rng.multivariate_normal(np.zeros(3), Sigma, size=n)
    y = np.stack([eq.observe(x, A, e) for e in noise[:2000]])
    # The mean log density under the truth is minus the Gaussian's entropy.
    scores = [eq.log_likelihood(value, x, A, Sigma) for value in y]
    entropy = scipy.stats.multivariate_normal(np.zeros(3), Sigma).entropy()
    assert abs(np.mean(scores) + entropy) < 4 * np.std(scores) / np.sqrt(len(scores))


def test_squared_norm_by_double_sum():
    rng = np.random.default_rng(2)
    u, W = rng.normal(size=4), rng.normal(size=(4, 4))
    by_hand = sum(float(u[i] * W[i, j] * u[j]) for i in range(4) for j in range(4))
    assert eq.squared_norm(u, W) == pytest.approx(by_hand, rel=1e-13)


def test_objective_symbolically():
    d1, d2, y, s, r1, r2, r12 = sp.symbols("d1 d2 y s r1 r2 r12")
    misfit = y - (2 * (1 + d1) - (3 + d2))
    price = (r1 * d1**2 + 2 * r12 * d1 * d2 + r2 * d2**2 + misfit**2 / s) / 2
    values = {d1: 0.3, d2: -0.4, y: 1.7, s: 0.2, r1: 2, r2: 1.5, r12: 0.4}
    ours = eq.projection_objective(
        [0.3, -0.4], [1, 3], [[2, -1]], [1.7], [[2, 0.4], [0.4, 1.5]], [[0.2]]
    )
    assert ours == pytest.approx(float(price.subs(values)), rel=1e-14)


def test_minimiser_of_the_objective_is_eq_7():
    """A general-purpose optimiser that knows nothing of eq. 7 must end up there."""
    for seed in range(5):
        x1_hat, A, y, R, Sigma = random_problem(seed)
        found = minimize(
            eq.projection_objective, np.zeros(7), args=(x1_hat, A, y, R, Sigma),
            method="BFGS", options={"gtol": 1e-9},
        )  # fmt: skip
        expected = eq.projection_correction(x1_hat, A, y, R, Sigma)
        np.testing.assert_allclose(found.x, expected, rtol=0, atol=1e-5)
        assert eq.projection_objective(expected, x1_hat, A, y, R, Sigma) <= found.fun + 1e-12


def test_objective_curves_upwards_everywhere():
    x1_hat, A, y, R, Sigma = random_problem(3)
    rng = np.random.default_rng(3)
    for _ in range(20):
        a, b = rng.normal(size=(2, 7))
        f = [eq.projection_objective(u, x1_hat, A, y, R, Sigma) for u in (a, (a + b) / 2, b)]
        assert f[1] < (f[0] + f[2]) / 2


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: eq.vectorise(np.zeros((4, 2))), "frames, joints, 3"),
        (lambda: eq.unvectorise(np.zeros(7), 2, 1), "does not end in"),
        (lambda: eq.observe([1.0, 2.0], np.eye(3), np.zeros(3)), r"A has shape \(3, 3\)"),
        (lambda: eq.log_prior([0.0], [0.0], [[-1.0]]), "R is not positive definite"),
        (lambda: eq.log_prior([0.0, 0.0], [0.0, 0.0], [[1.0, 1.0], [0.0, 1.0]]), "symmetric"),
        (lambda: eq.log_likelihood([0.0], [0.0], [[1.0]], [[0.0]]), "use eq. 7"),
        (
            lambda: eq.projection_objective([0.0], [0.0], [[1.0]], [1.0], [[1.0]], [[0.0]]),
            "use eq. 7",
        ),
        (lambda: eq.map_objective([0.0], [0.0], [[1.0]], [1.0], [[1.0]], [[0.0]]), "use eq. 7"),
    ],
)
def test_wrong_arguments_are_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()
