"""What comparisons have in common: cells stored as they are made, and rows over seeds and cells.

A cell is one method on one task with one seed. A run that was interrupted goes on with the cells
that are missing, and a run with more seeds takes those that are there.
"""

from __future__ import annotations

import hashlib
import itertools
import json
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from tqdm.auto import tqdm

from data_synth import Clips, held_out
from projflow_lite.prior import Prior, checkpoint
from projflow_lite.scores import (
    frechet_distance,
    interval,
    kinetic_features,
    load_evaluator,
    pose_features,
    score_clips,
)
from projflow_lite.studies.shares import is_first, is_mine, take_share, wait_for


class Features(NamedTuple):
    """What Fréchet distances compare, each ``(clips, features)``."""

    kinetic: NDArray
    pose: NDArray
    points: NDArray


def features_of(positions: NDArray) -> Features:
    """Features of a set of clips ``(clips, frames, 22, 3)``."""
    points = load_evaluator().embed_motion(positions)
    return Features(kinetic_features(positions), pose_features(positions), points)


def fingerprint(what: torch.nn.Module | Features) -> str:
    """Tells one network's weights, or the features of one evaluator and data set, from others."""
    if not isinstance(what, Features):
        return checkpoint.fingerprint(what)
    parts = [np.round(part, 3).astype(np.float32) for part in what]
    return hashlib.sha256(b"".join(part.tobytes() for part in parts)).hexdigest()[:8]


def quality(
    positions: NDArray, captions: list[str] | None, reference: Features, seed: int
) -> dict[str, float]:
    """Every score that needs no wish, over a whole set of clips; see `score_clips`."""
    own = features_of(positions)
    row = score_clips(positions, captions, seed=seed)
    row["kinetic distance"] = frechet_distance(own.kinetic, reference.kinetic)
    row["FID"] = frechet_distance(own.points, reference.points)
    return row


def stored(
    path: Path, measure: Callable[[], dict[str, float]], by_first: bool = False
) -> dict[str, float]:
    """A result from its file; or measured and stored, by the process that it belongs to.

    Args:
        path: the file.
        measure: what is stored.
        by_first: whether it belongs to the first process, as times do: it is then alone.
    """
    if not (is_first() if by_first else is_mine(path)):
        wait_for(path)
    if not path.exists():
        text = json.dumps(measure(), indent=1)
        write(path, lambda file: file.write(text.encode()))
    return json.loads(path.read_text())


def write(path: Path, fill: Callable[[Any], Any]) -> None:
    """Write a file under another name first: what is there under its own name is whole."""
    path.parent.mkdir(parents=True, exist_ok=True)
    half = path.with_suffix(".half")
    with half.open("wb") as file:
        fill(file)
    half.replace(path)


class Rival(NamedTuple):
    """One method with its settings.

    Attributes:
        name: in tables.
        method: a name of `projflow_lite.samplers.METHODS`, or one that the study knows; "" for a
            sample without a wish.
        options: what differs from the method's defaults; of ProjFlow also "metric", "guides", the
            constants of either, and "steps", see `control_ways.aim`.
        model: what it brings instead of the prior that all others share; empty for that prior.
    """

    name: str
    method: str
    options: tuple[tuple[str, Any], ...] = ()
    model: str = ""

    @property
    def spelled(self) -> str:
        """Name, settings and model, for a file's name."""
        parts = [self.name, *(f"{key}={value}" for key, value in self.options)]
        parts += [self.model] if self.model else []
        return "_".join(parts).replace(", ", "-").replace(" ", "-")


class Cell(NamedTuple):
    """One method on one task, for all seeds.

    Attributes:
        joint: what is asked for.
        keys: in how many frames; `ALL` where a study has but one answer to that.
        rival: the method.
    """

    joint: str
    keys: int | str
    rival: Rival

    @property
    def path(self) -> Path:
        """Folder of the results of all seeds."""
        return Path(self.rival.spelled) / f"{self.joint}-{self.keys}".replace(" ", "-")


ALL, DATA = "all", "held-out data"

Scores = dict[str, float]


def file_of(place: Path, seed: int, cell: Cell) -> Path:
    """Where the result of a cell and seed is stored."""
    return place / cell.path / f"seed-{seed}.json"


