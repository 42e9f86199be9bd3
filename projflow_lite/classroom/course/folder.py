"""The course folder: everything a lecturer needs to run nbgrader on the sheets."""

from __future__ import annotations

import re
from collections.abc import Iterable
from importlib import resources
from pathlib import Path
from string import Template
from typing import NamedTuple

import nbformat
from nbformat import NotebookNode

from .chapter import chapter
from .notebook import notebook
from .sheet import sheets

COURSE_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]*")


class Assignment(NamedTuple):
    """What students hand in at once.

    Attributes:
        name: what nbgrader calls it.
        file: name of its notebook.
        source: the lecturer's version of that.
        points: to be had.
        exercises: what is checked, such as ``"projflow:7"``.
    """

    name: str
    file: str
    source: NotebookNode
    points: int
    exercises: list[str]


def create(
    folder: str | Path,
    course_id: str = "projflow",
    seconds_per_cell: int = 30,
    chapters: Iterable[str | Path] = (),
) -> Path:
    """Lay out a course for nbgrader; nbgrader itself is not needed for it.

    The folder gets the lecturer's notebooks in ``source/``, ``nbgrader_config.py`` and a
    ``README.md`` with the commands of a term.

    Args:
        folder: where to; made if it does not exist.
        course_id: what nbgrader calls the course.
        seconds_per_cell: after so long a student's cell is interrupted and counts as wrong.
        chapters: tutorial notebooks with exercises, such as
            ``["notebooks/02_the_projection.ipynb"]``: assignments beside the sheets.

    Returns:
        The folder.

    Raises:
        FileExistsError: if there is something in the folder already, or a file in its place.
        FileNotFoundError: if a chapter does not exist.
        ValueError: if the name of the course, the number of seconds or a chapter cannot be used.
    """
    if not COURSE_ID.fullmatch(course_id):
        raise ValueError(f"create: {course_id!r} is no course id; use letters, digits, _ . and -")
    if int(seconds_per_cell) != seconds_per_cell or seconds_per_cell < 1:
        raise ValueError(f"create: seconds_per_cell is {seconds_per_cell}, expected 1, 2, 3, ...")
    folder = Path(folder).expanduser()
    if folder.exists() and not (folder.is_dir() and not any(folder.iterdir())):
        raise FileExistsError(f"create: {folder} is not an empty folder; name a new one")
    course = _assignments(chapters)
    for assignment in course:
        place = folder / "source" / assignment.name
        place.mkdir(parents=True)
        nbformat.write(assignment.source, place / assignment.file)
    words = {"course_id": course_id, "seconds": str(int(seconds_per_cell)), "table": _table(course)}
    for name in ("nbgrader_config.py", "README.md"):
        template = resources.files(__package__) / "handout" / f"{name}.template"
        text = Template(template.read_text(encoding="utf-8")).substitute(words)
        (folder / name).write_text(text, encoding="utf-8")
    return folder


def _assignments(chapters: Iterable[str | Path]) -> list[Assignment]:
    """Return the sheets, then the chapters."""
    course = []
    for sheet in sheets():
        checked = [cell.exercise for cell in sheet.cells if cell.exercise]
        file = f"{sheet.notebook}.ipynb"
        course.append(Assignment(sheet.assignment, file, notebook(sheet), sheet.points, checked))
    for made in map(chapter, chapters):
        name, checked = made.name, [exercise.id for exercise in made.exercises]
        if name in [assignment.name for assignment in course]:
            raise ValueError(f"create: two assignments would be called {name!r}; rename one file")
        course.append(Assignment(name, f"{name}.ipynb", made.notebook, made.points, checked))
    return course


def _table(course: list[Assignment]) -> str:
    """Return the assignments as a table in Markdown."""
    rows = [
        f"| `{assignment.name}` | `{assignment.file}` | {assignment.points} "
        f"| {', '.join(id.partition(':')[2] for id in assignment.exercises)} |"
        for assignment in course
    ]
    return "\n".join(["| assignment | notebook | points | equations |", "|---|---|---|---|", *rows])
