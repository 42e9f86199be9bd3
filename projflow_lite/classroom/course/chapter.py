"""A tutorial notebook as an assignment: its own answers become the solutions of the lecturer.

The exercises of a tutorial lie there with nbgrader's metadata: a cell with a function to write, and
below it a cell with nothing but its `check`. The answers, though, are folded into the text below,
for those who learn by themselves. Here they move to where nbgrader removes them on release.
"""

from __future__ import annotations

import ast
import re
import textwrap
from pathlib import Path
from typing import Any, NamedTuple

import nbformat
from nbformat import NotebookNode

from .notebook import check_source

CHECK = re.compile(r'check\("(?P<id>\w+:\w+)", (?P<function>\w+)\)')
STUB = re.compile(r"^(?P<indent>[ \t]+)\.\.\.(?:[ \t]*(?P<note>#.*))?$", re.M)
ANSWER = re.compile(
    r"<details>\s*<summary>(?:One|An) answer\b[^<]*</summary>(?P<inside>.*?)</details>\n*", re.S
)
FENCE = re.compile(r"^```python\n(.*?)^```$", re.M | re.S)
FILE_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]*")


class Exercise(NamedTuple):
    """An exercise of a tutorial notebook.

    Attributes:
        id: what is checked, such as ``"projflow:7"``.
        function: name of the student's function.
        answer: the cell in which it is written.
        test: the cell that checks it.
    """

    id: str
    function: str
    answer: NotebookNode
    test: NotebookNode

    @property
    def points(self) -> int:
        """What it is worth."""
        return _marked(self.test, "points")


class Chapter(NamedTuple):
    """A tutorial notebook, ready for nbgrader.

    Attributes:
        name: of the assignment and of its notebook, such as ``"02_the_projection"``.
        notebook: the lecturer's version, with solutions and hidden tests.
        exercises: from top to bottom.
    """

    name: str
    notebook: NotebookNode
    exercises: list[Exercise]

    @property
    def points(self) -> int:
        """Points to be had."""
        return sum(exercise.points for exercise in self.exercises)


def chapter(path: str | Path) -> Chapter:
    """Make the lecturer's version of a tutorial notebook; the file itself stays as it is.

    Args:
        path: such as ``"notebooks/02_the_projection.ipynb"``.

    Raises:
        FileNotFoundError: if there is no such file.
        ValueError: if it is no notebook, has no exercises, or one of them has no answer.
    """
    path = Path(path).expanduser()
    if not FILE_NAME.fullmatch(path.stem):
        raise ValueError(
            f"chapter: {path.name!r} gives no name to an assignment; "
            "rename it, with letters, digits, _ . and -"
        )
    whole = _read(path)
    exercises = _exercises(path.name, whole.cells)
    solutions = _cut_answers(path.name, whole.cells, exercises)
    for exercise in exercises:
        if exercise.function not in solutions:
            raise ValueError(
                f"chapter: {path.name} has no answer to {exercise.function}; below its check, add "
                "<details><summary>One answer</summary> with a ```python block, and </details>"
            )
        exercise.answer.source = _solved(path.name, exercise, solutions[exercise.function])
        exercise.test.source = check_source(exercise.id, exercise.function, exercise.points)
    whole.cells = [cell for cell in whole.cells if cell.source]  # some text was an answer only
    return Chapter(path.stem, whole, exercises)


def _read(path: Path) -> NotebookNode:
    """Read a notebook, and make sure that it is one."""
    if not path.is_file():
        raise FileNotFoundError(f"chapter: there is no file {path}; name a notebook (.ipynb)")
    try:
        whole = nbformat.reads(path.read_text(encoding="utf-8"), as_version=4)
        nbformat.validate(whole)
    except Exception:  # nbformat has many words for it
        raise ValueError(f"chapter: {path} is no notebook; name a file of Jupyter's") from None
    return whole


