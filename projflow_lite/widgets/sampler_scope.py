"""The sampler scope: one sample, taken apart. Scrub the sampling time and see every step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import ipywidgets as widgets
import numpy as np
from numpy.typing import NDArray

from projflow_lite.constraints import Rows, Wish
from projflow_lite.motion import Motion
from projflow_lite.samplers import GuideSettings, ProjectionStep, Step, Velocity, sample
from projflow_lite.skeleton import N_JOINTS
from projflow_lite.widgets.board import Board
from projflow_lite.widgets.flipbook import Flipbook
from projflow_lite.widgets.viewer import Viewer

NAMES = ("projected", "predicted", "state")
FLOOR = -2.0
"""Where hard rows are drawn, whose standard deviation is 0: 10^-2 cm."""


class SamplerScope(widgets.VBox):
    r"""Every step of one sample: what it saw, what it predicted, where it was put.

    Left the body: solid the predicted motion after its projection, :math:`\hat x_1^*` (ProjFlow
    eq. 8), thin the prediction itself, :math:`\hat x_1` (eq. 5), and, if ticked, the noisy state
    :math:`x_t`. Right, frame by frame, how firmly each row of the wish and each guide around it is
    held in this step: their standard deviation (eq. 12-18), hard rows at the bottom. Guides that
    are out of reach (the halo of eq. 14) are not drawn. Below, over all steps, how far the
    projection had to move the body.

    Args:
        prior: what to sample from, see `sample`.
        wish: what must hold.
        prompt: what the motion should be.
        frames: length of the motion.
        steps: of the sampler; or flow times; or None, see `sample`.
        seed: of its noise.
        guides: see `sample`.
        height: of the picture of the body, pixels.
        options: further arguments of `sample`.

    Raises:
        ValueError: as `sample` does.

    ``.record`` holds every `Step`, ``.step`` is the slider, ``.motion`` what came out. All steps
    are drawn at once, and the page turns them (see `Flipbook`).
    """

    def __init__(
        self,
        prior: Velocity,
        wish: Wish,
        prompt: str | None = None,
        frames: int = 60,
        steps: int | Sequence[float] | None = None,
        seed: int = 0,
        guides: bool | GuideSettings = True,
        height: int = 380,
        **options: Any,
    ) -> None:
        self.record: list[Step] = []
        options |= {"guides": guides, "callback": self.record.append}
        self.motion = sample(prior, wish, prompt, frames, steps, seed, **options)
        guide = ProjectionStep(
            wish, frames, options.get("metric", "kinematic"), guides=guides
        ).guides
        self.frame_of_row = frames_of_rows(guide.rows if guide else wish.rows(frames))
        self.moved = np.array([moved_by(step) for step in self.record])
        self._make_parts(height)
        self._draw_way()
        self.said = Flipbook(
            self.step, [self.viewer, self.held, self.way], self._show,
            layout=widgets.Layout(align_self="center"),
        )  # fmt: skip
        super().__init__(self._rows())
        self.noisy.observe(lambda change: self.said.redraw(), "value")

    def _make_parts(self, height: int) -> None:
        last = len(self.record) - 1
        self.viewer = Viewer(height=height, playing=False, layout=widgets.Layout(width="100%"))
        self.viewer.frame = self._first_frame()
        self.step = widgets.IntSlider(
            value=last // 2, min=0, max=last, description="step",
            layout=widgets.Layout(width="340px"), style={"description_width": "40px"},
        )  # fmt: skip
        self.noisy = widgets.Checkbox(
            value=False, description="show the state x_t", indent=False,
            layout=widgets.Layout(width="170px"),
        )  # fmt: skip
        layout = {"flex": "2 1 300px", "min_width": "280px"}
        self.held = Board(
            (0, max(1, self.motion.frames - 1)), (FLOOR - 0.3, 3.0),
            ("frame", "log₁₀ of std, cm"), "how firmly rows are held",
            height=(height + 60) // 2, equal=False, layout=widgets.Layout(**layout),
        )  # fmt: skip
        self.way = Board(
            (0, 1), (0, 1.15 * max(1e-3, 100 * self.moved.max())),
            ("flow time t", "cm"), "farthest joint that the projection moved",
            height=(height + 60) // 2, equal=False, layout=widgets.Layout(**layout),
        )  # fmt: skip

    def _rows(self) -> list[widgets.Widget]:
        wrap = widgets.Layout(flex_flow="row wrap", width="100%", grid_gap="4px 12px")
        body = widgets.VBox([self.viewer], layout=widgets.Layout(flex="3 1 340px"))
        graphs = widgets.VBox([self.held, self.way], layout=widgets.Layout(flex="2 1 300px"))
        controls = widgets.Box([self.step, self.noisy, self.said], layout=wrap)
        return [controls, widgets.Box([body, graphs], layout=wrap)]

    def _first_frame(self) -> int:
        """The first frame that was asked for: there is most to see while the steps go by."""
        wish, last = self.motion.wish, self.motion.frames - 1
        return 0 if wish is None else int(np.min(wish.markers(last + 1).frame, initial=last))

    def _show(self, k: int) -> str:
        """Draw a step; returns what there is to say of it."""
        step = self.record[k]
        bodies = [
            Motion(x[0].double().numpy(), wish=wish)
            for x, wish in (
                (step.x1_projected, self.motion.wish), (step.x1_hat, None), (step.x_t, None),
            )
        ]  # fmt: skip
        shown = 3 if self.noisy.value else 2
        self.viewer.show(*bodies[:shown], names=NAMES[:shown])
        self._draw_held(step)
        now = 100 * self.moved[k]
        with self.way.hold():
            self.way.points("now", [[step.t, now]], "projected", size=6, opacity=1)
        return f"t = {step.t:.3f} → {step.t_next:.3f}, moved by {now:.1f} cm"

    def _draw_held(self, step: Step) -> None:
        """Standard deviation of every row that acts, against its frame."""
        variance = np.asarray(step.variance, float)[0]
        acts = np.isfinite(variance)
        hard, soft = acts & (variance == 0), acts & (variance > 0)
        firm = np.column_stack([self.frame_of_row[hard], np.full(hard.sum(), FLOOR)])
        std = np.log10(np.clip(100 * np.sqrt(variance[soft]), 10**FLOOR, None))
        loose = np.column_stack([self.frame_of_row[soft], std])
        with self.held.hold():
            self.held.points("soft", loose, "flow", 3.5, 0.8, label="guides and soft rows")
            self.held.points("hard", firm, "wish", 4.5, 0.9, label="hard: std 0")

    def _draw_way(self) -> None:
        times = [step.t for step in self.record]
        with self.way.hold():
            self.way.line("way", np.column_stack([times, 100 * self.moved]), "flow")


def frames_of_rows(rows: Rows) -> NDArray[np.float64]:
    """Frame that each row looks at, ``(rows,)``; the mean of them if there are several."""
    frame = np.arange(rows.A.shape[1]) // (N_JOINTS * 3)
    reads = (rows.A != 0).astype(float)
    return (reads @ frame) / np.maximum(reads.sum(1).A1, 1)


def moved_by(step: Step) -> float:
    """Distance of the joint that the projection moved farthest, metres."""
    return float((step.x1_projected - step.x1_hat)[0].norm(dim=-1).max())
