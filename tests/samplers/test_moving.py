"""The projection over time: equal to eq. 7 with the dense metric, and exact where it must be."""

import numpy as np
import pytest
import torch

import projflow_lite as pf
from projflow_lite import equations as eq
from projflow_lite.constraints import offset, pin, rows
from projflow_lite.joint_metric import kinematic_joint_metric
from projflow_lite.samplers import (
    GuideSettings,
    MovingMetric,
    MovingStep,
    ProjectionStep,
    sample,
)
from projflow_lite.samplers.moving import projection_step

FRAMES = 4
SETTINGS = MovingMetric(start=0.2, speed=0.8, memory=1.0, until=0.9, noise_std=0.5)


def some_row():
    A = np.zeros((1, FRAMES * 66))
    A[0, [5, 80, 200]] = 0.5, -1.0, 2.0
    return rows(A, [0.3], 0.0)


WISHES = {
    "one pin": pin("left_wrist", 2, [0.1, 1.2, 0.3]),
    "pins": pin(["pelvis", "head"], [0, 3], np.arange(12).reshape(2, 2, 3) / 9),
    "an axis": pin("pelvis", 1, [0.9], axes="y"),
    "soft": pin("left_foot", 1, [0.1, 0.0, 0.2], std=0.05),
    "soft beside hard": pin("left_foot", 1, [0.1, 0.0, 0.2], std=0.05) & pin("head", 3, [0, 1, 0]),
    "offset": offset("left_wrist", "right_wrist", [0.3, 0.0, 0.0]),
    "any row": some_row() & pin("head", 0, [0.0, 1.6, 0.0]),
}


def dense(wish, x, t):
    A, y, variance = wish.rows(FRAMES)
    walk = eq.walk_covariance(FRAMES, SETTINGS.start, SETTINGS.speed, SETTINGS.memory)
    R = eq.metric_over_time(
        min(t, SETTINGS.until), walk, kinematic_joint_metric(), SETTINGS.noise_std
    )
    return eq.project(x.ravel(), A.toarray(), y, R, np.diag(variance)).reshape(x.shape)


@pytest.mark.parametrize("t", [0.0, 0.4, 0.97])
@pytest.mark.parametrize("name", WISHES)
def test_equals_eq_7_with_the_dense_metric(name, t):
    x = np.random.default_rng(0).normal(size=(2, FRAMES, 22, 3))
    step = MovingStep(WISHES[name], FRAMES, SETTINGS, torch.float64)
    found = step(torch.tensor(x), t).numpy()
    for one, two in zip(found, x, strict=True):
        np.testing.assert_allclose(one, dense(WISHES[name], two, t), atol=1e-9)


def test_pins_are_exact_to_the_last_bit():
    target = np.array([0.1, 1.2, 0.3])
    step = MovingStep(pin("left_wrist", [1, 3], [target, target]), FRAMES)
    x1 = step(torch.randn(3, FRAMES, 22, 3), 0.5)
    assert (x1[:, [1, 3], 20] == torch.tensor(target, dtype=torch.float32)).all()
    assert step.residual(x1) == 0


def test_many_frames_at_once_are_met():
    """Neighbours of a smooth walk are nearly the same place: the system is as bad as it gets."""
    targets = np.random.default_rng(1).normal(size=(196, 3))
    step = MovingStep(pin("pelvis", range(196), targets), 196, dtype=torch.float64)
    assert step.residual(step(torch.randn(1, 196, 22, 3, dtype=torch.float64), 0.0)) < 1e-12


def test_targets_for_each_motion_of_a_batch():
    wish, x = WISHES["soft beside hard"], torch.randn(2, FRAMES, 22, 3, dtype=torch.float64)
    y = np.random.default_rng(2).normal(size=(2, 6))
    step = MovingStep(wish, FRAMES, SETTINGS, torch.float64)
    together = step.aimed_at(y)(x, 0.3)
    for k in range(2):
        torch.testing.assert_close(together[k : k + 1], step.aimed_at(y[k])(x[k : k + 1], 0.3))
    assert not torch.allclose(together, step(x, 0.3))


def test_a_correction_reaches_the_neighbours_and_fades():
    still = torch.zeros(1, 60, 22, 3)
    wish = pin("pelvis", 30, [0.0, 0.0, 1.0])
    late = MovingStep(wish, 60)(still, 0.9)[0, :, 0, 2]
    assert late[30] == 1
    assert 0.8 < late[29] < 1
    assert (late[30:45].diff() < 0).all()
    assert late[45:].abs().max() < 0.06
    early = MovingStep(wish, 60)(still, 0.0)[0, :, 0, 2]
    assert (early[:20] > late[:20]).all()
    without = ProjectionStep(wish, 60, guides=False)(still, 0.9)[0, :, 0, 2]
    assert without[29] == 0


def test_gradients_flow_through():
    step = MovingStep(WISHES["soft"], FRAMES, SETTINGS, torch.float64)
    x = torch.randn(1, FRAMES, 22, 3, dtype=torch.float64, requires_grad=True)
    way = torch.randn(1, FRAMES, 22, 3, dtype=torch.float64)
    (slope,) = torch.autograd.grad((step(x, 0.5) * way).sum(), x)
    h = 1e-4
    difference = (step(x + h * way, 0.5) - step(x - h * way, 0.5)).mul(way).sum() / (2 * h)
    torch.testing.assert_close((slope * way).sum(), difference)


def test_sample_takes_it_by_name_and_fits_it_to_the_noise_of_the_prior():
    def velocity(x_t, t, text=None):
        return -x_t

    velocity.noise_std = 0.3
    wish = pin("head", 5, [0.0, 1.5, 0.2])
    by_name = sample(velocity, wish, frames=12, steps=4, metric="moving")
    fitted = sample(velocity, wish, frames=12, steps=4, metric=MovingMetric(noise_std=0.3))
    np.testing.assert_allclose(by_name.positions, fitted.positions, atol=1e-6)
    other = sample(velocity, wish, frames=12, steps=4)
    assert not np.allclose(by_name.positions, other.positions, atol=1e-3)
    assert (by_name.positions[5, 15] == np.float32([0.0, 1.5, 0.2])).all()


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"speed": 0.0}, "speed is a number above 0"),
        ({"memory": float("inf")}, "memory is a number above 0"),
        ({"start": "far"}, "start is a number above 0"),
        ({"until": 1.0}, "until is below 1"),
        ({"noise_std": True}, "noise_std is a number above 0"),
    ],
)
def test_constants_that_make_no_sense(given, message):
    with pytest.raises(ValueError, match=message):
        MovingMetric(**given)


def test_what_it_refuses():
    wish = pin("head", 1, [0.0, 1.5, 0.2])
    with pytest.raises(ValueError, match="leave guides out"):
        projection_step(wish, FRAMES, "moving", guides=GuideSettings())
    everything = pf.pin(range(22), range(196), np.zeros((196, 22, 3)))
    with pytest.raises(ValueError, match="ask for fewer frames"):
        MovingStep(everything, 196)
    with pytest.raises(ValueError, match="contradict"):
        MovingStep(wish & pin("head", 1, [0.0, 1.6, 0.2]), FRAMES)
    with pytest.raises(ValueError, match="expected shape"):
        MovingStep(wish, FRAMES)(torch.zeros(1, FRAMES + 1, 22, 3), 0.5)
