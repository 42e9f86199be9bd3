"""Walk by sliders, and pull a foot: the widgets of the notebook on how a body walks."""

from __future__ import annotations

from typing import Any

import ipywidgets as widgets
import numpy as np
from numpy.typing import NDArray

from data_synth.angles import joint_angles
from data_synth.body import LONGEST_LEG, two_bones
from projflow_lite.motion import Motion
from projflow_lite.skeleton import FPS
from projflow_lite.studies.gait import (
    FRAMES,
    LEFT,
    PHASE,
    PRESETS,
    RIGHT,
    SLIDERS,
    Settings,
    Slider,
    cycle_of,
    facts_of,
    make_walk,
    toe_speed,
)
from projflow_lite.widgets import Board, Viewer


class GaitExplorer(widgets.VBox):
    """Sliders for a gait, the body that walks it, its footfalls and the angles of its left leg.

    Args:
        preset: the gait to begin with, a name of `PRESETS`.
        height: of the body's picture, pixels.

    The sliders are ``.sliders[name]``, the last walk is ``.walk``, what is said of it ``.facts``.

    Raises:
        ValueError: for an unknown preset.
    """

    def __init__(self, preset: str = "walk", height: int = 400) -> None:
        if preset not in PRESETS:
            raise ValueError(f"GaitExplorer: '{preset}' is not one of {', '.join(PRESETS)}")
        self.preset = widgets.ToggleButtons(
            options=list(PRESETS), value=preset, style={"button_width": "70px"}
        )
        self.sliders = {name: slider_of(each) for name, each in SLIDERS.items()}
        self.viewer = Viewer(height=height, follow=True, trail=["left_foot", "right_foot"])
        wide = widgets.Layout(width="100%")
        self.footfalls = Board(
            (0, FRAMES / FPS), (-0.1, 6), ("seconds", "toes over ground, m/s"), height=height // 2,
            equal=False, layout=wide,
        )  # fmt: skip
        self.leg = Board(
            (0, 100), (-60, 140), ("left leg, % of its cycle", "degrees"), height=height // 2,
            equal=False, layout=wide,
        )  # fmt: skip
        self.said = widgets.HTML()
        self.facts: dict[str, float] = {}
        super().__init__(self._rows())
        self._quiet = False
        self._choose()
        self.preset.observe(self._choose, "value")
        for name, slider in self.sliders.items():
            slider.observe(lambda change, name=name: self._moved(name), "value")
        self.viewer.observe(self._show_now, ["frame", "playing"])

    def _rows(self) -> list[widgets.Widget]:
        """Controls above, the body on the left, the two plots on the right of it."""
        wrap = widgets.Layout(flex_flow="row wrap", width="100%", grid_gap="0px 14px")
        self.viewer.layout = widgets.Layout(flex="1 1 310px", min_width="290px")
        plots = widgets.VBox(
            [self.footfalls, self.leg], layout=widgets.Layout(flex="1 1 370px", min_width="320px")
        )
        sliders = widgets.Box(list(self.sliders.values()), layout=wrap)
        return [self.preset, sliders, widgets.Box([self.viewer, plots], layout=wrap), self.said]

    @property
    def settings(self) -> Settings:
        """Where the sliders are."""
        return {name: slider.value for name, slider in self.sliders.items()}

    def _choose(self, change: dict[str, Any] | None = None) -> None:
        """Put all sliders where a preset has them, and show that at once."""
        self._quiet = True
        for name, value in {**PRESETS[self.preset.value], "slip": 0}.items():
            self._put(name, value)
        self._quiet = False
        self._moved("speed")

    def _moved(self, name: str) -> None:
        """Keep speed = cadence × stride / 2, then draw: a moved stride changes the cadence."""
        if self._quiet:
            return
        self._quiet = True
        twice, cadence = 2 * self.sliders["speed"].value, self.sliders["cadence"].value
        if name == "stride":
            cadence = self._put("cadence", twice / self.sliders["stride"].value)
        if name in ("speed", "cadence", "stride"):
            stride = self._put("stride", twice / cadence)
            if abs(stride - twice / cadence) > SLIDERS["stride"].step:  # it is at its end
                self._put("cadence", twice / stride)
        self._quiet = False
        self.draw()

    def _put(self, name: str, value: float) -> float:
        """Move a slider to the place nearest to a value; returns that place."""
        step = SLIDERS[name].step
        # The page knows no places but whole steps, and would answer with one as if it was moved.
        self.sliders[name].value = round(round(value / step) * step, 6)
        return self.sliders[name].value

    def draw(self) -> None:
        """Make the walk anew and show it everywhere."""
        self.walk = make_walk(self.settings)
        self.viewer.show(Motion(self.walk.positions))
        with self.footfalls.hold():
            self._draw_footfalls()
            self._show_now()
        with self.leg.hold():
            self._draw_leg()
        self.facts = facts_of(self.walk, self.settings)
        self.said.value = sentence(self.facts)

    def _draw_footfalls(self) -> None:
        """Each toe's speed over time, and above it when the plan has the foot on the floor."""
        speeds = toe_speed(self.walk.positions)
        top = max(1.0, 1.35 * float(speeds.max()))
        self.footfalls.y = [-0.03 * top, top]
        middle = (np.arange(len(speeds)) + 0.5) / FPS
        for side, name, color in ((LEFT, "left", "data"), (RIGHT, "right", "wish")):
            stands = self.walk.stands[:, side]
            bar = np.where(stands, (0.94 - 0.09 * side) * top, np.nan)
            self.footfalls.line(
                f"{name} stands", np.column_stack([np.arange(len(bar)) / FPS, bar]), color, 7
            )
            curve = np.column_stack([middle, speeds[:, side]])
            self.footfalls.line(name, curve, color, 2, label=f"{name} foot; bar: it stands")

    def _draw_leg(self) -> None:
        """Hip, knee and ankle of the left leg; the cycles of the walk lie over each other."""
        at, positions = self.settings, self.walk.positions
        cycle = cycle_of(at, PHASE, len(positions))[:, LEFT]
        order, angles = np.argsort(cycle), joint_angles(positions)
        for name, color in (("hip ahead", "prediction"), ("knee", "flow"), ("ankle up", "noise")):
            curve = np.column_stack([100 * cycle, angles[name][:, LEFT]])[order]
            self.leg.line(name, curve, color, 2, label=name)
        off = 100 * at["duty"]
        self.leg.line("off", [[off, -60], [off, 140]], "quiet", 1, dash=True)
        self.leg.text("off, in words", (off + 11, 125), "toe off")

    def _show_now(self, change: dict[str, Any] | None = None) -> None:
        """Mark the frame that is looked at; without a length while the body moves."""
        t = min(self.viewer.frame, FRAMES - 1) / FPS
        ends = [np.nan, np.nan] if self.viewer.playing else self.footfalls.y
        self.footfalls.line("now", [[t, end] for end in ends], "quiet", 1, dash=True)


