"""A course of three sheets for nbgrader, and how to lay it out for a class.

>>> from projflow_lite.classroom import course
>>> course.create("my_course")             # a folder that nbgrader works with
>>> course.create("another", chapters=["notebooks/02_the_projection.ipynb"])

The sheets are plain text in ``sheets/``; nobody edits a notebook by hand. The tutorial notebooks
can be assignments as well: `chapter` makes the lecturer's version of one, with its answers moved to
where nbgrader removes them.
"""

from .chapter import Chapter, chapter
from .folder import create
from .notebook import notebook
from .sheet import Cell, Sheet, read_sheet, sheets

__all__ = ["Cell", "Chapter", "Sheet", "chapter", "create", "notebook", "read_sheet", "sheets"]
