"""What captions say of direction, speed and hand, measured from joint positions alone."""

import numpy as np
import pytest

from data_synth import make_clips
from data_synth.captions import CASES, PACE, SAID
from projflow_lite.skeleton import FPS, JOINTS

J = {name: k for k, name in enumerate(JOINTS)}


def said(clips, *words):
    """Which captions hold one of the words, ``(n,)``."""
    return np.array([any(word in caption for word in words) for caption in clips.captions])


def rate_of(curve):
    """The frequency that a curve ``(n, frames)`` has most of, Hz."""
    curve = curve - curve.mean(1, keepdims=True)
    power = np.abs(np.fft.rfft(curve * np.hanning(curve.shape[1]), 1024, axis=1)) ** 2
    return np.fft.rfftfreq(1024, 1 / FPS)[power.argmax(1)]


def pace(action, x):
    """How quick an action is, whatever that means for it, from positions."""
    if action == "clap":
        apart = np.linalg.norm(x[:, :, J["left_wrist"]] - x[:, :, J["right_wrist"]], axis=-1)
        return rate_of(np.diff(apart[:, 25:-25], axis=1))  # the rise of the hands is slow
    if action == "sway":
        return rate_of(x[:, 20:, 0, 0])
    half = x[:, ::10, 0][..., [0, 2]]
    return np.linalg.norm(np.diff(half, axis=1), axis=-1).mean(1) * FPS / 10


@pytest.mark.parametrize("action", PACE)
def test_slowly_is_slow_and_quickly_is_quick(action):
    clips = make_clips(200, 120, seed=3, actions=[action])
    measured = pace(action, clips.positions.astype(float))
    slow, quick = said(clips, "slowly"), said(clips, "quickly")
    low, high = PACE[action]
    assert slow.sum() > 5
    assert quick.sum() > 5
    assert not (slow & quick).any()
    room = 0.12 * high  # a wobble of the speed, or the grid of a spectrum
    assert measured[slow].max() < low + room
    assert measured[quick].min() > high - room
    assert measured[~slow & ~quick].min() > low - room
    assert measured[~slow & ~quick].max() < high + room


def turned(x):
    """How far to the left the hips have turned in the end, ``(n,)`` radians."""
    hips = x[:, :, J["left_hip"]] - x[:, :, J["right_hip"]]
    heading = np.unwrap(np.arctan2(-hips[..., 2], hips[..., 0]), axis=1)
    return heading[:, -4:].mean(1) - heading[:, :4].mean(1)


@pytest.mark.parametrize("action", ["turn", "walk_turn", "walk_curve"])
def test_left_is_left_and_round_is_round(action):
    clips = make_clips(200, seed=3, actions=[action])
    angle = turned(clips.positions.astype(float))
    assert (angle[said(clips, "left")] > 0.2).all()
    assert (angle[said(clips, "right")] < -0.2).all()
    assert (said(clips, "left") | said(clips, "right")).mean() > 0.3
    if action != "walk_curve":
        round_ = said(clips, "around")
        assert round_.any()
        assert np.abs(angle[round_]).min() > 2.1
        assert np.abs(angle[~round_]).max() < 2.9


@pytest.mark.parametrize("action", ["reach", "point", "walk_and_point"])
def test_hands_go_where_the_caption_says(action):
    clips = make_clips(240, seed=3, actions=[action])
    x = clips.positions.astype(float)
    hands = x[:, :, [J["left_wrist"], J["right_wrist"]]]
    shoulders = x[:, :, [J["left_shoulder"], J["right_shoulder"]]]
    out = np.linalg.norm(hands - x[:, :, [J["neck"]]], axis=-1).max(1)  # (n, 2)
    up = (hands - shoulders)[..., 1].max((1, 2))
    raised = said(clips, " up ", " up high", "high up", "something high", "arm up")
    assert raised.sum() > 20
    assert up[raised].min() > 0.3
    others = said(clips, "to the left", "to the right", "to the side", " down", "low")
    assert up[others].max() < 0.3
    # A hand reaches further from the neck than one that hangs or swings.
    left, right = said(clips, "left"), said(clips, "right")
    acts = np.abs(turned_arm(x))
    assert (acts[left, 0] > acts[left, 1]).all()
    assert (acts[right, 1] > acts[right, 0]).all()
    assert out.max() < 1.2


def turned_arm(x):
    """By how much the angle between each arm and the trunk changes, ``(n, 2)`` radians."""
    trunk = x[:, :, J["spine3"]] - x[:, :, J["neck"]]
    spans = []
    for side in ("left", "right"):
        arm = x[:, :, J[f"{side}_wrist"]] - x[:, :, J[f"{side}_shoulder"]]
        size = np.linalg.norm(arm, axis=-1) * np.linalg.norm(trunk, axis=-1)
        spans.append(np.ptp(np.arccos((arm * trunk).sum(-1) / size), axis=1))
    return np.stack(spans, axis=1)


def test_a_high_kick_is_higher():
    clips = make_clips(240, 120, seed=3, actions=["kick"])
    feet = clips.positions[:, :, [J["left_foot"], J["right_foot"]], 1].max((1, 2))
    high = said(clips, "kicks high", "high kick", "kicks up")
    assert high.sum() > 10
    assert feet[high].min() > 0.42


def test_a_walking_body_walks_while_its_hands_act():
    for action, words in (
        ("walk_and_wave", "wav"), ("walk_and_point", "point"), ("walk_and_carry", "carr"),
    ):  # fmt: skip
        clips = make_clips(60, seed=3, actions=[action])
        assert (clips.positions[:, -1, 0, 2] > 1.0).all()
        assert said(clips, "walk").mean() + said(clips, "carries a box").mean() >= 1.0
        assert said(clips, words, "hold").all()


def test_every_case_of_every_action_can_be_said_in_four_ways_or_more():
    for action, endings in CASES.items():
        assert {action + ending for ending in endings} <= set(SAID)
    for case, ways in SAID.items():
        assert len(set(ways)) == len(ways) >= 4, case
