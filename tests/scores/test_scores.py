"""Every score against motions whose answer is known beforehand."""

import numpy as np
import pytest

from data_synth import make_clips
from projflow_lite import scores
from projflow_lite.skeleton import EDGES, JOINTS

LEFT_FOOT, HEAD = JOINTS.index("left_foot"), JOINTS.index("head")


def still(frames=60):
    """A body of one-metre bones high above the ground, which does not move."""
    x = np.zeros((frames, 22, 3))
    for parent, child in EDGES:
        x[:, child] = x[:, parent] + [0.6, 0.0, 0.8]
    return x + [0, 5, 0]


def test_a_miss_of_51_cm_counts_and_one_of_49_does_not():
    x = np.zeros((2, 4, 1, 3))
    target = np.full_like(x, np.nan)
    target[:, [0, 2]] = 0.0
    x[0, 0, 0, 0], x[1, 0, 0, 0] = 0.51, 0.49
    errors = scores.control_errors(x, target)
    np.testing.assert_array_equal(errors.trajectory, [1, 0])
    np.testing.assert_array_equal(errors.location, [0.5, 0])
    np.testing.assert_allclose(errors.average, [0.255, 0.245])


def test_control_errors_refuse_what_they_cannot_score():
    with pytest.raises(ValueError, match="differ"):
        scores.control_errors(np.zeros((4, 1, 3)), np.zeros((5, 1, 3)))
    with pytest.raises(ValueError, match="no target at all"):
        scores.control_errors(np.zeros((4, 1, 3)), np.full((4, 1, 3), np.nan))


@pytest.mark.parametrize(
    ("height", "speed", "expected"), [(0.02, 1.0, 20), (0.02, 0.4, 0), (0.08, 1.0, 0)]
)
def test_a_planted_skate_of_twenty_frames_is_found(height, speed, expected):
    x = still()
    x[:, LEFT_FOOT, 1] = height
    x[20:41, LEFT_FOOT, 0] += np.arange(21) * speed / 20
    x[41:, LEFT_FOOT, 0] += speed
    # The five-frame mean cuts up to one frame off either end of a slow skate.
    assert scores.foot_skating(x) * 59 == pytest.approx(expected, abs=2)


def test_a_foot_that_stands_does_not_skate():
    x = still()
    x[:, LEFT_FOOT, 1] = 0.0
    assert scores.foot_skating(x) == 0


@pytest.mark.parametrize(
    ("heel", "speed", "expected"), [(0.02, 0.08, 20), (0.02, 0.07, 0), (0.06, 0.08, 0)]
)
def test_a_planted_slide_of_both_heels_is_found_by_bmm_s_definition(heel, speed, expected):
    x = still()
    ankles = [JOINTS.index("left_ankle"), JOINTS.index("right_ankle")]
    x[:, ankles, 1] = heel + 0.05  # a heel is 5 cm below its ankle
    x[20:41, ankles, 2] += (np.arange(21) * speed / 20)[:, None]
    x[41:, ankles, 2] += speed
    assert scores.foot_skating(x, definition="bmm") * 59 == pytest.approx(expected)
    assert scores.foot_skating(x) == 0  # far below 0.5 m/s
    x[:, ankles[0], 2] = 0.0  # one heel stands: that is no skating by this definition
    assert scores.foot_skating(x, definition="bmm") == 0


def test_skating_refuses_another_definition_and_a_single_frame():
    with pytest.raises(ValueError, match="'gmd' or 'bmm', not 'omni'"):
        scores.foot_skating(still(), definition="omni")
    with pytest.raises(ValueError, match="one frame"):
        scores.foot_skating(still(1))


def test_a_heel_that_stands_is_where_the_floor_is():
    """The drop from ankle to heel fits the data: a standing body stands, and does not skate."""
    x = make_clips(64, 40, seed=5, actions=["idle"]).positions
    ankles = x[:, :, [JOINTS.index("left_ankle"), JOINTS.index("right_ankle")], 1]
    assert np.median(ankles) - 0.05 == pytest.approx(0, abs=0.02)
    assert scores.foot_skating(x, definition="bmm").mean() < 0.05


def test_one_bone_stretched_by_a_tenth_in_half_of_the_frames():
    x = still(60)
    x[:25, HEAD] += 0.1 * (x[:25, HEAD] - x[:25, JOINTS.index("neck")])
    assert scores.bone_length_error(x) == pytest.approx(0.1 * 25 / 60 / 21)
    assert scores.bone_length_error(still()) == pytest.approx(0, abs=1e-15)


def test_free_fall_has_gravity_as_its_worst_acceleration_and_no_jerk():
    t = np.arange(20) / 20
    x = still(20)
    x[..., 1] -= 0.5 * 9.81 * t[:, None] ** 2
    assert scores.worst_acceleration(x) == pytest.approx(9.81)
    assert scores.mean_jerk(x) == pytest.approx(0, abs=1e-8)


def test_a_cubic_has_constant_jerk():
    t = np.arange(20) / 20
    x = still(20)
    x[..., 0] += (t**3)[:, None]
    assert scores.mean_jerk(x) == pytest.approx(6.0)


def test_frechet_distance_of_known_gaussians():
    random = np.random.default_rng(0)
    z = random.normal(size=(2000, 3))
    z = (z - z.mean(0)) @ np.linalg.inv(np.linalg.cholesky(np.cov(z.T))).T  # mean 0, covariance I
    scale, shift = np.array([1.0, 2.0, 3.0]), np.array([1.0, 0.0, -2.0])
    expected = 5.0 + np.sum((scale - 1) ** 2)
    assert scores.frechet_distance(z, z * scale + shift) == pytest.approx(expected, rel=1e-6)
    assert scores.frechet_distance(z, z) == pytest.approx(0, abs=1e-8)
    with pytest.raises(ValueError, match="two sets"):
        scores.frechet_distance(z, z[:, :2])


def test_kinetic_features_of_a_sine_wave():
    t = np.arange(2000) / 20
    x = still(2000)
    x[:, HEAD, 0] += 0.1 * np.sin(2 * np.pi * 0.5 * t)
    features = scores.kinetic_features(x)
    speed, acceleration = np.exp(2 * features[[3, 9]]) - np.square([0.03, 0.3])
    assert np.sqrt(speed) == pytest.approx(0.1 * np.pi / np.sqrt(2), rel=0.01)
    assert np.sqrt(acceleration) == pytest.approx(0.1 * np.pi**2 / np.sqrt(2), rel=0.02)
    np.testing.assert_allclose(np.exp(features[[0, 6]]), [0.03, 0.3])  # the pelvis stands still


def test_a_spike_moves_the_kinetic_distance():
    random = np.random.default_rng(0)
    clips = still()[None] + 0.02 * random.normal(size=(64, 60, 22, 3)).cumsum(1)
    spiked = clips.copy()
    spiked[:, 30, JOINTS.index("left_wrist")] += 0.3
    calm = scores.frechet_distance(*np.split(scores.kinetic_features(clips), 2))
    loud = scores.frechet_distance(scores.kinetic_features(clips), scores.kinetic_features(spiked))
    assert loud > 3 * calm
