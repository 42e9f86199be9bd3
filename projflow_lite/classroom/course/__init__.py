"""A course of three sheets for nbgrader, and how to lay it out for a class.

>>> from projflow_lite.classroom import course
>>> course.create("my_course")             # a folder that nbgrader works with

The sheets are plain text in ``sheets/``; nobody edits a notebook by hand.
"""

from .folder import create
from .notebook import notebook
from .sheet import Cell, Sheet, read_sheet, sheets

__all__ = ["Cell", "Sheet", "create", "notebook", "read_sheet", "sheets"]
