"""Watch the tiny flow learn: the loss as it falls, and what it would answer by now.

The steps are made in a thread. The kernel stays free meanwhile: sliders move, other cells run, and
the button stops the training between two steps.
"""

from __future__ import annotations

import atexit
import threading
import time
from contextlib import closing
from pathlib import Path

import ipywidgets as widgets
import numpy as np
import torch
from numpy.typing import NDArray

from data_synth import held_out
from projflow_lite.motion import Motion
from projflow_lite.prior.loss import loss_of
from projflow_lite.prior.loss_log import read_loss
from projflow_lite.prior.model import Prior
from projflow_lite.prior.training import Recipe, begin, finish, steps_of
from projflow_lite.widgets.answering import status_line
from projflow_lite.widgets.board import Board
from projflow_lite.widgets.viewer import Viewer

CLIPS = 68
"""Held-out clips on which the loss is measured: two of each action."""

DRAW_EVERY = 0.3
"""Seconds between two pictures of the curve."""

WINDOW = 25
"""Steps over which the loss is smoothed."""

_RUNNING: dict[Path, TrainingWatch] = {}


class TrainingWatch(widgets.VBox):
    r"""Trains a prior and shows it learning.

    Left the loss of every step, smoothed, and the loss of the averaged network on held-out clips
    with noise that never changes. Right what that network takes for the clean motion,
    :math:`\hat x_1`, when it is shown one held-out clip under one fixed noise; the slider sets how
    much of the clip it sees.

    Args:
        recipe: what to train.
        folder: where the run is stored, see `projflow_lite.prior.training.train`. A folder that
            holds an interrupted run of this recipe is gone on with.
        prompt: the clip to show: the first held-out one whose caption has these words.
        every: steps between two looks at the held-out clips.
        frames: length of the held-out clips; by default the commonest of the recipe.
        height: of the pictures, pixels.

    Raises:
        ValueError: if the folder holds a damaged run or one of another recipe, or if no held-out
            caption has the words of the prompt.

    ``.losses`` and ``.held_out`` are the curves, ``(n, 2)`` steps made and loss; ``.prior`` is the
    averaged network of the last look, ``.clip`` the clip that is shown and ``.prompt`` its caption;
    ``.error`` is what went wrong last.
    """

    def __init__(
        self,
        recipe: Recipe,
        folder: str | Path,
        prompt: str = "waves with the left hand",
        every: int = 20,
        frames: int | None = None,
        height: int = 360,
    ) -> None:
        if every < 1:
            raise ValueError(f"TrainingWatch: every is {every} steps, expected 1 or more")
        self.folder, self.every = Path(folder).resolve(), every
        halt(self.folder)  # the cell was run again: the older watch must let go of the files
        self.trainer = begin(recipe, self.folder)
        self.error: Exception | None = None
        self._thread: threading.Thread | None = None
        self._stop, self._lock = threading.Event(), threading.Lock()
        frames = frames or max(recipe.lengths, key=recipe.lengths.count)
        self._choose_clips(frames, prompt)
        log = self.folder / "loss.jsonl"
        self._losses = read_loss(log).tolist() if log.exists() else []
        self._held_out: list[tuple[int, float]] = []
        self._make_parts(height)
        super().__init__(self._rows())
        self._look()
        self._draw()

    def _choose_clips(self, frames: int, prompt: str) -> None:
        """Prepare the held-out clips, and the one to show with its noise."""
        clips, prior = held_out(5 * CLIPS, frames), self.trainer.prior
        places = [i for i, caption in enumerate(clips.captions) if prompt in caption]
        if not places:
            raise ValueError(
                f"TrainingWatch: no held-out clip is called '{prompt}'; "
                f"one is called '{clips.captions[0]}'"
            )
        self.prompt = clips.captions[places[0]]
        self.clip = Motion(clips.positions[places[0]].astype(float), self.prompt)
        self._x1 = torch.as_tensor(clips.positions[places[0]])[None]
        random = torch.Generator().manual_seed(0)
        self._noise = prior.noise_std * torch.randn(self._x1.shape, generator=random)
        self._u1 = (torch.as_tensor(clips.positions[:CLIPS]) - prior.mean) / prior.noise_std
        self._ids = prior.vocabulary.encode(clips.captions[:CLIPS])

    def _make_parts(self, height: int) -> None:
        steps = self.trainer.recipe.steps
        self.board = Board(
            x=(0, 1.04 * max(steps, 1)),  # room for the last number below the axis
            labels=("steps made", "log₁₀ of the loss"),
            height=height,
            equal=False,
            layout=widgets.Layout(flex="3 1 340px", min_width="300px"),
        )
        self.viewer = Viewer(
            height=height - 70, layout=widgets.Layout(flex="1 1 auto", width="100%")
        )
        self.t = widgets.FloatSlider(
            value=0.5, min=0.0, max=0.95, step=0.05, description="t", readout_format=".2f"
        )
        self.t.layout = widgets.Layout(width="98%")
        self.t.style.description_width = "20px"
        self.t.observe(lambda change: self._show_guess(), "value")
        self.button = widgets.Button(layout=widgets.Layout(width="110px"))
        self.button.on_click(lambda button: self.stop() if self.running else self.start())
        self.status = widgets.HTML()

    def _rows(self) -> list[widgets.Widget]:
        """Button and status above; the curve and the body side by side, or below each other."""
        body = widgets.VBox(
            [self.viewer, self.t], layout=widgets.Layout(flex="2 1 300px", min_width="290px")
        )
        wrap = widgets.Layout(flex_flow="row wrap", width="100%", grid_gap="4px 10px")
        head = widgets.HBox([self.button, self.status], layout=widgets.Layout(grid_gap="0 10px"))
        return [head, widgets.Box([self.board, body], layout=wrap)]

    @property
    def losses(self) -> NDArray[np.float64]:
        """Steps made and the loss of the last of them, ``(n, 2)``."""
        return np.array(self._losses, float).reshape(-1, 2)

    @property
    def held_out(self) -> NDArray[np.float64]:
        """Steps made and the loss on held-out clips, ``(n, 2)``."""
        return np.array(self._held_out, float).reshape(-1, 2)

    @property
    def running(self) -> bool:
        """Whether steps are being made."""
        return self._thread is not None and self._thread.is_alive() and not self._stop.is_set()

    def start(self) -> TrainingWatch:
        """Begin, or go on where it was stopped; returns at once."""
        if not self.running:
            halt(self.folder)
            self._stop.clear()
            self.error = None
            self._thread = threading.Thread(target=self._learn, daemon=True)
            _RUNNING[self.folder] = self
            self._thread.start()
        return self

    def stop(self) -> None:
        """Ask for an end after the step that is being made; the run is stored."""
        self._stop.set()

    def wait(self) -> Prior:
        """Wait until the training has ended or was stopped.

        Interrupting the kernel stops the training, as the button does.

        Returns:
            The prior of this moment.

        Raises:
            Exception: what went wrong in training, if anything did.
        """
        try:
            while self._thread is not None and self._thread.is_alive():
                self._thread.join(0.1)
        except KeyboardInterrupt:
            self.stop()
            if self._thread is not None:
                self._thread.join()
        if self.error is not None:
            raise self.error
        return self.prior

    def _learn(self) -> None:
        """What the thread does: steps, and pictures of them."""
        self._begun, self._from = time.monotonic(), self.trainer.step
        drawn = 0.0
        try:
            with closing(steps_of(self.trainer, self.folder)) as steps:
                for loss in steps:
                    self._losses.append((self.trainer.step, loss))
                    if self.trainer.step % self.every == 0:
                        self._look()
                    if time.monotonic() - drawn > DRAW_EVERY:
                        self._draw(busy=True)
                        drawn = time.monotonic()
                    if self._stop.is_set():
                        break
            if self.done:
                finish(self.trainer, self.folder)
            self._look()
        except Exception as error:  # anything at all: a traceback would vanish in a log
            self.error = error
        _RUNNING.pop(self.folder, None)
        self._draw()

    @property
    def done(self) -> bool:
        """Whether all steps of the recipe have been made."""
        return self.trainer.step >= self.trainer.recipe.steps

    def _look(self) -> None:
        """Measure the averaged network on held-out clips, and ask it for its guess."""
        self.prior = self.trainer.result()
        with torch.no_grad():
            random = torch.Generator().manual_seed(0)
            loss = float(loss_of(self.prior.network, self._u1, self._ids, random))
        if not self._held_out or self._held_out[-1][0] < self.trainer.step:
            self._held_out.append((self.trainer.step, loss))
        self._show_guess()

    def guess(self, t: float) -> NDArray[np.float64]:
        r"""What the network takes for the clean motion now, ``(frames, 22, 3)`` metres.

        Args:
            t: flow time; the clip counts for a share of t, its noise for the rest.
        """
        x_t = (1 - t) * self._noise + t * self._x1
        with torch.no_grad():
            return self.prior.endpoint(x_t, t, self.prompt)[0].double().numpy()

    def _show_guess(self) -> None:
        with self._lock:  # the slider and the training may ask at once
            t = self.t.value
            names = [f"x̂₁ at t = {t:.2f}", "the clip"]
            self.viewer.show(Motion(self.guess(t), self.prompt), self.clip, names=names)

    def _draw(self, busy: bool = False) -> None:
        """Bring curve, button and status up to date."""
        losses, held = self.losses, self.held_out
        with self.board.hold():
            if len(losses):
                thin = losses[:: max(1, len(losses) // 600)]
                self.board.points("every step", logarithm(thin), "quiet", 1.5, 0.5, "every step")
                self.board.line("loss", logarithm(smoothed(losses)), "flow", 2, label="smoothed")
            self.board.line("held out", logarithm(held), "prediction", 2, label="held out")
            self.board.points("looks", logarithm(held), "prediction", 2.5, 0.9)
            every = np.log10(np.concatenate([losses[:, 1], held[:, 1]]).clip(1e-9))
            low, high = np.floor(2 * every.min()) / 2, np.ceil(2 * every.max()) / 2
            self.board.y = [float(low), float(max(high, low + 0.5))]
        label = (
            "Done" if self.done else "Stop" if busy else "Go on" if self.trainer.step else "Start"
        )
        self.button.description = label
        self.button.icon = {"Done": "check", "Stop": "stop"}.get(label, "play")
        self.button.disabled = self.done
        kind = "pf-bad" if self.error else "pf-busy" if busy else ""
        self.status.value = status_line(self._report(busy), kind)

    def _report(self, busy: bool) -> str:
        """One line: how far it is, how well it does, how long it will take."""
        if self.error is not None:
            return f"error: {self.error}"
        step, steps = self.trainer.step, self.trainer.recipe.steps
        parts = [f"step {step} of {steps}"]
        if self._losses:
            parts.append(f"loss {smoothed(self.losses)[-1, 1]:.3f}")
        parts.append(f"held out {self._held_out[-1][1]:.3f}")
        if busy and step > self._from:
            rate = (step - self._from) / (time.monotonic() - self._begun)
            seconds = (steps - step) / rate
            left = f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min"
            parts.append(f"{rate:.1f} steps/s, {left} left")
        return " · ".join(parts)


def halt(folder: Path) -> None:
    """Stop whoever is training in a folder, and wait until it has stored its run."""
    watch = _RUNNING.pop(folder, None)
    if watch is not None and watch._thread is not None:
        watch.stop()
        watch._thread.join()


@atexit.register
def halt_all() -> None:
    """Let no run be cut off in the middle of a step when the kernel ends."""
    for folder in list(_RUNNING):
        halt(folder)


def logarithm(curve: NDArray[np.float64]) -> NDArray[np.float64]:
    """A curve of positive numbers, ``(n, 2)``, with the logarithm to base 10 of the second."""
    return np.column_stack([curve[:, 0], np.log10(curve[:, 1].clip(1e-9))])


def smoothed(curve: NDArray[np.float64], window: int = WINDOW) -> NDArray[np.float64]:
    """Geometric mean of each number of a curve, ``(n, 2)``, and those before it in a window."""
    sums = np.cumsum(np.log(curve[:, 1].clip(1e-9)))
    sums[window:] -= sums[:-window].copy()
    return np.column_stack(
        [curve[:, 0], np.exp(sums / np.minimum(window, 1 + np.arange(len(sums))))]
    )
