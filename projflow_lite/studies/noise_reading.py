"""Which noise should eq. 9 of ProjFlow mix, and how much of it should be fresh?

Printed, it is the noise that sampling began with. Released code takes the noise that the current
state and velocity imply. Here both are measured, over guidance, density of keyframes and joint, on
prompts and keyframes of held-out clips, with an interval over seeds.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from tqdm.auto import tqdm

from data_synth import Clips, held_out
from projflow_lite import scores
from projflow_lite.constraints import pin
from projflow_lite.prior import Prior
from projflow_lite.samplers import ProjectionStep, flow_times, guided, projflow, sample
from projflow_lite.skeleton import joint_index

FRAMES = 60

READINGS: dict[str, dict[str, Any]] = {
    "original": {"noise": "original", "eta": "paper"},
    "implied": {"noise": "implied", "eta": "paper"},
    "implied, ddpm": {"noise": "implied", "eta": "ddpm"},
    "implied, none fresh": {"noise": "implied", "eta": 0.0},
}


def keyframes(count: int) -> NDArray[np.int64]:
    """`count` frames spread evenly, neither end included unless every frame is asked for."""
    if count == FRAMES:
        return np.arange(FRAMES)
    return np.linspace(0, FRAMES - 1, count + 2).round().astype(int)[1:-1]


def through_keyframes(positions: NDArray, joint: str, keys: int) -> ProjectionStep:
    """A projection step that leads every clip of a batch through keyframes of its own.

    The rows, their factorisation and the guides are shared; only the targets differ.

    Args:
        positions: ``(clips, frames, 22, 3)`` metres: where the targets are taken from.
        joint: the joint that is pinned.
        keys: number of keyframes, see `keyframes`.
    """
    frames = keyframes(keys)
    targets = positions[:, frames, joint_index(joint, "noise_reading")]
    step = ProjectionStep(pin(joint, frames, targets[0]), FRAMES)
    return step.aimed_at(targets.reshape(len(targets), -1))


def controlled(
    prior: Prior,
    clips: Clips,
    joint: str,
    keys: int,
    guidance: float,
    steps: int,
    options: dict[str, Any],
    seed: int,
) -> NDArray:
    """Generate one motion for every clip: its prompt, and some of its keyframes pinned exactly.

    Returns:
        ``(clips, frames, 22, 3)`` metres.
    """
    project = through_keyframes(clips.positions, joint, keys)
    generator = torch.Generator().manual_seed(seed)
    x0 = prior.noise_std * torch.randn(clips.positions.shape, generator=generator)
    with torch.inference_mode():
        x = projflow(
            guided(prior, guidance), project, x0, flow_times(steps), generator, clips.captions,
            noise_std=prior.noise_std, **options,
        )  # fmt: skip
    return x.numpy()


def data(clips: int, seed: int) -> NDArray:
    """Motions of the data itself, other ones for every seed, none of them wished for."""
    return held_out(clips, FRAMES, 2 + seed).positions


def free(prior: Prior, clips: Clips, guidance: float, steps: int, seed: int) -> NDArray:
    """Generate one motion for every prompt, without a wish."""
    texts = clips.captions
    motion = sample(prior, None, texts, FRAMES, steps, seed, batch=len(texts), guidance=guidance)
    return motion.positions


def score(positions: NDArray, reference: NDArray) -> dict[str, float]:
    """The columns of the table, each over a whole set of clips."""
    return {
        "kinetic distance": scores.frechet_distance(
            scores.kinetic_features(positions), scores.kinetic_features(reference)
        ),
        "pose distance": scores.frechet_distance(
            scores.pose_features(positions), scores.pose_features(reference)
        ),
        "bone error %": 100 * float(scores.bone_length_error(positions).mean()),
        "skating": float(scores.foot_skating(positions).mean()),
        "jerk": float(scores.mean_jerk(positions).mean()),
        "worst acceleration": float(np.median(scores.worst_acceleration(positions))),
    }


def repeat(make: Callable[[int], NDArray], reference: NDArray, seeds: int) -> dict[str, Any]:
    """Score several seeds: the mean of each column and a 95 % interval of that mean."""
    columns = [score(make(seed), reference) for seed in range(seeds)]
    row: dict[str, Any] = {}
    for name in columns[0]:
        values = np.array([column[name] for column in columns])
        mean, half = scores.interval(values)
        row[name] = {"mean": mean, "half width": half}
    return row


def run(
    prior: Prior,
    clips: int = 64,
    seeds: int = 3,
    steps: int = 50,
    joints: tuple[str, ...] = ("pelvis", "left_wrist"),
    densities: tuple[int, ...] = (1, 5, FRAMES),
    guidances: tuple[float, ...] = (1.0, 2.0),
) -> list[dict[str, Any]]:
    """Measure every combination; see the module's docstring.

    Returns:
        One record a row: what was asked for and its scores. The first rows are held-out data
        against held-out data, and unconstrained samples.
    """
    wished = held_out(clips, FRAMES, 0)
    reference = held_out(8 * clips, FRAMES, 1).positions
    rows: list[dict[str, Any]] = [
        {"method": "held-out data", "scores": repeat(partial(data, clips), reference, seeds)}
    ]
    for guidance in guidances:
        make = partial(free, prior, wished, guidance, steps)
        row = {"method": "no wish", "guidance": guidance}
        rows.append(row | {"scores": repeat(make, reference, seeds)})
    grid = list(itertools.product(joints, densities, guidances, READINGS))
    for joint, keys, guidance, reading in tqdm(grid, unit="row"):
        make = partial(controlled, prior, wished, joint, keys, guidance, steps, READINGS[reading])
        row = {"method": reading, "joint": joint, "keyframes": keys, "guidance": guidance}
        rows.append(row | {"scores": repeat(make, reference, seeds)})
    return rows


def table(rows: list[dict[str, Any]]) -> str:
    """The records as text, one line each."""
    names = list(rows[0]["scores"])
    lines = [
        f"{'method':20s} {'joint':11s} {'keys':>4s} {'g':>4s}  "
        + "  ".join(f"{n:>18s}" for n in names)
    ]
    for row in rows:
        cells = [f"{c['mean']:9.3f} ±{c['half width']:7.3f}" for c in row["scores"].values()]
        lines.append(
            f"{row['method']:20s} {row.get('joint', ''):11s} {row.get('keyframes', ''):>4} "
            f"{row.get('guidance', ''):>4}  " + "  ".join(cells)
        )
    return "\n".join(lines)
