"""Answers to ProjFlow eq. 36, rows of a fixed offset, and eq. 38, rows of a loop."""

from __future__ import annotations

import numpy as np
import scipy.sparse

from .shelves import right, wrong


def _hold(frames, joints, plus, minus):
    """Rows of the joint `plus` less the joint `minus`."""
    e = np.eye(joints)
    return np.kron(np.eye(frames), np.kron((e[plus] - e[minus])[None], np.eye(3)))


@wrong("projflow:36")
def joints_swapped(frames, joints, joint_a, joint_b, d):
    """The joints have changed places: the offset leads from joint_b to joint_a."""
    return _hold(frames, joints, joint_b, joint_a), np.tile(d, frames)


@wrong("projflow:36")
def joints_added(frames, joints, joint_a, joint_b, d):
    """Both joints have a plus sign: their sum is held, not their difference."""
    e = np.eye(joints)
    rows = np.kron((e[joint_a] + e[joint_b])[None], np.eye(3))
    return np.kron(np.eye(frames), rows), np.tile(d, frames)


@wrong("projflow:36")
def other_joint_forgotten(frames, joints, joint_a, joint_b, d):
    """joint_b is forgotten: joint_a is pinned to the place d."""
    rows = np.kron(np.eye(joints)[joint_a][None], np.eye(3))
    return np.kron(np.eye(frames), rows), np.tile(d, frames)


@wrong("projflow:36")
def joints_counted_from_one(frames, joints, joint_a, joint_b, d):
    """The joints are counted from 1; here they count from 0."""
    return _hold(frames, joints, joint_a - 1, joint_b - 1), np.tile(d, frames)


@wrong("projflow:36")
def x_axis_only(frames, joints, joint_a, joint_b, d):
    """Only the x axis is held: there are N rows, not 3 N."""
    return _hold(frames, joints, joint_a, joint_b)[::3], np.tile(d[:1], frames)


@wrong("projflow:36")
def axes_before_joints(frames, joints, joint_a, joint_b, d):
    """The axes come before the joints; in the vector each joint has its three axes together."""
    e = np.eye(joints)
    rows = np.kron(np.eye(3), (e[joint_a] - e[joint_b])[None])
    return np.kron(np.eye(frames), rows), np.tile(d, frames)


@wrong("projflow:36")
def joints_before_frames(frames, joints, joint_a, joint_b, d):
    """The joints come before the frames, as if the vector were sorted joint by joint."""
    e = np.eye(joints)
    return np.kron((e[joint_a] - e[joint_b])[None], np.eye(3 * frames)), np.tile(d, frames)


@wrong("projflow:36")
def first_frame_only(frames, joints, joint_a, joint_b, d):
    """Only the first frame is held."""
    return _hold(frames, joints, joint_a, joint_b)[:3], np.asarray(d)


@wrong("projflow:36")
def values_once(frames, joints, joint_a, joint_b, d):
    """The values are there once; they belong into every frame."""
    return _hold(frames, joints, joint_a, joint_b), np.asarray(d)


@wrong("projflow:36")
def values_repeated_one_by_one(frames, joints, joint_a, joint_b, d):
    """Each value is repeated by itself (x, x, ... y, y, ...); all of d belongs into every frame."""
    return _hold(frames, joints, joint_a, joint_b), np.repeat(d, frames)


@wrong("projflow:36")
def values_with_wrong_sign(frames, joints, joint_a, joint_b, d):
    """The values have the wrong sign."""
    return _hold(frames, joints, joint_a, joint_b), -np.tile(d, frames)


@wrong("projflow:36")
def values_zero(frames, joints, joint_a, joint_b, d):
    """The values are zero: the joints would have to meet."""
    return _hold(frames, joints, joint_a, joint_b), np.zeros(3 * frames)


@wrong("projflow:36")
def rows_as_columns(frames, joints, joint_a, joint_b, d):
    """The matrix is transposed: each measurement should be a row."""
    return _hold(frames, joints, joint_a, joint_b).T, np.tile(d, frames)


@right("projflow:36")
def entry_by_entry(frames, joints, joint_a, joint_b, d):
    """Loops that write one plus and one minus into every row."""
    A, y = np.zeros((3 * frames, 3 * frames * joints)), []
    for n in range(frames):
        for c in range(3):
            A[3 * n + c, (n * joints + joint_a) * 3 + c] = 1
            A[3 * n + c, (n * joints + joint_b) * 3 + c] = -1
            y.append(float(d[c]))
    return [A, y]


