"""The shape of a catalog record."""

from __future__ import annotations

from typing import NamedTuple


class Record(NamedTuple):
    """One printed equation.

    Attributes:
        paper: short name of the paper.
        number: as printed; for an equation without a number, its section and a letter.
        title: what it says, in a few words.
        latex: the formula.
        function: dotted name of the function, empty while there is none.
        check: dotted name of the test that checks it from outside, empty while there is none.
        status: ``"checked"`` or ``"open"``.
        erratum: what is wrong or open to mistake in print or in the public code, or empty.
    """

    paper: str
    number: str
    title: str
    latex: str
    function: str = ""
    check: str = ""
    status: str = "open"
    erratum: str = ""


def projflow(
    number: int, title: str, latex: str, function: str, check: str, erratum: str = ""
) -> Record:
    """Return a checked ProjFlow record, from short names of its function and its test."""
    return Record(
        "ProjFlow",
        str(number),
        title,
        latex,
        f"projflow_lite.equations.{function}",
        f"tests.equations.{check}",
        "checked",
        erratum,
    )
