"""The projection in closed form and DDNM: ProjFlow eq. 7, 8 and 21."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.random import Generator

from ..exercise import Case, Exercise, case
from .draws import covariance, metric


def _measurements(rng: Generator) -> list[Case]:
    """Draw measurements whose matrix has an inverse: what eq. 7 prints has a value there."""

    def drawn(m: int, d: int) -> list[Any]:
        A = rng.normal(size=(m, d))
        return [rng.normal(size=d), A, rng.normal(size=m), metric(rng, d), covariance(rng, m)]

    hard, nothing, everything, twice, short, met, euclid, one, square, hard_square = (
        drawn(2, 5), drawn(0, 4), drawn(4, 4), drawn(3, 5), drawn(2, 5),
        drawn(2, 5), drawn(3, 6), drawn(1, 1), drawn(4, 4), drawn(1, 4),
    )  # fmt: skip
    hard[4] = np.zeros((2, 2))
    hard_square[1], hard_square[4] = np.array([[0.0, 1.0, 0.0, 0.0]]), np.zeros((1, 1))
    everything[1], everything[4] = np.eye(4), np.zeros((4, 4))
    twice[1][2] = twice[1][0]
    short[1], short[2] = 1e-3 * short[1], 1e-3 * short[2]
    short[4] = np.zeros((2, 2))
    met[2] = met[1] @ met[0]
    euclid[3], euclid[4] = np.eye(6), np.zeros((3, 3))
    uneven = drawn(3, 5)
    uneven[3], uneven[4] = np.diag(rng.uniform(1, 9, 5)), np.diag([0.0, 0.5, 4.0])
    return [
        case("two rows, five coordinates, correlated noise", *drawn(2, 5)),
        case("one row, three coordinates", *drawn(1, 3)),
        case("as many rows as coordinates", *square),
        case("more rows than coordinates, with noise", *drawn(5, 3)),
        case("exact rows (Sigma = 0)", *hard),
        case("one exact coordinate", *hard_square),
        case("every coordinate observed exactly", *everything),
        case("no observation (m = 0)", *nothing),
        case("a row that is there twice, with noise", *twice),
        case("exact rows with small entries", *short),
        case("the prediction meets the wish already", *met),
        case("R is the identity and Sigma is zero", *euclid),
        case("diagonal R and Sigma, the first row exact", *uneven),
        case("one coordinate, one row", *one),
    ]


def _noiseless(rng: Generator) -> list[Case]:
    def drawn(m: int, d: int) -> list[Any]:
        return [rng.normal(size=d), rng.normal(size=(m, d)), rng.normal(size=m)]

    x, y = rng.normal(size=4), rng.normal(size=4)
    mask, pick = np.diag([1.0, 0.0, 1.0, 0.0]), np.array([[0.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    rotation, _ = np.linalg.qr(rng.normal(size=(4, 4)))
    met = drawn(2, 5)
    met[2] = met[1] @ met[0]
    return [
        case("two rows, five coordinates", *drawn(2, 5)),
        case("one row, three coordinates", *drawn(1, 3)),
        case("as many rows as coordinates", *drawn(3, 3)),
        case("more rows than coordinates", *drawn(5, 3)),
        case("a square mask with gaps", x, mask, mask @ y),
        case("a coordinate measured twice, the same", x[:3], pick, np.array([0.7, 0.7])),
        case("a coordinate measured twice, differently", x[:3], pick, np.array([0.2, 0.8])),
        case("no observation (m = 0)", x, np.zeros((0, 4)), np.zeros(0)),
        case("every coordinate observed", x, np.eye(4), y),
        case("a rotation", x, rotation, y),
        case("rows of zeros", x, np.zeros((2, 4)), np.zeros(2)),
        case("the prediction meets the wish already", *met),
    ]


EXERCISES = (
    Exercise(
        "projflow:7",
        "project",
        "Return the corrected endpoint: the prediction x1_hat (d) plus the smallest correction, "
        "in the metric R (d x d), that meets the measurements y (m) of the rows A (m x d) with "
        "covariance Sigma (m x m).",
        (
            "Begin with the misfit: what does the prediction still lack of y? Then follow the "
            "shapes from m numbers to d numbers.",
            "R is what a movement costs; its inverse is how far a coordinate likes to move. The "
            "correction spreads along the inverse, and Sigma joins in where the rows meet.",
            "Weigh the misfit first, by the inverse of an m x m matrix: how the rows see the "
            "inverse metric, plus their own covariance. Then carry it back through the transposed "
            "rows and once more through the inverse metric, and add it to the prediction.",
        ),
        _measurements,
        ("endpoint",),
        ("7", "8"),
    ),
    Exercise(
        "projflow:21",
        "ddnm",
        "Return the vector that takes from y (m) whatever the rows A (m x d) determine and all "
        "the rest from x1_hat (d). The rows may repeat or contradict each other.",
        (
            "The rows see some directions and are blind to others. Treat the two separately.",
            "The pseudo-inverse takes y back to the directions that the rows see.",
            "The matrix that keeps only what the rows cannot see is the identity minus the "
            "pseudo-inverse times A; let it act on the prediction, and add what y determines.",
        ),
        _noiseless,
        ("endpoint",),
    ),
)
