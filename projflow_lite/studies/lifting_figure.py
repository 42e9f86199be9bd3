"""The study of lifting as one picture: quality against obedience in the picture and in space.

Needs matplotlib, which comes with ``pip install projflow-lite[pictures]``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from projflow_lite.studies.cells import DATA
from projflow_lite.studies.control_figure import EXACT, LOOKS, band, draw_times, few_ticks, look
from projflow_lite.studies.lifting_paper import DIRECT, LIFT, RETRIEVAL
from projflow_lite.studies.lifting_pictures import CROSS
from projflow_lite.studies.posterior_figure import GREEN, ORANGE, PINK, RED, STYLE

LOOK = LOOKS | {
    RETRIEVAL: (GREEN, "s", "-"), LIFT: (PINK, "s", "-"), DIRECT: (ORANGE, "s", "-"),
    "euclid": (RED, "x", "-"), "no fresh noise": (RED, "+", "-"),
}  # fmt: skip


def figure(rows: list[dict[str, Any]], path: str | Path) -> Path:
    """Draw the records of `lifting.run`.

    Args:
        rows: the records.
        path: a ``.png``, ``.pdf`` or ``.svg`` file.
    """
    import matplotlib.pyplot as plt

    data = next(row for row in rows if row["method"] == DATA)
    average, cross = ([r for r in rows if r["joint"] == name] for name in ("average", CROSS))
    with plt.rc_context(STYLE):
        drawing, axes = plt.subplots(1, 4, figsize=(17, 4.6), width_ratios=[3, 3, 3, 2])
        draw_errors(axes[0], average, "average error 2D", data, "One path: in the picture")
        draw_errors(axes[1], average, "average error 3D", data, "One path: in space")
        draw_errors(axes[2], cross, "average error 3D", data, "One to six paths: in space")
        draw_times(axes[3], average, LOOK)
        handles, names = axes[0].get_legend_handles_labels()
        rows_of_legend = -(-len(names) // 8)
        drawing.legend(handles, names, loc="lower center", ncol=8, frameon=False)
        drawing.tight_layout(w_pad=2.0, rect=(0, 0.03 + 0.045 * rows_of_legend, 1, 1))
        drawing.savefig(path, dpi=130)
        plt.close(drawing)
    return Path(path)


def draw_errors(
    axes: Any, rows: list[dict[str, Any]], error: str, data: dict[str, Any], title: str
) -> None:
    """Quality over an error along the path, one point a method: the lower left corner is best."""
    band(axes, data, "FID")
    for row in rows:
        colour, mark, _ = look(row["method"], LOOK)
        # Exact methods meet at the left edge: ProjFlow's mark is larger and under theirs.
        size, order = (11, 2) if row["method"] == "projflow" else (6, 3)
        miss, cell = row["scores"][error], row["scores"]["FID"]
        axes.errorbar(
            max(miss["mean"], EXACT), cell["mean"], xerr=miss["half width"],
            yerr=cell["half width"], color=colour, marker=mark, ms=size, elinewidth=0.8, ls="none",
            label=row["method"], zorder=order,
        )  # fmt: skip
    unit = "picture units (left edge: exact)" if error.endswith("2D") else "m"
    axes.set(xscale="log", yscale="log", xlabel=f"{error}, {unit}", ylabel="FID", title=title)
    if error.endswith("2D"):
        axes.xaxis.minorticks_off()
    else:
        few_ticks(axes.xaxis)
    few_ticks(axes.yaxis)
