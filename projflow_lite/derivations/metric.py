"""The skeleton's metric, derived again: ProjFlow eq. 11, 17 and 49–51."""

from __future__ import annotations

import math

import numpy as np

from projflow_lite import equations as eq
from projflow_lite.skeleton import EDGES, N_JOINTS

from .problems import (
    STICK,
    STICK_JOINTS,
    elastic_energy,
    exact,
    gap,
    largest,
    metric_by_bones,
    numbers,
    sympy,
)
from .registry import derives


@derives(11, "price of random motions, bone by bone; one frame, one joint", 1e-12)
def price_bone_by_bone(random: np.random.Generator) -> float:
    """A metric prices a motion: squared differences over bones, squares over joints."""
    deviations = []
    for frames, bones, joints in ((2, EDGES, N_JOINTS), (3, STICK, STICK_JOINTS), (1, (), 1)):
        w_kin, ridge = random.uniform(1, 20), random.uniform(0.1, 2)
        R = eq.kinematic_metric(frames, eq.kinematic_laplacian(bones, joints), w_kin, ridge)
        u = random.normal(size=(frames, joints, 3))
        price = elastic_energy(u, bones, w_kin, ridge)
        deviations.append(abs(u.ravel() @ R @ u.ravel() / price - 1))
    return largest(deviations)


@derives(49, "every entry put in its place by loops over frames and bones", 1e-13)
def entry_by_entry(random: np.random.Generator) -> float:
    """A bone couples two joints in the same frame and on the same axis: index (n J + j) 3 + c."""
    deviations = []
    for frames, bones, joints in ((3, STICK, STICK_JOINTS), (1, ((0, 1),), 2), (2, (), 1)):
        w_kin, ridge = random.uniform(1, 20), random.uniform(0.1, 2)
        ours = eq.kinematic_metric(frames, eq.kinematic_laplacian(bones, joints), w_kin, ridge)
        deviations.append(gap(ours, metric_by_bones(frames, joints, bones, w_kin, ridge)))
    return largest(deviations)


@derives(49, "sympy's second derivatives of the price of two frames", 1e-13)
def second_derivatives(random: np.random.Generator) -> float:
    """Twice the metric is the matrix of second derivatives of the price it stands for."""
    sp = sympy()
    w_kin, ridge = random.uniform(1, 20), random.uniform(0.1, 2)
    letters = sp.symbols(f"u0:{2 * STICK_JOINTS * 3}")
    u = np.array(letters, dtype=object).reshape(2, STICK_JOINTS, 3)
    price = sp.expand(elastic_energy(u, STICK, sp.Symbol("w"), sp.Symbol("l")))
    hessian = sp.hessian(price, letters) / 2
    R = hessian.subs({sp.Symbol("w"): sp.Rational(w_kin), sp.Symbol("l"): sp.Rational(ridge)})
    L = eq.kinematic_laplacian(STICK, STICK_JOINTS)
    return gap(eq.kinematic_metric(2, L, w_kin, ridge), numbers(R))


@derives(50, "sympy's second derivatives of one axis; a single joint too", 1e-13)
def one_frame_one_axis(random: np.random.Generator) -> float:
    """Half the second derivatives of the price, with letters for the two weights."""
    sp = sympy()
    deviations = []
    for bones, joints in ((STICK, STICK_JOINTS), ((), 1)):
        w, ridge = sp.symbols("w lambda", positive=True)
        letters = sp.symbols(f"u0:{joints}")
        u = np.array(letters, dtype=object).reshape(1, joints, 1)
        block = sp.lambdify((w, ridge), sp.hessian(elastic_energy(u, bones, w, ridge), letters) / 2)
        w_, ridge_ = random.uniform(1, 20), random.uniform(0.1, 2)
        L = eq.kinematic_laplacian(bones, joints)
        deviations.append(gap(eq.joint_metric(L, w_, ridge_), block(w_, ridge_)))
    return largest(deviations)


