"""How does the time of a projection grow with frames, batch, keyframes, joints?

One size is varied at a time from the same middle, and a power of it is fitted to the larger half of
the sizes, where overhead no longer hides the growth. Frames and batch should have an exponent of 1:
blocks are solved side by side; it is more while they outgrow one cache after the other. Joints
pinned in the same frame share a block, whose elimination grows with up to the third power of their
number, yet there are 22 at the most. Keyframes change which rows are hard, hardly how many rows
there are.
"""

from __future__ import annotations

from typing import Any

import measuring

import projflow_lite as pf
from projflow_lite.skeleton import JOINTS

MIDDLE = {"frames": 196, "batch": 16, "keyframes, %": 25, "joints": 5}
SIZES = {
    "frames": (49, 98, 196, 392, 784),
    "batch": (1, 4, 16, 32, 64),
    "keyframes, %": (3, 6, 12, 25, 50),
    "joints": (1, 2, 5, 11, 22),
}
QUICK_MIDDLE = {"frames": 8, "batch": 2, "keyframes, %": 25, "joints": 2}
QUICK_SIZES = {
    "frames": (4, 8, 16),
    "batch": (1, 2, 4),
    "keyframes, %": (12, 25, 50),
    "joints": (1, 2, 4),
}


def measure(
    variable: str, sizes: tuple[int, ...], middle: dict[str, int], seconds: float
) -> list[dict[str, Any]]:
    """Time projections that differ in one size, taking turns."""
    runs = {}
    for size in sizes:
        now = middle | {variable: size}
        case = measuring.problem(
            now["frames"], JOINTS[: now["joints"]], now["keyframes, %"] / 100, now["batch"]
        )
        projector = pf.Projector(case.rows, dtype=case.x1_hat.dtype)
        runs[str(size)] = lambda case=case, projector=projector: projector.project(
            case.x1_hat, case.variance
        )
    best = [timing.best for timing in measuring.take_turns(runs, seconds).values()]
    half = (len(sizes) - 1) // 2
    power = measuring.exponent(sizes[half:], best[half:])
    return [
        {"variable": variable, "size": size, "ms": 1e3 * time, "exponent": power}
        for size, time in zip(sizes, best, strict=True)
    ]


def draw(figure: Any, rows: list[dict[str, Any]]) -> None:
    """A panel for each variable."""
    names = list(dict.fromkeys(row["variable"] for row in rows))
    for axes, name in zip(figure.subplots(1, len(names), sharey=True), names, strict=True):
        mine = [row for row in rows if row["variable"] == name]
        axes.loglog([row["size"] for row in mine], [row["ms"] for row in mine], "o-", ms=4)
        sizes = [row["size"] for row in mine]
        axes.set_xticks(sizes, sizes, fontsize=8)
        axes.minorticks_off()
        axes.set(title=f"exponent {mine[0]['exponent']:.2f}", xlabel=name)
        axes.grid(alpha=0.3)
    figure.axes[0].set_ylabel("projection, ms")


def main(arguments: list[str] | None = None) -> None:
    """Run everything and report it."""
    options = measuring.read_options(__doc__, arguments)
    sizes, middle = (QUICK_SIZES, QUICK_MIDDLE) if options.quick else (SIZES, MIDDLE)
    seconds = 0.01 if options.quick else 0.2
    rows = [row for name in sizes for row in measure(name, sizes[name], middle, seconds)]
    measuring.report(options, __doc__, rows, draw=draw)


if __name__ == "__main__":
    main()
