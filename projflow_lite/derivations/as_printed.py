"""Where the paper as printed, or its public code, does not give what it says: how far it is off.

Every function returns a deviation that is *expected* to be larger than rounding. It is infinite
where the printed form has no value at all.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from projflow_lite import equations as eq
from projflow_lite.skeleton import EDGES, JOINTS, N_JOINTS

from .problems import (
    STICK,
    STICK_JOINTS,
    elastic_energy,
    gap,
    lagrange,
    linear_model,
    metric_by_bones,
)
from .registry import contradicts

SAMPLES = 100_000
HARD = np.zeros((1, 1))
"""Sigma of one hard row."""
GAP_IN_A_MASK = (np.array([1.0, 2.0, 3.0]), np.diag([1.0, 0, 0]), np.array([5.0, 0, 0]))


def off(printed: Callable[[], ArrayLike], right: ArrayLike, to_invert: NDArray) -> float:
    """Distance of a printed form from the right answer; infinite if its inverse does not exist."""
    try:
        value = printed()
    except ValueError:
        if np.linalg.matrix_rank(to_invert) == len(to_invert):
            raise  # it could have been inverted: the refusal has another reason
        return math.inf
    return gap(value, right)


def raw_trust(s: ArrayLike, form: str = "printed") -> NDArray:
    """Trust at the start of a run with the constants of Table 5, before any clipping."""
    T = eq.TABLE_5
    return eq.frame_trust(s, 0.0, T["c0"], T["lambda_s"], T["p"], T["tau_min"], form)


@contradicts(1, "released grid of 100 times: updates too few")
def steps_and_updates(random: np.random.Generator) -> float:
    """Section C.1: a grid of 100 times has 99 steps between them."""
    return float(100 - len(np.diff(eq.time_grid(100, form="released"))))


@contradicts(6, "printed inverse of Sigma, for a hard row (Sigma = 0)")
def price_of_a_hard_constraint(random: np.random.Generator) -> float:
    """A correction that meets the constraint costs 1/2; the formula divides 0 by 0."""
    one = np.eye(1)
    return off(lambda: eq.projection_objective([1], [0], one, [1], one, HARD), 0.5, HARD)


@contradicts(7, "released 1e-8 on the diagonal: misses a hard row by (m)", 1e-11)
def nearly_exact(random: np.random.Generator) -> float:
    """The diagonal makes a hard row as soft as a variance of (0.1 mm)^2 would."""
    x1_hat, A, y, R, _ = linear_model(random)
    delta = eq.projection_correction(x1_hat, A, y, R, np.zeros((3, 3)), form="released")
    return gap(A @ (x1_hat + delta), y)


@contradicts(7, "released, two rows ask for 0 m and 1 m: misses both by (m)")
def contradiction_unnoticed(random: np.random.Generator) -> float:
    """No motion meets both; the same diagonal settles in the middle without a word."""
    A, y = np.ones((2, 1)), np.array([0.0, 1.0])
    delta = eq.projection_correction([0.0], A, y, [[1.0]], np.zeros((2, 2)), form="released")
    return float(np.abs(A @ delta - y).min())


@contradicts(9, "released mixing of implied noise: variance short of 1 by", 0.1)
def noise_that_shrinks(random: np.random.Generator) -> float:
    """An expected value varies less than what it is expected of: here (1 - t)^2 + t^2 = 1/2."""
    x0, x1, eps = random.normal(size=(3, SAMPLES))
    x_t = eq.interpolate(x0, x1, 0.5)
    v = np.zeros(SAMPLES)  # E[x1 - x0 | x_t] for normal data half-way
    return float(1 - eq.mix_noise(eq.implied_noise(x_t, v, 0.5), eps, 0.5).var())


@contradicts(11, "printed I_3 x I_N x L: a step of a body costs too much by")
def a_step_that_costs(random: np.random.Generator) -> float:
    """Moved as a whole no bone changes; the printed order sees bones between strangers."""
    step = np.zeros((2, STICK_JOINTS, 3))
    step[..., 0] = 1
    R = eq.kinematic_metric(2, eq.kinematic_laplacian(STICK, STICK_JOINTS), 10.0, 1.0, "printed")
    return float(step.ravel() @ R @ step.ravel() - elastic_energy(step, STICK, 10.0, 1.0))


@contradicts(12, "released reading of x alone: misses a wish about height by (m)")
def height_overlooked(random: np.random.Generator) -> float:
    """Pin the height of one joint at 1 m: the released rows are empty and nothing moves."""
    observed = np.zeros((1, 1, 3), dtype=bool)
    observed[..., 1] = True
    A = eq.selection_rows(observed, form="released")
    moved = lagrange(np.zeros(3), A, np.ones(len(A)), np.eye(3), np.zeros((len(A),) * 2))
    return abs(1 - moved[1])


@contradicts(14, "guides said to vanish: left beside a keyframe at t = 0.99")
def guides_that_stay(random: np.random.Generator) -> float:
    """The last update of a run still has a radius of 3.07 frames around a lone keyframe."""
    observed = np.arange(21) == 10
    radius = float(eq.halo_radius(0.99, eq.TABLE_5["l_min"], eq.TABLE_5["l_max"]))
    return float(eq.halo(observed, radius).sum())


@contradicts(15, "with Table 5, trust at the start and median: above 1 by")
def more_than_all(random: np.random.Generator) -> float:
    """Clipped to 1 it leaves no variance: the guide is then as hard as a keyframe."""
    return float(raw_trust([1.0])[0] - 1)


@contradicts(15, "released lower median of curvatures 1 and 3: trust off by")
def lower_median(random: np.random.Generator) -> float:
    """Matters for an even number of frames only: 1 and 3 have the median 2, not 1."""
    frames = np.array([1.0, 3.0])
    right = 3 / (1 + (frames / 2) ** 2)
    return gap(raw_trust(frames, "released"), right)


@contradicts(23, "printed inverse of A A', for a square mask with a gap")
def mask_without_full_rank(random: np.random.Generator) -> float:
    """An empty row makes the product singular; the nearest point, (5, 2, 3), exists."""
    M = GAP_IN_A_MASK[1]
    return off(lambda: eq.euclidean_projection(*GAP_IN_A_MASK), [5, 2, 3], M @ M.T)


@contradicts(31, "printed inverse of Sigma, for a hard row (Sigma = 0)")
def normal_equations_of_a_hard_row(random: np.random.Generator) -> float:
    """Their solution has a limit, x = y = 1, but both sides grow without bound as Sigma shrinks."""
    one = np.eye(1)

    def solution() -> NDArray:
        return np.linalg.solve(*eq.map_normal_equations([0], one, [1], one, HARD))

    return off(solution, [1], HARD)


@contradicts(32, "printed inverse of Sigma, for a hard row (Sigma = 0)")
def estimate_of_a_hard_row(random: np.random.Generator) -> float:
    """The limit, x = y = 1, exists; the formula does not reach it."""
    one = np.eye(1)
    return off(lambda: eq.map_estimate([0], one, [1], one, HARD), [1], HARD)


@contradicts(33, "printed inverse of Sigma, for a hard row (Sigma = 0)")
def correction_of_a_hard_row(random: np.random.Generator) -> float:
    """The limit, x = y = 1, exists; the formula does not reach it."""
    one = np.eye(1)
    return off(lambda: eq.map_estimate_as_correction([0], one, [1], one, HARD), [1], HARD)


@contradicts(39, "printed inverse of M + Sigma, for a hard keyframe and a gap")
def update_with_a_gap(random: np.random.Generator) -> float:
    """Observe the first of three coordinates exactly: (5, 2, 3) is the answer."""
    x1_hat, M, y = GAP_IN_A_MASK
    Sigma, right = np.zeros((3, 3)), [5, 2, 3]
    return off(lambda: eq.euclidean_masked_update(x1_hat, M, y, Sigma, "printed"), right, M + Sigma)


@contradicts(40, "printed inverse of M + Sigma, for a hard keyframe and a gap")
def average_with_a_gap(random: np.random.Generator) -> float:
    """Observe the first of three coordinates exactly: (5, 2, 3) is the answer."""
    x1_hat, M, y = GAP_IN_A_MASK
    Sigma, right = np.zeros((3, 3)), [5, 2, 3]
    return off(
        lambda: eq.euclidean_masked_average(x1_hat, M, y, Sigma, "printed"), right, M + Sigma
    )


@contradicts(44, "printed inverse, for a hard keyframe and a gap, in any metric")
def metric_update_with_a_gap(random: np.random.Generator) -> float:
    """Observe the first of three coordinates exactly, with R = I: (5, 2, 3) is the answer."""
    x1_hat, M, y = GAP_IN_A_MASK
    R, Sigma, right = np.eye(3), np.zeros((3, 3)), [5, 2, 3]
    S = M @ np.linalg.inv(R) @ M.T + Sigma
    return off(lambda: eq.masked_update(x1_hat, M, y, R, Sigma, "printed"), right, S)


@contradicts(45, "printed inverse, for a hard keyframe and a gap, in any metric")
def metric_average_with_a_gap(random: np.random.Generator) -> float:
    """Observe the first of three coordinates exactly, with R = I: (5, 2, 3) is the answer."""
    x1_hat, M, y = GAP_IN_A_MASK
    R, Sigma, right = np.eye(3), np.zeros((3, 3)), [5, 2, 3]
    S = M @ np.linalg.inv(R) @ M.T + Sigma
    return off(lambda: eq.masked_average(x1_hat, M, y, R, Sigma, "printed"), right, S)


@contradicts(46, "two guides of trust 1/2 on one bone: correct more than 1/2 by")
def neighbours_add_up(random: np.random.Generator) -> float:
    """Each pulls the other along: together they correct more than either was meant to."""
    R = metric_by_bones(1, 2, ((0, 1),), 10.0, 1.0)
    variance = float(eq.variance_from_trust(0.5, np.linalg.inv(R)[0, 0]))
    delta = lagrange(np.zeros(6), np.eye(6)[[0, 3]], [1, 1], R, variance * np.eye(2))
    return delta[0] - float(eq.trust_from_variance(variance, np.linalg.inv(R)[0, 0]))


@contradicts(47, "said to become the Euclidean weight for R = I: apart by")
def remark_about_the_wrong_one(random: np.random.Generator) -> float:
    """Eq. 46 becomes that weight; a variance is not a share."""
    return abs(float(eq.variance_from_trust(0.5, 1.0) - eq.euclidean_gain(0.5)))


@contradicts(48, "taken unclipped by a lone joint: variance below 0 by")
def negative_variance(random: np.random.Generator) -> float:
    """Where nothing bends the trust is 3 at the start, and r (1/3 - 1) is no variance."""
    trust = float(raw_trust([0.0])[0])
    return -(1 / trust - 1)  # for r = 1


@contradicts(49, "printed I_3 x I_N x L: coupling of strangers, up to")
def strangers_coupled(random: np.random.Generator) -> float:
    """In the declared order the printed matrix ties a joint's x to its own y."""
    L = eq.kinematic_laplacian(STICK, STICK_JOINTS)
    printed = eq.kinematic_metric(2, L, 10.0, 1.0, "printed")
    strangers = metric_by_bones(2, STICK_JOINTS, STICK, 10.0, 1.0) == 0
    return float(np.abs(printed[strangers]).max())


