"""The study of equal time as one picture: quality and obedience over the time that was taken.

Needs matplotlib, which comes with ``pip install projflow-lite[pictures]``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from projflow_lite.studies.control_figure import EXACT, band, few_ticks, look
from projflow_lite.studies.control_ways import FREE
from projflow_lite.studies.equal_time_words import RATIO, Row, averages, budgets
from projflow_lite.studies.posterior_figure import STYLE

PANELS = ("FID", "kinetic distance", "average error")


def figure(rows: list[Row], path: str | Path) -> Path:
    """Draw the records of `equal_time.run`.

    Args:
        rows: the records.
        path: a ``.png``, ``.pdf`` or ``.svg`` file.
    """
    import matplotlib.pyplot as plt

    found = [averages(rows, budget) for budget in budgets(rows)]
    names = [name for name in found[0] if all(name in part for part in found)]
    with plt.rc_context(STYLE):
        drawing, axes = plt.subplots(1, len(PANELS), figsize=(14, 4.4))
        for cell, score in zip(axes, PANELS, strict=True):
            if score in rows[0]["scores"]:
                band(cell, rows[0], score)
            for name in names:
                if score != "average error" or name != FREE.name:
                    draw_method(cell, [part[name] for part in found], score)
            finish(cell, score, budgets(rows))
        handles, labels = axes[0].get_legend_handles_labels()
        drawing.legend(handles, labels, loc="lower center", ncol=7, frameon=False)
        drawing.tight_layout(w_pad=2.0, rect=(0, 0.13, 1, 1))
        drawing.savefig(path, dpi=130)
        plt.close(drawing)
    return Path(path)


def draw_method(axes: Any, rows: list[Row], score: str) -> None:
    """One score of one method over the time that it took."""
    colour, mark, line = look(rows[0]["method"])
    cells = [row["scores"][score] for row in rows]
    first = rows[0]["method"] == "projflow"
    axes.errorbar(
        [row[RATIO] for row in rows],
        [max(cell["mean"], EXACT) for cell in cells],
        yerr=[cell["half width"] for cell in cells],
        color=colour, marker=mark, ls=line, ms=8 if first else 4, lw=1.5, elinewidth=0.8,
        label=rows[0]["method"], zorder=2 if first else 3,
    )  # fmt: skip


def finish(axes: Any, score: str, multiples: list[int]) -> None:
    """Axes of one panel."""
    axes.set(xscale="log", yscale="log", xlabel="time over that of ProjFlow")
    axes.set_title(f"{score}, m (lower edge: exact)" if score == "average error" else score)
    low, high = axes.get_xlim()
    axes.set_xlim(min(low, 0.9 * multiples[0]), max(high, 1.1 * multiples[-1]))
    axes.set_xticks(multiples, [str(multiple) for multiple in multiples])
    axes.xaxis.minorticks_off()
    few_ticks(axes.yaxis)
