"""The posterior study as one picture of six panels.

Needs matplotlib, which comes with ``pip install projflow-lite[pictures]``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from projflow_lite import equations as eq
from projflow_lite.studies import posterior_worlds as worlds
from projflow_lite.studies.posterior_exact import projection_of
from projflow_lite.studies.posterior_words import pick

BLUE, RED, GREEN, PINK, ORANGE, GREY = (
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#5a5a5a",
)  # fmt: skip
"""Colours that stay apart for colour-blind eyes."""

STYLE: Any = {
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 10,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
}


def figure(rows: list[dict[str, Any]], path: str | Path) -> Path:
    """Draw the records of `posterior.run`.

    Args:
        rows: the records.
        path: a ``.png``, ``.pdf`` or ``.svg`` file.
    """
    import matplotlib.pyplot as plt

    with plt.rc_context(STYLE):
        drawing, cells = plt.subplots(2, 3, figsize=(13, 7.6))
        draw_spread(cells[0, 0], rows)
        draw_mean(cells[0, 1], rows)
        draw_soft(cells[0, 2], rows)
        draw_path(cells[1, 0])
        draw_modes(cells[1, 1])
        draw_energy(cells[1, 2], rows)
        drawing.tight_layout(w_pad=2.5, h_pad=2.0)
        drawing.savefig(path, dpi=130)
        plt.close(drawing)
    return Path(path)


def draw_curves(axes: Any, rows: list[dict[str, Any]], score: str, curves: list[tuple]) -> None:
    """Scores over the number of steps, each curve named where it ends.

    A curve is what picks its row, a name, a colour, a line style and a shift of the name in points.
    """
    for wanted, name, colour, style, shift in curves:
        row = pick(rows, **wanted)
        steps, values = row["steps"], row["scores"][score]
        axes.plot(steps, values, style, color=colour, lw=2, marker="o", ms=4)
        axes.annotate(
            name, (steps[-1], values[-1]), (7, shift), textcoords="offset points",
            color=colour, va="center", fontsize=8,
        )  # fmt: skip
    axes.set(xscale="log", yscale="log", xlabel="steps")
    ticks = rows[0]["steps"]
    axes.set_xticks(ticks, [str(tick) for tick in ticks])
    axes.minorticks_off()
    axes.set_xlim(ticks[0] * 0.85, ticks[-1] * 11)


def plain_ticks(axes: Any, ticks: list[float]) -> None:
    """Numbers a reader reads without powers of ten."""
    axes.set_yticks(ticks, [f"{tick:g}" for tick in ticks])


def draw_spread(axes: Any, rows: list[dict[str, Any]]) -> None:
    """No wish: what the noise does to the spread."""
    base = {"world": "line", "wish": "none"}
    axes.axhline(1, color=GREY, lw=1)
    axes.axhline(np.sqrt(0.5), color=GREY, lw=1, ls=":")
    curves = [
        (base | {"noise": "original", "eta": "0"}, "original, none fresh", PINK, "-", 0),
        (base | {"noise": "original", "eta": "paper"}, "original, paper's η", PINK, "--", 6),
        (base | {"noise": "implied", "eta": "0"}, "implied, none fresh", BLUE, "-", -7),
        (base | {"noise": "implied", "eta": "paper"}, "implied, paper's η", RED, "-", 5),
        (base | {"noise": "implied", "eta": "1"}, "all fresh", ORANGE, "-", -6),
    ]
    draw_curves(axes, rows, "spread", curves)
    ticks = [0.5, np.sqrt(0.5), 1, 2, 4]
    axes.set_yticks(ticks, ["0.5", r"$\sqrt{1/2}$", "1", "2", "4"])
    axes.set(title="No wish: the spread that is left", ylabel="standard deviation / true one")


def draw_mean(axes: Any, rows: list[dict[str, Any]]) -> None:
    """A hard wish: which metric gets the mean right."""
    base = {"world": "plane", "wish": "hard", "eta": "0"}
    curves = [
        (base | {"metric": "opposite", "noise": "implied"}, "wrong metric", PINK, "-", 0),
        (base | {"metric": "euclid", "noise": "guided"}, "Euclid, guided", BLUE, "--", 0),
        (base | {"metric": "data", "noise": "implied"}, "data's precision", ORANGE, "-", 0),
        (base | {"metric": "euclid", "noise": "implied"}, "Euclid, implied", BLUE, "-", 0),
    ]
    draw_curves(axes, rows, "mean error", curves)
    axes.set_ylim(0.02, 8)
    plain_ticks(axes, [0.03, 0.1, 0.3, 1, 3])
    axes.annotate(
        "moving metric, guided noise: 0 at any number of steps", (0.03, 0.02),
        xycoords="axes fraction", color=GREEN, fontsize=8,
    )  # fmt: skip
    label = "error of the mean / posterior std"
    axes.set(title="A hard wish: is the mean right?", ylabel=label)


def draw_soft(axes: Any, rows: list[dict[str, Any]]) -> None:
    """A soft wish: what counting the same evidence again makes of it."""
    base = {"world": "plane", "wish": "soft"}
    moving = {"metric": "moving", "noise": "guided"}
    data = {"metric": "data", "noise": "implied"}
    axes.axhline(1, color=GREY, lw=1)
    axes.text(5, 1.15, "right", color=GREY, fontsize=8, va="bottom")
    curves = [
        (base | moving | {"eta": "0"}, "moving, guided", GREEN, "-", 5),
        (base | moving | {"eta": "paper"}, "the same, paper's η", GREEN, "--", -7),
        (base | data | {"eta": "paper"}, "data's, paper's η", RED, "-", 0),
        (base | data | {"eta": "0"}, "data's, none fresh", ORANGE, "-", 0),
    ]
    draw_curves(axes, rows, "spread along rows", curves)
    axes.set(title="A soft row hardens with the steps", ylabel="spread of A x / right one")


def draw_path(axes: Any, steps: int = 100) -> None:
    """A path between two keyframes: bands of two standard deviations."""
    world = worlds.path()
    frames = np.arange(world.A.shape[1])
    _, means, covariances = world.posterior
    bands = [("posterior", means[0], covariances[0], GREY, 0.22)]
    for name, guides, colour in (
        ("Euclid, implied, paper's η", False, BLUE),
        ("the same with guides", True, RED),
    ):
        law = eq.sampler_moments(
            world.means[0], world.covariances[0], eq.time_grid(steps),
            projection_of(world, "euclid", guides), "implied",
        )  # fmt: skip
        bands.append((name, *law, colour, 0.0))
    for name, mean, covariance, colour, fill in bands:
        half = 2 * np.sqrt(np.clip(np.diag(covariance), 0, None))
        if fill:
            axes.fill_between(
                frames, mean - half, mean + half, color=colour, alpha=fill, lw=0, label=name
            )
        else:
            axes.plot(frames, mean - half, color=colour, lw=1.6)
            axes.plot(frames, mean + half, color=colour, lw=1.6, label=name)
    keys = world.A.argmax(axis=1)
    axes.plot(keys, world.y, "o", color="black", ms=7, label="keyframes", zorder=5)
    axes.legend(frameon=False, fontsize=8, loc="upper right")
    axes.set_ylim(-1.3, 2.1)
    axes.set_xticks(frames[::3])
    axes.set_xlabel("frame")
    axes.set(title=f"A path, two keyframes, {steps} steps", ylabel="position, mean ± 2 std")


def draw_modes(axes: Any, count: int = 3000, steps: int = 100) -> None:
    """Three modes: the density along the line that the wish leaves."""
    world = worlds.three_modes()
    x = np.linspace(-1.7, 2.3, 500)
    axes.fill_between(x, line_density(world, x), color=GREY, alpha=0.22, lw=0, label="posterior")
    choices = [
        (("euclid", "implied", "paper"), "Euclid, implied, paper's η", RED, "-"),
        (("data", "implied", "paper"), "data's precision, the same", ORANGE, "--"),
        (("moving", "guided", "0"), "moving, guided, none fresh", GREEN, "-"),
    ]
    for choice, name, colour, style in choices:
        ends = worlds.sample_ends(world, *choice, steps, count, 0)[:, 1]
        axes.plot(x, stats.gaussian_kde(ends, 0.16)(x), style, color=colour, lw=1.8, label=name)
    axes.legend(frameon=False, fontsize=8, loc="upper right")
    axes.set_ylim(0, 2.6)
    axes.set(title="Three modes, along the wish", xlabel="free coordinate", ylabel="density")


def line_density(world: worlds.World, x: NDArray) -> NDArray:
    """Exact posterior density of the second coordinate."""
    weights, means, covariances = world.posterior
    parts = zip(weights, means[:, 1], np.sqrt(covariances[:, 1, 1]), strict=True)
    return sum((w * stats.norm.pdf(x, m, s) for w, m, s in parts), np.zeros_like(x))


def draw_energy(axes: Any, rows: list[dict[str, Any]]) -> None:
    """Every choice on the three modes, beside exact samples against exact samples."""
    modes = [row for row in rows if row["world"] == "three modes"]
    floor = pick(modes, method="exact samples")["scores"]["energy distance"]
    low, high = floor["mean"] - floor["half width"], floor["mean"] + floor["half width"]
    axes.fill_betweenx([-0.6, 8.6], low, high, color=GREY, alpha=0.25, lw=0)
    axes.text(
        high + 0.012, 4, "exact against exact", color=GREY, fontsize=8, va="center", rotation=90
    )
    marks = {"0": ("o", BLUE, 0.24), "2/steps": ("^", GREEN, 0.08), "paper": ("s", RED, -0.08),
             "1": ("D", ORANGE, -0.24)}  # fmt: skip
    names: list[str] = []
    for row in (row for row in modes if row["method"] == "projection"):
        name = f"{row['metric']}, {row['noise']}"
        names = names if name in names else [*names, name]
        mark, colour, shift = marks[row["eta"]]
        score = row["scores"]["energy distance"]
        place = 8 - names.index(name) + shift
        label = f"η = {row['eta']}" if (name, row["eta"]) in LABELLED else None
        axes.errorbar(
            score["mean"], place, xerr=score["half width"], fmt=mark, color=colour, ms=5, lw=1.2,
            label=label,
        )  # fmt: skip
    axes.set_yticks(8 - np.arange(len(names)), names)
    axes.set_ylim(-0.6, 9.6)
    axes.set_xlim(left=0)
    axes.grid(axis="y", color="#eeeeee")
    axes.legend(
        frameon=False, fontsize=8, loc="upper right", ncols=4, columnspacing=0.8, handletextpad=0
    )
    axes.set(
        title="Three modes: distance to the posterior", xlabel="energy distance, 95 % interval"
    )


LABELLED = {("euclid, implied", eta) for eta in worlds.ETAS}
"""The points that name their kind in the legend."""
