"""Seeds, captions that tell the truth, and errors."""

import numpy as np
import pytest

from data_synth import ACTIONS, dataset, held_out, make_clips, stream
from data_synth.captions import PACE, SAID, WHO
from projflow_lite.skeleton import JOINTS

LEFT, RIGHT = JOINTS.index("left_wrist"), JOINTS.index("right_wrist")


def raised(clips, side):
    """How much the angle between an arm and the spine changes, ``(n,)`` radians."""
    x = clips.positions.astype(float)
    wrist, shoulder, low, high = (
        x[:, :, JOINTS.index(j)] for j in (f"{side}_wrist", f"{side}_shoulder", "spine3", "neck")
    )
    arm, down = wrist - shoulder, low - high
    size = np.linalg.norm(arm, axis=-1) * np.linalg.norm(down, axis=-1)
    return np.ptp(np.arccos((arm * down).sum(-1) / size), axis=1)


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
    assert len(ACTIONS) >= 24


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


@pytest.mark.parametrize("action", ["reach", "point", "throw", "draw", "walk_and_point"])
def test_a_caption_names_the_hand_that_acts(action):
    clips = make_clips(200, seed=2, actions=[action])
    left, right = raised(clips, "left"), raised(clips, "right")
    said_left = np.array(["left" in caption for caption in clips.captions])
    said_right = np.array(["right" in caption for caption in clips.captions])
    assert (said_left | said_right).mean() > 0.5
    assert (left > right)[said_left].all()
    assert (right > left)[said_right].all()


@pytest.mark.parametrize("action", ["kick", "lunge"])
def test_a_caption_names_the_leg_that_acts(action):
    clips = make_clips(200, seed=2, actions=[action])
    ahead = np.ptp(clips.positions[:, :, [10, 11], 2], axis=1)
    for caption, (left, right) in zip(clips.captions, ahead, strict=True):
        assert ("left" in caption) == (left > right), caption
        assert ("right" in caption) == (right > left), caption


@pytest.mark.parametrize("action", ["hop", "balance"])
def test_a_caption_names_the_leg_that_carries(action):
    clips = make_clips(200, seed=2, actions=[action])
    lifted = clips.positions[:, :, [10, 11], 1].mean(1)
    for caption, (left, right) in zip(clips.captions, lifted, strict=True):
        carries = "left" if left < right else "right"
        raised = "right" if left < right else "left"
        assert carries in caption or f"lifts the {raised}" in caption, caption


COUNT = {"twice": 2, "three times": 3}


def bumps(curve, share=0.5):
    """How often each curve ``(n, frames)`` rises above a share of its range."""
    low, high = curve.min(1, keepdims=True), curve.max(1, keepdims=True)
    above = curve > low + share * (high - low)
    return above[:, 0] + (above[:, 1:] & ~above[:, :-1]).sum(1)


@pytest.mark.parametrize("action", ["squat", "bow", "kick", "raise_arms", "lunge"])
def test_a_caption_counts_truly(action):
    clips = make_clips(150, frames=150, seed=2, actions=[action])
    x = clips.positions.astype(float)
    curve = {
        "squat": -x[:, :, 0, 1],
        "bow": -x[:, :, JOINTS.index("head"), 1],
        "kick": x[:, :, [10, 11], 2].max(-1),
        "raise_arms": x[:, :, [LEFT, RIGHT], 1].sum(-1),
        "lunge": -x[:, :, 0, 1],
    }[action]
    said = [next((n for word, n in COUNT.items() if word in c), 1) for c in clips.captions]
    np.testing.assert_array_equal(bumps(curve), said)


def test_sitting_down_ends_low_and_getting_up_begins_low():
    clips = make_clips(150, seed=2, actions=["sit"])
    height = clips.positions[:, :, 0, 1]
    seated = height < 0.7
    for caption, low in zip(clips.captions, seated, strict=True):
        if "sits" in caption or "to sitting" in caption or "sitting down" in caption:
            assert not low[0], caption
            assert low.any(), caption
            assert low[-1] != ("up" in caption), caption
        else:
            assert low[0], caption
            assert not low[-1], caption


def test_every_action_has_several_captions_and_the_words_are_few():
    clips = [make_clips(1200, frames=f, seed=s) for s, f in enumerate((20, 60, 150))]
    said = {(a, c) for k in clips for a, c in zip(k.actions, k.captions, strict=True)}
    for action in ACTIONS:
        ways = {c for a, c in said if a == action and c.startswith("a person ")}
        assert len(ways) >= 4, action
    assert min(map(len, SAID.values())) >= 4
    assert len({word.strip(",") for _, c in said for word in c.split()}) <= 165
    assert all(c.startswith(WHO) and "{" not in c for _, c in said)
    assert set(PACE) <= set(ACTIONS)


