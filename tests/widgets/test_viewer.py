"""The Python side of the viewer: what it sends to the page, and what it refuses."""

from __future__ import annotations

import numpy as np
import pytest
from stage import walking, wished
from traitlets import TraitError

from projflow_lite.motion import Motion
from projflow_lite.widgets import Viewer, view
from projflow_lite.widgets.front_end import pack, unpack


def shown(viewer: Viewer) -> np.ndarray:
    return unpack(viewer.data, *viewer.shape)


def test_positions_travel_as_little_endian_float32():
    motion = walking(7)
    viewer = view(motion)
    assert viewer.shape == [1, 7, 22, 3]
    np.testing.assert_allclose(shown(viewer)[0], motion.positions, atol=1e-6)
    assert viewer.data[:4] == np.array(motion.positions[0, 0, 0], "<f4").tobytes()


def test_ghosts_of_other_lengths_hold_their_last_pose():
    long, short = walking(9), walking(4)
    bodies = shown(view(long, short))
    assert bodies.shape == (2, 9, 22, 3)
    np.testing.assert_allclose(bodies[1, 4:], np.repeat(bodies[1, 3:4], 5, axis=0))


def test_a_batch_is_one_focus_and_ghosts_or_stands_in_a_row():
    batch = Motion(np.stack([walking(5).positions] * 3), prompt=["a", "b", "c"])
    assert view(batch).solid == 1
    assert view(batch).names == ["a", "", ""]
    row = Viewer(batch, spread=1.5)
    assert row.solid == 3
    np.testing.assert_allclose(shown(row)[:, 0, 0, 0], [0, 1.5, 3.0])


def test_show_replaces_the_motion_and_keeps_the_state():
    viewer = Viewer(walking(10), walking(10, 0.5), trail="left_wrist", playing=False)
    viewer.frame, viewer.camera = 4, {"yaw": 1.0}
    new = walking(12)
    viewer.motion = new
    assert viewer.motion is new
    assert viewer.shape == [1, 12, 22, 3]
    assert (viewer.frame, viewer.camera, viewer.playing) == (4, {"yaw": 1.0}, False)
    assert viewer.trail == [20]


def test_markers_carry_target_tolerance_and_residual():
    viewer = view(wished(walking(10), frames=[2, 8], off=0.25, free=[0], std=0.05))
    records = unpack(viewer.markers, -1, 7)
    np.testing.assert_array_equal(records[:, :2], [[20, 2], [20, 8]])
    assert np.isnan(records[:, 2]).all()
    np.testing.assert_allclose(records[:, 5:], [[0.05, 0.25]] * 2, atol=1e-6)
    assert viewer.residual == pytest.approx(0.25)


def test_without_a_wish_there_is_nothing_to_meet():
    viewer = view(wished(walking(5)))
    viewer.show(walking(5))
    assert viewer.markers == b""
    assert viewer.residual is None


def test_bytes_from_the_page_arrive():
    viewer = view(walking(3))
    data = pack(np.zeros((1, 3, 22, 3)))
    viewer.set_state({"data": memoryview(data)})
    assert viewer.data == data


def test_what_is_wrong_is_said_in_one_line():
    with pytest.raises(ValueError, match="'left_wirst' is not a joint; did you mean 'left_wrist'"):
        view(walking(3), trail="left_wirst")
    with pytest.raises(ValueError, match="expected a Motion, got ndarray"):
        view(walking(3).positions)
    with pytest.raises(ValueError, match="2 motions need as many names, got 1"):
        view(walking(3), walking(3), names=["only one"])


def test_bad_state_is_refused():
    viewer = view(walking(3))
    with pytest.raises(TraitError, match="camera has no 'yaww'"):
        viewer.camera = {"yaww": 1.0}
    with pytest.raises(TraitError, match="not finite"):
        viewer.camera = {"target": [0, float("nan"), 0]}
    with pytest.raises(TraitError, match="speed must be"):
        viewer.speed = 0


def test_text_shown_where_the_front_end_did_not_start():
    assert "No picture?" in repr(view(walking(3)))
    assert len(repr(view(walking(3)))) < 110  # a longer one is cut
