"""Cameras against geometry done another way, and lifting through the projection."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import projflow_lite as pf
from projflow_lite import equations
from projflow_lite.constraints.cameras import rotation

ANGLE = st.floats(-60, 60)


@given(pitch=ANGLE, yaw=ANGLE, roll=ANGLE)
def test_rotation_is_scipys(pitch, yaw, roll):
    expected = Rotation.from_euler("yxz", [-yaw, pitch, roll], degrees=True).as_matrix()
    np.testing.assert_allclose(rotation(pitch, yaw, roll), expected, atol=1e-12)


def test_which_way_the_angles_turn():
    head, left_hand = np.array([0.0, 1.7, 0.0]), np.array([0.6, 1.2, 0.0])
    np.testing.assert_allclose(pf.Orthographic().project(left_hand), [0.6, 1.2])
    # From the body's left the camera sees ahead (+z) at its left and what is at the left, nearer.
    ahead = np.array([0.0, 1.0, 1.0])
    assert pf.Orthographic(yaw=90).project(ahead)[0] == pytest.approx(-1)
    # From above, what is ahead of the body sinks in the picture.
    assert pf.Orthographic(pitch=30).project(ahead)[1] < pf.Orthographic().project(ahead)[1]
    # Turned anticlockwise, the head moves to the left.
    assert pf.Orthographic(roll=20).project(head)[0] < 0


@given(pitch=ANGLE, yaw=ANGLE, roll=ANGLE, scale=st.floats(0.3, 3))
def test_orthographic_is_eq_19(pitch, yaw, roll, scale):
    x = np.random.default_rng(0).normal(size=(4, 22, 3))
    camera = pf.Orthographic(pitch, yaw, roll, scale)
    seen = equations.orthographic_projection(x, rotation(pitch, yaw, roll), scale)
    np.testing.assert_allclose(camera.project(x), seen, atol=1e-12)


@given(
    yaw=ANGLE, pitch=st.floats(-30, 30), focal=st.floats(0.5, 4), u=st.floats(-1, 1), seed=st.integers(0, 99)
)  # fmt: skip
def test_perspective_rows_hold_for_the_points_that_were_photographed(yaw, pitch, focal, u, seed):
    camera = pf.Perspective((0.3, 1.5, 0.2), pitch, yaw, 7.0, focal, (u, 0.1))
    random = np.random.default_rng(seed)
    seen = np.column_stack([random.normal(size=(6, 2)), -random.uniform(1, 8, 6)])
    x = np.zeros((6, 22, 3))
    x[:, 15] = seen @ rotation(pitch, yaw, 7.0) + camera.position
    picture = np.array(camera.centre) + focal * seen[:, :2] / -seen[:, 2:]
    np.testing.assert_allclose(camera.project(x[:, 15]), picture, atol=1e-10)
    wish = pf.lift(camera, "head", None, picture)
    assert wish.residual(x) < 1e-10
    x[2, 15] += [0.0, 0.05, 0.0]
    assert wish.residual(x) > 0.01


def test_a_distant_pinhole_is_an_orthographic_camera():
    x = np.random.default_rng(0).normal(size=(5, 3))
    pinhole = pf.Perspective(position=(0.0, 0.0, 1e6), focal=1e6)
    np.testing.assert_allclose(pinhole.project(x), pf.Orthographic().project(x), atol=1e-5)


def test_behind_the_camera_there_is_no_picture():
    with pytest.raises(ValueError, match="Perspective: a point is not ahead of the camera"):
        pf.Perspective(position=(0.0, 0.0, 1.0)).project(np.array([0.0, 0.0, 2.0]))


@pytest.mark.parametrize(
    "camera",
    [pf.Orthographic(20, -40, 0, 1.2), pf.Perspective((1.0, 1.4, 6.0), 5, 10, 0, 1.5, (0.2, 0.1))],
    ids=["orthographic", "perspective"],
)
def test_after_projection_the_camera_sees_what_was_drawn(camera):
    random = np.random.default_rng(0)
    drawn = camera.project(random.normal(0, 0.3, (12, 3)) + [0, 1, 0])
    wish = pf.lift(camera, "right_wrist", None, drawn)
    x = torch.as_tensor(random.normal(0, 0.4, (2, 12, 22, 3)))
    y = pf.Projector(wish.rows(12), dtype=torch.float64).project(x).numpy()
    assert wish.residual(y) < 1e-12
    np.testing.assert_allclose(camera.project(y[1, :, 21]), drawn, atol=1e-10)
    dense = equations.project(
        x[0].numpy().ravel(), wish.rows(12).A.toarray(), wish.rows(12).y,
        equations.kinematic_metric(12, equations.kinematic_laplacian(pf.skeleton.EDGES, 22), 10, 1),
        np.zeros((24, 24)),
    )  # fmt: skip
    np.testing.assert_allclose(y[0].ravel(), dense, atol=1e-9)
