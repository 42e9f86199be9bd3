"""Answers to ProjFlow eq. 17, the curvature of a motion."""

from __future__ import annotations

import numpy as np

from .shelves import right, wrong


def _ends(s):
    """Copy the first and the last value outwards."""
    return np.concatenate([s[:1], s, s[-1:]])


def _bend(x):
    """Second differences."""
    return x[2:] - 2 * x[1:-1] + x[:-2]


def _squared(a, R_J):
    """Squared norm of each frame."""
    return np.einsum("njc,jk,nkc->n", a, R_J, a)


@wrong("projflow:17")
def root_missing(x1_hat, R_J):
    """The root is missing: this is the squared norm."""
    return _ends(_squared(_bend(x1_hat), R_J))


@wrong("projflow:17")
def metric_forgotten(x1_hat, R_J):
    """R_J is forgotten: this is the Euclidean norm."""
    return _ends(np.linalg.norm(_bend(x1_hat), axis=(1, 2)))


@wrong("projflow:17")
def metric_inverted(x1_hat, R_J):
    """R_J is inverted; the norm takes the metric as it is."""
    return _ends(np.sqrt(_squared(_bend(x1_hat), np.linalg.inv(R_J))))


@wrong("projflow:17")
def metric_twice(x1_hat, R_J):
    """This is the Euclidean length of R_J times the vector: the metric counts twice."""
    return _ends(np.linalg.norm(np.einsum("jk,nkc->njc", R_J, _bend(x1_hat)), axis=(1, 2)))


@wrong("projflow:17")
def speed_instead_of_bend(x1_hat, R_J):
    """The first difference is measured, the speed; curvature takes the second."""
    return _ends(np.sqrt(_squared((x1_hat[2:] - x1_hat[:-2]) / 2, R_J)))


@wrong("projflow:17")
def factor_two_missing(x1_hat, R_J):
    """The middle frame lacks its factor 2: a motion that stands still would seem to bend."""
    return _ends(np.sqrt(_squared(x1_hat[2:] - x1_hat[1:-1] + x1_hat[:-2], R_J)))


@wrong("projflow:17")
def middle_added(x1_hat, R_J):
    """The middle frame is added where it should be subtracted."""
    return _ends(np.sqrt(_squared(x1_hat[2:] + 2 * x1_hat[1:-1] + x1_hat[:-2], R_J)))


@wrong("projflow:17")
def ends_zero(x1_hat, R_J):
    """The first and last frame are given 0; they should copy the value beside them."""
    return np.pad(np.sqrt(_squared(_bend(x1_hat), R_J)), 1)


@wrong("projflow:17")
def ends_missing(x1_hat, R_J):
    """The first and last frame are missing: there are N - 2 values, not N."""
    return np.sqrt(_squared(_bend(x1_hat), R_J))


@wrong("projflow:17")
def ends_wrapped_around(x1_hat, R_J):
    """The motion is taken for a loop: the first and last frame are neighbours."""
    a = np.roll(x1_hat, -1, axis=0) - 2 * x1_hat + np.roll(x1_hat, 1, axis=0)
    return np.sqrt(_squared(a, R_J))


@wrong("projflow:17")
def one_frame_early(x1_hat, R_J):
    """The values are one frame early: each belongs to the middle of its three frames."""
    s = np.sqrt(_squared(_bend(x1_hat), R_J))
    return np.concatenate([s, s[-1:], s[-1:]])


@wrong("projflow:17")
def x_axis_only(x1_hat, R_J):
    """Only the x axis is measured."""
    return _ends(np.sqrt(_squared(_bend(x1_hat)[:, :, :1], R_J)))


@wrong("projflow:17")
def root_per_axis(x1_hat, R_J):
    """Each axis has a root of its own; the three are added first, then one root is taken."""
    per_axis = np.einsum("njc,jk,nkc->nc", _bend(x1_hat), R_J, _bend(x1_hat))
    return _ends(np.sqrt(per_axis).sum(axis=1))


@wrong("projflow:17")
def mean_over_axes(x1_hat, R_J):
    """The three axes are averaged where they should be added."""
    return _ends(np.sqrt(_squared(_bend(x1_hat), R_J) / 3))


@wrong("projflow:17")
def diagonal_of_the_metric(x1_hat, R_J):
    """Only the diagonal of R_J is used; neighbours that move together cost too much."""
    return _ends(np.sqrt(_squared(_bend(x1_hat), np.diag(np.diag(R_J)))))


@wrong("projflow:17")
def gradient_twice(x1_hat, R_J):
    """np.gradient applied twice spans five frames; the second difference spans three."""
    return np.sqrt(_squared(np.gradient(np.gradient(x1_hat, axis=0), axis=0), R_J))


@wrong("projflow:17")
def per_second_squared(x1_hat, R_J):
    """The result is per second squared; eq. 17 counts frames."""
    return _ends(np.sqrt(_squared(_bend(x1_hat) * 20**2, R_J)))


@right("projflow:17")
def by_loops(x1_hat, R_J):
    """Explicit loops over frames, axes and pairs of joints, returned as a list."""
    N, J, _ = x1_hat.shape
    s = []
    for n in range(1, N - 1):
        a = x1_hat[n + 1] - 2 * x1_hat[n] + x1_hat[n - 1]
        pairs = [(j, k, c) for j in range(J) for k in range(J) for c in range(3)]
        s.append(sum(a[j, c] * R_J[j, k] * a[k, c] for j, k, c in pairs) ** 0.5)
    return [s[0], *s, s[-1]]


@right("projflow:17")
def by_a_triangular_root(x1_hat, R_J):
    """The Euclidean norm after a triangular root of the metric."""
    a = np.diff(x1_hat, n=2, axis=0)
    return np.pad(np.linalg.norm(np.linalg.cholesky(R_J).T @ a, axis=(1, 2)), 1, mode="edge")


@right("projflow:17")
def in_the_metric_of_one_frame(x1_hat, R_J):
    """The frame written as a vector, and its block of the metric."""
    R = np.kron(R_J, np.eye(3))
    a = np.diff(x1_hat, 2, axis=0).reshape(len(x1_hat) - 2, -1)
    s = np.array([np.sqrt(row @ R @ row) for row in a])
    return s[[0, *range(len(s)), -1]]
