"""Where the answers of the bank are kept, by exercise."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from typing import Any

Answer = Callable[..., Any]

_WRONG: dict[str, list[Answer]] = defaultdict(list)
_RIGHT: dict[str, list[Answer]] = defaultdict(list)


def wrong(id: str) -> Callable[[Answer], Answer]:
    """Put the function below on the shelf of wrong answers to an exercise."""

    def shelve(answer: Answer) -> Answer:
        _WRONG[id].append(answer)
        return answer

    return shelve


def right(id: str) -> Callable[[Answer], Answer]:
    """Put the function below on the shelf of right answers to an exercise."""

    def shelve(answer: Answer) -> Answer:
        _RIGHT[id].append(answer)
        return answer

    return shelve


def wrong_answers(id: str) -> tuple[Answer, ...]:
    """Return the wrong answers to an exercise."""
    return tuple(_WRONG[id])


def right_answers(id: str) -> tuple[Answer, ...]:
    """Return the right answers to an exercise, in various styles."""
    return tuple(_RIGHT[id])
