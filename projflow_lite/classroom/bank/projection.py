"""Answers to ProjFlow eq. 7 and 8, the projection."""

from __future__ import annotations

import numpy as np
import scipy.linalg

from .shelves import right, wrong


@wrong("projflow:7")
def metric_for_its_inverse(x1_hat, A, y, R, Sigma):
    """R is used where its inverse belongs."""
    return x1_hat + R @ A.T @ np.linalg.solve(A @ R @ A.T + Sigma, y - A @ x1_hat)


@wrong("projflow:7")
def noise_forgotten(x1_hat, A, y, R, Sigma):
    """Sigma is forgotten: every row is met exactly, however uncertain it is."""
    R_inv_At = np.linalg.solve(R, A.T)
    return x1_hat + R_inv_At @ np.linalg.pinv(A @ R_inv_At) @ (y - A @ x1_hat)


@wrong("projflow:7")
def metric_forgotten(x1_hat, A, y, R, Sigma):
    """R is forgotten: this is the smallest correction in the Euclidean metric."""
    return x1_hat + A.T @ np.linalg.solve(A @ A.T + Sigma, y - A @ x1_hat)


@wrong("projflow:7")
def metric_and_noise_forgotten(x1_hat, A, y, R, Sigma):
    """R and Sigma are both forgotten: this is DDNM, eq. 21."""
    return x1_hat + np.linalg.pinv(A) @ (y - A @ x1_hat) if len(A) else 1.0 * x1_hat


@wrong("projflow:7")
def misfit_with_wrong_sign(x1_hat, A, y, R, Sigma):
    """The misfit has the wrong sign: the correction leads away from the wish."""
    R_inv_At = np.linalg.solve(R, A.T)
    return x1_hat + R_inv_At @ np.linalg.solve(A @ R_inv_At + Sigma, A @ x1_hat - y)


@wrong("projflow:7")
def correction_only(x1_hat, A, y, R, Sigma):
    """This is the correction alone, eq. 7; eq. 8 adds it to the prediction."""
    R_inv_At = np.linalg.solve(R, A.T)
    return R_inv_At @ np.linalg.solve(A @ R_inv_At + Sigma, y - A @ x1_hat)


@wrong("projflow:7")
def wish_taken_for_the_misfit(x1_hat, A, y, R, Sigma):
    """The correction is computed from y itself, not from what the prediction lacks of it."""
    R_inv_At = np.linalg.solve(R, A.T)
    return x1_hat + R_inv_At @ np.linalg.solve(A @ R_inv_At + Sigma, y)


@wrong("projflow:7")
def small_matrix_not_inverted(x1_hat, A, y, R, Sigma):
    """The misfit is multiplied by the m x m matrix where its inverse belongs."""
    R_inv_At = np.linalg.solve(R, A.T)
    return x1_hat + R_inv_At @ ((A @ R_inv_At + Sigma) @ (y - A @ x1_hat))


@wrong("projflow:7")
def metric_missing_inside(x1_hat, A, y, R, Sigma):
    """The inverse metric is missing inside the m x m matrix."""
    R_inv_At = np.linalg.solve(R, A.T)
    return x1_hat + R_inv_At @ np.linalg.solve(A @ A.T + Sigma, y - A @ x1_hat)


@wrong("projflow:7")
def metric_missing_outside(x1_hat, A, y, R, Sigma):
    """The inverse metric is missing in front of the m x m matrix."""
    S = A @ np.linalg.solve(R, A.T) + Sigma
    return x1_hat + A.T @ np.linalg.solve(S, y - A @ x1_hat)


@wrong("projflow:7")
def jitter_on_the_diagonal(x1_hat, A, y, R, Sigma):
    """A small number is added to the diagonal: exact rows are then only nearly met."""
    R_inv_At = np.linalg.solve(R, A.T)
    S = A @ R_inv_At + Sigma + 1e-8 * np.eye(len(y))
    return x1_hat + R_inv_At @ np.linalg.solve(S, y - A @ x1_hat)


