"""GMD's formulas derived again. They have few numbers, so a section and a letter name them."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from projflow_lite import equations as eq

from . import registry
from .problems import exact, gap, lagrange, largest, numbers

derives = partial(registry.derives, paper="GMD")
N, STEPS, ROWS, EMPHASISED, C = 5, 4, (2, 1), (0, 1, 2), 10.0


def picking(rows: tuple[int, ...] = ROWS, features: int = N) -> NDArray:
    """Matrix of the projection that takes a trajectory out."""
    return np.array([[float(j == row) for j in range(features)] for row in rows])


def projection(random: np.random.Generator) -> tuple[NDArray, float]:
    """A and k of a small projection, far from singular."""
    Q, _ = np.linalg.qr(random.normal(size=(N, N)))
    A_prime = Q * random.uniform(0.5, 2, N)
    return eq.emphasis_matrix(A_prime, EMPHASISED, C), eq.emphasis_scale(N, EMPHASISED, C)


def region(random: np.random.Generator) -> NDArray:
    """A mask inside the rows of the trajectory, with something in it."""
    mask = np.zeros((N, STEPS), dtype=bool)
    mask[list(ROWS)] = random.integers(0, 2, (2, STEPS))
    mask[ROWS[0], 0] = True
    return mask


def slope(function: Callable[[NDArray], float], x: NDArray, h: float = 1e-5) -> NDArray:
    """Gradient by central differences."""
    gradient = np.zeros_like(x)
    for place in np.ndindex(x.shape):
        nudge = np.zeros_like(x)
        nudge[place] = h
        gradient[place] = (function(x + nudge) - function(x - nudge)) / (2 * h)
    return gradient


@derives("4 (a)", "drawn: given one feature, the law of another, in standard errors", 5)
def what_is_kept_has_the_conditional_law(random: np.random.Generator) -> float:
    """Correlation r: given that x2 is a, x1 has mean r a and variance 1 - r^2."""
    r, a = 0.8, 0.5
    x = random.multivariate_normal([0, 0], [[1, r], [r, 1]], size=20_000)[:, :, None]
    kept = eq.goal_conditioned(x, lambda motion: abs(motion[1, 0] - a), 0.05)[:, 0, 0]
    n, variance = len(kept), 1 - r**2
    mean_error = (kept.mean() - r * a) / np.sqrt(variance / n)
    variance_error = (kept.var() - variance) / (variance * np.sqrt(2 / n))
    return largest([abs(mean_error), abs(variance_error)])


@derives("4 (b)", "a goal that adds up what it sees, coordinate by coordinate", 1e-13)
def seen_by_the_goal(random: np.random.Generator) -> float:
    """Cubes tell apart rows, signs and sizes."""
    x = random.normal(size=(N, STEPS))
    by_hand = sum((k + 1) * x[row, i] ** 3 for k, row in enumerate(ROWS) for i in range(STEPS))
    goal = eq.motion_goal(x, lambda z: float((np.array([[1], [2]]) * z**3).sum()), ROWS)
    return abs(goal - by_hand)


@derives("4 (c)", "as a matrix of zeros and ones", 0)
def taken_by_a_matrix(random: np.random.Generator) -> float:
    """Each row of the matrix has a single 1, so nothing is rounded."""
    x = random.normal(size=(N, STEPS))
    return gap(eq.take_trajectory(x, ROWS), picking() @ x)


@derives("4 (d)", "as the transpose of that matrix; taken out again", 0)
def filled_by_the_transpose(random: np.random.Generator) -> float:
    """What was put in comes out, and nothing else was put in."""
    z = random.normal(size=(2, STEPS))
    x = eq.fill_trajectory(z, ROWS, N)
    return largest([gap(x, picking().T @ z), gap(picking() @ x, z)])


@derives("4.1 (a)", "entry by entry; variances of the terms added as fractions", 1e-12)
def terms_of_a_projected_coordinate(random: np.random.Generator) -> float:
    """Independent terms: each has variance c^2 or 1, and k^2 times their sum must be 1."""
    A_prime, x = random.normal(size=(N, N)), random.normal(size=(N, 2))
    A, k = eq.emphasis_matrix(A_prime, EMPHASISED, C), eq.emphasis_scale(N, EMPHASISED, C)
    weights = [Fraction(10) if j in EMPHASISED else Fraction(1) for j in range(N)]
    root = float(sum(w * w for w in weights)) ** 0.5
    by_hand = [
        [sum(A_prime[i, j] * float(weights[j]) * x[j, t] for j in range(N)) / root for t in (0, 1)]
        for i in range(N)
    ]
    return gap(eq.emphasise(x, A, k), by_hand)


@derives("4.1 (a)", "drawn: unit variance on average, in standard errors", 5)
def variance_of_drawn_projections(random: np.random.Generator) -> float:
    """A' and x are both drawn; one mean square per projected motion."""
    k, squares = eq.emphasis_scale(N, EMPHASISED, C), []
    for _ in range(2000):
        A = eq.emphasis_matrix(random.normal(size=(N, N)), EMPHASISED, C)
        squares.append((eq.emphasise(random.normal(size=(N, 1)), A, k) ** 2).mean())
    return float(abs(np.mean(squares) - 1) / (np.std(squares) / np.sqrt(len(squares))))


