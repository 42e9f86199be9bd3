"""The pose editor: grab a joint at any frame, drag it, and the motion follows."""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import reduce
from operator import and_
from typing import Any

import ipywidgets as widgets
import numpy as np

from projflow_lite.constraints import Wish, pin
from projflow_lite.motion import Motion
from projflow_lite.samplers import Velocity, sample
from projflow_lite.skeleton import JOINTS
from projflow_lite.widgets.answering import Later, status_line
from projflow_lite.widgets.studio import report
from projflow_lite.widgets.viewer import Viewer

ASK = "Grab a joint in the picture and drag it; it becomes a pin in the frame that is shown."
SETTLE = 0.01  # seconds: a hand that drags is followed, and need not come to rest


class PoseEditor(widgets.VBox):
    """A motion whose joints can be grabbed. What was dragged stays where it was put, exactly.

    While the hand moves, one message to the page answers; once it lets go, the line of words and
    the written place follow. The noise stays the same, so that only the pins change the motion.
    Without a mouse: choose the joint and the frame, and write its place.

    Args:
        prior: what to sample from, see `sample`.
        prompt: what the motion should be.
        frames: length of the motion.
        wish: what must hold besides the pins, or None.
        steps: of the sampler; or flow times; or None, see `sample`.
        seed: of the noise.
        height: of the picture, pixels.
        options: further arguments of `sample`.

    Raises:
        ValueError: as `sample` does.

    ``.pins`` is ``{(joint, frame): (x, y, z)}`` in metres, ``.motion`` the motion, ``.runs`` how
    often the sampler ran, ``.error`` what went wrong last.
    """

    def __init__(
        self,
        prior: Velocity,
        prompt: str | None = None,
        frames: int = 60,
        wish: Wish | None = None,
        steps: int | Sequence[float] | None = None,
        seed: int = 0,
        height: int = 460,
        **options: Any,
    ) -> None:
        self.prior, self.wish = prior, wish
        self.options = {"prompt": prompt, "frames": frames, "steps": steps, "seed": seed} | options
        self.pins: dict[tuple[int, int], tuple[float, ...]] = {}
        self.runs = 0
        self.error: Exception | None = None
        self._later = Later(SETTLE)
        self.motion = self._sample()
        self.viewer = Viewer(self.motion, grab=True, playing=False, height=height)
        self._make_controls()
        super().__init__([self._controls(), self.viewer, self.status])
        self._say(ASK)
        self._show_place()
        self._observe()

    def _make_controls(self) -> None:
        self.joint = widgets.Dropdown(
            options=[(name.replace("_", " "), k) for k, name in enumerate(JOINTS)],
            value=JOINTS.index("left_wrist"), description="joint",
            layout={"width": "185px"}, style={"description_width": "40px"},
        )  # fmt: skip
        self.place = [
            widgets.FloatText(
                description=axis, step=0.05, layout={"width": "104px"},
                style={"description_width": "14px"},
            )
            for axis in "xyz"
        ]  # fmt: skip
        self.undo = widgets.Button(description="Undo", tooltip="Take the last pin away")
        self.clear = widgets.Button(description="Clear", tooltip="Take all pins away")
        for button in (self.undo, self.clear):
            button.layout.width = "70px"
        self.status = widgets.HTML()

    def _controls(self) -> widgets.Widget:
        wrap = widgets.Layout(flex_flow="row wrap", width="100%", grid_gap="2px 8px")
        return widgets.Box([self.joint, *self.place, self.undo, self.clear], layout=wrap)

    def _observe(self) -> None:
        self.viewer.observe(self._pulled, "pull")
        self.viewer.observe(self._show_place, "frame")
        self.joint.observe(self._show_place, "value")
        for field in self.place:
            field.observe(self._written, "value")
        self.undo.on_click(lambda button: self._take_away(1))
        self.clear.on_click(lambda button: self._take_away(len(self.pins)))

    def _pulled(self, change: dict[str, Any]) -> None:
        """A joint was dragged: remember where to, and answer once no newer message waits."""
        pull = change["new"]
        if not pull:
            return
        self._pin(pull["joint"], pull["frame"], pull["at"])
        self.joint.value = pull["joint"]
        self._soon(wordless=not pull["done"])

    def _written(self, change: dict[str, Any]) -> None:
        """A coordinate was written."""
        if self._showing:
            return
        self._pin(self.joint.value, self.viewer.frame, [field.value for field in self.place])
        self._soon()

    def _pin(self, joint: int, frame: int, at: Sequence[float]) -> None:
        """Make a pin, or move it; the last one moved is the first one to be undone."""
        self.pins.pop((joint, frame), None)
        self.pins[joint, frame] = (*map(float, at),)

    def _take_away(self, number: int) -> None:
        """Take away the pins that were made last."""
        for key in list(self.pins)[::-1][:number]:
            del self.pins[key]
        self._soon()

    def _soon(self, wordless: bool = False) -> None:
        """Run once things have settled: what was dragged while we were busy makes one motion."""
        self._later.call(self.run, wordless)

    def run(self, wordless: bool = False) -> None:
        """Make the motion anew, and show it or say what is wrong.

        Args:
            wordless: send the picture alone, in one message, unless there is an error to say or to
                take back: the words would be old before they are read.
        """
        start, wordless = time.perf_counter(), wordless and self.error is None
        try:
            self.motion, self.error = self._sample(), None
        except Exception as error:  # anything at all: a traceback would vanish in a log
            self.error = error
            self._say(f"error: {error}", "pf-bad")
            return
        self.runs += 1
        self.viewer.show(self.motion)
        if wordless:
            return
        self._show_place()
        seconds = time.perf_counter() - start
        count = f"{len(self.pins)} pin{'s' * (len(self.pins) != 1)}"
        self._say(f"{count} · {report(self.motion, seconds)}" if self.pins else ASK)

    def _sample(self) -> Motion:
        wishes = [pin(joint, frame, at) for (joint, frame), at in self.pins.items()]
        if self.wish is not None:
            wishes.append(self.wish)
        wish = reduce(and_, wishes) if wishes else None
        return sample(self.prior, wish, **self.options)

    def _show_place(self, change: dict[str, Any] | None = None) -> None:
        """Write where the chosen joint is in the frame that is shown."""
        self._showing = True
        at = np.asarray(self.motion.positions)[self.viewer.frame, self.joint.value]
        for field, value in zip(self.place, at, strict=True):
            field.value = round(float(value), 3)
        self._showing = False

    def _say(self, text: str, kind: str = "") -> None:
        self.status.value = status_line(text, kind)
