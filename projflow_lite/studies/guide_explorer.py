"""All constants of the guides at once: the boards of the notebook on pseudo-observations."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import ipywidgets as widgets
import numpy as np
from numpy.typing import NDArray

from projflow_lite.equations import TABLE_5, interpolate_observations
from projflow_lite.skeleton import FPS, N_JOINTS, joint_index
from projflow_lite.widgets import Board
from projflow_lite.widgets.board_explorer import legs, slider

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

RANGES: dict[str, tuple[float, float, float]] = {
    "w_kin": (0, 100, 1),
    "ridge": (0.1, 10, 0.1),
    "l_min": (0, 10, 0.5),
    "l_max": (0, 20, 0.5),
    "tau_min": (0.01, 1, 0.01),
    "c0": (0, 10, 0.1),
    "lambda_s": (0, 5, 0.1),
    "p": (0.5, 4, 0.1),
    "pi_min": (0.01, 0.5, 0.01),
    "pi_max": (0.05, 1, 0.01),
    "steps": (5, 100, 1),
}
"""Lowest, highest and step of every constant of Table 5 that can be moved."""

RAISED = 0.1
"""How far above its prediction the second joint is asked to be, metres."""


class State(NamedTuple):
    """What the sliders and the keyframes say.

    Attributes:
        constants: of Table 5, by name.
        t: flow time of the step nearest to the slider.
        observed: ``(frames, 22)``, which heights are pinned.
        y: ``(frames, 22)``, heights asked for, metres, on straight lines between the keyframes.
    """

    constants: dict[str, float]
    t: float
    observed: Mask
    y: Array


class GuideExplorer(widgets.VBox):
    """Drag keyframes and move constants: heights with and without guides, and the guides' trust.

    Args:
        x1_hat: ``(frames, 22, 3)``, the predicted motion, metres; its heights are corrected.
        keyframes: height of the first joint by frame, metres.
        trust: ``trust(constants, t, observed)`` gives the raw trust ``(frames,)``, the trust of
            every guide and which of them are active, both ``(frames, 22)``.
        project: ``project(constants, observed, y, trust, active)`` gives the heights
            ``(frames, 22)``.
        through_sampling: ``through_sampling(constants, t, raw, joints)`` gives the times of all
            steps ``(steps,)`` and, in each, the trust ``(steps,)`` of a guide on the first joint
            in a frame whose raw trust at time t is `raw`, beside a keyframe of these `joints`.
        joints: the joint of the keyframes, and one that can be pinned as well.
    """

    def __init__(
        self,
        x1_hat: Array,
        keyframes: Mapping[int, float],
        trust: Callable[..., tuple[Array, Array, Mask]],
        project: Callable[..., Array],
        through_sampling: Callable[..., tuple[Array, Array]],
        joints: tuple[str, str] = ("left_wrist", "left_elbow"),
    ) -> None:
        self.x1_hat, self.keyframes = x1_hat, keyframes
        self.trust, self.project, self.through_sampling = trust, project, through_sampling
        self.names = [name.split("_")[-1] for name in joints]
        self.joints = [joint_index(name, "GuideExplorer") for name in joints]
        self.frames = np.arange(len(x1_hat))
        self._make_boards()
        self._make_controls()
        grid = widgets.Layout(grid_template_columns="repeat(auto-fill, 310px)")
        super().__init__([
            self.path, self.trusted, self.times, widgets.HBox([self.both, self.table_5]), self.says,
            widgets.GridBox(list(self.sliders.values()), layout=grid),
        ])  # fmt: skip
        self._quiet = False
        self.update()
        self._observe()

    def _make_boards(self) -> None:
        across = (0, float(self.frames[-1]))
        self.path = Board(
            across, (0.5, 1.6), ("frame", "height, m"), height=330, equal=False,
            title="dashed: as predicted, thin: bare keyframes, thick: with guides",
        )  # fmt: skip
        self.trusted = Board(across, (0, 3.1), ("frame", "trust"), height=190, equal=False)
        self.times = Board(
            (0, 1), (0, 1.05), ("flow time t", "trust beside a keyframe"), height=190, equal=False
        )
        for frame, height in self.keyframes.items():
            self.path.handle(f"key {frame}", (frame, height), label="", along="y")

    def _make_controls(self) -> None:
        self.sliders = {"t": slider("t", 0.0, 0, 1)}
        for name, (low, high, step) in RANGES.items():
            kind = int if name == "steps" else float
            self.sliders[name] = slider(name, kind(TABLE_5[name]), low, high, step)
        for each in self.sliders.values():
            each.style.description_width = "70px"
        words = f"pin the {self.names[1]}, too"
        self.both = widgets.Checkbox(False, description=words, indent=False)
        self.table_5 = widgets.Button(description="Table 5")
        self.says = widgets.HTML()

    def _observe(self) -> None:
        for control in [*self.sliders.values(), self.both]:
            control.observe(self.update, "value")
        self.path.on_move(self.update)
        self.table_5.on_click(self.reset)

    def reset(self, *_: Any) -> None:
        """Put the paper's constants back."""
        self._quiet = True
        for name in RANGES:
            self.sliders[name].value = TABLE_5[name]
        self._quiet = False
        self.update()

    def state(self) -> State:
        """What is asked for now."""
        c = {name: each.value for name, each in self.sliders.items()}
        t = min(round(c["t"] * c["steps"]), c["steps"] - 1) / c["steps"]
        observed = np.zeros((len(self.frames), N_JOINTS), bool)
        y = np.zeros(observed.shape)
        first, second = self.joints
        for frame in self.keyframes:
            observed[frame, self.joints if self.both.value else [first]] = True
            y[frame, first] = self.path.positions[f"key {frame}"][1]
            y[frame, second] = self.x1_hat[frame, second, 1] + RAISED
        return State(c, t, observed, interpolate_observations(y, observed)[0])

    def update(self, *_: Any) -> None:
        """Draw everything anew, or say why that cannot be."""
        if self._quiet:
            return
        try:
            self._draw(self.state())
        except ValueError as error:
            self.says.value = f"<b>{error}</b>"

    def _draw(self, state: State) -> None:
        c, t, observed, y = state
        raw, pi, active = self.trust(c, t, observed)
        bare = self.project(c, observed, y, pi, np.zeros_like(active))
        guided = self.project(c, observed, y, pi, active)
        with self.path.hold(), self.trusted.hold(), self.times.hold():
            self._draw_heights(bare, guided, y, observed, active)
            self._draw_trust(raw, pi, active)
            self._draw_times(c, t, raw, observed)
        pops = [worst_acceleration(x[:, self.joints[0]]) for x in (bare, guided)]
        self.says.value = (
            f"t = {t:.2f}, {active.any(axis=1).sum()} guided frames, "
            f"{(pi == 1).sum()} guides as hard as keyframes. Worst acceleration of the "
            f"{self.names[0]}: bare {pops[0]:.0f}, guided {pops[1]:.0f} m/s²"
        )

    def _draw_heights(
        self, bare: Array, guided: Array, y: Array, observed: Mask, active: Mask
    ) -> None:
        for j, name, color in zip(self.joints, self.names, ("projected", "flow"), strict=True):
            asked = self._over_frames(y[:, j])
            predicted = self._over_frames(self.x1_hat[:, j, 1])
            self.path.line(f"{name} predicted", predicted, color, 1.5, dash=True)
            self.path.line(f"{name} bare", self._over_frames(bare[:, j]), color, 1)
            self.path.line(
                f"{name} guided", self._over_frames(guided[:, j]), color, 3.5, label=name
            )
            self.path.points(f"{name} guides", asked[active[:, j]], "wish", 4, 0.7)
            self.path.points(f"{name} keyframes", asked[observed[:, j]], "wish", 7, 1.0)

    def _draw_trust(self, raw: Array, pi: Array, active: Mask) -> None:
        at = np.flatnonzero(active[:, self.joints[0]])
        stems = self._over_frames(pi[:, self.joints[0]])[at]
        name = f"guide on the {self.names[0]}"
        self.trusted.line("clipped", legs(stems * [1, 0], stems), "wish", 5, label=name)
        line = self._over_frames(raw)
        self.trusted.line("raw", line, "quiet", 1.5, dash=True, label="before sharing and clipping")

    def _draw_times(self, c: dict[str, float], t: float, raw: Array, observed: Mask) -> None:
        """The guide beside the first keyframe in every step of the sampler, as a dot each."""
        key = min(self.keyframes)
        times, pi = self.through_sampling(c, t, raw[key + 1], np.flatnonzero(observed[key]))
        self.times.points("every step", np.stack([times, pi], axis=1), "wish", 3, 1.0)
        self.times.line("now", [[t, 0], [t, 1.05]], "quiet")

    def _over_frames(self, values: Array) -> Array:
        return np.stack([self.frames, values], axis=1)


def worst_acceleration(heights: Array) -> float:
    """Largest second difference of heights ``(frames,)`` in metres, as m/s²."""
    return float(np.abs(np.diff(heights, 2)).max() * FPS**2)
