"""One wish, every method: choose one, watch the body, and see what each gave up."""

from __future__ import annotations

import html
import time
from typing import Any, NamedTuple, cast

import ipywidgets as widgets
import numpy as np
from numpy.typing import NDArray

from data_synth import held_out
from projflow_lite.constraints import Wish, pin
from projflow_lite.motion import Motion
from projflow_lite.prior import Prior
from projflow_lite.samplers import sample
from projflow_lite.samplers.pace import Pace
from projflow_lite.samplers.projflow import Velocity
from projflow_lite.scores import bone_length_error, foot_skating, worst_acceleration
from projflow_lite.skeleton import CONTROLLED
from projflow_lite.studies.cells import Rival
from projflow_lite.studies.control_models import LOADERS, absent_of, said_of
from projflow_lite.studies.control_ways import OURS, RIVALS, TRAINED
from projflow_lite.widgets import Viewer
from projflow_lite.widgets.answering import status_line

USUAL: dict[str, dict[str, Any]] = {
    "projflow": {"eta": "paper"},
    "dno": {"iterations": 20, "solver_steps": 8},
}
"""Options by method: the paper's noise, and a search for noise short enough to wait for."""

MOVING = OURS[0]._replace(name="projflow, moving metric")
WAYS = {rival.name: rival for rival in (*RIVALS[:2], MOVING, *RIVALS[2:], *TRAINED)}
"""Those that need no training, ProjFlow with a metric over time, and the trained ones, by name."""

COUNTS = (1, 2, 3, 5, 10, 30)
COLUMNS = ("misses by, cm", "worst acc., m/s²", "bones change, %", "feet slide, %", "seconds")


class Outcome(NamedTuple):
    """What one method made of the wish, and the numbers of `COLUMNS`."""

    motion: Motion
    numbers: tuple[float, ...]