def slider_of(each: Slider) -> widgets.FloatSlider:
    """One slider; its name stands before it."""
    digits = 0 if each.step >= 1 else 1 if each.step >= 0.1 else 2
    return widgets.FloatSlider(
        min=each.low, max=each.high, step=each.step, description=each.name,
        readout_format=f".{digits}f", layout=widgets.Layout(width="290px"),
        style={"description_width": "118px"},
    )  # fmt: skip


def sentence(facts: dict[str, float]) -> str:
    """The facts as one line below the pictures."""
    feet = (
        f"both feet stand {100 * facts['both']:.0f} % of the time, none {100 * facts['none']:.0f} %"
    )
    parts = [
        feet,
        f"a foot stands for {facts['stance']:.2f} s",
        f"a toe on the floor slides at {facts['slide']:.2f} m/s at most",
        f"skating score {facts['skating']:.2f}",
        f"knee up to {facts['knee']:.0f}°",
    ]
    if facts["lowered"] > 0.01:
        lower = 100 * facts["lowered"]
        parts.append(f"the pelvis is {lower:.0f} cm lower than asked for: legs reach no further")
    return '<div class="pf-status">' + " · ".join(parts) + "</div>"


class LegExplorer(widgets.VBox):
    """One leg seen from its side: drag the ankle, and inverse kinematics finds the knee.

    Args:
        thigh: length of the upper bone, metres.
        shank: length of the lower bone, metres.
        height: of the picture, pixels.

    The hip is at (0, 0). ``.ankle`` and ``.knee`` are where they are now, ``(2,)`` metres ahead and
    up; ``.missing`` is how far the ankle is out of reach.
    """

    def __init__(self, thigh: float = 0.41, shank: float = 0.43, height: int = 400) -> None:
        self.bones = thigh, shank
        self.board = Board(
            (-0.95, 0.95), (-1.0, 0.4), ("ahead, m", "up, m"), "drag the ankle", height
        )
        self.words = widgets.HTML()
        super().__init__([self.board, self.words])
        angle = np.linspace(0, 2 * np.pi, 90)
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        for name, radius in (("reach", sum(self.bones)), ("too near", abs(thigh - shank))):
            self.board.line(name, radius * circle, "quiet", 1, dash=True)
        self.board.text("hip", (-0.09, 0.05), "hip")
        self.board.on_move(lambda name, position: self.pull(position))
        self.pull((0.25, -0.70))

    def pull(self, ankle: Any) -> None:
        """Put the ankle somewhere and find the knee."""
        self.ankle = np.asarray(ankle, float)
        self.knee, self.missing = knee_of(self.ankle, *self.bones)
        distance = max(float(np.linalg.norm(self.ankle)), 1e-9)
        reached = self.ankle * (1 - self.missing / distance)
        along = reached / max(float(reached @ reached), 1e-9)
        other = 2 * (self.knee @ along) * reached - self.knee  # mirrored at the line hip–ankle
        with self.board.hold():
            thigh_circle, shank_circle = circles(reached, *self.bones)
            self.board.line("thigh circle", thigh_circle, "noise", 1)
            self.board.line("shank circle", shank_circle, "noise", 1)
            behind = np.array([[0.0, 0.0], other, reached])
            self.board.line("knee behind", behind, "quiet", 2, dash=True, label="bends backwards")
            leg = np.array([[0.0, 0.0], self.knee, reached])
            self.board.line("leg", leg, "flow", 5, label="thigh and shank")
            self.board.line("gap", np.array([reached, self.ankle]), "wish", 3, dash=True)
            self.board.points("knee", self.knee[None], "projected", 7, 1.0, label="knee")
            self.board.handle("ankle", self.ankle)
        self.words.value = self._sentence()

    def _sentence(self) -> str:
        """What the law of cosines says here."""
        if self.missing > 0.0005:
            text = f"out of reach by {100 * self.missing:.0f} cm: move the hip, or stretch a bone"
        else:
            one, other = -self.knee, self.ankle - self.knee
            cosine = one @ other / np.linalg.norm(one) / np.linalg.norm(other)
            bend = 180 - np.degrees(np.arccos(np.clip(cosine, -1, 1)))
            text = f"hip to ankle {np.linalg.norm(self.ankle):.2f} m, knee bent by {bend:.0f}°"
        return f'<div class="pf-status">{text}</div>'


