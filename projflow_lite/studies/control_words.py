"""The study of control as tables beside the paper's, and what they say in sentences.

What *reproduced* means is said in `projflow_lite.studies.claims`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from projflow_lite.scores import interval
from projflow_lite.studies.cells import ALL, DATA
from projflow_lite.studies.claims import (
    TIME,
    block,
    claims_of,
    count_of,
    difference_of,
    find,
    of_claim,
    of_time,
    shown,
    verdict,
)
from projflow_lite.studies.control_paper import EDIT_TABLE, SOURCES, TABLES
from projflow_lite.studies.control_ways import EDIT, OURS, TRAINED, TUNED

ERRORS = ("trajectory error", "location error", "average error")
SHOWN = (
    *ERRORS, "residual", "FID", "kinetic distance", "R top 3", "diversity", "skating gmd",
    "bone error %", "worst acceleration",
)  # fmt: skip
"""Columns of the table of a joint."""

SHOWN_OF_EDIT = (
    "FID", "R top 1", "R top 2", "R top 3", "matching", "diversity", "average error", "residual",
    "kinetic distance", "skating gmd", "bone error %", "worst acceleration",
)  # fmt: skip
COLUMNS = (*SHOWN, "R top 1", "R top 2", "matching")
"""Everything that is measured."""

COSTS = ("projflow", "dps", "dno", *(rival.name for rival in TRAINED))
"""Projection, guidance through the network, optimisation of the noise, and trained control."""

COMPARED = ("FID", "R top 3", "skating gmd", "average error")
COMPARED_OF_EDIT = ("FID", "R top 1", "R top 2", "R top 3", "matching")


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
    """Is ProjFlow's FID the best of all untrained methods, its own ablations aside?"""
    own = find(rows, joint, "projflow")
    others = [r for r in rows if r["joint"] == joint and r["keys"] == ALL and r is not own]
    aside = ("no wish", DATA, *SOURCES, *(rival.name for rival in TRAINED + OURS + TUNED))
    others = [r for r in others if r["method"] not in aside]
    if own is None or not others:
        return None
    best = min(others, key=lambda row: row["scores"]["FID"]["mean"])
    cells = [row["scores"]["FID"] for row in (own, best)]
    difference = difference_of(*cells)
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


BESIDE = {
    TUNED[0].name: "ProjFlow with constants chosen on other clips",
    OURS[0].name: (
        "A metric over time in place of metric and guides, as exact, its constants measured or "
        "chosen on other clips"
    ),
}
"""What stands beside ProjFlow as the paper sets it, in words."""


def of_ours(rows: list[dict[str, Any]], other: str) -> str | None:
    """What one of `BESIDE` changes, over all joints and densities."""
    pair = [find(rows, "average", name) for name in (other, "projflow")]
    if pair[0] is None or pair[1] is None:
        return None
    said = []
    for column in ("FID", "kinetic distance", "bone error %", "worst acceleration"):
        ours, usual = (row["scores"][column] for row in pair if row is not None)
        difference = difference_of(ours, usual)
        certain = "" if abs(difference.mean) > difference.half_width else " (undecided)"
        said.append(f"{column} {shown(ours)} instead of {shown(usual)}{certain}")
    changed = ", ".join(f"{name} {value}" for name, value in pair[0]["options"].items())
    return f"{BESIDE[other]} ({changed}): {'; '.join(said)}."


def of_costs(rows: list[dict[str, Any]]) -> str | None:
    """What guidance, optimisation and trained control cost beside ProjFlow, as in Figure 6."""
    times = {r["method"]: r[TIME] for r in rows if r["joint"] == "average" and TIME in r}
    names = [name for name in COSTS if name in times]
    if "projflow" not in times or len(names) < 2:
        return None
    ratios = [f"{times[name] / times['projflow']:.2f}" for name in names]
    text = f"Time, {' : '.join(names)} = {' : '.join(ratios)}"
    if "control branch" not in names:
        return f"{text}."
    ahead = times["projflow"] < times["control branch"]
    return (
        f"{text}; with as many steps projflow is faster than a control branch in Figure 6: "
        f"{'reproduced' if ahead else 'not reproduced'}."
    )


def sentences(rows: list[dict[str, Any]]) -> list[str]:
    """What the rows say of every claim that they can say something of, averages first."""
    joints = list(dict.fromkeys(r["joint"] for r in rows if r["joint"] not in (ALL, EDIT)))[::-1]
    of_joints = sorted(claims_of(TABLES, COMPARED), key=lambda claim: claim.joint != "average")
    claimed = [of_claim(rows, claim, TABLES) for claim in of_joints]
    edits = [of_claim(rows, c, EDIT_TABLE) for c in claims_of(EDIT_TABLE, COMPARED_OF_EDIT)]
    known = [sentence for sentence in claimed + edits if sentence]
    said = [of_exactness(rows), *(of_best(rows, joint) for joint in joints)]
    said += [of_cells(rows, other) for other in SOURCES]
    said += [of_ours(rows, other) for other in BESIDE]
    said += [of_time(rows), of_costs(rows), count_of(known), *known]
    return [sentence for sentence in said if sentence]


def table(rows: list[dict[str, Any]]) -> str:
    """Text: for every joint a line a method, the paper's numbers under it, and then sentences."""
    data = rows[0]
    lines = [
        f"{data['seeds']} seeds of {data['clips']} clips for every joint and density, "
        f"{data['steps']} steps; means over densities ± 95 %. Errors in metres, time as a multiple "
        f"of a sample without a wish. Where there is a second line, it is ProjFlow's paper "
        "(Table 7; Table 6 for ablations), of another prior, other data and another evaluator. In "
        "the upper-body edit pelvis and legs are given in every frame. control branch and condmdi "
        "were trained for control, all others not."
    ]
    for joint in dict.fromkeys(row["joint"] for row in rows[1:]):
        edit = joint == EDIT
        printed, columns = (EDIT_TABLE, SHOWN_OF_EDIT) if edit else (TABLES, SHOWN)
        lines += block(rows, joint, columns, printed)
    absent = [data["left out"]] if data.get("left out") else []
    return "\n".join([*lines, "", *absent, *sentences(rows)])
