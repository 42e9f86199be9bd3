"""Seeds, captions that tell the truth, and errors."""

import numpy as np
import pytest

from data_synth import ACTIONS, make_clips
from projflow_lite.skeleton import JOINTS

LEFT, RIGHT = JOINTS.index("left_wrist"), JOINTS.index("right_wrist")


def travelled(clips, joint):
    """Length of a joint's path around the pelvis, ``(n,)`` metres."""
    around = clips.positions[:, :, joint] - clips.positions[:, :, 0]
    return np.linalg.norm(np.diff(around, axis=1), axis=-1).sum(1)


def test_the_same_seed_gives_the_same_clips_and_another_one_others():
    a, b, c = make_clips(33, seed=4), make_clips(33, seed=4), make_clips(33, seed=5)
    np.testing.assert_array_equal(a.positions, b.positions)
    assert (a.captions, a.actions) == (b.captions, b.actions)
    assert np.abs(a.positions - c.positions).max() > 0.1


def test_actions_come_equally_often():
    clips = make_clips(10 * len(ACTIONS), seed=0)
    assert {name: clips.actions.count(name) for name in ACTIONS} == dict.fromkeys(ACTIONS, 10)
    assert clips.positions.dtype == np.float32
    assert set(make_clips(6, actions="jump").actions) == {"jump"}


def test_parameters_are_nan_where_an_action_has_none():
    clips = make_clips(50, seed=0, actions=["walk", "squat"])
    walks = np.array([name == "walk" for name in clips.actions])
    assert np.isfinite(clips.parameters["speed"][walks]).all()
    assert np.isnan(clips.parameters["speed"][~walks]).all()


def test_a_caption_names_the_hand_that_waves():
    clips = make_clips(200, seed=2, actions=["wave"])
    left, right = travelled(clips, LEFT), travelled(clips, RIGHT)
    for caption, l, r in zip(clips.captions, left, right, strict=True):
        if "both" in caption:
            assert 0.3 < l / r < 3
        else:
            assert ("left" in caption) == (l > r), caption
            assert ("right" in caption) == (r > l), caption


def test_a_caption_names_the_hand_that_reaches():
    clips = make_clips(200, seed=2, actions=["reach"])
    moves_left = travelled(clips, LEFT) > travelled(clips, RIGHT)
    said_left = np.array(["left" in caption for caption in clips.captions])
    said_right = np.array(["right" in caption for caption in clips.captions])
    assert (said_left | said_right).mean() > 0.5
    assert moves_left[said_left].all()
    assert not moves_left[said_right].any()


def test_a_caption_names_the_way():
    for action, axis in (("sidestep", 0), ("walk_curve", 0)):
        clips = make_clips(200, seed=2, actions=[action])
        end = clips.positions[:, -1, 0]
        for caption, place in zip(clips.captions, end, strict=True):
            if "left" in caption:
                assert place[axis] > 0.1, caption
            if "right" in caption:
                assert place[axis] < -0.1, caption


def test_forward_is_ahead_and_backward_is_not():
    for action, sign in (("walk", 1), ("run", 1), ("walk_backward", -1), ("walk_and_wave", 1)):
        end = make_clips(60, seed=2, actions=[action]).positions[:, -1, 0, 2]
        assert (sign * end > 0.5).all()


def test_slowly_is_slower_than_quickly():
    clips = make_clips(300, seed=2, actions=["walk"])
    speed = clips.parameters["speed"]
    slow = np.array(["slowly" in caption for caption in clips.captions])
    quick = np.array(["quickly" in caption for caption in clips.captions])
    assert speed[slow].max() < speed[~slow & ~quick].min()
    assert speed[quick].min() > speed[~slow & ~quick].max()


def test_jumping_ahead_goes_ahead_and_squatting_twice_goes_down_twice():
    jumps = make_clips(100, seed=2, actions=["jump"])
    for caption, end in zip(jumps.captions, jumps.positions[:, -1, 0, 2], strict=True):
        assert ("forward" in caption) == (end > 0.14), caption
    squats = make_clips(100, seed=2, actions=["squat"])
    height = squats.positions[:, :, 0, 1]
    middle = height - (height.max(1) + height.min(1))[:, None] / 2
    down = ((middle[:, :-1] > 0) & (middle[:, 1:] <= 0)).sum(1)
    for caption, count in zip(squats.captions, down, strict=True):
        assert count == (2 if "twice" in caption or "two" in caption else 1), caption


WRONG = [
    (
        lambda: make_clips(3, actions=["wlak"]),
        "make_clips: 'wlak' is not an action; did you mean 'walk'?",
    ),
    (lambda: make_clips(3, actions=[]), "make_clips: actions is an empty list"),
    (lambda: make_clips(0), "make_clips: n is a whole number of at least 1, not 0"),
    (lambda: make_clips(2.5), "make_clips: n is a whole number of at least 1, not 2.5"),
    (lambda: make_clips(3, frames=19), "make_clips: frames is 20 to 196, not 19"),
    (lambda: make_clips(3, frames=197), "make_clips: frames is 20 to 196, not 197"),
]


@pytest.mark.parametrize(("make", "message"), WRONG, ids=[m for _, m in WRONG])
def test_wrong_arguments_are_refused(make, message):
    with pytest.raises(ValueError, match="make_clips") as caught:
        make()
    assert str(caught.value) == message
