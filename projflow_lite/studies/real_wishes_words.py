"""The study of wishes from outside as a table, and what it says in sentences.

A score is *higher* or *lower* on recorded wishes if the 95 % interval of the difference over seeds
excludes 0, and else *undecided*. Both kinds of wishes have the same noise and frames of keyframes.
"""

from __future__ import annotations

import itertools
from typing import Any

from projflow_lite.studies.cells import ALL, DATA
from projflow_lite.studies.claims import EXACT, difference_of, line_of, shown, verdict
from projflow_lite.studies.control_ways import FREE
from projflow_lite.studies.recorded import RECORDED

SOURCE, TO_RECORDED = "source", "FID to recorded"

COLUMNS = (
    "trajectory error", "location error", "average error", "residual", "FID", TO_RECORDED,
    "kinetic distance", "diversity", "skating gmd", "bone error %", "worst acceleration",
)  # fmt: skip
"""Everything that is measured; "FID" is that to synthetic data, as in all other studies."""

COMPARED = (
    "average error", "FID", TO_RECORDED, "kinetic distance", "bone error %", "skating gmd",
    "worst acceleration",
)  # fmt: skip
RANKED = ("FID", TO_RECORDED, "kinetic distance", "bone error %")
"""Less is better in all of them."""

WORDS = {"reproduced": "lower", "not reproduced": "higher", "undecided": "undecided"}
WIDTH = 32
"""Of the names of rows."""

Row = dict[str, Any]


def averages(rows: list[Row], source: str) -> dict[str, Row]:
    """The rows over joints and densities on one kind of wishes, by the name of the method."""
    own = [row for row in rows if row[SOURCE] == source and row["method"] != DATA]
    return {r["method"]: r for r in own if (r["joint"], r["keys"]) == ("average", ALL)}


def data_of(rows: list[Row]) -> dict[str, Row]:
    """What clips themselves score, by where they are from."""
    return {row[SOURCE]: row for row in rows if row["method"] == DATA}


def of_data(rows: list[Row], source: str) -> str:
    """How unlike synthetic clips are the recorded ones themselves?"""
    data = data_of(rows)
    first, other = data[next(iter(data))], data[source]
    columns = [name for name in COMPARED if name in other["scores"]]
    parts = [
        f"{name} {shown(other['scores'][name])} against {shown(first['scores'][name])}"
        for name in columns
    ]
    return f"The clips themselves, {source} against held-out: {', '.join(parts)}."


def of_exactness(rows: list[Row]) -> str | None:
    """Who meets keyframes to rounding, and does it hold outside?"""
    sources = [source for source in data_of(rows) if averages(rows, source)]
    if not sources:
        return None
    parts = []
    for source in sources:
        exact = [
            name
            for name, row in averages(rows, source).items()
            if max(row["scores"]["residual"]["values"]) < EXACT
        ]
        parts.append(f"on {source} wishes by {', '.join(exact) or 'none'}")
    return f"Keyframes are met to rounding {'; '.join(parts)}."


def of_method(rows: list[Row], name: str, source: str) -> str:
    """What one method loses on recorded wishes; a sample without a wish knows of none."""
    first = averages(rows, next(iter(data_of(rows))))[name]
    other = averages(rows, source)[name]
    parts = []
    for column in COMPARED:
        pair = (other["scores"][column], first["scores"][column])
        if all(max(cell["values"]) < EXACT for cell in pair):
            parts.append(f"{column} exact in both")
            continue
        difference = difference_of(*pair)
        parts.append(
            f"{column} {difference.mean:+.3g} ± {difference.half_width:.2g} "
            f"({WORDS[verdict(difference)]})"
        )
    return f"{name}, {source} less held-out: {', '.join(parts)}."


def of_order(rows: list[Row], column: str, source: str) -> str | None:
    """Is who is better on synthetic wishes also better on recorded ones?"""
    first, other = averages(rows, next(iter(data_of(rows)))), averages(rows, source)
    names = [name for name in first if name in other and name != FREE.name]
    same = turned = still = 0
    for a, b in itertools.combinations(names, 2):
        said = [
            verdict(difference_of(found[a]["scores"][column], found[b]["scores"][column]))
            for found in (first, other)
        ]
        if said[0] == "undecided":
            continue
        same += said[0] == said[1]
        still += said[1] == "undecided"
        turned += said[1] not in (said[0], "undecided")
    if same + turned + still == 0:
        return None
    return (
        f"{column}: of {same + turned + still} pairs of methods whose order is certain on held-out "
        f"wishes, {same} have the same order on {source} ones, {turned} the other, and {still} are "
        "undecided there."
    )


def sentences(rows: list[Row]) -> list[str]:
    """What the rows say, clips themselves first, then method by method."""
    others = [source for source in data_of(rows) if source.startswith(RECORDED)]
    said = [of_data(rows, source) for source in others]
    said.append(of_exactness(rows) or "")
    for source in others:
        said += [of_order(rows, column, source) or "" for column in RANKED]
        names = (name for name in averages(rows, source) if name != FREE.name)
        said += [of_method(rows, name, source) for name in names]
    return [sentence for sentence in said if sentence]


def table(rows: list[Row]) -> str:
    """Text: for every kind of wishes the clips themselves and a line a method, then sentences."""
    data = rows[0]
    joints = dict.fromkeys(r["joint"] for r in rows if r["joint"] not in ("average", ALL))
    keys = dict.fromkeys(str(row["keys"]) for row in rows if row["keys"] != ALL)
    lines = [
        f"{data['seeds']} seeds of {data['clips']} clips for every joint ({', '.join(joints)}) and "
        f"density ({', '.join(keys)}), {data['steps']} steps, no prompts; means over both ± 95 %. "
        "FID is the distance to synthetic clips. Errors and residual in metres."
    ]
    for source, own in data_of(rows).items():
        lines += ["", f"{source + ' wishes':{WIDTH}s}" + "".join(f"{n:>20s}" for n in COLUMNS)]
        lines.append(line_of(own | {"method": f"{source} clips"}, COLUMNS, WIDTH))
        lines += [line_of(row, COLUMNS, WIDTH) for row in averages(rows, source).values()]
    return "\n".join([*lines, "", *sentences(rows)])
