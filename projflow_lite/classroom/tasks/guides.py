"""Guides between keyframes, and how far to trust them: ProjFlow eq. 14–17 and 52."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from ..exercise import Case, Exercise, case
from .draws import joint_metric, metric


def _radii(rng: Generator) -> list[Case]:
    t = float(rng.uniform(0.1, 0.9))
    return [
        case("the constants of Table 5 at a random time", t, 3.0, 10.0),
        case("the start (t = 0)", 0.0, 3.0, 10.0),
        case("the end (t = 1)", 1.0, 3.0, 10.0),
        case("a quarter of the way", 0.25, 1.5, 9.0),
        case("guides that vanish (l_min = 0)", t, 0.0, 7.0),
        case("a radius that stays", t, 4.0, 4.0),
        case("whole numbers", t, 2, 9),
        case("many times at once", np.linspace(0, 1, 7), 3.0, 10.0),
        case("times in a table", rng.uniform(size=(2, 3)), 1.0, 5.0),
    ]


def _decays(rng: Generator) -> list[Case]:
    t = float(rng.uniform(0.1, 0.9))
    return [
        case("the constant of Table 5 at a random time", t, 0.1),
        case("the start (t = 0)", 0.0, 0.1),
        case("the end (t = 1)", 1.0, 0.1),
        case("half of the way", 0.5, 0.3),
        case("nothing is left (tau_min = 0)", t, 0.0),
        case("nothing fades (tau_min = 1)", t, 1.0),
        case("much is left", t, 0.8),
        case("many times at once", np.linspace(0, 1, 7), 0.1),
        case("times in a table", rng.uniform(size=(2, 3)), 0.25),
    ]


def _bends(rng: Generator) -> list[Case]:
    def drawn(N: int, J: int) -> tuple[np.ndarray, np.ndarray]:
        return rng.normal(size=(N, J, 3)), joint_metric(rng, J)

    steady = np.arange(6.0)[:, None, None] * np.array([[1.0, 0.5, -2.0], [0.25, 4.0, 1.0]])
    upwards = np.zeros((5, 2, 3))
    upwards[:, :, 1] = rng.normal(size=(5, 2))
    # whole numbers, so that steady motion and the halves of the corner do not bend at all
    corner = np.abs(np.arange(7.0) - 3)[:, None, None] * np.ones((1, 3, 3))
    return [
        case("eight frames, four joints", *drawn(8, 4)),
        case("as many frames as joints", *drawn(4, 4)),
        case("three frames", *drawn(3, 2)),
        case("one joint", *drawn(6, 1)),
        case("a metric of any kind", drawn(6, 3)[0], metric(rng, 3)),
        case("the Euclidean metric", drawn(6, 3)[0], np.eye(3)),
        case("a steady motion, which does not bend", steady, joint_metric(rng, 2)),
        case("a motion that stands still", np.ones((5, 3, 3)), joint_metric(rng, 3)),
        case("a motion upwards only", upwards, joint_metric(rng, 2)),
        case("a straight motion with one corner", corner, joint_metric(rng, 3)),
    ]


def _curvatures(rng: Generator) -> list[Case]:
    def drawn(N: int) -> np.ndarray:
        return rng.uniform(0.1, 3, N)

    table_5 = (3.0, 1.0, 2.0, 0.1)
    t = float(rng.uniform(0.1, 0.9))
    outlier, still_ends = drawn(9), drawn(7)
    outlier[4] = 400.0
    still_ends[[0, 6]] = 0
    return [
        case("an odd number of frames", drawn(7), t, *table_5),
        case("an even number of frames", drawn(8), t, *table_5),
        case("two frames", drawn(2), t, *table_5),
        case("one frame", drawn(1), t, *table_5),
        case("the start (t = 0)", drawn(5), 0.0, *table_5),
        case("the end (t = 1)", drawn(5), 1.0, *table_5),
        case("other constants", drawn(7), t, 0.7, 2.5, 1.5, 0.3),
        case("curvature does not count (lambda_s = 0)", drawn(6), t, 0.8, 0.0, 2.0, 0.1),
        case("the first power", drawn(7), t, 2.0, 0.5, 1.0, 0.2),
        case("every frame bends alike", np.full(5, 2.0), t, *table_5),
        case("one frame bends far more than the others", outlier, t, *table_5),
        case("the first and last frame do not bend", still_ends, t, *table_5),
    ]


def _shares(rng: Generator) -> list[Case]:
    def drawn(N: int, J: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        active = rng.random((N, J)) < 0.6
        active[:, 0] = True
        return rng.uniform(0.2, 3, N), rng.uniform(1, 5, J), active

    loose, table_5 = (1e-6, 1.0), (0.02, 1.0)
    budget, q, active = drawn(5, 4)
    active[[1, 3]] = False
    alone = np.eye(3, dtype=bool)
    return [
        case("six frames, four joints", *drawn(6, 4), *table_5),
        case("as many frames as joints", *drawn(4, 4), *table_5),
        case("every joint active", *drawn(5, 3)[:2], np.ones((5, 3), dtype=bool), *table_5),
        case("one joint active in each frame", *drawn(3, 3)[:2], alone, *table_5),
        case("no joint active", *drawn(3, 4)[:2], np.zeros((3, 4), dtype=bool), *table_5),
        case("some frames without an active joint", budget, q, active, *table_5),
        case("one frame, one joint", *drawn(1, 1), *table_5),
        case("equal weights", drawn(4, 3)[0], np.ones(3), drawn(4, 3)[2], *table_5),
        case("a small budget, far from the bounds", 0.2 * drawn(5, 4)[0], *drawn(5, 4)[1:], *loose),
        case("a budget above 1", 3 + drawn(5, 4)[0], *drawn(5, 4)[1:], *table_5),
        case("narrow bounds", *drawn(6, 4), 0.3, 0.5),
        case("flags stored as 0 and 1", *drawn(5, 4)[:2], drawn(5, 4)[2].astype(float), *table_5),
    ]


EXERCISES = (
    Exercise(
        "projflow:14",
        "halo_radius",
        "Return the reach of the guides at time t, in frames: l_max at t = 0, l_min at t = 1, a "
        "straight line in between. t is one number or an array of any shape.",
        (
            "Guides reach far at the start, t = 0, and less and less far later.",
            "It has the form of eq. 2: two ends and two weights that add up to 1.",
            "The weight of the smaller radius is the time; the larger radius has what is left "
            "of 1. Nothing is rounded.",
        ),
        _radii,
        ("radius",),
    ),
    Exercise(
        "projflow:15",
        "frame_trust",
        "Return the trust in the guides of each frame (N) from the curvatures s (N), not clipped. "
        "tau(t) is that of eq. 16; s_med is the median of s and is above 0 here.",
        (
            "Ask of each frame how much more it bends than a typical one.",
            "Three steps: divide by the median, turn that into a penalty with the power and "
            "lambda_s, and let the time's decay and c0 multiply the rest.",
            "The power acts on the ratio alone, lambda_s outside of it. The penalty is added to 1 "
            "below the line. For an even number of frames the median is halfway between the two "
            "middle values. Do not clip.",
        ),
        _curvatures,
        ("trust",),
    ),
    Exercise(
        "projflow:16",
        "time_decay",
        "Return the factor tau by which guides are trusted at time t: 1 at t = 0, tau_min at "
        "t = 1, a straight line in between. t is one number or an array of any shape.",
        (
            "What must come out at both ends?",
            "A part stays whatever the time, and only the rest fades.",
            "The part that stays is tau_min. The rest is what it lacks of 1, and shrinks in "
            "proportion to the time left.",
        ),
        _decays,
        ("factor",),
    ),
    Exercise(
        "projflow:17",
        "curvature",
        "Return how sharply a motion x1_hat (N, J, 3) of three or more frames bends at each frame "
        "(N), in the metric R_J (J x J) that every axis uses. The first and the last frame copy "
        "the value beside them.",
        (
            "The second difference compares a frame with both neighbours; steady motion has none.",
            "The norm in a metric is a root: of the sum, over the three axes, of a quadratic form "
            "between joints.",
            "For N frames there are N - 2 second differences. For each take, axis by axis, the "
            "vector of all joints on both sides of R_J, add the three numbers and take one root. "
            "Then repeat the first and the last result.",
        ),
        _bends,
        ("curvature",),
    ),
    Exercise(
        "projflow:52",
        "joint_trust",
        "Return the trust in each joint's guide (N, J): the frame's trust pi_frame (N), shared by "
        "the weights q (J) among the joints active (N, J) in that frame, then clipped to pi_min "
        "and pi_max. A joint that is not active has trust 0.",
        (
            "The joints that are active in a frame share its budget. Who is in the sum below the "
            "line?",
            "The sum over active joints is one number per frame. Clip after sharing, not before.",
            "Weight by weight over the frame's own sum, times the frame's budget, clipped; at "
            "last put 0 wherever a joint is not active, also in frames where the sum is empty.",
        ),
        _shares,
        ("trust",),
    ),
)
