"""Wishes as rows, derived again: ProjFlow eq. 19–20 and 35–38."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from projflow_lite import equations as eq

from .problems import gap, lagrange, largest
from .registry import derives


def rows_by_trial(measure: Callable[[NDArray], NDArray], frames: int, joints: int) -> NDArray:
    """Matrix of a linear measurement: move one coordinate by 1 at a time and see what changes."""
    columns = []
    for place in np.ndindex(frames, joints, 3):  # the order of the vector
        x = np.zeros((frames, joints, 3))
        x[place] = 1
        columns.append(np.asarray(measure(x), dtype=np.float64).ravel())
    return np.array(columns).T


@derives(19, "distances along the camera's right and up, by quaternions", 1e-13)
def along_the_cameras_axes(random: np.random.Generator) -> float:
    """The picture shows how far to the right and how far up a joint is; the depth is lost."""
    turn, s = Rotation.random(rng=random), random.uniform(0.2, 3)
    right, up = turn.inv().apply([[1, 0, 0], [0, 1, 0]])
    x = random.normal(size=(3, 4, 3))
    picture = np.zeros((3, 4, 2))
    for n, j in np.ndindex(3, 4):
        picture[n, j] = s * sum(x[n, j] * right), s * sum(x[n, j] * up)
    seen = eq.orthographic_projection(x, turn.as_matrix(), s)
    depth = turn.inv().apply([0, 0, 1])  # moving along it changes nothing
    moved = eq.orthographic_projection(x + 5 * depth, turn.as_matrix(), s)
    return largest([gap(seen, picture), gap(moved, picture)])


@derives(20, "each coordinate moved by itself and photographed; parts of it", 1e-13)
def photographed_one_by_one(random: np.random.Generator) -> float:
    """A linear measurement is known once its answer to every single coordinate is known."""
    turn, s = Rotation.random(rng=random), random.uniform(0.2, 3)

    def picture(x: NDArray) -> NDArray:
        return s * turn.apply(x.reshape(-1, 3)).reshape(x.shape)[..., :2]

    A_full = rows_by_trial(picture, 2, 3)
    joints, axes = random.integers(0, 2, (2, 3)), random.integers(0, 2, (2, 3, 2))
    R_cam, nothing = turn.as_matrix(), np.zeros((2, 3))
    return largest(
        [
            gap(eq.orthographic_rows(2, 3, R_cam, s), A_full),
            gap(eq.orthographic_rows(2, 3, R_cam, s, axes), A_full[axes.ravel() == 1]),
            gap(eq.orthographic_rows(2, 3, R_cam, s, nothing), A_full[:0]),
            gap(
                eq.orthographic_rows(2, 3, R_cam, s, joints),
                A_full[np.repeat(joints.ravel(), 2) == 1],
            ),
        ]
    )


@derives(35, "subtracted number by number; turning keeps the length", 1e-13)
def offset_by_hand(random: np.random.Generator) -> float:
    """An offset has three numbers per frame; a rotation about any point changes no length."""
    x = random.normal(size=(4, 3, 3))
    by_hand = [[x[n, 2, c] - x[n, 0, c] for c in range(3)] for n in range(4)]
    turned = Rotation.random(rng=random).apply(x.reshape(-1, 3)).reshape(x.shape) + 7
    lengths = [np.sqrt(sum(d * d for d in offset)) for offset in by_hand]
    after = np.linalg.norm(eq.relative_position(turned, 2, 0), axis=-1)
    return largest([gap(eq.relative_position(x, 2, 0), by_hand), gap(after, lengths)])


def offset(x: NDArray, a: int, b: int) -> NDArray:
    """Where joint a is, seen from joint b, in every frame."""
    return x[:, a] - x[:, b]


@derives(36, "each coordinate moved by itself, offset read; one frame too", 0)
def offset_one_by_one(random: np.random.Generator) -> float:
    """Rows of zeros and plus or minus ones: there is nothing to round."""
    deviations = []
    for frames, joints, a, b in ((3, 4, 2, 0), (3, 4, 1, 3), (1, 2, 0, 1)):
        d = random.normal(size=3)
        A, y = eq.offset_rows(frames, joints, a, b, d)
        trial = rows_by_trial(partial(offset, a=a, b=b), frames, joints)
        deviations += [gap(A, trial), gap(y, [d[c] for _ in range(frames) for c in range(3)])]
    return largest(deviations)


@derives(37, "subtracted number by number; a closed circle has no gap", 1e-14)
def gap_by_hand(random: np.random.Generator) -> float:
    """First pose minus last pose; on a circle walked once around they are the same."""
    x = random.normal(size=(5, 2, 3))
    by_hand = [[x[0, j, c] - x[4, j, c] for c in range(3)] for j in range(2)]
    angle = np.linspace(0, 2 * np.pi, 9)[:, None]
    circle = np.stack([np.cos(angle), 0 * angle, np.sin(angle)], axis=-1)
    return largest([gap(eq.loop_gap(x), by_hand), gap(eq.loop_gap(circle), np.zeros((1, 3)))])


@derives(38, "each coordinate moved by itself, gap read; one frame too", 0)
def loop_one_by_one(random: np.random.Generator) -> float:
    """Rows of zeros and plus or minus ones; a single frame closes by itself."""
    deviations = []
    for frames, joints in ((4, 3), (1, 2)):
        A, y = eq.loop_rows(frames, joints)
        trial = rows_by_trial(lambda x: x[0] - x[-1], frames, joints)
        deviations += [gap(A, trial), gap(y, np.zeros(3 * joints))]
    return largest(deviations)


@derives(38, "a straight walk closed by hand: 0 1 2 3 4 becomes 2 1 2 3 2", 1e-12)
def a_walk_closed_by_hand(random: np.random.Generator) -> float:
    """The two ends meet half-way and nobody else moves, wherever the walk starts."""
    start = random.normal()
    walk = np.zeros((5, 1, 3))
    walk[:, 0, 2] = start + np.arange(5)
    A, y = eq.loop_rows(5, 1)
    closed = walk.ravel() + lagrange(walk.ravel(), A, y, np.eye(15), np.zeros((3, 3)))
    return gap(closed.reshape(5, 3)[:, 2], start + np.array([2, 1, 2, 3, 2]))
