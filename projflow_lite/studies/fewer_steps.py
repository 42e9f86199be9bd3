"""How few steps keep the quality of a hundred?

Quality against the number of network calls: over the spacing of the times, over solvers, and, where
a wish is projected between the steps, over the noise that eq. 9 mixes and the share of it that is
fresh. Without a wish a sampler follows an ordinary differential equation, and what a coarse step
costs can be told from what the prior cannot do: by the distance to where many small steps lead from
the same noise.

A full run takes hours, so every result is stored as it is made, seed after seed: an interrupted run
goes on from where it was, and more seeds narrow the intervals of a finished one. One command does
it all, ``python -m projflow_lite.studies.fewer_steps --out book``.
"""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm.auto import tqdm

from data_synth import Clips, held_out
from projflow_lite.prior import Prior, load_prior
from projflow_lite.scores import frechet_distance, score_clips
from projflow_lite.studies.cells import (
    Features,
    features_of,
    fingerprint,
    over_seeds,
    published,
    stored,
    write,
)
from projflow_lite.studies.fewer_steps_figure import figure
from projflow_lite.studies.fewer_steps_ways import FINE, Way, all_ways, make
from projflow_lite.studies.fewer_steps_words import COLUMNS, DATA, OFF_FLOW, sentences, table
from projflow_lite.studies.keyframes import FRAMES
from projflow_lite.studies.shares import is_first, take_share, wait_for

__all__ = ["figure", "run", "sentences", "table"]

FOLDER = Path("runs/fewer-steps")
REFERENCE, WISHED, OTHERS = 1000, 2000, 3000
"""Seeds of held-out clips: to compare with, to ask for, and to show what data itself scores."""


def run(
    prior: Prior,
    quick: bool = False,
    clips: int = 64,
    seeds: int = 3,
    folder: str | Path = FOLDER,
    progress: bool = True,
) -> list[dict[str, Any]]:
    """Measure every way to sample; see the module's docstring.

    Args:
        prior: what makes motions.
        quick: half the clips, two seeds, fewer steps and one wish: minutes instead of hours.
        clips: motions of a way and seed; 64 at least, or 32 of them would not fill a batch of
            R-precision when quick.
        seeds: each with other captions, keyframes and noise, the same ones for every way.
        folder: where results are stored; those of another prior, evaluator, data or number of
            clips lie apart in it. After a change of the sampler, take another folder.
        progress: whether to show a bar; its unit is a call of the network.

    Returns:
        One record a row, held-out data first: how it was sampled, and ``scores``, each with its
        ``mean``, its ``half width`` (95 %) and the ``values`` of all seeds.

    Raises:
        ValueError: for fewer than 64 clips or 2 seeds.
    """
    if clips < 64 or seeds < 2:
        raise ValueError(f"fewer_steps: at least 64 clips and 2 seeds, not {clips} and {seeds}")
    if quick:
        clips, seeds = clips // 2, 2
    reference = features_of(held_out(16 * clips, FRAMES, REFERENCE).positions)
    place = Path(folder) / f"{fingerprint(prior)}-{fingerprint(reference)}-{clips}"
    found: dict[Way | None, list[dict[str, float]]] = {way: [] for way in [None, *all_ways(quick)]}
    cost = sum(way.calls for way in found if way)
    with tqdm(total=seeds * (cost + FINE.calls), disable=not progress, unit="call") as bar:
        for seed in range(seeds):
            others = held_out(clips, FRAMES, OTHERS + seed)
            found[None].append(score(others.positions, others.captions, reference))
            wished = held_out(clips, FRAMES, WISHED + seed)
            fine = fine_motion(prior, wished, seed, place)
            bar.update(FINE.calls)
            jobs = {}
            for way in filter(None, found):
                path = place / name_of(way, seed)
                measure = partial(measured, prior, way, wished, seed, reference, fine)
                jobs[way] = path, partial(stored, path, measure)
            take_share(jobs.values())
            for way, (_, work) in jobs.items():
                bar.set_description(f"{way.task}, {way.solver}, {way.steps}")
                found[way].append(work())
                bar.update(way.calls)
    return [record(way, values, clips) for way, values in found.items()]


def measured(
    prior: Prior, way: Way, wished: Clips, seed: int, reference: Features, fine: NDArray
) -> dict[str, float]:
    """Sample one way with one seed, and score it."""
    x, calls = make(prior, way, wished, seed)
    row = score(x, wished.captions, reference)
    if not way.joint:
        row[OFF_FLOW] = 100 * float(np.linalg.norm(x - fine, axis=-1).mean())
    return row | {"calls": calls}


def score(positions: NDArray, captions: list[str], reference: Features) -> dict[str, float]:
    """The columns of the table, each over a whole set of clips."""
    own = features_of(positions)
    distances = [frechet_distance(a, b) for a, b in zip(own, reference, strict=True)]
    names = ("kinetic distance", "pose distance", "FID")
    row = dict(zip(names, distances, strict=True)) | score_clips(positions, captions)
    return {name: row[name] for name in COLUMNS if name != OFF_FLOW}


def fine_motion(prior: Prior, wished: Clips, seed: int, place: Path) -> NDArray:
    """Where many small steps lead without a wish, from the file if there is one."""
    path = place / f"fine-{seed}.npy"
    if not is_first():
        wait_for(path)
    if not path.exists():
        write(path, lambda file: np.save(file, make(prior, FINE, wished, seed)[0]))
    return np.load(path)


def name_of(way: Way, seed: int) -> str:
    """Name of the file of one result."""
    parts = [way.task, way.schedule, way.solver, way.steps, way.noise, way.eta, way.metric]
    name = "_".join(str(part) for part in parts if part != "")
    return f"{name.replace(', ', '-').replace(' ', '-')}/seed-{seed}.json"


def record(way: Way | None, values: list[dict[str, float]], clips: int) -> dict[str, Any]:
    """One row: how it was sampled and what it scored."""
    about: dict[str, Any] = {"task": DATA} if way is None else {"task": way.task} | way._asdict()
    if way is not None:
        about["calls"] = values[0]["calls"]
    return about | {"clips": clips, "seeds": len(values), "scores": over_seeds(values, COLUMNS)}


def main() -> None:
    """Measure, print the table, and write the records and the picture."""
    parser = argparse.ArgumentParser(description="How few steps keep the quality of a hundred?")
    parser.add_argument("--prior", type=Path, help="a checkpoint (default: the shipped one)")
    parser.add_argument("--quick", action="store_true", help="minutes, not hours; wide intervals")
    parser.add_argument("--clips", type=int, default=64, help="motions of a seed (default 64)")
    parser.add_argument(
        "--seeds", type=int, default=3, help="more narrow the intervals (default 3)"
    )
    parser.add_argument("--folder", type=Path, default=FOLDER, help="for results as they are made")
    parser.add_argument("--out", type=Path, help="folder for results/ and pictures/")
    options = parser.parse_args()
    prior = load_prior(options.prior)
    rows = run(prior, options.quick, options.clips, options.seeds, options.folder)
    print(table(rows))
    if options.out:
        published("fewer-steps", prior, rows, figure, options.out)


if __name__ == "__main__":
    main()
