import re

import numpy as np
import pytest

from projflow_lite import equations as eq

ROWS = [2, 0]
MEAN, COVARIANCE = np.array([0.3, -0.4]), np.array([[1.0, 0.6], [0.6, 0.8]])


def test_taking_and_filling_entry_by_entry():
    rng = np.random.default_rng(0)
    x, z = rng.normal(size=(2, 5, 3)), rng.normal(size=(2, 2, 3))
    taken, filled = np.zeros((2, 2, 3)), np.zeros((2, 5, 3))
    for k, i in np.ndindex(2, 3):
        for place, row in enumerate(ROWS):
            taken[k, place, i] = x[k, row, i]
            filled[k, row, i] = z[k, place, i]
    assert np.array_equal(eq.take_trajectory(x, ROWS), taken)
    assert np.array_equal(eq.fill_trajectory(z, ROWS, 5), filled)


def test_filling_is_the_transpose_of_taking():
    rng = np.random.default_rng(1)
    x, z = rng.normal(size=(5, 3)), rng.normal(size=(2, 3))
    assert (eq.take_trajectory(x, ROWS) * z).sum() == pytest.approx(
        (x * eq.fill_trajectory(z, ROWS, 5)).sum()
    )


def test_goal_of_a_motion_sees_its_trajectory_alone():
    rng = np.random.default_rng(2)
    x = rng.normal(size=(5, 3))
    by_hand = sum(x[row, i] ** 2 * (i + 1) for row in ROWS for i in range(3))

    def goal(z):
        return (z**2 * [1, 2, 3]).sum()

    assert eq.motion_goal(x, goal, ROWS) == pytest.approx(by_hand)
    elsewhere = x + [[0], [9], [0], [9], [9]]
    assert eq.motion_goal(elsewhere, goal, ROWS) == eq.motion_goal(x, goal, ROWS)


def assert_moments(samples, mean, variance):
    """Sample mean and variance of one coordinate within five standard errors."""
    assert abs(samples.mean() - mean) < 5 * samples.std() / np.sqrt(len(samples))
    fourth = ((samples - samples.mean()) ** 4).mean() - samples.var() ** 2
    assert abs(samples.var() - variance) < 5 * np.sqrt(fourth / len(samples))


def test_conditioning_finds_the_gaussian_posterior():
    """A motion of two features; the second is the trajectory and should be at 0.7."""
    rng = np.random.default_rng(3)
    samples = rng.multivariate_normal(MEAN, COVARIANCE, size=60_000)[:, :, None]

    def goal(x):
        return eq.motion_goal(x, lambda z: abs(z[0, 0] - 0.7), [1])

    kept = eq.goal_conditioned(samples, goal, 0.05)[:, 0, 0]
    assert len(kept) > 1000
    mean, covariance = eq.gaussian_posterior(MEAN, COVARIANCE, [[0, 1]], [0.7], [[0]])
    assert_moments(kept, mean[0], covariance[0, 0])
    everything = eq.goal_conditioned(samples, goal, 100)
    assert np.array_equal(everything, samples)
    assert eq.goal_conditioned(samples[:5], goal, 0).shape == (0, 2, 1)


def test_two_goals_with_the_same_zeros_condition_differently():
    """x2 = 0 and x2 / x1 = 0 are one line; given the first, x1 has variance 1, else 2."""
    rng = np.random.default_rng(4)
    samples = rng.normal(size=(60_000, 2, 1))
    height = eq.goal_conditioned(samples, lambda x: abs(x[1, 0]), 0.04)[:, 0, 0]
    slope = eq.goal_conditioned(samples, lambda x: abs(x[1, 0] / x[0, 0]), 0.04)[:, 0, 0]
    assert_moments(height, 0, 1)
    assert_moments(slope, 0, 2)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: eq.take_trajectory(np.zeros((3, 4)), [3]), "row 3 is outside 0..2"),
        (lambda: eq.take_trajectory(np.zeros((3, 4)), [1, 1]), "named twice"),
        (lambda: eq.take_trajectory(np.zeros(4), [1]), "expected (..., features, steps)"),
        (lambda: eq.fill_trajectory(np.zeros((3, 4)), [0, 1], 5), "z has 3 features, expected 2"),
        (lambda: eq.goal_conditioned(np.zeros((1, 2, 2)), np.sum, -1), "tolerance is -1"),
    ],
)
def test_mistakes_are_named(call, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        call()
