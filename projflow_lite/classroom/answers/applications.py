"""Answers to ProjFlow eq. 36 and 38: rows as derivatives of what they measure."""

from __future__ import annotations

from typing import Any

from .derivation import Answer, Derivation, Step


def _motion(frames: int, joints: int) -> tuple[Any, Any]:
    """Return a motion of symbols as an array and as a vector sorted frame by frame."""
    import numpy as np
    import sympy

    entries = sympy.symbols(f"x_:{3 * frames * joints}")
    return np.array(entries).reshape(frames, joints, 3), sympy.Matrix(entries)


def hold() -> Derivation:
    """The offset of two joints, differentiated by every coordinate."""
    import sympy

    frames, joints, a, b = 2, 3, 2, 0
    x, vector = _motion(frames, joints)
    d = sympy.Matrix(sympy.symbols("d_:3", positive=True))
    measured = sympy.Matrix((x[:, a] - x[:, b]).ravel())
    A, e, kron = measured.jacobian(vector), sympy.eye(joints), sympy.kronecker_product
    printed = kron(sympy.eye(frames), kron(e[a, :] - e[b, :], sympy.eye(3)))
    return Derivation(
        [
            Step("differentiating the offset gives the rows of eq. 36", A - printed),
            Step("the rows measure the offset, with no constant", A * vector - measured),
        ],
        (frames, joints, a, b, d),
        (A, sympy.Matrix([*d, *d])),
    )


def loop() -> Derivation:
    """First pose minus last, differentiated by every coordinate."""
    import sympy

    frames, joints = 3, 2
    x, vector = _motion(frames, joints)
    gap = sympy.Matrix((x[0] - x[-1]).ravel())
    A, e = gap.jacobian(vector), sympy.eye(frames)
    printed = sympy.kronecker_product(e[0, :] - e[frames - 1, :], sympy.eye(3 * joints))
    still = vector.subs(dict(zip(x[-1].ravel(), x[0].ravel(), strict=True)))
    return Derivation(
        [
            Step("differentiating the gap gives the rows of eq. 38", A - printed),
            Step("a motion that ends as it begins has no gap", A * still),
        ],
        (frames, joints),
        (A, sympy.zeros(3 * joints, 1)),
    )


ANSWERS = {
    "projflow:36": Answer(
        r"The offset $x_{n, j_a} - x_{n, j_b}$ is linear, so its rows are its derivatives: a plus "
        r"at joint $a$, a minus at joint $b$, in every frame and on every axis by itself. With "
        r"frames slowest and axes fastest: $I_N \otimes (e_{j_a} - e_{j_b})^\top \otimes I_3$. The "
        r"values are $d$ once per frame.",
        "def offset_rows(frames, joints, joint_a, joint_b, d):\n"
        "    e = np.eye(joints)\n"
        "    difference = (e[joint_a] - e[joint_b])[None, :]\n"
        "    A = np.kron(np.eye(frames), np.kron(difference, np.eye(3)))\n"
        "    return A, np.tile(d, frames)",
        hold,
    ),
    "projflow:38": Answer(
        r"The gap $x_0 - x_{N-1}$ is linear: a plus in the first frame, a minus in the last, for "
        r"every joint and axis by itself, $(e_0 - e_{N-1})^\top \otimes I_{3J}$. It shall be 0.",
        "def loop_rows(frames, joints):\n"
        "    e = np.eye(frames)\n"
        "    first_minus_last = (e[0] - e[-1])[None, :]\n"
        "    return np.kron(first_minus_last, np.eye(3 * joints)), np.zeros(3 * joints)",
        loop,
    ),
}