@derives(50, "joints that move together, and one bone torn apart, by hand", 1e-12)
def two_motions_by_hand(random: np.random.Generator) -> float:
    """Moved together no bone is stretched, so only the ridge answers. Torn apart, w does too."""
    w_kin, ridge = random.uniform(1, 20), random.uniform(0.1, 2)
    R_J = eq.joint_metric(eq.kinematic_laplacian(EDGES, N_JOINTS), w_kin, ridge)
    together = gap(R_J @ np.ones(N_JOINTS), ridge * np.ones(N_JOINTS))
    bone = eq.joint_metric(eq.kinematic_laplacian([(0, 1)], 2), w_kin, ridge)
    apart = gap(bone @ [1, -1], [2 * w_kin + ridge, -2 * w_kin - ridge])
    return largest([together, apart])


@derives(51, "visits of a walker from joint to joint, 4000 steps", 1e-12)
def influence_as_a_walk(random: np.random.Generator) -> float:
    """A column of the inverse is a count of visits.

    At each step the walker takes a bone with weight w or leaves the body with weight lambda.
    """
    w_kin, ridge = random.uniform(2, 12), random.uniform(0.5, 2)
    neighbours = np.zeros((N_JOINTS, N_JOINTS))
    for a, b in EDGES:
        neighbours[a, b] = neighbours[b, a] = w_kin
    leaving = neighbours.sum(axis=0) + ridge
    visits = walkers = np.diag(1 / leaving)
    for _ in range(4000):
        walkers = (neighbours @ walkers) / leaving[:, None]
        visits = visits + walkers
    lengths = [math.sqrt(math.fsum(v * v for v in column)) for column in visits.T]
    R_J = eq.joint_metric(eq.kinematic_laplacian(EDGES, N_JOINTS), w_kin, ridge)
    return gap(eq.influence_weights(R_J) * lengths, np.ones(N_JOINTS))


@derives(51, "columns of an inverse in fractions; a single joint too", 1e-12)
def columns_in_fractions(random: np.random.Generator) -> float:
    """Sympy inverts the stick figure's matrix without rounding and measures its columns."""
    deviations = []
    for bones, joints in ((STICK, STICK_JOINTS), ((), 1)):
        w_kin, ridge = random.integers(1, 40) / 4, random.integers(1, 8) / 4
        R_J = np.diag(np.full(joints, ridge))
        for a, b in bones:
            R_J[[a, b], [a, b]] += w_kin
            R_J[[a, b], [b, a]] -= w_kin
        inverse = exact(R_J).inv()
        q = [float(1 / inverse.col(j).norm()) for j in range(joints)]
        deviations.append(gap(eq.influence_weights(R_J), q))
    return largest(deviations)


@derives(17, "second differences, bone by bone; motions too short to bend", 1e-11)
def bending_bone_by_bone(random: np.random.Generator) -> float:
    """Take one frame's second difference, price it as a motion, take the root.

    The two ends have no second difference of their own and copy the one beside them.
    """
    w_kin, ridge = random.uniform(1, 20), random.uniform(0.1, 2)
    R_J = eq.joint_metric(eq.kinematic_laplacian(STICK, STICK_JOINTS), w_kin, ridge)
    deviations = []
    for frames in (0, 1, 2, 3, 7):
        x = random.normal(size=(frames, STICK_JOINTS, 3))
        s = [0.0] * frames
        for n in range(frames if frames > 2 else 0):
            m = min(max(n, 1), frames - 2)
            bend = (x[m + 1] - 2 * x[m] + x[m - 1])[None]
            s[n] = math.sqrt(elastic_energy(bend, STICK, w_kin, ridge))
        deviations.append(gap(eq.curvature(x, R_J), s))
    return largest(deviations)


@derives(17, "a thrown body bends by g dt^2 per joint, a steady walk by 0", 1e-11)
def a_thrown_body(random: np.random.Generator) -> float:
    """Falling, all 22 joints share one second difference, g dt^2; a steady walk has none."""
    ridge, dt, frames = random.uniform(0.1, 2), 1 / 20, 8
    R_J = eq.joint_metric(eq.kinematic_laplacian(EDGES, N_JOINTS), 10.0, ridge)
    walk = random.normal(size=(N_JOINTS, 3)) + np.arange(frames)[:, None, None] * [0.1, 0, 0.05]
    thrown = walk.copy()
    thrown[..., 1] -= 0.5 * 9.81 * (dt * np.arange(frames)[:, None]) ** 2
    expected = np.full(frames, 9.81 * dt**2 * math.sqrt(ridge * N_JOINTS))
    return largest(
        [gap(eq.curvature(thrown, R_J), expected), gap(eq.curvature(walk, R_J), 0 * expected)]
    )
