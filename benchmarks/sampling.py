"""What does a wish add to sampling, and is a sample quick enough to drag?

Sampling with a wish against sampling without, at the same prompt, steps and batch, from the call to
the finished motion: what is built once for a wish is in it. See one_step.py for where it goes.

The network does the same work in both, is nearly all of it, and differs by several per cent from
call to call on a machine with other work; a wish costs less than that. So a sample's time is taken
in two parts, the network's calls and the rest, and the best of each is kept: the best network time
of all samples of a batch size, and the best rest with each wish. Their sums are compared.
"""

from __future__ import annotations

from typing import Any

import measuring
import numpy as np
import torch

import projflow_lite as pf
from projflow_lite.samplers import METHODS

PROMPT, FRAMES = "a person walks forward", 60
LIMITS = {1: 1.15, 16: 1.05}
"""How much longer than without a wish a batch of this size may take."""

RATIO = "sum / sum without wish"
LIVE = 0.3
"""Seconds within which a sample follows the hand that drags."""


def wishes() -> dict[str, pf.Wish]:
    """What people ask for, each with a name."""
    random = np.random.default_rng(0)
    path = np.cumsum(random.normal(scale=0.02, size=(FRAMES, 3)), axis=0) + [0.3, 1.2, 0.3]
    keys = np.sort(random.choice(FRAMES, FRAMES // 4, replace=False))
    return {
        "a path": pf.pin("left_wrist", None, path),
        "three keyframes": pf.pin("left_wrist", [10, 30, 50], path[[10, 30, 50]]),
        "five joints, a quarter of the frames": pf.pin(
            measuring.FIVE, keys, random.normal(size=(len(keys), len(measuring.FIVE), 3))
        ),
        "a loop": pf.loop(),
        "a box in two hands": pf.offset("left_wrist", "right_wrist", [0.4, 0, 0]),
    }


class Clocked:
    """A prior that adds up the time spent in it."""

    def __init__(self, prior: Any) -> None:
        self.prior, self.noise_std, self.seconds = prior, prior.noise_std, 0.0

    def __call__(self, *arguments: Any) -> torch.Tensor:
        start = measuring.clock()
        v = self.prior(*arguments)
        self.seconds += measuring.clock() - start
        return v


def measure(batch: int, seconds: float, steps: int | None) -> list[dict[str, Any]]:
    """Time samples with each wish and without one, taking turns."""
    prior = pf.load_prior()
    given = {} if steps is None else {"steps": steps}
    cases: dict[str, pf.Wish | None] = {"none": None, **wishes()}
    inside: dict[str, list[float]] = {name: [] for name in cases}

    def sample(name: str) -> None:
        clocked = Clocked(prior)
        pf.sample(clocked, cases[name], PROMPT, FRAMES, batch=batch, **given)
        inside[name].append(clocked.seconds)

    runs = {name: lambda name=name: sample(name) for name in cases}
    times = measuring.take_turns(runs, seconds, turn=0.0)
    rest = {
        name: min(all_ - net for all_, net in zip(times[name].calls, inside[name], strict=True))
        for name in cases
    }
    network = min(min(calls) for calls in inside.values())
    calls = steps or METHODS["projflow"].pace.steps
    return [
        {
            "batch": batch,
            "wish": name,
            "network, ms": 1e3 * network,
            "rest, ms": 1e3 * rest[name],
            RATIO: (network + rest[name]) / (network + rest["none"]),
            "sum / forward pass": calls * (network + rest[name]) / network,
            "whole sample at its best, ms": 1e3 * times[name].best,
            "turns": len(times[name].calls),
        }
        for name in cases
    ]


def bars(rows: list[dict[str, Any]]) -> list[measuring.Bar]:
    """The dearest wish against its limit, and the time that dragging allows."""
    whole = [row for row in rows if row["wish"] in wishes()]
    judged = []
    for batch, limit in LIMITS.items():
        dearest = max((row for row in whole if row["batch"] == batch), key=lambda r: r[RATIO])
        what = f"batch {batch}, dearest wish ({dearest['wish']}): sample with / without"
        judged.append(measuring.Bar(what, dearest[RATIO], limit))
    slowest = max(row["whole sample at its best, ms"] for row in whole if row["batch"] == 1)
    return [
        *judged,
        measuring.Bar("60 frames, default steps, batch 1, dearest wish, ms", slowest, 1e3 * LIVE),
    ]


def draw(figure: Any, rows: list[dict[str, Any]]) -> None:
    """How much each wish adds, beside what it may."""
    axes = figure.subplots()
    names, batches = list(wishes()), sorted({row["batch"] for row in rows})
    for k, batch in enumerate(batches):
        more = {r["wish"]: 100 * (r[RATIO] - 1) for r in rows if r["batch"] == batch}
        place = np.arange(len(names)) + 0.4 * (k - 0.5)
        colour = ["#0072B2", "#E69F00"][k]
        axes.barh(place, [more[name] for name in names], 0.38, color=colour, label=f"batch {batch}")
        if batch in LIMITS:
            axes.axvline(100 * (LIMITS[batch] - 1), color=colour, linestyle="--")
    axes.set_yticks(range(len(names)), names)
    axes.set_xlabel("added to sampling by the wish, % (dashed: the most it may)")
    axes.legend(frameon=False)


def main(arguments: list[str] | None = None) -> None:
    """Run everything and report it."""
    options = measuring.read_options(__doc__, arguments)
    batches, seconds = ((1, 2), 0.01) if options.quick else ((1, 16), 6.0)
    steps = 2 if options.quick else None
    rows = [row for batch in batches for row in measure(batch, seconds, steps)]
    measuring.report(options, __doc__, rows, [] if options.quick else bars(rows), draw)


if __name__ == "__main__":
    main()
