"""How good is a prior? Its motions beside held-out data, over sampling steps, with intervals.

Every number is measured twice: for motions that the prior makes for held-out captions, and for the
held-out clips that those captions describe. Both are compared with one and the same other sample of
the data, so the held-out row is the floor that a perfect prior would reach. What is repeated, and
what the intervals are over: other captions, other clips and other noise.
"""

from __future__ import annotations

import math
from collections import Counter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from tqdm.auto import tqdm

from data_synth import held_out
from projflow_lite.samplers import sample
from projflow_lite.samplers.projflow import Velocity
from projflow_lite.scores import interval, load_evaluator, multimodality, score_clips

BATCH = 64
QUICK: dict[str, Any] = {"clips": 3 * BATCH, "repetitions": 3, "steps": (25,)}
DATA = "held-out data"

PROMPTS, QUICK_PROMPTS, SAMPLES = 12, 4, 10
"""Multimodality: this many prompts, and motions for each. The papers take 100 prompts."""

COLUMNS = (
    "FID", "kinetic distance", "R top 1", "R top 2", "R top 3", "matching", "diversity",
    "multimodality", "bone error %", "worst acceleration", "skating gmd", "skating bmm", "jerk",
)  # fmt: skip


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


class Sample(NamedTuple):
    """Single clips of several lengths and what they show."""

    positions: list[NDArray]
    captions: list[str]


