"""A metric over time: its walk against integrals and simulation, its limits against eq. 11."""

import numpy as np
import pytest
from scipy import integrate

from projflow_lite import equations as eq


@pytest.mark.parametrize(("a", "b"), [(0, 0), (3, 3), (2, 9), (9, 4)])
def test_walk_is_the_double_integral_of_its_velocity(a, b):
    start, speed, memory, rate = 0.3, 0.7, 1.4, 10.0
    inner, _ = integrate.dblquad(
        lambda u, v: speed**2 * np.exp(-abs(u - v) / memory), 0, a / rate, 0, b / rate
    )
    S = eq.walk_covariance(10, start, speed, memory, rate)
    np.testing.assert_allclose(S[a, b], start**2 + inner, rtol=1e-6)


def test_walk_is_what_simulated_walkers_do():
    rng = np.random.default_rng(0)
    start, speed, memory, rate, fine, walkers = 0.2, 0.5, 0.8, 20.0, 20, 20_000
    step = 1 / (rate * fine)
    keep = np.exp(-step / memory)
    v = speed * rng.normal(size=walkers)
    x = start * rng.normal(size=walkers)
    kept = [x]
    for k in range(1, 19 * fine + 1):
        following = keep * v + np.sqrt(1 - keep**2) * speed * rng.normal(size=walkers)
        x, v = x + step * (v + following) / 2, following
        if k % fine == 0:
            kept.append(x)
    found = np.cov(kept)
    S = eq.walk_covariance(20, start, speed, memory, rate)
    # A covariance of 20 000 draws has an error of about 1 % of the two deviations' product.
    assert np.abs(found - S).max() < 0.04 * S.max()


def test_without_memory_of_place_it_is_the_metric_of_eq_11():
    L = eq.kinematic_laplacian([(0, 1), (1, 2)], 3)
    R_J = eq.joint_metric(L, 10.0, 1.0)
    R = eq.metric_over_time(0.0, np.eye(4), R_J, 0.7)
    np.testing.assert_allclose(
        R / np.linalg.inv(R_J)[0, 0], eq.kinematic_metric(4, L, 10.0, 1.0), rtol=1e-9, atol=1e-9
    )


def test_it_begins_as_the_walk_and_ends_as_no_walk_at_all():
    S, R_J = eq.walk_covariance(6, 0.3, 0.5, 5.0), np.eye(2)
    begin = np.linalg.inv(eq.metric_over_time(0.0, S, R_J, 0.7))[::6, ::6]
    np.testing.assert_allclose(begin, S, rtol=1e-6)
    end = np.linalg.inv(eq.metric_over_time(0.9999, S, R_J, 0.7))[::6, ::6]
    assert np.abs(end - np.diag(np.diag(end))).max() < 0.03 * end.max()


def test_gain_is_gaussian_conditioning():
    """Pinning one frame moves the others by S[other, pinned] / S[pinned, pinned], at t = 0."""
    S, R_J = eq.walk_covariance(5, 0.3, 0.5, 2.0), np.array([[2.0, -1.0], [-1.0, 1.5]])
    A = np.zeros((1, 30))
    A[0, 3 * 6] = 1  # frame 3, joint 0, axis x
    x = eq.project(
        np.zeros(30), A, np.ones(1), eq.metric_over_time(0.0, S, R_J, 0.7), np.zeros((1, 1))
    )
    np.testing.assert_allclose(x.reshape(5, 2, 3)[:, 0, 0], S[:, 3] / S[3, 3], rtol=1e-8)


@pytest.mark.parametrize("t", [0.0, 0.5])
def test_a_long_walk_can_be_projected_with(t):
    """Frames of a smooth walk are nearly the same place, so the inverse of S is badly rounded."""
    S = eq.walk_covariance(60, 0.3, 0.5, 5.0)
    R = eq.metric_over_time(t, S, [[1.0]], 0.76)
    x = eq.project(np.zeros(180), np.eye(180)[[3 * 20]], np.ones(1), R, np.zeros((1, 1)))
    C = np.linalg.solve(np.eye(60) + (t / (1 - t) / 0.76) ** 2 * S, S)
    np.testing.assert_allclose(x[::3], C[:, 20] / C[20, 20], atol=1e-5)


@pytest.mark.parametrize("name", ["start", "speed", "memory"])
def test_walk_refuses_what_is_not_above_0(name):
    given = {"start": 0.3, "speed": 0.5, "memory": 5.0, name: 0.0}
    with pytest.raises(ValueError, match=f"walk_covariance: {name} is above 0"):
        eq.walk_covariance(5, **given)


def test_metric_refuses_what_it_cannot_use():
    S, R_J = eq.walk_covariance(3, 0.3, 0.5, 5.0), np.eye(2)
    with pytest.raises(ValueError, match="noise_std is above 0"):
        eq.metric_over_time(0.5, S, R_J, 0.0)
    with pytest.raises(ValueError, match="R_J"):
        eq.metric_over_time(0.5, S, -R_J, 0.7)
    with pytest.raises(ValueError, match="covariance"):
        eq.metric_over_time(0.5, -S, R_J, 0.7)
