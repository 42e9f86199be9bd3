"""No joint bends further than a person's, flights obey gravity, and any length will do."""

import numpy as np
import pytest

from data_synth import ACTIONS, make_clips
from data_synth.angles import HUMAN, joint_angles
from projflow_lite.skeleton import FPS, JOINTS, MASS, bone_lengths
from projflow_lite.widgets.standing import standing_pose

J = {name: k for k, name in enumerate(JOINTS)}
FEET = [J["left_foot"], J["right_foot"]]
UPPER = [J[n] for n in JOINTS if not n.endswith(("pelvis", "hip", "knee", "ankle", "foot"))]


def turned(points, about, axis, degrees):
    """Points rotated about a place, by the right-hand rule (Rodrigues' formula)."""
    k, a = np.eye(3)["xyz".index(axis)], np.radians(degrees)
    v = points - about
    return (
        about
        + v * np.cos(a)
        + np.cross(np.broadcast_to(k, v.shape), v) * np.sin(a)
        + k * (v @ k)[..., None] * (1 - np.cos(a))
    )


def puppet():
    """A body whose every angle is zero: upright, legs and arms straight down."""
    x = np.zeros((22, 3))
    x[:, 1] = [1, 0.9, 0.9, 1.1, 0.5, 0.5, 1.2, 0.1, 0.1, 1.3, 0.05, 0.05, 1.5, 1.4, 1.4, 1.6,
               1.4, 1.4, 1.1, 1.1, 0.8, 0.8]  # fmt: skip
    for name, at in J.items():
        wide = 0.2 if at >= J["left_shoulder"] else 0.1
        x[at, 0] = wide * (name.startswith("left") - float(name.startswith("right")))
    x[FEET, 2] = 0.05 / np.tan(np.radians(18.5))  # as a flat foot slopes
    return x


BENT = [
    # name, joints that move, about which joint, axis, degrees, expected (left and right or one)
    ("knee", ["left_ankle", "left_foot"], "left_knee", "x", 60, (60, 0)),
    ("hip ahead", ["left_knee", "left_ankle", "left_foot"], "left_hip", "x", -40, (40, 0)),
    ("hip aside", ["left_knee", "left_ankle", "left_foot"], "left_hip", "z", 25, (25, 0)),
    ("hip aside", ["right_knee", "right_ankle", "right_foot"], "right_hip", "z", -25, (0, 25)),
    ("ankle up", ["right_foot"], "right_ankle", "x", -30, (0, 30)),
    ("ankle up", ["left_foot"], "left_ankle", "x", 45, (-45, 0)),
    ("elbow", ["right_wrist"], "right_elbow", "x", -90, (0, 90)),
    ("shoulder from hanging", ["left_elbow", "left_wrist"], "left_shoulder", "x", -120, (120, 0)),
    ("shoulder from hanging", ["right_elbow", "right_wrist"], "right_shoulder", "z", -70, (0, 70)),
    ("neck ahead", ["head"], "neck", "x", 30, 30),
    ("neck to the side", ["head"], "neck", "z", -20, 20),
    ("trunk ahead", "upper", "spine1", "x", 35, 35),
    ("trunk to the side", "upper", "spine1", "z", -15, 15),
    ("trunk twist", "upper", "spine1", "y", 20, 20),
]


@pytest.mark.parametrize(
    ("name", "moving", "about", "axis", "degrees", "expected"), BENT, ids=[b[0] for b in BENT]
)
@pytest.mark.parametrize("faces", [0, 130])
def test_an_angle_is_what_the_puppet_was_bent_by(
    name, moving, about, axis, degrees, expected, faces
):
    x = puppet()
    joints = [j for j in UPPER if j != J["spine1"]] if moving == "upper" else [J[m] for m in moving]
    x[joints] = turned(x[joints], x[J[about]], axis, degrees)
    x = turned(x, np.zeros(3), "y", faces)
    angles = joint_angles(x)
    np.testing.assert_allclose(angles[name], expected, atol=1e-6)
    hardly = {"knee", "elbow", "hip ahead", "hip aside", "trunk twist"} - {name}
    for other in hardly:
        np.testing.assert_allclose(angles[other], 0, atol=1e-6, err_msg=other)


def test_a_standing_person_is_near_zero_everywhere():
    for name, value in joint_angles(standing_pose()).items():
        assert np.abs(value).max() < 35, name


@pytest.mark.parametrize("action", ACTIONS)
def test_no_joint_bends_past_a_human_range(action):
    for frames in (20, 60, 150):
        angles = joint_angles(make_clips(60, frames, seed=11, actions=[action]).positions)
        for name, (low, high) in HUMAN.items():
            assert low <= angles[name].min(), (name, frames)
            assert angles[name].max() <= high, (name, frames)


def test_a_clip_with_a_broken_ankle_would_be_seen():
    x = make_clips(1, actions=["idle"]).positions[0, 0].astype(float)
    foot, ankle = J["left_foot"], J["left_ankle"]
    x[foot] = turned(x[foot], x[ankle], "x", -60)
    assert joint_angles(x)["ankle up"][0] > HUMAN["ankle up"].high


def test_joints_reach_far_where_the_action_says_so():
    def most(action, name):
        return joint_angles(make_clips(60, seed=1, actions=[action]).positions)[name].max()

    assert most("squat", "knee") > 80
    assert most("bow", "trunk ahead") > 25
    assert most("raise_arms", "shoulder from hanging") > 140
    assert most("kick", "hip ahead") > 60


@pytest.mark.parametrize(("action", "tolerance"), [("jump", 1.6), ("hop", 1.6), ("run", 2.5)])
def test_the_whole_body_falls_in_flight(action, tolerance):
    """Centre of mass: limbs that move in the air shift it in the body, hence the tolerance."""
    x = make_clips(150, seed=11, actions=[action]).positions.astype(float)
    height = np.einsum("j,nfjc->nfc", np.array(MASS), x)[..., 1]
    aloft = (x[:, :, FEET, 1] > 0.03).all(-1)
    flying = aloft[:, :-2] & aloft[:, 1:-1] & aloft[:, 2:]
    fall = np.diff(height, 2, axis=1)[flying] * FPS**2
    assert len(fall) > 40
    assert np.median(fall) == pytest.approx(-9.81, abs=tolerance)


def test_every_length_from_20_to_196_is_whole():
    """One or two actions for each length, in turn: finite, on the floor, bones constant."""
    for frames in range(20, 197):
        some = [ACTIONS[(2 * frames + k) % len(ACTIONS)] for k in (0, 1)]
        x = make_clips(2, frames, seed=frames, actions=some).positions.astype(float)
        assert x.shape == (2, frames, 22, 3)
        assert np.isfinite(x).all(), (frames, some)
        assert np.ptp(bone_lengths(x), axis=1).max() < 1e-5, (frames, some)
        assert x[..., 1].min() > -0.01, (frames, some)
