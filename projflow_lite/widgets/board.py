"""The board: a plane with clouds, lines, ellipses, and handles that call Python when dragged."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from types import MappingProxyType
from typing import Any

import anywidget
import numpy as np
import traitlets
from ipywidgets import Layout
from numpy.typing import ArrayLike, NDArray

from projflow_lite.widgets.front_end import float_bytes, module, pack

ROLES = ("data", "noise", "wish", "prediction", "projected", "flow", "quiet")
"""What a colour stands for; the theme says which colour that is."""

Move = Callable[[str, tuple[float, float]], Any]

AROUND = (60, 52)  # pixels that the numbers and names of the axes take, as in board_axes.js


class Board(anywidget.AnyWidget):
    """A plane with things to look at and handles to drag.

    Args:
        x: left and right end of the plane.
        y: lower and upper end of the plane.
        labels: names of the two axes.
        title: a short heading.
        height: height of the picture in pixels.
        equal: whether one unit is as long across as it is up; ellipses then keep their shape.
        traits: anything else a widget takes, ``layout`` for example.

    Raises:
        ValueError: if a range is not two finite numbers that grow, or the height not positive.

    Every drawing method replaces the layer of the same name, in its place in the order of drawing.
    A `label` puts the layer into the legend. Handles have names of their own.
    """

    _esm = module("theme.js", "board_axes.js", "board_layers.js", "board.js")
    _css = module("widgets.css")

    x = traitlets.List(traitlets.Float()).tag(sync=True)
    y = traitlets.List(traitlets.Float()).tag(sync=True)
    labels = traitlets.List(traitlets.Unicode()).tag(sync=True)
    title = traitlets.Unicode("").tag(sync=True)
    height = traitlets.Int(420).tag(sync=True)
    equal = traitlets.Bool(True).tag(sync=True)

    layers: traitlets.List = traitlets.List().tag(sync=True, echo_update=False)
    data = float_bytes()
    handles: traitlets.List = traitlets.List().tag(sync=True)
    # From the page: {"moves": {name: [x, y, count]}}; `seen` is the highest count that was heard.
    # The answer tells where the handles are, so an echo would only be one message more.
    drag: traitlets.Dict = traitlets.Dict().tag(sync=True, echo_update=False)
    seen = traitlets.Int(0).tag(sync=True)
    problem = traitlets.Unicode("").tag(sync=True)

    def __init__(
        self,
        x: Sequence[float] = (-3, 3),
        y: Sequence[float] = (-3, 3),
        labels: Sequence[str] = ("x", "y"),
        title: str = "",
        height: int = 420,
        equal: bool = True,
        **traits: Any,
    ) -> None:
        across, up = _range("x", x), _range("y", y)
        if height < 100:
            raise ValueError(f"Board: height is {height} pixels, expected 100 or more")
        if len(labels) != 2:
            raise ValueError(f"Board: labels needs two names, got {len(labels)}")
        if equal and "layout" not in traits:
            scale = (height - AROUND[1]) / (up[1] - up[0])
            width = round(scale * (across[1] - across[0])) + AROUND[0]
            traits["layout"] = Layout(width=f"{width}px", max_width="100%")
        self._drawn: dict[str, tuple[dict[str, Any], NDArray]] = {}
        self._handles: dict[str, dict[str, Any]] = {}
        self._listeners: list[Move] = []
        self._held = 0
        super().__init__(
            x=across, y=up, labels=list(labels), title=title, height=height, equal=equal, **traits
        )

    def __repr__(self) -> str:
        # Jupyter shows this text where the front end did not start.
        return f"Board: {self.title or 'a plane'}. No picture? Rerun the cell."

    @property
    def positions(self) -> Mapping[str, tuple[float, float]]:
        """Where each handle is now, ``{name: (x, y)}``; `handle` moves one."""
        return MappingProxyType({name: (*handle["at"],) for name, handle in self._handles.items()})

    def handle(
        self,
        name: str,
        position: ArrayLike,
        label: str | None = None,
        color: str = "wish",
        along: str | None = None,
    ) -> None:
        """Put a dot that can be dragged, or move the one of this name.

        Called for a handle while it is dragged, the handle goes where Python puts it rather than
        where the pointer is: on a line, on a circle.

        Args:
            name: what `positions` and `on_move` call it.
            position: ``(x, y)``.
            label: what the picture calls it; by default its name.
            color: a role.
            along: ``"x"`` or ``"y"`` if it moves along that axis only.

        Raises:
            ValueError: for a position, role or axis that does not exist.
        """
        if along not in (None, "x", "y"):
            raise ValueError(f"Board.handle: along is {along!r}, expected 'x', 'y' or None")
        at = _array("handle", "position", position, (2,)).tolist()
        before = self._handles.get(name)
        led = before is not None and before["at"] != at
        self._handles[name] = {
            "name": name,
            "at": at,
            "label": name if label is None else label,
            "color": _role("handle", color),
            "along": along,
            "led": led,
        }
        self._publish()

    def points(
        self,
        name: str,
        xy: ArrayLike,
        color: str = "data",
        size: float = 3,
        opacity: float = 0.5,
        label: str = "",
    ) -> None:
        """Draw a cloud of dots.

        Args:
            name: of the layer.
            xy: ``(n, 2)``.
            color: a role.
            size: radius of a dot, pixels.
            opacity: from 0, unseen, to 1.
            label: words for the legend.

        Raises:
            ValueError: for another shape, a value that is not finite, or an unknown role.
        """
        style = {"color": _role("points", color), "size": float(size), "opacity": float(opacity)}
        self._draw("points", name, _array("points", "xy", xy, (None, 2)), label, style)

    def line(
        self,
        name: str,
        xy: ArrayLike,
        color: str = "flow",
        width: float = 2,
        dash: bool = False,
        label: str = "",
    ) -> None:
        """Draw a line through points; a row of NaN lifts the pen.

        Args:
            name: of the layer.
            xy: ``(n, 2)``.
            color: a role.
            width: pixels.
            dash: whether to dash it.
            label: words for the legend.

        Raises:
            ValueError: for another shape, an infinite value, or an unknown role.
        """
        style = {"color": _role("line", color), "width": float(width), "dash": bool(dash)}
        self._draw("line", name, _array("line", "xy", xy, (None, 2), gaps=True), label, style)

    def ellipse(
        self,
        name: str,
        mean: ArrayLike,
        covariance: ArrayLike,
        color: str = "prediction",
        deviations: Sequence[float] = (1, 2),
        label: str = "",
    ) -> None:
        """Draw where a Gaussian has so many standard deviations from its mean.

        Args:
            name: of the layer.
            mean: ``(2,)``.
            covariance: ``(2, 2)``, positive semidefinite; a singular one is drawn as a stroke.
            color: a role.
            deviations: one curve for each.
            label: words for the legend.

        Raises:
            ValueError: for another shape, a value that is not finite, a covariance that is not
                positive semidefinite, or an unknown role.
        """
        mean = _array("ellipse", "mean", mean, (2,))
        C = _array("ellipse", "covariance", covariance, (2, 2))
        variance, axes = np.linalg.eigh(C)
        if not np.allclose(C, C.T, rtol=1e-6, atol=1e-9):
            raise ValueError("Board.ellipse: covariance is not symmetric")
        if variance[0] < -1e-9 * max(abs(variance[1]), 1e-30):
            raise ValueError(
                "Board.ellipse: covariance is not positive semidefinite, "
                f"its smallest eigenvalue is {variance[0]:.3g}"
            )
        half_axes = (axes * np.sqrt(np.maximum(variance, 0))).T
        style = {"color": _role("ellipse", color), "deviations": [float(d) for d in deviations]}
        self._draw("ellipse", name, np.vstack([mean, half_axes]), label, style)

    def arrow(
        self,
        name: str,
        start: ArrayLike,
        end: ArrayLike,
        color: str = "projected",
        label: str = "",
    ) -> None:
        """Draw an arrow.

        Args:
            name: of the layer.
            start: ``(2,)``.
            end: ``(2,)``.
            color: a role.
            label: words for the legend.

        Raises:
            ValueError: for another shape, a value that is not finite, or an unknown role.
        """
        ends = [_array("arrow", "start", start, (2,)), _array("arrow", "end", end, (2,))]
        self._draw("arrow", name, np.vstack(ends), label, {"color": _role("arrow", color)})

    def text(self, name: str, position: ArrayLike, words: str, color: str = "quiet") -> None:
        """Write words, centred at a place.

        Args:
            name: of the layer.
            position: ``(2,)``.
            words: may have several lines.
            color: a role.

        Raises:
            ValueError: for another shape, a value that is not finite, or an unknown role.
        """
        at = _array("text", "position", position, (2,))[None]
        self._draw("text", name, at, "", {"color": _role("text", color), "words": str(words)})

    def remove(self, name: str) -> None:
        """Take away the layer and the handle of this name.

        Raises:
            ValueError: if there is neither.
        """
        if name not in self._drawn and name not in self._handles:
            there = ", ".join([*self._drawn, *self._handles]) or "none"
            raise ValueError(f"Board.remove: nothing is called {name!r}; there is {there}")
        self._drawn.pop(name, None)
        self._handles.pop(name, None)
        self._publish()

    def on_move(self, function: Move, remove: bool = False) -> Move:
        """Call ``function(name, (x, y))`` while a handle is dragged.

        What it draws arrives as one picture. While it is busy, later moves replace waiting ones.
        What it raises is shown below the picture.

        Args:
            function: what to call, after those given before.
            remove: stop calling it instead.
        """
        if remove:
            self._listeners.remove(function)
        else:
            self._listeners.append(function)
        return function

    @contextmanager
    def hold(self) -> Iterator[None]:
        """Collect the changes made in this block: they arrive as one picture."""
        with self.hold_sync():
            self._held += 1
            try:
                yield
            finally:
                self._held -= 1
                self._publish()

    def _draw(self, kind: str, name: str, xy: NDArray, label: str, style: dict[str, Any]) -> None:
        self._drawn[name] = ({"name": name, "kind": kind, "label": label, **style}, xy)
        self._publish()

    def _publish(self) -> None:
        """Send what changed: the layers' numbers travel together, as one array of float32."""
        if self._held:
            return
        sizes = [len(xy) for _, xy in self._drawn.values()]
        starts = np.cumsum([0, *sizes]).tolist()
        with self.hold_sync():
            self.layers = [
                style | {"start": start, "count": count}
                for (style, _), start, count in zip(
                    self._drawn.values(), starts, sizes, strict=False
                )
            ]
            self.data = pack(np.vstack([np.empty((0, 2)), *(xy for _, xy in self._drawn.values())]))
            self.handles = [dict(handle) for handle in self._handles.values()]

    @traitlets.observe("drag")
    def _dragged(self, change: dict[str, Any]) -> None:
        """Hear what the page says was moved: each move once, in the order in which they came."""
        moves = sorted(change["new"].get("moves", {}).items(), key=lambda move: move[1][2])
        with self.hold():
            for name, (x, y, count) in moves:
                if count > self.seen and name in self._handles:
                    self._handles[name] |= {"at": [float(x), float(y)], "led": False}
                    self._call(name, (float(x), float(y)))
            self.seen = max([self.seen, *(count for _, (_, _, count) in moves)])

    def _call(self, name: str, position: tuple[float, float]) -> None:
        """Call the listeners; what one raises would vanish in a log, so the page shows it."""
        self.problem = ""
        try:
            for function in tuple(self._listeners):
                function(name, position)
        except Exception as error:
            kind = "" if isinstance(error, ValueError) else f"{type(error).__name__}: "
            self.problem = f"{kind}{error}"