def test_a_stream_never_repeats_and_can_be_resumed():
    one, again = stream(20, seed=7), stream(20, seed=7, first=1)
    first, second = next(one), next(one)
    np.testing.assert_array_equal(second.positions, next(again).positions)
    assert np.abs(first.positions - second.positions).max() > 0.1
    assert first.positions.shape == (20, 60, 22, 3)


def test_held_out_clips_are_fixed_and_no_training_clip_is_among_them():
    small, large = held_out(30, 30), held_out(400, 30)
    np.testing.assert_array_equal(small.positions, large.positions[:30])
    assert small.captions == large.captions[:30]
    assert all(len(values) == 400 for values in large.parameters.values())
    held = {clip.tobytes() for clip in large.positions}
    assert len(held) == 400
    for clips in (
        make_clips(340, 30, seed=0),
        make_clips(340, 30, seed=2**31),
        make_clips(340, 30, seed=2**62),
        next(stream(340, 30)),
        held_out(340, 30, seed=1),
    ):
        assert not held & {clip.tobytes() for clip in clips.positions}


@pytest.mark.parametrize("seed", [0, 5, 2**31, 2**63 - 1])
def test_no_training_seed_draws_the_numbers_of_held_out_clips(seed, monkeypatch):
    """Whatever is asked for, the generators start in different states."""
    started = []

    def record(random, order, frames, names):
        started.append(random.bit_generator.state["state"]["state"])
        return original(random, order[:1], frames, names)

    original = dataset.drawn_with
    monkeypatch.setattr(dataset, "drawn_with", record)
    frames = 30
    for other in (0, seed, seed + 1 if seed < 2**63 - 1 else 1):
        held_out(3 * 10 * 2, frames, other, ["idle", "walk"])
    held = {*started}
    started.clear()
    for number in (seed, seed + frames, frames, 2**32 + frames):
        make_clips(1, frames, min(number, 2**63 - 1), ["idle"])
        for first in (0, 1, 2, frames, frames + 2**32, 2**32):
            next(stream(1, frames, min(number, 2**63 - 1), ["idle"], first=first))
    assert not held & {*started}


def test_held_out_actions_come_equally_often_in_every_set():
    for n in (34, 64, 200, 400):
        actions = held_out(n, 20).actions
        counts = np.array([actions.count(name) for name in ACTIONS])
        assert np.ptp(counts) <= 1
    assert set(held_out(25, 20, actions=["squat", "bow"]).actions) == {"squat", "bow"}


def test_held_out_clips_of_another_length_have_other_captions():
    assert held_out(60, 40).captions != held_out(60, 60).captions
    assert held_out(60, 40).captions != held_out(60, 40, seed=1).captions


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


def test_jumping_ahead_goes_ahead():
    jumps = make_clips(100, seed=2, actions=["jump"])
    for caption, end in zip(jumps.captions, jumps.positions[:, -1, 0, 2], strict=True):
        assert ("forward" in caption or "ahead" in caption) == (end > 0.14), caption


WRONG = [
    (
        lambda: make_clips(3, actions=["wlak"]),
        "make_clips: 'wlak' is not an action; did you mean 'walk'?",
    ),
    (lambda: make_clips(3, actions=[]), "make_clips: actions is an empty list"),
    (lambda: make_clips(0), "make_clips: n is a whole number of at least 1, not 0"),
    (lambda: make_clips(2.5), "make_clips: n is a whole number of at least 1, not 2.5"),
    (lambda: make_clips(3, frames=19), "make_clips: frames is 20 to 196, not 19"),
    (
        lambda: make_clips(3, seed=-1),
        "make_clips: seed is a whole number from 0 to 2^63 - 1, not -1",
    ),
    (
        lambda: make_clips(3, seed=2**64),
        f"make_clips: seed is a whole number from 0 to 2^63 - 1, not {2**64}",
    ),
    (lambda: make_clips(3, frames=197), "make_clips: frames is 20 to 196, not 197"),
    (lambda: held_out(3, seed=-1), "held_out: seed is a whole number from 0 to 2^63 - 1, not -1"),
]


@pytest.mark.parametrize(("make", "message"), WRONG, ids=[m for _, m in WRONG])
def test_wrong_arguments_are_refused(make, message):
    with pytest.raises(ValueError, match="make_clips|held_out") as caught:
        make()
    assert str(caught.value) == message
