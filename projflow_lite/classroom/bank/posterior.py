"""Answers to ProjFlow eq. 31, the normal equations of the most probable motion."""

from __future__ import annotations

import numpy as np
import scipy.linalg

from .shelves import right, wrong


@wrong("projflow:31")
def covariance_for_precision(x1_hat, A, y, R, Sigma):
    """Sigma is used where its inverse belongs."""
    return R + A.T @ Sigma @ A, R @ x1_hat + A.T @ Sigma @ y


@wrong("projflow:31")
def prior_missing_in_the_matrix(x1_hat, A, y, R, Sigma):
    """The prior's R is missing in H, which is then singular for few rows."""
    W = np.linalg.inv(Sigma)
    return A.T @ W @ A, R @ x1_hat + A.T @ W @ y


@wrong("projflow:31")
def prior_missing_in_the_vector(x1_hat, A, y, R, Sigma):
    """The prediction is missing in b: that solution is pulled towards zero."""
    W = np.linalg.inv(Sigma)
    return R + A.T @ W @ A, A.T @ W @ y


@wrong("projflow:31")
def prediction_not_weighted(x1_hat, A, y, R, Sigma):
    """The prediction enters b as it is; it should be weighted by R, as in H."""
    W = np.linalg.inv(Sigma)
    return R + A.T @ W @ A, x1_hat + A.T @ W @ y


@wrong("projflow:31")
def metric_inverted(x1_hat, A, y, R, Sigma):
    """R is inverted; it is the prior's precision already."""
    W, P = np.linalg.inv(Sigma), np.linalg.inv(R)
    return P + A.T @ W @ A, P @ x1_hat + A.T @ W @ y


@wrong("projflow:31")
def misfit_in_the_vector(x1_hat, A, y, R, Sigma):
    """b holds the misfit y - A x1_hat where y belongs: the prediction is counted twice."""
    W = np.linalg.inv(Sigma)
    return R + A.T @ W @ A, R @ x1_hat + A.T @ W @ (y - A @ x1_hat)


@wrong("projflow:31")
def measurement_subtracted(x1_hat, A, y, R, Sigma):
    """The measurement's terms are subtracted; knowledge from two sources adds up."""
    W = np.linalg.inv(Sigma)
    return R - A.T @ W @ A, R @ x1_hat - A.T @ W @ y


@wrong("projflow:31")
def noise_forgotten(x1_hat, A, y, R, Sigma):
    """Sigma is forgotten: every row counts as if its variance were 1."""
    return R + A.T @ A, R @ x1_hat + A.T @ y


@wrong("projflow:31")
def noise_taken_as_uncorrelated(x1_hat, A, y, R, Sigma):
    """Only the diagonal of Sigma is used; correlations of the measurements are lost."""
    W = np.diag(1 / np.diag(Sigma))
    return R + A.T @ W @ A, R @ x1_hat + A.T @ W @ y


@wrong("projflow:31")
def reciprocal_entries(x1_hat, A, y, R, Sigma):
    """1 / Sigma turns every entry over; the inverse of a matrix is something else."""
    W = 1 / Sigma
    return R + A.T @ W @ A, R @ x1_hat + A.T @ W @ y


@wrong("projflow:31")
def transpose_on_the_wrong_side(x1_hat, A, y, R, Sigma):
    """The transpose of A is on the wrong side, which fits square matrices only."""
    W = np.linalg.inv(Sigma)
    return R + A @ W @ A.T, R @ x1_hat + A @ W @ y


@wrong("projflow:31")
def pair_in_the_wrong_order(x1_hat, A, y, R, Sigma):
    """The pair comes back as (b, H); it should be (H, b)."""
    W = np.linalg.inv(Sigma)
    return R @ x1_hat + A.T @ W @ y, R + A.T @ W @ A


@wrong("projflow:31")
def solved_already(x1_hat, A, y, R, Sigma):
    """The system comes back solved; the exercise asks for H and b themselves."""
    W = np.linalg.inv(Sigma)
    H, b = R + A.T @ W @ A, R @ x1_hat + A.T @ W @ y
    return H, np.linalg.solve(H, b)


@wrong("projflow:31")
def overwrites_the_metric(x1_hat, A, y, R, Sigma):
    """H is written over the argument R, which the caller still needs."""
    W = np.linalg.inv(Sigma)
    b = R @ x1_hat + A.T @ W @ y
    R += A.T @ W @ A
    return R, b


@right("projflow:31")
def with_solves(x1_hat, A, y, R, Sigma):
    """Linear systems where the equation prints an inverse."""
    H = R + A.T @ np.linalg.solve(Sigma, A)
    return H, R @ x1_hat + A.T @ np.linalg.solve(Sigma, y)


@right("projflow:31")
def with_whitened_rows(x1_hat, A, y, R, Sigma):
    """Rows and values divided by a triangular root of Sigma, returned as lists."""
    L = np.linalg.cholesky(Sigma)
    rows, values = np.linalg.solve(L, A), np.linalg.solve(L, y)
    return [(R + rows.T @ rows).tolist(), (R @ x1_hat + rows.T @ values).tolist()]


@right("projflow:31")
def as_stacked_least_squares(x1_hat, A, y, R, Sigma):
    """The normal equations of one tall least-squares problem."""
    root = scipy.linalg.cholesky(R)
    L = np.linalg.cholesky(Sigma)
    tall = np.vstack([root, np.linalg.solve(L, A)])
    values = np.concatenate([root @ x1_hat, np.linalg.solve(L, y)])
    return tall.T @ tall, tall.T @ values
