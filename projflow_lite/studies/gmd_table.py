"""GMD beside ProjFlow: the same clips, the same keyframes, from one to all.

Guided motion diffusion overwrites what is known and pushes; what its parts add is measured one by
one: imputation, emphasis, guidance, two stages; over the density of keyframes, over tau, and around
obstacles, where projection has nothing to offer. Keyframes are x and z of the pelvis. Every result
is stored as it is made, so an interrupted run goes on from where it was.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm.auto import tqdm

from data_synth import Clips, held_out
from projflow_lite.scores import control_errors, frechet_distance
from projflow_lite.scores.clips import physics
from projflow_lite.skeleton import FEET, bone_lengths
from projflow_lite.studies.cells import (
    DATA,
    Features,
    features_of,
    fingerprint,
    over_seeds,
    stored,
)
from projflow_lite.studies.gmd_figure import figure
from projflow_lite.studies.gmd_ways import (
    GROUND,
    Models,
    Way,
    all_ways,
    load_models,
    make,
    post_of,
    targets_of,
    walks,
)
from projflow_lite.studies.keyframes import FRAMES
from projflow_lite.studies.shares import take_share

__all__ = ["figure", "load_models", "run", "table"]

FOLDER = Path("runs/gmd-table")
REFERENCE, WISHED, WALKED, OTHERS = 1000, 2000, 2500, 3000
"""Seeds of held-out clips: to compare with, to ask for, and what data itself scores."""

COLUMNS = {
    "keyframes": (
        "error, m", "location error %", "trajectory error %", "FID", "kinetic distance",
        "skating gmd", "walked %", "bone error %", "tear %", "worst acceleration", "ms",
    ),
    "obstacle": ("depth, cm", "frames inside %", "clear %", "error, m", "bone error %", "ms"),
}  # fmt: skip
COLUMNS["tau"] = COLUMNS["keyframes"]


def run(
    models: Models,
    quick: bool = False,
    clips: int = 64,
    seeds: int = 4,
    folder: str | Path = FOLDER,
    progress: bool = True,
) -> list[dict[str, Any]]:
    """Measure every way; see the module's docstring.

    Args:
        models: what makes motions, see `load_models`.
        quick: a quarter of the clips, three seeds, two densities: minutes instead of an hour.
        clips: motions of a way and seed.
        seeds: each with other clips and noise, the same ones for every way.
        folder: where results are stored; those of other priors lie apart in it. After a change of
            the sampler, take another folder.
        progress: whether to show a bar.

    Returns:
        One record a row, held-out data first: the way, and ``scores``, each with its ``mean``, its
        ``half width`` (95 %) and the ``values`` of all seeds.

    Raises:
        ValueError: for fewer than 16 clips or 2 seeds.
    """
    if clips < 16 or seeds < 2:
        raise ValueError(f"gmd_table: at least 16 clips and 2 seeds, not {clips} and {seeds}")
    if quick:
        clips, seeds = max(16, clips // 4), 3
    reference = features_of(held_out(16 * clips, FRAMES, REFERENCE).positions)
    place = Path(folder) / f"{fingerprint_of(models)}-{fingerprint(reference)}-{clips}"
    found: dict[Way | None, list[dict[str, float]]] = {None: []}
    found |= {way: [] for way in all_ways(models, quick)}
    with tqdm(total=seeds * (len(found) - 1), disable=not progress, unit="way") as bar:
        for seed in range(seeds):
            others = held_out(clips, FRAMES, OTHERS + seed).positions
            found[None].append(quality(others, reference))
            wished = {"obstacle": walks(clips, WALKED + seed)}
            usual = held_out(clips, FRAMES, WISHED + seed)
            jobs = {}
            for way in filter(None, found):
                path, asked = place / way.name / f"seed-{seed}.json", wished.get(way.task, usual)
                measure = partial(measured, models, way, asked, seed, reference)
                jobs[way] = path, partial(stored, path, measure)
            take_share(jobs.values())
            for way, (_, work) in jobs.items():
                bar.set_description(f"{way.task}, {way.method}")
                found[way].append(work())
                bar.update()
    return [record(way, values, clips) for way, values in found.items()]


def measured(
    models: Models, way: Way, clips: Clips, seed: int, reference: Features
) -> dict[str, float]:
    """Sample one way with one seed, and score it."""
    x, seconds = make(models, way, clips, seed)
    errors = control_errors(x, targets_of(x, clips, way))
    row = {
        "error, m": float(errors.average.mean()),
        "location error %": 100 * float(errors.location.mean()),
        "trajectory error %": 100 * float(errors.trajectory.mean()),
    }
    row |= quality(x, reference)
    if way.task == "obstacle":
        depth = post_of(clips).depth(x).numpy()
        row["depth, cm"] = 100 * float(depth.max(1).mean())
        row["frames inside %"] = 100 * float((depth > 0).mean())
        row["clear %"] = 100 * float((depth == 0).all(1).mean())
    row["ms"] = 1000 * seconds
    return {name: row[name] for name in COLUMNS[way.task] if name in row}


def quality(positions: NDArray, reference: Features) -> dict[str, float]:
    """The columns that know nothing of a wish, each over a whole set of clips."""
    own = features_of(positions)
    row = {
        "kinetic distance": frechet_distance(own.kinetic, reference.kinetic),
        "FID": frechet_distance(own.points, reference.points),
        "tear %": 100 * float(tears(positions).mean()),
        "walked %": 100 * walked(positions),
    }
    row |= physics(list(positions))
    return {name: row[name] for name in COLUMNS["keyframes"] if name in row}


def tears(positions: NDArray) -> NDArray:
    """The largest relative change of a bone in any frame against its median, ``(clips,)``."""
    lengths = bone_lengths(positions)
    usual = np.median(lengths, axis=1, keepdims=True)
    return np.abs(lengths / usual - 1).max((1, 2))


def walked(positions: NDArray) -> float:
    """Share of the pelvis' way that its standing foot walks, over a set of clips.

    1 for feet that are planted, 0 for bodies that are carried: GMD's motion incoherence.

    Args:
        positions: ``(clips, frames, 22, 3)``, metres.
    """
    way = np.diff(positions[:, :, 0][..., GROUND], axis=1)
    feet = positions[:, :, FEET]
    back = -np.diff(feet[..., GROUND] - positions[:, :, :1][..., GROUND], axis=1)
    lower = feet[:, 1:, :, 1].argmin(-1)[..., None, None]
    standing = np.take_along_axis(back, lower, axis=2)[:, :, 0]
    length = np.linalg.norm(way, axis=-1)
    along = (standing * way).sum(-1) / np.maximum(length, 1e-9)
    return float(along.sum() / length.sum())


def fingerprint_of(models: Models) -> str:
    """Tells these priors' weights from others."""
    parts: list[Any] = [models.plain, *models.emphasised.values(), models.planner]
    return "-".join(fingerprint(part)[:4] for part in parts)


