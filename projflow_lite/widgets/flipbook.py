"""A flipbook: what widgets show at each place of a slider, turned by the page with no question."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import Any

import anywidget
import ipywidgets as widgets
import traitlets

from projflow_lite.widgets.front_end import module

Page = dict[widgets.Widget, dict[str, Any]]
"""The traits of each widget that are not the same on every page, as they travel."""


class Flipbook(anywidget.AnyWidget):
    """A line of words, and a slider that shows what was drawn before.

    Everything is drawn once for each place of the slider, and the page keeps it. While the slider
    moves, no message goes to Python and back before the picture: only the slider's own place does,
    and the widgets in Python follow it in silence.

    Args:
        slider: goes from 0 to the last page.
        shown: the widgets that `draw` changes.
        draw: called as ``draw(k)`` for every page; returns its line of words.
    """

    _esm = module("theme.js", "flipbook.js")
    _css = module("widgets.css")

    words = traitlets.Unicode("").tag(sync=True, echo_update=False)
    slider = traitlets.Unicode("").tag(sync=True)

    def __init__(
        self,
        slider: widgets.IntSlider,
        shown: Sequence[widgets.Widget],
        draw: Callable[[int], str],
        **traits: Any,
    ) -> None:
        super().__init__(slider=slider.model_id, **traits)
        self._slider, self._shown, self._draw = slider, [*shown, self], draw
        self._opened = False  # whether a page asked for the pages
        self.pages: list[Page] = []
        self.redraw()
        self.on_msg(self._heard)
        slider.observe(lambda change: self.turn(), "value")

    def redraw(self) -> None:
        """Draw all pages anew, the one that is shown last: only that one is sent as usual."""
        with ExitStack() as stack:
            for widget in self._shown:
                stack.enter_context(widget.hold_sync())
            taken = [self._take(k) for k in range(self._slider.max + 1)]
            self._take(self._slider.value)
        kept = {widget: changing(taken, widget) for widget in self._shown}
        self.pages = [
            {widget: {name: page[widget][name] for name in names} for widget, names in kept.items()}
            for page in taken
        ]
        if self._opened:
            self._send_pages()

    def turn(self) -> None:
        """Put the widgets to the slider's place: in silence if the page has done so itself."""
        for widget, state in self.pages[self._slider.value].items():
            if self._opened:
                widget.set_state(state)  # as if the page had told it
            else:
                with widget.hold_sync():
                    for name, value in state.items():
                        widget.set_trait(name, value)

    def _take(self, k: int) -> Page:
        self.words = self._draw(k)
        return {widget: widget.get_state() for widget in self._shown}

    def _heard(self, widget: Any, content: dict[str, Any], buffers: list[Any]) -> None:
        if content.get("type") == "open":
            self._opened = True
            self._send_pages()

    def _send_pages(self) -> None:
        """Bytes travel beside the JSON; where they belong stands their number."""
        buffers: list[bytes] = []

        def plain(value: Any) -> Any:
            if not isinstance(value, bytes):
                return value
            buffers.append(value)
            return {"buffer": len(buffers) - 1}

        def written(page: Page) -> dict[str, dict[str, Any]]:
            return {
                widget.model_id: {name: plain(value) for name, value in state.items()}
                for widget, state in page.items()
            }

        self.send({"pages": [written(page) for page in self.pages]}, buffers)


def changing(pages: Sequence[Page], widget: widgets.Widget) -> list[str]:
    """The traits of a widget that differ between pages."""
    first = pages[0][widget]
    return [name for name in first if any(page[widget][name] != first[name] for page in pages)]
