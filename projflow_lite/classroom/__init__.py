"""The classroom: checks of a student's own implementation, hints, answers, and their proof.

>>> from projflow_lite.classroom import check
>>> check("projflow:7", my_project)        # in a notebook, as the last line of a cell

`mutation_score` proves that the checks can fail: every wrong answer of the bank is caught.
"""

from .answers import answer
from .checking import check
from .mutation import mutation_score, report, run
from .shelf import exercises, hint
from .verdict import Verdict

__all__ = [
    "Verdict",
    "answer",
    "check",
    "exercises",
    "hint",
    "mutation_score",
    "report",
    "run",
]