def knee_of(ankle: NDArray, thigh: float, shank: float) -> tuple[NDArray[np.float64], float]:
    """The knee ``(2,)`` of a leg from (0, 0), bent ahead, and how far the ankle is out of reach.

    Args:
        ankle: ``(2,)`` ahead and up, metres.
        thigh: metres.
        shank: metres.
    """
    distance = float(np.linalg.norm(ankle))
    nearest = abs(thigh - shank) + 1e-3
    farthest = LONGEST_LEG * (thigh + shank)
    within = float(np.clip(distance, nearest, farthest))
    direction = ankle / distance if distance > 1e-6 else np.array([0.0, -1.0])
    end = np.array([0.0, *(within * direction)[::-1]])  # as x, y up, z ahead
    # Ahead of the leg, whichever way it points: a quarter turn from hip–ankle.
    pole = np.array([0.0, direction[0], -direction[1]])
    knee = two_bones(np.zeros(3), end, np.array(thigh), np.array(shank), pole)
    return knee[[2, 1]], distance - within


def circles(ankle: NDArray, thigh: float, shank: float) -> tuple[NDArray, NDArray]:
    """Where the knee may be for the thigh, and where for the shank: two arcs ``(60, 2)``."""
    turn = np.linspace(-1.3, 1.3, 60)
    down = np.arctan2(ankle[1], ankle[0])
    arcs = []
    for centre, radius, towards in ((np.zeros(2), thigh, down), (ankle, shank, down + np.pi)):
        angle = towards + turn
        arcs.append(centre + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    return arcs[0], arcs[1]
