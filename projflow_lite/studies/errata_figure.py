"""The study of errata as one picture: what each printed form changes, over all densities.

Needs matplotlib, which comes with ``pip install projflow-lite[pictures]``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from projflow_lite.studies.cells import ALL
from projflow_lite.studies.errata_forms import ERRATA
from projflow_lite.studies.errata_words import JUDGED, Row, effect_of, pairs_of
from projflow_lite.studies.fewer_steps_words import TOLERANCE
from projflow_lite.studies.posterior_figure import BLUE, GREEN, GREY, RED, STYLE

COLOURS, MARKS = (RED, BLUE, GREEN), "osD"


def figure(rows: list[Row], path: str | Path) -> Path:
    """Draw the records of `errata.run`.

    Args:
        rows: the records.
        path: a ``.png``, ``.pdf`` or ``.svg`` file.
    """
    import matplotlib.pyplot as plt

    with plt.rc_context(STYLE):
        drawing, axes = plt.subplots(1, len(JUDGED), figsize=(15, 3.4), sharey=True)
        for cell, column in zip(axes, JUDGED, strict=True):
            draw_score(cell, rows, column)
        handles, names = axes[0].get_legend_handles_labels()
        drawing.legend(handles, names, loc="lower center", ncol=len(names), frameon=False)
        drawing.tight_layout(w_pad=1.5, rect=(0, 0.08, 1, 1))
        drawing.savefig(path, dpi=130)
        plt.close(drawing)
    return Path(path)


def draw_score(axes: Any, rows: list[Row], column: str) -> None:
    """One score: a line an erratum, a mark a wish, the difference as a share of the score."""
    from matplotlib.ticker import FuncFormatter

    pairs = list(pairs_of(rows, ALL))
    joints = list(dict.fromkeys(pair.joint for pair in pairs))
    for k, joint in enumerate(joints):
        own = [pair for pair in pairs if pair.joint == joint]
        effects = [effect_of(pair.printed, pair.derived, column) for pair in own]
        scale = [100 / max(abs(one.derived["mean"]), 1e-12) for one in effects]
        axes.errorbar(
            [one.mean * s for one, s in zip(effects, scale, strict=True)],
            [ERRATA.index(pair.erratum) + 0.2 * (k - (len(joints) - 1) / 2) for pair in own],
            xerr=[one.half_width * s for one, s in zip(effects, scale, strict=True)],
            color=COLOURS[k], marker=MARKS[k], ms=5, elinewidth=1, ls="none", label=joint,
        )  # fmt: skip
    axes.axvspan(-100 * TOLERANCE, 100 * TOLERANCE, color=GREY, alpha=0.2, lw=0, label="within 5 %")
    axes.axvline(0, color=GREY, lw=0.8)
    axes.set_xscale("symlog", linthresh=10)
    low, high = axes.get_xlim()
    ticks = [t for t in (-1000, -100, -10, 0, 10, 100, 1000) if min(low, -10) <= t <= max(high, 10)]
    axes.set_xticks(ticks)
    axes.set_xlim(min(low, -12), max(high, 12))
    axes.xaxis.set_major_formatter(
        FuncFormatter(lambda value, _: f"{value:+.0f}" if value else "0")
    )
    axes.xaxis.minorticks_off()
    axes.set_yticks(range(len(ERRATA)), [erratum.name for erratum in ERRATA])
    axes.set_ylim(len(ERRATA) - 0.5, -0.5)
    axes.set(title=column, xlabel="printed less derived, % of derived")
