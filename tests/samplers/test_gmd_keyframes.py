"""Two stages: lines and planned trajectories, and what the motion makes of them."""

import numpy as np
import pytest
import torch

import projflow_lite as pf
from projflow_lite import equations as eq
from projflow_lite.samplers import Avoid, circles, flow_times, gmd_keyframes, keep_speed, on_ground
from projflow_lite.samplers.gmd_imputation import Imputation, known_coordinates

FRAMES, FPS = 12, 20
KEYS = [0, 4, 11]
PLACES = np.array([[0.0, 0.0], [0.4, 0.5], [-0.2, 1.0]])
WISH = pf.pin("pelvis", KEYS, PLACES, axes="xz")
MEAN = torch.randn(FRAMES, 22, 3, generator=torch.Generator().manual_seed(1), dtype=torch.float64)


def motion_velocity(x_t, t, text=None):
    """Motions whose coordinates are independent, 0.2 m around MEAN; noise of 1 m."""
    gain = t * 0.2**2 / ((1 - t) ** 2 + t**2 * 0.2**2)
    return (MEAN + gain * (x_t - t * MEAN) - x_t) / (1 - t)


class Planner:
    """A stand-in for a trajectory model: walks that wander, exactly.

    The speed is smooth, so trajectories through keyframes are curves.
    """

    noise_std = 0.5

    def __init__(self):
        n = np.arange(FRAMES)
        speed = np.exp(-((n[:, None] - n) ** 2) / 18)
        sums = np.tril(np.ones((FRAMES, FRAMES)), -1)
        self.covariance = 0.05 * sums @ speed @ sums.T + 1e-6 * np.eye(FRAMES)

    def project(self, motion):
        return on_ground(motion)

    def unproject(self, z):
        motion = z.new_zeros(*z.shape[:-1], 22, 3)
        motion[..., 0, [0, 2]] = z
        return motion

    def __call__(self, z_t, t, text=None):
        S = (1 - t) ** 2 * self.noise_std**2 * np.eye(FRAMES) + t**2 * self.covariance
        gain = torch.as_tensor(t * np.linalg.solve(S, self.covariance).T)
        return (gain @ z_t - z_t) / (1 - t)


def sample(wish=WISH, batch=1, steps=10, seed=0, **options):
    generator = torch.Generator().manual_seed(seed)
    shape = (batch, FRAMES, 22, 3)
    x0 = torch.randn(shape, generator=generator, dtype=torch.float64)
    known = known_coordinates(wish, FRAMES, torch.float64)
    return gmd_keyframes(motion_velocity, known, x0, flow_times(steps), generator, **options)


def line():
    z, _ = eq.point_to_point(KEYS, PLACES, FRAMES)
    return z.T


def test_lines_run_over_the_ground_between_keyframes_and_not_beyond():
    wish = pf.pin("pelvis", [3, 7], [[0, 1.0], [1, 2.0]], axes="xz")
    wish &= pf.pin("pelvis", 5, [0.9], axes="y") & pf.pin("head", [3, 9], np.zeros((2, 3)))
    known = known_coordinates(wish, FRAMES, torch.float64)
    lines = known.line()
    added = lines.mask & ~known.mask
    assert added.nonzero().tolist() == [[n, 0, axis] for n in (4, 5, 6) for axis in (0, 2)]
    expected = [[0.25, 1.25], [0.5, 1.5], [0.75, 1.75]]
    np.testing.assert_allclose(lines.values[4:7, 0][:, [0, 2]], expected)
    np.testing.assert_array_equal(lines.values[known.mask], known.values[known.mask])


def test_every_motion_of_a_batch_has_its_own_lines():
    known = known_coordinates(WISH, FRAMES, torch.float64)
    values = torch.stack([known.values, 2 * known.values])
    both = Imputation(known.mask, values).line().values
    torch.testing.assert_close(both[0], known.line().values)
    torch.testing.assert_close(both[1][:, 0], 2 * known.line().values[:, 0])


