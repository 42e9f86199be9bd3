"""The check itself: cases, comparison, verdict."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from copy import deepcopy
from functools import lru_cache
from typing import Any

import numpy as np

from .attempt import Outcome, agree, as_arrays, attempt, deviation
from .bank import wrong_answers
from .exercise import Case, Exercise
from .formula import as_function, is_formula
from .shelf import EXERCISES, find
from .verdict import Verdict


@np.errstate(all="ignore")  # huge numbers are a verdict, not a warning
def check(id: str, function: Callable[..., Any], seed: int = 0) -> Verdict:
    """Find out whether a function computes an equation.

    The function is called with random, degenerate and adversarial arguments, all of them such
    that the printed equation has a value, and compared with `projflow_lite.equations`. Nothing
    it does makes the check itself stop: mistakes, crashes and unfinished work are verdicts. Only a
    loop without end has to be interrupted by hand.

    Args:
        id: the exercise, such as ``"projflow:7"``; `exercises` lists them.
        function: the function to check, with the signature that the exercise asks for; or, where
            the answer is a formula, a sympy expression in symbols of those names.
        seed: draws other cases.

    Returns:
        A `Verdict`, true if the function is right, which prints as what to know.

    Raises:
        ValueError: if there is no such exercise.
    """
    exercise = find(id, "check")
    cases, expected = standard(exercise.id, seed)
    said = ""
    if is_formula(function):
        found = as_function(function, exercise.parameters)
        said, function = (found, function) if isinstance(found, str) else ("", found)
    refusal = said or _cannot_be_called(exercise, function, cases[0])
    if refusal:
        return _verdict(exercise, cases, problem=refusal)
    outcomes = _attempts(exercise, function, cases)
    complaints = [
        _complaint(exercise, outcome, right)
        for outcome, right in zip(outcomes, expected, strict=True)
    ]
    failed = [k for k, complaint in enumerate(complaints) if complaint]
    if not failed:
        return Verdict(True, exercise.id, exercise.record.title, len(cases), len(cases))
    if all(outcome.unwritten for outcome in outcomes):
        problem = f"not written yet ({outcomes[0].problem}; is a `return` missing?)"
        return _verdict(exercise, cases, problem=problem)
    first = failed[0]
    return _verdict(
        exercise,
        cases,
        passed=len(cases) - len(failed),
        problem=_sentence(cases, failed, complaints[first]),
        mistake=_recognise(exercise, seed, outcomes),
        case=cases[first],
    )


@lru_cache(maxsize=128)
def standard(id: str, seed: int) -> tuple[list[Case], list[tuple[np.ndarray, ...]]]:
    """Return the cases of an exercise and what should come out of them."""
    exercise = EXERCISES[id]
    cases = exercise.cases(np.random.default_rng(seed))
    parts = len(exercise.returns)
    return cases, [as_arrays(exercise.reference(*case.arguments), parts) for case in cases]


@lru_cache(maxsize=128)
def known_mistakes(id: str, seed: int) -> list[tuple[str, list[Outcome]]]:
    """Return what the wrong answers of the bank come to, each with what the mistake is."""
    exercise, (cases, _) = EXERCISES[id], standard(id, seed)
    return [
        (inspect.getdoc(wrong) or "", _attempts(exercise, wrong, cases))
        for wrong in wrong_answers(id)
    ]


def _attempts(exercise: Exercise, function: Callable[..., Any], cases: list[Case]) -> list[Outcome]:
    """Call a function with every case."""
    names, parts = exercise.parameters, len(exercise.returns)
    return [attempt(function, case.arguments, names, parts) for case in cases]


def _recognise(exercise: Exercise, seed: int, outcomes: list[Outcome]) -> str:
    """Say which known mistake comes to the same in every case, if one does."""
    for sentence, known in known_mistakes(exercise.id, seed):
        if all(agree(one, other) for one, other in zip(outcomes, known, strict=True)):
            return sentence
    return ""


def _cannot_be_called(exercise: Exercise, function: Callable[..., Any], case: Case) -> str:
    """Say why a function cannot be called with the arguments of its exercise, if so."""
    if not callable(function):
        name = exercise.function
        return f"this is not a function; write check({exercise.id!r}, {name}), without calling it"
    try:
        signature = inspect.signature(function)
    except Exception:  # some built-in functions do not tell; calling them will
        return ""
    try:
        signature.bind(*case.arguments)
    except TypeError:
        wanted, own = exercise.record.signature, list(signature.parameters)
        return f"the arguments should be those of {wanted}; yours are ({', '.join(own)})"
    return ""


def _complaint(exercise: Exercise, outcome: Outcome, expected: tuple[np.ndarray, ...]) -> str:
    """Say what is wrong with one outcome; nothing if it is right."""
    if outcome.problem:
        return outcome.problem
    for name, value, right in zip(exercise.returns, outcome.values, expected, strict=True):
        if value.shape != right.shape:
            return f"the {name} has shape {value.shape}, expected {right.shape}"
        if not np.isfinite(value).all():
            return f"the {name} has a value that is not finite, {_place(~np.isfinite(value))}"
        if deviation(value, right) > 1:
            off = np.abs(value - right)
            return f"the {name} deviates by up to {off.max():.3g}, {_place(off)}"
    if outcome.changed:
        changed = " and ".join(outcome.changed)
        return f"the numbers are right, but the function changes its argument {changed}"
    return ""


def _place(size: np.ndarray) -> str:
    """Say where an array is largest."""
    if size.ndim == 0:
        return "a single number"
    index = tuple(int(i) for i in np.unravel_index(np.argmax(size), size.shape))
    return f"at [{', '.join(map(str, index))}]"


def _sentence(cases: list[Case], failed: list[int], complaint: str) -> str:
    """Put a complaint into its place among the cases."""
    passed = f"{len(cases) - len(failed)} of {len(cases)} cases are right"
    return f"{passed}. Case {failed[0] + 1}, {cases[failed[0]].name}: {complaint}."


def _verdict(exercise: Exercise, cases: list[Case], **what: Any) -> Verdict:
    """Return a verdict on a function that is not right."""
    case = what.pop("case", None)
    if case is not None:
        what["case"] = case.name
        own = deepcopy(case.arguments)  # whatever becomes of these, the cases stay as they are
        what["arguments"] = dict(zip(exercise.parameters, own, strict=True))
    return Verdict(
        False, exercise.id, exercise.record.title, len(cases), hint=exercise.hints[0], **what
    )