def _exercises(name: str, cells: list[NotebookNode]) -> list[Exercise]:
    """Find the exercises by nbgrader's metadata."""
    answers = [cell for cell in cells if _marked(cell, "solution")]
    found = []
    for test in (cell for cell in cells if _marked(cell, "grade")):
        call = CHECK.fullmatch(test.source.strip())
        if not call:
            raise ValueError(
                f"chapter: in {name} the cell {_marked(test, 'grade_id')!r} is graded, but "
                'is not a check by itself; write check("projflow:7", function), and no more'
            )
        function = call["function"]
        answer = next((cell for cell in answers if f"def {function}(" in cell.source), None)
        if answer is None:
            raise ValueError(
                f"chapter: in {name} no cell asks for {function}; mark the one with its def as "
                "nbgrader's autograded answer"
            )
        found.append(Exercise(call["id"], function, answer, test))
    if not found:
        raise ValueError(
            f"chapter: {name} has no exercises that nbgrader could grade; mark cells with a check "
            "as its autograder tests, or leave this notebook out"
        )
    return found


def _marked(cell: NotebookNode, key: str) -> Any:
    """Return what nbgrader's metadata say of a cell; None if they do not."""
    return cell.metadata.get("nbgrader", {}).get(key)


def _cut_answers(name: str, cells: list[NotebookNode], exercises: list[Exercise]) -> dict[str, str]:
    """Cut the answers out of the text below the checks; return the bodies of the functions."""
    found: dict[str, str] = {}
    above: list[str] = []
    for cell in cells:
        above += [exercise.function for exercise in exercises if exercise.test is cell]
        if cell.cell_type != "markdown":
            continue
        for block in ANSWER.finditer(cell.source):
            asked = [function for function in above if function not in found]
            bodies = _bodies(name, block["inside"], asked)
            if bodies:
                cell.source = cell.source.replace(block[0], "")
            found |= bodies
    return found


def _bodies(name: str, text: str, asked: list[str]) -> dict[str, str]:
    """Read the bodies of functions from an answer.

    A block may define the functions, or show a body only; these are in the order of the exercises.
    """
    bodies: dict[str, str] = {}
    alone = []
    for fence in FENCE.findall(text):
        try:
            parts = ast.parse(fence).body
        except SyntaxError as error:
            raise ValueError(f"chapter: an answer in {name} is no Python: {error.msg}") from None
        defined = [p for p in parts if isinstance(p, ast.FunctionDef) and p.name in asked]
        if defined and len(defined) < len(parts):
            raise ValueError(
                f"chapter: the answer to {defined[0].name} in {name} has code outside of the "
                "function; move it inside"
            )
        bodies |= {function.name: _body(fence, function) for function in defined}
        alone += [] if defined else [fence.rstrip()]
    left = [function for function in asked if function not in bodies]
    return bodies | dict(zip(left, alone, strict=False))


def _body(source: str, function: ast.FunctionDef) -> str:
    """Return what a function does, from its first statement on."""
    first = function.body[0]
    lines = source.splitlines()[first.lineno - 1 : function.end_lineno]
    lines[0] = " " * first.col_offset + lines[0][first.col_offset :]  # without "def f(x): "
    return textwrap.dedent("\n".join(lines))


def _solved(name: str, exercise: Exercise, body: str) -> str:
    """Return the cell of an answer with its solution in place of the dots."""
    dots = STUB.search(exercise.answer.source)
    if not dots:
        raise ValueError(
            f"chapter: in {name} the cell of {exercise.function} has no line of three dots; "
            "leave ... where the student is to write"
        )
    note = [dots["note"]] if dots["note"] else []
    lines = [*note, "### BEGIN SOLUTION", body, "### END SOLUTION"]
    written = textwrap.indent("\n".join(lines), dots["indent"])
    return exercise.answer.source[: dots.start()] + written + exercise.answer.source[dots.end() :]