def test_straight_lines_lead_the_motion_before_tau():
    steps = []
    x = sample(switch=0.6, until=1.0, callback=steps.append)
    assert 2 < sum(step.t < 0.6 for step in steps) < len(steps) - 2
    for step in steps:
        off = (on_ground(step.x1_projected)[0] - torch.as_tensor(line())).abs()
        assert off[KEYS].max() == 0
        assert (off.max() < 1e-12) == (step.t < 0.6)
    np.testing.assert_array_equal(on_ground(x)[0, KEYS], PLACES)


def test_lines_to_the_end_are_the_trajectory():
    np.testing.assert_allclose(on_ground(sample(switch=1.0, until=1.0))[0], line(), atol=1e-12)


def test_a_planned_trajectory_is_imputed_in_every_frame():
    steps = []
    x = sample(trajectory_model=Planner(), switch=0.0, until=1.0, callback=steps.append)
    z = on_ground(x)[0]
    np.testing.assert_array_equal(z[KEYS], PLACES)
    for step in steps:
        torch.testing.assert_close(on_ground(step.x1_projected)[0], z, atol=0, rtol=0)
    assert (z - torch.as_tensor(line())).abs().max() > 0.02


def bend(z):
    return z.diff(n=2, dim=1).square().sum((1, 2)).mean().item()


def test_tau_goes_from_the_models_trajectories_to_straight_lines():
    """Diversity and closeness to the lines, as the paper has it: one is bought with the other."""
    away, spread = [], []
    for switch in (0.0, 0.5, 0.9, 1.0):
        x = sample(batch=100, trajectory_model=Planner(), switch=switch, until=1.0, pull=0.0)
        z = on_ground(x)
        away.append((z - torch.as_tensor(line())).square().mean().item())
        spread.append(z.var(dim=0).mean().item())
    assert away == sorted(away, reverse=True)
    assert spread == sorted(spread, reverse=True)
    assert away[-1] < 1e-20 < away[-2]


def test_a_pull_makes_planned_trajectories_less_kinked():
    """Imputed keyframes stick out of what was planned; the pull brings the neighbours along."""
    kinked, smooth = (
        bend(on_ground(sample(batch=50, trajectory_model=Planner(), switch=0.0, until=1.0, pull=p)))
        for p in (0.0, 3.0)
    )
    assert smooth < 0.7 * kinked


def test_goals_guide_the_trajectory():
    goal = Avoid(circles([[0.7, 1.5]], 0.3), 0.05)
    depths = [
        goal.depth(sample(batch=50, trajectory_model=Planner(), switch=0.0, goal=goal, scale=s))
        for s in (0.0, 60.0)
    ]
    assert depths[0].amax(1).mean() > 0.02
    assert depths[1].amax(1).mean() < 0.6 * depths[0].amax(1).mean()
    assert (depths[1] > 0).any(1).sum() < (depths[0] > 0).any(1).sum()


def test_a_trajectory_without_keyframes_has_goals_alone():
    goal, planner = keep_speed(0.5), Planner()
    slow = sample(None, 50, trajectory_model=planner, switch=0.0, goal=goal, scale=8.0, until=1.0)
    free = sample(None, 50, trajectory_model=planner, switch=0.0, until=1.0)
    assert goal(slow).mean() < 0.5 * goal(free).mean()


WRONG = [
    (
        lambda: sample(pf.pin("head", 3, [0, 1, 0])),
        "gmd: straight lines need keyframes of the pelvis, in x or z: pin some, or leave lines out "
        "with switch=0",
    ),
    (
        lambda: sample(switch=2),
        "gmd_keyframes: switch is a flow time from 0 to 1, not 2",
    ),
]


@pytest.mark.parametrize(("make", "message"), WRONG, ids=[m for _, m in WRONG])
def test_wrong_options_say_what_and_what_to_do(make, message):
    with pytest.raises(ValueError, match=".") as caught:
        make()
    assert str(caught.value) == message
