"""What can be moved in a notebook, and to which places: sliders, menus, boxes, handles.

Not buttons: a click may start anything, a training for example.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import ipywidgets as widgets
import numpy as np
import traitlets

from projflow_lite.widgets.board import Board

Stop = Any
"""A place of a control: a value, an index, or ``(x, y)`` of a handle."""

MOST = 21  # places of a slider
LATTICES = ((15, 11), (11, 9), (9, 7), (7, 5))  # places of a handle that moves in the plane
ALONG = 17  # places of a handle that moves along an axis
NUMBERS = (widgets.IntSlider, widgets.FloatSlider, widgets.FloatLogSlider)
CHOICES = (widgets.Dropdown, widgets.SelectionSlider, widgets.RadioButtons, widgets.ToggleButtons)
MOVABLE = (*NUMBERS, *CHOICES, widgets.Checkbox, widgets.ToggleButton)


@dataclass
class Control:
    """One thing that a hand can move.

    Attributes:
        widget: the widget it belongs to.
        trait: the trait that moves, or the name of a board's handle.
        stops: the places.
        home: the place where it was found.
        move: function that puts it to a place, as the page would.
        own: traits that say where it is.
        axes: for a handle, the coordinates of the lattice along x and along y.
    """

    widget: widgets.Widget
    trait: str
    stops: list[Stop]
    home: Stop
    move: Callable[[Stop], Any]
    own: tuple[str, ...] = ()
    axes: tuple[list[float], list[float]] = field(default=([], []))

    @property
    def is_plane(self) -> bool:
        """Whether the places fill a plane: then all of them are needed."""
        return len(self.axes[0]) > 1 and len(self.axes[1]) > 1

    def coarser(self) -> Control | None:
        """The same handle with fewer places, or None if there are few already."""
        sizes = [size for size in LATTICES if size[0] < len(self.axes[0])]
        if not sizes:
            return None
        return replace(self, **lattice(self.widget, None, self.home, sizes[0]))


def controls_of(present: Iterable[widgets.Widget]) -> Iterator[Control]:
    """Every control among the widgets whose moves Python hears and whose places can be listed."""
    for widget in present:
        if not calls_python(widget):
            continue
        if isinstance(widget, Board):
            yield from (handle_of(widget, name) for name in widget.positions)
        elif (stops := stops_of(widget)) is not None:
            trait = "index" if isinstance(widget, CHOICES) else "value"
            yield Control(
                widget, trait, stops, home=getattr(widget, trait),
                move=partial(setattr, widget, trait), own=("value", "index"),
            )  # fmt: skip


def calls_python(widget: widgets.Widget) -> bool:
    """Whether a change in the page would call a function in the kernel."""
    notifiers: dict[str, dict[str, list[Any]]] = widget._trait_notifiers
    listeners = [each for kinds in notifiers.values() for kind in kinds.values() for each in kind]
    # What a class itself observes is wrapped; what a notebook observes is a plain function.
    outside = any(not isinstance(listener, traitlets.EventHandler) for listener in listeners)
    clicked = bool(getattr(getattr(widget, "_click_handlers", None), "callbacks", ()))
    return outside or clicked or bool(getattr(widget, "_listeners", ()))


def stops_of(widget: widgets.Widget) -> list[Stop] | None:
    """The places of a slider, menu or box; None for another widget."""
    if isinstance(widget, widgets.Checkbox | widgets.ToggleButton):
        return [False, True]
    if isinstance(widget, CHOICES):
        return list(range(len(widget.options)))
    if isinstance(widget, NUMBERS):
        return sorted({*spread_over(widget), widget.value})
    return None


def spread_over(slider: widgets.Widget) -> list[float]:
    """Places evenly over a slider's range; over its exponents if it is logarithmic."""
    count = round((slider.max - slider.min) / slider.step) + 1
    every = [slider.min + k * slider.step for k in thinned(count)]
    if isinstance(slider, widgets.FloatLogSlider):
        return [slider.base**exponent for exponent in every]
    return [round(v) if isinstance(slider, widgets.IntSlider) else round(v, 9) for v in every]


def thinned(count: int, most: int = MOST) -> list[int]:
    """At most so many of 0 … count - 1, evenly, both ends among them."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int)).tolist()


def coarse_to_fine(count: int) -> list[int]:
    """0 … count - 1 in an order that covers the whole range early, should time run out."""
    order: list[int] = [0, count - 1] if count > 1 else [0]
    step = count
    while len(order) < count:
        step = max(1, step // 2)
        order += [k for k in range(0, count, step) if k not in order]
    return order


def handle_of(board: Board, name: str) -> Control:
    """A handle of a board."""
    along = next(handle["along"] for handle in board.handles if handle["name"] == name)
    home = board.positions[name]

    def drag(stop: Sequence[float]) -> None:
        board.drag = {"moves": {name: [*stop, board.seen + 1]}}

    places = lattice(board, along, home, LATTICES[0])
    return Control(board, name, home=home, move=drag, **places)


def lattice(
    board: Board, along: str | None, home: Sequence[float], size: tuple[int, int]
) -> dict[str, Any]:
    """Places of a handle over the board, a little inside its edges, through where it is."""
    axes = []
    for axis, (ends, count) in enumerate(zip((board.x, board.y), size, strict=True)):
        margin = 0.02 * (ends[1] - ends[0])
        inside = ends[0] + margin, ends[1] - margin
        fixed = along is not None and along != "xy"[axis]
        axes.append(
            [home[axis]] if fixed else through(home[axis], inside, ALONG if along else count)
        )
    return {"stops": [(x, y) for y in axes[1] for x in axes[0]], "axes": (axes[0], axes[1])}


def through(value: float, ends: tuple[float, float], count: int) -> list[float]:
    """Evenly spread numbers between two ends, the nearest of them moved onto the value."""
    places = np.linspace(*ends, count)
    places[np.abs(places - value).argmin()] = value
    return places.tolist()
