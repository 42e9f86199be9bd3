"""What the scores of a prior say: a table, a verdict for every bar, and the prior's card."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from projflow_lite.studies.data_card_words import paragraph
from projflow_lite.studies.score_prior import COLUMNS, DATA, SAMPLES


class Bar(NamedTuple):
    """What a prior has to reach: a score, as a ratio to the held-out data or as it is."""

    score: str
    low: float
    high: float
    ratio: bool = True


BARS = (
    Bar("FID", 0.0, 2.0),
    Bar("R top 3", 0.95, math.inf),
    Bar("diversity", 0.95, 1.05),
    Bar("bone error %", 0.0, 1.0, ratio=False),
    Bar("skating gmd", 0.0, 1.3),
    Bar("jerk", 0.0, 1.3),
)


def verdicts(rows: list[dict[str, Any]]) -> list[str]:
    """One sentence for each row and bar: is it met, missed, or within the interval?"""
    return [sentence(row, bar) for row in rows if row["row"] != DATA for bar in BARS]


def sentence(row: dict[str, Any], bar: Bar) -> str:
    """What one row says of one bar."""
    cell = row["scores"][bar.score]
    value, half = (
        (cell["ratio"], cell["ratio half width"])
        if bar.ratio
        else (cell["mean"], cell["half width"])
    )
    met = bar.low <= value <= bar.high
    # Without an interval (one repetition) nothing is said of its reach.
    open_ = any(math.isfinite(edge) and abs(value - edge) < half for edge in (bar.low, bar.high))
    verdict = "met" if met else "MISSED"
    doubt = ", but the interval holds the bar" if open_ else ""
    unit = " times held-out data" if bar.ratio else ""
    return (
        f"{row['row']}: {bar.score} is {value:.2f} ± {half:.2f}{unit}, "
        f"bar {limits(bar)}: {verdict}{doubt}."
    )


def limits(bar: Bar) -> str:
    """A bar in words."""
    if bar.high == math.inf:
        return f"at least {bar.low:g}"
    return f"at most {bar.high:g}" if bar.low == 0 else f"{bar.low:g} to {bar.high:g}"


def table(rows: list[dict[str, Any]]) -> str:
    """The records as text: a line a score, a column a row, then the verdicts."""
    first = rows[0]
    lines = [
        f"{first['repetitions']} repetitions of {first['clips']} clips, frames "
        f"{', '.join(map(str, first['lengths']))}; multimodality over {first['prompts']} prompts "
        f"with {SAMPLES} motions each. Mean ± 95 %, and in brackets the ratio to held-out data.",
        f"{'':18s}" + "".join(f"{row['row']:>28s}" for row in rows),
    ]
    for name in COLUMNS:
        cells = (row["scores"][name] for row in rows)
        lines.append(f"{name:18s}" + "".join(f"{shown(cell):>28s}" for cell in cells))
    return "\n".join([*lines, "", *verdicts(rows)])


def shown(cell: dict[str, float]) -> str:
    """One cell of the table."""
    # Nothing is a multiple of bones that do not change at all.
    ratio = f"{cell['ratio']:.2f}" if cell["ratio"] < 1000 else "–"
    return f"{cell['mean']:.3f} ± {cell['half width']:.3f} ({ratio})"


FEET = """
    What counts as skating here are mostly toes at the begin and end of a swing: fast while half a
    centimetre or more lower than they should be, and so under the 5 cm of the definition. It
    happens in walks, most along curves and in turns. It is not the sampler: more steps do not help,
    as the columns show, and fresh noise in every step helps a little only. Nor was it enough to
    count feet eight times in the last round of training. What is left to try: longer training, or a
    second network for the end of the flow."""


def missed(rows: list[dict[str, Any]], score: str) -> bool:
    """Whether any row misses the bar of a score."""
    return any(
        line.split(": ")[1].startswith(score) and "MISSED" in line for line in verdicts(rows)
    )


def card(rows: list[dict[str, Any]], recipe: dict[str, Any]) -> str:
    """The prior's card as Markdown: every number in it comes from the records.

    Args:
        rows: what `score_prior.run` returned.
        recipe: how the prior was trained.
    """
    first, frames = rows[0], ", ".join(map(str, rows[0]["lengths"]))
    what = f"""
        The shipped prior was trained for {recipe["steps"]} steps of {recipe["batch"]} clips. Here
        it makes motions for captions that it never met. They are scored beside the held-out clips
        that those captions describe: {first["repetitions"]} times {first["clips"]} clips of
        {frames} frames. Everything is compared with one and the same other sample of the data, so
        *{DATA}* is the floor that a perfect prior would reach."""
    made = """
        `projflow-lite train --recipe classroom --out runs/classroom` and then `projflow-lite score
        --classroom runs/classroom/prior.safetensors --out book` write this page and its numbers."""
    numbers = f"""
        Mean ± 95 % over repetitions; in brackets the ratio to held-out data. Multimodality is over
        {first["prompts"]} prompts with {SAMPLES} motions each."""
    more = """
        `make pictures` draws it again. `projflow-lite score --blind FOLDER --real CLIPS` writes a
        page with synthetic, generated and recorded clips in random order, to guess which is which,
        and the key in a file of its own."""
    lines = [
        ["", *(row["row"] for row in rows)],
        ["---"] * (len(rows) + 1),
        *([name, *(shown(row["scores"][name]) for row in rows)] for name in COLUMNS),
    ]
    parts = [
        "# Prior card: how good are its motions?",
        *map(paragraph, (what, made, numbers)),
        "\n".join(f"| {' | '.join(line)} |" for line in lines),
        "## The bars",
        "\n".join(f"- {line}" for line in verdicts(rows)),
        *(["## What the feet lack", paragraph(FEET)] if missed(rows, "skating gmd") else []),
        "## To look at",
        "![All actions, a prompt for each, and what was made of it](pictures/all_actions.png)",
        paragraph(more),
    ]
    return "\n\n".join(parts) + "\n"
