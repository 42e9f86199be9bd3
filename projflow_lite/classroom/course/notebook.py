"""A sheet as a notebook with the metadata that nbgrader reads."""

from __future__ import annotations

from typing import Any

import nbformat
from nbformat import NotebookNode

from .sheet import Cell, Sheet

HIDDEN_SEED = 20_000
"""Hidden tests repeat the check with cases that the student's own run has not drawn."""

TEST = """\
# {points}
from projflow_lite.classroom import check

verdict = check("{exercise}", {function})
print(verdict)
assert verdict, "{function} is not right yet: the lines above say what is wrong"
### BEGIN HIDDEN TESTS
{hidden}assert check("{exercise}", {function}, seed={seed}), "wrong for other numbers"
### END HIDDEN TESTS"""

KERNEL = {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"}

FLAGS = {
    "text": {"locked": True, "solution": False, "grade": False},
    "setup": {"locked": True, "solution": False, "grade": False},
    "answer": {"locked": False, "solution": True, "grade": False},
    "test": {"locked": True, "solution": False, "grade": True},
    "written": {"locked": False, "solution": True, "grade": True},
}
"""What nbgrader does with each role: restore it, empty it, mark it. ``play`` is left alone."""


def notebook(sheet: Sheet) -> NotebookNode:
    """Return the lecturer's version of a sheet, with solutions and hidden tests.

    Args:
        sheet: from `sheets` or `read_sheet`.
    """
    cells = [_notebook_cell(cell) for cell in sheet.cells]
    metadata = {"kernelspec": KERNEL, "language_info": {"name": "python"}}
    whole = nbformat.v4.new_notebook(cells=cells, metadata=metadata)
    nbformat.validate(whole)
    return whole


def check_source(exercise: str, function: str, points: int, hidden: str = "") -> str:
    """Return the lecturer's test of one function.

    Args:
        exercise: what is checked, such as ``"projflow:7"``.
        function: name of the student's function.
        points: what the test is worth.
        hidden: code of further hidden tests, with its line end.
    """
    return TEST.format(
        points=f"{points} point{'s' if points > 1 else ''}",
        exercise=exercise,
        function=function,
        hidden=hidden,
        seed=HIDDEN_SEED,
    )


def _notebook_cell(cell: Cell) -> NotebookNode:
    """Return one cell with its metadata; the name is also the identity, so files stay the same."""
    kind = "markdown" if cell.role in ("text", "written") else "code"
    new = nbformat.v4.new_markdown_cell if kind == "markdown" else nbformat.v4.new_code_cell
    made = new(_source(cell), id=cell.name)
    if cell.role in FLAGS:
        made.metadata["nbgrader"] = _nbgrader(cell, kind)
    return made


def _source(cell: Cell) -> str:
    """Return what the lecturer's cell says."""
    if cell.role == "written":
        return f"### BEGIN SOLUTION\n{cell.body}\n### END SOLUTION"
    if cell.role != "test":
        return cell.body
    function = cell.name.removeprefix("test_")
    hidden = f"import numpy as np\n\n{cell.body}\n"
    return check_source(cell.exercise, function, cell.points, hidden)


def _nbgrader(cell: Cell, kind: str) -> dict[str, Any]:
    """Return nbgrader's own metadata, version 3 of its schema."""
    metadata = {"grade_id": cell.name, "schema_version": 3, "task": False, "cell_type": kind}
    metadata |= FLAGS[cell.role]
    return metadata | ({"points": cell.points} if FLAGS[cell.role]["grade"] else {})
