"""How far is a projection from the least it could cost: one pass over its arrays?

A projection has to read the motion, the targets, the variances and its own tables once, and to
write a motion. The pass copies the same arrays, one after the other, and does no arithmetic. Small
problems are all overhead: a call of torch takes microseconds however little there is to do.
"""

from __future__ import annotations

from typing import Any

import measuring
import torch

import projflow_lite as pf

FRAMES, BATCHES = (60, 196, 784), (1, 16, 64)


def tensors_of(thing: Any, seen: set[int] | None = None) -> list[torch.Tensor]:
    """All tensors that an object holds, itself or in what it holds, each once."""
    seen = set() if seen is None else seen
    if id(thing) in seen:
        return []
    seen.add(id(thing))
    if isinstance(thing, torch.Tensor):
        return [thing]
    inside = (
        thing if isinstance(thing, list | tuple) else list(getattr(thing, "__dict__", {}).values())
    )
    return [tensor for part in inside for tensor in tensors_of(part, seen)]


def measure(name: str, frames: int, batch: int, seconds: float) -> dict[str, Any]:
    """Time a projection against a copy of the arrays that it works on."""
    case = measuring.problem(frames, *measuring.CASES[name], batch, torch.float32)
    projector = pf.Projector(case.rows)
    arrays = [case.x1_hat, *tensors_of(projector)]
    arrays += [case.variance] if case.variance is not None else []
    copies = [torch.empty_like(array) for array in arrays]

    def one_pass() -> None:
        for copy, array in zip(copies, arrays, strict=True):
            copy.copy_(array)

    runs = {"projection": lambda: projector.project(case.x1_hat, case.variance), "pass": one_pass}
    times = measuring.take_turns(runs, seconds)
    return {
        "case": name,
        "frames": frames,
        "batch": batch,
        "arrays, MB": sum(array.nbytes for array in arrays) / 1e6,
        "pass, ms": 1e3 * times["pass"].best,
        "projection, ms": 1e3 * times["projection"].best,
        "projection / pass": times["projection"].best / times["pass"].best,
    }


def draw(figure: Any, rows: list[dict[str, Any]]) -> None:
    """The ratio over frames, a panel for each case, a line for each batch."""
    panels = figure.subplots(1, len(measuring.CASES), sharey=True)
    for axes, name in zip(panels, measuring.CASES, strict=True):
        mine = [row for row in rows if row["case"] == name]
        for batch in sorted({row["batch"] for row in mine}):
            points = [(r["frames"], r["projection / pass"]) for r in mine if r["batch"] == batch]
            axes.plot(*zip(*points, strict=True), "o-", label=f"batch {batch}", ms=4)
        frames = sorted({row["frames"] for row in mine})
        axes.set_xscale("log")
        axes.set_xticks(frames, frames)
        axes.minorticks_off()
        axes.set_title(name, fontsize=9)
        axes.set_xlabel("frames")
        axes.grid(alpha=0.3)
    panels[0].set_ylabel("projection / one pass over memory")
    panels[0].set_ylim(bottom=0)
    panels[0].legend(frameon=False)


def main(arguments: list[str] | None = None) -> None:
    """Run everything and report it."""
    options = measuring.read_options(__doc__, arguments)
    rows = [
        measure(name, frames, batch, 0.02 if options.quick else 0.15)
        for name in measuring.CASES
        for frames in ((8,) if options.quick else FRAMES)
        for batch in ((1, 4) if options.quick else BATCHES)
    ]
    measuring.report(options, __doc__, rows, draw=draw)


if __name__ == "__main__":
    main()
