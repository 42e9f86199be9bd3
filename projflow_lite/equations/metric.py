r"""The skeleton's own way to measure a correction: ProjFlow eq. 11 and 49–51.

A motion of N frames and J joints is a vector of length d = 3 N J, frame by frame, joint by
joint, axis by axis: entry (n J + j) 3 + c.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import one_of, positive_definite, real_array, whole_number


def kinematic_adjacency(edges: Iterable[tuple[int, int]], joints: int) -> NDArray:
    r"""Matrix with a 1 wherever a bone connects two joints.

    .. math:: (A_{kin})_{j_1 j_2} = 1 \text{ if } j_1 \text{ and } j_2 \text{ share a bone, else } 0

    Args:
        edges: pairs of joint indices, in any direction and order.
        joints: J.

    Returns:
        ``(J, J)``.

    Raises:
        ValueError: if a bone leaves 0..J-1 or connects a joint with itself.

    Source: ProjFlow eq. 11.
    """
    A_kin = np.zeros((whole_number("kinematic_adjacency", "joints", joints),) * 2)
    for a, b in edges:
        if not (0 <= a < joints and 0 <= b < joints) or a == b:
            raise ValueError(f"kinematic_adjacency: ({a}, {b}) is no bone among {joints} joints")
        A_kin[a, b] = A_kin[b, a] = 1
    return A_kin


def kinematic_laplacian(edges: Iterable[tuple[int, int]], joints: int) -> NDArray:
    r"""Graph Laplacian of the skeleton: it sees only differences across bones.

    .. math:: L_{kin} = D_{kin} - A_{kin}, \qquad D_{kin} = \mathrm{diag}(A_{kin} \mathbf{1}),
              \qquad u^\top L_{kin} u = \sum_{\text{bones } (a, b)} (u_a - u_b)^2

    Args:
        edges: pairs of joint indices, in any direction and order.
        joints: J.

    Returns:
        ``(J, J)``.

    Raises:
        ValueError: if a bone leaves 0..J-1 or connects a joint with itself.

    Source: ProjFlow eq. 11.
    """
    A_kin = kinematic_adjacency(edges, joints)
    D_kin = np.diag(A_kin @ np.ones(joints))
    return D_kin - A_kin


def kinematic_metric(
    frames: int, L: ArrayLike, w_kin: float, ridge: float, form: str = "derived"
) -> NDArray:
    r"""Metric of a whole motion: cheap where neighbours move together, dear where they part.

    .. math:: R = w_{kin} (I_N \otimes L_{kin} \otimes I_3) + \lambda I_d

    Args:
        frames: N.
        L: ``(J, J)``, the skeleton's Laplacian.
        w_kin: weight of the differences across bones, 1/m² as the ridge.
        ridge: :math:`\lambda > 0`, weight of every coordinate by itself.
        form: ``"derived"`` as above. ``"printed"`` is :math:`I_3 \otimes I_N \otimes L`, which
            belongs to a vector sorted axis by axis, and couples strangers in one sorted frame
            by frame, the order that the same paper declares.

    Returns:
        ``(d, d)`` with d = 3 N J.

    Raises:
        ValueError: if R would not be positive definite.

    Source: ProjFlow eq. 11 and 49.
    """
    one_of("kinematic_metric", form, ("derived", "printed"))
    L = real_array("kinematic_metric", "L", L, (None, None))
    I_N, I_3 = np.eye(whole_number("kinematic_metric", "frames", frames)), np.eye(3)
    per_bone = np.kron(I_N, np.kron(L, I_3))
    if form == "printed":
        per_bone = np.kron(I_3, np.kron(I_N, L))
    R = w_kin * per_bone + ridge * np.eye(len(per_bone))
    joint_metric(L, w_kin, ridge)  # refuses what is not positive definite, on a small matrix
    return R


def joint_metric(L: ArrayLike, w_kin: float, ridge: float) -> NDArray:
    r"""Block of the metric that one frame and one axis share.

    .. math:: R_J = w_{kin} L_{kin} + \lambda I_J

    Args:
        L: ``(J, J)``, the skeleton's Laplacian.
        w_kin: weight of the differences across bones.
        ridge: :math:`\lambda > 0`, weight of every coordinate by itself.

    Returns:
        ``(J, J)``.

    Raises:
        ValueError: if R_J would not be positive definite.

    Source: ProjFlow eq. 50.
    """
    L = real_array("joint_metric", "L", L, (None, None))
    if L.shape[0] != L.shape[1]:
        raise ValueError(f"joint_metric: L has shape {L.shape}, expected a square matrix")
    if not (w_kin >= 0 and ridge > 0):  # rounding can let a singular matrix pass for definite
        raise ValueError("joint_metric: w_kin must not be negative and ridge must be positive")
    return positive_definite("joint_metric", "R_J", w_kin * L + ridge * np.eye(len(L)))


def marginal_variance(R_J: ArrayLike) -> NDArray:
    r"""Prior variance of each joint's coordinate under the metric.

    .. math:: r_i = [\mathrm{diag}(R^{-1})]_i

    It is the same in every frame and on every axis, so one number per joint is enough.

    Args:
        R_J: ``(J, J)``, from `joint_metric`.

    Returns:
        ``(J,)``.

    Raises:
        ValueError: if R_J is not positive definite.

    Source: ProjFlow eq. 18 and section B.2.2.
    """
    R_J = real_array("marginal_variance", "R_J", R_J, (None, None))
    return np.diag(np.linalg.inv(positive_definite("marginal_variance", "R_J", R_J)))


def influence_weights(R_J: ArrayLike, form: str = "printed") -> NDArray:
    r"""How large a share of the trust each joint gets: less if moving it moves the others more.

    .. math:: q_j = 1 / \lVert c_j \rVert_2, \qquad c_j = \text{column } j \text{ of } R_J^{-1}

    On a human skeleton this gives the *pelvis* more than the wrists, against the words around
    the equation: every column of the inverse sums to :math:`1 / \lambda`, so a joint whose
    influence spreads over many others has a short column, and a leaf has a long one.

    Args:
        R_J: ``(J, J)``, from `joint_metric`.
        form: ``"printed"`` as above; ``"released"`` is :math:`1 / \lVert c_j \rVert^2`, which
            sharpens the same order.

    Returns:
        ``(J,)``, positive, not normalised.

    Raises:
        ValueError: if R_J is not positive definite.

    Source: ProjFlow eq. 51.
    """
    one_of("influence_weights", form, ("printed", "released"))
    R_J = real_array("influence_weights", "R_J", R_J, (None, None))
    c = np.linalg.inv(positive_definite("influence_weights", "R_J", R_J))
    column_norm = np.linalg.norm(c, axis=0)
    return 1 / column_norm if form == "printed" else 1 / column_norm**2
