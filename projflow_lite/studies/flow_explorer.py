"""Paths that cross, and particles in a flow: the boards of the notebook on flows in the plane."""

from __future__ import annotations

from collections.abc import Callable

import ipywidgets as widgets
import numpy as np
from numpy.typing import ArrayLike, NDArray

from projflow_lite.equations import interpolate, tweedie_endpoint
from projflow_lite.widgets import Board
from projflow_lite.widgets.board_explorer import BoardExplorer, legs, slider

Array = NDArray[np.float64]
Passing = Callable[[Array, float], tuple[Array, Array]]
Velocity = Callable[[Array, float], Array]

SHOWN = 40
"""Straight paths that are drawn through the probe."""

TRACED = 25
"""Particles whose way is drawn."""


class CrossingExplorer(BoardExplorer):
    """Drag a place and choose a time: the straight paths through it, and their average velocity.

    The velocities are drawn as far as they would carry in the time that is left (ProjFlow eq. 5).

    Args:
        passing: ``passing(x, t)`` gives the ends of the straight paths that pass nearest to x at
            time t: x0 and x1, each ``(n, 2)``.
        average: ``average(x, t)`` is the mean velocity of those, ``(2,)``.
        exact: the same in closed form.
        probe: where the probe is at first.
    """

    def __init__(
        self,
        passing: Passing,
        average: Velocity,
        exact: Velocity,
        probe: ArrayLike = (0.5, 0.3),
    ) -> None:
        self.passing, self.average, self.exact = passing, average, exact
        self.time = slider("time t", 0.45, 0, 0.95)
        board = Board(title="All paths through one place", height=450)
        board.handle("probe", probe, label="x", color="flow")
        super().__init__(board, [self.time])

    def draw(self) -> None:
        """Paths in grey, where they end, and the two velocities."""
        x, t, board = self.place("probe"), self.time.value, self.board
        start, end = self.passing(x, t)
        average, exact = self.average(x, t), self.exact(x, t)
        lines = legs(start[:SHOWN], end[:SHOWN])
        board.line("lines", lines, "quiet", 0.5, label="paths through x")
        board.points("ends", end[:SHOWN], "data", label="where they end")
        closed = [x, tweedie_endpoint(x, exact, t)]
        board.line("exact", closed, "prediction", width=8, label="closed form")
        tip = tweedie_endpoint(x, average, t)
        board.arrow("average", x, tip, "projected", label=f"average of {len(start)}")
        means = f"average of {len(start)}: {average.round(2)}"
        self.words.value = f"{means} &nbsp; closed form: {exact.round(2)}"


class RiverExplorer(BoardExplorer):
    """Drag the means of the data, and the whole flow from noise to data is computed anew.

    Args:
        means: of the clumps to begin with, ``(k, 2)``.
        flow: ``flow(means, steps)`` gives the places of all particles, ``(steps + 1, n, 2)``.
        data: ``data(means)`` gives points of the data, ``(m, 2)``.
        steps: of Euler's method to begin with.

    ``.paths`` are the places of all particles now.
    """

    def __init__(
        self,
        means: ArrayLike,
        flow: Callable[[Array, int], Array],
        data: Callable[[Array], Array],
        steps: int = 20,
    ) -> None:
        self.flow, self.data = flow, data
        self.steps = slider("Euler steps", steps, 1, 50, step=1)
        self.percent = slider("time t, %", 100, 0, 100, step=1)
        board = Board(title="The flow from noise to data", height=460)
        self.names = [f"m{k}" for k in range(len(np.asarray(means)))]
        for k, mean in enumerate(np.asarray(means)):
            board.handle(self.names[k], mean, label=f"m{k + 1}", color="data")
        super().__init__(board, [self.steps])
        self.percent.observe(self.show_particles, "value")
        time = widgets.HBox([self._player(), self.percent])
        self.children = [board, time, self.steps]

    def _player(self) -> widgets.Play:
        """A button that lets the time run; it stands at the end, as the slider does."""
        play = widgets.Play(value=100, min=0, max=100, step=2, interval=60, show_repeat=False)
        # Kept, or the link would be collected with the widget that nothing else refers to.
        self._link = widgets.jslink((play, "value"), (self.percent, "value"))
        return play

    def draw(self) -> None:
        """The data, the ways of a few particles, and all particles at the time that is set."""
        means = np.array([self.place(name) for name in self.names])
        self.paths = self.flow(means, self.steps.value)
        self.board.points("data", self.data(means), "data", opacity=0.3, label="data")
        lifted = np.pad(
            self.paths[:, :TRACED], ((0, 1), (0, 0), (0, 0)), constant_values=np.nan
        ).swapaxes(0, 1)
        self.board.line("paths", lifted.reshape(-1, 2), "quiet", width=1, label="paths")
        self.show_particles()

    def show_particles(self, *_: object) -> None:
        """Put the particles where they are at the time of the slider."""
        last = len(self.paths) - 1
        k, share = divmod(self.percent.value / 100 * last, 1)
        before, after = self.paths[int(k)], self.paths[min(int(k) + 1, last)]
        x_t = interpolate(before, after, share)
        self.board.points("particles", x_t, "flow", opacity=0.6, label="particles")
