"""Checks of the reader's own code in the notebook on how a body walks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from projflow_lite.classroom.attempt import attempt, deviation
from projflow_lite.classroom.verdict import Verdict

CASES = 12


def check_knee(function: Callable[..., Any], seed: int = 0) -> Verdict:
    """Does ``function(hip, ankle, thigh, shank)`` find the knee of a leg that bends ahead?

    The leg is seen from its left side: a point is ``(ahead, up)``, metres. The ankle is below the
    hip and within reach. What comes back is judged by what makes it a knee: both bones have their
    length, and the knee is ahead of the line from hip to ankle.

    Args:
        function: returns the knee, ``(2,)``.
        seed: draws other legs.
    """
    random = np.random.default_rng(seed)
    title, names = "the knee of a leg", ("hip", "ankle", "thigh", "shank")
    hint = "the law of cosines gives how far along hip–ankle the knee is, Pythagoras how far aside"
    for number in range(CASES):
        hip, thigh, shank = random.uniform(-1, 1, 2), *random.uniform(0.3, 0.5, 2)
        reach = random.uniform(abs(thigh - shank) + 0.05, 0.98 * (thigh + shank))
        turned = random.uniform(-1.2, 1.2)
        ankle = hip + reach * np.array([np.sin(turned), -np.cos(turned)])
        outcome = attempt(function, (hip, ankle, thigh, shank), names, 1)
        problem = outcome.problem or knee_problem(outcome.values[0], hip, ankle, thigh, shank)
        if outcome.unwritten:
            return unwritten("knee", title, CASES)
        if problem:
            arguments = {"hip": hip, "ankle": ankle, "thigh": thigh, "shank": shank}
            return Verdict(False, "knee", title, CASES, number, problem, "", hint, "", arguments)
    return Verdict(True, "knee", title, CASES, CASES)


def knee_problem(knee: NDArray, hip: NDArray, ankle: NDArray, thigh: float, shank: float) -> str:
    """What is wrong with a knee, or nothing."""
    if knee.shape != (2,):
        return f"the knee has shape {knee.shape}, and not (2,): ahead and up"
    if not np.isfinite(knee).all():
        return "the knee is not a number; is something under the root negative?"
    for name, length, end in (("thigh", thigh, hip), ("shank", shank, ankle)):
        found = float(np.linalg.norm(knee - end))
        if abs(found - length) > 1e-6:
            return f"the {name} should be {length:.3f} m long, and is {found:.3f} m"
    down = ankle - hip
    if (knee - hip) @ np.array([-down[1], down[0]]) <= 0:
        return "both bones have their length, but the knee bends backwards"
    return ""


def check_stance(function: Callable[..., Any], seed: int = 0) -> Verdict:
    """Does ``function(time, cadence, duty)`` say which feet stand?

    A cycle is two steps; a foot stands for the first `duty` of its cycle, and the right foot is
    half a cycle off the left one, whose cycle begins at time 0.

    Args:
        function: takes ``(n,)`` seconds, steps a second and a share; returns ``(n, 2)``, left and
            right, 1 or True where a foot stands.
        seed: draws other gaits.
    """
    random = np.random.default_rng(seed)
    title, names = "which feet stand", ("time", "cadence", "duty")
    hint = "a foot makes cadence / 2 cycles a second; what counts is their part after the point"
    for number in range(CASES):
        time = np.sort(random.uniform(0, 5, 40))
        cadence, duty = random.uniform(0.8, 3.2), random.uniform(0.25, 0.75)
        # A cycle holds two steps, so a walker's clock in steps has a foot's turn every second one.
        clock = np.mod(time[:, None] * cadence + [0.0, 1.0], 2.0)
        right = (clock < 2 * duty).astype(float)
        outcome = attempt(function, (time, cadence, duty), names, 1)
        if outcome.unwritten:
            return unwritten("stance", title, CASES)
        problem = outcome.problem or stance_problem(outcome.values[0], right, clock, duty)
        if problem:
            arguments = {"time": time, "cadence": cadence, "duty": duty}
            return Verdict(False, "stance", title, CASES, number, problem, "", hint, "", arguments)
    return Verdict(True, "stance", title, CASES, CASES)


def stance_problem(found: NDArray, right: NDArray, clock: NDArray, duty: float) -> str:
    """What is wrong with an answer, or nothing."""
    if found.shape != right.shape:
        return f"the answer has shape {found.shape}, and not {right.shape}: times and two feet"
    if deviation(found, right) <= 1:
        return ""
    if deviation(found[:, ::-1], right) <= 1:
        return "left and right are exchanged"
    if deviation(found, 1 - right) <= 1:
        return "it says when a foot swings, not when it stands"
    if deviation(found[:, :1], right[:, :1]) <= 1:
        return "the left foot is right, and the right foot is wrong: half a cycle apart"
    wrong = int((np.abs(found - right) > 0.5).any(axis=1).sum())
    return f"at {wrong} of {len(right)} times a foot is wrong"


def unwritten(name: str, title: str, cases: int) -> Verdict:
    """The verdict on a function that nobody has written yet."""
    return Verdict(False, name, title, cases, problem="not written yet (is a `return` missing?)")