@wrong("projflow:7")
def noise_taken_as_uncorrelated(x1_hat, A, y, R, Sigma):
    """Only the diagonal of Sigma is used; correlations of the measurements are lost."""
    R_inv_At = np.linalg.solve(R, A.T)
    S = A @ R_inv_At + np.diag(np.diag(Sigma))
    return x1_hat + R_inv_At @ np.linalg.solve(S, y - A @ x1_hat)


@wrong("projflow:7")
def metric_taken_as_diagonal(x1_hat, A, y, R, Sigma):
    """Only the diagonal of R is used, so that no joint takes its neighbours along."""
    R_inv_At = A.T / np.diag(R)[:, None]
    return x1_hat + R_inv_At @ np.linalg.solve(A @ R_inv_At + Sigma, y - A @ x1_hat)


@wrong("projflow:7")
def reciprocal_entries(x1_hat, A, y, R, Sigma):
    """1 / R turns every entry over; the inverse of a matrix is something else."""
    R_inv_At = (1 / R) @ A.T
    return x1_hat + R_inv_At @ np.linalg.solve(A @ R_inv_At + Sigma, y - A @ x1_hat)


@wrong("projflow:7")
def noise_squared(x1_hat, A, y, R, Sigma):
    """Sigma is squared as if it held standard deviations; it is a covariance already."""
    R_inv_At = np.linalg.solve(R, A.T)
    return x1_hat + R_inv_At @ np.linalg.solve(A @ R_inv_At + Sigma @ Sigma, y - A @ x1_hat)


@wrong("projflow:7")
def transpose_missing(x1_hat, A, y, R, Sigma):
    """A stands where its transpose belongs, which works for square matrices only, and wrongly."""
    R_inv = np.linalg.inv(R)
    return x1_hat + R_inv @ A @ np.linalg.solve(A @ R_inv @ A + Sigma, y - A @ x1_hat)


@wrong("projflow:7")
def rows_solved_without_the_prediction(x1_hat, A, y, R, Sigma):
    """The rows are solved for the motion itself: the prediction is lost."""
    return np.linalg.solve(A, y)


@wrong("projflow:7")
def overwrites_the_prediction(x1_hat, A, y, R, Sigma):
    """The correction is added to the argument x1_hat itself, which the caller still needs."""
    R_inv_At = np.linalg.solve(R, A.T)
    x1_hat += R_inv_At @ np.linalg.solve(A @ R_inv_At + Sigma, y - A @ x1_hat)
    return x1_hat


@right("projflow:7")
def as_printed(x1_hat, A, y, R, Sigma):
    """Inverses written as the equation prints them."""
    R_inv = np.linalg.inv(R)
    return x1_hat + R_inv @ A.T @ np.linalg.inv(A @ R_inv @ A.T + Sigma) @ (y - A @ x1_hat)


@right("projflow:7")
def by_cholesky(x1_hat, A, y, R, Sigma):
    """Whiten with a triangular factor of R, then an ordinary least-norm correction."""
    L = scipy.linalg.cholesky(R, lower=True)
    white = scipy.linalg.solve_triangular(L, A.T, lower=True)
    weights = np.linalg.solve(white.T @ white + Sigma, y - A @ x1_hat)
    return x1_hat + scipy.linalg.solve_triangular(L.T, white @ weights)


@right("projflow:7")
def by_lagranges_conditions(x1_hat, A, y, R, Sigma):
    """One linear system for the correction and the multipliers together."""
    d = len(x1_hat)
    system = np.block([[R, -A.T], [A, Sigma]])
    return x1_hat + np.linalg.solve(system, np.concatenate([np.zeros(d), y - A @ x1_hat]))[:d]


@right("projflow:7")
def by_einsum(x1_hat, A, y, R, Sigma):
    """Index notation, returned as a list."""
    C = np.linalg.inv(R)
    S = np.einsum("ia,ab,jb->ij", A, C, A) + Sigma
    misfit = y - np.einsum("ia,a->i", A, x1_hat)
    return list(x1_hat + np.einsum("ab,ib,ij,j->a", C, A, np.linalg.inv(S), misfit))
