"""Where GMD as printed, or its public code, does not give what it says: how far it is off."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from projflow_lite import equations as eq

from . import registry
from .gmd import EMPHASISED, C

contradicts = partial(registry.contradicts, paper="GMD")
FEATURES = 263
"""Of HumanML3D, the paper's data."""
ONE_KEYFRAME = np.array([[1.0], [1.0]])
NO_VALUE = (
    "z has 5 features, expected 2",
    "has no value",
    "acts on 5 rows",
)


def without_value(message: str) -> float:
    """Infinite if that is why a printed form stopped; any other reason is no finding."""
    if any(reason in message for reason in NO_VALUE):
        return math.inf
    raise ValueError(message)


@contradicts("4 (a)", "two goals with the same zeros: variances of what they leave", more_than=0.5)
def same_zeros_other_law(random: np.random.Generator) -> float:
    """Given x2 = 0, x1 has variance 1; given x2 / x1 = 0, which is the same line, it has 2."""
    samples = random.normal(size=(40_000, 2, 1))
    height = eq.goal_conditioned(samples, lambda x: abs(x[1, 0]), 0.05)[:, 0, 0]
    steepness = eq.goal_conditioned(samples, lambda x: abs(x[1, 0] / x[0, 0]), 0.05)[:, 0, 0]
    return float(steepness.var() - height.var())


@contradicts("4.1 (a)", "printed factor without its root: standard deviation short of 1")
def too_small_by_the_root(random: np.random.Generator) -> float:
    """White data, N = 263 and c = 10: 0.042 where 1 was promised."""
    total = (FEATURES - 3) + 3 * C**2
    return float(1 - eq.emphasis_scale(FEATURES, EMPHASISED, C, form="printed") * total**0.5)


@contradicts("4.1 (a)", "unit variance: spread of the coordinates' own variances", more_than=0.1)
def unit_variance_on_average_only(random: np.random.Generator) -> float:
    """Variance of coordinate i of white data: the squared length of row i of k A."""
    A = eq.emphasis_matrix(random.normal(size=(FEATURES, FEATURES)), EMPHASISED, C)
    rows = eq.emphasise(np.eye(FEATURES), A, eq.emphasis_scale(FEATURES, EMPHASISED, C))
    return float((rows**2).sum(axis=1).std())


@contradicts("4.1 (b)", "alpha_t taken for a single step's, after two steps of 1/4")
def one_step_for_all(random: np.random.Generator) -> float:
    """The signal is down to 1/4; the formula, read so, leaves it at 1/2."""
    one, zero = np.ones(1), np.zeros(1)
    two_steps = np.sqrt(0.25) * np.sqrt(0.25)
    return float(eq.diffuse(one, zero, 0.25)[0] - two_steps)


@contradicts("4.1 (d)", "printed without its factor: what a motion of 1 loses")
def undone_without_its_factor(random: np.random.Generator) -> float:
    """N = 3 and c = 10: the factor is one over the root of 300."""
    A, k = eq.emphasis_matrix(np.eye(3), EMPHASISED, C), eq.emphasis_scale(3, EMPHASISED, C)
    x = np.ones((3, 1))
    return float((x - eq.unemphasise(eq.emphasise(x, A, k), A, k, form="printed"))[0, 0])


@contradicts("4.1 (e)", "printed without its factor: where a trajectory at 1 arrives, too far by")
def imputed_without_its_factor(random: np.random.Generator) -> float:
    """N = 263 and c = 10: at the root of 560. With A' = I the arithmetic is plain to see."""
    A = eq.emphasis_matrix(np.eye(FEATURES), EMPHASISED, C)
    k = eq.emphasis_scale(FEATURES, EMPHASISED, C)
    mask = eq.imputation_region(ONE_KEYFRAME, (1, 2), FEATURES)
    nothing = np.zeros((FEATURES, 1))
    printed = eq.impute_emphasised(nothing, ONE_KEYFRAME, mask, (1, 2), A, k, form="printed")
    return float(eq.unemphasise(printed, A, k)[1, 0] - 1)


@contradicts("4.2 (a)", "printed projection, which fills in where it should take out")
def filled_in_where_taken_out(random: np.random.Generator) -> float:
    """It expects the two rows of a trajectory and is given a motion."""
    try:
        eq.goal_step(np.zeros((5, 1)), np.asarray, (1, 2), form="printed")
    except ValueError as error:
        return without_value(str(error))
    return 0.0


