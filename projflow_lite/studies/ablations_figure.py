"""The study of ablations as one picture, as Figure 7: scores over the number of keyframes.

Needs matplotlib, which comes with ``pip install projflow-lite[pictures]``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from projflow_lite.studies.ablations_words import JUDGED, OURS, Row, single
from projflow_lite.studies.control_figure import band, few_ticks
from projflow_lite.studies.posterior_figure import BLUE, GREEN, GREY, ORANGE, RED, STYLE

LOOKS = {
    "projflow": (RED, "o"),
    "euclid": (BLUE, "D"),
    "no fresh noise": (ORANGE, "v"),
    "plain masking": (GREY, "s"),
    OURS: (GREEN, "^"),
}
"""Colour and mark of each variant."""

LINES = {"implied": "-", "original": ":"}
"""Line of each reading of the noise."""


def figure(rows: list[Row], path: str | Path) -> Path:
    """Draw the records of `ablations.run` at the smallest guidance.

    Args:
        rows: the records.
        path: a ``.png``, ``.pdf`` or ``.svg`` file.
    """
    import matplotlib.pyplot as plt

    own = single(rows)
    least = min(row["guidance"] for row in own)
    own = [row for row in own if row["guidance"] == least]
    joints = list(dict.fromkeys(row["joint"] for row in own))
    size = (4 * len(JUDGED), 3.2 * len(joints) + 0.5)
    with plt.rc_context(STYLE):
        drawing, axes = plt.subplots(len(joints), len(JUDGED), figsize=size, squeeze=False)
        for line, joint in zip(axes, joints, strict=True):
            for cell, column in zip(line, JUDGED, strict=True):
                draw(cell, [row for row in own if row["joint"] == joint], column, rows[0])
                cell.set_title(f"{joint.replace('_', ' ')}: {column}")
        handles, names = axes[0, 0].get_legend_handles_labels()
        drawing.legend(handles, names, loc="lower center", ncol=6, frameon=False)
        drawing.tight_layout(w_pad=1.5, h_pad=1.5, rect=(0, 0.1, 1, 1))
        drawing.savefig(path, dpi=130)
        plt.close(drawing)
    return Path(path)


def draw(axes: Any, rows: list[Row], column: str, data: Row) -> None:
    """One score of one joint over density: a curve a variant and reading."""
    if column != "bone error %":  # a thousandth of a percent would flatten all curves
        band(axes, data, column)
    for part, noise in dict.fromkeys((row["part"], row["noise"]) for row in rows):
        own = [row for row in rows if (row["part"], row["noise"]) == (part, noise)]
        cells = [row["scores"][column] for row in own]
        colour, mark = LOOKS[part]
        axes.errorbar(
            [row["keys"] for row in own], [cell["mean"] for cell in cells],
            yerr=[cell["half width"] for cell in cells], color=colour, marker=mark,
            ls=LINES[noise], lw=1.4, ms=4, elinewidth=0.8, label=f"{part}, {noise} noise",
        )  # fmt: skip
    keys = sorted({row["keys"] for row in rows})
    axes.set(xscale="log", yscale="log", xlabel="keyframes")
    axes.set_xticks(keys, [str(k) for k in keys])
    axes.xaxis.minorticks_off()
    few_ticks(axes.yaxis)