@derives("4.1 (b)", "mean and variance carried through single steps", 1e-14)
def carried_through_single_steps(random: np.random.Generator) -> float:
    """One step multiplies the mean by the root of a, and a variance v becomes a v + 1 - a."""
    alphas, x0 = random.uniform(0.5, 1, 6), random.normal(size=3)
    mean, variance = x0, 0.0
    for a in alphas:
        mean, variance = np.sqrt(a) * mean, a * variance + 1 - a
    level = np.prod(alphas)
    zeros, ones = np.zeros(3), np.ones(3)
    ours = eq.diffuse(x0, zeros, level), eq.diffuse(zeros, ones, level) ** 2
    return largest([gap(ours[0], mean), gap(ours[1], variance * ones)])


@derives("4.1 (c)", "coordinate by coordinate", 0)
def wanted_or_predicted(random: np.random.Generator) -> float:
    """A mask keeps or replaces, it never computes."""
    x0, z, mask = random.normal(size=(N, STEPS)), random.normal(size=(2, STEPS)), region(random)
    by_hand = x0.copy()
    for k, row in enumerate(ROWS):
        for i in range(STEPS):
            by_hand[row, i] = z[k, i] if mask[row, i] else x0[row, i]
    return gap(eq.impute(x0, z, mask, ROWS), by_hand)


@derives("4.1 (d)", "solved in fractions", 1e-11)
def undone_in_fractions(random: np.random.Generator) -> float:
    """The motion whose projection was given, by exact elimination."""
    A, k = projection(random)
    x_proj = random.normal(size=(N, 1))
    solved = numbers(exact(k * A).LUsolve(exact(x_proj)))
    return gap(eq.unemphasise(x_proj, A, k)[:, 0], solved)


@derives("4.1 (e)", "as the smallest change of the motion, by Lagrange's conditions", 1e-11)
def smallest_change_of_the_motion(random: np.random.Generator) -> float:
    """Undone, it is eq. 7 with R = I: emphasis plays no part in which coordinates move."""
    A, k = projection(random)
    x0, z, mask = random.normal(size=(N, STEPS)), random.normal(size=(2, STEPS)), region(random)
    wanted, columns = picking().T @ z, []
    for i in range(STEPS):
        S = np.eye(N)[mask[:, i]]
        y, hard = wanted[mask[:, i], i], np.zeros((len(S), len(S)))
        columns.append(x0[:, i] + lagrange(x0[:, i], S, y, np.eye(N), hard))
    ours = eq.impute_emphasised(k * A @ x0, z, mask, ROWS, A, k)
    return gap(ours, k * A @ np.array(columns).T)


@derives("4.2 (a)", "against central differences of the goal", 1e-8)
def downhill_by_differences(random: np.random.Generator) -> float:
    """A goal with a curved valley, so that the slope is another one at every coordinate."""
    x0 = random.normal(size=(N, STEPS))
    step = slope(lambda x: float(np.cosh((picking() @ x) / 2).sum()), x0)
    return gap(eq.goal_step(x0, lambda z: np.sinh(z / 2) / 2, ROWS), x0 - step)


@derives("4.2 (b)", "as the best compromise of goal and mean, imputed ones held fixed", 1e-11)
def compromise_where_nothing_is_imputed(random: np.random.Generator) -> float:
    """Lowest s g.u + (u - mean)^2 / (2 variance) with hard rows; its free minimum is a step."""
    mean, gradient, mask = *random.normal(size=(2, N, STEPS)), region(random)
    s, variance = 3.0, 0.2
    free_minimum = mean.ravel() - s * variance * gradient.ravel()
    S = np.eye(N * STEPS)[mask.ravel()]
    hard = np.zeros((len(S), len(S)))
    held = free_minimum + lagrange(
        free_minimum, S, S @ mean.ravel(), np.eye(N * STEPS) / variance, hard
    )
    return gap(eq.guided_mean(mean, gradient, mask, s, variance).ravel(), held)


