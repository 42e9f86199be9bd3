"""The study of equal time as a table, and what it says in sentences.

A method is *ahead* of ProjFlow in a score if the 95 % interval of their difference over seeds
excludes 0 on its side, *behind* if on the other, and else *undecided*. It may be ahead because it
does not go where it was asked to go: so what it misses by is said beside it.
"""

from __future__ import annotations

from typing import Any

from projflow_lite.studies.cells import ALL
from projflow_lite.studies.claims import difference_of, line_of, shown, verdict
from projflow_lite.studies.control_tuning import NEAR
from projflow_lite.studies.control_ways import FREE
from projflow_lite.studies.sensitivity_sweeps import USUAL

BUDGET, COUNT, RATIO = "budget", "count", "ratio"

SHOWN = (
    "trajectory error", "location error", "average error", "residual", "FID", "kinetic distance",
    "skating gmd", "bone error %", "worst acceleration",
)  # fmt: skip
"""Columns of the table."""

JUDGED = ("FID", "kinetic distance")
"""Less is better in both; the second sees torn bodies, which the first hardly does."""

OVER = 1.25
"""A method whose least count takes more than so many times the budget does not fit into it."""

WIDTH = 38
"""Of the names of rows."""

Row = dict[str, Any]


def averages(rows: list[Row], budget: int) -> dict[str, Row]:
    """The rows over joints and densities in one time, by the name of the method."""
    own = [row for row in rows if row.get(BUDGET) == budget]
    return {r["method"]: r for r in own if (r["joint"], r["keys"]) == ("average", ALL)}


def budgets(rows: list[Row]) -> list[int]:
    """The times that were measured."""
    return list(dict.fromkeys(row[BUDGET] for row in rows if BUDGET in row))


def miss(row: Row) -> str:
    """How far a method is from its keyframes, in words."""
    error = row["scores"]["average error"]["mean"]
    return "exact" if error < 1e-5 else f"misses by {error:.3f} m"


def of_budget(rows: list[Row], budget: int, column: str) -> str | None:
    """Who is ahead of ProjFlow in one score, in one time?"""
    found = averages(rows, budget)
    own = found.get(USUAL.name)
    others = [row for name, row in found.items() if name not in (USUAL.name, FREE.name)]
    if own is None or not others:
        return None
    groups: dict[str, list[str]] = {"reproduced": [], "not reproduced": [], "undecided": []}
    for row in others:
        difference = difference_of(row["scores"][column], own["scores"][column])
        groups[verdict(difference)].append(
            f"{row['method']} ({difference.mean:+.3g} ± {difference.half_width:.2g}, {miss(row)})"
        )
    words = zip(("ahead of it", "behind it", "undecided"), groups.values(), strict=True)
    parts = [f"{word}: {', '.join(names)}" for word, names in words if names]
    return (
        f"{column} in {spelled(budget)} of ProjFlow, which is {own[COUNT]} steps of its own "
        f"and {shown(own['scores'][column])}; {'; '.join(parts)}."
    )


def spelled(budget: int) -> str:
    """A time in words."""
    return {1: "the time", 2: "twice the time", 4: "four times the time"}.get(
        budget, f"{budget} times the time"
    )


def of_more_time(rows: list[Row], column: str) -> str | None:
    """Who makes something of more time?"""
    least, most = min(budgets(rows), default=1), max(budgets(rows), default=1)
    first, last = averages(rows, least), averages(rows, most)
    parts = []
    for name in (name for name in first if name in last):
        difference = difference_of(*(row[name]["scores"][column] for row in (last, first)))
        said = {"reproduced": "better", "not reproduced": "worse"}.get(verdict(difference))
        end = said or "undecided"
        parts.append(f"{name} {difference.mean:+.3g} ± {difference.half_width:.2g} ({end})")
    if least == most or not parts:
        return None
    return f"{column}, {spelled(most)} less {spelled(least)}: {', '.join(parts)}."


def of_fit(rows: list[Row]) -> str | None:
    """Which methods do not fit, however little of them is done?"""
    late = [
        f"{name} in {spelled(budget)} (takes {row[RATIO]:.2g} times ProjFlow's with {row[COUNT]} "
        f"{row['counted']})"
        for budget in budgets(rows)
        for name, row in averages(rows, budget).items()
        if row[RATIO] > OVER * budget
    ]
    if not budgets(rows):
        return None
    who = ", ".join(late) if late else "no method"
    return f"Longer than their time by more than a quarter: {who}."


def of_near(rows: list[Row]) -> str | None:
    """Which methods come near their keyframes, and from which time on?"""
    parts: dict[str, int] = {}
    for budget in budgets(rows):
        for name, row in averages(rows, budget).items():
            if row["scores"]["average error"]["mean"] <= NEAR:
                parts.setdefault(name, budget)
    if not budgets(rows):
        return None
    said = [f"{name} ({spelled(budget)})" for name, budget in parts.items()]
    return (
        f"Within {100 * NEAR:g} cm of their keyframes on average, and the least time in which they "
        f"are: {', '.join(said) if said else 'none'}."
    )


def sentences(rows: list[Row]) -> list[str]:
    """What the rows say, time by time."""
    said = [of_fit(rows), of_near(rows)]
    said += [of_budget(rows, budget, column) for budget in budgets(rows) for column in JUDGED]
    said += [of_more_time(rows, column) for column in JUDGED]
    return [sentence for sentence in said if sentence]


def table(rows: list[Row]) -> str:
    """Text: for every time a line a method, then sentences."""
    data = rows[0]
    joints = dict.fromkeys(row["joint"] for row in rows[1:] if row["joint"] != "average")
    keys = dict.fromkeys(str(row["keys"]) for row in rows[1:] if row["keys"] != ALL)
    lines = [
        f"{data['seeds']} seeds of {data['clips']} clips for every joint ({', '.join(joints)}) and "
        f"density ({', '.join(keys)}); means over both ± 95 %. Behind a method: how much of it "
        "fits, and the time that this takes, as a multiple of that of ProjFlow at "
        f"{data['steps']} steps. Errors and residual in metres.",
        "", f"{'':{WIDTH}s}" + "".join(f"{name:>20s}" for name in SHOWN),
        line_of(data, SHOWN, WIDTH),
    ]  # fmt: skip
    for budget in budgets(rows):
        lines += ["", spelled(budget)]
        for name, row in averages(rows, budget).items():
            label = f"{name}, {row[COUNT]} {row['counted']}, {row[RATIO]:.2f}"
            lines.append(line_of(row | {"method": label}, SHOWN, WIDTH))
    return "\n".join([*lines, "", *sentences(rows)])