@right("projflow:36")
def as_a_derivative(frames, joints, joint_a, joint_b, d):
    """The measurement of every unit motion, column by column."""
    units = np.eye(3 * frames * joints).reshape(-1, frames, joints, 3)
    A = (units[:, :, joint_a] - units[:, :, joint_b]).reshape(len(units), -1).T
    return A, np.concatenate([d] * frames)


@wrong("projflow:38")
def last_minus_first(frames, joints):
    """The rows are last minus first: the same loop, but not the signs of eq. 38."""
    e = np.eye(frames)
    return np.kron((e[-1] - e[0])[None], np.eye(3 * joints)), np.zeros(3 * joints)


@wrong("projflow:38")
def first_plus_last(frames, joints):
    """First and last are added; a loop compares them."""
    e = np.eye(frames)
    return np.kron((e[0] + e[-1])[None], np.eye(3 * joints)), np.zeros(3 * joints)


@wrong("projflow:38")
def last_frame_off_by_one(frames, joints):
    """The last frame is missed by one: frames count from 0, so it is frame N - 1."""
    e = np.eye(frames)
    return np.kron((e[0] - e[frames - 2])[None], np.eye(3 * joints)), np.zeros(3 * joints)


@wrong("projflow:38")
def first_frame_off_by_one(frames, joints):
    """The first frame is missed by one: frames count from 0."""
    e = np.eye(frames)
    return np.kron((e[1] - e[-1])[None], np.eye(3 * joints)), np.zeros(3 * joints)


@wrong("projflow:38")
def one_frame_overwritten(frames, joints):
    """With a single frame the minus overwrites the plus; both fall on one entry and cancel."""
    A = np.zeros((3 * joints, 3 * frames * joints))
    A[:, : 3 * joints] = np.eye(3 * joints)
    A[:, -3 * joints :] = -np.eye(3 * joints)
    return A, np.zeros(3 * joints)


@wrong("projflow:38")
def last_pose_forgotten(frames, joints):
    """Only the first frame is there: its pose would have to be zero."""
    return np.eye(3 * joints, 3 * frames * joints), np.zeros(3 * joints)


@wrong("projflow:38")
def every_pair_of_neighbours(frames, joints):
    """Every frame is compared with the next one: the motion would stand still."""
    e = np.eye(frames)
    A = np.kron(e[:-1] - e[1:], np.eye(3 * joints))
    return A, np.zeros(len(A))


@wrong("projflow:38")
def first_axes_only(frames, joints):
    """The identity has the size J; it needs one row per joint and axis, 3 J."""
    e = np.eye(frames)
    return np.kron((e[0] - e[-1])[None], np.eye(joints)), np.zeros(joints)


@wrong("projflow:38")
def inner_order_first(frames, joints):
    """The factors are in the wrong order, as if the vector had its frames innermost."""
    e = np.eye(frames)
    return np.kron(np.eye(3 * joints), (e[0] - e[-1])[None]), np.zeros(3 * joints)


@wrong("projflow:38")
def values_one(frames, joints):
    """The values are 1; a loop has no gap, so they are 0."""
    e = np.eye(frames)
    return np.kron((e[0] - e[-1])[None], np.eye(3 * joints)), np.ones(3 * joints)


@wrong("projflow:38")
def one_value_per_coordinate(frames, joints):
    """There is one value per coordinate of the motion; there should be one per row."""
    e = np.eye(frames)
    return np.kron((e[0] - e[-1])[None], np.eye(3 * joints)), np.zeros(3 * frames * joints)


@wrong("projflow:38")
def loop_rows_as_columns(frames, joints):
    """The matrix is transposed: each measurement should be a row."""
    e = np.eye(frames)
    return np.kron((e[0] - e[-1])[None], np.eye(3 * joints)).T, np.zeros(3 * joints)


@right("projflow:38")
def difference_of_two_selections(frames, joints):
    """Rows that pick the first pose less rows that pick the last."""
    pick = np.eye(3 * frames * joints)
    return pick[: 3 * joints] - pick[-3 * joints :], [0.0] * (3 * joints)


@right("projflow:38")
def sparse_rows(frames, joints):
    """Two sparse diagonals; where they meet, they cancel."""
    size, width = 3 * joints, 3 * frames * joints
    first = scipy.sparse.eye(size, width)
    return first - scipy.sparse.eye(size, width, k=width - size), np.zeros(size)