def filled(
    place: Path,
    cells: Sequence[Cell],
    seeds: int,
    measure: Callable[[Cell, int], Scores],
    progress: bool = True,
) -> dict[Cell, list[Scores]]:
    """The results of all cells, seed after seed: from their files, or measured and stored.

    Args:
        place: folder of one prior, data and size.
        cells: what is measured.
        seeds: how often.
        measure: of a cell and a seed.
        progress: whether to show a bar.
    """
    found: dict[Cell, list[Scores]] = {cell: [] for cell in cells}
    with tqdm(total=seeds * len(cells), disable=not progress, unit="cell") as bar:

        def take(seed: int, cell: Cell) -> dict[str, float]:
            bar.set_description(f"seed {seed}, {cell.joint}, {cell.keys}, {cell.rival.name}")
            return stored(file_of(place, seed, cell), partial(measure, cell, seed))

        every = list(itertools.product(range(seeds), cells))
        take_share((file_of(place, *job), partial(take, *job)) for job in every)
        for seed, cell in every:
            found[cell].append(take(seed, cell))
            bar.update(1)
    return found


class Group(NamedTuple):
    """A row of the table for every method: its name, and the tasks that it is the mean of."""

    joint: str
    keys: int | str
    parts: tuple[tuple[str, int | str], ...]


def summarised(
    found: dict[Cell, list[Scores]],
    groups: Sequence[Group],
    rivals: Sequence[Rival],
    columns: Sequence[str],
    about: dict[str, Any],
) -> list[dict[str, Any]]:
    """A record for every group and method; means are taken seed by seed."""
    rows = []
    for group, rival in itertools.product(groups, rivals):
        parts = [found[Cell(joint, keys, rival)] for joint, keys in group.parts]
        values = [mean_of(list(seed)) for seed in zip(*parts, strict=True)]
        own = {"joint": group.joint, "keys": group.keys, "method": rival.name}
        extent = about | {"options": dict(rival.options), "seeds": len(values)}
        rows.append(own | extent | {"scores": over_seeds(values, columns)})
    return rows


def over_seeds(values: Sequence[Scores], columns: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Every score with its ``mean``, its ``half width`` (95 %) and the ``values`` of all seeds."""
    scores = {}
    for name in (name for name in columns if name in values[0]):
        column = [row[name] for row in values]
        mean, half = interval(column)
        scores[name] = {"mean": mean, "half width": half, "values": column}
    return scores


def data_row(
    score: Callable[[Clips, int], Scores],
    clips: int,
    frames: int,
    first: int,
    columns: Sequence[str],
    about: dict[str, Any],
) -> dict[str, Any]:
    """A record of what data itself scores.

    Args:
        score: of clips and a seed.
        clips: how many a seed, each of so many `frames`.
        frames: see `clips`.
        first: held-out seed of seed 0; those of other seeds follow.
        columns: of the table.
        about: what all records hold; among it ``seeds``.
    """
    parts = [score(held_out(clips, frames, first + seed), seed) for seed in range(about["seeds"])]
    row = {"joint": ALL, "keys": ALL, "method": DATA, "options": {}}
    return row | about | {"scores": over_seeds(parts, columns)}


def mean_of(parts: list[Scores]) -> Scores:
    """Mean of every column; of the residual the largest."""
    row = {name: float(np.mean([part[name] for part in parts])) for name in parts[0]}
    if "residual" in row:
        row["residual"] = max(part["residual"] for part in parts)
    return row


def records_text(prior: Prior, rows: list[dict[str, Any]], **about: Any) -> str:
    """The records of a study as JSON, a record a line; the prior that they are of comes first."""
    known = json.dumps({"prior": fingerprint(prior)} | about)
    lines = ",\n".join(json.dumps(row) for row in rows)
    return f'{known[:-1]}, "rows": [\n{lines}\n]}}\n'


def published(
    name: str, prior: Prior, rows: list[dict[str, Any]], draw: Callable[[Any, Path], Any], out: Path
) -> None:
    """Write the records to ``results/`` and the picture to ``pictures/`` of a folder."""
    for part in ("results", "pictures"):
        (out / part).mkdir(parents=True, exist_ok=True)
    (out / f"results/{name}.json").write_text(records_text(prior, rows))
    draw(rows, out / f"pictures/{name}.png")
