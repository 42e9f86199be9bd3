"""Where does the time of one sampling step go?

The network's forward pass, beside what a wish does in the same step: the variances of its guides,
and the projection. What is built once for a whole sample is in the last column.
"""

from __future__ import annotations

from typing import Any

import measuring
import numpy as np
import torch
from sampling import FRAMES, PROMPT, wishes

import projflow_lite as pf
from projflow_lite.samplers import ProjectionStep


def measure(name: str, batch: int, seconds: float) -> dict[str, Any]:
    """Time the parts of a step with one wish, taking turns."""
    prior, wish = pf.load_prior(), wishes()[name]
    step, x = ProjectionStep(wish, FRAMES), torch.randn(batch, FRAMES, 22, 3)
    variance = step.variance(x, 0.5) if step.guides else None
    runs = {
        "forward pass": lambda: prior(x, 0.5, PROMPT),
        "projection": lambda: step.projector.project(x, variance),
        "built once": lambda: ProjectionStep(wish, FRAMES),
    }
    if step.guides:
        runs["guides"] = lambda: step.variance(x, 0.5)
    with torch.inference_mode():
        times = measuring.take_turns(runs, seconds)
    ms = {part: 1e3 * timing.best for part, timing in times.items()}
    each = ms["projection"] + ms.get("guides", 0.0)
    return {
        "wish": name,
        "batch": batch,
        "forward pass, ms": ms["forward pass"],
        "guides, ms": ms.get("guides"),
        "projection, ms": ms["projection"],
        "wish / forward pass": each / ms["forward pass"],
        "built once, ms": ms["built once"],
    }


def draw(figure: Any, rows: list[dict[str, Any]]) -> None:
    """Shares of the forward pass."""
    axes = figure.subplots()
    names = [f"{row['wish']}, batch {row['batch']}" for row in rows]
    left = np.zeros(len(rows))
    for part, colour in (("guides, ms", "#E69F00"), ("projection, ms", "#0072B2")):
        share = np.array([100 * (row[part] or 0.0) / row["forward pass, ms"] for row in rows])
        axes.barh(names, share, left=left, color=colour, label=part.split(",")[0])
        left += share
    axes.set_xlabel("% of a forward pass of the network")
    axes.invert_yaxis()
    axes.legend(frameon=False)


def main(arguments: list[str] | None = None) -> None:
    """Run everything and report it."""
    options = measuring.read_options(__doc__, arguments)
    batches, seconds = ((1, 2), 0.01) if options.quick else ((1, 16), 0.4)
    rows = [measure(name, batch, seconds) for batch in batches for name in wishes()]
    measuring.report(options, __doc__, rows, draw=draw)


if __name__ == "__main__":
    main()
