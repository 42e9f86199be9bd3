"""What must be true of every synthetic clip, measured from its joint positions alone."""

import numpy as np
import pytest

from data_synth import ACTIONS, make_clips
from projflow_lite import scores
from projflow_lite.skeleton import EDGES, JOINTS, bone_lengths

FPS = 20
J = {name: k for k, name in enumerate(JOINTS)}
FEET = (J["left_foot"], J["right_foot"])
LOCOMOTION = (
    "walk", "run", "jog", "sneak", "walk_curve", "walk_backward", "sidestep", "walk_and_wave",
    "walk_and_point", "walk_and_carry",
)  # fmt: skip
ON_THE_SPOT = ("squat", "sit", "bow", "wave", "reach", "point", "clap", "throw", "punch", "carry",
               "draw", "raise_arms", "sway", "idle")  # fmt: skip


@pytest.fixture(scope="module")
def clips():
    return {name: make_clips(60, seed=11, actions=[name]) for name in ACTIONS}


def angle(a, b):
    """Angle between vectors, radians."""
    cosine = (a * b).sum(-1) / np.linalg.norm(a, axis=-1) / np.linalg.norm(b, axis=-1)
    return np.arccos(cosine.clip(-1, 1))


@pytest.mark.parametrize("action", ACTIONS)
def test_bones_keep_their_length(clips, action):
    lengths = bone_lengths(clips[action].positions.astype(float))
    assert np.ptp(lengths, axis=1).max() < 1e-5


def test_bones_have_human_lengths_that_differ_between_bodies(clips):
    lengths = bone_lengths(clips["walk"].positions)[:, 0]
    names = [JOINTS[child] for _, child in EDGES]
    for name, low, high in (
        ("left_knee", 0.36, 0.45),
        ("left_ankle", 0.38, 0.48),
        ("left_wrist", 0.23, 0.31),
    ):
        bone = lengths[:, names.index(name)]
        assert low < bone.min() < bone.max() < high
        assert bone.std() > 0.005
    np.testing.assert_allclose(
        lengths[:, names.index("left_elbow")], lengths[:, names.index("right_elbow")], atol=1e-5
    )


@pytest.mark.parametrize("action", ACTIONS)
def test_the_floor_holds_and_the_first_frame_stands_over_the_origin(clips, action):
    x = clips[action].positions
    assert x[..., 1].min() > -0.01
    np.testing.assert_allclose(x[:, 0, 0, [0, 2]], 0, atol=1e-6)
    hips = x[:, 0, J["left_hip"]] - x[:, 0, J["right_hip"]]
    facing = np.stack([-hips[:, 2], hips[:, 0]], axis=1)  # x and z of straight ahead
    assert np.abs(np.arctan2(facing[:, 0], facing[:, 1])).max() < 0.35


@pytest.mark.parametrize("action", ACTIONS)
def test_planted_feet_do_not_slide(clips, action):
    """A toe that is down in three frames running has not moved in the middle one."""
    toes = clips[action].positions[:, :, FEET].astype(float)
    down = toes[..., 1] < 0.0125
    planted = down[:, :-2] & down[:, 1:-1] & down[:, 2:]
    moved = np.linalg.norm(np.diff(toes, axis=1), axis=-1)
    assert planted.mean() > {"run": 0.1, "jog": 0.15}.get(action, 0.3)
    assert moved[:, 1:][planted].max() < 1e-3


@pytest.mark.parametrize("action", ACTIONS)
def test_joints_bend_the_human_way(clips, action):
    x = clips[action].positions.astype(float)
    for side in ("left", "right"):
        hip, knee, ankle = (x[:, :, J[f"{side}_{part}"]] for part in ("hip", "knee", "ankle"))
        axis = np.cross(ankle - knee, knee - hip)  # to the right, if the knee points ahead
        to_the_right = x[:, :, J["right_hip"]] - x[:, :, J["left_hip"]]
        flexion = angle(ankle - knee, knee - hip)
        assert flexion.max() < np.radians(155)
        clear = flexion > np.radians(8)
        assert ((axis * to_the_right).sum(-1)[clear] > 0).mean() > 0.999
        shoulder, elbow, wrist = (
            x[:, :, J[f"{side}_{part}"]] for part in ("shoulder", "elbow", "wrist")
        )
        assert angle(wrist - elbow, elbow - shoulder).max() < np.radians(160)


@pytest.mark.parametrize("action", ACTIONS)
def test_no_limb_is_overstretched_and_nothing_pops(clips, action):
    x = clips[action].positions.astype(float)
    for a, b, c in (("hip", "knee", "ankle"), ("shoulder", "elbow", "wrist")):
        for side in ("left", "right"):
            first, middle, last = (x[:, :, J[f"{side}_{part}"]] for part in (a, b, c))
            straight = np.linalg.norm(middle - first, axis=-1) + np.linalg.norm(
                last - middle, axis=-1
            )
            assert (np.linalg.norm(last - first, axis=-1) / straight).max() < 0.9999
    # Real clips reach 40 m/s² in walking and 55 in running and jumping, in the median.
    limit = {"throw": 160}.get(action, 120)
    assert scores.worst_acceleration(x).max() < limit


@pytest.mark.parametrize("action", ON_THE_SPOT)
def test_feet_that_have_no_business_moving_stay(clips, action):
    feet = clips[action].positions[:, :, FEET]
    assert np.ptp(feet, axis=1).max() < 1e-4


