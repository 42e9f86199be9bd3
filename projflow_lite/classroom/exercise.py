"""What an exercise is made of."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

from numpy.random import Generator

from .. import equations


class Case(NamedTuple):
    """One call of the student's function.

    Attributes:
        name: what is special about it, said to the student if it goes wrong.
        arguments: what the function is called with, in order.
    """

    name: str
    arguments: tuple[Any, ...]


def case(name: str, *arguments: Any) -> Case:
    """Return a case with its arguments written one after the other."""
    return Case(name, arguments)


class ExerciseRecord(NamedTuple):
    """One line of the list of exercises.

    Attributes:
        id: such as ``"projflow:7"``.
        title: what it is about.
        signature: the function to write, such as ``"halo_radius(t, l_min, l_max)"``.
        task: what to do, in one or two sentences.
        latex: the equation, from the catalog.
    """

    id: str
    title: str
    signature: str
    task: str
    latex: str


@dataclass(frozen=True)
class Exercise:
    """A function to write, and everything needed to judge it.

    Attributes:
        id: such as ``"projflow:7"``.
        function: name of the function in `projflow_lite.equations` that sets the standard.
        task: what to do, in one or two sentences.
        hints: three, from a nudge to all but the answer.
        cases: draws the cases. Each is one where the printed equation has a value.
        returns: names of the arrays that come back.
        numbers: equations of ProjFlow that the function computes; the one in `id` if left out.
    """

    id: str
    function: str
    task: str
    hints: tuple[str, str, str]
    cases: Callable[[Generator], list[Case]]
    returns: tuple[str, ...] = ("result",)
    numbers: tuple[str, ...] = ()

    @property
    def reference(self) -> Callable[..., Any]:
        """The function of `projflow_lite.equations` that sets the standard."""
        return getattr(equations, self.function)

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        """Names of the arguments; `form`, which chooses between readings, is not one of them."""
        return tuple(p for p in inspect.signature(self.reference).parameters if p != "form")

    @cached_property
    def record(self) -> ExerciseRecord:
        """The line of this exercise in the list, with title and equation from the catalog."""
        numbers = self.numbers or (self.id.split(":")[1],)
        found = {r.number: r for r in equations.catalog() if r.paper == "ProjFlow"}
        latex = r", \qquad ".join(found[number].latex for number in numbers)
        signature = f"{self.function}({', '.join(self.parameters)})"
        return ExerciseRecord(self.id, found[numbers[-1]].title, signature, self.task, latex)
