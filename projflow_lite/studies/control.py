"""Every zero-shot method on one prior and one protocol: ProjFlow's Tables 1, 3, 6 and 7.

Captions of held-out clips, and where one joint of those clips is in 1, 2, 5, a quarter and all of
their frames. How near does a method come, what does the motion look like afterwards, and what does
it cost? The paper compares methods on different priors with different metric code; here they share
everything but themselves.

A full run takes many hours on a laptop, so every cell of the table is stored as it is made: an
interrupted run goes on from where it was, and more seeds narrow the intervals of a finished one.
``python -m projflow_lite.studies.control --help`` has all options, a graphics card among them.
"""

from __future__ import annotations

import argparse
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
from projflow_lite.prior import Prior, load_prior
from projflow_lite.samplers.projflow import Velocity
from projflow_lite.scores import control_errors, frechet_distance, interval, score_clips
from projflow_lite.studies.control_figure import figure
from projflow_lite.studies.control_ways import (
    ABLATIONS,
    FREE,
    QUICK_DNO,
    RIVALS,
    Made,
    Rival,
    Task,
    elsewhere,
    make,
    time_ratio,
)
from projflow_lite.studies.control_words import ALL, COLUMNS, DATA, TIME, sentences, table
from projflow_lite.studies.fewer_steps import Features, features_of, fingerprint, stored
from projflow_lite.studies.noise_reading import FRAMES

__all__ = ["figure", "run", "sentences", "table"]

