"""How good is a prior? Its motions beside held-out data, over sampling steps, with intervals.

Every number is measured twice: for motions that the prior makes for held-out captions, and for the
held-out clips that those captions describe. Both are compared with one and the same other sample of
the data, so the held-out row is the floor that a perfect prior would reach. What is repeated, and
what the intervals are over: other captions, other clips and other noise.
"""

from __future__ import annotations

import itertools
import math
from collections import Counter
from functools import cached_property, partial
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np
import torch
from numpy.typing import NDArray
from tqdm.auto import tqdm

from data_synth import held_out
from projflow_lite.prior import Prior
from projflow_lite.prior.network import draw, spline_kernel
from projflow_lite.samplers import flow_times, sample
from projflow_lite.samplers.projflow import Velocity
from projflow_lite.scores import interval, load_evaluator, multimodality, score_clips
from projflow_lite.studies.cells import DATA, fingerprint, stored

BATCH = 64
QUICK: dict[str, Any] = {"clips": 3 * BATCH, "repetitions": 2, "steps": (25,)}

PROMPTS, QUICK_PROMPTS, SAMPLES = 12, 4, 10
"""Multimodality: this many prompts, and motions for each. The papers take 100 prompts."""

REPETITIONS = 5

COLUMNS = (
    "FID", "kinetic distance", "R top 1", "R top 2", "R top 3", "matching", "diversity",
    "multimodality", "bone error %", "worst acceleration", "skating gmd", "skating bmm", "jerk",
)  # fmt: skip


class Sample(NamedTuple):
    """Single clips of several lengths and what they show."""

    positions: list[NDArray]
    captions: list[str]


SPLINES = "data as splines"


class Row(NamedTuple):
    """A row of the table: who makes the motions, in how many steps.

    Nobody does for the data itself, and for the curves nearest to it that the network could draw.
    """

    name: str
    prior: Velocity | None
    steps: int | None


def run(
    prior: Velocity,
    clips: int = 192,
    repetitions: int = REPETITIONS,
    steps: tuple[int, ...] = (25, 50, 100),
    quick: bool = False,
    progress: bool = True,
    folder: Path | None = None,
) -> list[dict[str, Any]]:
    """Score a prior.

    Args:
        prior: what makes motions; its ``lengths`` decide how long they are.
        clips: motions a repetition, a multiple of 64.
        repetitions: how often everything is drawn anew; 2 at least give an interval.
        steps: numbers of sampling steps, each a row.
        quick: two repetitions of 192 clips at 25 steps, instead of the three numbers above. A
            first look: its intervals are wide.
        progress: show a progress bar.
        folder: where results are stored as they are made; a run that was interrupted goes on
            there. None stores nothing.

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
    rows = [Row(SPLINES, None, None), *(Row(f"{count} steps", prior, count) for count in steps)]
    court = Court(lengths_of(prior), clips, QUICK_PROMPTS if quick else PROMPTS)
    return judged(court, rows, repetitions, progress, folder)


def beside(
    prior: Velocity,
    other: Velocity,
    clips: int = 192,
    repetitions: int = REPETITIONS,
    steps: int = 25,
    quick: bool = False,
    progress: bool = True,
    folder: Path | None = None,
) -> list[dict[str, Any]]:
    """Score two priors, shipped and classroom, on motions of lengths that both know.

    Arguments, records and errors are those of `run`.
    """
    if quick:
        clips, repetitions, steps = QUICK["clips"], QUICK["repetitions"], QUICK["steps"][0]
    check(clips, repetitions, (steps,))
    rows = [Row("shipped", prior, steps), Row("classroom", other, steps)]
    court = Court(lengths_of(prior, other), clips, QUICK_PROMPTS if quick else PROMPTS)
    return judged(court, rows, repetitions, progress, folder)


def judged(
    court: Court, made: list[Row], repetitions: int, progress: bool, folder: Path | None
) -> list[dict[str, Any]]:
    """The records of some rows, after those of held-out data."""
    rows = [Row(DATA, None, None), *made]
    measured: dict[Row, list[dict[str, float]]] = {row: [] for row in rows}
    sampled = sum(row.prior is not None for row in made)
    total = repetitions * sampled * (court.clips + court.prompts * SAMPLES)
    with tqdm(total=total, disable=not progress, unit="clip") as bar:
        for repetition, row in itertools.product(range(repetitions), rows):
            measure = partial(court.judge, row, repetition, bar)
            path = folder and folder / place_of(row, court) / f"repetition-{repetition}.json"
            measured[row].append(stored(path, measure) if path else measure())
    about = {
        "clips": court.clips, "repetitions": repetitions, "prompts": court.prompts,
        "lengths": court.lengths,
    }  # fmt: skip
    return [
        {"row": row.name, "steps": row.steps}
        | about
        | {"scores": summary(measured[row], measured[rows[0]])}
        for row in rows
    ]


def place_of(row: Row, court: Court) -> str:
    """A folder's name that tells one prior, number of steps and size of a run from others."""
    extent = f"{court.clips}-clips-{court.prompts}-prompts-{'-'.join(map(str, court.lengths))}"
    if row.prior is None:
        return f"{'data' if row.name == DATA else 'splines'}-{extent}"
    return f"{fingerprint(cast(Prior, row.prior))}-{row.steps}-steps-{extent}"


