"""How much memory does a projection take at its peak, and how much do its rivals?

Every number comes from a fresh process, for memory that was once taken is seldom given back: the
growth of its peak resident memory from just before the work, when everything is imported and the
problem stands ready, to just after it. That counts torch, numpy and LAPACK alike.
"""

from __future__ import annotations

import contextlib
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import measuring
import torch
from projection import rivals

import projflow_lite as pf

CASE = "five joints, a quarter of the frames"
FULL = [
    ("projection", 60, 1), ("projection", 196, 1), ("projection", 196, 16), ("projection", 196, 64),
    ("projection", 784, 16), ("sparse direct", 196, 1), ("sparse KKT", 196, 1),
    ("full Cholesky", 196, 1), ("dense formula", 60, 1),
]  # fmt: skip
QUICK = [("projection", 60, 16), ("full Cholesky", 60, 1)]


def work(way: str, case: measuring.Problem) -> Callable[[], object]:
    """What is done for a projection from the start: set up, and project once."""

    def project() -> torch.Tensor:
        projector = pf.Projector(case.rows, dtype=case.x1_hat.dtype)
        return projector.project(case.x1_hat, case.variance)

    return project if way == "projection" else lambda: rivals(case, [way])[way]()


def peak() -> float:
    """Largest resident memory of this process so far, MB."""
    unit = 1e6 if sys.platform == "darwin" else 1e3
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit


def forget_peak() -> None:
    """Let the peak begin anew from what is held now; where that cannot be, imports count too."""
    with contextlib.suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")


def growth(way: str, frames: int, batch: int) -> float:
    """Do the work and say by how many MB the peak has grown; once in a process."""
    torch.set_num_threads(1)
    work(
        way, measuring.problem(4, *measuring.CASES[CASE])
    )()  # whatever libraries load at first use
    do = work(way, measuring.problem(frames, *measuring.CASES[CASE], batch))
    forget_peak()
    before = peak()
    do()
    return peak() - before


def measure(way: str, frames: int, batch: int) -> dict[str, Any]:
    """Ask a fresh process."""
    code = f"import memory; print(memory.growth({way!r}, {frames}, {batch}))"
    run = subprocess.run(
        [sys.executable, "-c", code], cwd=Path(__file__).parent, capture_output=True, text=True
    )
    if run.returncode:
        raise SystemExit(f"memory: {way} at {frames} frames failed\n{run.stderr}")
    motion = batch * frames * 22 * 3 * 8 / 1e6
    grown = float(run.stdout)
    return {
        "way": way, "frames": frames, "batch": batch, "motions, MB": motion,
        "peak grows by, MB": grown, "peak / motions": grown / motion,
    }  # fmt: skip


def draw(figure: Any, rows: list[dict[str, Any]]) -> None:
    """A bar for each measurement."""
    axes = figure.subplots()
    names = [f"{row['way']}, {row['frames']} frames, batch {row['batch']}" for row in rows]
    axes.barh(names[::-1], [row["peak grows by, MB"] for row in rows[::-1]], color="#0072B2")
    axes.set(xscale="symlog", xlabel="growth of the peak memory, MB")


def main(arguments: list[str] | None = None) -> None:
    """Run everything and report it."""
    options = measuring.read_options(__doc__, arguments)
    rows = [measure(*each) for each in (QUICK if options.quick else FULL)]
    measuring.report(options, __doc__, rows, draw=draw)


if __name__ == "__main__":
    main()
