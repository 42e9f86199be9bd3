import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from projflow_lite import equations as eq


def random_motion(seed, frames=3, joints=4):
    return np.random.default_rng(seed).normal(size=(frames, joints, 3))


def test_a_camera_without_rotation_drops_the_depth():
    np.testing.assert_array_equal(
        eq.orthographic_projection([1.0, 2.0, 3.0], np.eye(3), 2.0), [2.0, 4.0]
    )


def test_a_camera_turned_to_the_side_sees_depth_as_width():
    # A quarter turn about the vertical takes z to x (and x to -z), by hand.
    quarter = [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]
    seen = eq.orthographic_projection([1.0, 2.0, 3.0], quarter, 1.0)
    np.testing.assert_array_equal(seen, [3.0, 2.0])


def test_projection_measures_along_the_cameras_own_axes():
    """Independent: picture coordinates are dot products with the camera's right and up."""
    x, rotation = random_motion(0), Rotation.from_euler("yxz", [40, -20, 5], degrees=True)
    right, up = rotation.inv().apply([1, 0, 0]), rotation.inv().apply([0, 1, 0])
    seen = eq.orthographic_projection(x, rotation.as_matrix(), 0.9)
    np.testing.assert_allclose(seen[..., 0], 0.9 * (x @ right), rtol=0, atol=1e-14)
    np.testing.assert_allclose(seen[..., 1], 0.9 * (x @ up), rtol=0, atol=1e-14)


@given(st.integers(0, 2**32 - 1), st.integers(1, 3), st.integers(1, 4))
def test_orthographic_rows_see_what_the_projection_sees(seed, frames, joints):
    rng = np.random.default_rng(seed)
    x, R_cam = random_motion(seed, frames, joints), Rotation.random(rng=rng).as_matrix()
    seen = eq.orthographic_projection(x, R_cam, 1.1)
    A = eq.orthographic_rows(frames, joints, R_cam, 1.1)
    np.testing.assert_allclose((A @ eq.vectorise(x)).reshape(seen.shape), seen, rtol=0, atol=1e-13)
    for shape in ((frames, joints), (frames, joints, 2)):
        selected = rng.integers(0, 2, shape).astype(bool)
        both = np.broadcast_to(selected.reshape(frames, joints, -1), (frames, joints, 2))
        by_hand = [seen[place] for place in np.ndindex(seen.shape) if both[place]]
        A = eq.orthographic_rows(frames, joints, R_cam, 1.1, selected)
        np.testing.assert_allclose(A @ eq.vectorise(x), by_hand, rtol=0, atol=1e-13)


def test_lifting_meets_the_picture_and_keeps_the_depth():
    x, R_cam = random_motion(1), Rotation.from_euler("yx", [30, 15], degrees=True).as_matrix()
    A = eq.orthographic_rows(3, 4, R_cam, 1.0)
    y = A @ eq.vectorise(random_motion(2))
    lifted = eq.project(eq.vectorise(x), A, y, np.eye(36), np.zeros((24, 24)))
    np.testing.assert_allclose(A @ lifted, y, rtol=0, atol=1e-13)
    # With R = I the missing direction is the prediction's own.
    depth = (x @ R_cam.T)[..., 2]
    np.testing.assert_allclose(
        (eq.unvectorise(lifted, 3, 4) @ R_cam.T)[..., 2], depth, rtol=0, atol=1e-13
    )


@given(st.integers(0, 2**32 - 1), st.integers(1, 4), st.permutations(range(4)))
def test_offset_rows_subtract_two_joints_in_every_frame(seed, frames, order):
    a, b = order[:2]
    x, d = random_motion(seed, frames), [0.1, -0.2, 0.3]
    A, y = eq.offset_rows(frames, 4, a, b, d)
    offsets = (A @ eq.vectorise(x)).reshape(frames, 3)
    for n in range(frames):
        for c in range(3):
            assert offsets[n, c] == pytest.approx(x[n, a, c] - x[n, b, c], abs=1e-14)
            assert y[3 * n + c] == d[c]
    np.testing.assert_array_equal(eq.relative_position(x, a, b).shape, (frames, 3))
    np.testing.assert_allclose(eq.relative_position(x, a, b), offsets, rtol=0, atol=1e-14)


def test_a_hold_holds():
    A, y = eq.offset_rows(3, 4, 2, 3, [0.4, 0, 0])
    held = eq.project(eq.vectorise(random_motion(5)), A, y, np.eye(36), np.zeros((9, 9)))
    held = eq.unvectorise(held, 3, 4)
    np.testing.assert_allclose(held[:, 2] - held[:, 3], [[0.4, 0, 0]] * 3, rtol=0, atol=1e-14)


@given(st.integers(0, 2**32 - 1), st.integers(1, 4), st.integers(1, 4))
def test_loop_rows_compare_the_first_and_the_last_frame(seed, frames, joints):
    x = random_motion(seed, frames, joints)
    A, y = eq.loop_rows(frames, joints)
    assert not y.any()
    gap = (A @ eq.vectorise(x)).reshape(joints, 3)
    for j in range(joints):
        for c in range(3):
            assert gap[j, c] == pytest.approx(x[0, j, c] - x[frames - 1, j, c], abs=1e-14)
    np.testing.assert_allclose(eq.loop_gap(x), gap, rtol=0, atol=1e-14)


def test_a_loop_closes_the_pose_but_not_the_velocity():
    """What eq. 37 does not promise: a straight walk bent into a loop turns back with a jerk."""
    x = np.zeros((5, 1, 3))
    x[:, 0, 2] = np.arange(5.0)
    A, y = eq.loop_rows(5, 1)
    closed = eq.unvectorise(eq.project(eq.vectorise(x), A, y, np.eye(15), np.zeros((3, 3))), 5, 1)
    np.testing.assert_allclose(eq.loop_gap(closed), 0, rtol=0, atol=1e-14)
    np.testing.assert_allclose(closed[:, 0, 2], [2, 1, 2, 3, 2], rtol=0, atol=1e-14)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: eq.orthographic_projection([0, 0, 0], np.diag([1, 1, -1]), 1), "not a rotation"),
        (lambda: eq.orthographic_projection([0, 0, 0], 2 * np.eye(3), 1), "not a rotation"),
        (lambda: eq.orthographic_projection([0, 0, 0], np.eye(3), 0), "scale"),
        (lambda: eq.orthographic_projection([0, 0], np.eye(3), 1), "x has shape"),
        (lambda: eq.orthographic_rows(2, 2, np.eye(3), 1, np.ones((2, 3))), "selected has shape"),
        (lambda: eq.orthographic_rows(0, 2, np.eye(3), 1), "orthographic_rows: frames is 0"),
        (lambda: eq.offset_rows(2, 2, 0, 2, [0, 0, 0]), "joint 2 is outside 0..1"),
        (lambda: eq.offset_rows(2, 2, 1, 1, [0, 0, 0]), "are both 1"),
        (lambda: eq.offset_rows(2, 2, 0, 1, [0, 0]), "d has shape"),
        (lambda: eq.relative_position(np.zeros((2, 2, 3)), 0, -1), "joint -1"),
        (lambda: eq.loop_gap(np.zeros((0, 2, 3))), "loop_gap"),
        (lambda: eq.loop_rows(2, 0), "joints is 0"),
    ],
)
def test_wrong_arguments_are_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()
