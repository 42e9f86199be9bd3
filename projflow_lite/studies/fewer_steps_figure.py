"""The study of fewer steps as one picture: quality against network calls.

Needs matplotlib, which comes with ``pip install projflow-lite[pictures]``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from projflow_lite.studies.fewer_steps_words import DATA, OFF_FLOW, methods_of, plain_of
from projflow_lite.studies.posterior_figure import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PINK,
    RED,
    STYLE,
    plain_ticks,
)

COLOURS = {
    "even": PINK, "quadratic": BLUE, "cubic": GREEN,
    "Euler": BLUE, "multistep": RED, "Heun": GREEN, "midpoint": ORANGE,
}  # fmt: skip
LINES = {"original": "--"}
SHARES = {"paper": RED, "ddpm": BLUE, "0": GREEN}


def figure(rows: list[dict[str, Any]], path: str | Path) -> Path:
    """Draw the records of `fewer_steps.run`.

    Args:
        rows: the records.
        path: a ``.png``, ``.pdf`` or ``.svg`` file.
    """
    import matplotlib.pyplot as plt

    data = next(row for row in rows if row["task"] == DATA)
    tasks = list(dict.fromkeys(row["task"] for row in rows if row is not data))[:3]
    with plt.rc_context(STYLE):
        size = (13, 3.7 * len(tasks))
        drawing, axes = plt.subplots(len(tasks), 3, figsize=size, squeeze=False)
        draw_free(axes[0], [row for row in rows if row["task"] == tasks[0]], data)
        for line, task in zip(axes[1:], tasks[1:], strict=True):
            draw_wish(line, [row for row in rows if row["task"] == task], data)
        drawing.tight_layout(w_pad=2.0, h_pad=2.0)
        drawing.savefig(path, dpi=130)
        plt.close(drawing)
    return Path(path)


def draw_free(axes: Any, rows: list[dict[str, Any]], data: dict[str, Any]) -> None:
    """Without a wish: spacing of the times, solvers, and how far off the flow they are."""
    methods = methods_of(rows)
    spacings = {m[0]: part for m, part in methods.items() if m[1] == "Euler"}
    solvers = {m[1]: part for m, part in methods.items() if m[0] == "cubic"}
    draw(axes[0], spacings, "kinetic distance", data, "No wish, Euler: spacing of the times")
    draw(axes[1], solvers, "bone error %", data, "No wish, cubic times: solvers")
    draw(axes[2], solvers, OFF_FLOW, data, "No wish, cubic times: off the flow")
    axes[2].set_yscale("log")
    axes[2].set_ylim(2, 40)
    plain_ticks(axes[2], [1, 2, 5, 10, 20])
    axes[2].minorticks_off()


def draw_wish(axes: Any, rows: list[dict[str, Any]], data: dict[str, Any]) -> None:
    """With a wish: what eq. 9 mixes, in two scores, and solvers with the sampler's own noise."""
    methods, task = methods_of(rows), rows[0]["task"].replace("_", " ").capitalize()
    plain = plain_of(methods)
    readings = {
        "metric over time" if m[4] == "moving" else f"{m[2]}, η {m[3] or 0}": part
        for m, part in methods.items()
        if m[:2] == ("quadratic", "Euler")
    }
    solvers = {
        m[1]: part for m, part in methods.items() if m[0] == "quadratic" and m[2:] == plain[2:]
    }
    draw(axes[0], readings, "kinetic distance", data, f"{task}: noise and metric")
    draw(axes[1], readings, "worst acceleration", data, f"{task}: noise and metric")
    draw(axes[2], solvers, "kinetic distance", data, f"{task}: solvers, paper noise")


def draw(
    axes: Any, curves: dict[str, list[dict[str, Any]]], score: str, data: dict[str, Any], title: str
) -> None:
    """One score over network calls, a curve a method, and the data's own score as a band."""
    if score in data["scores"]:
        floor = data["scores"][score]
        low, high = floor["mean"] - floor["half width"], floor["mean"] + floor["half width"]
        axes.axhspan(low, high, color=GREY, alpha=0.2, lw=0)
        axes.axhline(floor["mean"], color=GREY, lw=1, label="held-out data")
    for name, part in curves.items():
        noise, _, share = name.partition(", η ")
        cells = [row["scores"][score] for row in part]
        axes.errorbar(
            [row["calls"] for row in part],
            [cell["mean"] for cell in cells],
            yerr=[cell["half width"] for cell in cells],
            color=COLOURS.get(name) or SHARES.get(share, PINK), ls=LINES.get(noise, "-"),
            lw=1.8, marker="o", ms=4, elinewidth=0.8, label=name,
        )  # fmt: skip
    axes.set(xscale="log", title=title, xlabel="network calls", ylabel=score)
    axes.set_xticks([5, 10, 20, 50, 100], ["5", "10", "20", "50", "100"])
    axes.minorticks_off()
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, 0), high + 0.45 * (high - low))  # room for the legend
    axes.legend(frameon=False, fontsize=8, loc="upper right", ncol=2)
