"""Damage held-out motion by a slider, watch the body, and see which scores notice."""

from __future__ import annotations

import html
from typing import Any

import ipywidgets as widgets
import numpy as np

from projflow_lite.motion import Motion
from projflow_lite.studies.score_court import FAULTS, SHOWN, Court, Range, multiple, noticed
from projflow_lite.widgets import Viewer

LOW, HIGH = 0.1, 100.0
"""Ends of the bars, in multiples of what held-out data scores."""


class ScoreExplorer(widgets.VBox):
    """Choose a fault and its size: the body on the left, all scores beside it.

    A bar is a score in multiples of what the same clips score undamaged, on a logarithmic scale;
    the grey band is by how much two sets of held-out clips differ by chance. What reaches out of
    the band is orange.

    Args:
        court: the data that plays along, if there is one already.
        clip: which clip the picture shows.

    The chosen fault and size are ``.fault`` and ``.size``; ``.scores`` are those of the damaged
    set, ``.noticed`` the names of the scores that notice, ``.viewer`` is the picture.
    """

    def __init__(self, court: Court | None = None, clip: int = 0) -> None:
        self.court = court or Court()
        self._found: dict[tuple[str, float], dict[str, float]] = {}
        slim = {"description_width": "50px"}
        self.fault = widgets.Dropdown(
            options=list(FAULTS), description="fault", style=slim,
            layout=widgets.Layout(width="230px"),
        )  # fmt: skip
        self.size = widgets.SelectionSlider(
            options=self._sizes(), description="size", continuous_update=False, style=slim,
            layout=widgets.Layout(width="420px"),
        )  # fmt: skip
        self.clip = widgets.BoundedIntText(
            clip, 0, len(self.court.shown.captions) - 1, description="clip", style=slim,
            layout=widgets.Layout(width="120px"),
        )  # fmt: skip
        self.viewer = Viewer(
            height=360,
            layout=widgets.Layout(flex="1 1 284px", max_width="420px", min_width="284px"),
        )
        self.bars = widgets.HTML(layout=widgets.Layout(flex="0 0 352px"))
        self.said = widgets.HTML()
        wrap = widgets.Layout(flex_flow="row wrap", width="100%", grid_gap="4px 12px")
        super().__init__([
            widgets.Box([self.fault, self.size, self.clip], layout=wrap),
            widgets.Box([self.viewer, self.bars], layout=wrap),
            self.said,
        ])  # fmt: skip
        self.show()
        self.fault.observe(self._other_fault, "value")
        self.size.observe(self.show, "value")
        self.clip.observe(self.show, "value")

    def _sizes(self) -> list[tuple[str, float]]:
        fault = FAULTS[self.fault.value]
        return [(f"{size:g} {fault.unit}", size) for size in fault.sizes]

    def _other_fault(self, change: dict[str, Any]) -> None:
        """Begin at the least size of the new fault."""
        self.size.unobserve(self.show, "value")
        self.size.options = self._sizes()
        self.size.observe(self.show, "value")
        self.show()

    def show(self, change: dict[str, Any] | None = None) -> None:
        """Damage, score and draw."""
        court, key = self.court, (self.fault.value, self.size.value)
        positions, was = court.damaged(*key)
        if key not in self._found:
            self._found[key] = court.scores(positions, was, court.shown.captions)
        self.scores = self._found[key]
        self.noticed = [name for name in SHOWN if noticed(self.scores[name], court.floor[name])]
        k = self.clip.value
        prompt = court.shown.captions[k]
        self.viewer.show(
            Motion(positions[k], prompt), Motion(court.shown.positions[k]),
            names=[self.fault.value, "the data's"],
        )  # fmt: skip
        self.bars.value = "".join(
            ["<table style='border-spacing:0;font-size:11px;line-height:1.4'>"]
            + [HEAD, *(bar(name, self.scores[name], court.floor[name]) for name in SHOWN)]
            + [SCALE, "</table>"]
        )
        blind = len(SHOWN) - len(self.noticed)
        seen = ", ".join(self.noticed) or "none"
        self.said.value = (
            f"Prompt of this clip: “{html.escape(prompt)}”. "
            f"<b>Who notices? {seen}.</b> Blind: {blind} of {len(SHOWN)}."
        )


LABEL = "padding-right:8px;width:116px;text-align:right;white-space:nowrap"


def bar(name: str, value: float, floor: Range) -> str:
    """One score as a row of the table."""
    seen = noticed(value, floor)
    start, end = sorted((place(1.0), place(multiple(name, value, floor))))
    low, high = (place(multiple(name, floor.own + s * floor.reach, floor)) for s in (-1, 1))
    colour, weight = ("#d55e00", "bold") if seen else ("#8a8a8a", "normal")
    piece = (
        "<div style='position:absolute;left:{:.1f}%;width:{:.1f}%;top:{}px;height:{}px;{}'></div>"
    )
    band = piece.format(low, max(high - low, 0.5), 0, 16, "background:#9996")
    body = piece.format(start, max(end - start, 0.7), 4, 8, f"background:{colour}")
    track = "<div style='position:relative;width:150px;height:16px;overflow:hidden'>"
    return (
        f"<tr><td style='{LABEL};font-weight:{weight}'>{name}</td>"
        f"<td>{track}{band}{body}</div></td>"
        f"<td style='padding-left:8px;font-weight:{weight}'>{number(value)}</td>"
        f"<td style='padding-left:6px;opacity:0.7'>{number(floor.own)}</td></tr>"
    )


def number(value: float) -> str:
    """Three digits, and no powers of ten for what is as good as nothing."""
    return f"{value:.3g}" if value >= 0.001 else "0"


def place(ratio: float) -> float:
    """Where a multiple of the floor lies along a bar, per cent."""
    share = np.log(max(ratio, LOW) / LOW) / np.log(HIGH / LOW)
    return float(100 * min(share, 1.0))


def scale() -> str:
    """The row of numbers below the bars."""
    mark = "<span style='position:absolute;left:{:.0f}%;transform:translateX(-{}%)'>{:g}×</span>"
    ends = ((LOW, 0), (1.0, 50), (10.0, 50), (HIGH, 100))  # and how far left of its place each is
    marks = "".join(mark.format(place(x), shift, x) for x, shift in ends)
    track = "<div style='position:relative;width:150px;height:16px'>"
    return f"<tr style='opacity:0.7'><td></td><td>{track}{marks}</div></td><td></td><td></td></tr>"


SCALE = scale()
HEAD = (
    "<tr style='opacity:0.7'><td></td><td></td>"
    "<td style='padding-left:8px'>score</td><td style='padding-left:6px'>data</td></tr>"
)
