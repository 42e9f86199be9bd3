"""The study of GMD as one picture: over density, over tau, and around obstacles.

Needs matplotlib, which comes with ``pip install projflow-lite[pictures]``.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from projflow_lite.studies.gmd_ways import FREE, PROJFLOW, TWO_STAGES
from projflow_lite.studies.keyframes import FRAMES
from projflow_lite.studies.posterior_figure import BLUE, GREEN, GREY, ORANGE, PINK, RED, STYLE

COLOURS = {
    "imputation": PINK,
    "imputation, body along": "#882255",
    "imputation and guidance": RED,
    "mixing (c = 1)": ORANGE,
    "emphasis": "#56b4e9",
    "emphasis, guidance": BLUE,
    "emphasis, guidance, lines": GREY,
    TWO_STAGES: GREEN,
    PROJFLOW: "#000000",
}

ALONE = ("imputation", "imputation, body along", "mixing (c = 1)", "emphasis")
"""Imputation and nothing else: on the plain prior, and with c = 1 and 10."""

LED = tuple(name for name in COLOURS if name not in ALONE[1:3])

Rows = list[dict[str, Any]]


def figure(rows: Rows, path: str | Path) -> Path:
    """Draw the records of `gmd_table.run`.

    Args:
        rows: the records.
        path: a ``.png``, ``.pdf`` or ``.svg`` file.
    """
    import matplotlib.pyplot as plt

    data, free = rows[0], next(row for row in rows if row["method"] == FREE)
    keyed = [row for row in rows if row["task"] == "keyframes" and row is not free]
    of_c = [row for row in keyed if row["method"] in ALONE]
    led = [row for row in keyed if row["method"] in LED]
    obstacle = [row for row in rows if row["task"] == "obstacle"]
    with plt.rc_context(STYLE):
        drawing, cells = plt.subplots(2, 3, figsize=(14, 8))
        over_density(cells[0, 0], of_c, "walked %", "Imputation alone: how much is walked")
        floor(cells[0, 0], data, "walked %")
        over_density(cells[0, 1], led, "error, m", "Keyframes: how far they are missed")
        over_density(cells[0, 2], led, "kinetic distance", "Keyframes: how unlike the data")
        floor(cells[0, 2], data, "kinetic distance")
        over_density(cells[1, 0], led, "tear %", "Keyframes: how bones tear")
        floor(cells[1, 0], data, "tear %")
        over_tau(cells[1, 1], [row for row in rows if row["task"] == "tau"])
        around(cells[1, 2], obstacle)
        named = {name: line for axes in cells.flat for line, name in labelled(axes)}
        drawing.tight_layout(w_pad=2.0, h_pad=2.0, rect=(0, 0.08, 1, 1))
        drawing.legend(named.values(), named.keys(), loc="lower center", ncol=5, frameon=False)
        drawing.savefig(path, dpi=130)
        plt.close(drawing)
    return Path(path)


def labelled(axes: Any) -> list[tuple[Any, str]]:
    """What is drawn in one panel, and the names of it."""
    return list(zip(*axes.get_legend_handles_labels(), strict=True))


def over_density(axes: Any, rows: Rows, score: str, title: str) -> None:
    """One score over the number of keyframes."""
    curves(axes, rows, score, lambda row: row["keys"])
    axes.set(title=title, ylabel=score, xlabel=f"keyframes of {FRAMES}")
    axes.set_xscale("log")
    ticks = sorted({row["keys"] for row in rows})
    axes.set_xticks(ticks, [str(tick) for tick in ticks])
    axes.minorticks_off()
    axes.set_ylim(bottom=0)


def over_tau(axes: Any, rows: Rows) -> None:
    """How far five keyframes are missed over the time for which lines lead."""
    curves(axes, rows, "error, m", lambda row: row["tau"])
    axes.set(title="Five keyframes, two stages: tau", ylabel="error, m", xlabel="tau (flow time)")
    axes.set_ylim(bottom=0)


def around(axes: Any, rows: Rows) -> None:
    """Share of motions that never touch the post, over the strength of the goal."""
    pushed = [row for row in rows if row["scale"] > 0]
    curves(axes, pushed, "clear %", lambda row: row["scale"])
    for row in rows:
        if not row["scale"]:
            height = row["scores"]["clear %"]["mean"]
            axes.axhline(height, color=COLOURS[row["method"]], lw=1, label=row["method"])
    axes.set(title="A post in the way", ylabel="motions that never touch it, %", xlabel="scale")
    axes.set_ylim(-3, 103)


def curves(axes: Any, rows: Rows, score: str, across: Callable[[dict[str, Any]], float]) -> None:
    """A curve a method, with its intervals."""
    for method in dict.fromkeys(row["method"] for row in rows):
        part = sorted((row for row in rows if row["method"] == method), key=across)
        cells = [row["scores"][score] for row in part]
        axes.errorbar(
            [across(row) for row in part],
            [cell["mean"] for cell in cells],
            yerr=[cell["half width"] for cell in cells],
            color=COLOURS[method], lw=1.8, marker="o", ms=4, elinewidth=0.8, label=method,
        )  # fmt: skip


def floor(axes: Any, data: dict[str, Any], score: str) -> None:
    """What held-out data scores."""
    axes.axhline(data["scores"][score]["mean"], color=GREY, lw=1, ls=":", label="held-out data")
