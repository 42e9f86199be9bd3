from itertools import pairwise

import numpy as np
import pytest

from projflow_lite import skeleton


def test_the_skeleton_is_one_tree_of_22_joints():
    assert len(skeleton.JOINTS) == 22
    assert len(skeleton.EDGES) == 21
    reached = {0}
    for parent, child in skeleton.EDGES:
        assert parent in reached
        reached.add(child)
    assert reached == set(range(22))


def test_every_chain_follows_the_parents():
    for chain in skeleton.CHAINS:
        for parent, child in pairwise(chain):
            assert skeleton.PARENTS[child] == parent


def test_a_mirrored_motion_mirrored_again_is_the_motion():
    x = np.random.default_rng(0).normal(size=(5, 22, 3))
    np.testing.assert_array_equal(skeleton.mirror(skeleton.mirror(x)), x)
    left, right = skeleton.JOINTS.index("left_wrist"), skeleton.JOINTS.index("right_wrist")
    np.testing.assert_array_equal(skeleton.mirror(x)[:, left], x[:, right] * [-1, 1, 1])


def test_bone_lengths_of_a_body_whose_bones_are_all_one_metre():
    x = np.zeros((1, 22, 3))
    for parent, child in skeleton.EDGES:
        x[0, child] = x[0, parent] + [0.6, 0.0, 0.8]
    np.testing.assert_allclose(skeleton.bone_lengths(x), np.ones((1, 21)), atol=1e-12)


@pytest.mark.parametrize(
    ("joint", "message"),
    [
        ("left_wirst", "pin: 'left_wirst' is not a joint; did you mean 'left_wrist'?"),
        ("Left Wrist", "pin: 'Left Wrist' is not a joint; did you mean 'left_wrist'?"),
        ("zzz", "pin: 'zzz' is not a joint; the joints are pelvis"),
        (22, "pin: joint 22 is outside 0..21"),
        (-1, "pin: joint -1 is outside 0..21"),
        (1.5, "pin: a joint is a name or an integer, not 1.5"),
        (True, "pin: a joint is a name or an integer, not True"),
    ],
)
def test_a_wrong_joint_is_named_and_the_nearest_proposed(joint, message):
    with pytest.raises(ValueError, match="joint") as caught:
        skeleton.joint_index(joint, "pin")
    assert str(caught.value).startswith(message)
