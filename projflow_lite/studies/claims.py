"""What a paper's table says of two methods, and whether it holds here.

Absolute numbers are of another prior, other data and another evaluator, and are not to be compared.
What can be compared is which of two methods is ahead. A claim of the paper is *reproduced* if the
difference has the paper's sign here and its 95 % interval over seeds excludes 0, *not reproduced*
if the interval excludes 0 on the other side, and else *undecided*. All methods have the same
captions, wishes and noise, so differences are more certain than the scores themselves. The paper
prints no intervals of its own, so a claim may be one of chance: many differ in the last digit.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from projflow_lite.scores import interval
from projflow_lite.scores.interval import Interval
from projflow_lite.studies.cells import ALL

TIME = "time"

EXACT = 1e-5
"""Errors below this are rounding: two methods that both stay below are not told apart."""

Rows = list[dict[str, Any]]


class Printed(NamedTuple):
    """Numbers of a paper.

    Attributes:
        columns: of its tables.
        rows: for every joint or task, and every method, a number a column; None where there is
            none.
        table: where they are printed.
        elsewhere: where the numbers of a method are printed, if not there.
    """

    columns: tuple[str, ...]
    rows: dict[str, dict[str, tuple[float | None, ...]]]
    table: str
    elsewhere: dict[str, str]

    def number(self, joint: str, method: str, column: str) -> float | None:
        """A number of the paper, or None."""
        row = self.rows.get(joint, {}).get(method)
        return None if row is None or column not in self.columns else row[self.place(column)]

    def place(self, column: str) -> int:
        """Where a column stands."""
        return self.columns.index(column)

    def source(self, *methods: str) -> str:
        """Where the numbers of methods are printed."""
        return next((self.elsewhere[m] for m in methods if m in self.elsewhere), self.table)


class Claim(NamedTuple):
    """The paper says that one method has less of something than another."""

    joint: str
    column: str
    less: str
    more: str


def claims_of(printed: Printed, columns: Sequence[str], own: str = "projflow") -> list[Claim]:
    """Everything that the table says of one method against another; ties say nothing."""
    found = []
    for joint, methods in printed.rows.items():
        for other in (name for name in methods if name != own):
            for column in columns:
                ours, theirs = (printed.number(joint, name, column) for name in (own, other))
                if ours is None or theirs is None or ours == theirs:
                    continue
                less, more = (own, other) if ours < theirs else (other, own)
                found.append(Claim(joint, column, less, more))
    return found


def verdict(difference: Interval) -> str:
    """What a difference says of a claim that it is below 0."""
    if difference.mean + difference.half_width < 0:
        return "reproduced"
    if difference.mean - difference.half_width > 0:
        return "not reproduced"
    return "undecided"


def find(rows: Rows, joint: str, method: str) -> dict[str, Any] | None:
    """The row of a method on a joint over all densities, if it was measured."""
    wanted = (joint, ALL, method)
    return next((r for r in rows if (r["joint"], r["keys"], r["method"]) == wanted), None)


def difference_of(less: dict[str, Any], more: dict[str, Any]) -> Interval:
    """One score minus another, seed by seed."""
    return interval(np.subtract(less["values"], more["values"]))


def of_claim(rows: Rows, claim: Claim, printed: Printed) -> str | None:
    """A sentence on one claim, or None if a method or joint was not measured."""
    pair = [find(rows, claim.joint, name) for name in (claim.less, claim.more)]
    if pair[0] is None or pair[1] is None:
        return None
    cells = [row["scores"][claim.column] for row in pair if row is not None]
    difference = difference_of(*cells)
    theirs = [printed.number(claim.joint, name, claim.column) for name in (claim.less, claim.more)]
    said = (
        f"{claim.joint}, {claim.column}: {claim.less} less than {claim.more} "
        f"({theirs[0]:g} and {theirs[1]:g} in {printed.source(*claim[2:])}); here "
    )
    if all(max(cell["values"]) < EXACT for cell in cells):
        return f"{said}both are exact: undecided."
    return (
        f"{said}{shown(cells[0])} and {shown(cells[1])}, difference {difference.mean:+.3g} ± "
        f"{difference.half_width:.2g}: {verdict(difference)}."
    )


def count_of(claimed: list[str]) -> str | None:
    """How many claims came out which way."""
    ends = (": reproduced.", ": not reproduced.", ": undecided.")
    yes, no, open_ = (sum(text.endswith(end) for text in claimed) for end in ends)
    if not claimed:
        return None
    return (
        f"Of {len(claimed)} claims of the paper about two methods {yes} are reproduced, {no} are "
        f"not, and {open_} are undecided:"
    )


def of_time(rows: Rows) -> str | None:
    """What every method costs."""
    last = [r for r in rows if r["joint"] == "average" and r["keys"] == ALL]
    if not last:
        return None
    cheap = sorted(last, key=lambda row: row[TIME])
    parts = [f"{row['method']} {row[TIME]:.2f}" for row in cheap if row["method"] != "no wish"]
    return f"Time, as a multiple of a sample without a wish: {', '.join(parts)}."


def block(
    rows: Rows, joint: str, columns: Sequence[str], printed: Printed, width: int = 16
) -> list[str]:
    """Lines of one joint: held-out data, then every method, the paper's numbers under it."""
    head = "".join(f"{name:>20s}" for name in columns)
    lines = ["", f"{joint:{width}s}{head}{TIME:>8s}", line_of(rows[0], columns, width)]
    for row in (r for r in rows[1:] if r["joint"] == joint and r["keys"] == ALL):
        lines.append(line_of(row, columns, width))
        if row["method"] in printed.rows.get(joint, {}):
            lines.append(paper_line(printed, joint, row["method"], columns, "  paper", width))
    return lines


def paper_line(
    printed: Printed, joint: str, method: str, columns: Sequence[str], label: str, width: int
) -> str:
    """The paper's numbers of one method, in the columns of a table."""
    numbers = (printed.number(joint, method, name) for name in columns)
    return f"{label:{width}s}" + "".join(f"{'' if v is None else f'{v:g}':>20s}" for v in numbers)


def line_of(row: dict[str, Any], columns: Sequence[str], width: int = 16) -> str:
    """One row of a table."""
    cells = (row["scores"].get(name) for name in columns)
    text = "".join(f"{shown(cell) if cell else '':>20s}" for cell in cells)
    return f"{row['method']:{width}s}{text}" + (f"{row[TIME]:8.2f}" if TIME in row else "")


def shown(cell: dict[str, Any]) -> str:
    """A mean and its interval; small ones in powers of ten."""
    if 0 < cell["mean"] < 1e-3:
        return f"{cell['mean']:.1e} ± {cell['half width']:.0e}"
    return f"{cell['mean']:.3f} ± {cell['half width']:.3f}"
