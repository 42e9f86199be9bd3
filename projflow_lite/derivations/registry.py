"""The list of derivations and of counterexamples, and what runs them."""

from __future__ import annotations

import math
import time
import zlib
from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple, TypeVar

import numpy as np

from projflow_lite import equations as eq

Deviation = Callable[[np.random.Generator], float]
Number = int | str
PROJFLOW = "ProjFlow"


class Derivation(NamedTuple):
    """One way to an equation that does not go through the equation's own function.

    Attributes:
        equation: number in ProjFlow; for another paper, the number of its record, as text.
        method: how it is derived or checked, in words.
        tolerance: the largest deviation that rounding, or chance, may leave.
        deviation: function of a random generator that returns the largest deviation.
        paper: short name of the paper, as in the catalog.
    """

    equation: Number
    method: str
    tolerance: float
    deviation: Deviation
    paper: str = PROJFLOW


class Counterexample(NamedTuple):
    """One place where the equation as printed, or its public code, does not do what it says.

    Attributes:
        equation: number in ProjFlow; for another paper, the number of its record, as text.
        what: what is printed or released, and what the deviation measures.
        more_than: the deviation that rounding could explain.
        deviation: function of a random generator that returns the deviation.
        paper: short name of the paper, as in the catalog.
    """

    equation: Number
    what: str
    more_than: float
    deviation: Deviation
    paper: str = PROJFLOW


class Row(NamedTuple):
    """What one derivation found; `problem` is the error that stopped it, if any did."""

    equation: Number
    title: str
    method: str
    deviation: float
    tolerance: float
    holds: bool
    seconds: float
    problem: str = ""
    paper: str = PROJFLOW


class PrintedRow(NamedTuple):
    """What one counterexample found: it is right if the printed form `deviates`."""

    equation: Number
    title: str
    what: str
    deviation: float
    more_than: float
    deviates: bool
    seconds: float
    problem: str = ""
    paper: str = PROJFLOW


Entry = TypeVar("Entry", Derivation, Counterexample)

DERIVATIONS: list[Derivation] = []
COUNTEREXAMPLES: list[Counterexample] = []
"""Those of ProjFlow, the paper this package is about."""

OTHER_DERIVATIONS: list[Derivation] = []
OTHER_COUNTEREXAMPLES: list[Counterexample] = []
"""Those of the papers it is compared with."""


def derives(
    equation: Number, method: str, tolerance: float, paper: str = PROJFLOW
) -> Callable[[Deviation], Deviation]:
    """Enter a function into the list of derivations.

    Args:
        equation: number in ProjFlow; for another paper, the number of its record, as text.
        method: how it is derived or checked, in words.
        tolerance: the largest deviation at which the equation still counts as derived.
        paper: short name of the paper, as in the catalog.
    """

    def enter(function: Deviation) -> Deviation:
        entries = DERIVATIONS if paper == PROJFLOW else OTHER_DERIVATIONS
        entries.append(Derivation(equation, method, tolerance, function, paper))
        return function

    return enter


def contradicts(
    equation: Number, what: str, more_than: float = 1e-12, paper: str = PROJFLOW
) -> Callable[[Deviation], Deviation]:
    """Enter a function into the list of counterexamples to what is printed or released.

    Args:
        equation: number in ProjFlow; for another paper, the number of its record, as text.
        what: what is printed or released, and what the deviation measures.
        more_than: the deviation that rounding could explain.
        paper: short name of the paper, as in the catalog.
    """

    def enter(function: Deviation) -> Deviation:
        entries = COUNTEREXAMPLES if paper == PROJFLOW else OTHER_COUNTEREXAMPLES
        entries.append(Counterexample(equation, what, more_than, function, paper))
        return function

    return enter


