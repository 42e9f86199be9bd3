"""The study of sensitivity as a table, and what it says in sentences.

A value of a constant is *alike* to the usual one in a score if their difference, with its 95 %
interval over seeds, stays below a twentieth of that score. It is *better* or *worse* if the
interval excludes 0, and else *undecided*. All values have the same captions, keyframes and noise.
With some forty values one or two differences will be called certain by chance.
"""

from __future__ import annotations

from typing import Any

from projflow_lite.studies.claims import difference_of, find, line_of, shown, verdict
from projflow_lite.studies.fewer_steps_words import TOLERANCE
from projflow_lite.studies.sensitivity_sweeps import SWEEPS, USUAL, Sweep, spelled

JUDGED = ("kinetic distance", "FID")
"""Less is better; the first sees torn bodies, which the second hardly does."""

SHOWN = (
    "FID", "kinetic distance", "R top 3", "diversity", "skating gmd", "bone error %",
    "worst acceleration", "residual",
)  # fmt: skip

WIDTH = 20
"""Of the names of rows."""

OUTCOME = {"reproduced": "better", "not reproduced": "worse", "undecided": "undecided"}

Row = dict[str, Any]


def measured_of(rows: list[Row], sweep: Sweep) -> list[tuple[Any, Row]]:
    """The values of a constant that were measured, and their rows, without the usual one."""
    pairs = [(value, find(rows, "average", sweep.label(value))) for value in sweep.values]
    return [(value, row) for value, row in pairs if row is not None]


def judged(row: Row, usual: Row, column: str) -> str:
    """Is a row better than the usual constants, worse, alike, or undecided?"""
    difference = difference_of(row["scores"][column], usual["scores"][column])
    reach = abs(difference.mean) + difference.half_width
    if reach < TOLERANCE * usual["scores"][column]["mean"]:
        return "alike"
    return OUTCOME[verdict(difference)]


def of_sweep(rows: list[Row], sweep: Sweep, column: str) -> str | None:
    """What one constant does to one score."""
    usual, found = find(rows, "average", USUAL.name), measured_of(rows, sweep)
    if usual is None or not found:
        return None
    parts = []
    for value, row in found:
        difference = difference_of(row["scores"][column], usual["scores"][column])
        parts.append(
            f"{spelled(value)}: {difference.mean:+.3g} ± {difference.half_width:.2g}, "
            f"{judged(row, usual, column)}"
        )
    here = usual["steps"] if sweep.usual is None else sweep.usual
    as_usual = spelled(here)
    if spelled(sweep.paper) != as_usual:
        as_usual += f" (Table 5: {spelled(sweep.paper)})"
    return (
        f"{sweep.name}, {sweep.says}: {column} {shown(usual['scores'][column])} at the usual "
        f"{as_usual}; {'; '.join(parts)}."
    )


def of_all(rows: list[Row], column: str) -> str | None:
    """How many values are better than the usual ones, worse, or alike."""
    usual = find(rows, "average", USUAL.name)
    found = [row for sweep in SWEEPS for _, row in measured_of(rows, sweep)]
    if usual is None or not found:
        return None
    said = [judged(row, usual, column) for row in found]
    better = [row["method"] for row, word in zip(found, said, strict=True) if word == "better"]
    names = f" ({', '.join(better)})" if better else ""
    return (
        f"{column}: of {len(said)} values that differ from the usual ones {len(better)} are "
        f"better{names}, {said.count('worse')} are worse, {said.count('alike')} alike and "
        f"{said.count('undecided')} undecided."
    )


def of_order(rows: list[Row], column: str) -> str | None:
    """Which constant matters most, by the spread of a score over its values."""
    usual = find(rows, "average", USUAL.name)
    spreads = {}
    for sweep in SWEEPS:
        found = [row for _, row in measured_of(rows, sweep)]
        if usual is not None and found:
            means = [row["scores"][column]["mean"] for row in (usual, *found)]
            spreads[sweep.name] = max(means) / min(means)
    if not spreads:
        return None
    order = sorted(spreads, key=lambda name: -spreads[name])
    parts = ", ".join(f"{name} {spreads[name]:.2f}" for name in order)
    return f"{column}, largest over smallest among the values tried: {parts}."


def sentences(rows: list[Row]) -> list[str]:
    """What the rows say, all constants first, then one by one."""
    said = [of_all(rows, column) for column in JUDGED]
    said += [of_order(rows, column) for column in JUDGED]
    said += [of_sweep(rows, sweep, column) for sweep in SWEEPS for column in JUDGED]
    return [sentence for sentence in said if sentence]


def table(rows: list[Row]) -> str:
    """Text: a line for the data, the usual constants and every other value, then sentences."""
    data = rows[0]
    joints = dict.fromkeys(row["joint"] for row in rows[1:] if row["joint"] != "average")
    keys = dict.fromkeys(str(row["keys"]) for row in rows[1:] if row["joint"] == "average")
    lines = [
        f"{data['seeds']} seeds of {data['clips']} clips for every joint "
        f"({', '.join(joints)}) and density ({', '.join(list(keys)[:-1])}), {data['steps']} steps "
        "if nothing else is said; means over both ± 95 %. Table 5 of ProjFlow prints the usual "
        "values, and no numbers of others.",
        "",
        f"{'':{WIDTH}s}" + "".join(f"{name:>20s}" for name in SHOWN),
        line_of(data, SHOWN, WIDTH),
    ]
    for name in ("no wish", USUAL.name):
        row = find(rows, "average", name)
        lines += [] if row is None else [line_of(row, SHOWN, WIDTH)]
    for sweep in SWEEPS:
        lines += [line_of(row, SHOWN, WIDTH) for _, row in measured_of(rows, sweep)]
    return "\n".join([*lines, "", *sentences(rows)])