def test_hops_fall_with_gravity_on_one_leg(clips):
    x, drawn = clips["hop"].positions.astype(float), clips["hop"].parameters
    own = np.where(drawn["side"] > 0, *FEET)
    other = np.where(drawn["side"] > 0, *FEET[::-1])
    rows = np.arange(len(x))
    stands, free = x[rows, :, own, 1], x[rows, :, other, 1]
    aloft = (stands > 0.04) & (free > 0.06)
    middle = aloft[:, :-2] & aloft[:, 1:-1] & aloft[:, 2:]
    acceleration = np.diff(x[:, :, 0, 1], 2, axis=1) * FPS**2
    assert middle.sum() > 20
    assert np.median(acceleration[middle]) == pytest.approx(-9.81, abs=0.6)
    flights = ((stands[:, :-1] <= 0.015) & (stands[:, 1:] > 0.015)).sum(1)
    np.testing.assert_array_equal(flights, drawn["times"])


def test_starting_ends_in_walking_and_stopping_ends_at_rest(clips):
    for action, resting, going in (
        ("walk_start", slice(0, 5), slice(-12, None)),
        ("walk_stop", slice(-5, None), slice(0, 12)),
    ):
        pelvis = clips[action].positions[:, :, 0, [0, 2]].astype(float)
        pace = np.linalg.norm(np.diff(pelvis, axis=1), axis=-1) * FPS
        assert np.median(pace[:, resting]) < 0.12
        assert np.median(pace[:, going]) == pytest.approx(
            np.median(clips[action].parameters["speed"]), rel=0.15
        )


def facing(x):
    """Direction in which the hips face, radians to the left of +z, unwrapped, ``(n, frames)``."""
    hips = x[:, :, J["left_hip"]] - x[:, :, J["right_hip"]]
    return np.unwrap(np.arctan2(-hips[..., 2], hips[..., 0]), axis=1)


@pytest.mark.parametrize("action", ["turn", "walk_turn"])
def test_turns_go_as_far_and_to_the_side_they_say(clips, action):
    heading = facing(clips[action].positions.astype(float))
    drawn = clips[action].parameters
    turned = heading[:, -4:].mean(1) - heading[:, :4].mean(1)
    np.testing.assert_allclose(turned, drawn["side"] * drawn["angle"], atol=0.45)


def test_turning_and_marching_stay_on_the_spot(clips):
    for action in ("turn", "march"):
        pelvis = clips[action].positions[:, :, 0, [0, 2]]
        assert np.linalg.norm(pelvis, axis=-1).max() < 0.25


def test_a_jump_falls_with_gravity(clips):
    x, height = clips["jump"].positions.astype(float), clips["jump"].parameters["height"]
    aloft = (x[:, :, FEET, 1] > 0.06).all(-1)
    middle = aloft[:, :-2] & aloft[:, 1:-1] & aloft[:, 2:]
    acceleration = np.diff(x[:, :, 0, 1], 2, axis=1) * FPS**2
    assert middle.sum() > 100
    np.testing.assert_allclose(acceleration[middle], -9.81, atol=0.05)
    rise = x[:, :, 0, 1].max(1) - x[:, 0, 0, 1]
    assert np.corrcoef(rise, height)[0, 1] > 0.95


def test_runs_fly_and_walks_do_not(clips):
    def share_aloft(action):
        ankles = clips[action].positions[:, :, FEET, 1]
        return (ankles > 0.03).all(-1).mean()

    assert share_aloft("run") > 0.1
    assert share_aloft("walk") < 0.02


@pytest.mark.parametrize("action", LOCOMOTION)
def test_the_body_travels_as_fast_as_it_says(clips, action):
    path = clips[action].positions[:, :, 0, [0, 2]].astype(float)
    smooth = path[:, ::10]  # half a second: sway and bob leave no trace
    travelled = np.linalg.norm(np.diff(smooth, axis=1), axis=-1).sum(1) / (50 / FPS)
    said = np.abs(clips[action].parameters["speed"])
    np.testing.assert_allclose(travelled, said, rtol=0.2, atol=0.05)


def test_walking_matches_real_walking():
    """Medians of real walks, measured on motion capture, with room for our own spread."""
    x = make_clips(200, seed=3, actions=["walk"]).positions.astype(float)
    pelvis = x[:, :, 0]
    bob = np.median([np.ptp(p[k : k + 11, 1]) for p in pelvis for k in range(0, 48, 12)])
    swing = np.median(np.ptp(x[:, :, J["left_wrist"], 2] - x[:, :, 0, 2], axis=1))
    left, right = x[:, :, J["left_wrist"]] - pelvis, x[:, :, J["right_ankle"]] - pelvis
    together = np.median(
        [np.corrcoef(a[:, 2], b[:, 2])[0, 1] for a, b in zip(left, right, strict=True)]
    )
    lift = np.median(np.ptp(x[:, :, [J["left_ankle"], J["right_ankle"]], 1], axis=1))
    assert 0.019 < bob < 0.031
    assert 0.22 < swing < 0.36
    assert 0.150 < lift < 0.205
    assert together > 0.94


@pytest.mark.parametrize("frames", [20, 45, 100, 196])
def test_every_action_has_every_length(frames):
    clips = make_clips(2 * len(ACTIONS), frames=frames, seed=1)
    assert clips.positions.shape == (2 * len(ACTIONS), frames, 22, 3)
    assert np.isfinite(clips.positions).all()
    assert scores.worst_acceleration(clips.positions).max() < 260


def test_speeds_of_walks_spread_like_real_ones():
    speed = make_clips(400, seed=5, actions=["walk"]).parameters["speed"]
    assert np.median(speed) == pytest.approx(1.21, abs=0.06)
    assert np.percentile(speed, 10) == pytest.approx(0.90, abs=0.08)
    assert np.percentile(speed, 90) == pytest.approx(1.54, abs=0.08)
