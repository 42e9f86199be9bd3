"""How far a keyframe reaches: the pinned path over time, under each way of correcting it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import ipywidgets as widgets
import numpy as np
import torch
from numpy.typing import NDArray

from projflow_lite.constraints import Wish, pin
from projflow_lite.samplers import MovingMetric, MovingStep, ProjectionStep, flow_times
from projflow_lite.samplers.moving import projection_step
from projflow_lite.skeleton import FPS, joint_index
from projflow_lite.widgets import Board
from projflow_lite.widgets.board_explorer import BoardExplorer, slider

Array = NDArray[np.float64]

ALONE, GUIDED, MOVING = "keyframe alone", "with guides", "metric over time"

LOOKS = {
    "as predicted": ("quiet", 1.5, True),
    ALONE: ("noise", 1.5, False),
    GUIDED: ("projected", 2, False),
    MOVING: ("flow", 3.5, False),
}
"""Colour, width and dashes of every path."""

STEPS = 25
"""Of the sampler whose flow times are the dots of the lower picture."""


class ReachExplorer(BoardExplorer):
    """Drag keyframes: what one projection makes of a joint's path, by three metrics.

    Above is where the joint is on one axis in every frame; below, for each step of a sampler, how
    many frames come more than half of the way along with the first keyframe.

    Args:
        motions: predicted motions ``(frames, 22, 3)``, metres, by name; one is chosen in a menu.
        keyframes: place on the axis by frame, metres; each is a handle, ``"key 1"`` and so on.
        joint: that is pinned.
        axis: 0, 1 or 2, for x, y, z.
        t: flow time to begin with.
        up: ends of the axis that are shown, metres.

    ``.paths`` holds the paths ``(frames,)`` that are shown, by the names of `LOOKS`.
    """

    children: Sequence[widgets.Widget]

    def __init__(
        self,
        motions: Mapping[str, Array],
        keyframes: Mapping[int, float],
        joint: str = "pelvis",
        axis: int = 0,
        t: float = 0.5,
        up: tuple[float, float] = (-0.4, 0.9),
    ) -> None:
        self.motions = {name: np.asarray(motion, float) for name, motion in motions.items()}
        self.joint, self.axis = joint, axis
        self.paths: dict[str, Array] = {}
        self._kept: dict[str, tuple[tuple[object, ...], ProjectionStep]] = {}
        self.frames = len(next(iter(self.motions.values())))
        across = (0, float(self.frames - 1))
        label = f"{joint.replace('_', ' ')}, {'xyz'[axis]}, m"
        board = Board(across, up, ("frame", label), height=340, equal=False)
        self.times = Board(
            (0, 1), (0, 1.05 * self.frames), ("flow time t", "frames along"),
            height=190, equal=False,
        )  # fmt: skip
        self.pins = [f"key {k + 1}" for k in range(len(keyframes))]
        for name, place in zip(self.pins, keyframes.items(), strict=True):
            board.handle(name, place, label="")
        usual = MovingMetric()
        self.motion = widgets.Dropdown(
            options=list(self.motions), layout={"width": "300px"}, description="prediction",
            style={"description_width": "initial"},
        )  # fmt: skip
        self.t = slider("flow time t", float(t), 0, 1)
        self.memory = slider("memory, s", usual.memory, 0.1, 10, 0.1)
        self.speed = slider("speed, m/s", usual.speed, 0.1, 5, 0.1)
        self.until = slider("until", usual.until, 0.5, 0.99)
        super().__init__(board, [self.motion, self.t, self.memory, self.speed, self.until])
        self.children = [board, self.times, *self.children[1:]]

    @property
    def metric(self) -> MovingMetric:
        """The metric over time that the sliders ask for."""
        memory, speed, until = (each.value for each in (self.memory, self.speed, self.until))
        return MovingMetric(speed=speed, memory=memory, until=until)

    @property
    def wish(self) -> Wish:
        """The keyframes, as they lie now."""
        at = np.array([self.place(name) for name in self.pins])
        return pin(self.joint, at[:, 0].astype(int).tolist(), at[:, 1:], axes="xyz"[self.axis])

    def step(self, name: str) -> ProjectionStep:
        """The projection of this name; made anew only if its metric or a keyframe has changed."""
        metric = self.metric if name == MOVING else "kinematic"
        asked = (metric, *(self.board.positions[name] for name in self.pins))
        if name not in self._kept or self._kept[name][0] != asked:
            made = projection_step(self.wish, self.frames, metric, torch.float64, name == GUIDED)
            self._kept[name] = asked, made
        return self._kept[name][1]

    def moved(self, name: str, position: Array) -> None:
        """A keyframe lies in a whole frame, and no two in one."""
        others = [round(self.place(other)[0]) for other in self.pins if other != name]
        free = [n for n in range(self.frames) if n not in others]
        nearest = min(free, key=lambda n: abs(n - position[0]))
        self.board.handle(name, (nearest, position[1]), label="")

    def draw(self) -> None:
        """Correct the prediction in three ways, and draw the paths."""
        x1_hat = torch.as_tensor(self.motions[self.motion.value])[None]
        self.paths = {"as predicted": self.path(x1_hat)}
        for name in (ALONE, GUIDED, MOVING):
            self.paths[name] = self.path(self.step(name)(x1_hat, self.t.value))
        for name, (color, width, dash) in LOOKS.items():
            curve = np.column_stack([np.arange(self.frames), self.paths[name]])
            self.board.line(name, curve, color, width, dash, label=name)
        self.draw_reach()
        worst = (f"{name} {worst_acceleration(path):.0f}" for name, path in self.paths.items())
        self.words.value = f"Worst acceleration on this axis, m/s²: {', '.join(worst)}."

    def draw_reach(self) -> None:
        """For every step of a sampler, how many frames follow the first keyframe."""
        moving = self.step(MOVING)
        assert isinstance(moving, MovingStep)
        key, times, now = round(self.place("key 1")[0]), flow_times(STEPS)[:-1], self.t.value
        dots = [(t, frames_along(moving.reach.over_frames(t), key)) for t in times]
        with self.times.hold():
            self.times.points("steps", dots, "flow", 3.5, 1, f"{MOVING}, a dot a step")
            self.times.line("alone", [[0, 1], [1, 1]], "noise", 1.5, label=ALONE)
            self.times.line("now", [[now, 0], [now, self.frames]], "quiet")

    def path(self, x: torch.Tensor) -> Array:
        """The joint's place on the axis, ``(frames,)``, of a motion ``(1, frames, 22, 3)``."""
        return x[0, :, joint_index(self.joint, "ReachExplorer"), self.axis].numpy().copy()


def frames_along(C: Array, frame: int) -> int:
    """Frames that come more than half of the way along with one: C[n, frame] / C[frame, frame]."""
    return int((C[:, frame] > C[frame, frame] / 2).sum())


def worst_acceleration(path: Sequence[float] | Array) -> float:
    """Largest second difference of a path ``(frames,)`` in metres, m/s²."""
    return float(np.abs(np.diff(path, 2)).max() * FPS**2)
