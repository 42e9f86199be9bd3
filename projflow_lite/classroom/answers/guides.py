"""Answers to ProjFlow eq. 14 to 17 and 52."""

from __future__ import annotations

from .derivation import Answer, Derivation, Step


def radius() -> Derivation:
    """The line through two radii."""
    import sympy

    t, low, more = sympy.symbols("t low more", positive=True)
    a, b = sympy.symbols("a b")
    l_min, l_max = low, low + more
    line = a + b * t
    found = line.subs(sympy.solve([line.subs(t, 0) - l_max, line.subs(t, 1) - l_min], [a, b]))
    return Derivation(
        [
            Step("the line from l_max to l_min is eq. 14", found - (1 - t) * l_max - t * l_min),
            Step("it shrinks at the rate l_max - l_min", sympy.diff(found, t) + l_max - l_min),
        ],
        (t, l_min, l_max),
        found,
    )


def decay() -> Derivation:
    """The line from 1 to what is left."""
    import sympy

    t, tau_min = sympy.symbols("t tau_min", positive=True)
    a, b = sympy.symbols("a b")
    line = a + b * t
    found = line.subs(sympy.solve([line.subs(t, 0) - 1, line.subs(t, 1) - tau_min], [a, b]))
    return Derivation(
        [Step("the line from 1 to tau_min is eq. 16", found - tau_min - (1 - tau_min) * (1 - t))],
        (t, tau_min),
        found,
    )


def trust_of_a_frame() -> Derivation:
    """Three frames in order of curvature: what the middle one and the limits get."""
    import sympy

    t, c0, strength, p, tau_min = sympy.symbols("t c0 strength p tau_min", positive=True)
    a, b, c, ratio = sympy.symbols("a b c ratio", positive=True)
    s = sympy.Matrix([a + b, a, a + b + c])  # the median is the first: a + b
    full = decay().result * c0
    trust = full / (1 + strength * ratio**p)
    squared, at_median = trust.subs(p, 2), trust.subs(ratio, 1)
    slope = sympy.diff(trust, ratio) * (1 + strength * ratio**p) ** 2 * ratio / ratio**p
    return Derivation(
        [
            Step("a frame that does not bend gets tau c0", sympy.limit(squared, ratio, 0) - full),
            Step("one that bends without end gets none", sympy.limit(squared, ratio, sympy.oo)),
            Step("the median gets tau c0 / (1 + lambda_s)", at_median - full / (1 + strength)),
            Step("more curvature, less trust: the slope has one sign", slope + full * strength * p),
        ],
        (s, t, c0, strength, p, tau_min),
        sympy.Matrix([trust.subs(ratio, s_n / (a + b)) for s_n in s]),
    )  # fmt: skip


def bend() -> Derivation:
    """Three frames of two joints: the norm by a sum over the bone, the joints and the axes."""
    import numpy as np
    import sympy

    n, a, b, c = sympy.symbols("n a b c")
    w, ridge = sympy.symbols("w ridge", positive=True)
    parabola = a + b * n + c * n**2
    second = parabola.subs(n, n + 1) - 2 * parabola + parabola.subs(n, n - 1)
    x = np.array(sympy.symbols("x_:18", positive=True)).reshape(3, 2, 3)
    u, v = x[2] - 2 * x[1] + x[0]  # how the two joints bend
    squared = sum(w * (u - v) ** 2 + ridge * (u**2 + v**2))
    R_J = w * sympy.Matrix([[1, -1], [-1, 1]]) + ridge * sympy.eye(2)
    axes = [sympy.Matrix(pair) for pair in zip(u, v, strict=True)]
    form = sum((joints.T * R_J * joints)[0] for joints in axes)
    return Derivation(
        [
            Step("of a parabola only the square term is left: 2 c", second - 2 * c),
            Step("the form of R_J is a sum over bones, joints and axes", form - squared),
        ],
        (x, R_J),
        sympy.Matrix([sympy.sqrt(squared)] * 3),
    )  # fmt: skip


