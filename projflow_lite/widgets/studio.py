"""The studio: draw a path for a joint, and see a motion that follows it."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Sequence
from typing import Any

import ipywidgets as widgets
import numpy as np
from numpy.typing import NDArray

from projflow_lite.motion import Motion
from projflow_lite.skeleton import JOINTS, joint_index
from projflow_lite.widgets.answering import Later, status_line
from projflow_lite.widgets.path_pad import BOUNDS, PLANES, PathPad
from projflow_lite.widgets.standing import standing_pose
from projflow_lite.widgets.viewer import Viewer

Make = Callable[[str, str, NDArray[np.float64], str], Motion]

VIEWS = {"front (x, y)": "xy", "side (z, y)": "zy", "from above (x, z)": "xz"}
PROMPTS = (
    "a person waves with the left hand",
    "a person waves with the right hand",
    "a person stands still",
    "a person reaches up with the right hand",
    "a person walks forward",
    "a person walks in a curve to the left",
    "a person sidesteps to the left",
    "a person runs forward",
    "a person squats",
    "a person jumps forward",
)
DRAW_FIRST = "Draw a path in the left picture, or choose a shape below it."
SETTLE = 0.01  # seconds to wait for more changes, so that many quick ones make one motion
AFTER = 0.04  # seconds from a picture to its words: the page paints the picture first


class WishStudio(widgets.VBox):
    """Joint, plane, prompt, a pad to draw on, and the motion that comes of it.

    Args:
        make: called as ``make(joint, plane, path, prompt)`` whenever a path was drawn or a control
            was changed; ``path`` is ``(samples, 2)`` metres in the axes of the plane (see
            `PathPad`). Returns the Motion to show. What it raises is shown in the status line.
        joint: the joint to start with, by name.
        plane: ``"xy"``, ``"zy"`` or ``"xz"``.
        prompt: the text to start with.
        prompts: texts to choose from; any other can be typed.
        joints: names of the joints to choose from.
        samples: points of the path, usually one for each frame.
        height: height of the two pictures, pixels.

    Raises:
        ValueError: for a joint, plane or height that does not exist.

    The last motion is ``.motion``, what went wrong last is ``.error``, and ``.pad`` and
    ``.viewer`` are the two pictures.
    """

    def __init__(
        self,
        make: Make,
        *,
        joint: str = "left_wrist",
        plane: str = "xy",
        prompt: str = PROMPTS[0],
        prompts: Sequence[str] = PROMPTS,
        joints: Sequence[str] = JOINTS,
        samples: int = 60,
        height: int = 400,
    ) -> None:
        joint_index(joint, "WishStudio")
        if plane not in PLANES:
            raise ValueError(
                f"WishStudio: '{plane}' is not a plane; choose from {', '.join(PLANES)}"
            )
        if not callable(make):
            raise ValueError("WishStudio: make must be a function make(joint, plane, path, prompt)")
        self.make = make
        self.motion: Motion | None = None
        self.error: Exception | None = None
        self.runs = 0
        self._later, self._told = Later(SETTLE), Later(AFTER)
        self.joint = widgets.Dropdown(
            options=[(name.replace("_", " "), name) for name in joints],
            value=joint,
            description="joint",
        )
        self.plane = widgets.Dropdown(options=list(VIEWS.items()), value=plane, description="view")
        self.prompt = widgets.Combobox(
            value=prompt,
            options=list(prompts),
            description="prompt",
            placeholder="choose a text, or write one",
            continuous_update=False,
        )
        self.again = widgets.Button(
            description="Again", icon="refresh", tooltip="Make a motion for this path once more"
        )
        self.pad = PathPad(plane=plane, samples=samples, height=height)
        self.viewer = Viewer(Motion(standing_pose()), height=height, trail=joint)
        self.status = widgets.HTML()
        super().__init__(self._rows())
        self._show_reference()
        self._say(DRAW_FIRST)
        self._observe()

    def _rows(self) -> list[widgets.Widget]:
        """Controls and status above, the two pictures side by side (below each other if narrow)."""
        for control, width in ((self.joint, "190px"), (self.plane, "220px"), (self.prompt, "auto")):
            control.layout = widgets.Layout(width=width, min_width="150px")
            control.style.description_width = "54px"
        self.prompt.layout.flex = "1 1 260px"
        self.again.layout = widgets.Layout(width="90px")
        self.pad.layout = widgets.Layout(flex="2 1 330px", min_width="300px")
        self.viewer.layout = widgets.Layout(flex="3 1 400px", min_width="300px")
        wrap = widgets.Layout(flex_flow="row wrap", width="100%", grid_gap="4px 10px")
        controls = widgets.Box([self.joint, self.plane, self.prompt, self.again], layout=wrap)
        pictures = widgets.Box([self.pad, self.viewer], layout=wrap)
        return [controls, self.status, pictures]

    def _observe(self) -> None:
        self.pad.observe(self._soon, "version")
        self.prompt.observe(self._soon, "value")
        self.joint.observe(self._joint_changed, "value")
        self.plane.observe(self._plane_changed, "value")
        self.again.on_click(self._soon)

    def _joint_changed(self, change: dict[str, Any]) -> None:
        self.viewer.trail = self.joint.value
        self._show_reference()
        self._soon()

    def _plane_changed(self, change: dict[str, Any]) -> None:
        self.pad.plane = self.plane.value  # clears the path
        self._show_reference()
        self._say(DRAW_FIRST)

    def _show_reference(self) -> None:
        """Put the body, and the path its joint takes now, behind the drawing."""
        reference = standing_pose() if self.motion is None else next(iter(self.motion)).positions
        with self.pad.hold_sync():  # one message
            self.pad.bounds = room_for(reference, self.plane.value)
            self.pad.show_reference(reference, self.joint.value)

    def _soon(self, *_: Any) -> None:
        """Run once things have settled: strokes drawn while we were busy make one motion."""
        self._later.call(self.run)

    def run(self) -> None:
        """Make a motion for the path on the pad, and show it or say what is wrong."""
        path = self.pad.path
        if path is None:
            self._say(DRAW_FIRST)
            return
        self._say("sampling …", "pf-busy")
        start = time.perf_counter()
        try:
            with warnings.catch_warnings(record=True) as heard:
                warnings.simplefilter("always")
                motion = self.make(self.joint.value, self.plane.value, path, self.prompt.value)
            seconds = time.perf_counter() - start
            self.viewer.show(motion)
        except Exception as error:  # anything at all: a traceback would vanish in a log
            self.error = error
            kind = "" if isinstance(error, ValueError) else f" ({type(error).__name__})"
            self._say(f"error{kind}: {error}", "pf-bad")
            return
        self.motion, self.error = motion, None
        self.runs += 1
        # What was warned of, a word the prior never saw for example, would be lost in a log.
        said = dict.fromkeys(str(warning.message) for warning in heard)
        self._told.call(self._tell, " · ".join([report(motion, seconds), *said]))

    def _tell(self, words: str) -> None:
        """What follows a picture: words, and the body behind the next drawing."""
        self._show_reference()
        self._say(words)

    def _say(self, text: str, kind: str = "") -> None:
        self._told.forget()  # older words
        self.status.value = status_line(text, kind)


def report(motion: Motion, seconds: float) -> str:
    """One line about a motion: how long it took and how exactly it does what was asked."""
    line = f"{motion.frames} frames in {seconds:.2f} s"
    return line if motion.wish is None else f"{line} · max |A x − y| = {motion.residual:.1e} m"


def room_for(positions: NDArray, plane: str) -> list[float]:
    """Bounds of the pad that hold the usual ones and all of a motion, to the next half metre."""
    usual = BOUNDS[plane]
    flat = np.asarray(positions)[..., PLANES[plane]].reshape(-1, 2)
    low = np.floor(flat.min(axis=0) / 0.5) * 0.5
    high = np.ceil(flat.max(axis=0) / 0.5) * 0.5
    return [
        min(usual[0], float(low[0])),
        max(usual[1], float(high[0])),
        min(usual[2], float(low[1])) if plane == "xz" else usual[2],
        max(usual[3], float(high[1])),
    ]
