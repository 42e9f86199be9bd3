"""Answers to ProjFlow eq. 18, 31 and 46."""

from __future__ import annotations

from typing import Any

from .derivation import Answer, Derivation, Step


def _share_of_one_coordinate() -> tuple[Any, Any, Any]:
    """Minimise eq. 6 for one coordinate with prior variance r and return (share, variance, r)."""
    import sympy

    variance, r, misfit, delta = sympy.symbols("variance r misfit delta", positive=True)
    price = delta**2 / (2 * r) + (misfit - delta) ** 2 / (2 * variance)
    best = sympy.solve(sympy.diff(price, delta), delta)[0]
    return sympy.simplify(best / misfit), variance, r


def trust() -> Derivation:
    """The corrected share of the misfit, from the price of one coordinate."""
    share, variance, r = _share_of_one_coordinate()
    return Derivation(
        [
            Step("the price of one coordinate is least at the share of eq. 46",
                 share - r / (r + variance)),
            Step("without variance the misfit is corrected in full", share.subs(variance, 0) - 1),
            Step("equal variances correct one half", 2 * share.subs(variance, r) - 1),
        ],
        (variance, r),
        share,
    )  # fmt: skip


def variance() -> Derivation:
    """The share of eq. 46, solved for the variance."""
    import sympy

    share, own, r = _share_of_one_coordinate()
    pi = sympy.Symbol("pi_", positive=True)
    (found,) = sympy.solve(sympy.Eq(pi, share), own)
    return Derivation(
        [
            Step("eq. 46 solved for the variance is eq. 18", found - r * (1 - pi) / pi),
            Step("eq. 47 is the same", found - r * (1 / pi - 1)),
            Step("full trust is a hard row", found.subs(pi, 1)),
        ],
        (pi, r),
        found,
    )


def normal_equations() -> Derivation:
    """Half of the gradient of eq. 30, with correlated noise, sorted into matrix and vector."""
    import sympy

    a, b, c, p, q, r = sympy.symbols("a b c p q r", positive=True)
    x, y = (sympy.Matrix(sympy.symbols(f"{n}_:2", positive=True)) for n in "xy")
    A = sympy.Matrix(2, 2, sympy.symbols("A_:4", positive=True))
    R = sympy.Matrix([[1 + a, b], [b, 1 + c]])
    Sigma = sympy.Matrix([[1 + p, q], [q, 1 + r]])
    z = sympy.Matrix(sympy.symbols("z_:2"))
    W, misfit = Sigma.inv(), y - A * z
    price = ((z - x).T * R * (z - x) + misfit.T * W * misfit)[0]
    slope = sympy.Matrix([sympy.diff(price, entry) for entry in z]) / 2
    H, at_zero = slope.jacobian(z), slope.subs(dict.fromkeys(z, 0))
    return Derivation(
        [
            Step("the slope's matrix is R + A' Sigma^-1 A", H - R - A.T * W * A),
            Step("its vector is R x1_hat + A' Sigma^-1 y", -at_zero - R * x - A.T * W * y),
            Step("the slope of eq. 30 is H x1 - b, with no other term", slope - H * z - at_zero),
        ],
        (x, A, y, R, Sigma),
        (H, -at_zero),
    )


ANSWERS = {
    "projflow:18": Answer(
        r"Eq. 46 says $\pi = r / (r + \sigma^2)$. Multiply by the denominator, "
        r"$\pi r + \pi \sigma^2 = r$, and solve: $\sigma^2 = r\,(1 - \pi) / \pi$.",
        "def variance_from_trust(pi, r):\n    return r * (1 - pi) / pi",
        variance,
    ),
    "projflow:31": Answer(
        r"Half of the gradient of eq. 30 is $R\,(x_1 - \hat{x}_1) - A^\top \Sigma^{-1} "
        r"(y - A x_1)$. Set it to zero and sort: what multiplies $x_1$ is "
        r"$H = R + A^\top \Sigma^{-1} A$, the rest is $b = R \hat{x}_1 + A^\top \Sigma^{-1} y$. "
        r"Precisions add up.",
        "def map_normal_equations(x1_hat, A, y, R, Sigma):\n"
        "    At_Sigma_inv = np.linalg.solve(Sigma, A).T\n"
        "    return R + At_Sigma_inv @ A, R @ x1_hat + At_Sigma_inv @ y",
        normal_equations,
    ),
    "projflow:46": Answer(
        r"For one coordinate eq. 6 reads $\tfrac12 \Delta^2 / r + \tfrac12 (m - \Delta)^2 / "
        r"\sigma^2$ with the misfit $m$. Its derivative vanishes at "
        r"$\Delta = m\, r / (r + \sigma^2)$: the share $\pi$ of the misfit.",
        "def trust_from_variance(variance, r):\n    return r / (r + variance)",
        trust,
    ),
}
