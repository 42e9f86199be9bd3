"""Answers for a page without a kernel: move every control once, and keep what the others do.

A slider, a menu or a handle of a board may call Python. In a page that is only read there is no
Python, so `record` moves each of them while there is one, from the state the notebook ends in,
and notes what changed. The page plays that back, one control at a time.
"""

from __future__ import annotations

import contextlib
import io
import time
import warnings
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import ipywidgets as widgets

from projflow_lite.widgets.board import Board
from projflow_lite.widgets.controls import (
    MOVABLE,
    Control,
    Stop,
    calls_python,
    coarse_to_fine,
    controls_of,
)
from projflow_lite.widgets.states import State, difference, snapshot, weight
from projflow_lite.widgets.studio import WishStudio

FEWEST = 3  # places below which a control is not worth having
HEAVIEST = 500_000  # bytes that the answers of one control may take in a page
PLACE = ("max", "min", "value", "index")
"""Traits that say where a control is."""


class Recording(NamedTuple):
    """A control, where it was put, and what each place changed."""

    control: Control
    stops: list[Stop]
    answers: list[State]


class Records(NamedTuple):
    """All that a page needs to know.

    Attributes:
        start: state of every widget before anything was moved.
        recordings: one for each control that Python answered.
        silent: ids of widgets that call Python and could not be recorded.
        groups: which widgets stand together; moving one control puts the rest of its group back.
        strayed: what did not come back to the start: the page has to put it there.
    """

    start: State
    recordings: list[Recording]
    silent: list[str]
    groups: dict[str, int]
    strayed: State


def record(present: Sequence[widgets.Widget], seconds: float = 4.0) -> Records:
    """Move every control of the given widgets, and bring each back to where it was.

    Args:
        present: the widgets of a notebook, hidden ones and layouts included.
        seconds: processor time that each control may take; a slow one gets fewer places.
    """
    studios = [widget for widget in present if isinstance(widget, WishStudio)]
    skipped = {widget.model_id for studio in studios for widget in family(studio)}
    start = snapshot(present)
    controls = list(controls_of([w for w in present if w.model_id not in skipped]))
    with quiet(present):
        # The latest first: one that replaces other controls was made before those.
        swept = {
            (control.widget.model_id, control.trait): sweep(control, present, start, seconds)
            for control in reversed(controls)
        }
    recordings = [recording for recording in reversed(swept.values()) if recording is not None]
    answered = {model for model, _ in swept} - {m for (m, _), found in swept.items() if not found}
    silent = {widget.model_id for widget in present if calls_python(widget)} - answered
    strayed = difference(start, snapshot(present))
    return Records(start, recordings, sorted(silent), groups_of(start, recordings), strayed)


def sweep(
    control: Control, present: Sequence[widgets.Widget], start: State, seconds: float
) -> Recording | None:
    """Put one control to its places in turn; None if it is too slow or does not come back."""
    answers = answers_of(control, present, start, seconds)
    go_home(control, present, start)
    if difference(start, snapshot(present), control):
        return None
    if control.is_plane and len(answers) < len(control.stops):
        coarser = control.coarser()
        return None if coarser is None else sweep(coarser, present, start, seconds)
    if len(answers) < min(FEWEST, len(control.stops)):
        return None
    kept = sorted(answers)
    return Recording(control, [control.stops[k] for k in kept], [answers[k] for k in kept])


def answers_of(
    control: Control, present: Sequence[widgets.Widget], start: State, seconds: float
) -> dict[int, State]:
    """What each place changed, by its index; not all of them if they take too long or too much."""
    stops = enumerate(control.stops)
    answers: dict[int, State] = {k: {} for k, stop in stops if stop == control.home}
    begin, size = time.process_time(), 0
    for k in coarse_to_fine(len(control.stops)):
        if k in answers:  # where it stands already nothing changes
            continue
        if put(control, control.stops[k], present, start):
            answers[k] = difference(start, snapshot(present), control)
            if any("children" in traits for traits in answers[k].values()):
                return {}  # no page can build the widgets that this one makes
            size += weight(answers[k], start)
        # A lattice with holes is of no use: there, give up as soon as it will not fit.
        share = max(0.1, len(answers) / len(control.stops)) if control.is_plane else 1.0
        if time.process_time() - begin > seconds * share or size > HEAVIEST * share:
            break
    return answers


def put(control: Control, stop: Stop, present: Sequence[widgets.Widget], start: State) -> bool:
    """Move a control, all others being where they were; False if the notebook raised an error."""
    try:
        back([widget for widget in present if widget is not control.widget], start)
        handles_back(present, start)
        control.move(stop)
    except Exception:  # anything at all: this place has no answer
        return False
    return True


def go_home(control: Control, present: Sequence[widgets.Widget], start: State) -> None:
    """Put a control back where it was, and then all that its way has moved."""
    with contextlib.suppress(Exception):
        handles_back(present, start)
        control.move(control.home)
        for _ in range(2):  # the first control put back may move one that came before it
            back(present, start)
            handles_back(present, start)


def back(present: Iterable[widgets.Widget], start: State) -> None:
    """Put controls where they were: a notebook may move one when another is moved."""
    for widget in present:
        if isinstance(widget, MOVABLE):
            for name in PLACE:
                was = start[widget.model_id].get(name)
                if was is not None and getattr(widget, name) != was:
                    setattr(widget, name, was)


def handles_back(present: Iterable[widgets.Widget], start: State) -> None:
    """The same for the handles of all boards; nothing is called."""
    for board in present:
        if isinstance(board, Board):
            with board.hold():
                for handle in start[board.model_id]["handles"]:
                    name, at = handle["name"], handle["at"]
                    if tuple(at) != board.positions.get(name):
                        board.handle(name, at, handle["label"], handle["color"], handle["along"])


def family(widget: widgets.Widget) -> list[widgets.Widget]:
    """A widget, its children and theirs."""
    return [widget, *(each for child in getattr(widget, "children", ()) for each in family(child))]


def groups_of(start: State, recordings: Iterable[Recording]) -> dict[str, int]:
    """Number the groups of widgets that stand in one box, or answer the same control."""
    group = {model: {model} for model in start}

    def join(first: str, second: str) -> None:
        if group[first] is not group[second]:
            group[first] |= group[second]
            for member in group[second]:
                group[member] = group[first]

    for model, state in start.items():
        for child in state.get("children", ()):
            join(model, child.removeprefix("IPY_MODEL_"))
    for recording in recordings:
        for model in {model for answer in recording.answers for model in answer}:
            join(recording.control.widget.model_id, model)
    numbers = {id(members): k for k, members in enumerate(group.values())}
    return {model: numbers[id(members)] for model, members in group.items()}


@contextlib.contextmanager
def quiet(present: Iterable[widgets.Widget]) -> Iterator[None]:
    """Keep what is tried out from the front end, from the output, and from the warnings."""
    with contextlib.ExitStack() as stack:
        for widget in present:
            stack.enter_context(widget.hold_sync())
        stack.enter_context(contextlib.redirect_stdout(io.StringIO()))
        stack.enter_context(warnings.catch_warnings())
        warnings.simplefilter("ignore")
        yield
