"""The study of control as one picture: obedience against quality, and quality over density.

Needs matplotlib, which comes with ``pip install projflow-lite[pictures]``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from projflow_lite.studies.cells import ALL, DATA
from projflow_lite.studies.claims import TIME
from projflow_lite.studies.control_paper import SOURCES
from projflow_lite.studies.posterior_figure import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PINK,
    RED,
    STYLE,
)

LOOKS = {
    "no wish": (GREY, "s", ":"), "projflow": (RED, "o", "-"), "ddnm": (BLUE, "o", "-"),
    "replacement": (GREEN, "v", "--"), "imputation": (GREEN, "^", "-"), "gmd": (PINK, "^", "-"),
    "flowdps": (ORANGE, "o", "-"), "pnp_flow": (ORANGE, "D", "--"), "flowchef": (BLUE, "D", "--"),
    "dps": (PINK, "o", "--"), "dps, endpoint": (PINK, "v", ":"), "dno": (GREY, "D", "-"),
    "metric over time": (GREEN, "o", "-"), "control branch": (RED, "D", "--"),
    "condmdi": (RED, "v", ":"), "projflow, tuned": (RED, "^", "--"),
}  # fmt: skip
"""Colour, mark and line of each method."""

EXACT = 1e-6
"""Errors below this, in metres, are drawn at it."""


def figure(rows: list[dict[str, Any]], path: str | Path) -> Path:
    """Draw the records of `control.run`, the ablations aside.

    Args:
        rows: the records.
        path: a ``.png``, ``.pdf`` or ``.svg`` file.
    """
    import matplotlib.pyplot as plt

    data = next(row for row in rows if row["method"] == DATA)
    average = [r for r in rows if r["joint"] == "average" and r["method"] not in SOURCES]
    with plt.rc_context(STYLE):
        drawing, axes = plt.subplots(1, 4, figsize=(17, 4.4), width_ratios=[3, 3, 3, 2])
        draw_obedience(axes[0], [row for row in average if row["keys"] == ALL], data)
        for cell, score in zip(axes[1:3], ("FID", "kinetic distance"), strict=True):
            draw_densities(cell, [row for row in average if row["keys"] != ALL], score, data)
        draw_times(axes[3], [row for row in average if row["keys"] == ALL])
        handles, names = axes[1].get_legend_handles_labels()
        rows_of_legend = -(-len(names) // 9)
        drawing.legend(handles, names, loc="lower center", ncol=9, frameon=False)
        drawing.tight_layout(w_pad=2.0, rect=(0, 0.02 + 0.05 * rows_of_legend, 1, 1))
        drawing.savefig(path, dpi=130)
        plt.close(drawing)
    return Path(path)


def draw_obedience(axes: Any, rows: list[dict[str, Any]], data: dict[str, Any]) -> None:
    """Quality over what is missed, one point a method: near the lower left corner is best."""
    band(axes, data, "FID")
    for row in rows:
        colour, mark, _ = look(row["method"])
        miss, cell = row["scores"]["average error"], row["scores"]["FID"]
        axes.errorbar(
            max(miss["mean"], EXACT), cell["mean"], yerr=cell["half width"],
            color=colour, marker=mark, ms=7, elinewidth=0.8, ls="none",
        )  # fmt: skip
    axes.set(
        xscale="log", yscale="log", xlabel="average error, m (left edge: exact)", ylabel="FID",
        title="Obedience and quality",
    )  # fmt: skip
    axes.xaxis.minorticks_off()
    few_ticks(axes.yaxis)


def draw_densities(axes: Any, rows: list[dict[str, Any]], score: str, data: dict[str, Any]) -> None:
    """One score over the number of keyframes, a curve a method."""
    band(axes, data, score)
    for method in dict.fromkeys(row["method"] for row in rows):
        part = [row for row in rows if row["method"] == method]
        colour, mark, line = look(method)
        cells = [row["scores"][score] for row in part]
        axes.errorbar(
            [row["keys"] for row in part],
            [cell["mean"] for cell in cells],
            yerr=[cell["half width"] for cell in cells],
            color=colour, marker=mark, ls=line, lw=1.5, ms=4, elinewidth=0.8, label=method,
        )  # fmt: skip
    axes.set(
        xscale="log",
        yscale="log",
        xlabel="keyframes",
        title=f"{score[0].upper()}{score[1:]} over density",
    )
    keys = sorted({row["keys"] for row in rows})
    axes.set_xticks(keys, [str(k) for k in keys])
    axes.xaxis.minorticks_off()
    few_ticks(axes.yaxis)


def draw_times(axes: Any, rows: list[dict[str, Any]], looks: dict[str, Any] = LOOKS) -> None:
    """What every method costs."""
    rows = sorted((row for row in rows if row["method"] != "no wish"), key=lambda row: -row[TIME])
    names = [row["method"] for row in rows]
    axes.barh(names, [row[TIME] for row in rows], color=[look(name, looks)[0] for name in names])
    axes.set(xscale="log", title="Time", xlabel="multiple of a sample without a wish")
    few_ticks(axes.xaxis)


def few_ticks(axis: Any) -> None:
    """Numbers 1, 2 and 5 of a decade on a logarithmic axis, without powers of ten.

    Of many decades 1 alone.
    """
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    low, high = axis.get_view_interval()
    axis.set_major_locator(LogLocator(subs=(1, 2, 5) if high < 100 * low else (1,)))
    axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axis.set_minor_formatter(NullFormatter())


def band(axes: Any, data: dict[str, Any], score: str) -> None:
    """The data's own score, with its interval."""
    cell = data["scores"][score]
    low, high = cell["mean"] - cell["half width"], cell["mean"] + cell["half width"]
    axes.axhspan(max(low, cell["mean"] / 10), high, color=GREY, alpha=0.2, lw=0)
    axes.axhline(cell["mean"], color=GREY, lw=1, label="held-out data")


def look(method: str, looks: dict[str, Any] = LOOKS) -> tuple[str, str, str]:
    """Colour, mark and line of a method."""
    return looks.get(method, (GREY, "x", "-"))
