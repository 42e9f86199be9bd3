"""The study of errata as a table of differences, and what they say in sentences.

A reading *does not matter here* in a score if the difference, printed less derived, stays below a
twentieth of that score with all of its 95 % interval. It *matters here* if it does not and the
interval excludes 0, and else it is *undecided*. Over all densities together, where an erratum is
judged as a whole, intervals are widened so that all of its differences hold at once in 95 of 100
studies. Cells of the table are not: of twenty, one differs by chance.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from projflow_lite.scores import interval
from projflow_lite.studies.cells import ALL
from projflow_lite.studies.claims import EXACT, line_of, shown
from projflow_lite.studies.errata_forms import ERRATA, Erratum
from projflow_lite.studies.fewer_steps_words import TOLERANCE

SHOWN = (
    "trajectory error", "location error", "average error", "residual", "FID", "kinetic distance",
    "skating gmd", "bone error %", "worst acceleration",
)  # fmt: skip
"""Columns of the table."""

JUDGED = ("FID", "kinetic distance", "skating gmd", "bone error %", "worst acceleration")
"""What an erratum is judged by: keyframes are exact in any reading."""

MATTERS, NOT, OPEN = "matters here", "does not matter here", "undecided"
WIDTH = 24
"""Of the names of rows."""

Row = dict[str, Any]


class Effect(NamedTuple):
    """What one reading changes in one score.

    Attributes:
        column: the score.
        mean, half_width: of the difference, printed less derived, seed by seed.
        derived: the score of the other reading.
        word: what this says.
    """

    column: str
    mean: float
    half_width: float
    derived: dict[str, Any]
    word: str

    @property
    def spelled(self) -> str:
        """Name, difference and interval."""
        return f"{self.column} {self.mean:+.3g} ± {self.half_width:.2g} of {shown(self.derived)}"


def effect_of(printed: Row, derived: Row, column: str, confidence: float = 0.95) -> Effect:
    """The difference of two rows in one score."""
    ours, other = printed["scores"][column], derived["scores"][column]
    mean, half = interval(np.subtract(ours["values"], other["values"]), confidence)
    exact = all(max(np.abs(cell["values"])) < EXACT for cell in (ours, other))
    if exact or abs(mean) + half < TOLERANCE * abs(other["mean"]) or mean == half == 0:
        word = NOT
    else:
        word = MATTERS if abs(mean) > half else OPEN
    return Effect(column, mean, half, other, word)


def place_of(rows: list[Row], joint: str, keys: int | str) -> dict[str, Row]:
    """The rows of one wish and density, by the name of the method."""
    return {row["method"]: row for row in rows if (row["joint"], row["keys"]) == (joint, keys)}


class Pair(NamedTuple):
    """The rows of an erratum's two readings of one wish."""

    erratum: Erratum
    joint: str
    printed: dict[str, Any]
    derived: dict[str, Any]


def pairs_of(rows: list[Row], keys: int | str) -> Iterator[Pair]:
    """Every erratum and wish that was measured both ways at one density."""
    joints = dict.fromkeys(row["joint"] for row in rows[1:] if row["joint"] != "average")
    for erratum in ERRATA:
        for joint in joints:
            found = place_of(rows, joint, keys)
            if all(rival.name in found for rival in erratum.rivals):
                yield Pair(erratum, joint, *(found[rival.name] for rival in erratum.rivals))


def of_erratum(rows: list[Row], erratum: Erratum) -> str | None:
    """Does one erratum matter, over all densities?"""
    pairs = [pair for pair in pairs_of(rows, ALL) if pair.erratum == erratum]
    if not pairs:
        return None
    confidence = 1 - 0.05 / (len(pairs) * len(JUDGED))
    effects = [
        (pair.joint, effect_of(pair.printed, pair.derived, column, confidence))
        for pair in pairs
        for column in JUDGED
    ]
    certain = [f"{joint}, {one.spelled}" for joint, one in effects if one.word == MATTERS]
    none = sum(one.word == NOT for _, one in effects)
    verdict = MATTERS if certain else NOT if none == len(effects) else OPEN
    detail = f" ({'; '.join(certain)})" if certain else ""
    return (
        f"{erratum.name}: printed, it {erratum.printed}; derived, it {erratum.derived}. It "
        f"{'is ' if verdict == OPEN else ''}{verdict}: of {len(effects)} differences over all "
        f"densities {len(certain)} are certain{detail}, {none} are certainly small, and "
        f"{len(effects) - len(certain) - none} are undecided."
    )


def of_exactness(rows: list[Row]) -> str | None:
    """Are keyframes met in every reading?"""
    known = {rival.name for erratum in ERRATA for rival in erratum.rivals}
    own = [row for row in rows if row["method"] in known]
    if not own:
        return None
    largest = max(max(row["scores"]["residual"]["values"]) for row in own)
    return (
        f"Keyframes: the largest residual of all readings is {largest:.1e} m: "
        f"{'every reading meets them' if largest < EXACT else 'not every reading meets them'}."
    )


def of_density(rows: list[Row], keys: int | str) -> list[str]:
    """What each erratum does at one density, a sentence a wish."""
    said = []
    for erratum, joint, printed, derived in pairs_of(rows, keys):
        effects = [effect_of(printed, derived, column) for column in JUDGED]
        parts = []
        for word in (MATTERS, NOT, OPEN):
            own = [one for one in effects if one.word == word]
            named = [one.column if word == NOT else one.spelled for one in own]
            parts += [f"{word} in {', '.join(named)}"] if own else []
        said.append(f"{erratum.name}, {joint}, {keys} frames given: {'; '.join(parts)}.")
    return said


def sentences(rows: list[Row]) -> list[str]:
    """What the rows say, errata as a whole first, then density by density."""
    said = [of_exactness(rows), *(of_erratum(rows, erratum) for erratum in ERRATA)]
    for keys in densities(rows):
        said += of_density(rows, keys)
    return [sentence for sentence in said if sentence]


def densities(rows: list[Row]) -> list[int]:
    """Numbers of keyframes that were measured."""
    return list(dict.fromkeys(row["keys"] for row in rows if isinstance(row["keys"], int)))


def table(rows: list[Row]) -> str:
    """Text: for every wish and density the usual scores and a line of differences an erratum."""
    data = rows[0]
    lines = [
        f"{data['seeds']} seeds of {data['clips']} clips for every wish and density, "
        f"{data['steps']} steps. Rows of equations are differences, printed less derived, over "
        "the same captions, keyframes and noise, ± 95 %. Errors and residual in metres.",
        "", f"{'':{WIDTH}s}{'':>10s}" + "".join(f"{name:>20s}" for name in SHOWN),
        line_of(data, SHOWN, WIDTH + 10),
    ]  # fmt: skip
    shown_keys: list[int | str] = [*densities(rows)]
    if len(shown_keys) > 1:
        shown_keys.append(ALL)
    for keys in shown_keys:
        last = None
        for erratum, joint, printed, derived in pairs_of(rows, keys):
            if erratum != last:
                last = erratum
                lines += ["", f"{erratum.name}, keyframes: {keys}"]
            effects = [effect_of(printed, derived, column) for column in SHOWN]
            cells = (f"{one.mean:+.3g} ± {one.half_width:.2g}" for one in effects)
            lines.append(line_of(derived | {"method": f"  {joint}, derived"}, SHOWN, WIDTH + 10))
            start = "    printed less derived"
            lines.append(f"{start:{WIDTH + 10}s}" + "".join(f"{cell:>20s}" for cell in cells))
    return "\n".join([*lines, "", *sentences(rows)])
