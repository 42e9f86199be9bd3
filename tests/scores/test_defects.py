"""Every fault is what it says, and each blind spot of a score is really there."""

import numpy as np
import pytest

from data_synth import held_out
from projflow_lite import scores
from projflow_lite.scores import defects
from projflow_lite.skeleton import JOINTS, bone_lengths

WRIST, ELBOW = JOINTS.index("left_wrist"), JOINTS.index("left_elbow")


@pytest.fixture(scope="module")
def data():
    return held_out(68, seed=11)


@pytest.mark.parametrize("fault", [defects.spike, defects.slide, defects.stretch, defects.smooth])
def test_a_fault_of_size_zero_is_none_and_none_changes_what_it_is_given(data, fault):
    before = data.positions.copy()
    np.testing.assert_array_equal(fault(data.positions, 0), before)
    assert np.abs(fault(data.positions, 0.3) - before).max() > 1e-3
    np.testing.assert_array_equal(data.positions, before)


def test_a_spike_of_30_cm_is_an_acceleration_of_240_that_fid_does_not_see(data):
    still = np.zeros((60, 22, 3))
    # Up 0.3 m and down again in a twentieth of a second each: 2 * 0.3 * 20^2.
    assert scores.worst_acceleration(defects.spike(still, 0.3)) == pytest.approx(240)
    reference, judge = held_out(340, seed=12).positions, scores.load_evaluator()
    spiked = defects.spike(data.positions, 0.3)
    for features, noticed in ((judge.embed_motion, False), (scores.kinetic_features, True)):
        floor = scores.frechet_distance(features(data.positions), features(reference))
        value = scores.frechet_distance(features(spiked), features(reference))
        assert (value > 1.2 * floor) == noticed
        assert not noticed or value > 10 * floor


def test_a_slide_jumps_into_sight_at_half_a_metre_a_second():
    still = defects.sliding_foot(0.0, 0.02)
    assert scores.foot_skating(defects.slide(still, 0.49)) == 0
    assert scores.foot_skating(defects.slide(still, 0.51)) == 1
    assert scores.worst_acceleration(defects.slide(still, 0.51)) == pytest.approx(0, abs=1e-9)


def test_a_stretch_that_lasts_is_seen_by_true_lengths_only(data):
    """21 bones, one of them longer by 30 %: the mean is 0.3 / 21."""
    true = np.median(bone_lengths(data.positions), axis=-2)
    stretched = defects.stretch(data.positions, 0.3)
    np.testing.assert_allclose(scores.bone_length_error(stretched), 0, atol=1e-6)
    np.testing.assert_allclose(scores.bone_length_error(stretched, true), 0.3 / 21, atol=1e-6)
    others = [joint for joint in range(22) if joint != WRIST]
    np.testing.assert_array_equal(stretched[..., others, :], data.positions[..., others, :])


def test_a_smoothed_motion_has_less_jerk_than_the_data_and_skates_more(data):
    smoothed = defects.smooth(data.positions, 2.0)
    assert scores.mean_jerk(smoothed).mean() < 0.5 * scores.mean_jerk(data.positions).mean()
    assert scores.foot_skating(smoothed).mean() > 1.5 * scores.foot_skating(data.positions).mean()


def test_a_parrot_of_one_clip_has_no_diversity_and_one_of_many_passes(data):
    judge = scores.load_evaluator()
    text, known = judge.embed_text(data.captions), held_out(680, seed=13).positions
    points = judge.embed_motion(known)
    one, many = points[defects.parrot(text, points[:1])], points[defects.parrot(text, points)]
    assert scores.diversity(one) == 0
    assert scores.r_precision(text, one).top3 == pytest.approx(3 / 32, abs=0.05)
    own = judge.embed_motion(data.positions)
    assert scores.r_precision(text, many).top3 > 0.95
    assert scores.matching_score(text, many) < scores.matching_score(text, own)
    assert scores.diversity(many) == pytest.approx(scores.diversity(own), rel=0.1)


def test_a_parrot_answers_with_the_nearest_by_hand():
    text, known = np.array([[0.0], [9.0], [4.9]]), np.array([[10.0], [0.0]])
    assert defects.parrot(text, known).tolist() == [1, 0, 1]


@pytest.mark.parametrize(("frames", "moving"), [(60, 20), (40, 5), (30, 29)])
def test_a_planted_skate_has_the_length_that_was_planted(frames, moving):
    x = defects.sliding_foot(1.2, 0.02, frames, moving)
    assert scores.foot_skating(x) * (frames - 1) == pytest.approx(moving)
    travelled = x[-1, JOINTS.index("left_foot"), 2] - x[0, JOINTS.index("left_foot"), 2]
    assert travelled == pytest.approx(1.2 * moving / 20)
    assert scores.foot_skating(defects.sliding_foot(1.2, 0.06, frames, moving)) == 0


def test_faults_refuse_what_is_no_motion():
    with pytest.raises(ValueError, match="spike"):
        defects.spike(np.zeros((60, 21, 3)), 0.1)