def run(
    prior: Velocity,
    clips: int = 512,
    repetitions: int = 5,
    steps: tuple[int, ...] = (25, 50, 100),
    quick: bool = False,
    progress: bool = True,
) -> list[dict[str, Any]]:
    """Score a prior.

    Args:
        prior: what makes motions; its ``lengths`` decide how long they are.
        clips: motions a repetition, a multiple of 64.
        repetitions: how often everything is drawn anew; 2 at least give an interval.
        steps: numbers of sampling steps, each a row.
        quick: three repetitions of 192 clips at 25 steps, instead of the three numbers above. A
            first look: its intervals are wide.
        progress: show a progress bar.

    Returns:
        One record a row, held-out data first: ``row``, ``steps``, ``clips``, ``repetitions``,
        ``prompts`` (of the multimodality) and ``scores``; each of `COLUMNS` there has its ``mean``,
        ``half width`` (95 %), ``ratio`` to the held-out mean, and that ratio's own half width.

    Raises:
        ValueError: for a number of clips, repetitions or steps that makes no sense.
    """
    if quick:
        clips, repetitions, steps = QUICK["clips"], QUICK["repetitions"], QUICK["steps"]
    check(clips, repetitions, steps)
    lengths, prompts = lengths_of(prior), QUICK_PROMPTS if quick else PROMPTS
    reference = data_sample(lengths, 4 * clips, 0).positions
    names: list[int | None] = [None, *steps]  # None: the data itself
    measured: dict[int | None, list[dict[str, float]]] = {name: [] for name in names}
    total = repetitions * len(steps) * (clips + prompts * SAMPLES)
    with tqdm(total=total, disable=not progress, unit="clip") as bar:
        for repetition in range(repetitions):
            data = data_sample(lengths, clips, repetition + 1)
            many = repeated(lengths[len(lengths) // 2], prompts, repetition)
            for count in names:
                made, again = data, many
                if count is not None:
                    made = generate(prior, data, count, 2 * repetition, bar)
                    again = generate(prior, many, count, 2 * repetition + 1, bar)
                row = score_clips(made.positions, made.captions, reference, seed=repetition)
                points = load_evaluator().embed_motion(again.positions).reshape(-1, SAMPLES, 64)
                row["multimodality"] = multimodality(points, seed=repetition)
                measured[count].append(row)
    about = {"clips": clips, "repetitions": repetitions, "prompts": prompts, "lengths": lengths}
    return [
        {"row": DATA if count is None else f"{count} steps", "steps": count}
        | about
        | {"scores": summary(measured[count], measured[None])}
        for count in names
    ]


def check(clips: int, repetitions: int, steps: tuple[int, ...]) -> None:
    """Refuse numbers that make no sense."""
    if clips < BATCH or clips % BATCH:
        raise ValueError(f"score_prior: clips is a multiple of {BATCH}, not {clips}")
    if repetitions < 1 or not steps or min(steps) < 1:
        raise ValueError("score_prior: at least one repetition, and one step in every row")


def lengths_of(prior: Velocity) -> list[int]:
    """Short, medium and long, of what a prior makes."""
    shortest, longest = getattr(prior, "lengths", (40, 80))
    return sorted({round(x) for x in np.linspace(max(20, shortest), min(196, longest), 3)})


def data_sample(lengths: list[int], clips: int, seed: int) -> Sample:
    """Held-out clips: batches of 64 of one length, the lengths in turn."""
    turns = [lengths[k % len(lengths)] for k in range(clips // BATCH)]
    made = {frames: held_out(BATCH * turns.count(frames), frames, seed) for frames in set(turns)}
    positions: list[NDArray] = []
    captions: list[str] = []
    for k, frames in enumerate(turns):
        first = BATCH * turns[:k].count(frames)
        positions.extend(made[frames].positions[first : first + BATCH])
        captions.extend(made[frames].captions[first : first + BATCH])
    return Sample(positions, captions)


def repeated(frames: int, prompts: int, seed: int, pool: int | None = None) -> Sample:
    """Held-out clips that share their caption: `SAMPLES` for each of some captions.

    The most frequent captions are taken, but no two of one action.

    Raises:
        ValueError: if not enough captions occur often enough; a larger pool has more.
    """
    pool = pool or 512 * prompts
    data = held_out(pool, frames, seed=500_000 + seed)
    often = [text for text, count in Counter(data.captions).most_common() if count >= SAMPLES]
    action = dict(zip(data.captions, data.actions, strict=True))
    chosen = list({action[text]: text for text in reversed(often)}.values())[::-1][:prompts]
    if len(chosen) < prompts:
        if pool < 100_000:
            return repeated(frames, prompts, seed, 2 * pool)
        raise ValueError(f"score_prior: only {len(chosen)} captions occur {SAMPLES} times")
    texts = np.array(data.captions)
    places = [k for text in chosen for k in np.flatnonzero(texts == text)[:SAMPLES]]
    return Sample([data.positions[k] for k in places], [data.captions[k] for k in places])


def generate(prior: Velocity, like: Sample, steps: int, seed: int, bar: tqdm) -> Sample:
    """A motion for each caption of a sample, of the length of its clip."""
    made: list[NDArray] = []
    for start in range(0, len(like.captions), BATCH):
        texts = like.captions[start : start + BATCH]
        frames = len(like.positions[start])
        # Other noise for every batch of every repetition, the same for every number of steps.
        noise = 10_000 * seed + start
        motion = sample(prior, None, texts, frames, steps, noise, batch=len(texts))
        made.extend(motion.positions)
        bar.update(len(texts))
    return Sample(made, like.captions)


def summary(rows: list[dict[str, float]], floor: list[dict[str, float]]) -> dict[str, Any]:
    """Mean, interval and ratio to the floor of every column, over repetitions."""
    cells = {}
    for name in COLUMNS:
        mean, half = interval([row[name] for row in rows])
        base, base_half = interval([row[name] for row in floor])
        ratio = mean / base if base > 0 else float("nan")
        # Relative errors of a quotient add as squares. The floor has none against itself.
        relative = math.hypot(half / mean, base_half / base) if mean > 0 < base else float("nan")
        ratio_half = 0.0 if rows is floor else ratio * relative
        cells[name] = {
            "mean": mean, "half width": half, "ratio": ratio, "ratio half width": ratio_half,
        }  # fmt: skip
    return cells


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