@contradicts("4.2 (a)", "no step size: 0.01 from a keyframe, where one step of eq. 12 ends")
def a_step_of_one(random: np.random.Generator) -> float:
    """At p = 1 the slope is 1 at any distance."""
    y = 0.01 * ONE_KEYFRAME
    gradient = partial(eq.keyframe_gradient, y=y, mask=ONE_KEYFRAME)
    return float(eq.goal_step(np.zeros((5, 1)), gradient, (1, 2))[1, 0] - 0.01)


@contradicts("4.2 (b)", "printed projection, which fills in where it should take out")
def filled_in_behind_the_denoiser(random: np.random.Generator) -> float:
    """The denoiser returns a motion, so its shape fits no better."""
    try:
        eq.state_gradient(np.zeros((5, 1)), np.eye(5), np.asarray, (1, 2), form="printed")
    except ValueError as error:
        return without_value(str(error))
    return 0.0


@contradicts("4.2 (c)", "printed without its factor: share of the step that is lost")
def pushed_without_the_factor(random: np.random.Generator) -> float:
    """N = 3 and c = 10: all but one over the root of 300."""
    A, k = eq.emphasis_matrix(np.eye(3), EMPHASISED, C), eq.emphasis_scale(3, EMPHASISED, C)
    steps = [
        eq.unprojected_step(np.ones((3, 1)), A, k, 1.0, 1.0, form)[0, 0]
        for form in ("printed", "derived")
    ]
    return float(1 - steps[0] / steps[1])


@contradicts("4.2 (d)", "printed without a bracket: how far an imputed feature moves")
def imputed_and_yet_moved(random: np.random.Generator) -> float:
    """A = [[1, 1], [0, 1]], a step of (2, 1), the first feature imputed: it moves by 1."""
    A, mask, mean = np.array([[1.0, 1.0], [0.0, 1.0]]), np.array([[1], [0]]), np.zeros((2, 1))
    step = np.array([[2.0], [1.0]])
    moved = eq.guided_mean_emphasised(mean, step, mask, A, 1.0, form="printed")
    return float(eq.unemphasise(moved, A, 1.0)[0, 0])


@contradicts("12", "printed as a product of matrices that cannot be multiplied")
def mask_times_difference(random: np.random.Generator) -> float:
    """Both have two rows, and as many columns as there are steps."""
    x, y = np.zeros((5, 4)), np.ones((2, 4))
    try:
        eq.keyframe_goal_of_motion(x, y, np.ones((2, 4)), (1, 2), form="printed")
    except ValueError as error:
        return without_value(str(error))
    return 0.0


@contradicts("12", "released mean against the printed sum: two coordinates, each 1 away")
def mean_against_sum(random: np.random.Generator) -> float:
    """2 against 1; with more keyframes the guidance of each becomes weaker."""
    x = np.zeros((5, 1))
    found = [
        eq.keyframe_goal_of_motion(x, ONE_KEYFRAME, ONE_KEYFRAME, (1, 2), form=form)
        for form in ("derived", "released")
    ]
    return found[0] - found[1]


@contradicts("5.2 (a)", "printed as a product of matrices: two steps, where it can be multiplied")
def mask_times_difference_of_two_steps(random: np.random.Generator) -> float:
    """One coordinate is observed and 1 away; the product adds its whole row up to 3."""
    z, y, mask = np.array([[1.0, 2.0], [3.0, 5.0]]), np.zeros((2, 2)), np.array([[1, 0], [0, 0]])
    return eq.keyframe_goal(z, y, mask, form="printed") - eq.keyframe_goal(z, y, mask)


@contradicts("5.2 (b)", "printed projection, which takes out where it should fill in")
def taken_out_where_filled_in(random: np.random.Generator) -> float:
    """It expects a motion and is given the mask of a trajectory."""
    try:
        eq.imputation_region(np.ones((2, 4)), (1, 2), 5, form="printed")
    except ValueError as error:
        return without_value(str(error))
    return 0.0


@contradicts("5.2 (c)", "released line from the origin: steps imputed that no keyframe asked for")
def steps_before_the_first_keyframe(random: np.random.Generator) -> float:
    """A single keyframe at step 4 needs no line; the public code imputes steps 0 to 3 too."""
    known = [
        eq.point_to_point([4], [[1.0, 1.0]], 6, form=form)[1][0].sum()
        for form in ("released", "derived")
    ]
    return float(known[0]) - float(known[1])
