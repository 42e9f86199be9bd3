import numpy as np
import pytest
from scipy.optimize import approx_fprime

from projflow_lite import equations as eq

CENTRES, RADII = np.array([[0.0, 0.0], [2.0, 0.5]]), np.array([1.0, 0.7])


def test_distance_to_points_drawn_on_the_circles():
    """Outside, the nearest of many points on the circles is as far as the formula says."""
    rng = np.random.default_rng(0)
    z = rng.uniform(-3, 4, size=(2, 200))
    angle = np.linspace(0, 2 * np.pi, 2000)
    around = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    points = np.concatenate([c + r * around for c, r in zip(CENTRES, RADII, strict=True)])
    nearest = np.linalg.norm(z.T[:, None] - points, axis=-1).min(axis=1)
    inside = (np.linalg.norm(z.T[:, None] - CENTRES, axis=-1) < RADII).any(axis=1)
    assert 0 < inside.sum() < 200
    signed = np.where(inside, -nearest, nearest)
    assert np.allclose(eq.signed_distance(z, CENTRES, RADII), signed, atol=1e-3)


def test_depth_by_hand():
    """On the x axis: 0.4 is 0.6 deep in the unit circle, 3 and -2 are outside of both."""
    z = np.array([[0.4, 3.0, -2.0], [0.0, 0.0, 0.0]])
    assert eq.obstacle_goal(z, CENTRES, RADII) == pytest.approx(0.6)
    assert eq.obstacle_goal(z, CENTRES, RADII, form="released") == pytest.approx(5 * 0.6 / 3)
    deeper = 1.1 + (0.5 - (np.hypot(1, 0.5) - 0.7))  # 3 is 0.42 outside, -2 is 1 outside
    assert eq.obstacle_goal(z, CENTRES, RADII, margin=0.5) == pytest.approx(deeper)


def test_released_goal_counts_overlapping_circles_twice():
    z, twice, radii = np.zeros((2, 1)), np.zeros((2, 2)), np.ones(2)
    assert eq.obstacle_goal(z, twice, radii) == 1
    assert eq.obstacle_goal(z, twice, radii, form="released") == 10


@pytest.mark.parametrize("margin", [0.0, 0.5])
def test_gradient_by_finite_differences(margin):
    z = np.random.default_rng(1).uniform(-2, 3, size=(2, 20))

    def goal(flat):
        return eq.obstacle_goal(flat.reshape(2, 20), CENTRES, RADII, margin)

    numerical = approx_fprime(z.ravel(), goal, 1e-7).reshape(2, 20)
    assert numerical.any()
    assert np.allclose(eq.obstacle_gradient(z, CENTRES, RADII, margin), numerical, atol=1e-5)
    assert not eq.obstacle_gradient(np.zeros((2, 1)), CENTRES, RADII).any()


@pytest.mark.parametrize("function", [eq.signed_distance, eq.obstacle_goal, eq.obstacle_gradient])
def test_mistakes_are_named(function):
    with pytest.raises(ValueError, match="at least one circle"):
        function(np.zeros((2, 3)), np.zeros((0, 2)), np.zeros(0))
    with pytest.raises(ValueError, match="no negative radius"):
        function(np.zeros((2, 3)), np.zeros((1, 2)), [-1])
    with pytest.raises(ValueError, match=r"centres has shape \(1, 3\)"):
        function(np.zeros((2, 3)), np.zeros((1, 3)), [1])
