"""The study of ablations as tables, and what they say in sentences.

ProjFlow is *better with a part* in a cell (a joint, a density, a reading of the noise, a guidance)
if the score is worse without it and the 95 % interval of the difference, taken seed by seed,
excludes 0; it is *better without* if the interval excludes 0 on the other side; else the cell is
*undecided*. Of twenty cells without any difference, one is called decided by chance.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterator
from typing import Any, NamedTuple

from projflow_lite.scores.interval import Interval
from projflow_lite.studies.cells import ALL
from projflow_lite.studies.claims import difference_of, line_of, shown

Row = dict[str, Any]

SHOWN = ("FID", "kinetic distance", "bone error %", "skating gmd", "worst acceleration", "R top 3")
"""Columns of the table."""

JUDGED = ("FID", "kinetic distance", "bone error %", "worst acceleration")
"""What a part is judged by: the paper's score, and three that see a body torn or thrown."""

WHOLE, OURS = "projflow", "metric over time"
TAKEN = {
    "euclid": "the metric of the skeleton",
    "no fresh noise": "fresh noise",
    "plain masking": "guides",
}
"""What is missing in each of the paper's ablations."""

EARNS, HARMS, OPEN = "better with it", "better without it", "undecided"


class Effect(NamedTuple):
    """What one change does in one cell, ProjFlow less the variant.

    Attributes:
        place: joint, keyframes, noise and guidance.
        column: the score.
        difference: below 0 where the whole method is better; all scores are better when small.
        whole, other: both scores.
    """

    place: tuple[str, int, str, float]
    column: str
    difference: Interval
    whole: dict[str, Any]
    other: dict[str, Any]

    @property
    def word(self) -> str:
        """What it says."""
        mean, half = self.difference.mean, self.difference.half_width
        return OPEN if abs(mean) <= half else EARNS if mean < 0 else HARMS

    @property
    def spelled(self) -> str:
        """Where, and both scores."""
        joint, keys, noise, guidance = self.place
        return (
            f"{joint}, {keys} keyframes, {noise} noise, guidance {guidance:g}: "
            f"{shown(self.whole)} and {shown(self.other)}"
        )


def place_of(row: Row) -> tuple[str, int, str, float]:
    """The cell that a row belongs to."""
    return row["joint"], row["keys"], row["noise"], row["guidance"]


def single(rows: list[Row]) -> list[Row]:
    """Rows of one joint and one density."""
    return [row for row in rows[1:] if row["keys"] != ALL and row["joint"] != "average"]


def effects(rows: list[Row], part: str, column: str) -> Iterator[Effect]:
    """What one change does to one score, cell by cell."""
    cells = {(place_of(row), row["part"]): row["scores"][column] for row in single(rows)}
    for (place, name), whole in cells.items():
        if name == WHOLE and (place, part) in cells:
            other = cells[place, part]
            yield Effect(place, column, difference_of(whole, other), whole, other)


def of_part(rows: list[Row], part: str, column: str) -> str | None:
    """Does a part of ProjFlow earn its place, by one score?"""
    found = list(effects(rows, part, column))
    if not found:
        return None
    words = Counter(effect.word for effect in found)
    text = (
        f"{column}: without {TAKEN[part]} it is worse in {words[EARNS]} of {len(found)} cells, "
        f"better in {words[HARMS]}, and undecided in {words[OPEN]}"
    )
    extremes = [
        max(
            (e for e in found if e.word == word), key=lambda e: abs(e.difference.mean), default=None
        )
        for word in (EARNS, HARMS)
    ]
    detail = "; ".join(effect.spelled for effect in extremes if effect)
    return f"{text} (with and without it, at the most: {detail})." if detail else f"{text}."


def of_order(rows: list[Row], column: str) -> str | None:
    """Does the order of Tables 3 and 6 hold: the whole method first, everything else worse?"""
    found = [list(effects(rows, part, column)) for part in TAKEN]
    cells = list(zip(*found, strict=True)) if all(found) else []
    if not cells:
        return None
    said = []
    for noise in dict.fromkeys(row["noise"] for row in single(rows)):
        own = [cell for cell in cells if cell[0].place[2] == noise]
        kept = sum(all(effect.word == EARNS for effect in cell) for cell in own)
        broken = sum(any(effect.word == HARMS for effect in cell) for cell in own)
        said.append(
            f"with {noise} noise it holds in {kept} of {len(own)} cells with all three intervals, "
            f"is broken in {broken} with at least one, and is undecided in "
            f"{len(own) - kept - broken}"
        )
    return (
        f"{column}, the order of Tables 3 and 6 (the whole method best, each ablation worse): "
        f"{'; '.join(said)}."
    )


def of_readings(rows: list[Row], column: str) -> str | None:
    """Which noise should eq. 9 mix?"""
    cells = {
        (row["joint"], row["keys"], row["guidance"], row["noise"]): row["scores"][column]
        for row in single(rows)
        if row["part"] == WHOLE
    }
    pairs = [
        (cell, cells[*place, "original"])
        for (*place, noise), cell in cells.items()
        if noise == "implied" and (*place, "original") in cells
    ]
    if not pairs:
        return None
    differences = [difference_of(*pair) for pair in pairs]
    below = sum(d.mean + d.half_width < 0 for d in differences)
    above = sum(d.mean - d.half_width > 0 for d in differences)
    return (
        f"{column}: the implied noise is better than that of the start, as printed, in {below} of "
        f"{len(pairs)} cells, worse in {above}, undecided in {len(pairs) - below - above}."
    )


def of_ours(rows: list[Row], column: str) -> str | None:
    """Is a metric over time better than metric and guides?"""
    found = list(effects(rows, OURS, column))
    if not found:
        return None
    words = Counter(effect.word for effect in found)
    data = rows[0]["scores"][column]
    largest = max(found, key=lambda effect: abs(effect.difference.mean))
    return (
        f"{column}: a metric over time is better than ProjFlow's metric and guides in "
        f"{words[HARMS]} of {len(found)} cells, worse in {words[EARNS]}, undecided in "
        f"{words[OPEN]} (ProjFlow and with it, at the most: {largest.spelled}; held-out data "
        f"{shown(data)})."
    )


def sentences(rows: list[Row]) -> list[str]:
    """What the rows say: the paper's order, our metric, every part by every score, the noise."""
    said = [of_order(rows, column) for column in JUDGED[:2]]
    said += [of_ours(rows, column) for column in JUDGED]
    said += [of_part(rows, part, column) for part, column in itertools.product(TAKEN, JUDGED)]
    said += [of_readings(rows, column) for column in JUDGED]
    return [sentence for sentence in said if sentence]


def table(rows: list[Row]) -> str:
    """Text: for every cell a line a variant, and then sentences."""
    data = rows[0]
    lines = [
        f"{data['seeds']} seeds of {data['clips']} clips for every cell, {data['steps']} steps; "
        "means over seeds ± 95 %. Keyframes are met exactly by all.",
    ]
    for place in dict.fromkeys(place_of(row) for row in single(rows)):
        joint, keys, noise, guidance = place
        title = f"{joint}, {keys} keyframe{'s' * (keys != 1)}, {noise} noise, guidance {guidance:g}"
        lines += ["", title, f"{'':18s}" + "".join(f"{name:>20s}" for name in SHOWN)]
        own = [row for row in single(rows) if place_of(row) == place]
        lines += [line_of(row | {"method": row["part"]}, SHOWN, 18) for row in own]
        lines.append(line_of(data, SHOWN, 18))
    return "\n".join([*lines, "", *sentences(rows)])
