r"""Wishes of an animator as linear rows: ProjFlow eq. 19–20 and 35–38.

Rows act on a motion written as a vector (see `vectorise`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import real_array, whole_number
from .masks import selection_rows

P = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""Orthographic projection: drop the depth."""


def orthographic_projection(x: ArrayLike, R_cam: ArrayLike, s: float) -> NDArray:
    r"""Where a distant camera sees every joint.

    .. math:: y_{n,j} = s\, P\, R_{cam}\, x_{n,j}, \qquad
              P = \begin{bmatrix} 1 & 0 & 0 \\ 0 & 1 & 0 \end{bmatrix}

    Args:
        x: ``(..., 3)``, metres.
        R_cam: ``(3, 3)``, rotation from world to camera axes.
        s: scale, picture units per metre.

    Returns:
        ``(..., 2)``, picture units.

    Raises:
        ValueError: if `R_cam` is not a rotation or `s` is 0.

    Source: ProjFlow eq. 19.
    """
    x, s_P_R = real_array("orthographic_projection", "x", x), _camera(R_cam, s)
    if x.ndim == 0 or x.shape[-1] != 3:
        raise ValueError(f"orthographic_projection: x has shape {x.shape}, expected (..., 3)")
    return x @ s_P_R.T


def orthographic_rows(
    frames: int, joints: int, R_cam: ArrayLike, s: float, selected: ArrayLike | None = None
) -> NDArray:
    r"""Rows that take a motion to the picture coordinates somebody drew.

    .. math:: A = M A_{full}, \qquad A_{full} = I_{NJ} \otimes s P R_{cam}

    Args:
        frames: N.
        joints: J.
        R_cam: ``(3, 3)``, rotation from world to camera axes.
        s: scale, picture units per metre.
        selected: booleans ``(N, J)`` or ``(N, J, 2)``, what was drawn; everything if left out.

    Returns:
        ``(m, d)``; row (n J + j) 2 + k of :math:`A_{full}` is picture axis k.

    Raises:
        ValueError: if `R_cam` is not a rotation, `s` is 0 or `selected` has another shape.

    Source: ProjFlow eq. 20.
    """
    N, J = _size("orthographic_rows", frames, joints)
    A_full = np.kron(np.eye(N * J), _camera(R_cam, s))
    selected = np.ones((N, J)) if selected is None else np.asarray(selected)
    if selected.shape not in ((N, J), (N, J, 2)):
        raise ValueError(f"orthographic_rows: selected has shape {selected.shape}, not {(N, J)}")
    both_axes = selected[..., None] if selected.ndim == 2 else selected
    M = selection_rows(np.broadcast_to(both_axes, (N, J, 2)))
    return M @ A_full


def relative_position(x: ArrayLike, joint_a: int, joint_b: int) -> NDArray:
    r"""Offset from one joint to another in every frame.

    .. math:: x_{n, j_a} - x_{n, j_b} = d

    Args:
        x: ``(..., N, J, 3)``, metres.
        joint_a: index of the joint that the offset leads to.
        joint_b: index of the joint that it starts from.

    Returns:
        ``(..., N, 3)``, metres; a rigid hold keeps it at d.

    Raises:
        ValueError: if a joint does not exist.

    Source: ProjFlow eq. 35.
    """
    x = real_array("relative_position", "x", x)
    _two_joints("relative_position", joint_a, joint_b, x.shape[-2] if x.ndim > 1 else 0)
    return x[..., joint_a, :] - x[..., joint_b, :]


def offset_rows(
    frames: int, joints: int, joint_a: int, joint_b: int, d: ArrayLike
) -> tuple[NDArray, NDArray]:
    r"""Rows that keep the offset between two joints fixed in every frame.

    .. math:: A_{rel} = I_N \otimes (e_{j_a} - e_{j_b})^\top \otimes I_3, \qquad
              y_{rel} = (d, \dots, d)

    Args:
        frames: N.
        joints: J.
        joint_a: index of the joint that the offset leads to.
        joint_b: index of the joint that it starts from.
        d: ``(3,)``, the offset in metres.

    Returns:
        A ``(3 N, 3 N J)`` and y ``(3 N,)``.

    Raises:
        ValueError: if a joint does not exist or both are the same.

    Source: ProjFlow eq. 36.
    """
    N, J = _size("offset_rows", frames, joints)
    _two_joints("offset_rows", joint_a, joint_b, J)
    e = np.eye(J)
    difference = (e[joint_a] - e[joint_b])[None, :]
    A_rel = np.kron(np.eye(N), np.kron(difference, np.eye(3)))
    return A_rel, np.tile(real_array("offset_rows", "d", d, (3,)), N)


def loop_gap(x: ArrayLike) -> NDArray:
    r"""How far the last pose is from the first.

    .. math:: x_0 - x_{N-1} = 0

    Closing it makes the poses meet, not the velocities; and the last frame repeats the first,
    so a player that loops should skip it.

    Args:
        x: ``(..., N, J, 3)``, metres.

    Returns:
        ``(..., J, 3)``, metres.

    Raises:
        ValueError: if there is no frame.

    Source: ProjFlow eq. 37.
    """
    x = real_array("loop_gap", "x", x)
    if x.ndim < 3 or x.shape[-3] == 0:
        raise ValueError(f"loop_gap: x has shape {x.shape}, expected (..., frames, joints, 3)")
    return x[..., 0, :, :] - x[..., -1, :, :]


def loop_rows(frames: int, joints: int) -> tuple[NDArray, NDArray]:
    r"""Rows that make the last pose the first.

    .. math:: A_{loop} = (e_0 - e_{N-1})^\top \otimes I_{3J}, \qquad A_{loop}\, x = 0

    Args:
        frames: N; with one frame the rows are empty, as nothing has to close.
        joints: J.

    Returns:
        A ``(3 J, 3 N J)`` and y ``(3 J,)``, zeros.

    Raises:
        ValueError: if a number is not whole and positive.

    Source: ProjFlow eq. 38.
    """
    N, J = _size("loop_rows", frames, joints)
    e = np.eye(N)
    first_minus_last = (e[0] - e[-1])[None, :]
    return np.kron(first_minus_last, np.eye(3 * J)), np.zeros(3 * J)


def _size(who: str, frames: int, joints: int) -> tuple[int, int]:
    """Check that both numbers are whole and positive."""
    return whole_number(who, "frames", frames), whole_number(who, "joints", joints)


def _camera(R_cam: ArrayLike, s: float) -> NDArray:
    """Return s P R_cam, or say why it is no camera."""
    R_cam = real_array("orthographic", "R_cam", R_cam, (3, 3))
    if not np.allclose(R_cam @ R_cam.T, np.eye(3), atol=1e-9) or np.linalg.det(R_cam) < 0:
        raise ValueError("orthographic: R_cam is not a rotation")
    if not np.isfinite(s) or s == 0:
        raise ValueError(f"orthographic: the scale s is {s}, expected a number other than 0")
    return s * P @ R_cam


def _two_joints(who: str, joint_a: int, joint_b: int, joints: int) -> None:
    """Refuse joints that do not exist or are the same."""
    for joint in (joint_a, joint_b):
        if not 0 <= joint < joints:
            raise ValueError(f"{who}: joint {joint} is outside 0..{joints - 1}")
    if joint_a == joint_b:
        raise ValueError(f"{who}: joint_a and joint_b are both {joint_a}")