class MethodExplorer(widgets.VBox):
    """Keyframes of one joint of a held-out clip, met by any of the methods.

    The solid body is what the method makes, the thin one the clip that the keyframes are from. All
    methods begin with the same noise. The table keeps a line for every method that was tried. A
    trained method whose model is not in the package, or is of another prior, is left out, and a
    sentence says so.

    Args:
        prior: what to sample from.
        prompt: of the clip: the first held-out one whose caption has these words.
        frames: length of the motion.
        batch: motions whose numbers are averaged; the first is shown.

    Raises:
        ValueError: if no held-out caption has the words of the prompt.

    ``.outcomes`` are the methods tried, by name, for the present wish, ``.ways`` all that can be.
    """

    def __init__(
        self,
        prior: Velocity,
        prompt: str = "walks forward",
        frames: int = 60,
        batch: int = 4,
    ) -> None:
        clips = held_out(340, frames)
        places = [k for k, caption in enumerate(clips.captions) if prompt in caption]
        if not places:
            raise ValueError(f"MethodExplorer: no held-out clip is called '{prompt}'")
        self.prior, self.frames, self.batch = prior, frames, batch
        self.clip = Motion(clips.positions[places[0]].astype(float), clips.captions[places[0]])
        absent = absent_of(prior, TRAINED)
        left_out = {name for name, _ in absent}
        self.ways = {name: rival for name, rival in WAYS.items() if name not in left_out}
        self._models: dict[str, Velocity] = {"": prior}
        self._tried: dict[tuple[str, int], dict[str, Outcome]] = {}
        slim = {"description_width": "80px"}
        self.method = widgets.Dropdown(
            options=list(self.ways), value="projflow", description="method", style=slim,
            layout={"width": "240px"},
        )  # fmt: skip
        self.joint = widgets.Dropdown(
            options=CONTROLLED, value="left_wrist", description="joint", style=slim,
            layout={"width": "220px"},
        )  # fmt: skip
        self.count = widgets.SelectionSlider(
            options=COUNTS, value=5, description="keyframes",
            style={"description_width": "initial"}, continuous_update=False,
            layout={"width": "300px"},
        )  # fmt: skip
        self.viewer = Viewer(height=380, trail=self.joint.value, layout={"flex": "1 1 330px"})
        self.table = widgets.HTML(layout={"flex": "1 1 380px"})
        self.left_out = widgets.HTML(status_line(said_of(absent) or ""))
        wrap = {"flex_flow": "row wrap", "width": "100%", "grid_gap": "4px 12px"}
        super().__init__([
            widgets.Box([self.method, self.joint, self.count], layout=wrap),
            widgets.Box([self.viewer, self.table], layout=wrap),
            *([self.left_out] if absent else []),
        ])  # fmt: skip
        for control in (self.joint, self.count):
            control.observe(self._new_wish, "value")
        self.method.observe(self._show, "value")
        self._show()

    @property
    def outcomes(self) -> dict[str, Outcome]:
        """What the methods tried so far made of the present wish, by name."""
        return self._tried.setdefault((self.joint.value, self.count.value), {})

    @property
    def keyframes(self) -> NDArray[np.int64]:
        """Frames of the keyframes, spread evenly."""
        count = self.count.value
        return np.unique(np.linspace(0, self.frames - 1, count + 2)[1:-1].round().astype(int))

    @property
    def wish(self) -> Wish:
        """The clip's joint at the keyframes."""
        return pin(
            self.joint.value, self.keyframes, self.clip.joint(self.joint.value)[self.keyframes]
        )

    def try_method(self, name: str) -> Outcome:
        """What a method makes of the present wish; made once."""
        if name not in self.outcomes:
            prior = self._model(self.ways[name])
            start = time.perf_counter()
            motion = self._sample(prior, self.ways[name])
            self.outcomes[name] = Outcome(
                motion, self._numbers(motion, time.perf_counter() - start)
            )
        return self.outcomes[name]

    def try_all(self) -> None:
        """Try every method, and show the table."""
        for name in self.ways:
            self.try_method(name)
        self._show()

    def _model(self, rival: Rival) -> Velocity:
        """What a method samples from; a trained model is loaded when it is first chosen."""
        if rival.model not in self._models:
            own = cast(Prior, self.prior)  # of another kind it has no trained ways
            self._models[rival.model] = LOADERS[rival.model](own)
        return self._models[rival.model]

    def _sample(self, prior: Velocity, rival: Rival) -> Motion:
        common: dict[str, Any] = {"prompt": self.clip.prompt, "frames": self.frames}
        # The same steps for all, and the paper's noise, as in `projflow_lite.studies.control`.
        common |= {"batch": self.batch, "steps": Pace().times(), "solver": "euler"}
        if not rival.method:
            return sample(prior, None, **common)
        options = dict(rival.options) | USUAL.get(rival.method, {})
        return sample(prior, self.wish, method=rival.method, **common, **options)

    def _numbers(self, motion: Motion, seconds: float) -> tuple[float, ...]:
        at = self.keyframes
        missed = motion.joint(self.joint.value)[:, at] - self.clip.joint(self.joint.value)[at]
        x = motion.positions
        return (
            100 * float(np.linalg.norm(missed, axis=-1).mean()),
            float(worst_acceleration(x).mean()),
            100 * float(bone_length_error(x).mean()),
            100 * float(foot_skating(x).mean()),
            seconds,
        )

    def _new_wish(self, change: dict[str, Any]) -> None:
        self.viewer.trail = self.joint.value
        self._show()

    def _show(self, change: dict[str, Any] | None = None) -> None:
        motion = self.try_method(self.method.value).motion
        first = Motion(motion.positions[0], self.clip.prompt, self.wish)
        self.viewer.show(first, self.clip, names=[self.method.value, "the clip"])
        self.table.value = table(self.outcomes, self.method.value)


def table(outcomes: dict[str, Outcome], chosen: str) -> str:
    """The numbers of the methods tried, as HTML; the chosen one bold."""
    head = "".join(f'<th style="text-align: right; padding: 2px 8px">{c}</th>' for c in COLUMNS)
    lines = []
    for name in (name for name in WAYS if name in outcomes):
        weight = "bold" if name == chosen else "normal"
        cells = "".join(
            f'<td style="text-align: right; padding: 2px 8px">{number:.1f}</td>'
            for number in outcomes[name].numbers
        )
        label = f'<td style="white-space: nowrap">{html.escape(name)}</td>'
        lines.append(f'<tr style="font-weight: {weight}">{label}{cells}</tr>')
    return f'<table style="line-height: 1.4"><tr><th></th>{head}</tr>{"".join(lines)}</table>'
