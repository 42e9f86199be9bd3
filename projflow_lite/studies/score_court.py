"""Held-out motion, ways to damage it, and what the scores make of that."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from data_synth import Clips, held_out
from projflow_lite.scores import (
    bone_length_error,
    defects,
    frechet_distance,
    kinetic_features,
    load_evaluator,
    score_clips,
)
from projflow_lite.skeleton import bone_lengths

TRUE_BONES = "true bone error %"
"""Against the lengths that the undamaged body has; the usual one takes a clip's own median."""

SHOWN = (
    "FID", "kinetic distance", "diversity", "R top 1", "R top 3", "matching", "bone error %",
    TRUE_BONES, "skating gmd", "skating bmm", "jerk", "worst acceleration",
)  # fmt: skip

FINEST = {"bone error %": 0.1, TRUE_BONES: 0.1, "R top 1": 0.03, "R top 3": 0.03}
"""Where data hardly scatters: a smaller difference is none. Bones are compared with 0.1 %."""

SEEDS = {"shown": 41, "reference": 42, "known": 43, "floor": 44}


class Fault(NamedTuple):
    """A way to damage motion, the sizes that a slider offers, and their unit."""

    apply: Callable[[NDArray, float], NDArray] | None
    sizes: tuple[float, ...]
    unit: str


FAULTS = {
    "one-frame spike": Fault(defects.spike, (0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5), "m"),
    "sliding body": Fault(
        defects.slide, (0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.45, 0.49, 0.51, 0.6), "m/s"
    ),
    "long forearm": Fault(defects.stretch, (0, 0.05, 0.1, 0.2, 0.3, 0.5, 1.0), "of its length"),
    "too smooth": Fault(defects.smooth, (0, 0.5, 1, 1.5, 2, 3, 4), "frames"),
    "parrot": Fault(None, (512, 256, 128, 64, 32, 16, 8, 4, 1), "clips known"),
}


class Range(NamedTuple):
    """What the undamaged clips score, and by how much two sets of as many clips differ by chance.

    The ``reach`` is two standard deviations of such a difference.
    """

    own: float
    reach: float


class Court:
    """Held-out data that plays every part: what is damaged, compared with, known, and the floor.

    Args:
        clips: in the set that is damaged, and in each set of the floor; a multiple of 32.
        sets: sets that the floor is measured on.
    """

    def __init__(self, clips: int = 96, sets: int = 8) -> None:
        self.judge = load_evaluator()
        self.shown = held_out(clips, seed=SEEDS["shown"])
        self.known = held_out(512, seed=SEEDS["known"])
        self.known_points = self.judge.embed_motion(self.known.positions)
        self.text_points = self.judge.embed_text(self.shown.captions)
        reference = held_out(512, seed=SEEDS["reference"]).positions
        self.points, self.kinetic = self.judge.embed_motion(reference), kinetic_features(reference)
        self.floor = self._floor(held_out(sets * clips, seed=SEEDS["floor"]), sets)

    def damaged(self, fault: str, size: float) -> tuple[NDArray, NDArray]:
        """Damaged motion ``(clips, frames, 22, 3)``, and the motion that it was.

        A parrot damages nothing: it answers with other clips, `size` of which it knows.
        """
        apply = FAULTS[fault].apply
        if apply is not None:
            return apply(self.shown.positions, size), self.shown.positions
        answers = defects.parrot(self.text_points, self.known_points[: round(size)])
        said = self.known.positions[answers]
        return said, said

    def scores(self, positions: NDArray, was: NDArray, captions: list[str]) -> dict[str, float]:
        """All of `SHOWN` for a set of clips, and the true lengths of what it was."""
        row = score_clips(positions, captions)
        row["FID"] = frechet_distance(self.judge.embed_motion(positions), self.points)
        row["kinetic distance"] = frechet_distance(kinetic_features(positions), self.kinetic)
        true = np.median(bone_lengths(was), axis=-2)
        row[TRUE_BONES] = 100 * float(bone_length_error(positions, true).mean())
        return {name: row[name] for name in SHOWN}

    def _floor(self, data: Clips, sets: int) -> dict[str, Range]:
        """What the undamaged set scores, and how much other sets scatter."""
        x = self.shown.positions
        own, rows = self.scores(x, x, self.shown.captions), []
        for part in np.array_split(np.arange(len(data.captions)), sets):
            x = data.positions[part]
            rows.append(self.scores(x, x, [data.captions[k] for k in part]))
        floor = {}
        for name in SHOWN:
            # The difference of two independent sets has twice the variance of one.
            scatter = np.std([row[name] for row in rows], ddof=1) * np.sqrt(2)
            floor[name] = Range(own[name], max(2 * float(scatter), FINEST.get(name, 0.0)))
        return floor


def noticed(value: float, floor: Range) -> bool:
    """Does a score differ from the undamaged one by more than two sets of data do?"""
    return abs(value - floor.own) > floor.reach


def multiple(name: str, value: float, floor: Range) -> float:
    """A score in multiples of the undamaged one; of bones, that never change, of 0.1 %."""
    least = FINEST[name] if name.endswith("bone error %") else 0.0
    return max(value, least) / max(floor.own, least)


def floor_by_size(
    sizes: tuple[int, ...] = (32, 64, 128, 256, 512),
    fault: str = "too smooth",
    size: float = 2,
    repetitions: int = 5,
    pool: int = 1024,
) -> dict[str, NDArray]:
    """FID of held-out data, and of damaged data, against other data, over the number of clips.

    Args:
        sizes: numbers of clips, the same on both sides.
        fault: one of `FAULTS` that damages clips.
        size: of the fault.
        repetitions: how often clips are drawn for each number.
        pool: clips that each side is drawn from; as many as the largest number, or more.

    Returns:
        ``sizes``, and ``data`` and ``damaged`` ``(sizes, repetitions)``.
    """
    judge, random = load_evaluator(), np.random.default_rng(0)
    x, other = (held_out(pool, seed=seed).positions for seed in (51, 52))
    apply = FAULTS[fault].apply
    if apply is None or pool < max(sizes):
        raise ValueError(f"floor_by_size: '{fault}' damages no clip, or {pool} clips are too few")
    sides = {"data": judge.embed_motion(x), "damaged": judge.embed_motion(apply(x, size))}
    reference = judge.embed_motion(other)
    found = {name: np.zeros((len(sizes), repetitions)) for name in sides}
    for i, count in enumerate(sizes):
        for k in range(repetitions):
            mine, theirs = (random.choice(pool, count, replace=False) for _ in range(2))
            for name, points in sides.items():
                found[name][i, k] = frechet_distance(points[mine], reference[theirs])
    return {"sizes": np.array(sizes)} | found
