"""Answers to ProjFlow eq. 7, 8 and 21."""

from __future__ import annotations

from .derivation import Answer, Derivation, Step


def correction() -> Derivation:
    """The price of eq. 6 minimised by solving for a vanishing gradient."""
    import numpy as np
    import sympy

    a, b, c, s, y = sympy.symbols("a b c s y", positive=True)
    x = sympy.Matrix(sympy.symbols("x_:2", positive=True))
    A = sympy.Matrix([sympy.symbols("A_:2", positive=True)])
    R = sympy.Matrix([[1 + a, b], [b, 1 + c]])  # positive definite for all a, b, c in 0..1
    Sigma, wish = sympy.Matrix([[s]]), sympy.Matrix([y])
    delta = sympy.Matrix(sympy.symbols("delta_:2"))
    misfit = wish - A * (x + delta)
    price = (delta.T * R * delta + misfit.T * Sigma.inv() * misfit)[0] / 2
    best = sympy.solve([sympy.diff(price, entry) for entry in delta], list(delta))
    found = x + delta.subs(best)
    R_inv = R.inv()
    printed = R_inv * A.T * (A * R_inv * A.T + Sigma).inv() * (wish - A * x)
    exact = found.subs(s, 0)
    return Derivation(
        [
            Step("the price of eq. 6 is least at the correction of eq. 7", found - x - printed),
            Step("for Sigma = 0 the wish is met exactly", A * exact - wish),
            Step("a wish that is met already needs no correction", printed.subs(y, (A * x)[0])),
        ],
        (x, A, wish, R, np.array([[s]])),
        found,
    )


def range_and_null_space() -> Derivation:
    """The nearest point that meets one row, by Lagrange's conditions."""
    import sympy

    x, z = (sympy.Matrix(sympy.symbols(f"{n}_:3", positive=True)) for n in "xz")
    A = sympy.Matrix([sympy.symbols("A_:3", positive=True)])
    y, multiplier = sympy.symbols("y multiplier", positive=True)
    distance = ((z - x).T * (z - x))[0] / 2 - multiplier * ((A * z)[0] - y)
    unknowns = [*z, multiplier]
    best = sympy.solve([sympy.diff(distance, u) for u in unknowns], unknowns)
    found = z.subs(best)
    pinv = A.T / (A * A.T)[0]
    rest = sympy.eye(3) - pinv * A
    return Derivation(
        [
            Step("the nearest point that meets the row is eq. 21", found - pinv * y - rest * x),
            Step("it meets the row", A * found - sympy.Matrix([y])),
            Step("what the row cannot see is left as it was", rest * (found - x)),
            Step("the row sees nothing of I - pinv(A) A", A * rest),
        ],
        (x, A, sympy.Matrix([y])),
        found,
    )


ANSWERS = {
    "projflow:7": Answer(
        r"The price of eq. 6, $\tfrac12 \lVert \Delta \rVert_R^2 + \tfrac12 \lVert r - A \Delta "
        r"\rVert_{\Sigma^{-1}}^2$ with the misfit $r = y - A \hat{x}_1$, is convex. Its gradient "
        r"vanishes where $R \Delta = A^\top z$ with $z = \Sigma^{-1} (r - A \Delta)$. So "
        r"$\Delta = R^{-1} A^\top z$; put into $\Sigma z = r - A \Delta$ this is "
        r"$(A R^{-1} A^\top + \Sigma)\, z = r$. No step divides by $\Sigma$ any more: it may be 0. "
        r"Eq. 8 adds $\Delta$ to the prediction.",
        "def project(x1_hat, A, y, R, Sigma):\n"
        "    R_inv_At = np.linalg.solve(R, A.T)\n"
        "    S = A @ R_inv_At + Sigma\n"
        "    return x1_hat + R_inv_At @ np.linalg.solve(S, y - A @ x1_hat)",
        correction,
    ),
    "projflow:21": Answer(
        r"Among all $x$ with $A x = y$ take the one nearest to $\hat{x}_1$. Lagrange: "
        r"$x - \hat{x}_1 = A^\top z$, so the change lies in what the rows see, and "
        r"$(I - A^{+} A)\, x = (I - A^{+} A)\, \hat{x}_1$. The seen part is $A^{+} A x = A^{+} y$. "
        r"Together they are eq. 21. For dependent rows the pseudo-inverse gives least squares.",
        "def ddnm(x1_hat, A, y):\n"
        "    A_pinv = np.linalg.pinv(A)\n"
        "    return A_pinv @ y + (np.eye(len(x1_hat)) - A_pinv @ A) @ x1_hat",
        range_and_null_space,
    ),
}
