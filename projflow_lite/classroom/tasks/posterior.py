"""The probabilistic reading: ProjFlow eq. 18, 31 and 46."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.random import Generator

from ..exercise import Case, Exercise, case
from .draws import covariance, metric


def _gaussians(rng: Generator) -> list[Case]:
    def drawn(m: int, d: int) -> list[Any]:
        A = rng.normal(size=(m, d))
        return [rng.normal(size=d), A, rng.normal(size=m), metric(rng, d), covariance(rng, m)]

    euclid, met, all_seen, twice, still = (
        drawn(2, 4), drawn(2, 5), drawn(3, 3), drawn(3, 5), drawn(2, 4)
    )  # fmt: skip
    euclid[3], euclid[4] = np.eye(4), np.eye(2)
    met[2] = met[1] @ met[0]
    all_seen[1] = np.eye(3)
    twice[1][2] = twice[1][0]
    still[0] = np.zeros(4)
    return [
        case("two rows, five coordinates, correlated noise", *drawn(2, 5)),
        case("one row, three coordinates", *drawn(1, 3)),
        case("as many rows as coordinates", *drawn(4, 4)),
        case("more rows than coordinates", *drawn(5, 3)),
        case("R and Sigma are identities", *euclid),
        case("the prediction meets the wish already", *met),
        case("every coordinate observed", *all_seen),
        case("a row that is there twice", *twice),
        case("the prediction is zero", *still),
        case("no observation (m = 0)", *drawn(0, 3)),
        case("one coordinate, one row", *drawn(1, 1)),
    ]


def _trusts(rng: Generator) -> list[Case]:
    def drawn(*shape: int) -> tuple[np.ndarray, np.ndarray]:
        return rng.uniform(0.05, 0.95, shape), rng.uniform(0.1, 0.4, shape)

    return [
        case("a few coordinates", *drawn(6)),
        case("a motion, every axis with numbers of its own", *drawn(4, 2, 3)),
        case("a single coordinate", *drawn(1)),
        case("full trust", np.ones(3), drawn(3)[1]),
        case("the least trust of Table 5", np.full(3, 0.02), drawn(3)[1]),
        case("half trust", np.full(3, 0.5), drawn(3)[1]),
        case("the Euclidean metric (r = 1)", drawn(4)[0], np.ones(4)),
        case("r above 1", drawn(4)[0], rng.uniform(2, 9, 4)),
        case("full trust in some coordinates only", np.array([1.0, 0.3, 1.0]), drawn(3)[1]),
    ]


def _variances(rng: Generator) -> list[Case]:
    def drawn(*shape: int) -> tuple[np.ndarray, np.ndarray]:
        return rng.uniform(0.02, 1.5, shape), rng.uniform(0.1, 0.4, shape)

    r = drawn(4)[1]
    return [
        case("a few coordinates", *drawn(6)),
        case("a motion, every axis with numbers of its own", *drawn(4, 2, 3)),
        case("a single coordinate", *drawn(1)),
        case("no variance, a hard row", np.zeros(3), drawn(3)[1]),
        case("a huge variance", np.full(3, 1e3), drawn(3)[1]),
        case("the variance equals r", r, r.copy()),
        case("the Euclidean metric (r = 1)", drawn(4)[0], np.ones(4)),
        case("r above 1", drawn(4)[0], rng.uniform(2, 9, 4)),
        case("some rows are hard", np.array([0.0, 0.3, 0.0]), drawn(3)[1]),
    ]


EXERCISES = (
    Exercise(
        "projflow:18",
        "variance_from_trust",
        "Return the variance that makes a coordinate follow its guide with trust pi, where r is "
        "the coordinate's prior variance. Both arrays have the same shape; pi is above 0 and at "
        "most 1.",
        (
            "Full trust is a hard row. Which variance does a hard row have?",
            "Distrust compared with trust, in units of the prior variance.",
            "Divide what is missing from full trust by the trust; then multiply by r. Half trust "
            "must give back r itself.",
        ),
        _trusts,
        ("variance",),
    ),
    Exercise(
        "projflow:31",
        "map_normal_equations",
        "Return the matrix H (d x d) and the vector b (d) of the linear system H x1 = b that the "
        "most probable motion solves. Shapes as in eq. 7; Sigma has an inverse here.",
        (
            "Two sources of knowledge, the prediction and the measurement. Each gives one term to "
            "H and one to b.",
            "Each source counts by its precision, the inverse of its covariance. For the "
            "prediction the precision is R itself.",
            "The measurement's precision has size m x m; its rows carry it to d x d, the "
            "transpose on the left. In b the prediction is weighted by its precision, and y is "
            "weighted and carried back in the same manner. Return the pair, unsolved.",
        ),
        _gaussians,
        ("matrix H", "vector b"),
    ),
    Exercise(
        "projflow:46",
        "trust_from_variance",
        "Return the share of its misfit that a single observed coordinate corrects, from the "
        "variance of its measurement and its prior variance r. Both arrays have the same shape.",
        (
            "A measurement without variance is followed in full, a very uncertain one hardly.",
            "It is the prior's variance as a share of something.",
            "Of the total variance, the prior's and the measurement's together, which share is "
            "the prior's? Equal variances must give one half.",
        ),
        _variances,
        ("trust",),
    ),
)
