"""One call of a function that may do anything, and the comparison of what came of it."""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass
from types import EllipsisType
from typing import Any

import numpy as np
from numpy.typing import NDArray

TOLERANCE = 1e-5
"""Largest deviation that counts as rounding, relative to the largest number expected.

Single precision passes; the mistakes of the bank deviate by far more.
"""

SMALLEST_SCALE = 1e-3
"""Where less than this is expected, zeros above all, the deviation is relative to this."""


@dataclass(frozen=True)
class Outcome:
    """What came of one call.

    Attributes:
        values: the arrays that came back, empty if there is a problem.
        problem: why there is nothing to compare, in one sentence without its full stop.
        changed: names of the arguments that the call changed.
        unwritten: whether the function looks as if nobody had written it yet.
    """

    values: tuple[NDArray, ...] = ()
    problem: str = ""
    changed: tuple[str, ...] = ()
    unwritten: bool = False


def attempt(
    function: Callable[..., Any],
    arguments: tuple[Any, ...],
    parameters: tuple[str, ...],
    parts: int,
) -> Outcome:
    """Call a function with copies of the arguments; whatever it does becomes an outcome.

    Only an interruption from the keyboard passes through.

    Args:
        function: the function to call.
        arguments: what to call it with, in order.
        parameters: their names.
        parts: how many arrays should come back.
    """
    given = deepcopy(arguments)
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            returned = function(*given)
            if returned is None or isinstance(returned, EllipsisType):
                return Outcome(problem="the function returns nothing", unwritten=True)
            values = as_arrays(returned, parts)
    except NotImplementedError:
        return Outcome(problem="the function raises NotImplementedError", unwritten=True)
    except RecursionError:
        return Outcome(problem="the function calls itself without end")
    except UnreadableReturnError as error:
        return Outcome(problem=str(error))
    except (Exception, SystemExit) as error:
        return Outcome(problem=f"the function stops with {describe(error)}")
    pairs = zip(parameters, arguments, given, strict=True)
    return Outcome(values, changed=tuple(n for n, old, new in pairs if not same(old, new)))


class UnreadableReturnError(Exception):
    """What a function returned cannot be read as arrays of numbers."""


def as_arrays(returned: Any, parts: int) -> tuple[NDArray, ...]:
    """Read what a function returned as `parts` arrays of float64.

    Lists, tuples, tensors and sparse matrices are welcome.

    Raises:
        UnreadableReturnError: saying what came back instead.
    """
    if inspect.isgenerator(returned) or inspect.iscoroutine(returned):
        returned.close()
        raise UnreadableReturnError("the function yields its values one by one; use return instead")
    if parts == 1:
        return (as_array(returned),)
    if not isinstance(returned, tuple | list) or len(returned) != parts:
        raise UnreadableReturnError(
            f"the function should return {parts} arrays, not {kind(returned)}"
        )
    return tuple(as_array(part) for part in returned)


def as_array(value: Any) -> NDArray:
    """Read a value as an array of float64.

    Raises:
        UnreadableReturnError: if it holds anything but real numbers.
    """
    try:
        array = np.asarray(value.toarray() if hasattr(value, "toarray") else value)
        if array.dtype.kind == "c":
            raise TypeError("complex numbers are not real")
        return array.astype(np.float64)
    except Exception:
        raise UnreadableReturnError(
            f"the function should return real numbers, not {kind(value)}"
        ) from None


def kind(value: Any) -> str:
    """Say in few words what a value is."""
    if isinstance(value, tuple | list):
        return f"a {type(value).__name__} of {len(value)}"
    if isinstance(value, np.ndarray):
        return f"one array of shape {value.shape} with {value.dtype} in it"
    return f"a value of type {type(value).__name__}"


def describe(error: BaseException) -> str:
    """Name an error and quote the first line of what it says, cut to a readable length."""
    try:
        words = str(error).strip().splitlines()
    except Exception:  # a student's exception may fail to print, too
        words = []
    message = f": {words[0][:160]}" if words else ""
    return f"{type(error).__name__}{message}"


def same(old: Any, new: Any) -> bool:
    """Say whether an argument is still what it was."""
    if isinstance(old, np.ndarray):
        return old.shape == new.shape and bool(np.array_equal(old, new))
    return bool(old == new)


def deviation(value: NDArray, expected: NDArray) -> float:
    """Return the largest deviation in units of what would still count as rounding.

    Above 1 the value is wrong; it is infinite if a shape differs or a number is not finite
    where the expected one is.
    """
    if value.shape != expected.shape:
        return np.inf
    finite = np.isfinite(expected)
    if (np.isfinite(value) != finite).any():
        return np.inf
    scale = max(np.abs(expected[finite]).max(initial=0), SMALLEST_SCALE)
    return float(np.abs(value[finite] - expected[finite]).max(initial=0) / scale / TOLERANCE)


def agree(one: Outcome, other: Outcome) -> bool:
    """Say whether two functions came to the same: equal values, or both to a problem."""
    if bool(one.problem) != bool(other.problem) or one.changed != other.changed:
        return False
    pairs = zip(one.values, other.values, strict=True)
    return one.unwritten == other.unwritten and all(deviation(a, b) <= 1 for a, b in pairs)
