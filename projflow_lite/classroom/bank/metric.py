"""Answers to ProjFlow eq. 11, the metric of a motion, and eq. 50, that of one frame and axis."""

from __future__ import annotations

import numpy as np
import scipy.linalg
import scipy.sparse

from .shelves import right, wrong


@wrong("projflow:11")
def order_as_printed(frames, L, w_kin, ridge):
    """The Laplacian comes last, as printed: that is for a vector with its joints innermost."""
    R = w_kin * np.kron(np.eye(3), np.kron(np.eye(frames), L))
    return R + ridge * np.eye(len(R))


@wrong("projflow:11")
def joints_change_slowest(frames, L, w_kin, ridge):
    """The Laplacian comes first, as if the vector were sorted joint by joint."""
    R = w_kin * np.kron(L, np.eye(3 * frames))
    return R + ridge * np.eye(len(R))


@wrong("projflow:11")
def weight_forgotten(frames, L, w_kin, ridge):
    """w_kin is forgotten."""
    R = np.kron(np.eye(frames), np.kron(L, np.eye(3)))
    return R + ridge * np.eye(len(R))


@wrong("projflow:11")
def ridge_forgotten(frames, L, w_kin, ridge):
    """The ridge is forgotten: without it the metric has no inverse."""
    return w_kin * np.kron(np.eye(frames), np.kron(L, np.eye(3)))


@wrong("projflow:11")
def ridge_in_every_entry(frames, L, w_kin, ridge):
    """The ridge is added to every entry; it belongs on the diagonal."""
    return w_kin * np.kron(np.eye(frames), np.kron(L, np.eye(3))) + ridge


@wrong("projflow:11")
def weight_on_the_ridge(frames, L, w_kin, ridge):
    """w_kin multiplies the ridge as well."""
    R = np.kron(np.eye(frames), np.kron(L, np.eye(3)))
    return w_kin * (R + ridge * np.eye(len(R)))


@wrong("projflow:11")
def one_frame_only(frames, L, w_kin, ridge):
    """This is the block of one frame; a motion has N of them."""
    R = w_kin * np.kron(L, np.eye(3))
    return R + ridge * np.eye(len(R))


@wrong("projflow:11")
def one_axis_only(frames, L, w_kin, ridge):
    """This has one axis instead of three: the last factor is missing."""
    R = w_kin * np.kron(np.eye(frames), L)
    return R + ridge * np.eye(len(R))


@wrong("projflow:11")
def frames_coupled(frames, L, w_kin, ridge):
    """Ones in place of an identity couple every frame with every other one."""
    R = w_kin * np.kron(np.ones((frames, frames)), np.kron(L, np.eye(3)))
    return R + ridge * np.eye(len(R))


@wrong("projflow:11")
def axes_coupled(frames, L, w_kin, ridge):
    """Ones in place of an identity couple the three axes of a joint."""
    R = w_kin * np.kron(np.eye(frames), np.kron(L, np.ones((3, 3))))
    return R + ridge * np.eye(len(R))


@wrong("projflow:11")
def degrees_plus_adjacency(frames, L, w_kin, ridge):
    """The bones have plus signs off the diagonal; a Laplacian is degrees minus adjacency."""
    R = w_kin * np.kron(np.eye(frames), np.kron(np.abs(L), np.eye(3)))
    return R + ridge * np.eye(len(R))


@wrong("projflow:11")
def covariance_of_a_motion(frames, L, w_kin, ridge):
    """This is the inverse of the metric, the prior's covariance."""
    R = w_kin * np.kron(np.eye(frames), np.kron(L, np.eye(3)))
    return np.linalg.inv(R + ridge * np.eye(len(R)))


@right("projflow:11")
def blocks_of_frames(frames, L, w_kin, ridge):
    """The metric of one frame, once per frame along the diagonal."""
    R_J = w_kin * L + ridge * np.eye(len(L))
    return scipy.linalg.block_diag(*[np.kron(R_J, np.eye(3))] * frames)