def trust_of_a_joint() -> Derivation:
    """One frame with three joints, two of them active, and bounds too wide to matter."""
    import sympy

    budget, first, second, third, unit = sympy.symbols("budget q_0 q_1 q_2 unit", positive=True)
    rest = sympy.solve(unit * first + unit * third - budget, unit)[0]
    shares = sympy.Matrix([[rest * first, 0, rest * third]])
    printed = [budget * q / (first + third) for q in (first, third)]
    return Derivation(
        [
            Step("shares in proportion to q that spend the budget are those of eq. 52",
                 sympy.Matrix([shares[0] - printed[0], shares[2] - printed[1]])),
            Step("they add up to the frame's trust", sum(shares) - budget),
        ],
        (
            sympy.Matrix([budget]),
            sympy.Matrix([first, second, third]),
            sympy.Matrix([[1, 0, 1]]),
            sympy.Float(1e-6),
            sympy.Integer(1),
        ),
        shares,
    )  # fmt: skip


ANSWERS = {
    "projflow:14": Answer(
        r"A line $a + b\,t$ through $\ell_{max}$ at $t = 0$ and $\ell_{min}$ at $t = 1$ has "
        r"$a = \ell_{max}$ and $b = \ell_{min} - \ell_{max}$. Sorted by radii that is eq. 14.",
        "def halo_radius(t, l_min, l_max):\n    return (1 - t) * l_max + t * l_min",
        radius,
    ),
    "projflow:15": Answer(
        r"The ratio $s_n / s_{med}$ has no unit. Below the line it makes a factor between 1 (no "
        r"bend) and 0 (any bend, in the limit); a frame at the median gets $1 / (1 + \lambda_s)$. "
        r"Time and strength multiply it. With $c_0 = 3$ it exceeds 1: it is not clipped yet.",
        "def frame_trust(s, t, c0, lambda_s, p, tau_min):\n"
        "    tau = tau_min + (1 - tau_min) * (1 - t)\n"
        "    return tau * c0 / (1 + lambda_s * (s / np.median(s)) ** p)",
        trust_of_a_frame,
    ),
    "projflow:16": Answer(
        r"$\tau_{min}$ stays; the rest, $1 - \tau_{min}$, fades with the time left, $1 - t$.",
        "def time_decay(t, tau_min):\n    return tau_min + (1 - tau_min) * (1 - t)",
        decay,
    ),
    "projflow:17": Answer(
        r"The second difference $a_n = x_{n+1} - 2 x_n + x_{n-1}$ vanishes for steady motion. Its "
        r"norm is that of eq. 11 for one frame, $\lVert a_n \rVert_R^2 = \sum_c a_{n,c}^\top R_J\, "
        r"a_{n,c}$: the axes are added under one root. The ends have one neighbour only and copy.",
        "def curvature(x1_hat, R_J):\n"
        "    a = x1_hat[2:] - 2 * x1_hat[1:-1] + x1_hat[:-2]\n"
        '    s = np.sqrt(np.einsum("njc,jk,nkc->n", a, R_J, a))\n'
        "    return np.concatenate([s[:1], s, s[-1:]])",
        bend,
    ),
    "projflow:52": Answer(
        r"Shares in proportion to $q_j$ that spend the budget $\tilde\pi_n$ of a frame are "
        r"$\tilde\pi_n\, q_j / \sum_{k \in H_n} q_k$, the sum over the joints active in that "
        r"frame. Each is clipped; joints that are not active have no guide to trust.",
        "def joint_trust(pi_frame, q, active, pi_min, pi_max):\n"
        "    total = (q * active).sum(axis=1, keepdims=True)\n"
        "    total[total == 0] = 1  # no active joint: the line below gives 0 anyway\n"
        "    share = pi_frame[:, None] * q / total\n"
        "    return np.where(active, np.clip(share, pi_min, pi_max), 0)",
        trust_of_a_joint,
    ),
}