FOLDER = Path("runs/control")
JOINTS = ("pelvis", "left_foot", "right_foot", "head", "left_wrist", "right_wrist")
DENSITIES = (1, 2, 5, FRAMES // 4, FRAMES)
REFERENCE, WISHED, OTHERS = 4000, 5000, 6000
"""Seeds of held-out clips: to compare with, to ask for, and to show what data itself scores."""

TIMED = Task("pelvis", 5, FRAMES), 16
"""What is timed: this task, on so many clips."""


class Protocol(NamedTuple):
    """How much is measured.

    Attributes:
        clips: motions of a cell, that is of a method, joint, density and seed.
        seeds: each with other captions, keyframes and noise, the same ones for every method.
        steps: of sampling.
        joints, densities: of the keyframes.
        rivals: the methods.
    """

    clips: int = 128
    seeds: int = 4
    steps: int = 25
    joints: tuple[str, ...] = JOINTS
    densities: tuple[int, ...] = DENSITIES
    rivals: tuple[Rival, ...] = RIVALS + ABLATIONS


QUICK = Protocol(32, 2, 10, ("pelvis", "left_wrist"), (5,), (*RIVALS[:-1], QUICK_DNO, *ABLATIONS))
"""A first look: its intervals are wide, and DNO gets a tenth of its looks."""


def run(
    prior: Prior,
    protocol: Protocol | None = None,
    folder: str | Path = FOLDER,
    device: str = "cpu",
    progress: bool = True,
) -> list[dict[str, Any]]:
    """Measure every method; see the module's docstring.

    Args:
        prior: what makes motions.
        protocol: how much is measured; None for the whole of it.
        folder: where results are stored; those of another prior, evaluator, data, number of clips
            or of steps lie apart in it, and so do those of other settings of a method. After a
            change of a sampler, take another folder.
        device: where the network is computed, "cpu" or "cuda".
        progress: whether to show a bar.

    Returns:
        One record a row, held-out data first: ``joint``, ``keys``, ``method``, ``options`` and
        ``scores``, each with its ``mean``, its ``half width`` (95 %) and the ``values`` of all
        seeds. Then for every joint the mean over densities (``keys`` is "all"), and that over
        joints (``joint`` is "average").

    Raises:
        ValueError: for fewer than 32 clips, or fewer than 2 seeds.
    """
    p = protocol or Protocol()
    if p.clips < 32 or p.seeds < 2:
        raise ValueError(f"control: at least 32 clips and 2 seeds, not {p.clips} and {p.seeds}")
    reference = features_of(held_out(16 * p.clips, FRAMES, REFERENCE).positions)
    place = Path(folder) / f"{fingerprint(prior)}-{fingerprint(reference)}-{p.clips}-{p.steps}"
    velocity, noise_std = elsewhere(prior, device), prior.noise_std
    data: list[dict[str, float]] = []
    cells: dict[tuple[str, int, Rival], list[dict[str, float]]] = {}
    times: dict[Rival, float] = {}
    names = list(itertools.product(p.joints, p.densities, p.rivals))
    with tqdm(total=p.seeds * len(names), disable=not progress, unit="cell") as bar:
        for rival in p.rivals:
            bar.set_description(f"time of {rival.name}")
            clock = partial(timed, velocity, noise_std, rival, p.steps)
            times[rival] = stored(place / rival.spelled / f"time-{device}.json", clock)[TIME]
        for seed in range(p.seeds):
            others = held_out(p.clips, FRAMES, OTHERS + seed)
            data.append(score(others.positions, others, None, reference, seed))
            wished = held_out(p.clips, FRAMES, WISHED + seed)
            for joint, keys, rival in names:
                bar.set_description(f"seed {seed}, {joint}, {keys} keys, {rival.name}")
                task = Task(joint, keys, FRAMES)
                work = partial(
                    measured, velocity, noise_std, rival, task, wished, p.steps, seed, reference
                )
                path = place / rival.spelled / f"{joint}-{keys}" / f"seed-{seed}.json"
                cells.setdefault((joint, keys, rival), []).append(stored(path, work))
                bar.update(1)
    rows = [record(data, method=DATA, joint=ALL, keys=ALL, options={}, protocol=p)]
    return rows + summarised(cells, times, p)


def measured(
    velocity: Velocity,
    noise_std: float | torch.Tensor,
    rival: Rival,
    task: Task,
    wished: Clips,
    steps: int,
    seed: int,
    reference: Features,
) -> dict[str, float]:
    """One cell: sample one way with one seed, and score it."""
    made = make(velocity, noise_std, rival, task, wished, steps, seed)
    return score(made.positions, wished, made, reference, seed)


def timed(
    velocity: Velocity, noise_std: float | torch.Tensor, rival: Rival, steps: int
) -> dict[str, float]:
    """Seconds of a method over those of a sample without a wish, taken in turns."""
    task, count = TIMED
    clips = held_out(count, FRAMES, WISHED)

    def work(way: Rival) -> Callable[[], Made]:
        return partial(make, velocity, noise_std, way, task, clips, steps, 0)

    return {TIME: 1.0 if rival == FREE else time_ratio(work(rival), work(FREE))}


def score(
    positions: NDArray, clips: Clips, made: Made | None, reference: Features, seed: int
) -> dict[str, float]:
    """The columns of the table, each over a whole set of clips; without a wish no errors."""
    own = features_of(positions)
    row = score_clips(positions, clips.captions, seed=seed)
    row["kinetic distance"] = frechet_distance(own.kinetic, reference.kinetic)
    row["FID"] = frechet_distance(own.points, reference.points)
    if made is not None:
        errors = control_errors(positions, made.targets)
        row |= {f"{name} error": float(e.mean()) for name, e in errors._asdict().items()}
        row["residual"] = float(np.nanmax(np.abs(positions - made.targets)))
    return {name: row[name] for name in COLUMNS if name in row}


def record(values: list[dict[str, float]], protocol: Protocol, **about: Any) -> dict[str, Any]:
    """One row: what it is of, and its scores over seeds."""
    scores = {}
    for name in (name for name in COLUMNS if name in values[0]):
        column = [row[name] for row in values]
        mean, half = interval(column)
        scores[name] = {"mean": mean, "half width": half, "values": column}
    extent = {"clips": protocol.clips, "seeds": len(values), "steps": protocol.steps}
    return about | extent | {"scores": scores}


def summarised(
    cells: dict[tuple[str, int, Rival], list[dict[str, float]]],
    times: dict[Rival, float],
    protocol: Protocol,
) -> list[dict[str, Any]]:
    """A row for every cell, for every joint over densities, and for all joints together."""
    rows = []
    p = protocol
    groups: list[tuple[str, Any, Sequence[str], Sequence[int]]] = [
        *((joint, keys, (joint,), (keys,)) for joint in p.joints for keys in p.densities),
        *((joint, ALL, (joint,), p.densities) for joint in p.joints),
        *(("average", keys, p.joints, (keys,)) for keys in p.densities),
        ("average", ALL, p.joints, p.densities),
    ]
    for (joint, keys, joints, densities), rival in itertools.product(groups, p.rivals):
        parts = [cells[j, k, rival] for j in joints for k in densities]
        values = [mean_of([part[seed] for part in parts]) for seed in range(p.seeds)]
        about = {"joint": joint, "keys": keys, "method": rival.name, "options": dict(rival.options)}
        rows.append(record(values, p, **about) | {TIME: times[rival]})
    return rows


def mean_of(parts: list[dict[str, float]]) -> dict[str, float]:
    """Mean of every column; of the residual the largest."""
    row = {name: float(np.mean([part[name] for part in parts])) for name in parts[0]}
    return row | {"residual": max(part["residual"] for part in parts)}


def main() -> None:
    """Measure, print the table, and write the records and the picture."""
    usual = Protocol()
    parser = argparse.ArgumentParser(description="Every zero-shot method on one protocol.")
    parser.add_argument("--prior", type=Path, help="a checkpoint (default: the shipped one)")
    parser.add_argument("--quick", action="store_true", help="minutes; wide intervals")
    parser.add_argument("--clips", type=int, default=usual.clips, help="of a cell (default 128)")
    parser.add_argument("--seeds", type=int, default=usual.seeds, help="default 4")
    parser.add_argument("--steps", type=int, default=usual.steps, help="of sampling (default 25)")
    parser.add_argument("--joints", nargs="+", default=JOINTS, help="default: all six")
    parser.add_argument("--methods", nargs="+", help="names in the table (default: all)")
    parser.add_argument("--device", default="cpu", help="of the network: cpu or cuda")
    parser.add_argument("--folder", type=Path, default=FOLDER, help="for results as they are made")
    parser.add_argument("--out", type=Path, help="folder for results/ and pictures/")
    options = parser.parse_args()
    rivals = tuple(r for r in usual.rivals if options.methods is None or r.name in options.methods)
    counts = (options.clips, options.seeds, options.steps)
    protocol = (
        QUICK if options.quick else Protocol(*counts, tuple(options.joints), DENSITIES, rivals)
    )
    prior = load_prior(options.prior)
    rows = run(prior, protocol, options.folder, options.device)
    print(table(rows))
    if options.out:
        for part in ("results", "pictures"):
            (options.out / part).mkdir(parents=True, exist_ok=True)
        text = json.dumps({"prior": fingerprint(prior), "rows": rows}, indent=1)
        (options.out / "results/control.json").write_text(text + "\n")
        figure(rows, options.out / "pictures/control.png")


if __name__ == "__main__":
    main()
