"""The study of lifting as a table beside the paper's, and what it says in sentences.

What *reproduced* means is said in `projflow_lite.studies.claims`.
"""

from __future__ import annotations

from typing import Any

from projflow_lite.studies.claims import (
    block,
    claims_of,
    count_of,
    difference_of,
    find,
    of_claim,
    of_time,
    paper_line,
    shown,
    verdict,
)
from projflow_lite.studies.lifting_paper import LIFT, TABLE
from projflow_lite.studies.lifting_ways import OVERWRITERS

IN_PICTURE = ("MPJPE-2D", "average error 2D")
COLUMNS = (
    *TABLE.columns, "residual", "kinetic distance", "bone error %", "worst acceleration",
)  # fmt: skip
WIDTH = 22
"""Of the names of methods."""


def of_exactness(rows: list[dict[str, Any]]) -> str | None:
    """Are ProjFlow's errors in the picture zero, to the three digits of the paper?"""
    own = [row for row in rows if row["method"] == "projflow"]
    if not own:
        return None
    worst = max(max(row["scores"][name]["values"]) for row in own for name in IN_PICTURE)
    largest = max(max(row["scores"]["residual"]["values"]) for row in own)
    return (
        f"projflow: both errors in the picture 0.000 (Table 2); here the largest is {worst:.4f}, "
        f"the largest residual {largest:.1e} m: "
        f"{'reproduced' if worst < 5e-4 else 'not reproduced'}."
    )


def of_depth(rows: list[dict[str, Any]], joint: str) -> str | None:
    """Is depth better left to the flow, or decided beforehand? Not a claim of the paper."""
    pair = [find(rows, joint, name) for name in ("projflow", LIFT)]
    if pair[0] is None or pair[1] is None:
        return None
    parts = []
    for column in ("average error 3D", "kinetic distance", "bone error %"):
        cells = [row["scores"][column] for row in pair if row is not None]
        difference = difference_of(*cells)
        said = {"reproduced": "less", "not reproduced": "more", "undecided": "undecided"}
        parts.append(
            f"{column} {shown(cells[0])} against {shown(cells[1])} "
            f"({said[verdict(difference)]}, {difference.mean:+.3g} ± {difference.half_width:.2g})"
        )
    return (
        f"{joint}: the same sampler with depth left open (projflow) and with depth from a "
        f"regression ({LIFT}): {'; '.join(parts)}."
    )


def sentences(rows: list[dict[str, Any]]) -> list[str]:
    """What the rows say of every claim that they can say something of."""
    claimed = [of_claim(rows, claim, TABLE) for claim in claims_of(TABLE, TABLE.columns)]
    known = [sentence for sentence in claimed if sentence]
    said = [of_exactness(rows), *(of_depth(rows, joint) for joint in TABLE.rows), of_time(rows)]
    said += [
        "Not tested: Sketch2Anim, a model that was trained for the task. And "
        f"{', '.join(OVERWRITERS)} cannot: they overwrite coordinates, and what a camera sees is "
        "a sum of three.",
        count_of(known), *known,
    ]  # fmt: skip
    return [sentence for sentence in said if sentence]


def table(rows: list[dict[str, Any]]) -> str:
    """Text: for both settings a line a method, the paper's numbers under it, then sentences."""
    data = rows[0]
    lines = [
        f"{data['seeds']} seeds of {data['clips']} clips for every task, {data['steps']} steps; "
        "± 95 %. 2D errors in picture units, 3D errors in metres, both poses seen from their own "
        "pelvis and paths as they stand; time as a multiple of a sample without a wish. Where "
        "there is a second line, it is ProjFlow's paper (Table 2), of another prior, other data "
        "and another evaluator, and of baselines larger than these."
    ]
    for joint in TABLE.rows:
        lines += block(rows, joint, COLUMNS, TABLE, WIDTH)
        lines.append(
            paper_line(TABLE, joint, "sketch2anim", COLUMNS, "  paper: sketch2anim", WIDTH)
        )
    return "\n".join([*lines, "", *sentences(rows)])