@derives("4.2 (c)", "as a step of the motion that pays for distance in projected space", 1e-7)
def step_paid_for_in_projected_space(random: np.random.Generator) -> float:
    """Lowest ``s g.d + |k A d|^2 / (2 variance)``; the slopes are taken by differences."""
    A, k = projection(random)
    x, s, variance = random.normal(size=(N, 1)), 2.0, 0.3
    undo = np.linalg.inv(k * A)

    def goal(motion: NDArray) -> float:
        return float(np.cosh(motion[list(ROWS)]).sum())

    along_projected = slope(lambda u: goal(undo @ u), k * A @ x)
    price = (k * A).T @ (k * A) / variance
    by_hand = np.linalg.solve(price, -s * slope(goal, x))
    off = gap(eq.unprojected_step(along_projected, A, k, s, variance), by_hand)
    return off / float(np.abs(by_hand).max())


@derives("4.2 (d)", "undone, coordinate by coordinate: held or moved", 1e-11)
def held_or_moved(random: np.random.Generator) -> float:
    """In motion space what is imputed keeps its mean and the rest follows the step."""
    A, k = projection(random)
    mean, delta, mask = *random.normal(size=(2, N, STEPS)), region(random)
    by_hand = mean.copy()
    for place in np.ndindex(N, STEPS):
        by_hand[place] += 0 if mask[place] else delta[place]
    return gap(eq.guided_mean_emphasised(k * A @ mean, delta, mask, A, k), k * A @ by_hand)


@derives("12", "step by step, norms written out for p = 1, 2 and 3", 1e-12)
def norms_written_out(random: np.random.Generator) -> float:
    """A step without keyframes adds nothing."""
    x, y = random.normal(size=(N, STEPS)), random.normal(size=(2, STEPS))
    mask = region(random)[list(ROWS)]
    deviations = []
    for p in (1, 2, 3):
        steps = [
            [abs(x[row, i] - y[k, i]) ** p for k, row in enumerate(ROWS) if mask[k, i]]
            for i in range(STEPS)
        ]
        by_hand = sum(sum(step) ** (1 / p) for step in steps)
        deviations.append(abs(eq.keyframe_goal_of_motion(x, y, mask, ROWS, p) - by_hand))
    return largest(deviations)


@derives("5.2 (a)", "by Euler's theorem, from slopes taken by differences", 1e-6)
def distance_from_its_slopes(random: np.random.Generator) -> float:
    """Twice as far is twice the goal, so the goal is its slope times the way to go."""
    z, y = random.normal(size=(2, STEPS)), random.normal(size=(2, STEPS))
    mask = region(random)[list(ROWS)]
    deviations = []
    for p in (1.0, 2.0):
        gradient = slope(partial(eq.keyframe_goal, y=y, mask=mask, p=p), z)
        deviations.append(abs(eq.keyframe_goal(z, y, mask, p) - (gradient * (z - y)).sum()))
        deviations.append(gap(eq.keyframe_gradient(z, y, mask, p), gradient))
    longest = eq.keyframe_goal(y + [[3.0], [4.0]], y, np.ones((2, STEPS)), 2.0)
    return largest([*deviations, abs(longest - 5 * STEPS)])


@derives("5.2 (b)", "as a matrix that puts rows in their places", 0)
def region_by_a_matrix(random: np.random.Generator) -> float:
    """The mask of the trajectory, moved to the trajectory's rows."""
    mask = random.integers(0, 2, (2, STEPS))
    mask[0, 0] = 1
    return gap(eq.imputation_region(mask, ROWS, N), picking().T @ mask)


@derives("5.2 (c)", "it meets its keyframes and does not bend between them", 1e-13)
def straight_between_keyframes(random: np.random.Generator) -> float:
    """No second difference inside a stretch, and nothing known outside the keyframes."""
    frames, positions = [1, 4, 9], random.normal(size=(3, 2))
    z, known = eq.point_to_point(frames, positions, 12)
    bends = [
        gap(np.diff(z[:, a : b + 1], n=2), np.zeros((2, b - a - 1))) for a, b in pairwise(frames)
    ]
    inside = [[1 <= i <= 9 for i in range(12)]] * 2
    return largest([*bends, gap(z[:, frames].T, positions), gap(known, inside)])
