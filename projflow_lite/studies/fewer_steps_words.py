"""The study of fewer steps as a table, and what it says in sentences.

When does a way to sample *lose* against another? When a score is further from what it should be, by
more than the 95 % interval of that difference over seeds, by more than `TOLERANCE`, and by more
than anybody could see. Both have the same prompts, keyframes and noise, so differences are more
certain than the scores themselves. A distance and an error should be small, a share of prompts
found as large as the data's. Skating, jerk and acceleration should be the data's: less is as wrong
as more, for too few steps make motion too calm.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from projflow_lite.scores import interval
from projflow_lite.studies.cells import DATA

OFF_FLOW = "off the flow, cm"

COLUMNS = (
    "kinetic distance", "pose distance", "FID", "R top 1", "R top 3", "bone error %",
    "skating gmd", "jerk", "worst acceleration", OFF_FLOW,
)  # fmt: skip

LIKE_THE_DATA = ("skating gmd", "jerk", "worst acceleration")
AT_LEAST_THE_DATA = ("R top 1", "R top 3")

TOLERANCE = 0.05
"""A loss of less than this share of a score is none, however certain."""

NEGLIGIBLE = {"bone error %": 0.05}
"""What nobody sees, in units of the score: of a shin it is 0.2 mm."""

WAY = ("schedule", "solver", "steps", "calls", "noise", "eta", "metric")
START = "{schedule:10s}{solver:10s}{steps:>6s}{calls:>6s}  {noise:9s}{eta:6s}{metric:10s}"
"""How a line of the table begins."""


def table(rows: list[dict[str, Any]]) -> str:
    """The records as text, one line each, task by task, and then sentences."""
    first = rows[0]
    lines = [
        f"{first['seeds']} seeds of {first['clips']} clips each. Mean ± 95 %. "
        "R: share of motions whose prompt is found among 32."
    ]
    head = START.format(**{name: name for name in WAY})
    for task in dict.fromkeys(row["task"] for row in rows):
        lines += ["", task]
        lines.append(head + "".join(f"{name.removesuffix(' gmd'):>20s}" for name in COLUMNS))
        lines += [line_of(row) for row in rows if row["task"] == task]
    return "\n".join([*lines, "", *sentences(rows)])


def line_of(row: dict[str, Any]) -> str:
    """One row of the table."""
    way = {name: str(row.get(name, "")) for name in WAY}
    start = (
        "{schedule:10s}{solver:10s}{steps:>6s}{calls:>6s}  {noise:9s}{eta:6s}{metric:10s}".format(
            **way
        )
    )
    cells = (row["scores"].get(name) for name in COLUMNS)
    shown = (f"{c['mean']:.3f} ± {c['half width']:.3f}" if c else "" for c in cells)
    return start + "".join(f"{cell:>20s}" for cell in shown)


def losses(row: dict[str, Any], name: str, data: dict[str, Any]) -> NDArray:
    """How far one score is from what it should be, for every seed."""
    values = np.array(row["scores"][name]["values"])
    right = data["scores"].get(name, {"mean": 0.0})["mean"]
    if name in LIKE_THE_DATA:
        return np.abs(values - right)
    if name in AT_LEAST_THE_DATA:
        return np.maximum(right - values, 0)
    return values


class Loss(NamedTuple):
    """By how much one score of a row is worse than a reference's, as a share of the latter.

    Negative if it is better; with the half width of its 95 % interval.
    """

    name: str
    share: float
    half_width: float
    least: float

    @property
    def certain(self) -> bool:
        """Is it one? `least` is the smallest share that counts."""
        return self.share > max(self.half_width, self.least)


def losses_against(
    row: dict[str, Any], reference: dict[str, Any], data: dict[str, Any]
) -> list[Loss]:
    """What a row loses in every score against a reference with the same seeds.

    How far a sample is off the flow is no matter of quality, and does not count.
    """
    found = []
    for name, cell in reference["scores"].items():
        if name != OFF_FLOW:
            more = losses(row, name, data) - losses(reference, name, data)
            mean, half = interval(more / cell["mean"])
            seen = NEGLIGIBLE.get(name, 0.0) / max(cell["mean"], 1e-12)
            found.append(Loss(name, mean, half, max(TOLERANCE, seen)))
    return found


def lost(row: dict[str, Any], reference: dict[str, Any], data: dict[str, Any]) -> list[str]:
    """The scores in which a row loses against a reference."""
    return [loss.name for loss in losses_against(row, reference, data) if loss.certain]


def method_of(row: dict[str, Any]) -> tuple:
    """What tells methods apart that differ in more than the number of steps."""
    return row["schedule"], row["solver"], row["noise"], row["eta"], row["metric"]


def methods_of(rows: Iterable[dict[str, Any]]) -> dict[tuple, list[dict[str, Any]]]:
    """The rows of every method, by rising number of steps."""
    found: dict[tuple, list[dict[str, Any]]] = {}
    for row in sorted(rows, key=lambda row: row["steps"]):
        found.setdefault(method_of(row), []).append(row)
    return found


def fewest(
    rows: list[dict[str, Any]], reference: dict[str, Any], data: dict[str, Any]
) -> dict[str, Any] | None:
    """The cheapest row of a method that keeps a quality, as all dearer ones of the method do."""
    kept = None
    for row in reversed(rows):
        if lost(row, reference, data):
            break
        kept = row
    return kept


def sentences(rows: list[dict[str, Any]]) -> list[str]:
    """What the rows say of every task: how few steps keep the quality of the most."""
    data = next(row for row in rows if row["task"] == DATA)
    said = []
    for task in dict.fromkeys(row["task"] for row in rows if row is not data):
        methods = methods_of(row for row in rows if row["task"] == task)
        plain = plain_of(methods)
        reference = methods[plain][-1]
        said += [of_plain(task, methods[plain], reference, data)]
        said += [of_cheapest(task, methods, reference, data)]
    return [*said, *of_solvers(rows)]


def plain_of(methods: dict[tuple, list[dict[str, Any]]]) -> tuple:
    """Euler's quadratic steps, as in all other tables, with the paper's noise."""
    return next(method for method in methods if method[:2] == ("quadratic", "Euler"))


def of_plain(
    task: str, rows: list[dict[str, Any]], reference: dict[str, Any], data: dict[str, Any]
) -> str:
    """How few of the plain steps keep the quality of the most of them."""
    kept = fewest(rows, reference, data)
    assert kept is not None  # the reference keeps its own quality
    fewer = [row for row in rows if row["steps"] < kept["steps"]]
    cost = (
        f"; {fewer[-1]['steps']} lose {listed(lost(fewer[-1], reference, data))}" if fewer else ""
    )
    return (
        f"{task.capitalize()}: {kept['steps']} of the plainest steps ({spelled(kept)}) keep the "
        f"quality of {reference['steps']}, within the interval{cost}.{doubt(kept, reference, data)}"
    )


def of_cheapest(
    task: str,
    methods: dict[tuple, list[dict[str, Any]]],
    reference: dict[str, Any],
    data: dict[str, Any],
) -> str:
    """Which ways keep that quality with the fewest network calls, best first."""
    found = [row for rows in methods.values() if (row := fewest(rows, reference, data))]
    calls = min(row["calls"] for row in found)
    best = [row for row in found if row["calls"] == calls]
    best.sort(key=lambda row: sum(loss.share for loss in losses_against(row, reference, data)))
    return (
        f"{task.capitalize()}: the fewest network calls that keep it are {calls:g}, of "
        f"{len(methods)} methods with {listed([spelled(row) for row in best])}."
        + doubt(best[0], reference, data)
    )


def doubt(row: dict[str, Any], reference: dict[str, Any], data: dict[str, Any]) -> str:
    """The largest loss that the interval leaves possible."""
    if row is reference:
        return ""
    known = [loss for loss in losses_against(row, reference, data) if loss.name not in NEGLIGIBLE]
    worst = max(known, key=lambda loss: loss.share + loss.half_width)
    most = worst.share + worst.half_width
    return f" The interval leaves room for a loss of {100 * most:.0f} % in {worst.name}."


def of_solvers(rows: list[dict[str, Any]], calls: int = 10) -> list[str]:
    """How far off the flow each solver is at about the same number of network calls."""
    said = []
    free = [row for row in rows if OFF_FLOW in row["scores"]]
    for schedule in dict.fromkeys(row["schedule"] for row in free):
        near = [r for r in free if r["schedule"] == schedule and calls - 1 <= r["calls"] <= calls]
        near.sort(key=lambda row: row["scores"][OFF_FLOW]["mean"])
        cells = [(r["solver"], r["scores"][OFF_FLOW]) for r in near]
        text = [f"{name} {c['mean']:.1f} ± {c['half width']:.1f} cm" for name, c in cells]
        said.append(f"Off the flow, {schedule}, about {calls} network calls: {', '.join(text)}.")
    return said


def spelled(row: dict[str, Any]) -> str:
    """A method in words."""
    noise = f", {row['noise']} noise, eta {row['eta']}" if row["noise"] else ""
    metric = ", metric over time" if row["metric"] == "moving" else ""
    return f"{row['schedule']} {row['solver']}{noise}{metric}"


def listed(words: list[str]) -> str:
    """Words with commas and a last "and"."""
    return " and ".join([", ".join(words[:-1]), words[-1]]) if len(words) > 1 else "".join(words)
