"""GMD, part by part: one walk, some keyframes of its pelvis, and every way of meeting them."""

from __future__ import annotations

from typing import Any, NamedTuple

import ipywidgets as widgets
import numpy as np

from projflow_lite.motion import Motion
from projflow_lite.scores import foot_skating, worst_acceleration
from projflow_lite.studies.gmd_table import tears, walked
from projflow_lite.studies.gmd_ways import (
    GROUND,
    HOWS,
    Models,
    Way,
    all_ways,
    frames_of,
    make,
    walks,
    wish_of,
)
from projflow_lite.studies.keyframes import FRAMES
from projflow_lite.widgets import Viewer

COUNTS = (1, 2, 5, 15, FRAMES)
COLUMNS = (
    "misses by, cm", "path walked, %", "feet slide, %", "bones tear, %", "worst acc., m/s²",
    "seconds",
)  # fmt: skip
WALK = 2500
"""Seed of the walks."""


class Outcome(NamedTuple):
    """What one way made: ``(batch, frames, 22, 3)``, and the numbers of `COLUMNS`."""

    motion: Motion
    numbers: tuple[float, ...]


class GmdExplorer(widgets.VBox):
    """Keyframes of a held-out walk, met by GMD's parts and by ProjFlow.

    The solid body is what the chosen way makes, the thin one the walk that the keyframes are from;
    on the ground is the path of the pelvis. The table keeps a line for every way that was tried.

    Args:
        models: see `projflow_lite.studies.gmd_ways.load_models`.
        method: a name of `HOWS` to begin with.
        keys: keyframes to begin with.
        batch: walks whose numbers are averaged; the first is shown.
        seed: of the noise.

    ``.outcomes`` are the ways tried, by name, for the present keyframes and tau.
    """

    def __init__(
        self,
        models: Models,
        method: str = "emphasis, guidance",
        keys: int = 5,
        batch: int = 4,
        seed: int = 0,
    ) -> None:
        self.models, self.seed = models, seed
        self.clips = walks(batch, WALK)
        self.outcomes: dict[str, Outcome] = {}
        able = {way.method for way in all_ways(models)}
        slim = {"description_width": "70px"}
        self.method = widgets.Dropdown(
            options=[name for name in HOWS if name in able], value=method, description="way",
            style=slim, layout={"width": "330px"},
        )  # fmt: skip
        self.count = widgets.SelectionSlider(
            options=COUNTS, value=keys, description="keyframes", style=slim,
            continuous_update=False, layout={"width": "280px"},
        )  # fmt: skip
        self.tau = widgets.FloatSlider(
            value=0.5, min=0, max=1, step=0.25, description="τ", style=slim,
            continuous_update=False, layout={"width": "260px"},
        )  # fmt: skip
        self.viewer = Viewer(height=380, trail="pelvis", layout={"flex": "1 1 330px"})
        self.table = widgets.HTML(layout={"flex": "1 1 430px"})
        wrap = {"flex_flow": "row wrap", "width": "100%", "grid_gap": "4px 12px"}
        super().__init__([
            widgets.Box([self.method, self.count, self.tau], layout=wrap),
            widgets.Box([self.viewer, self.table], layout=wrap),
        ])  # fmt: skip
        for control in (self.count, self.tau):
            control.observe(self._new_wish, "value")
        self.method.observe(self._show, "value")
        self._show()

    def try_way(self, name: str) -> Outcome:
        """What a way makes of the present keyframes; made once."""
        if name not in self.outcomes:
            way = Way("keyframes", name, self.count.value, self.tau.value)
            x, seconds = make(self.models, way, self.clips, self.seed)
            self.outcomes[name] = Outcome(Motion(x), (*self._numbers(x, way), seconds))
        return self.outcomes[name]

    def try_all(self) -> None:
        """Try every way, and show the table."""
        for name in self.method.options:
            self.try_way(name)
        self._show()

    def _numbers(self, x: np.ndarray, way: Way) -> tuple[float, ...]:
        missed = (x - self.clips.positions)[:, frames_of(way), 0][..., list(GROUND)]
        return (
            100 * float(np.linalg.norm(missed, axis=-1).mean()),
            100 * walked(x),
            100 * float(foot_skating(x).mean()),
            100 * float(tears(x).mean()),
            float(worst_acceleration(x).mean()),
        )

    def _new_wish(self, change: dict[str, Any]) -> None:
        self.outcomes.clear()
        self._show()

    def _show(self, change: dict[str, Any] | None = None) -> None:
        motion = self.try_way(self.method.value).motion
        prompt = self.clips.captions[0]
        way = Way("keyframes", self.method.value, self.count.value)
        first = Motion(motion.positions[0], prompt, wish_of(self.clips.positions[0], way))
        clip = Motion(self.clips.positions[0].astype(float), prompt)
        self.viewer.show(first, clip, names=[self.method.value, f"the clip: {prompt}"])
        self.table.value = table(self.outcomes, self.method.value)


def table(outcomes: dict[str, Outcome], chosen: str) -> str:
    """The numbers of the ways tried, as HTML; the chosen one bold."""
    head = "".join(f'<th style="text-align: right; padding: 2px 6px">{c}</th>' for c in COLUMNS)
    lines = []
    for name in (name for name in HOWS if name in outcomes):
        weight = "bold" if name == chosen else "normal"
        cells = "".join(
            f'<td style="text-align: right; padding: 2px 6px">{number:.1f}</td>'
            for number in outcomes[name].numbers
        )
        named = f'<td style="white-space: nowrap">{name}</td>'
        lines.append(f'<tr style="font-weight: {weight}">{named}{cells}</tr>')
    return f"<table><tr><th></th>{head}</tr>{''.join(lines)}</table>"
