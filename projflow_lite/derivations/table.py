"""The findings as text, in at most a hundred columns."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Sequence
from itertools import groupby

from .registry import PROJFLOW, PrintedRow, Row

TEXT = 64
AS_PRINTED = "As printed or released: what is expected NOT to hold, and how far off it is"


def table(rows: Sequence[Row], as_printed: Sequence[PrintedRow] = ()) -> str:
    """Write the findings as an aligned table that ends with a summary.

    Each equation has a line with its number and title, and below it one entry per derivation.
    Rows of another paper than ProjFlow come in a section under its name.

    Args:
        rows: from `run`; of several papers, one after the other.
        as_printed: from `run_as_printed`; sections of its own, before the summary.

    Returns:
        The text, without a line break at its end.
    """
    lines = [_columns("eq.", "", "deviation", "at most", "seconds", "")]
    for paper, of_paper in groupby(rows, key=lambda row: row.paper):
        lines += [] if paper == PROJFLOW else ["", paper]
        for _, entries in groupby(of_paper, key=lambda row: row.equation):
            lines += _derived(list(entries))
    if as_printed:
        lines += ["", AS_PRINTED, _columns("eq.", "", "deviation", "more than", "seconds", "")]
    for paper, as_in_paper in groupby(as_printed, key=lambda row: row.paper):
        lines += [] if paper == PROJFLOW else ["", paper]
        for _, found in groupby(as_in_paper, key=lambda row: row.equation):
            lines += _printed(list(found))
    lines += ["", *([printed_summary(as_printed)] if as_printed else []), summary(rows)]
    return "\n".join(line.rstrip() for line in lines)


def summary(rows: Sequence[Row]) -> str:
    """Say how many equations were derived how often, how closely, and whether all hold.

    Args:
        rows: from `run`.
    """
    counted = f"{_count(rows, 'derivation')}, {sum(row.seconds for row in rows):.1f} seconds"
    if not rows:
        return f"{counted}; nothing was derived."
    failed = _named([row for row in rows if not row.holds])
    worst = max(rows, key=_strain)
    named = ", ".join(failed)
    verdict = f"{named} {'DOES' if len(failed) == 1 else 'DO'} NOT HOLD" if failed else "all hold"
    return (
        f"{counted}; largest deviation {_strain(worst):.2g} of its tolerance "
        f"({_named([worst])[0]}, {_number(worst.deviation)}); {verdict}."
    )


def printed_summary(rows: Sequence[PrintedRow]) -> str:
    """Say how many printed or released forms were tried, and whether each deviates as expected.

    Args:
        rows: from `run_as_printed`.
    """
    failed = _named([row for row in rows if not row.deviates])
    verdict = f"not so {', '.join(failed)}" if failed else "all deviate"
    return f"As printed or released: {_count(rows, 'counterexample')}; {verdict}."


def plain(rows: Sequence[Row] | Sequence[PrintedRow]) -> list[dict]:
    """Return rows as dictionaries that JSON can hold: an infinite deviation becomes None.

    Args:
        rows: from `run` or `run_as_printed`.
    """
    found = [row._asdict() for row in rows]
    for row in found:
        row["deviation"] = row["deviation"] if math.isfinite(row["deviation"]) else None
    return found


def _derived(entries: list[Row]) -> Iterator[str]:
    """Lines of one equation's derivations."""
    yield f"{entries[0].equation:>4}  {entries[0].title}"
    for row in entries:
        bound = _number(row.tolerance) if row.tolerance else "exact"
        mark = "" if row.holds else "DOES NOT HOLD"
        yield from _entry(row.method, row, bound, mark)


def _printed(entries: list[PrintedRow]) -> Iterator[str]:
    """Lines of one equation's counterexamples."""
    yield f"{entries[0].equation:>4}  {entries[0].title}"
    for row in entries:
        mark = "" if row.deviates else "DOES NOT DEVIATE"
        yield from _entry(row.what, row, _number(row.more_than), mark)


def _entry(text: str, row: Row | PrintedRow, bound: str, mark: str) -> Iterator[str]:
    """One entry: numbers stand beside the first line of its text."""
    first, *more = textwrap.wrap(text, TEXT - 2)
    numbers = (_number(row.deviation), bound, f"{row.seconds:.2f}", mark)
    yield _columns("", f"  {first}", *numbers)
    yield from (_columns("", f"  {line}", "", "", "", "") for line in more)
    if row.problem:
        yield _columns("", f"  stopped by {row.problem}", "", "", "", "")


def _columns(number: str, text: str, deviation: str, bound: str, seconds: str, mark: str) -> str:
    """Place one line's cells under those of the other lines."""
    return f"{number:>4}  {text:<{TEXT}} {deviation:>9} {bound:>9} {seconds:>7} {mark}"


def _count(rows: Sequence[Row] | Sequence[PrintedRow], noun: str) -> str:
    """Say how many equations and how many rows there are."""
    equations = len({(row.paper, row.equation) for row in rows})
    return (
        f"{equations} equation{'s' * (equations != 1)}, {len(rows)} {noun}{'s' * (len(rows) != 1)}"
    )


def _named(rows: Sequence[Row] | Sequence[PrintedRow]) -> list[str]:
    """Name the equations of these rows, each once, in their order; those of ProjFlow as "eq."."""
    names = (f"{'eq.' if row.paper == PROJFLOW else row.paper} {row.equation}" for row in rows)
    return list(dict.fromkeys(names))


def _strain(row: Row) -> float:
    """Deviation as a multiple of its tolerance; infinite where nothing could be compared."""
    if math.isnan(row.deviation):
        return math.inf
    if row.tolerance == 0:
        return 0.0 if row.deviation == 0 else math.inf
    return row.deviation / row.tolerance


def _number(value: float) -> str:
    """Write a number with two digits, or say that there is none."""
    if value == 0:
        return "0"
    return f"{value:.2g}" if math.isfinite(value) else "no value"
