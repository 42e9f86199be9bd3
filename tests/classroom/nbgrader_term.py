"""A course in a folder of its own, and nbgrader with nothing of this machine's set-up."""

import copy
import csv
import os
import re
import subprocess
import sys

import nbformat
from nbgrader.api import Gradebook

from projflow_lite.classroom import course


class Term:
    """A course that sheets or chapters are released from, handed in to and marked in."""

    def __init__(self, folder, seconds_per_cell=10, chapters=()):
        self.course = course.create(
            folder / "course", seconds_per_cell=seconds_per_cell, chapters=chapters
        )
        home = folder / "home"
        home.mkdir()
        closed = "http://127.0.0.1:9"  # nobody listens there
        self.environment = {
            **os.environ,
            "HOME": str(home),
            "IPYTHONDIR": str(home / "ipython"),
            "JUPYTER_CONFIG_DIR": str(home / "config"),
            "JUPYTER_DATA_DIR": str(home / "data"),
            "JUPYTER_RUNTIME_DIR": str(home / "runtime"),
            "OMP_NUM_THREADS": "1",
            "http_proxy": closed,
            "https_proxy": closed,
        }

    def nbgrader(self, *words):
        done = subprocess.run(
            [sys.executable, "-m", "nbgrader", *words],
            cwd=self.course,
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert done.returncode == 0, done.stderr[-3000:]

    def path(self, stage, assignment):
        """The one notebook of an assignment."""
        (path,) = (self.course / stage / assignment).glob("*.ipynb")
        return path

    def read(self, stage, assignment):
        return nbformat.read(self.path(stage, assignment), as_version=4)

    def cells(self, stage, assignment):
        """The cells that nbgrader knows, by name."""
        cells = self.read(stage, assignment).cells
        known = [cell for cell in cells if "nbgrader" in cell.metadata]
        return {cell.metadata.nbgrader.grade_id: cell for cell in known}

    def hand_in(self, student, assignment, answers, deleted=()):
        """Fill answers into the notebook that was handed out, by the name of the cell."""
        notebook = copy.deepcopy(self.read("release", assignment))
        cells = {cell.metadata.get("nbgrader", {}).get("grade_id"): cell for cell in notebook.cells}
        for name, source in answers.items():
            cells[name].source = source
        notebook.cells = [cell for cell in notebook.cells if cell.id not in deleted]
        place = self.course / "submitted" / student / assignment
        place.mkdir(parents=True)
        nbformat.write(notebook, place / self.path("release", assignment).name)

    def solutions(self, assignment):
        """The lecturer's answers, as a student would have written them."""
        return {
            name: re.sub(r" *### (BEGIN|END) SOLUTION\n?", "", cell.source)
            for name, cell in self.cells("source", assignment).items()
            if cell.metadata.nbgrader.solution
        }

    def gradebook(self):
        return Gradebook(f"sqlite:///{self.course / 'gradebook.db'}", "projflow")

    def lost(self, student, assignment):
        """Names of the cells without points; none of them may wait for a person."""
        with self.gradebook() as book:
            submission = book.find_submission(assignment, student)
            grades = [grade for notebook in submission.notebooks for grade in notebook.grades]
            assert not any(grade.needs_manual_grade for grade in grades)
            return {grade.name for grade in grades if not grade.score}

    def exported(self):
        """The lines of the file of marks."""
        self.nbgrader("export", "--to", "grades.csv")
        with open(self.course / "grades.csv", newline="") as file:
            return list(csv.DictReader(file))