@right("projflow:11")
def entry_by_entry(frames, L, w_kin, ridge):
    """Loops over frames, pairs of joints and axes."""
    J = len(L)
    R = np.zeros((frames, J, 3, frames, J, 3))
    for n in range(frames):
        for j in range(J):
            for k in range(J):
                for c in range(3):
                    R[n, j, c, n, k, c] = w_kin * L[j, k] + (ridge if j == k else 0)
    return R.reshape(3 * frames * J, 3 * frames * J)


@right("projflow:11")
def sparse_factors(frames, L, w_kin, ridge):
    """Sparse factors, returned as a sparse matrix."""
    I_N, I_3 = scipy.sparse.identity(frames), scipy.sparse.identity(3)
    R = w_kin * scipy.sparse.kron(I_N, scipy.sparse.kron(L, I_3))
    return R + ridge * scipy.sparse.identity(3 * frames * len(L))


@wrong("projflow:50")
def ridge_in_all_entries(L, w_kin, ridge):
    """The ridge is added to every entry; it belongs on the diagonal."""
    return w_kin * L + ridge


@wrong("projflow:50")
def weight_left_out(L, w_kin, ridge):
    """w_kin is forgotten."""
    return L + ridge * np.eye(len(L))


@wrong("projflow:50")
def ridge_left_out(L, w_kin, ridge):
    """The ridge is forgotten: without it the metric has no inverse."""
    return w_kin * L


@wrong("projflow:50")
def weights_swapped(L, w_kin, ridge):
    """w_kin and the ridge have changed places."""
    return ridge * L + w_kin * np.eye(len(L))


@wrong("projflow:50")
def weight_on_both_terms(L, w_kin, ridge):
    """w_kin multiplies the ridge as well."""
    return w_kin * (L + ridge * np.eye(len(L)))


@wrong("projflow:50")
def covariance_of_a_frame(L, w_kin, ridge):
    """This is the inverse of the metric, the prior's covariance."""
    return np.linalg.inv(w_kin * L + ridge * np.eye(len(L)))


@wrong("projflow:50")
def ridge_subtracted(L, w_kin, ridge):
    """The ridge is subtracted; the metric would not be positive definite."""
    return w_kin * L - ridge * np.eye(len(L))


@wrong("projflow:50")
def signs_of_the_bones(L, w_kin, ridge):
    """The bones have plus signs off the diagonal; a Laplacian is degrees minus adjacency."""
    return w_kin * np.abs(L) + ridge * np.eye(len(L))


@wrong("projflow:50")
def all_three_axes(L, w_kin, ridge):
    """This has all three axes; the metric asked for is that of one axis."""
    return np.kron(w_kin * L + ridge * np.eye(len(L)), np.eye(3))


@wrong("projflow:50")
def ridge_by_degree(L, w_kin, ridge):
    """The ridge is multiplied by the number of bones of each joint; it is the same for all."""
    return w_kin * L + ridge * np.diag(np.diag(L))


@wrong("projflow:50")
def weight_squared(L, w_kin, ridge):
    """w_kin is squared."""
    return w_kin**2 * L + ridge * np.eye(len(L))


@wrong("projflow:50")
def overwrites_the_laplacian(L, w_kin, ridge):
    """The result is written over the argument L, which the caller still needs."""
    L[...] = L * w_kin
    L[np.diag_indices(len(L))] += ridge
    return L


@right("projflow:50")
def diagonal_raised(L, w_kin, ridge):
    """A copy, whose diagonal is raised."""
    R_J = w_kin * L.astype(float)
    R_J[np.diag_indices(len(L))] += ridge
    return R_J


@right("projflow:50")
def as_nested_lists(L, w_kin, ridge):
    """Loops over pairs of joints, returned as nested lists."""
    J = range(len(L))
    return [[w_kin * L[j, k] + ridge * (j == k) for k in J] for j in J]


@right("projflow:50")
def by_eigenvalues(L, w_kin, ridge):
    """The same eigenvectors as the Laplacian, with scaled and shifted eigenvalues."""
    value, U = np.linalg.eigh(L)
    return U @ np.diag(w_kin * value + ridge) @ U.T
