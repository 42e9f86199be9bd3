"""The study of control as tables beside the paper's, and what they say in sentences.

Absolute numbers are of another prior, other data and another evaluator, and are not to be compared.
What can be compared is which of two methods is ahead. A claim of the paper is *reproduced* if the
difference has the paper's sign here and its 95 % interval over seeds excludes 0, *not reproduced*
if the interval excludes 0 on the other side, and else *undecided*. All methods have the same
captions, keyframes and noise, so differences are more certain than the scores themselves. The paper
prints no intervals of its own, so a claim may be one of chance: many differ in the last digit.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from projflow_lite.scores import interval
from projflow_lite.scores.interval import Interval
from projflow_lite.studies.control_paper import PAPER, SOURCES, printed

DATA, ALL, TIME = "held-out data", "all", "time"

ERRORS = ("trajectory error", "location error", "average error")
COLUMNS = (
    *ERRORS, "residual", "FID", "kinetic distance", "R top 3", "diversity", "skating gmd",
    "bone error %", "worst acceleration",
)  # fmt: skip

COMPARED = ("FID", "R top 3", "skating gmd", "average error")


class Claim(NamedTuple):
    """The paper says that one method has less of something than another."""

    joint: str
    column: str
    less: str
    more: str


def claims() -> list[Claim]:
    """Everything that the zero-shot rows say of ProjFlow against another method."""
    found = []
    for joint, methods in PAPER.items():
        for other in (name for name in methods if name != "projflow"):
            for column in COMPARED:
                ours, theirs = (printed(joint, name, column) for name in ("projflow", other))
                assert ours is not None
                assert theirs is not None
                less, more = ("projflow", other) if ours < theirs else (other, "projflow")
                if ours != theirs:
                    found.append(Claim(joint, column, less, more))
    return found


def verdict(difference: Interval) -> str:
    """What a difference says of a claim that it is below 0."""
    if difference.mean + difference.half_width < 0:
        return "reproduced"
    if difference.mean - difference.half_width > 0:
        return "not reproduced"
    return "undecided"


def find(rows: list[dict[str, Any]], joint: str, method: str) -> dict[str, Any] | None:
    """The row of a method on a joint over all densities, if it was measured."""
    wanted = (joint, ALL, method)
    return next((r for r in rows if (r["joint"], r["keys"], r["method"]) == wanted), None)


def of_claim(rows: list[dict[str, Any]], claim: Claim) -> str | None:
    """A sentence on one claim, or None if a method or joint was not measured."""
    pair = [find(rows, claim.joint, name) for name in (claim.less, claim.more)]
    if pair[0] is None or pair[1] is None:
        return None
    cells = [row["scores"][claim.column] for row in pair if row is not None]
    difference = interval(np.subtract(cells[0]["values"], cells[1]["values"]))
    source = next((SOURCES[name] for name in claim[2:] if name in SOURCES), "Table 7")
    theirs = [printed(claim.joint, name, claim.column) for name in (claim.less, claim.more)]
    return (
        f"{claim.joint}, {claim.column}: {claim.less} less than {claim.more} "
        f"({theirs[0]:g} and {theirs[1]:g} in {source}); here {shown(cells[0])} and "
        f"{shown(cells[1])}, difference {difference.mean:+.3g} ± {difference.half_width:.2g}: "
        f"{verdict(difference)}."
    )


def of_exactness(rows: list[dict[str, Any]]) -> str | None:
    """Are ProjFlow's errors zero, to the four digits of the paper?"""
    own = [r for r in rows if r["method"] == "projflow" and r["keys"] != ALL]
    if not own:
        return None
    worst = max(max(r["scores"][name]["values"]) for r in own for name in ERRORS)
    largest = max(max(r["scores"]["residual"]["values"]) for r in own)
    return (
        f"projflow: all three errors 0.0000 on every joint (Table 7); here the largest is "
        f"{worst:.4f}, the largest residual {largest:.1e} m: "
        f"{'reproduced' if worst < 5e-5 else 'not reproduced'}."
    )


def of_best(rows: list[dict[str, Any]], joint: str) -> str | None:
    """Is ProjFlow's FID the best of all methods, its own ablations aside?"""
    own = find(rows, joint, "projflow")
    others = [r for r in rows if r["joint"] == joint and r["keys"] == ALL and r is not own]
    others = [r for r in others if r["method"] not in ("no wish", DATA, *SOURCES)]
    if own is None or not others:
        return None
    best = min(others, key=lambda row: row["scores"]["FID"]["mean"])
    cells = [row["scores"]["FID"] for row in (own, best)]
    difference = interval(np.subtract(cells[0]["values"], cells[1]["values"]))
    miss = best["scores"]["average error"]["mean"]
    return (
        f"{joint}, FID: projflow the best zero-shot method (text of section 5.2.1); here "
        f"{shown(cells[0])}, and the best other is {best['method']} with {shown(cells[1])} at an "
        f"average error of {miss:.3f} m, difference {difference.mean:+.3g} ± "
        f"{difference.half_width:.2g}: {verdict(difference)}."
    )


