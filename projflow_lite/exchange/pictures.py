"""Motion as a picture to print or a film to post: contact sheets and GIFs.

Needs matplotlib, which comes with ``pip install projflow-lite[pictures]``.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from projflow_lite.motion import Motion
from projflow_lite.skeleton import EDGES, JOINTS

LEFT, RIGHT, MIDDLE, MARK = "#d55e00", "#0072b2", "#4d4d4d", "#009e73"
"""Colours that stay apart for colour-blind eyes: the body's left, right, spine; and pins."""


def camera(points: NDArray, yaw: float = 40.0, pitch: float = 12.0) -> NDArray:
    """See points in parallel projection.

    Args:
        points: ``(..., 3)`` metres, y up.
        yaw: degrees the camera stands to the body's left of straight ahead.
        pitch: degrees it looks down.

    Returns:
        ``(..., 2)`` metres on the picture, right and up.
    """
    a, b = np.radians(yaw), np.radians(pitch)
    right = np.array([np.cos(a), 0.0, -np.sin(a)])
    forward = np.array([-np.sin(a) * np.cos(b), -np.sin(b), -np.cos(a) * np.cos(b)])
    up = np.cross(right, forward)
    return np.stack([points @ right, points @ up], axis=-1)


def colour_of(joint: int) -> str:
    """Colour of the bone that ends in a joint."""
    name = JOINTS[joint]
    return LEFT if name.startswith("left") else RIGHT if name.startswith("right") else MIDDLE


def draw_body(axes, points: NDArray, alpha: float = 1.0) -> None:
    """Draw one pose ``(22, 2)`` as bones and a head."""
    for parent, child in EDGES:
        x, y = points[[parent, child]].T
        axes.plot(x, y, color=colour_of(child), lw=2.2, alpha=alpha, solid_capstyle="round")
    axes.plot(*points[JOINTS.index("head")], "o", color=MIDDLE, ms=6, alpha=alpha)


def contact_sheet(
    motions: Sequence[Motion],
    path: str | Path,
    poses: int = 10,
    titles: Sequence[str] | None = None,
    columns: int = 1,
) -> None:
    """Write one row of poses for every motion, left to right in time.

    The body's own travel is shown as it is, seen from the front and a little to the side; what is
    added is only the room between two poses.

    Args:
        motions: single motions, any lengths.
        path: a ``.png``, ``.pdf`` or ``.svg`` file.
        poses: how many frames to show of each.
        titles: a line above each row; by default the prompt.
        columns: how many motions stand side by side.
    """
    import matplotlib.pyplot as plt

    titles = titles or [str(motion.prompt or "") for motion in motions]
    lines = -(-len(motions) // columns)
    size = (poses * 0.6 * columns, 1.55 * lines)
    figure, cells = plt.subplots(lines, columns, figsize=size, squeeze=False)
    for axes in cells.flat[len(motions) :]:
        axes.axis("off")
    for motion, axes, title in zip(motions, cells.flat, titles, strict=False):
        draw_row(axes, motion, poses)
        axes.set_title(title, fontsize=9, loc="left", pad=1)
    figure.tight_layout(pad=0.3)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def draw_row(axes, motion: Motion, poses: int, gap: float = 0.95) -> None:
    """Draw some poses of one motion side by side, over their frame numbers; pins are dots."""
    chosen = np.linspace(0, motion.frames - 1, poses).round().astype(int)
    pins = None if motion.wish is None else motion.wish.markers(motion.frames)
    for place, frame in enumerate(chosen):
        pose = motion.positions[frame]
        ground = np.array([pose[0, 0], 0.0, pose[0, 2]])
        points = camera(pose - ground) + [place * gap, 0.0]
        draw_body(axes, points)
        if pins is not None:
            pinned = points[pins.joint[pins.frame == frame]]
            axes.plot(*pinned.T, "o", color=MARK, ms=5, zorder=3)
        axes.text(
            place * gap, -0.32, f"{frame}", ha="center", va="top", fontsize=7, color="#777777"
        )
    axes.plot([-0.5 * gap, (poses - 0.5) * gap], [0, 0], color="#cccccc", lw=0.8, zorder=0)
    axes.set_xlim(-0.6 * gap, (poses - 0.4) * gap)
    axes.set_ylim(-0.45, 2.05)
    axes.set_aspect("equal")
    axes.axis("off")


def film(
    motion: Motion, path: str | Path, yaw: float = 40.0, trail: str | int | None = None
) -> None:
    """Write an animated GIF of one motion.

    Args:
        motion: a single motion.
        path: a ``.gif`` file.
        yaw: where the camera stands, see `camera`.
        trail: a joint whose path is drawn, or None.
    """
    import matplotlib.pyplot as plt
    from matplotlib.animation import FuncAnimation, PillowWriter

    points = camera(motion.positions, yaw)
    figure, axes = plt.subplots(figsize=(4.5, 4.5))
    low, high = points.min((0, 1)) - 0.2, points.max((0, 1)) + 0.2

    def show(frame: int) -> None:
        axes.clear()
        draw_body(axes, points[frame])
        if trail is not None:
            path_points = camera(motion.joint(trail), yaw)
            axes.plot(*path_points.T, color=MARK, lw=1.5, zorder=0)
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        axes.axis("off")

    animation = FuncAnimation(figure, show, motion.frames)
    animation.save(path, PillowWriter(fps=round(motion.fps)))
    plt.close(figure)
