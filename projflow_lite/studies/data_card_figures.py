"""The pictures of the data card. Needs matplotlib: ``pip install projflow-lite[pictures]``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from data_synth import ACTIONS, held_out
from data_synth.card import UNITS, gait_of, power_of
from projflow_lite.exchange.pictures import contact_sheet
from projflow_lite.motion import Motion
from projflow_lite.skeleton import EDGES, JOINTS, bone_lengths

MADE, REAL, HML = "#0072b2", "#d55e00", "#5a5a5a"
"""Synthetic, recorded, and recorded on HumanML3D's bones."""

SHOWN = ("speed", "cadence", "stride", "bob", "wrist_swing", "ankle_lift")
"""Measures of the gait that have a histogram."""

STYLE: Any = {
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 10,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
}

Sets = Mapping[str, Sequence[NDArray]]


def draw(
    folder: Path, made: Sets, recorded: Sets | None, families: Mapping[str, Sequence[str]]
) -> dict[str, Path]:
    """Write all pictures; returns their paths by what they show."""
    import matplotlib.pyplot as plt

    real = recorded or {}
    paths = {name: folder / f"data_card_{name}.png" for name in ("gait", "bones_and_spectrum")}
    with plt.rc_context(STYLE):
        histograms(paths["gait"], made["walk"], real.get("walk"))
        bones_and_spectrum(paths["bones_and_spectrum"], made, real)
    for family, actions in families.items():
        name = family.replace(",", "").replace(" ", "_")
        paths[family] = folder / f"data_card_{name}.png"
        clips = [held_out(1, 60, ACTIONS.index(action), [action]) for action in actions]
        motions = [Motion(clip.positions[0], clip.captions[0]) for clip in clips]
        contact_sheet(motions, paths[family], poses=8, columns=2)
    for path in paths.values():
        fewer_colours(path)
    return paths


def histograms(path: Path, made: Sequence[NDArray], real: Sequence[NDArray] | None) -> None:
    """How walks are spread: synthetic ones filled, recorded ones as an outline."""
    import matplotlib.pyplot as plt

    sets = [(gait_of(np.asarray(made, float)), MADE, f"synthetic ({len(made)} walks)")]
    if real is not None:
        sets.append((gait_of(list(real)), REAL, f"recorded ({len(real)} walks)"))
    figure, cells = plt.subplots(2, 3, figsize=(9, 4.6))
    for axes, name in zip(cells.flat, SHOWN, strict=True):
        values = [measured[name][np.isfinite(measured[name])] for measured, _, _ in sets]
        low, high = np.percentile(np.concatenate(values), [0.5, 99.5])
        edges = np.linspace(float(low), float(high), 17)
        for (_, colour, label), part, filled in zip(sets, values, (True, False), strict=False):
            share = np.full(len(part), 1 / len(part))
            style: dict[str, Any] = {"alpha": 0.45} if filled else {"histtype": "step", "lw": 2}
            axes.hist(part, edges, weights=share, color=colour, label=label, **style)
        axes.set_title(name.replace("_", " "))
        axes.set_xlabel(UNITS[name])
        axes.yaxis.set_major_formatter(lambda share, _: f"{100 * share:.0f} %")
    figure.legend(*cells[0, 0].get_legend_handles_labels(), loc="upper right", ncols=2)
    figure.suptitle("Straight walks", x=0.01, ha="left")
    figure.tight_layout()
    figure.savefig(path, dpi=100)
    plt.close(figure)


def bones_and_spectrum(path: Path, made: Sets, real: Sets) -> None:
    """Lengths of the bones, and how fast the movement is."""
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4.4), width_ratios=(1, 1.15))
    draw_bones(left, made, real)
    draw_spectrum(right, made, real)
    figure.tight_layout(w_pad=2)
    figure.savefig(path, dpi=100)
    plt.close(figure)


def draw_bones(axes: Any, made: Sets, real: Sets) -> None:
    """From the tenth to the ninetieth percentile of our bodies; recorded medians as marks."""
    shown = [k for k, (_, child) in enumerate(EDGES) if not JOINTS[child].startswith("right")]
    rows = np.arange(len(shown))[::-1]
    lengths = lengths_of(made["all"])[:, shown]
    low, middle, high = np.percentile(lengths, [10, 50, 90], axis=0)
    axes.barh(
        rows, high - low, left=low, height=0.55, color=MADE, alpha=0.45, label="synthetic, 10–90 %"
    )
    axes.plot(middle, rows, "|", color=MADE, ms=9, mew=2)
    marks = (("all", REAL, "o", "recorded, median"), ("hml", HML, "D", "on HumanML3D's bones"))
    for name, colour, mark, label in marks:
        if name in real:
            median = np.median(lengths_of(real[name])[:, shown], axis=0)
            axes.plot(median, rows, mark, color=colour, ms=5, mfc="none", mew=1.5, label=label)
    names = [JOINTS[EDGES[k][1]].replace("left_", "").replace("_", " ") for k in shown]
    axes.set_yticks(rows, names)
    axes.set(title="Bones, by the joint they end in", xlabel="metres", xlim=(0, None))
    axes.legend(
        fontsize=8, loc="upper center", bbox_to_anchor=(0.45, -0.14), ncols=3, frameon=False
    )


def lengths_of(clips: Sequence[NDArray]) -> NDArray:
    """Length of every bone of every clip, ``(n, 21)`` metres: the median over its frames."""
    return np.stack([np.median(bone_lengths(np.asarray(clip, float)), axis=0) for clip in clips])


def draw_spectrum(axes: Any, made: Sets, real: Sets) -> None:
    """How the movement about the pelvis is spread over frequencies."""
    for name, line in (("walk", "-"), ("all", ":")):
        for kind, source, colour in (("synthetic", made, MADE), ("recorded", real, REAL)):
            if name in source:
                frequency, share = mean_spectrum(source[name])
                axes.plot(frequency, share, line, color=colour, lw=1.8, label=f"{kind}, {name}")
    axes.set(
        title="How fast the movement is", xlabel="Hz", ylabel="share of the movement, a bin",
        yscale="log", xlim=(0, 10), ylim=(1e-4, 1),
    )  # fmt: skip
    axes.legend(fontsize=8)


def mean_spectrum(clips: Sequence[NDArray]) -> tuple[NDArray, NDArray]:
    """Frequencies, and the share of the movement of all clips of the usual length in each."""
    usual = max(len(clip) for clip in clips)
    powers = [power_of(np.asarray(clip, float)) for clip in clips if len(clip) == usual]
    total = np.sum([power for _, power in powers], axis=0)[1:]
    return powers[0][0][1:], total / total.sum()


def fewer_colours(path: Path, colours: int = 48) -> None:
    """Store a picture with a palette: a third of the size, and the eye sees no difference."""
    from PIL import Image

    with Image.open(path) as picture:
        small = picture.convert("RGB").quantize(colours)
    small.save(path, optimize=True)
