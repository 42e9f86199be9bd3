"""Drag a post into somebody's way: a goal with a gradient does what no row can say."""

from __future__ import annotations

from typing import Any

import ipywidgets as widgets
import numpy as np

from projflow_lite.constraints import pin
from projflow_lite.motion import Motion
from projflow_lite.samplers import Avoid, circles, sample
from projflow_lite.samplers.projflow import Velocity
from projflow_lite.widgets import Board, Viewer
from projflow_lite.widgets.answering import Later, status_line

RADIUS, MARGIN = 0.3, 0.05
"""Of the posts, and how far to stay away from them, metres."""

SETTLE = 0.25
"""Seconds of rest after which a drag is answered."""

CIRCLE = np.stack([f(np.linspace(0, 2 * np.pi, 49)) for f in (np.cos, np.sin)], axis=1)


class ObstacleWalk(widgets.VBox):
    """A walk to a place on the ground, around posts; seen from above and from the side.

    Posts and the place can be dragged.

    Args:
        prior: what to sample from, plain or emphasised.
        prompt: what the motion should be.
        goal: where the last frame should be, x and z, metres.
        posts: where the posts stand, ``(n, 2)``, metres.
        frames: length of the motion.
        scale: strength of the goal that keeps clear of posts. 20 is about what it takes; at 60
            many walks do not arrive.
        seed: of the noise.
        options: further ones of the method ``gmd``.

    ``.motion`` is the last walk, ``.numbers`` how deep it went into a post, in centimetres, for
    how many percent of its frames, and by how many centimetres it missed the place.
    """

    def __init__(
        self,
        prior: Velocity,
        prompt: str = "a person walks forward",
        goal: tuple[float, float] = (0.0, 3.2),
        posts: tuple[tuple[float, float], ...] = ((0.05, 1.5),),
        frames: int = 60,
        scale: float = 20.0,
        seed: int = 0,
        **options: Any,
    ) -> None:
        self.prior, self.prompt, self.frames, self.seed = prior, prompt, frames, seed
        self.options = options
        slim = {"description_width": "70px"}
        self.scale = widgets.FloatSlider(
            value=scale, min=0, max=max(60, scale), step=5, description="scale s", style=slim,
            continuous_update=False, layout={"width": "320px"},
        )  # fmt: skip
        self.said = widgets.HTML()
        self.board = Board((-2.2, 2.2), (-0.6, 4.4), ("x, m", "z, m"), "from above", height=420)
        self.board.handle("goal", goal, label="last frame")
        for k, at in enumerate(posts):
            self.board.handle(f"post {k + 1}", at, color="noise")
        self.viewer = Viewer(height=420, trail="pelvis", layout={"flex": "1 1 330px"})
        wrap = {"flex_flow": "row wrap", "width": "100%", "grid_gap": "4px 12px"}
        super().__init__([
            self.scale, widgets.Box([self.board, self.viewer], layout=wrap), self.said
        ])  # fmt: skip
        self._later = Later(SETTLE)
        self.board.on_move(self._moved)
        self.scale.observe(lambda change: self.run(), "value")
        self._draw_posts()
        self.run()

    @property
    def avoid(self) -> Avoid:
        """The goal: stay clear of every post."""
        places = [at for name, at in self.board.positions.items() if name != "goal"]
        return Avoid(circles(places, RADIUS), MARGIN)

    def _moved(self, name: str, position: tuple[float, float]) -> None:
        self._draw_posts()
        self._later.call(self.run)

    def run(self) -> None:
        """Walk anew, and show it or say what is wrong."""
        wish = pin("pelvis", [self.frames - 1], [self.board.positions["goal"]], axes="xz")
        try:
            self.motion = sample(
                self.prior, wish, self.prompt, self.frames, seed=self.seed, method="gmd",
                goal=self.avoid, scale=self.scale.value, **self.options,
            )  # fmt: skip
        except ValueError as error:  # a post on the start, or on the place itself
            self.said.value = status_line(str(error), "pf-bad")
            return
        depth = self.avoid.depth(self.motion.positions).numpy()
        missed = self.motion.joint("pelvis")[-1, [0, 2]] - self.board.positions["goal"]
        self.numbers = (
            100 * float(depth.max()), 100 * float((depth > 0).mean()),
            100 * float(np.linalg.norm(missed)),
        )  # fmt: skip
        self._show()

    def _show(self) -> None:
        track = self.motion.joint("pelvis")[:, [0, 2]]
        self.board.line("walk", track, "flow", 2.5, label="pelvis")
        self.viewer.show(Motion(self.motion.positions, self.prompt, self.motion.wish))
        deep, inside, missed = self.numbers
        self.said.value = status_line(
            f"deepest inside a post: {deep:.0f} cm; inside for {inside:.0f} % of the frames; "
            f"last frame missed by {missed:.0f} cm"
        )

    def _draw_posts(self) -> None:
        for name, at in self.board.positions.items():
            if name != "goal":
                self.board.line(f"around {name}", at + RADIUS * CIRCLE, "noise", 2)
