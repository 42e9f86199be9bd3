"""Metrics on the joints of one frame and axis: named, checked, and what others take from them."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from projflow_lite.equations import joint_metric, kinematic_laplacian
from projflow_lite.skeleton import EDGES, N_JOINTS, number_array, shown


def kinematic_joint_metric(w_kin: float = 10.0, ridge: float = 1.0) -> NDArray:
    r"""The skeleton's metric on one frame and axis, :math:`R_J = w L + \lambda I` (eq. 50)."""
    return joint_metric(kinematic_laplacian(EDGES, N_JOINTS), w_kin, ridge)


METRICS = {"kinematic": kinematic_joint_metric(), "euclidean": np.eye(N_JOINTS)}
"""Joint metrics by name."""


class JointMetric(NamedTuple):
    r"""What a projection and its guides take from a joint metric :math:`R_J`.

    Attributes:
        covariance: ``(22, 22)``, :math:`R_J^{-1}`.
        spread: ``(66, 66)``, the same on all coordinates of a frame, :math:`R_J^{-1} \otimes I_3`.
        root: ``(66, 66)``, :math:`C_J \otimes I_3` with :math:`R_J = C_J C_J^\top`: the length of
            eq. 17 is that of :math:`C^\top` times the bend.
    """

    covariance: NDArray
    spread: NDArray
    root: NDArray


def of_metric(metric: str | ArrayLike) -> JointMetric:
    """Check a metric, and work out what it is needed for; once for each."""
    return worked_out(check_metric(metric).tobytes())


@lru_cache(maxsize=8)
def worked_out(metric: bytes) -> JointMetric:
    """The parts of a joint metric, given as its ``22 * 22`` numbers."""
    R_J = np.frombuffer(metric).reshape(N_JOINTS, N_JOINTS)
    covariance, axes = np.linalg.inv(R_J), np.eye(3)
    return JointMetric(
        covariance, np.kron(covariance, axes), np.kron(np.linalg.cholesky(R_J), axes)
    )


def check_metric(metric: str | ArrayLike) -> NDArray:
    """The joint metric as a positive definite ``(22, 22)`` array, or an error that says why not."""
    if isinstance(metric, str):
        if metric not in METRICS:
            known = ", ".join(METRICS)
            raise ValueError(f"Projector: metric is one of {known}, not {shown(metric)}")
        return METRICS[metric].copy()
    R_J = number_array(metric, "Projector: the metric").astype(np.float64)
    if R_J.shape != (N_JOINTS, N_JOINTS) or not np.isfinite(R_J).all():
        raise ValueError(f"Projector: a metric is a symmetric ({N_JOINTS}, {N_JOINTS}) matrix")
    if not np.allclose(R_J, R_J.T, rtol=1e-10, atol=1e-12 * np.abs(R_J).max()):
        raise ValueError("Projector: the metric is not symmetric")
    eigenvalues = np.linalg.eigvalsh(R_J)
    # A negative eigenvalue's rounding is that of the largest.
    if eigenvalues[0] <= 1e-13 * eigenvalues[-1]:
        raise ValueError("Projector: the metric is not positive definite")
    return R_J
