"""What all benchmarks share: problems to solve, a fair clock, and one form of result.

Only ratios of times taken in the same run are worth comparing between machines. So whatever is to
be compared takes turns within one run, and the best time of each is kept: other processes and a
cold cache can only add to a time, never take from it. On one thread the clock is that of the
process: it stands still while others have the processor.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

# Linear algebra on one thread for all, or the times of threads add up. Numpy reads this when it is
# first imported, so benchmarks import this module before anything else.
os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import numpy as np
import scipy
import torch

import projflow_lite as pf
from projflow_lite.constraints import Rows
from projflow_lite.joint_metric import kinematic_joint_metric
from projflow_lite.samplers import Guides
from projflow_lite.skeleton import JOINTS, N_JOINTS

FIVE = ["pelvis", "left_foot", "right_foot", "left_wrist", "right_wrist"]
CASES = {
    "one keyframe": (["left_wrist"], 0.0),
    "five joints, a quarter of the frames": (FIVE, 0.25),
    "everything": (list(JOINTS), 1.0),
}
"""Joints that are pinned, and in which share of the frames; one frame at least."""


class Problem(NamedTuple):
    """One projection.

    Attributes:
        rows: the pins and, between them, the guides.
        x1_hat: ``(batch, frames, 22, 3)``, what is to be projected.
        variance: ``(batch, m)`` of the rows half-way through sampling; other in every step and
            motion. None where every frame is pinned and there is nothing to guide.
    """

    rows: Rows
    x1_hat: torch.Tensor
    variance: torch.Tensor | None


def problem(
    frames: int,
    joints: Sequence[str],
    share: float,
    batch: int = 1,
    dtype: torch.dtype = torch.float64,
) -> Problem:
    """Joints pinned in a share of the frames, with guides between, and motions to project."""
    random = np.random.default_rng(0)
    keys = np.sort(random.choice(frames, max(1, round(share * frames)), replace=False))
    targets = random.normal(size=(len(keys), len(joints), 3))
    x1_hat = torch.as_tensor(random.normal(size=(batch, frames, N_JOINTS, 3)), dtype=dtype)
    guides = Guides(
        pf.pin(list(joints), keys, targets).rows(frames), kinematic_joint_metric(), dtype=dtype
    )
    return Problem(guides.rows, x1_hat, guides.variance(x1_hat, 0.5) if guides else None)


class Timing(NamedTuple):
    """Seconds that the calls took, in the order in which they were made."""

    calls: list[float]

    @property
    def best(self) -> float:
        return min(self.calls)


def clock() -> float:
    """Seconds: of this process on one thread, on the wall on several."""
    return time.process_time() if torch.get_num_threads() == 1 else time.perf_counter()


def take_turns(
    runs: dict[str, Callable[[], object]], seconds: float = 1.0, least: int = 3, turn: float = 0.05
) -> dict[str, Timing]:
    """Time several calls against each other.

    Args:
        runs: what to call, by name.
        seconds: how long each is called in all. What takes longer is called just once.
        least: number of calls of all others.
        turn: seconds until it is the next one's turn; 0 for one call a turn.
    """
    calls: dict[str, list[float]] = {name: [] for name in runs}

    def done(name: str) -> bool:
        spent = sum(calls[name])
        return spent > seconds and (len(calls[name]) >= least or calls[name][0] > seconds)

    while waiting := [name for name in runs if not done(name)]:
        for name in waiting:
            end = clock() + turn
            while True:
                start = clock()
                runs[name]()
                calls[name].append(clock() - start)
                if clock() > end or done(name):
                    break
    return {name: Timing(times) for name, times in calls.items()}


def exponent(sizes: Sequence[float], times: Sequence[float]) -> float:
    """Slope of a straight line through logarithms: time grows like size to this power."""
    return float(np.polyfit(np.log(sizes), np.log(times), 1)[0])


def machine(threads: int) -> str:
    """The machine in one line: processor, system, versions, and how busy it was."""
    model = platform.processor() or platform.machine()
    if Path("/proc/cpuinfo").exists():
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        model = next((x.split(": ")[1] for x in lines if x.startswith("model name")), model)
    busy = f", load {os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else ""
    return (
        f"{model}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()}, "
        f"torch {torch.__version__}, numpy {np.__version__}, scipy {scipy.__version__}, "
        f"{threads} thread(s){busy}"
    )


class Bar(NamedTuple):
    """What was to be reached, and what was measured."""

    what: str
    measured: float
    limit: float
    at_least: bool = False

    @property
    def met(self) -> bool:
        return self.measured >= self.limit if self.at_least else self.measured <= self.limit

    def __str__(self) -> str:
        sign = ">=" if self.at_least else "<="
        verdict = "met" if self.met else "MISSED"
        return f"{verdict}: {self.what} {sign} {self.limit:g}, measured {self.measured:.4g}"


class Options(NamedTuple):
    """How a benchmark was called."""

    quick: bool
    threads: int
    json: Path | None
    plot: Path | None


def read_options(question: str, arguments: Sequence[str] | None = None) -> Options:
    """Read the command line, and give torch its threads."""
    parser = argparse.ArgumentParser(
        description=question, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="small sizes, in seconds")
    parser.add_argument("--threads", type=int, default=1, help="of torch (default 1)")
    parser.add_argument("--json", type=Path, help="write the numbers to this file")
    parser.add_argument("--plot", type=Path, help="draw them into this file (.png or .svg)")
    options = Options(**vars(parser.parse_args(arguments)))
    torch.set_num_threads(options.threads)
    return options


def report(
    options: Options,
    question: str,
    rows: list[dict[str, Any]],
    bars: Sequence[Bar] = (),
    draw: Callable[[Any, list[dict[str, Any]]], None] | None = None,
) -> None:
    """Print a table and the verdicts, and write what was asked for.

    Args:
        options: how the benchmark was called.
        question: what it answers, its docstring.
        rows: the numbers, one record a measurement.
        bars: what was to be reached. None are judged in a quick run.
        draw: fills a matplotlib figure.
    """
    bars = () if options.quick else bars
    line = machine(options.threads)
    print(line, table(rows), *bars, sep="\n")
    if options.json:
        judged = [bar._asdict() | {"met": bar.met} for bar in bars]
        result = {
            "question": question.strip().splitlines()[0],
            "machine": line,
            "quick": options.quick,
            "rows": rows,
            "bars": judged,
        }
        options.json.write_text(json.dumps(result, indent=2) + "\n")
    if options.plot and draw:
        figure = new_figure()
        draw(figure, rows)
        figure.savefig(options.plot, dpi=150)


def table(rows: Sequence[dict[str, Any]]) -> str:
    """Records as a Markdown table; columns are those of all records, in order of appearance."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    cells = [names] + [[written(row.get(name)) for name in names] for row in rows]
    widths = [max(len(line[k]) for line in cells) for k in range(len(names))]
    lines = [
        "| "
        + " | ".join(text.ljust(width) for text, width in zip(line, widths, strict=True))
        + " |"
        for line in cells
    ]
    return "\n".join([lines[0], "|" + "|".join("-" * (w + 2) for w in widths) + "|", *lines[1:]])


def written(value: Any) -> str:
    """A number with three digits that count, thousands apart; nothing for what was not run."""
    if value is None:
        return ""
    if not isinstance(value, float):
        return f"{value:,}" if isinstance(value, int) else str(value)
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.3g}"


def new_figure() -> Any:
    """An empty matplotlib figure, drawn without a screen."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise SystemExit("--plot needs matplotlib: pip install 'projflow-lite[pictures]'") from None
    return Figure(figsize=(8, 4.5), layout="constrained")
