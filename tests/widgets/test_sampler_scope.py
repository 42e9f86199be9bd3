"""The sampler scope without a page: what it shows is what the sampler did."""

import numpy as np
import pytest
import torch

import projflow_lite as pf
from projflow_lite.constraints import coordinate_rows
from projflow_lite.widgets import SamplerScope
from projflow_lite.widgets.sampler_scope import FLOOR, frames_of_rows

WISH = pf.pin("left_wrist", [4, 20], [[0.4, 1.5, 0.2], [0.3, 1.2, 0.2]])


def still(x_t, t, text):
    """The flow to one body that stands still at the origin, a metre up."""
    return (torch.tensor([0.0, 1.0, 0.0]) - x_t) / (1 - t)


@pytest.fixture(scope="module")
def scope():
    return SamplerScope(still, WISH, frames=24, steps=6, seed=3)


def unpacked(viewer):
    return np.frombuffer(viewer.data, np.float32).reshape(viewer.shape)


def layer(board, name):
    """What a page would draw of a layer, ``(n, 2)``."""
    (found,) = (each for each in board.layers if each["name"] == name)
    xy = np.frombuffer(board.data, np.float32).reshape(-1, 2)
    return xy[found["start"] : found["start"] + found["count"]]


def test_its_motion_is_the_one_that_sample_makes(scope):
    alone = pf.sample(still, WISH, frames=24, steps=6, seed=3)
    np.testing.assert_array_equal(scope.motion.positions, alone.positions)
    assert len(scope.record) == 6
    np.testing.assert_array_equal(scope.record[-1].x1_projected[0], alone.positions)


def test_the_slider_shows_each_step(scope):
    for k in (0, 3, 5):
        scope.step.value = k
        bodies = unpacked(scope.viewer)
        np.testing.assert_array_equal(bodies[0], scope.record[k].x1_projected[0])
        np.testing.assert_array_equal(bodies[1], scope.record[k].x1_hat[0])
        assert layer(scope.way, "now")[0, 0] == pytest.approx(scope.record[k].t)
        assert scope.said.words.startswith(f"t = {scope.record[k].t:.3f}")
    assert scope.viewer.residual < 1e-6


def test_the_state_is_shown_when_asked_for(scope):
    scope.noisy.value = True
    scope.step.value = 1
    assert scope.viewer.names == ["projected", "predicted", "state"]
    np.testing.assert_array_equal(unpacked(scope.viewer)[2], scope.record[1].x_t[0])
    scope.noisy.value = False
    assert len(scope.viewer.names) == 2


def test_what_moved_is_the_largest_distance(scope):
    """The body stands at (0, 1, 0): the farther pin says how far the wrist has to go."""
    way = layer(scope.way, "way")
    far = np.linalg.norm(np.array([0.4, 1.5, 0.2]) - [0, 1, 0])
    np.testing.assert_allclose(way[:, 1], 100 * far, rtol=1e-3)


def test_hard_rows_lie_at_the_bottom_and_the_halo_shrinks(scope):
    reach = []
    for k in (0, 5):
        scope.step.value = k
        hard, soft = layer(scope.held, "hard"), layer(scope.held, "soft")
        assert set(hard[:, 0]) == {4, 20}
        np.testing.assert_array_equal(hard[:, 1], FLOOR)
        acts = np.isfinite(np.asarray(scope.record[k].variance[0])) & (
            np.asarray(scope.record[k].variance[0]) > 0
        )
        assert len(soft) == acts.sum()
        reach.append(len(set(soft[:, 0])))
    assert reach[0] > reach[1] > 0


def test_a_row_looks_at_its_frame():
    columns = np.array([0, 66 * 3 + 5, 66 * 7])
    rows = coordinate_rows(columns, np.zeros(3), 9, 0.0)
    np.testing.assert_array_equal(frames_of_rows(rows), [0, 3, 7])
    moving = pf.velocity("pelvis", [5], [[0.0, 0.0, 1.0]]).rows(9)
    np.testing.assert_array_equal(frames_of_rows(moving), 5.5)


def test_without_guides_there_are_only_pins():
    scope = SamplerScope(still, WISH, frames=24, steps=3, guides=False)
    assert len(layer(scope.held, "soft")) == 0
    assert len(layer(scope.held, "hard")) == 6


def test_what_sample_refuses_is_refused():
    with pytest.raises(ValueError, match="sample: wish is made by pin"):
        SamplerScope(still, 3, frames=24)
