"""The study of wishes from outside as one picture: from held-out to recorded, method by method.

Needs matplotlib, which comes with ``pip install projflow-lite[pictures]``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from projflow_lite.studies.control_figure import EXACT, few_ticks, look
from projflow_lite.studies.posterior_figure import GREY, STYLE
from projflow_lite.studies.real_wishes_words import SOURCE, Row, averages, data_of
from projflow_lite.studies.recorded import RECORDED

APART = 0.14
"""Of the two marks of a method, in lines."""

PANELS = ("average error", "FID", "kinetic distance", "bone error %", "worst acceleration")


def figure(rows: list[Row], path: str | Path) -> Path:
    """Draw the records of `real_wishes.run`.

    Args:
        rows: the records.
        path: a ``.png``, ``.pdf`` or ``.svg`` file.
    """
    import matplotlib.pyplot as plt

    data = data_of(rows)
    first = next(iter(data))
    pair = [averages(rows, source) for source in (first, RECORDED)]
    names = [name for name in pair[0] if name in pair[1]]
    with plt.rc_context(STYLE):
        drawing, axes = plt.subplots(1, len(PANELS), figsize=(17, 4.2), sharey=True)
        for cell, score in zip(axes, PANELS, strict=True):
            draw_score(cell, pair, names, score)
            for source, line in ((first, ":"), (RECORDED, "-")):
                draw_clips(cell, data[source], score, line)
            few_ticks(cell.xaxis)
            cell.xaxis.get_major_locator().set_params(numticks=5)
        axes[0].set_yticks(range(len(names)), names)
        axes[0].set_ylim(len(names) - 0.5, -0.5)
        handles, labels = axes[1].get_legend_handles_labels()
        shown = dict(zip(labels, handles, strict=True))
        drawing.legend(shown.values(), shown, loc="lower center", ncol=4, frameon=False)
        drawing.tight_layout(w_pad=1.5, rect=(0, 0.07, 1, 1))
        drawing.savefig(path, dpi=130)
        plt.close(drawing)
    return Path(path)


def draw_score(axes: Any, pair: list[dict[str, Row]], names: list[str], score: str) -> None:
    """One score: a line a method from its value on held-out wishes to that on recorded ones."""
    for place, name in enumerate(names):
        colour = look(name)[0]
        cells = [found[name]["scores"][score] for found in pair]
        values = [max(cell["mean"], EXACT) for cell in cells]
        places = [place - APART, place + APART]
        axes.plot(values, places, color=colour, lw=1.2)
        for cell, value, y, filled in zip(cells, values, places, (False, True), strict=True):
            axes.errorbar(
                value, y, xerr=cell["half width"], marker="o", ms=5, elinewidth=0.8, ls="none",
                color=colour, mfc=colour if filled else "white",
                label=("recorded wishes" if filled else "held-out wishes") if place == 0 else None,
            )  # fmt: skip
    unit = ", m (left edge: exact)" if score == "average error" else ""
    axes.set(xscale="log", title=f"{score}{unit}")
    axes.xaxis.minorticks_off()


def draw_clips(axes: Any, data: Row, score: str, line: str) -> None:
    """What clips themselves score; bones that never stretch would need an axis of their own."""
    own = data["scores"].get(score)
    if own and score != "bone error %":
        axes.axvline(own["mean"], color=GREY, ls=line, lw=1, label=f"{data[SOURCE]} clips")
