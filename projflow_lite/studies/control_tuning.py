"""The settings with which every method enters the study of control, chosen alike for all.

Each method brings a few settings of its own. They are tried on captions and keyframes that the
study itself never uses, on the pelvis and a wrist, at two densities. Among those whose keyframes
are missed by no more than `NEAR` on average, the one with the smallest kinetic distance is chosen:
that distance sees torn bodies, which FID hardly does. If none comes so near, the nearest is chosen.

``python -m projflow_lite.studies.control_tuning`` prints all of them; the winners are to be written
into `control_ways`, or go into the study at once with ``--run``.
"""

from __future__ import annotations

import argparse
import itertools
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from tqdm.auto import tqdm

from data_synth import held_out
from projflow_lite.prior import Prior, load_prior
from projflow_lite.studies.cells import Rival, features_of, fingerprint, mean_of, stored
from projflow_lite.studies.control import FOLDER, Protocol, measured, run, table
from projflow_lite.studies.control_ways import ABLATIONS, FREE, OURS, RIVALS, TUNED, Task, elsewhere
from projflow_lite.studies.keyframes import FRAMES

NEAR = 0.05
"""Metres by which keyframes may be missed on average."""

TASKS = tuple(Task(joint, keys, FRAMES) for joint in ("pelvis", "left_wrist") for keys in (2, 15))
REFERENCE, WISHED = 7000, 8000
"""Seeds of held-out clips, apart from those of the study."""

GRIDS: dict[str, dict[str, tuple[Any, ...]]] = {
    "projflow, tuned": {
        "eta": ("paper", 0.0), "c0": (3.0, 30.0), "tau_min": (0.1, 1.0), "lambda_s": (1.0, 0.0),
        "w_kin": (10.0, 3.0),
    },
    "metric over time": {"until": (0.9, 0.95, 0.98), "eta": ("paper", 0.0)},
    "ddnm": {"eta": (0.0, "ddpm", "paper")},
    "replacement": {"noise": ("original", "fresh")},
    "imputation": {"until": (0.97, 1.0)},
    "gmd": {"pull": (10.0, 20.0, 40.0), "until": (0.99, 1.0)},
    "flowdps": {"step": (0.5, 1.0, 1.5), "iterations": (1, 3)},
    "pnp_flow": {"step": (0.5, 1.0), "alpha": (0.0, 0.5, 1.0)},
    "flowchef": {"step": (0.1, 0.25, 0.5, 1.0)},
    "dps": {"scale": (3.0, 10.0, 30.0, 100.0)},
    "dps, endpoint": {"scale": (0.1, 0.3, 0.6, 1.0)},
    "dno": {"rate": (0.05, 0.2), "decorrelate": (0.0, 1000.0)},
}  # fmt: skip
"""What is tried of each method: every combination. As many as matter, and never more than six; but
ProjFlow's own constants are searched more widely, for a row of their own beside the paper's."""


class Tried(NamedTuple):
    """One setting of a method and its mean scores over tasks and seeds."""

    rival: Rival
    scores: dict[str, float]


def settings_of(rival: Rival) -> list[Rival]:
    """The settings of a method that are tried."""
    grid = GRIDS.get(rival.name, {})
    found = []
    for values in itertools.product(*grid.values()):
        options = dict(rival.options) | dict(zip(grid, values, strict=True))
        found.append(rival._replace(options=tuple(options.items())))
    return found


def tune(
    prior: Prior,
    rivals: tuple[Rival, ...] = RIVALS + OURS + TUNED,
    clips: int = 64,
    seeds: int = 2,
    steps: int = 25,
    folder: str | Path = FOLDER,
    device: str = "cpu",
    progress: bool = True,
) -> list[list[Tried]]:
    """Try all settings of every method.

    Args:
        prior: what makes motions.
        rivals: the methods; those without a grid are tried as they are.
        clips: motions for each task and seed, 32 at least.
        seeds: each with other captions, keyframes and noise.
        steps: of sampling.
        folder: where results are stored as they are made.
        device: where the network is computed.
        progress: whether to show a bar.

    Returns:
        For every method its settings, in the order of the grid.
    """
    reference = features_of(held_out(16 * clips, FRAMES, REFERENCE).positions)
    place = Path(folder) / f"tuning-{fingerprint(prior)}-{fingerprint(reference)}-{clips}-{steps}"
    velocity = elsewhere(prior, device)
    wished = [held_out(clips, FRAMES, WISHED + seed) for seed in range(seeds)]
    found = []
    bar = tqdm([settings_of(rival) for rival in rivals], disable=not progress, unit="method")
    for settings in bar:
        bar.set_description(settings[0].name)
        tried = []
        for rival in settings:
            parts = []
            for task, seed in itertools.product(TASKS, range(seeds)):
                work = partial(
                    measured, velocity, prior.noise_std, rival, task, wished[seed], steps, seed,
                    reference,
                )  # fmt: skip
                name = f"{task.joint}-{task.keys}/seed-{seed}.json"
                parts.append(stored(place / rival.spelled / name, work))
            tried.append(Tried(rival, mean_of(parts)))
        found.append(tried)
    return found


def best(tried: list[Tried]) -> Tried:
    """The setting to take, see the module's docstring."""
    near = [one for one in tried if one.scores["average error"] <= NEAR]
    if near:
        return min(near, key=lambda one: one.scores["kinetic distance"])
    return min(tried, key=lambda one: one.scores["average error"])


def listing(found: list[list[Tried]]) -> str:
    """Everything that was tried as text, a star at what is taken."""
    columns = ("average error", "kinetic distance", "FID", "bone error %", "worst acceleration")
    width = max(len(words_of(one.rival)) for tried in found for one in tried)
    lines = ["  ".ljust(width + 2) + "".join(f"{name:>20s}" for name in columns)]
    for tried in found:
        taken = best(tried)
        for one in tried:
            star = "*" if one is taken else " "
            cells = "".join(f"{one.scores[name]:20.4f}" for name in columns)
            lines.append(f"{star} {words_of(one.rival).ljust(width)}{cells}")
    return "\n".join(lines)


def words_of(rival: Rival) -> str:
    """Its name and its settings."""
    return f"{rival.name}: {', '.join(f'{key} {value}' for key, value in rival.options)}"


def main() -> None:
    """Try all settings, print them, and run the study with the winners if that was asked for."""
    parser = argparse.ArgumentParser(description="Tune every method of the study of control.")
    parser.add_argument("--prior", type=Path, help="a checkpoint (default: the shipped one)")
    parser.add_argument("--clips", type=int, default=64, help="of a task and seed (default 64)")
    parser.add_argument("--seeds", type=int, default=2, help="default 2")
    parser.add_argument("--methods", nargs="+", help="names in the table (default: all)")
    parser.add_argument("--device", default="cpu", help="of the network: cpu or cuda")
    parser.add_argument("--folder", type=Path, default=FOLDER, help="for results as they are made")
    parser.add_argument("--run", action="store_true", help="then run the study with the winners")
    options = parser.parse_args()
    rivals = tuple(
        rival
        for rival in RIVALS + OURS + TUNED
        if rival != FREE and (options.methods is None or rival.name in options.methods)
    )
    prior = load_prior(options.prior)
    found = tune(
        prior, rivals, options.clips, options.seeds,
        folder=options.folder, device=options.device,
    )  # fmt: skip
    print(listing(found))
    if options.run:
        winners = [best(tried).rival for tried in found]
        protocol = Protocol(rivals=(FREE, *winners, *ABLATIONS))
        print(table(run(prior, protocol, options.folder, options.device)))


if __name__ == "__main__":
    main()
