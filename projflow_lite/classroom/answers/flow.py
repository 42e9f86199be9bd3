"""Answers to ProjFlow eq. 2, 3, 5, 9 and 10."""

from __future__ import annotations

from .derivation import Answer, Derivation, Step


def straight_path() -> Derivation:
    """The line through two points, solved for its two coefficients."""
    import sympy

    x0, x1, t = sympy.symbols("x0 x1 t", positive=True)
    a, b = sympy.symbols("a b")
    line = a + b * t
    ends = [line.subs(t, 0) - x0, line.subs(t, 1) - x1]
    x_t = line.subs(sympy.solve(ends, [a, b]))
    return Derivation(
        [
            Step(
                "the line through x0 at t = 0 and x1 at t = 1 is eq. 2", x_t - (1 - t) * x0 - t * x1
            ),
            Step("its velocity is x1 - x0 at all times", sympy.diff(x_t, t) - (x1 - x0)),
        ],
        (x0, x1, t),
        sympy.expand(x_t),
    )


def loss() -> Derivation:
    """Two samples of three coordinates, written out."""
    import numpy as np
    import sympy

    names = ("v", "x0", "x1")
    v, x0, x1 = (np.array(sympy.symbols(f"{n}_:6")).reshape(2, 1, 1, 3) for n in names)
    per_sample = [sum((v - (x1 - x0))[b].ravel() ** 2) for b in range(2)]
    mean = (per_sample[0] + per_sample[1]) / 2
    w, u, z = sympy.symbols("w u z")
    both = ((w - u) ** 2 + (w - z) ** 2) / 2  # one state, reached by two paths
    best = sympy.solve(sympy.diff(both, w), w)[0]
    right = dict(zip(v.ravel(), (x1 - x0).ravel(), strict=True))
    return Derivation(
        [
            Step("the loss is zero where v is the straight velocity", mean.subs(right)),
            Step(
                "where paths cross, the best v is the mean of their velocities", best - (u + z) / 2
            ),
        ],
        (v, x0, x1),
        mean,
    )


def endpoint() -> Derivation:
    """Position and velocity of the straight path, solved for its end."""
    import sympy

    x_t, v, t, x0, x1 = sympy.symbols("x_t v t x0 x1")
    path = [sympy.Eq(x_t, (1 - t) * x0 + t * x1), sympy.Eq(v, x1 - x0)]
    ends = sympy.solve(path, [x0, x1])
    return Derivation(
        [
            Step("the end of the path is x_t + (1 - t) v", ends[x1] - x_t - (1 - t) * v),
            Step("its start, the implied noise, is x_t - t v", ends[x0] - x_t + t * v),
        ],
        (x_t, v, t),
        ends[x1],
    )


def noise_mixture() -> Derivation:
    """Weights of two independent noises from their variances."""
    import sympy
    from sympy.stats import Normal, variance

    a, b, eta, x0, eps = sympy.symbols("a b eta x0 eps", positive=True)
    old, fresh = Normal("old", 0, 1), Normal("fresh", 0, 1)
    share = variance(b * fresh)
    whole = variance(a * old) + share  # independent: variances add up
    (weights,) = sympy.solve([share - eta, whole - 1], [a, b], dict=True)
    mixed = (a * x0 + b * eps).subs(weights)
    return Derivation(
        [
            Step("the weight of the fresh noise is the root of eta", weights[b] - sympy.sqrt(eta)),
            Step("that of the old noise is the root of 1 - eta", weights[a] - sympy.sqrt(1 - eta)),
            Step("the variance of the mixture is 1", whole.subs(weights) - 1),
        ],
        (x0, eps, eta),
        mixed,
    )


def next_state() -> Derivation:
    """Eq. 2 between the implied noise and the predicted endpoint is a step of Euler."""
    import sympy

    x1, noise, t_next, x_t, v, t = sympy.symbols("x1 noise t_next x_t v t")
    state = straight_path()
    x_next = state.result.subs(
        dict(zip(state.arguments, (noise, x1, t_next), strict=True)), simultaneous=True
    )
    euler = x_next.subs({x1: x_t + (1 - t) * v, noise: x_t - t * v})
    return Derivation(
        [
            Step("at t_next = 1 only the endpoint is left", x_next.subs(t_next, 1) - x1),
            Step(
                "with implied noise and no projection it is an Euler step",
                euler - (x_t + (t_next - t) * v),
            ),
        ],
        (x1, noise, t_next),
        x_next,
    )


ANSWERS = {
    "projflow:2": Answer(
        r"A straight path is $a + b\,t$. Its ends fix both coefficients: $t = 0$ gives $a = x_0$, "
        r"$t = 1$ gives $b = x_1 - x_0$. Sorted by ends, $x_t = (1 - t)\,x_0 + t\,x_1$.",
        "def interpolate(x0, x1, t):\n    return (1 - t) * x0 + t * x1",
        straight_path,
    ),
    "projflow:3": Answer(
        r"The path of eq. 2 has the velocity $x_1 - x_0$. The loss is the mean over samples of "
        r"$\lVert v - (x_1 - x_0) \rVert^2$, the norm summing over all coordinates of one sample. "
        r"Where several paths pass through one state, the mean of their velocities is best: "
        r"that is why the trained field is a conditional mean.",
        "def flow_matching_loss(v, x0, x1):\n    return np.sum((v - (x1 - x0)) ** 2) / len(v)",
        loss,
    ),
    "projflow:5": Answer(
        r"Position and velocity of a straight path are $x_t = (1 - t)\,x_0 + t\,x_1$ and "
        r"$v = x_1 - x_0$. These are two linear equations for the two ends. Their solution is "
        r"$x_1 = x_t + (1 - t)\,v$, and on the side $x_0 = x_t - t\,v$. Conditional means of "
        r"both sides given $x_t$ turn it into eq. 5.",
        "def tweedie_endpoint(x_t, v, t):\n    return x_t + (1 - t) * v",
        endpoint,
    ),
    "projflow:9": Answer(
        r"Let the weights be $a$ and $b$. Independent noises of variance 1 give the variance "
        r"$a^2 + b^2$. The fresh noise shall have the share $\eta$ of it, $b^2 = \eta$, and the "
        r"whole shall stay 1: $a^2 = 1 - \eta$.",
        "def mix_noise(x0, eps, eta):\n    return np.sqrt(1 - eta) * x0 + np.sqrt(eta) * eps",
        noise_mixture,
    ),
    "projflow:10": Answer(
        r"It is eq. 2 with other ends, the mixed noise and the corrected endpoint, at the next "
        r"time. With nothing corrected and no fresh noise it is a step of Euler's method.",
        "def recompose(x1, noise, t_next):\n    return t_next * x1 + (1 - t_next) * noise",
        next_state,
    ),
}
