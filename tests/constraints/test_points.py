import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import projflow_lite as pf
from projflow_lite.constraints import describe_row


def some_motion(frames, seed=0):
    return np.random.default_rng(seed).normal(size=(frames, 22, 3))


@given(
    frames=st.lists(st.integers(0, 11), min_size=1, max_size=12, unique=True),
    joints=st.lists(st.integers(0, 21), min_size=1, max_size=4, unique=True),
    axes=st.sampled_from(["x", "y", "z", "xz", "zy", "xyz", "yzx"]),
)
def test_the_rows_of_a_pin_read_off_what_a_loop_would(frames, joints, axes):
    x = some_motion(12)
    targets = np.array([[[x[n, j, "xyz".index(c)] for c in axes] for j in joints] for n in frames])
    A, y, variance = (
        pf.pin(joints, frames, targets).rows(12)
        if axes == "xyz"
        else pf.pin(joints, frames, targets, axes=axes).rows(12)
    )
    assert A.shape == (targets.size, 12 * 22 * 3)
    np.testing.assert_array_equal(A @ x.ravel(), targets.ravel())
    np.testing.assert_array_equal(y, targets.ravel())
    assert not variance.any()


def test_one_frame_one_joint_needs_only_three_numbers():
    A, y, _ = pf.pin("head", 3, [1, 2, 3]).rows(5)
    np.testing.assert_array_equal(np.flatnonzero(A.sum(axis=0)), (3 * 22 + 15) * 3 + np.arange(3))
    np.testing.assert_array_equal(y, [1, 2, 3])


def test_no_frames_means_every_frame_of_the_motion():
    wish = pf.pin("pelvis", None, np.zeros((8, 1)), axes="y", std=0.5)
    A, _, variance = wish.rows(8)
    assert A.shape == (8, 8 * 66)
    np.testing.assert_allclose(variance, 0.25)
    with pytest.raises(ValueError, match="pin: 8 positions for a motion of 9 frames"):
        wish.rows(9)


def test_offset_and_loop_measure_the_differences_they_name():
    x = some_motion(6)
    A, y, _ = pf.offset("left_wrist", "right_wrist", [0.3, 0, 0], frames=[2, 5]).rows(6)
    np.testing.assert_allclose((A @ x.ravel()).reshape(2, 3), x[[2, 5], 20] - x[[2, 5], 21])
    np.testing.assert_array_equal(y, [0.3, 0, 0] * 2)
    A, y, _ = pf.loop(shift=[0, 0, 1]).rows(6)
    np.testing.assert_allclose((A @ x.ravel()).reshape(22, 3), x[-1] - x[0])
    np.testing.assert_array_equal(y, [0, 0, 1] * 22)


def test_and_stacks_the_rows_in_order():
    first, second = pf.pin("head", 0, [1, 2, 3]), pf.loop("pelvis")
    both = (first & second).rows(4)
    np.testing.assert_array_equal(both.y, [1, 2, 3, 0, 0, 0])
    np.testing.assert_array_equal(both.A[:3].toarray(), first.rows(4).A.toarray())
    np.testing.assert_array_equal(both.A[3:].toarray(), second.rows(4).A.toarray())
    assert "head pinned in xyz at frame 0, exactly" in repr(first & second)
    assert "pelvis ends where it began" in repr(first & second)


def test_markers_are_the_pinned_points_with_nan_on_free_axes():
    wish = pf.pin("head", [2, 0], [[1, 3], [4, 6]], axes="xz") & pf.loop()
    frame, joint, target, std = wish.markers(5)
    np.testing.assert_array_equal(frame, [0, 2])
    np.testing.assert_array_equal(joint, [15, 15])
    np.testing.assert_array_equal(target, [[4, np.nan, 6], [1, np.nan, 3]])
    np.testing.assert_array_equal(std, [0, 0])


@settings(max_examples=30)
@given(shift=st.floats(-2, 2), frame=st.integers(0, 5))
def test_the_residual_is_what_was_added(shift, frame):
    x = some_motion(6)
    wish = pf.pin("left_foot", range(6), x[:, 10])
    moved = x.copy()
    moved[frame, 10, 1] += shift
    assert wish.residual(moved) == pytest.approx(abs(shift), abs=1e-12)


def test_a_row_is_described_by_joint_frame_and_axis():
    A = pf.offset("head", "neck", [0, 0, 0], frames=[7]).rows(9).A
    assert describe_row(A, 1) == "-1 * neck, frame 7, y + head, frame 7, y"