@contradicts(51, "words: pelvis less than wrist; it gets more, by the share")
def pelvis_before_wrist(random: np.random.Generator) -> float:
    """Every column of the inverse has the same sum, so the one spread widest is the shortest."""
    R_J = eq.joint_metric(eq.kinematic_laplacian(EDGES, N_JOINTS), 10.0, 1.0)
    q = dict(zip(JOINTS, eq.influence_weights(R_J), strict=True))
    return q["pelvis"] / q["left_wrist"] - 1


@contradicts(51, "released squared norm: the pelvis gets more, by the share")
def pelvis_before_wrist_squared(random: np.random.Generator) -> float:
    """Squaring keeps the order and widens the distance."""
    R_J = eq.joint_metric(eq.kinematic_laplacian(EDGES, N_JOINTS), 10.0, 1.0)
    q = dict(zip(JOINTS, eq.influence_weights(R_J, form="released"), strict=True))
    return q["pelvis"] / q["left_wrist"] - 1


@contradicts(52, "released clips first: two joints sharing 3 get too little by")
def clipped_too_early(random: np.random.Generator) -> float:
    """Printed, each gets 1.5 and is clipped to 1; released, both share 1."""
    arguments = ([3.0], [1.0, 1.0], [[True, True]], 0.02, 1.0)
    return gap(eq.joint_trust(*arguments, form="released"), [[1.0, 1.0]])
