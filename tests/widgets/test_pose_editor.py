"""The pose editor without a page: what is pulled is pinned, exactly, and can be taken back."""

import numpy as np
import pytest
import torch

import projflow_lite as pf
from projflow_lite.skeleton import JOINTS
from projflow_lite.widgets import PoseEditor

WRIST, HEAD = JOINTS.index("left_wrist"), JOINTS.index("head")


def still(x_t, t, text):
    return (torch.tensor([0.0, 1.0, 0.0]) - x_t) / (1 - t)


@pytest.fixture
def editor():
    return PoseEditor(still, frames=24, steps=4)


def pull(editor, joint, frame, at, done=True):
    count = editor.viewer.pull.get("count", 0) + 1
    editor.viewer.pull = {"joint": joint, "frame": frame, "at": at, "done": done, "count": count}


def test_what_is_pulled_becomes_an_exact_pin(editor):
    pull(editor, WRIST, 7, [0.5, 1.25, 0.25])
    assert editor.pins == {(WRIST, 7): (0.5, 1.25, 0.25)}
    np.testing.assert_array_equal(editor.motion.positions[7, WRIST], np.float32([0.5, 1.25, 0.25]))
    assert editor.motion.residual < 1e-6
    assert len(editor.viewer.markers) > 0
    assert "1 pin " in editor.status.value


def test_pulling_on_moves_the_same_pin(editor):
    for x in (0.1, 0.2, 0.3):
        pull(editor, WRIST, 7, [x, 1.0, 0.0], done=False)
    pull(editor, HEAD, 3, [0.0, 1.75, 0.0])
    assert list(editor.pins) == [(WRIST, 7), (HEAD, 3)]
    assert editor.pins[WRIST, 7][0] == 0.3


def messages_of(editor):
    """A list that grows by the sender and what it says with every message to the page."""
    said = []

    class Wire:
        kernel, comm_id = True, "wire"

        def __init__(self, widget):
            self.widget = widget

        def on_msg(self, callback): ...

        def close(self, *_, **__): ...

        def send(self, data=None, buffers=None):
            said.append((self.widget, set(data["state"])))

    for widget in (editor.viewer, editor.joint, *editor.place, editor.status):
        widget.comm = Wire(widget)
    return said


def test_while_the_hand_moves_an_answer_is_one_message(editor):
    pull(editor, WRIST, 7, [0.1, 1.0, 0.0], done=False)
    said = messages_of(editor)
    for x in (0.2, 0.3):
        editor.viewer.set_state(  # as the page says it
            {"pull": {"joint": WRIST, "frame": 7, "at": [x, 1, 0], "done": False, "count": x}}
        )
    assert [widget for widget, _ in said] == [editor.viewer] * 2
    pull(editor, WRIST, 7, [0.3, 1.2, 0.0], done=True)
    assert editor.status in [widget for widget, _ in said]
    assert "1 pin " in editor.status.value


def test_what_was_wrong_is_taken_back_while_the_hand_moves():
    editor = PoseEditor(still, frames=24, wish=pf.pin("pelvis", 0, [0, 0.9, 0]), steps=3)
    pull(editor, 0, 0, [0.5, 1.0, 0.0], done=False)
    assert "pf-bad" in editor.status.value
    pull(editor, 0, 0, [0.0, 0.9, 0.0], done=False)
    assert "pf-bad" not in editor.status.value


def test_undo_takes_the_last_pin_and_clear_all(editor):
    free = editor.motion.positions
    for joint in (WRIST, HEAD, 0):
        pull(editor, joint, 5, [0.0, 1.5, 0.1])
    pull(editor, WRIST, 5, [0.0, 1.5, 0.2])
    editor.undo.click()
    assert list(editor.pins) == [(HEAD, 5), (0, 5)]
    editor.clear.click()
    assert editor.pins == {}
    np.testing.assert_array_equal(editor.motion.positions, free)


def test_without_a_mouse_a_place_is_written(editor):
    editor.viewer.frame = 9
    editor.joint.value = HEAD
    assert editor.runs == 0
    assert [field.value for field in editor.place] == pytest.approx([0, 1, 0], abs=1e-3)
    editor.place[1].value = 1.5
    assert editor.pins == {(HEAD, 9): pytest.approx((0, 1.5, 0), abs=1e-3)}
    assert editor.motion.positions[9, HEAD, 1] == pytest.approx(1.5)


def test_another_wish_holds_as_well():
    editor = PoseEditor(still, frames=24, wish=pf.pin("pelvis", 0, [0, 0.9, 0]), steps=3)
    pull(editor, WRIST, 7, [0.5, 1.0, 0.0])
    np.testing.assert_allclose(editor.motion.positions[0, 0], [0, 0.9, 0], atol=1e-6)
    np.testing.assert_allclose(editor.motion.positions[7, WRIST], [0.5, 1, 0], atol=1e-6)


def test_what_cannot_be_is_said_and_the_motion_stays():
    editor = PoseEditor(still, frames=24, wish=pf.pin("pelvis", 0, [0, 0.9, 0]), steps=3)
    before = editor.motion
    pull(editor, 0, 0, [0.5, 1.0, 0.0])
    assert editor.motion is before
    assert isinstance(editor.error, ValueError)
    assert "pelvis" in editor.status.value
    editor.undo.click()
    assert editor.error is None
