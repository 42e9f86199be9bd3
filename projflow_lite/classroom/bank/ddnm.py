"""Answers to ProjFlow eq. 21, DDNM."""

from __future__ import annotations

import numpy as np
import scipy.linalg

from .shelves import right, wrong


@wrong("projflow:21")
def transpose_for_pseudo_inverse(x1_hat, A, y):
    """The transpose of A is used where its pseudo-inverse belongs."""
    return A.T @ y + (np.eye(len(x1_hat)) - A.T @ A) @ x1_hat


@wrong("projflow:21")
def null_space_forgotten(x1_hat, A, y):
    """What the rows cannot see is set to zero; it should come from the prediction."""
    return np.linalg.pinv(A) @ y


@wrong("projflow:21")
def prediction_in_full(x1_hat, A, y):
    """The whole prediction is added, with the part that the rows determine already."""
    return np.linalg.pinv(A) @ y + x1_hat


@wrong("projflow:21")
def projector_added(x1_hat, A, y):
    """The part that the rows see is added to the identity where it should be subtracted."""
    A_pinv = np.linalg.pinv(A)
    return A_pinv @ y + (np.eye(len(x1_hat)) + A_pinv @ A) @ x1_hat


@wrong("projflow:21")
def data_forgotten(x1_hat, A, y):
    """The measurement is left out: this is only the part of the prediction that no row sees."""
    return (np.eye(len(x1_hat)) - np.linalg.pinv(A) @ A) @ x1_hat


@wrong("projflow:21")
def seen_part_of_the_prediction(x1_hat, A, y):
    """The prediction contributes what the rows see; it should contribute what they do not."""
    A_pinv = np.linalg.pinv(A)
    return A_pinv @ y + A_pinv @ A @ x1_hat


@wrong("projflow:21")
def order_of_the_product(x1_hat, A, y):
    """A times its pseudo-inverse is taken, in the wrong order: that acts on y, not on x."""
    A_pinv = np.linalg.pinv(A)
    return A_pinv @ y + (np.eye(len(y)) - A @ A_pinv) @ x1_hat


@wrong("projflow:21")
def one_for_the_identity(x1_hat, A, y):
    """1 minus a matrix subtracts from a 1 in every entry; the identity has them on its diagonal."""
    A_pinv = np.linalg.pinv(A)
    return A_pinv @ y + (1 - A_pinv @ A) @ x1_hat


@wrong("projflow:21")
def independent_rows_only(x1_hat, A, y):
    """The pseudo-inverse is written out for independent rows; repeated or empty rows have none."""
    A_pinv = A.T @ np.linalg.inv(A @ A.T)
    return A_pinv @ y + (np.eye(len(x1_hat)) - A_pinv @ A) @ x1_hat


@wrong("projflow:21")
def independent_columns_only(x1_hat, A, y):
    """The pseudo-inverse is written out for independent columns; few rows have none."""
    A_pinv = np.linalg.inv(A.T @ A) @ A.T
    return A_pinv @ y + (np.eye(len(x1_hat)) - A_pinv @ A) @ x1_hat


@wrong("projflow:21")
def jitter_in_the_pseudo_inverse(x1_hat, A, y):
    """A small number on the diagonal stands in for the pseudo-inverse: rows are only nearly met."""
    A_pinv = A.T @ np.linalg.inv(A @ A.T + 1e-3 * np.eye(len(A)))
    return A_pinv @ y + (np.eye(len(x1_hat)) - A_pinv @ A) @ x1_hat


@wrong("projflow:21")
def misfit_reversed(x1_hat, A, y):
    """The misfit has the wrong sign: the step leads away from the measurement."""
    return x1_hat + np.linalg.pinv(A) @ (A @ x1_hat - y)


@wrong("projflow:21")
def overwrites_the_prediction(x1_hat, A, y):
    """The result is written over the argument x1_hat, which the caller still needs."""
    x1_hat += np.linalg.pinv(A) @ (y - A @ x1_hat)
    return x1_hat


@right("projflow:21")
def as_a_correction(x1_hat, A, y):
    """The prediction plus what the pseudo-inverse makes of the misfit."""
    return x1_hat + np.linalg.pinv(A) @ (y - A @ x1_hat)


@right("projflow:21")
def by_least_squares(x1_hat, A, y):
    """The shortest least-squares step, without any pseudo-inverse."""
    return x1_hat + np.linalg.lstsq(A, y - A @ x1_hat, rcond=None)[0] if len(A) else list(x1_hat)


@right("projflow:21")
def by_null_space(x1_hat, A, y):
    """An orthonormal basis of the directions that no row sees."""
    Z = scipy.linalg.null_space(A) if len(A) else np.eye(len(x1_hat))
    return np.linalg.pinv(A) @ y + Z @ (Z.T @ x1_hat)
