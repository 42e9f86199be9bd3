"""A board with controls below it: what explorers of formulas in the plane share."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import ipywidgets as widgets
import numpy as np
from numpy.typing import ArrayLike, NDArray

from projflow_lite.widgets.board import Board


class BoardExplorer(widgets.VBox):
    """A board, controls below it, and a line of words; drawn anew whenever a hand moves anything.

    A subclass says in `draw` what there is to see, and may use what a handle's move means in
    `moved`. What `draw` refuses with a ValueError is said below the picture, which keeps what was
    drawn until then.

    Args:
        board: with all its handles.
        controls: sliders, menus and boxes; they stand in one row.

    ``.board`` is the picture, ``.words`` the line below it.
    """

    def __init__(self, board: Board, controls: Sequence[widgets.Widget] = ()) -> None:
        self.board, self.words = board, widgets.HTML()
        wrap = widgets.Layout(flex_flow="row wrap", width="100%", grid_gap="0px 10px")
        super().__init__([board, widgets.Box(list(controls), layout=wrap), self.words])
        self.refresh()
        board.on_move(self._heard)
        for control in controls:
            control.observe(self.refresh, "value")

    def draw(self) -> None:
        """Draw everything."""
        raise NotImplementedError

    def moved(self, name: str, position: NDArray[np.float64]) -> None:
        """A handle was moved: called before everything is drawn anew."""

    def place(self, name: str) -> NDArray[np.float64]:
        """Where a handle is, ``(2,)``."""
        return np.array(self.board.positions[name])

    def refresh(self, *_: Any) -> None:
        """Draw everything as one picture, or say why that cannot be."""
        self.board.problem = ""
        try:
            with self.board.hold():
                self.draw()
        except ValueError as error:
            self.board.problem = str(error)

    def _heard(self, name: str, position: tuple[float, float]) -> None:
        self.moved(name, np.array(position))
        self.refresh()


def slider(
    name: str, value: float, low: float, high: float, step: float = 0.01, width: str = "300px"
) -> widgets.FloatSlider | widgets.IntSlider:
    """A slider whose name is never cut off; of whole numbers if `value` is one.

    Args:
        name: stands before it.
        value: to begin with.
        low: its left end.
        high: its right end.
        step: from one place to the next.
        width: as CSS has it.
    """
    kind = widgets.IntSlider if isinstance(value, int) else widgets.FloatSlider
    return kind(
        value=value, min=low, max=high, step=step, description=name,
        layout=widgets.Layout(width=width), style={"description_width": "initial"},
    )  # fmt: skip


def legs(start: ArrayLike, end: ArrayLike) -> NDArray[np.float64]:
    """Straight lines from ``(n, 2)`` to ``(n, 2)`` as one line that lifts its pen between them."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    gap = np.full_like(start, np.nan)
    return np.stack([start, end, gap], axis=1).reshape(-1, 2)