def _range(name: str, ends: Sequence[float]) -> list[float]:
    """Check the two ends of an axis."""
    low_high = np.asarray(ends, float)
    if low_high.shape != (2,) or not np.isfinite(low_high).all() or low_high[0] >= low_high[1]:
        raise ValueError(f"Board: {name} is {ends}, expected two finite numbers (low, high)")
    return low_high.tolist()


def _role(who: str, color: str) -> str:
    """Check the role that a colour stands for."""
    if color not in ROLES:
        raise ValueError(f"Board.{who}: color {color!r} is no role; choose from {', '.join(ROLES)}")
    return color


def _array(
    who: str, what: str, values: ArrayLike, shape: tuple[int | None, ...], gaps: bool = False
) -> NDArray[np.float64]:
    """Check numbers to draw; None in `shape` is any size, and `gaps` allows NaN."""
    array = np.asarray(values, float)
    fits = array.ndim == len(shape) and all(
        want in (None, size) for want, size in zip(shape, array.shape, strict=True)
    )
    if not fits:
        wanted = str(shape).replace("None", "n")
        raise ValueError(f"Board.{who}: {what} has shape {array.shape}, expected {wanted}")
    if np.isinf(array).any() or (not gaps and np.isnan(array).any()):
        raise ValueError(f"Board.{who}: {what} has a value that is not finite")
    return array
