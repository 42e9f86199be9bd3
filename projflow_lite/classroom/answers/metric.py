"""Answers to ProjFlow eq. 11, 50 and 51."""

from __future__ import annotations

from .derivation import Answer, Derivation, Step

BONES = ((0, 1), (1, 2))
"""A chain of three joints."""

LAPLACIAN = ((1, -1, 0), (-1, 2, -1), (0, -1, 1))


def motion() -> Derivation:
    """The metric as half of the second derivatives of a sum over frames, bones and axes."""
    import sympy

    w, ridge = sympy.symbols("w ridge", positive=True)
    frames = 2
    L = sympy.Matrix(LAPLACIAN)
    x = sympy.symbols("x_:18")

    def at(n: int, j: int, axis: int) -> sympy.Symbol:
        return x[(n * 3 + j) * 3 + axis]

    places = [(n, axis) for n in range(frames) for axis in range(3)]
    bones = sum((at(n, a, axis) - at(n, b, axis)) ** 2 for n, axis in places for a, b in BONES)
    R = sympy.hessian(w * bones + ridge * sum(entry**2 for entry in x), x) / 2
    kron = sympy.kronecker_product
    product = kron(sympy.eye(frames), kron(L, sympy.eye(3)))
    return Derivation(
        [
            Step(
                "frame by frame, the sum over bones has the metric w I_N x L x I_3 + ridge I",
                R - w * product - ridge * sympy.eye(18),
            ),
            Step(
                "a shift of the whole motion costs the ridge only",
                R * sympy.ones(18, 1) - ridge * sympy.ones(18, 1),
            ),
        ],
        (frames, L, w, ridge),
        R,
    )


def frame() -> Derivation:
    """The metric of one frame and axis as half of the second derivatives of a sum over bones."""
    import sympy

    w, ridge = sympy.symbols("w ridge", positive=True)
    L, u = sympy.Matrix(LAPLACIAN), sympy.symbols("u_:3")
    bones = sum((u[a] - u[b]) ** 2 for a, b in BONES)
    R_J = sympy.hessian(w * bones + ridge * sum(entry**2 for entry in u), u) / 2
    return Derivation(
        [
            Step(
                "the sum over bones has the metric w L + ridge I",
                R_J - w * L - ridge * sympy.eye(3),
            ),
            Step("L sees no shift of all joints", L * sympy.ones(3, 1)),
        ],
        (L, w, ridge),
        R_J,
    )


def influence() -> Derivation:
    """One bone: push one joint by itself and see how far both move."""
    import sympy

    w, ridge = sympy.symbols("w ridge", positive=True)
    R_J = w * sympy.Matrix([[1, -1], [-1, 1]]) + ridge * sympy.eye(2)
    moved = [R_J.LUsolve(sympy.eye(2)[:, j]) for j in range(2)]
    lengths = [sympy.sqrt(sum(entry**2 for entry in column)) for column in moved]
    by_hand = ridge * (ridge + 2 * w) / sympy.sqrt((w + ridge) ** 2 + w**2)
    return Derivation(
        [
            Step("a push spreads, but its sum stays 1 / ridge", sum(moved[0]) - 1 / ridge),
            Step("both ends of one bone weigh the same", lengths[0] - lengths[1]),
            Step(
                "that weight is ridge (ridge + 2 w) / sqrt((w + ridge)^2 + w^2)",
                1 / lengths[0] - by_hand,
            ),
        ],
        (R_J,),
        sympy.Matrix([1 / length for length in lengths]),
    )


ANSWERS = {
    "projflow:11": Answer(
        r"The metric is the price $w \sum_n \sum_{(a, b)} \lVert u_{n,a} - u_{n,b} \rVert^2 + "
        r"\lambda \lVert u \rVert^2$ over frames and bones. A bone connects two joints of the same "
        r"frame on the same axis, so the matrix is diagonal in frame and axis and is $L$ between "
        r"joints. With entry $(nJ + j)\,3 + c$ the frame changes slowest: "
        r"$I_N \otimes L \otimes I_3$. The printed order, $I_3 \otimes I_N \otimes L$, belongs to "
        r"a vector sorted axis by axis.",
        "def kinematic_metric(frames, L, w_kin, ridge):\n"
        "    per_bone = np.kron(np.eye(frames), np.kron(L, np.eye(3)))\n"
        "    return w_kin * per_bone + ridge * np.eye(len(per_bone))",
        motion,
    ),
    "projflow:50": Answer(
        r"For one frame and one axis the price is $w \sum_{(a, b)} (u_a - u_b)^2 + \lambda \sum_j "
        r"u_j^2$. Half of its second derivatives are $w L + \lambda I$.",
        "def joint_metric(L, w_kin, ridge):\n    return w_kin * L + ridge * np.eye(len(L))",
        frame,
    ),
    "projflow:51": Answer(
        r"Push joint $j$ alone: $R_J u = e_j$. The answer $u$ is column $j$ of $R_J^{-1}$, and its "
        r"length says how far everything moves. Its entries sum to $1 / \lambda$ whatever $j$, so "
        r"a joint in the middle, which spreads the push, has the *shorter* column and the larger "
        r"weight.",
        "def influence_weights(R_J):\n    return 1 / np.linalg.norm(np.linalg.inv(R_J), axis=0)",
        influence,
    ),
}
