"""The list of derivations and of counterexamples, and what runs them."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple, TypeVar

import numpy as np

from projflow_lite import equations as eq

Deviation = Callable[[np.random.Generator], float]


class Derivation(NamedTuple):
    """One way to an equation that does not go through the equation's own function.

    Attributes:
        equation: number in ProjFlow.
        method: how it is derived or checked, in words.
        tolerance: the largest deviation that rounding, or chance, may leave.
        deviation: function of a random generator that returns the largest deviation.
    """

    equation: int
    method: str
    tolerance: float
    deviation: Deviation


class Counterexample(NamedTuple):
    """One place where the equation as printed, or its public code, does not do what it says.

    Attributes:
        equation: number in ProjFlow.
        what: what is printed or released, and what the deviation measures.
        more_than: the deviation that rounding could explain.
        deviation: function of a random generator that returns the deviation.
    """

    equation: int
    what: str
    more_than: float
    deviation: Deviation


class Row(NamedTuple):
    """What one derivation found; `problem` is the error that stopped it, if any did."""

    equation: int
    title: str
    method: str
    deviation: float
    tolerance: float
    holds: bool
    seconds: float
    problem: str = ""


class PrintedRow(NamedTuple):
    """What one counterexample found: it is right if the printed form `deviates`."""

    equation: int
    title: str
    what: str
    deviation: float
    more_than: float
    deviates: bool
    seconds: float
    problem: str = ""


Entry = TypeVar("Entry", Derivation, Counterexample)

DERIVATIONS: list[Derivation] = []
COUNTEREXAMPLES: list[Counterexample] = []


def derives(equation: int, method: str, tolerance: float) -> Callable[[Deviation], Deviation]:
    """Enter a function into the list of derivations.

    Args:
        equation: number in ProjFlow.
        method: how it is derived or checked, in words.
        tolerance: the largest deviation at which the equation still counts as derived.
    """

    def enter(function: Deviation) -> Deviation:
        DERIVATIONS.append(Derivation(equation, method, tolerance, function))
        return function

    return enter


def contradicts(
    equation: int, what: str, more_than: float = 1e-12
) -> Callable[[Deviation], Deviation]:
    """Enter a function into the list of counterexamples to what is printed or released.

    Args:
        equation: number in ProjFlow.
        what: what is printed or released, and what the deviation measures.
        more_than: the deviation that rounding could explain.
    """

    def enter(function: Deviation) -> Deviation:
        COUNTEREXAMPLES.append(Counterexample(equation, what, more_than, function))
        return function

    return enter


def run(numbers: Iterable[int] | None = None, seed: int = 0) -> list[Row]:
    """Derive equations again and compare them with `projflow_lite.equations`.

    A deviation that is not a number never holds; neither does a derivation that an error stops.

    Args:
        numbers: which equations of ProjFlow; all 52 if left out.
        seed: of the random problems. An equation gets the same ones, whichever others are run.

    Returns:
        One row per derivation, in the order of the equations.

    Raises:
        ValueError: if there is no equation of that number.
        ModuleNotFoundError: if sympy is not installed.
    """
    rows, titles = [], _titles()
    for entry in _chosen(DERIVATIONS, numbers, "run"):
        deviation, seconds, problem = _measure(entry.deviation, entry.equation, seed)
        holds = not problem and deviation <= entry.tolerance
        found = (deviation, entry.tolerance, holds, seconds, problem)
        rows.append(Row(entry.equation, titles[entry.equation], entry.method, *found))
    return rows


def run_as_printed(numbers: Iterable[int] | None = None, seed: int = 0) -> list[PrintedRow]:
    """Measure how far the printed or released forms are from what they should give.

    Args:
        numbers: which equations of ProjFlow; all that have an erratum if left out.
        seed: of the random problems.

    Returns:
        One row per counterexample, in the order of the equations; none where nothing is wrong.

    Raises:
        ValueError: if there is no equation of that number.
    """
    rows, titles = [], _titles()
    for entry in _chosen(COUNTEREXAMPLES, numbers, "run_as_printed"):
        deviation, seconds, problem = _measure(entry.deviation, entry.equation, seed)
        deviates = not problem and deviation > entry.more_than
        found = (deviation, entry.more_than, deviates, seconds, problem)
        rows.append(PrintedRow(entry.equation, titles[entry.equation], entry.what, *found))
    return rows


def _measure(deviation: Deviation, equation: int, seed: int) -> tuple[float, float, str]:
    """Return deviation, seconds, and the error that stopped it, empty if none did."""
    start = time.perf_counter()
    try:
        value, problem = float(deviation(np.random.default_rng([seed, equation]))), ""
    except ImportError:
        raise  # a missing library says nothing about an equation
    except Exception as error:  # any other error is a finding, and the table shows it
        value, problem = math.nan, f"{type(error).__name__}: {error}"
    return value, time.perf_counter() - start, problem


def _titles() -> dict[int, str]:
    """Title of every equation of ProjFlow, from the catalog."""
    return {
        int(record.number): record.title for record in eq.catalog() if record.paper == "ProjFlow"
    }


def _chosen(entries: list[Entry], numbers: Iterable[int] | None, who: str) -> Iterator[Entry]:
    """Yield the entries of these equations, by number."""
    known = set(_titles())
    wanted = known if numbers is None else set(numbers)
    for number in wanted - known:
        raise ValueError(f"{who}: ProjFlow has no equation {number}, expected 1..{max(known)}")
    yield from sorted((e for e in entries if e.equation in wanted), key=lambda e: e.equation)
