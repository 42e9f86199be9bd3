"""What an answer is made of, and how sympy confirms it. Nothing here imports sympy before then."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple


class Step(NamedTuple):
    """A claim, and an expression of sympy that is zero exactly if the claim holds.

    Attributes:
        claim: what is claimed, in words.
        residue: an expression or a matrix of them.
    """

    claim: str
    residue: Any


class Derivation(NamedTuple):
    """An equation derived by sympy from where it comes from, not from its own print.

    All symbols may stand for any numbers between 0 and 1.

    Attributes:
        steps: what is confirmed on the way.
        arguments: those of the exercise, as sympy objects; a column stands for a vector, an
            array for itself.
        result: what the function must return for them, as found by sympy.
    """

    steps: list[Step]
    arguments: tuple[Any, ...]
    result: Any


class Answer(NamedTuple):
    """A lecturer's answer.

    Attributes:
        text: where the equation comes from, Markdown with LaTeX.
        code: the lines of numpy, a whole function.
        derive: computes the derivation.
    """

    text: str
    code: str
    derive: Callable[[], Derivation]


def confirmed(answer: Answer, id: str) -> tuple[str, ...]:
    """Return the claims of an answer's derivation after sympy has confirmed each.

    Raises:
        ArithmeticError: naming the first claim that does not hold.
    """
    steps = answer.derive().steps
    for step in steps:
        if not vanishes(step.residue):
            raise ArithmeticError(f"answer: {id}: sympy does not confirm: {step.claim}")
    return tuple(step.claim for step in steps)


def vanishes(residue: Any) -> bool:
    """Say whether an expression, or every entry of a matrix, simplifies to zero."""
    import sympy

    entries = list(residue) if hasattr(residue, "shape") else [residue]
    return all(sympy.simplify(entry) == 0 for entry in entries)
