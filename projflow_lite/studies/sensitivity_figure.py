"""The study of sensitivity as one picture: a panel a constant, the usual value marked.

Needs matplotlib, which comes with ``pip install projflow-lite[pictures]``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from projflow_lite.studies.claims import difference_of, find
from projflow_lite.studies.posterior_figure import BLUE, GREY, RED, STYLE
from projflow_lite.studies.sensitivity_sweeps import SWEEPS, USUAL, Sweep, spelled
from projflow_lite.studies.sensitivity_words import JUDGED, measured_of

ACROSS = 4
"""Panels in a row."""


def figure(rows: list[dict[str, Any]], path: str | Path) -> Path:
    """Draw the records of `sensitivity.run`.

    Args:
        rows: the records.
        path: a ``.png``, ``.pdf`` or ``.svg`` file.
    """
    import matplotlib.pyplot as plt

    sweeps = [sweep for sweep in SWEEPS if measured_of(rows, sweep)]
    down = -(-len(sweeps) // ACROSS)
    with plt.rc_context(STYLE):
        drawing, axes = plt.subplots(down, ACROSS, figsize=(15, 2.9 * down), squeeze=False)
        for cell, sweep in zip(axes.flat, sweeps, strict=False):
            draw_sweep(cell, rows, sweep)
        for cell in list(axes.flat)[len(sweeps) :]:
            cell.axis("off")
        handles, names = axes[0, 0].get_legend_handles_labels()
        drawing.legend(handles, names, loc="lower center", ncol=len(names), frameon=False)
        drawing.tight_layout(w_pad=1.5, h_pad=1.5, rect=(0, 0.12 / down, 1, 1))
        drawing.savefig(path, dpi=120)
        plt.close(drawing)
    return Path(path)


def draw_sweep(axes: Any, rows: list[dict[str, Any]], sweep: Sweep) -> None:
    """Both scores over the values of one constant, as multiples of the usual constants' scores.

    Bars are intervals of the differences: all values have the same captions, keyframes and noise.
    """
    usual = find(rows, "average", USUAL.name)
    assert usual is not None
    here = usual["steps"] if sweep.usual is None else sweep.usual
    found = in_order([*measured_of(rows, sweep), (here, usual)])
    places = range(len(found))
    for column, colour, mark in zip(JUDGED, (RED, BLUE), "os", strict=True):
        base = usual["scores"][column]
        more = [difference_of(row["scores"][column], base) for _, row in found]
        axes.errorbar(
            places, [1 + difference.mean / base["mean"] for difference in more],
            yerr=[difference.half_width / base["mean"] for difference in more],
            color=colour, marker=mark, ms=4, lw=1.2, elinewidth=0.8, label=column,
        )  # fmt: skip
    axes.axhline(1.0, color=GREY, lw=0.8)
    at = [value for value, _ in found].index(here)
    axes.axvspan(at - 0.3, at + 0.3, color=GREY, alpha=0.2, lw=0, label="the usual value")
    axes.set_xticks(places, [spelled(value) for value, _ in found])
    axes.set_title(f"{sweep.name}: {sweep.says}", fontsize=8.5)
    low, high = axes.get_ylim()  # what hardly matters should look like it
    axes.set(ylabel="over the usual", ylim=(min(low, 0.9), max(high, 1.1)))


def in_order(found: list[tuple[Any, dict[str, Any]]]) -> list[tuple[Any, dict[str, Any]]]:
    """Values by size, words last."""
    numbers = [pair for pair in found if not isinstance(pair[0], str)]
    words = [pair for pair in found if isinstance(pair[0], str)]
    return sorted(numbers, key=lambda pair: pair[0]) + words
