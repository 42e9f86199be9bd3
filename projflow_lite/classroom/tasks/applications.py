"""Wishes of an animator as rows: ProjFlow eq. 36 and 38."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from ..exercise import Case, Exercise, case


def _holds(rng: Generator) -> list[Case]:
    def offset() -> np.ndarray:
        return rng.uniform(0.1, 1, 3)

    return [
        case("three frames, four joints", 3, 4, 2, 1, offset()),
        case("two frames, five joints, the first joint with the last", 2, 5, 0, 4, offset()),
        case("as many frames as joints", 3, 3, 2, 0, offset()),
        case("one frame", 1, 4, 3, 1, offset()),
        case("two joints", 2, 2, 0, 1, offset()),
        case("two joints, the other way round", 2, 2, 1, 0, offset()),
        case("the joints shall meet (d = 0)", 2, 3, 1, 2, np.zeros(3)),
        case("an offset of whole numbers", 2, 3, 1, 2, np.array([1, -2, 3])),
    ]


def _loops(rng: Generator) -> list[Case]:
    frames, joints = (int(n) for n in rng.integers((5, 4), (8, 7)))
    return [
        case("a few frames and joints", frames, joints),
        case("four frames, two joints", 4, 2),
        case("two frames, four joints", 2, 4),
        case("three frames, three joints", 3, 3),
        case("two frames", 2, 1),
        case("one joint", 5, 1),
        case("one frame, first and last at once", 1, 3),
        case("one frame, one joint", 1, 1),
    ]


EXERCISES = (
    Exercise(
        "projflow:36",
        "offset_rows",
        "Return the rows A (3 N x 3 N J) and the values y (3 N) that keep joint_a at the offset d "
        "(3, metres) from joint_b in each of N frames. The vector is sorted frame by frame, in it "
        "joint by joint, in it axis by axis; joints count from 0.",
        (
            "One row per frame and axis. How many entries of each row are not zero?",
            "The offset leads from joint_b to joint_a: which of the two has the plus sign?",
            "Three factors, from slow to fast: an identity for the frames, a row of joints with "
            "one plus and one minus, an identity for the axes. The values repeat all of d once "
            "per frame.",
        ),
        _holds,
        ("matrix A", "vector y"),
    ),
    Exercise(
        "projflow:38",
        "loop_rows",
        "Return the rows A (3 J x 3 N J) and the values y (3 J) that make the last pose the first "
        "one, for N frames and J joints. The vector is sorted frame by frame; frames count from "
        "0. One frame is first and last at once.",
        (
            "One row per joint and axis. Which two frames does each row compare?",
            "What the rows measure is the first frame minus the last, and it shall be nothing.",
            "Two factors, from slow to fast: a row of frames with a plus in the first and a minus "
            "in the last, and an identity for everything inside a frame. With one frame the plus "
            "and the minus fall on the same entry.",
        ),
        _loops,
        ("matrix A", "vector y"),
    ),
)
