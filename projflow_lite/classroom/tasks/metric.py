"""The skeleton's metric: ProjFlow eq. 11, 50 and 51."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from ..exercise import Case, Exercise, case
from .draws import joint_metric, laplacian, metric

CHAIN = np.array([[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
LONELY = np.array([[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 0.0]])


def _motions(rng: Generator) -> list[Case]:
    weight, ridge = (float(v) for v in rng.uniform((2, 0.2), (9, 0.8)))
    return [
        case("two frames, four joints", 2, laplacian(rng, 4), weight, ridge),
        case("four frames, two joints", 4, laplacian(rng, 2), weight, ridge),
        case("three frames, three joints", 3, laplacian(rng, 3), weight, ridge),
        case("one frame", 1, laplacian(rng, 4), weight, ridge),
        case("one joint, no bone", 3, np.zeros((1, 1)), weight, ridge),
        case("one frame, one joint", 1, np.zeros((1, 1)), weight, ridge),
        case("bones do not count (w_kin = 0)", 2, CHAIN, 0.0, ridge),
        case("the constants of Table 5", 2, laplacian(rng, 5), 10.0, 1.0),
        case("a joint without a bone", 2, LONELY, weight, ridge),
    ]


def _frames(rng: Generator) -> list[Case]:
    weight, ridge = (float(v) for v in rng.uniform((2, 0.2), (9, 0.8)))
    whole = CHAIN.astype(np.int64)
    return [
        case("five joints", laplacian(rng, 5), weight, ridge),
        case("a chain of three joints", CHAIN, weight, ridge),
        case("two joints, one bone", np.array([[1.0, -1.0], [-1.0, 1.0]]), weight, ridge),
        case("one joint, no bone", np.zeros((1, 1)), weight, ridge),
        case("bones do not count (w_kin = 0)", CHAIN, 0.0, ridge),
        case("the constants of Table 5", laplacian(rng, 6), 10.0, 1.0),
        case("a joint without a bone", LONELY, weight, ridge),
        case("a large ridge", laplacian(rng, 4), 0.5, 20.0),
        case("a Laplacian stored as integers", whole, weight, ridge),
    ]


def _metrics(rng: Generator) -> list[Case]:
    return [
        case("a skeleton of five joints", joint_metric(rng, 5)),
        case("a skeleton of two joints", joint_metric(rng, 2)),
        case("one joint", np.array([[rng.uniform(2, 5)]])),
        case("the Euclidean metric", np.eye(4)),
        case("a diagonal metric", np.diag(rng.uniform(1, 9, 4))),
        case("any metric", metric(rng, 4)),
        case("the constants of Table 5", 10 * CHAIN + np.eye(3)),
        case("weak bones", 0.05 * laplacian(rng, 4) + 2 * np.eye(4)),
        case("a joint without a bone", 10 * LONELY + np.eye(3)),
    ]


EXERCISES = (
    Exercise(
        "projflow:11",
        "kinematic_metric",
        "Return the metric R (d x d, d = 3 N J) of a motion of N frames, from the Laplacian L "
        "(J x J), the weight w_kin and the ridge. The vector is sorted frame by frame, in it joint "
        "by joint, in it axis by axis.",
        (
            "Which two entries of the vector belong to joints that share a bone? They are in the "
            "same frame and on the same axis.",
            "In a Kronecker product the left factor changes slowest and the right one fastest. "
            "What changes slowest in this vector?",
            "Three factors, from slow to fast: an identity for the frames, the Laplacian for the "
            "joints, an identity for the axes. The print has another order. The ridge goes onto "
            "the diagonal only.",
        ),
        _motions,
        ("metric",),
    ),
    Exercise(
        "projflow:50",
        "joint_metric",
        "Return the metric R_J (J x J) of one frame and one axis, from the Laplacian L (J x J), "
        "the weight w_kin and the ridge.",
        (
            "One term for the bones and one for each joint by itself.",
            "A number added to an array lands in every entry. Where does the ridge belong?",
            "The bones' term is the Laplacian in its weight. The other is an identity matrix as "
            "large as the Laplacian, in the weight of the ridge.",
        ),
        _frames,
        ("metric",),
    ),
    Exercise(
        "projflow:51",
        "influence_weights",
        "Return one weight per joint (J) from the metric R_J (J x J) of eq. 50: the smaller, the "
        "more the other joints follow when this one is moved. The weights are not normalised.",
        (
            "Moving joint j drags the others along; how far is written in one column of a matrix. "
            "Of which?",
            "Measure each column by its Euclidean length. As the equation prints it, no length is "
            "squared.",
            "Invert the metric, take the length of each column, and give long columns small "
            "weights by the reciprocal.",
        ),
        _metrics,
        ("weights",),
    ),
)
