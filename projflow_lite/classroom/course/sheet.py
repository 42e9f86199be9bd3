r"""Exercise sheets as plain text, read into cells.

A sheet is a Markdown file. Text becomes locked text cells, one per heading. A fence whose first
line has a *role* becomes a cell of its own:

.. code-block:: text

    ```python setup NAME               code that everybody runs and nobody edits
    ```python play NAME                code to play with, worth nothing
    ```python answer NAME              the student's function; its solution between
                                       ### BEGIN SOLUTION and ### END SOLUTION
    ```python test ID NAME POINTS      the check of that function, such as `test projflow:7
                                       project 3`; the fence holds the hidden tests
    ```markdown written NAME POINTS    a question marked by a person; the fence holds the
                                       lecturer's solution

Fences without a role stay part of the text.
"""

from __future__ import annotations

import re
from importlib import resources
from typing import NamedTuple

FENCE = re.compile(
    r"^```(?:python|markdown) (?P<role>\w+) (?P<words>[^\n]+)\n(?P<body>.*?)^```$", re.M | re.S
)
WORDS = {"setup": 1, "play": 1, "answer": 1, "test": 3, "written": 2}
"""Roles, and how many words follow each."""


class Cell(NamedTuple):
    """One cell of a sheet.

    Attributes:
        role: ``"text"``, ``"setup"``, ``"play"``, ``"answer"``, ``"test"`` or ``"written"``.
        name: unique within the sheet.
        body: what is written in it.
        points: what it is worth; 0 but for tests and written questions.
        exercise: what a test checks, such as ``"projflow:7"``.
    """

    role: str
    name: str
    body: str
    points: int = 0
    exercise: str = ""


class Sheet(NamedTuple):
    """An exercise sheet.

    Attributes:
        assignment: what nbgrader calls it, such as ``"sheet2"``.
        notebook: name of its notebook without ending, such as ``"the_projection"``.
        cells: from top to bottom.
    """

    assignment: str
    notebook: str
    cells: list[Cell]

    @property
    def points(self) -> int:
        """Points to be had."""
        return sum(cell.points for cell in self.cells)


def sheets() -> list[Sheet]:
    """Return the sheets of the course, in order."""
    folder = resources.files(__package__) / "sheets"
    files = sorted((f for f in folder.iterdir() if f.name.endswith(".md")), key=lambda f: f.name)
    return [read_sheet(f.name.removesuffix(".md"), f.read_text(encoding="utf-8")) for f in files]


def read_sheet(name: str, text: str) -> Sheet:
    """Read a sheet from its text.

    Args:
        name: assignment and notebook, such as ``"sheet2_the_projection"``.
        text: as the head of this file describes it.

    Raises:
        ValueError: if a fence has an unknown role or the wrong words after it, or two cells
            share a name.
    """
    assignment, _, notebook = name.partition("_")
    cells: list[Cell] = []
    end = 0
    for fence in FENCE.finditer(text):
        cells += _text_cells(text[end : fence.start()], len(cells))
        cells.append(_cell(name, fence["role"], fence["words"].split(), fence["body"].rstrip()))
        end = fence.end()
    cells += _text_cells(text[end:], len(cells))
    names = [cell.name for cell in cells]
    for twice in {n for n in names if names.count(n) > 1}:
        raise ValueError(f"{name}: two cells are called {twice!r}; rename one")
    return Sheet(assignment, notebook, cells)


def _text_cells(text: str, before: int) -> list[Cell]:
    """Cut text into cells at its headings of second order."""
    parts = [part.strip() for part in re.split(r"^(?=## )", text, flags=re.M)]
    return [Cell("text", f"text_{before + k}", part) for k, part in enumerate(filter(None, parts))]


def _cell(sheet: str, role: str, words: list[str], body: str) -> Cell:
    """Make the cell of one fence."""
    if len(words) != WORDS.get(role):
        raise ValueError(f"{sheet}: '{role} {' '.join(words)}' does not open a cell; see sheet.py")
    if role == "test":
        return Cell(role, f"test_{words[1]}", body, int(words[2]), words[0])
    return Cell(role, words[0], body, int(words[1]) if role == "written" else 0)