def of_cells(rows: list[dict[str, Any]], other: str, column: str = "FID") -> str | None:
    """In how many cells, each a joint and a density, is ProjFlow below one of its ablations?"""
    cells: dict[str, dict[tuple, dict[str, Any]]] = {"projflow": {}, other: {}}
    for row in rows:
        if row["method"] in cells and row["keys"] != ALL and row["joint"] != "average":
            cells[row["method"]][row["joint"], row["keys"]] = row["scores"][column]
    pairs = [(cells["projflow"][place], cell) for place, cell in cells[other].items()]
    if not pairs:
        return None
    said = [verdict(interval(np.subtract(a["values"], b["values"]))) for a, b in pairs]
    below, above = said.count("reproduced"), said.count("not reproduced")
    return (
        f"{column} of single joints and densities: projflow is below {other} in {below} of "
        f"{len(said)}, above in {above}, and {len(said) - below - above} are undecided."
    )


def of_time(rows: list[dict[str, Any]]) -> str | None:
    """What every method costs."""
    last = [r for r in rows if r["joint"] == "average" and r["keys"] == ALL]
    if not last:
        return None
    cheap = sorted(last, key=lambda row: row[TIME])
    parts = [f"{row['method']} {row[TIME]:.2f}" for row in cheap if row["method"] != "no wish"]
    return f"Time, as a multiple of a sample without a wish: {', '.join(parts)}."


def sentences(rows: list[dict[str, Any]]) -> list[str]:
    """What the rows say of every claim that they can say something of, averages first."""
    joints = list(dict.fromkeys(row["joint"] for row in rows if row["method"] != DATA))[::-1]
    of_joints = sorted(claims(), key=lambda claim: claim.joint != "average")
    claimed = [sentence for claim in of_joints if (sentence := of_claim(rows, claim))]
    said = [of_exactness(rows), *(of_best(rows, joint) for joint in joints)]
    said += [of_cells(rows, other) for other in SOURCES]
    said += [of_time(rows), count_of(claimed), *claimed]
    return [sentence for sentence in said if sentence]


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


def table(rows: list[dict[str, Any]]) -> str:
    """Text: for every joint a line a method, the paper's numbers under it, and then sentences."""
    data = rows[0]
    lines = [
        f"{data['seeds']} seeds of {data['clips']} clips for every joint and density, "
        f"{data['steps']} steps; means over densities ± 95 %. Errors in metres, time as a multiple "
        f"of a sample without a wish. Where there is a second line, it is ProjFlow's paper "
        "(Table 7; Table 6 for ablations), of another prior, other data and another evaluator."
    ]
    for joint in dict.fromkeys(row["joint"] for row in rows if row["method"] != DATA):
        head = "".join(f"{name:>20s}" for name in COLUMNS)
        lines += ["", f"{joint:16s}{head}{TIME:>8s}", line_of(data)]
        for row in (r for r in rows if r["joint"] == joint and r["keys"] == ALL and r is not data):
            lines.append(line_of(row))
            if row["method"] in PAPER.get(joint, {}):
                lines.append(paper_line(joint, row["method"]))
    return "\n".join([*lines, "", *sentences(rows)])


def line_of(row: dict[str, Any]) -> str:
    """One row of the table."""
    cells = (row["scores"].get(name) for name in COLUMNS)
    text = "".join(f"{shown(cell) if cell else '':>20s}" for cell in cells)
    return f"{row['method']:16s}{text}" + (f"{row[TIME]:8.2f}" if TIME in row else "")


def paper_line(joint: str, method: str) -> str:
    """The paper's numbers, in the same columns."""
    values = (printed(joint, method, name) for name in COLUMNS)
    return f"{'  paper':16s}" + "".join(f"{'' if v is None else f'{v:g}':>20s}" for v in values)


def shown(cell: dict[str, Any]) -> str:
    """A mean and its interval; small ones in powers of ten."""
    if 0 < cell["mean"] < 1e-3:
        return f"{cell['mean']:.1e} ± {cell['half width']:.0e}"
    return f"{cell['mean']:.3f} ± {cell['half width']:.3f}"
