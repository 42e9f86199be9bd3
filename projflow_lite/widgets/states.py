"""The state of a notebook's widgets as a page holds it: taken, compared and weighed."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import ipywidgets as widgets
import numpy as np

from projflow_lite.widgets.controls import Control

State = dict[str, dict[str, Any]]
"""``{model id: {trait: value}}``."""

FRONT_END = {"drag", "seen", "_esm", "_css", "_anywidget_id", "comm", "keys", "_dom_classes"}
"""What the page itself owns, or what never changes."""


def snapshot(present: Iterable[widgets.Widget]) -> State:
    """The state of every widget as a page would hold it."""
    return {widget.model_id: state_of(widget) for widget in present}


def state_of(widget: widgets.Widget) -> dict[str, Any]:
    """The synced traits; of a plotly figure the whole figure, as JSON."""
    if hasattr(widget, "to_plotly_json"):
        return {"figure": widget.to_json()}
    state = {name: value for name, value in widget.get_state().items() if name not in FRONT_END}
    if "handles" in state:  # "led" says only who moved it last
        state["handles"] = [handle | {"led": True} for handle in state["handles"]]
    return state


def difference(start: State, now: State, control: Control | None = None) -> State:
    """What is not as it was at the start, apart from the control's own place."""
    changed: State = {}
    for model in now.keys() & start.keys():
        own = control.own if control and model == control.widget.model_id else ()
        new = {
            name: value
            for name, value in now[model].items()
            if name not in own and not same(start[model].get(name), value)
        }
        if new:
            changed[model] = new
    return changed


def same(first: Any, second: Any) -> bool:
    """Whether two values are equal but for the rounding of numbers."""
    if isinstance(first, bytes | memoryview) and isinstance(second, bytes | memoryview):
        a, b = bytes(first), bytes(second)
        if a == b or len(a) != len(b) or len(a) % 4:
            return a == b
        numbers = np.frombuffer(a, "<f4"), np.frombuffer(b, "<f4")
        return np.allclose(*numbers, rtol=1e-5, atol=1e-6, equal_nan=True)
    if isinstance(first, float) and isinstance(second, float):
        return first == second or math.isclose(first, second, rel_tol=1e-9, abs_tol=1e-9)
    if isinstance(first, list | tuple) and isinstance(second, list | tuple):
        return len(first) == len(second) and all(map(same, first, second))
    if isinstance(first, dict) and isinstance(second, dict):
        return first.keys() == second.keys() and all(same(first[k], second[k]) for k in first)
    return bool(first == second)


def weight(answer: State, start: State) -> int:
    """About how many bytes an answer takes in the page: numbers that changed, and texts."""
    total = 0
    for model, traits in answer.items():
        for name, value in traits.items():
            if isinstance(value, bytes | memoryview):
                total += 4 * len(changed_numbers(start[model].get(name), value))
            else:
                total += len(repr(value))
    return total


def changed_numbers(before: Any, after: bytes | memoryview) -> np.ndarray:
    """Indices of the float32 that changed; all of them if the number of numbers did."""
    old, new = bytes(before or b""), bytes(after)
    if len(old) != len(new):
        return np.arange(len(new) // 4)
    return np.flatnonzero(np.frombuffer(old, "<u4") != np.frombuffer(new, "<u4"))
