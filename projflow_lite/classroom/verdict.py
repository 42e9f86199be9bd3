"""What a check says about a student's function."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, repr=False, eq=False)
class Verdict:
    """Whether a function computes its equation, and if not, what is wrong where.

    It counts as true when the function is right, and prints as the words a student needs.

    Attributes:
        right: whether every case came out right.
        exercise: such as ``"projflow:7"``.
        title: what the exercise is about.
        cases: how many cases there are.
        passed: how many of them came out right.
        problem: what is wrong, in one sentence; empty if nothing is.
        mistake: the known mistake whose numbers these are; empty if none is recognised.
        hint: the exercise's first hint; empty if the function is right.
        case: name of the first case that went wrong.
        arguments: its arguments by name, to call the function with once more.
    """

    right: bool
    exercise: str
    title: str
    cases: int
    passed: int = 0
    problem: str = ""
    mistake: str = ""
    hint: str = ""
    case: str = ""
    arguments: dict[str, Any] = field(default_factory=dict)

    def __bool__(self) -> bool:
        """True if the function is right."""
        return self.right

    def __str__(self) -> str:
        """The verdict in plain text, one line per thing to know."""
        headline, *details = self._lines()
        return "\n".join([f"{headline[0]}: {headline[1]}", *(f"{k}: {v}" for k, v in details)])

    __repr__ = __str__

    def _repr_markdown_(self) -> str:
        """The same for a notebook."""
        mark = "✓" if self.right else "✗"
        lines = [f"**{word}** — {_as_it_is(sentence)}" for word, sentence in self._lines()]
        return f"{mark} " + "\n\n".join(lines)

    def _lines(self) -> list[tuple[str, str]]:
        """Return pairs of a word and a sentence; the first pair is the verdict itself."""
        if self.right:
            return [("Right", f"{self.exercise}, {self.title} ({self.cases} cases)")]
        lines = [("Not yet", f"{self.exercise}, {self.title}: {self.problem}")]
        if self.mistake:
            lines.append(("Known mistake with exactly these numbers", self.mistake))
        if self.hint:
            lines.append(("Hint", self.hint))
        return lines


def _as_it_is(sentence: str) -> str:
    """Keep Markdown from reading more into a sentence: a student's error may quote anything."""
    return re.sub(r"([\\<*_$])", r"\\\1", sentence)
