"""What the scores of a prior say: a table, a verdict for every bar, and the prior's card."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any, NamedTuple

from projflow_lite.studies.cells import DATA
from projflow_lite.studies.data_card_words import paragraph
from projflow_lite.studies.score_prior import COLUMNS, SAMPLES, SPLINES


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
    Bar("jerk", 1 / 1.3, 1.3),
)


def verdicts(rows: list[dict[str, Any]]) -> list[str]:
    """One sentence for each row and bar: is it met, missed, or within the interval?"""
    return [sentence(row, bar) for row in made_by_priors(rows) for bar in BARS]


def made_by_priors(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The rows that are judged."""
    return [row for row in rows if row["steps"] is not None]


def reached(row: dict[str, Any], bar: Bar) -> tuple[float, float]:
    """What a row has of the score of a bar, and how certain that is."""
    cell = row["scores"][bar.score]
    if bar.ratio:
        return cell["ratio"], cell["ratio half width"]
    return cell["mean"], cell["half width"]


def sentence(row: dict[str, Any], bar: Bar) -> str:
    """What one row says of one bar."""
    value, half = reached(row, bar)
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
    return f"at most {bar.high:g}" if bar.low == 0 else f"{bar.low:.2g} to {bar.high:.3g}"


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


FEET = f"""
    What counts as skating here are mostly toes at the begin and end of a swing: fast while half a
    centimetre or more lower than they should be, and so under the 5 cm of the definition. It
    happens in walks, most along curves and in turns. The network's curves account for some of it,
    as the column *{SPLINES}* shows. It is not the sampler: more steps do not help, and fresh noise
    in every step helps a little only. Nor was it enough to count feet eight times in the last round
    of training, or to train half as long again; and a second network for the end of the flow made
    jerk and kinetic distance worse for what it won."""


def missed(rows: list[dict[str, Any]], score: str) -> bool:
    """Whether any row misses the bar of a score."""
    bar = next(bar for bar in BARS if bar.score == score)
    made = (reached(row, bar)[0] for row in made_by_priors(rows))
    return not all(bar.low <= value <= bar.high for value in made)


SMOOTH = f"""
    Motions are smoother than data: of jerk, the third derivative, they have too little. A small
    part is due to the network's curves, as the column *{SPLINES}* shows; the rest is what it did
    not learn."""


def card(
    rows: list[dict[str, Any]], classroom: list[dict[str, Any]], recipe: dict[str, Any]
) -> str:
    """The prior's card as Markdown: every number in it comes from the records.

    Args:
        rows: what `score_prior.run` returned.
        classroom: what `score_prior.beside` returned, or nothing.
        recipe: how the prior was trained.
    """
    first = rows[0]
    what = f"""
        The shipped prior was trained for {recipe["steps"]} steps of {recipe["batch"]} clips. Here
        it makes motions for captions that it never met. They are scored beside the held-out clips
        that those captions describe: {extent(first)}. Everything is compared with one and the same
        other sample of the data, so *{DATA}* is the floor that a perfect prior would reach, and
        *{SPLINES}* the floor of this network, which draws curves of ten control points a second:
        the nearest ones to those clips."""
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
    parts = [
        "# Prior card: how good are its motions?",
        *map(paragraph, (what, made, numbers)),
        markdown(rows),
        "## The bars",
        "\n".join(f"- {line}" for line in verdicts(rows)),
        *(["## What the feet lack", paragraph(FEET)] if missed(rows, "skating gmd") else []),
        *(["## Too smooth", paragraph(SMOOTH)] if too_low(rows, "jerk") else []),
        *(beside_classroom(classroom) if classroom else []),
        "## To look at",
        "![All actions, a prompt for each, and what was made of it](pictures/all_actions.png)",
        paragraph(more),
    ]
    return "\n\n".join(parts) + "\n"


def too_low(rows: list[dict[str, Any]], score: str) -> bool:
    """Whether any row lies under the bar of a score."""
    bar = next(bar for bar in BARS if bar.score == score)
    return any(reached(row, bar)[0] < bar.low for row in made_by_priors(rows))


def beside_classroom(rows: list[dict[str, Any]]) -> list[str]:
    """The part of the card that compares the two recipes."""
    words = f"""
        The recipe `classroom` takes about ten minutes on one core and knows shorter motions only.
        So both priors are asked for {extent(rows[0])}, in {rows[1]["steps"]} steps."""
    about_it = [row for row in rows if row["row"] == "classroom"]
    return [
        "## What ten minutes of training reach",
        paragraph(words),
        markdown(rows),
        "\n".join(f"- {line}" for line in verdicts(about_it)),
    ]


def extent(row: dict[str, Any]) -> str:
    """How many clips of which lengths."""
    frames = ", ".join(map(str, row["lengths"]))
    return f"{row['repetitions']} times {row['clips']} clips of {frames} frames"


def markdown(rows: list[dict[str, Any]]) -> str:
    """A table: a line a score, a column a row."""
    lines = [
        ["", *(row["row"] for row in rows)],
        ["---"] * (len(rows) + 1),
        *([name, *(shown(row["scores"][name]) for row in rows)] for name in COLUMNS),
    ]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def write_card(
    out: Path,
    rows: list[dict[str, Any]],
    classroom: list[dict[str, Any]],
    recipe: dict[str, Any],
) -> None:
    """Write the card and its numbers to a folder; see `card`."""
    (out / "results").mkdir(parents=True, exist_ok=True)
    found = json.dumps({"shipped": rows, "classroom": classroom}, indent=1)
    (out / "results" / "prior-card.json").write_text(found + "\n")
    (out / "prior-card.md").write_text(card(rows, classroom, recipe))
