"""Answers to ProjFlow eq. 51, the weight of a joint."""

from __future__ import annotations

import numpy as np

from .shelves import right, wrong


@wrong("projflow:51")
def length_squared(R_J):
    """The length of each column is squared; eq. 51 prints no square."""
    return 1 / np.sum(np.linalg.inv(R_J) ** 2, axis=0)


@wrong("projflow:51")
def columns_of_the_metric(R_J):
    """The columns are those of R_J itself; eq. 51 takes those of its inverse."""
    return 1 / np.linalg.norm(R_J, axis=0)


@wrong("projflow:51")
def length_without_reciprocal(R_J):
    """These are the lengths themselves; the weight is one over the length."""
    return np.linalg.norm(np.linalg.inv(R_J), axis=0)


@wrong("projflow:51")
def normalised(R_J):
    """The weights are divided by their sum; eq. 51 does not, eq. 52 will."""
    q = 1 / np.linalg.norm(np.linalg.inv(R_J), axis=0)
    return q / q.sum()


@wrong("projflow:51")
def sum_of_absolute_values(R_J):
    """The length is a sum of absolute values, not the Euclidean one."""
    return 1 / np.linalg.norm(np.linalg.inv(R_J), ord=1, axis=0)


@wrong("projflow:51")
def diagonal_only(R_J):
    """Only the diagonal of the inverse is used; a joint's influence on the others is lost."""
    return 1 / np.diag(np.linalg.inv(R_J))


@wrong("projflow:51")
def one_length_for_all(R_J):
    """The length of the whole matrix is taken, not one length per column."""
    return 1 / np.linalg.norm(np.linalg.inv(R_J))


@wrong("projflow:51")
def reciprocal_entries(R_J):
    """1 / R_J turns every entry over; the inverse of a matrix is something else."""
    return 1 / np.linalg.norm(1 / R_J, axis=0)


@wrong("projflow:51")
def root_mean_square(R_J):
    """The mean of the squares stands under the root; the length takes their sum."""
    return 1 / np.sqrt(np.mean(np.linalg.inv(R_J) ** 2, axis=0))


@wrong("projflow:51")
def root_missing(R_J):
    """The root is taken once too often: the weight is one over the root of the length."""
    return 1 / np.sqrt(np.linalg.norm(np.linalg.inv(R_J), axis=0))


@wrong("projflow:51")
def own_entry_left_out(R_J):
    """Each joint's own entry is left out of its column; the length includes it."""
    c = np.linalg.inv(R_J)
    return 1 / np.linalg.norm(c - np.diag(np.diag(c)), axis=0)


@right("projflow:51")
def rows_of_the_inverse(R_J):
    """The inverse is symmetric, so its rows have the same lengths."""
    return 1 / np.linalg.norm(np.linalg.inv(R_J), axis=1)


@right("projflow:51")
def one_solve_per_joint(R_J):
    """Push each joint by itself and measure how far everything moves."""
    weights = []
    for push in np.eye(len(R_J)):
        moved = np.linalg.solve(R_J, push)
        weights.append(1 / np.sqrt(moved @ moved))
    return weights


@right("projflow:51")
def by_eigenvalues(R_J):
    """Squared lengths are the diagonal of the inverse squared."""
    value, U = np.linalg.eigh(R_J)
    return (U**2 @ value**-2.0) ** -0.5
