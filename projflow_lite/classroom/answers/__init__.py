"""The lecturer's answers: a derivation that sympy confirms, and the lines of numpy."""

from __future__ import annotations

from dataclasses import dataclass

from ..exercise import ExerciseRecord
from ..shelf import find
from . import applications, flow, guides, metric, posterior, projection
from .derivation import Answer, confirmed

ANSWERS: dict[str, Answer] = {
    **flow.ANSWERS,
    **projection.ANSWERS,
    **posterior.ANSWERS,
    **metric.ANSWERS,
    **guides.ANSWERS,
    **applications.ANSWERS,
}


@dataclass(frozen=True, repr=False, eq=False)
class LecturerAnswer:
    """An answer to read out, which prints as text and shows as formatted text in a notebook.

    Attributes:
        record: the exercise, with its equation.
        derivation: where the equation comes from, Markdown with LaTeX.
        confirmed: the steps that sympy has just computed and found to hold.
        code: the lines of numpy, a whole function.
    """

    record: ExerciseRecord
    derivation: str
    confirmed: tuple[str, ...]
    code: str

    def __str__(self) -> str:
        """The answer as Markdown."""
        steps = "\n".join(f"- {step}" for step in self.confirmed)
        return (
            f"**{self.record.id}, {self.record.title}**\n\n$${self.record.latex}$$\n\n"
            f"{self.derivation}\n\nComputed and confirmed by sympy:\n\n{steps}\n\n"
            f"```python\n{self.code}\n```"
        )

    __repr__ = __str__
    _repr_markdown_ = __str__


def answer(id: str) -> LecturerAnswer:
    """Return the lecturer's answer to an exercise; sympy confirms its derivation on the way.

    Args:
        id: such as ``"projflow:7"``.

    Raises:
        ValueError: if there is no such exercise.
        ArithmeticError: if sympy finds a step that does not hold.
    """
    exercise = find(id, "answer")
    found = ANSWERS[exercise.id]
    return LecturerAnswer(exercise.record, found.text, confirmed(found, exercise.id), found.code)
