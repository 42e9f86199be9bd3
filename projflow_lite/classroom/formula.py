"""Answers that are formulas: a sympy expression becomes a function that can be checked."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


def is_formula(answer: Any) -> bool:
    """Whether an answer is a sympy expression rather than a function."""
    return hasattr(answer, "free_symbols") and not isinstance(answer, type)


def as_function(formula: Any, parameters: tuple[str, ...]) -> Callable[..., Any] | str:
    """Turn a formula into a function of the exercise's parameters, or say why it is none.

    Args:
        formula: a sympy expression; its symbols carry the names of the parameters, whatever is
            assumed of them.
        parameters: those names, in order.
    """
    import sympy

    by_name = {symbol.name: symbol for symbol in formula.free_symbols}
    strangers = sorted(set(by_name) - set(parameters))
    if strangers:
        known = ", ".join(parameters)
        return f"the formula has a symbol {strangers[0]}; the names here are {known}"
    order = [by_name.get(name, sympy.Symbol(name)) for name in parameters]
    evaluate = sympy.lambdify(order, formula, "numpy")
    return lambda *arguments: evaluate(*arguments)
