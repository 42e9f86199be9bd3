"""The course folder: everything a lecturer needs to run nbgrader on the sheets."""

from __future__ import annotations

import re
from importlib import resources
from pathlib import Path
from string import Template

import nbformat

from .notebook import notebook
from .sheet import Sheet, sheets

COURSE_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]*")


def create(folder: str | Path, course_id: str = "projflow", seconds_per_cell: int = 30) -> Path:
    """Lay out a course for nbgrader; nbgrader itself is not needed for it.

    The folder gets the lecturer's notebooks in ``source/``, ``nbgrader_config.py`` and a
    ``README.md`` with the commands of a term.

    Args:
        folder: where to; made if it does not exist.
        course_id: what nbgrader calls the course.
        seconds_per_cell: after so long a student's cell is interrupted and counts as wrong.

    Returns:
        The folder.

    Raises:
        FileExistsError: if there is something in the folder already, or a file in its place.
        ValueError: if the name of the course or the number of seconds cannot be used.
    """
    if not COURSE_ID.fullmatch(course_id):
        raise ValueError(f"create: {course_id!r} is no course id; use letters, digits, _ . and -")
    if int(seconds_per_cell) != seconds_per_cell or seconds_per_cell < 1:
        raise ValueError(f"create: seconds_per_cell is {seconds_per_cell}, expected 1, 2, 3, ...")
    folder = Path(folder).expanduser()
    if folder.exists() and not (folder.is_dir() and not any(folder.iterdir())):
        raise FileExistsError(f"create: {folder} is not an empty folder; name a new one")
    course = sheets()
    for sheet in course:
        place = folder / "source" / sheet.assignment
        place.mkdir(parents=True)
        nbformat.write(notebook(sheet), place / f"{sheet.notebook}.ipynb")
    words = {"course_id": course_id, "seconds": str(int(seconds_per_cell)), "sheets": _list(course)}
    for name in ("nbgrader_config.py", "README.md"):
        template = resources.files(__package__) / "handout" / f"{name}.template"
        text = Template(template.read_text(encoding="utf-8")).substitute(words)
        (folder / name).write_text(text, encoding="utf-8")
    return folder


def _list(course: list[Sheet]) -> str:
    """Return the sheets as a table in Markdown."""
    rows = [
        f"| `{sheet.assignment}` | `{sheet.notebook}.ipynb` | {sheet.points} "
        f"| {', '.join(_number(c.exercise) for c in sheet.cells if c.exercise)} |"
        for sheet in course
    ]
    return "\n".join(["| sheet | notebook | points | equations |", "|---|---|---|---|", *rows])


def _number(exercise: str) -> str:
    """Return the number of an exercise's equation."""
    return exercise.partition(":")[2]