def run(numbers: Iterable[Number] | None = None, seed: int = 0, paper: str = PROJFLOW) -> list[Row]:
    """Derive equations again and compare them with `projflow_lite.equations`.

    A deviation that is not a number never holds; neither does a derivation that an error stops.

    Args:
        numbers: which equations of the paper; all 52 of ProjFlow if left out.
        seed: of the random problems. An equation gets the same ones, whichever others are run.
        paper: ``"ProjFlow"``, whose equations are numbers, or ``"GMD"``, where they are texts such
            as ``"4.1 (a)"``.

    Returns:
        One row per derivation, in the order of the equations.

    Raises:
        ValueError: if there is no equation of that number, or nothing of that paper is checked.
        ModuleNotFoundError: if sympy is not installed.
    """
    rows, titles = [], _titles(paper, "run")
    entries = DERIVATIONS if paper == PROJFLOW else OTHER_DERIVATIONS
    for entry in _chosen(entries, numbers, "run", paper):
        deviation, seconds, problem = _measure(entry.deviation, entry.equation, seed)
        holds = not problem and deviation <= entry.tolerance
        found = (deviation, entry.tolerance, holds, seconds, problem, paper)
        rows.append(Row(entry.equation, titles[entry.equation], entry.method, *found))
    return rows


def run_as_printed(
    numbers: Iterable[Number] | None = None, seed: int = 0, paper: str = PROJFLOW
) -> list[PrintedRow]:
    """Measure how far the printed or released forms are from what they should give.

    Args:
        numbers: which equations of the paper; all that have an erratum if left out.
        seed: of the random problems.
        paper: ``"ProjFlow"`` or ``"GMD"``, see `run`.

    Returns:
        One row per counterexample, in the order of the equations; none where nothing is wrong.

    Raises:
        ValueError: if there is no equation of that number, or nothing of that paper is checked.
    """
    rows, titles = [], _titles(paper, "run_as_printed")
    entries = COUNTEREXAMPLES if paper == PROJFLOW else OTHER_COUNTEREXAMPLES
    for entry in _chosen(entries, numbers, "run_as_printed", paper):
        deviation, seconds, problem = _measure(entry.deviation, entry.equation, seed)
        deviates = not problem and deviation > entry.more_than
        found = (deviation, entry.more_than, deviates, seconds, problem, paper)
        rows.append(PrintedRow(entry.equation, titles[entry.equation], entry.what, *found))
    return rows


def _measure(deviation: Deviation, equation: Number, seed: int) -> tuple[float, float, str]:
    """Return deviation, seconds, and the error that stopped it, empty if none did."""
    start = time.perf_counter()
    number = equation if isinstance(equation, int) else zlib.crc32(equation.encode())
    try:
        value, problem = float(deviation(np.random.default_rng([seed, number]))), ""
    except ImportError:
        raise  # a missing library says nothing about an equation
    except Exception as error:  # any other error is a finding, and the table shows it
        value, problem = math.nan, f"{type(error).__name__}: {error}"
    return value, time.perf_counter() - start, problem


def _titles(paper: str, who: str) -> dict[Number, str]:
    """Title of every equation of a paper, from the catalog and in its order."""
    records = [record for record in eq.catalog() if record.paper == paper and record.function]
    if not records:
        raise ValueError(f"{who}: no equation of {paper!r} is checked, expected ProjFlow or GMD")
    if paper == PROJFLOW:
        return {int(record.number): record.title for record in records}
    return {record.number: record.title for record in records}


def _chosen(
    entries: list[Entry], numbers: Iterable[Number] | None, who: str, paper: str
) -> Iterator[Entry]:
    """Yield the entries of these equations, by number."""
    known = list(_titles(paper, who))
    wanted = set(known if numbers is None else numbers)
    for number in wanted - set(known):
        expected = f"{known[0]}..{known[-1]}" if paper == PROJFLOW else ", ".join(map(str, known))
        raise ValueError(f"{who}: {paper} has no equation {number}, expected {expected}")
    chosen = [e for e in entries if e.paper == paper and e.equation in wanted]
    yield from sorted(chosen, key=lambda e: known.index(e.equation))