class Court:
    """Judges rows on the same captions and clips.

    Args:
        lengths: of motions, frames.
        clips: motions a repetition.
        prompts: of the multimodality.
    """

    def __init__(self, lengths: list[int], clips: int, prompts: int) -> None:
        self.lengths, self.clips, self.prompts = lengths, clips, prompts
        self.last: tuple[int, Sample, Sample] | None = None

    @cached_property
    def reference(self) -> list[NDArray]:
        """The clips that everything is compared with."""
        return data_sample(self.lengths, 4 * self.clips, 0).positions

    def drawn(self, repetition: int) -> tuple[Sample, Sample]:
        """Held-out clips of one repetition, and those of its captions that are repeated."""
        if self.last is None or self.last[0] != repetition:
            frames = self.lengths[len(self.lengths) // 2]
            clips = data_sample(self.lengths, self.clips, repetition + 1)
            self.last = repetition, clips, repeated(frames, self.prompts, repetition)
        return self.last[1:]

    def judge(self, row: Row, repetition: int, bar: tqdm) -> dict[str, float]:
        """All scores of one row, once."""
        made, again = self.drawn(repetition)
        if row.prior is not None and row.steps is not None:
            made = generate(row.prior, made, row.steps, 2 * repetition, bar)
            again = generate(row.prior, again, row.steps, 2 * repetition + 1, bar)
        elif row.name == SPLINES:
            made, again = as_splines(made), as_splines(again)
        scores = score_clips(made.positions, made.captions, self.reference, seed=repetition)
        points = load_evaluator().embed_motion(again.positions).reshape(-1, SAMPLES, 64)
        return scores | {"multimodality": multimodality(points, seed=repetition)}


def check(clips: int, repetitions: int, steps: tuple[int, ...]) -> None:
    """Refuse numbers that make no sense."""
    if clips < BATCH or clips % BATCH:
        raise ValueError(f"score_prior: clips is a multiple of {BATCH}, not {clips}")
    if repetitions < 1 or not steps or min(steps) < 1:
        raise ValueError("score_prior: at least one repetition, and one step in every row")


def lengths_of(*priors: Velocity) -> list[int]:
    """Short, medium and long, of what all of some priors make."""
    known = [getattr(prior, "lengths", (40, 80)) for prior in priors]
    shortest, longest = max(low for low, _ in known), min(high for _, high in known)
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


def as_splines(sample: Sample) -> Sample:
    """The same clips, each as the nearest curves that the network could draw."""
    return Sample([nearest_splines(clip) for clip in sample.positions], sample.captions)


def nearest_splines(positions: NDArray) -> NDArray:
    """Curves with a control point every two frames, nearest to a clip ``(frames, 22, 3)``.

    What they lack no training can teach: see `projflow_lite.prior.network.draw`.
    """
    frames = len(positions)
    points = 2 * -(-frames // 4)  # as many as the network has
    basis = draw(torch.eye(points)[:, None], spline_kernel())[:, 0, :frames].double().numpy().T
    flat = positions.reshape(frames, -1)
    best = np.linalg.lstsq(basis, flat, rcond=None)[0]
    return (basis @ best).reshape(positions.shape)


def generate(prior: Velocity, like: Sample, steps: int, seed: int, bar: tqdm) -> Sample:
    """A motion for each caption of a sample, of the length of its clip."""
    made: list[NDArray] = []
    times = flow_times(steps)
    for start in range(0, len(like.captions), BATCH):
        texts = like.captions[start : start + BATCH]
        frames = len(like.positions[start])
        # Other noise for every batch of every repetition, the same for every number of steps.
        noise = 10_000 * seed + start
        motion = sample(prior, None, texts, frames, times, noise, batch=len(texts), solver="euler")
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
