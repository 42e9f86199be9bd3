"""The explorer of reach: paths against Gaussian conditioning, and what hands can ask of it."""

import numpy as np
import pytest

from projflow_lite import equations as eq
from projflow_lite.samplers import MovingMetric
from projflow_lite.studies.reach_explorer import (
    ALONE,
    GUIDED,
    MOVING,
    ReachExplorer,
    frames_along,
    worst_acceleration,
)
from projflow_lite.widgets.standing import standing_pose

STILL = np.repeat(standing_pose(), 30, axis=0)


@pytest.fixture
def explorer():
    away = STILL + [0.1, 0.0, 0.0]
    return ReachExplorer({"still": STILL, "away": away}, {12: 0.4})


def expected(frame, t, memory=5.0, speed=0.5):
    """The column of a walk seen through noise, by Kalman's formula rather than by inverses."""
    usual = MovingMetric()
    S = eq.walk_covariance(30, usual.start, speed, memory)
    noise = ((1 - t) / t * usual.noise_std) ** 2
    C = S - S @ np.linalg.solve(S + noise * np.eye(30), S)
    return C[:, frame] / C[frame, frame]


def test_three_answers_to_one_pin(explorer):
    alone = np.zeros(30)
    alone[12] = 0.4
    np.testing.assert_allclose(explorer.paths[ALONE], alone, atol=1e-12)
    assert "keyframe alone 320" in explorer.words.value  # 2 x 0.4 x 20²
    assert explorer.paths[GUIDED][11] > 0.3
    np.testing.assert_allclose(explorer.paths[MOVING], 0.4 * expected(12, 0.5), atol=1e-6)


def test_sliders_reach_the_metric(explorer):
    explorer.t.value, explorer.memory.value, explorer.speed.value = 0.8, 0.5, 2.0
    found = expected(12, 0.8, 0.5, 2.0)
    np.testing.assert_allclose(explorer.paths[MOVING], 0.4 * found, atol=1e-6)
    explorer.t.value, explorer.until.value = 1.0, 0.6
    found = expected(12, 0.6, 0.5, 2.0)
    np.testing.assert_allclose(explorer.paths[MOVING], 0.4 * found, atol=1e-6)


def test_a_prediction_that_is_elsewhere_has_less_to_correct(explorer):
    explorer.motion.value = "away"
    np.testing.assert_allclose(explorer.paths[MOVING], 0.1 + 0.3 * expected(12, 0.5), atol=1e-6)


def test_a_dragged_keyframe_lies_in_a_whole_frame():
    explorer = ReachExplorer({"still": STILL}, {10: 0.0, 11: 0.5})
    explorer.board.drag = {"moves": {"key 1": [7.4, 0.2, 1]}}
    assert explorer.board.positions["key 1"] == (7, pytest.approx(0.2))
    assert explorer.paths[MOVING][[7, 11]] == pytest.approx([0.2, 0.5])
    explorer.board.drag = {"moves": {"key 1": [11.0, 0.2, 2]}}
    assert explorer.board.positions["key 1"][0] in (10, 12)
    explorer.board.drag = {"moves": {"key 1": [99.0, 0.2, 3]}}
    assert explorer.board.positions["key 1"][0] == 29
    assert explorer.board.problem == ""


def test_numbers_by_hand():
    C = np.array([[2.0, 1.1, 0.9], [1.1, 4.0, 0.0], [0.9, 0.0, 1.0]])
    assert [frames_along(C, frame) for frame in range(3)] == [2, 1, 2]
    assert worst_acceleration([0.0, 0.0, 0.1, 0.0]) == pytest.approx(80)
