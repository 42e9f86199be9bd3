"""Flow matching and the recomposition step: ProjFlow eq. 2, 3, 5, 9, 10."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from ..exercise import Case, Exercise, case

MOTION = (4, 5, 3)


def _two_and_share(rng: Generator) -> list[Case]:
    """Draw two motions and a number in [0, 1], the arguments of four exercises."""

    def two(*shape: int) -> tuple[np.ndarray, np.ndarray]:
        return rng.normal(size=shape), rng.normal(size=shape)

    same = rng.normal(size=MOTION)
    whole = np.arange(12).reshape(2, 2, 3), 7 - 2 * np.arange(12).reshape(2, 2, 3)
    return [
        case("a motion at a random time", *two(*MOTION), float(rng.uniform(0.2, 0.45))),
        case("a motion at another time", *two(*MOTION), float(rng.uniform(0.55, 0.9))),
        case("the third argument is 0", *two(*MOTION), 0.0),
        case("the third argument is 1", *two(*MOTION), 1.0),
        case("the third argument is 1/2", *two(*MOTION), 0.5),
        case("a batch of motions", *two(2, *MOTION), float(rng.uniform(0.1, 0.9))),
        case("one frame, one joint", *two(1, 1, 3), float(rng.uniform(0.1, 0.9))),
        case("a motion written as a vector", *two(7), float(rng.uniform(0.1, 0.9))),
        case("the first two arguments are equal", same, same.copy(), 0.25),
        case("the first argument is zero", np.zeros(MOTION), two(*MOTION)[0], 0.3),
        case("the second argument is zero", two(*MOTION)[0], np.zeros(MOTION), 0.3),
        case("whole numbers, stored as integers", *whole, 0.3),
    ]


def _velocities(rng: Generator) -> list[Case]:
    def three(*shape: int) -> list[np.ndarray]:
        return [rng.normal(size=shape) for _ in range(3)]

    _, x0, x1 = three(2, *MOTION)
    far = [100 * a for a in three(2, *MOTION)]
    return [
        case("a batch of five", *three(5, *MOTION)),
        case("a batch of two", *three(2, 2, 3, 3)),
        case("a batch of one", *three(1, *MOTION)),
        case("one frame, one joint", *three(3, 1, 1, 3)),
        case("more frames than samples", *three(2, 9, 1, 3)),
        case("the velocity is right", x1 - x0, x0, x1),
        case("the velocity has the wrong sign", x0 - x1, x0, x1),
        case("the velocity is zero", np.zeros_like(x0), x0, x1),
        case("noise and data are equal", three(2, *MOTION)[0], x0, x0.copy()),
        case("large deviations", *far),
        case("small deviations", x1 - x0 + 0.1 * rng.normal(size=x0.shape), x0, x1),
    ]


EXERCISES = (
    Exercise(
        "projflow:2",
        "interpolate",
        "Return the point at time t on the straight path from noise x0 to data x1. The arrays "
        "have any shape, t is one number from 0 to 1.",
        (
            "What must come out at t = 0, and what at t = 1?",
            "Every point of a straight line is a weighted average of its two ends, and the two "
            "weights add up to 1.",
            "The weight of the data is the time itself; the noise gets what is left of 1.",
        ),
        _two_and_share,
        ("state",),
    ),
    Exercise(
        "projflow:3",
        "flow_matching_loss",
        "Return the flow-matching loss of a batch as one number. All three arrays have the shape "
        "(batch, frames, joints, 3); the expectation is the average over the batch.",
        (
            "Which velocity carries x0 to x1 on a straight line within one unit of time?",
            "The double bars square and sum all coordinates of one sample. Only the expectation "
            "is an average.",
            "Subtract the straight velocity from v, add up the squares of everything, and divide "
            "by the number of samples, not by the number of coordinates.",
        ),
        _velocities,
        ("loss",),
    ),
    Exercise(
        "projflow:5",
        "tweedie_endpoint",
        "Return the clean motion that the state x_t is heading for if its velocity v stays as it "
        "is. The arrays have any shape, t is one number from 0 to 1.",
        (
            "The journey ends at time 1. How much time is left?",
            "Distance is velocity times time; start from where you are.",
            "At t = 1 you have arrived and the velocity no longer counts; at t = 0 it counts in "
            "full. The weight of v is a straight line in between.",
        ),
        _two_and_share,
        ("endpoint",),
    ),
    Exercise(
        "projflow:9",
        "mix_noise",
        "Replace a share eta of the noise x0 by the fresh noise eps so that the variance stays 1. "
        "The arrays have any shape, eta is one number from 0 to 1.",
        (
            "For independent noises it is the variances that add up, not the standard deviations.",
            "If noise is multiplied by a number, by what is its variance multiplied?",
            "The two weights, squared, must be one minus eta for the old noise and eta for the "
            "fresh one.",
        ),
        _two_and_share,
        ("noise",),
    ),
    Exercise(
        "projflow:10",
        "recompose",
        "Put the corrected endpoint x1 and the noise back together to the state at time t_next. "
        "The arrays have any shape, t_next is one number from 0 to 1.",
        (
            "It is the path of eq. 2 once more, with other ends.",
            "At the last step, t_next = 1, no noise may be left.",
            "The time to come is the weight of the endpoint; the weight of the noise is what "
            "that leaves of 1. There are no roots here.",
        ),
        _two_and_share,
        ("state",),
    ),
)