def record(way: Way | None, values: list[dict[str, float]], clips: int) -> dict[str, Any]:
    """One row: how it was sampled and what it scored."""
    about: dict[str, Any] = way._asdict() if way else {"task": DATA, "method": DATA}
    scores = over_seeds(values, tuple(values[0]))
    return about | {"clips": clips, "seeds": len(values), "scores": scores}


def table(rows: list[dict[str, Any]]) -> str:
    """The records as text, one line each, task by task."""
    data = rows[0]
    lines = [
        f"{data['seeds']} seeds of {data['clips']} clips each. Mean ± 95 %. Keyframes: x and z of "
        "the pelvis. ms: for one motion, on this machine.",
    ]
    for task, names in COLUMNS.items():
        label = {"keyframes": "keys", "tau": "tau", "obstacle": "scale"}[task]
        lines += ["", task, f"{'method':34s}{label:>6s}" + "".join(f"{n:>20s}" for n in names)]
        for row in rows:
            if row["task"] == task or row is data:
                value = row.get({"keyframes": "keys"}.get(task, label), "")
                lines.append(f"{row['method']:34s}{value!s:>6s}" + cells(row, names))
    return "\n".join(lines)


def cells(row: dict[str, Any], names: tuple[str, ...]) -> str:
    """The numbers of one line."""
    found = (row["scores"].get(name) for name in names)
    shown = (f"{c['mean']:.3f} ± {c['half width']:.3f}" if c else "" for c in found)
    return "".join(f"{cell:>20s}" for cell in shown)
