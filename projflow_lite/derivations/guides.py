"""Reach and trust of the guides, derived again: ProjFlow eq. 14–16, 48 and 52."""

from __future__ import annotations

from fractions import Fraction
from statistics import median

import numpy as np

from projflow_lite import equations as eq

from .problems import gap, largest, sympy
from .registry import derives


@derives(14, "the line through its two ends, in fractions", 1e-14)
def radius_in_fractions(random: np.random.Generator) -> float:
    """A straight line in t is l_max at 0 and l_min at 1; a halo of constant size is one too."""
    deviations = []
    for l_min, l_max in ((3, 10), (0, 7), (4, 4)):
        times = [0.0, *random.uniform(size=4), 1.0]
        line = [float(l_max + Fraction(t) * (l_min - l_max)) for t in times]
        deviations.append(gap(eq.halo_radius(times, l_min, l_max), line))
    return largest(deviations)


@derives(14, "frames within reach of a keyframe, counted one by one", 0)
def frames_within_reach(random: np.random.Generator) -> float:
    """Walk from every frame to the nearest keyframe and compare the distance with the line."""
    different = 0
    for t in random.uniform(size=20):
        observed = random.uniform(size=(24, 2)) < 0.1
        active = eq.halo(observed, float(eq.halo_radius(t, 3, 10)))
        for n, j in np.ndindex(observed.shape):
            distance = min((abs(n - m) for m in range(24) if observed[m, j]), default=99)
            different += active[n, j] != (0 < distance < 10 - 7 * Fraction(t))
    return float(different)


@derives(15, "number by number in fractions, with Python's own median", 1e-12)
def trust_in_fractions(random: np.random.Generator) -> float:
    """One frame, an odd and an even number of them; power 2, so that fractions stay fractions."""
    deviations = []
    for frames in (1, 5, 6):
        s, t = random.uniform(0.1, 3, frames), random.uniform()
        middle = median(map(Fraction, s))
        tau = Fraction(1) - (1 - Fraction(0.1)) * Fraction(t)
        trust = [float(tau * 3 / (1 + 2 * (Fraction(s_n) / middle) ** 2)) for s_n in s]
        deviations.append(gap(eq.frame_trust(s, t, 3.0, 2.0, 2.0, 0.1), trust))
    return largest(deviations)


@derives(48, "read backwards: a line through logarithms gives p, lambda back", 1e-10)
def constants_from_a_line(random: np.random.Generator) -> float:
    """Solved for the curvature, log(tau c0 / trust - 1) = log lambda + p log(s / s_med).

    A straight line fitted to that must have the slope p and the height log lambda.
    """
    c0, lambda_s, p = random.uniform(0.5, 4, 3)
    tau_min, t, s = 0.1, random.uniform(), random.uniform(0.2, 3, 9)
    trust = eq.frame_trust(s, t, c0, lambda_s, p, tau_min)
    tau = 1 - t + t * tau_min
    logarithms = np.log(tau * c0 / trust - 1)
    slope, height = np.polyfit(np.log(s / median(s)), logarithms, 1)
    return largest([abs(slope - p), abs(height - np.log(lambda_s))])


@derives(48, "nothing bends, or one frame only: sympy's limit of the median", 1e-14)
def limit_of_a_straight_walk(random: np.random.Generator) -> float:
    """At a median of 0 the printed ratio is 0/0 or infinite; the limit says what is meant."""
    sp = sympy()
    t, tau_min, c0 = random.uniform(), 0.1, random.uniform(0.5, 4)
    s_med, s = sp.symbols("s_med s", positive=True)
    bent = float(sp.limit(1 / (1 + (s / s_med) ** 2), s_med, 0, "+"))
    straight = float(sp.limit(1 / (1 + (s / s_med) ** 2), s, 0, "+"))
    budget = (1 - t + t * tau_min) * c0
    ours = [
        eq.frame_trust(curvatures, t, c0, 1.0, 2.0, tau_min)
        for curvatures in ([0.0] * 4, [0.0, 0.0, 0.0, 5.0], [0.0])
    ]
    limits = [[straight] * 4, [straight, straight, straight, bent], [straight]]
    return largest(gap(a, budget * np.array(b)) for a, b in zip(ours, limits, strict=True))


@derives(16, "sympy solves d tau / dt = -(1 - tau_min) from tau(0) = 1", 1e-14)
def steady_loss(random: np.random.Generator) -> float:
    """Trust is lost at a constant rate, all of it but tau_min over the whole run."""
    sp = sympy()
    t, tau_min, tau = sp.Symbol("t"), sp.Symbol("tau_min"), sp.Function("tau")
    solution = sp.dsolve(sp.Eq(tau(t).diff(t), tau_min - 1), tau(t), ics={tau(0): 1}).rhs
    law = sp.lambdify((t, tau_min), solution)
    times = np.array([0.0, *random.uniform(size=5), 1.0])
    return largest(gap(eq.time_decay(times, floor), law(times, floor)) for floor in (0.0, 0.1, 1.0))


@derives(52, "joint by joint in fractions; frames with no guide and with all", 1e-14)
def shares_in_fractions(random: np.random.Generator) -> float:
    """Divide the budget by weight among the active joints, and only then clip."""
    frames, joints, low, high = 6, 4, 0.02, 1.0
    budget, q = random.uniform(0, 3, frames), random.uniform(0.5, 3, joints)
    active = random.integers(0, 2, (frames, joints)).astype(bool)
    active[0], active[1] = False, True
    expected = np.zeros((frames, joints))
    for n, j in zip(*np.nonzero(active), strict=True):
        total = sum(Fraction(q[k]) for k in range(joints) if active[n, k])
        share = float(Fraction(budget[n]) * Fraction(q[j]) / total)
        expected[n, j] = low if share < low else high if share > high else share
    return gap(eq.joint_trust(budget, q, active, low, high), expected)


@derives(52, "unclipped, the whole budget is spent, in proportion to weights", 1e-13)
def budget_is_spent(random: np.random.Generator) -> float:
    """The shares add up to the budget, and any two of them stand like their joints' weights."""
    budget, q = random.uniform(0.3, 0.9, 5), random.uniform(1, 2, 6)
    trust = eq.joint_trust(budget, q, np.ones((5, 6)), 0.001, 1.0)
    crossed = trust[:, :, None] * q - trust[:, None, :] * q[:, None]
    return largest([gap(trust.sum(axis=1), budget), gap(crossed, np.zeros((5, 6, 6)))])
