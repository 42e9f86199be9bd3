"""Answers for a page without a kernel: every one is what the notebook's own function says."""

from __future__ import annotations

import ipywidgets as widgets
import numpy as np
import pytest

from projflow_lite.widgets import Board, WishStudio
from projflow_lite.widgets.controls import coarse_to_fine, thinned
from projflow_lite.widgets.recording import record
from projflow_lite.widgets.states import same
from projflow_lite.widgets.static_page import as_json


def square():
    """A slider whose square a text shows: the slider, the text, and a box of both."""
    slider, text = widgets.IntSlider(3, min=0, max=9), widgets.HTML()
    slider.observe(lambda _: setattr(text, "value", str(slider.value**2)), "value")
    text.value = "9"
    return slider, text, widgets.VBox([slider, text])


def test_every_place_of_a_slider_has_its_own_answer():
    slider, text, box = square()
    (recording,) = record([slider, text, box]).recordings
    assert recording.stops == list(range(10))
    for value, answer in zip(recording.stops, recording.answers, strict=True):
        wanted = {} if value == 3 else {text.model_id: {"value": str(value**2)}}
        assert answer == wanted
    assert (slider.value, text.value) == (3, "9")


def test_a_menu_and_a_box_are_recorded_by_what_the_page_sends():
    menu, box, text = widgets.Dropdown(options=["a", "b"]), widgets.Checkbox(), widgets.HTML()

    def show(_):
        text.value = f"{menu.value} {box.value}"

    menu.observe(show, "value")
    box.observe(show, "value")
    show(None)
    first, second = record([menu, box, text]).recordings
    assert (first.control.trait, first.stops) == ("index", [0, 1])
    assert first.answers[1] == {text.model_id: {"value": "b False"}}
    assert (second.control.trait, second.stops) == ("value", [False, True])
    assert second.answers[1] == {text.model_id: {"value": "a True"}}


def test_a_logarithmic_slider_is_recorded_over_its_exponents():
    slider, text = (
        widgets.FloatLogSlider(1.0, base=10, min=-1, max=1, step=0.5),
        widgets.HTML("1.000"),
    )
    slider.observe(lambda _: setattr(text, "value", f"{slider.value:.3f}"), "value")
    (recording,) = record([slider, text]).recordings
    np.testing.assert_allclose(recording.stops, 10.0 ** np.array([-1, -0.5, 0, 0.5, 1]))


def test_a_button_is_never_pressed():
    pressed, button = [], widgets.Button(description="Train")
    button.on_click(pressed.append)
    records = record([button])
    assert pressed == []
    assert records.silent == [button.model_id]


def double(board):
    """Draw a dot at twice the place of the handle."""

    def show(*_):
        board.points("twice", [2 * np.array(board.positions["a"])])

    board.handle("a", (0.5, -0.25))
    board.on_move(show)
    show()


def test_a_handle_is_put_to_a_lattice_through_its_own_place():
    board = Board()
    double(board)
    (recording,) = record([board]).recordings
    across, up = recording.control.axes
    assert 0.5 in across
    assert -0.25 in up
    assert len(recording.stops) == len(across) * len(up)
    for (x, y), answer in zip(recording.stops, recording.answers, strict=True):
        data = answer.get(board.model_id, {}).get("data", board.data)
        np.testing.assert_allclose(np.frombuffer(data, "<f4"), [2 * x, 2 * y], atol=1e-6)
    assert board.positions["a"] == (0.5, -0.25)


def test_every_answer_starts_from_where_the_handles_were():
    angle, board = widgets.IntSlider(0, min=0, max=80, step=10), Board()

    def lay_onto_line(*_):
        unit = np.array([np.cos(np.radians(angle.value)), np.sin(np.radians(angle.value))])
        board.handle("a", unit * (unit @ board.positions["a"]))

    board.handle("a", (1.0, 0.0))
    angle.observe(lay_onto_line, "value")
    (recording,) = record([angle, board]).recordings
    # Laid onto one line after the other, the handle would creep towards the middle.
    for degrees, answer in zip(recording.stops[1:], recording.answers[1:], strict=True):
        cosine = np.cos(np.radians(degrees))
        wanted = [cosine**2, cosine * np.sin(np.radians(degrees))]
        np.testing.assert_allclose(answer[board.model_id]["handles"][0]["at"], wanted, atol=1e-12)


def test_a_control_that_another_one_moves_is_put_back_by_hand():
    """Fewer steps move the slider of the step; more steps do not move it back to where it was."""
    steps, step = widgets.Dropdown(options=[5, 20], value=20), widgets.IntSlider(9, min=0, max=19)
    text = widgets.HTML("9 of 20")

    def rescale(_):
        share = step.value / step.max
        with step.hold_trait_notifications():
            step.max = steps.value - 1
            step.value = round(share * step.max)

    def show(_):
        text.value = f"{step.value} of {steps.value}"

    steps.observe(rescale, "value")
    for control in (steps, step):
        control.observe(show, "value")
    records = record([step, steps, text])
    assert records.silent == []
    assert records.strayed == {}
    by_trait = {recording.control.trait: recording for recording in records.recordings}
    fewer = by_trait["index"].answers[0]
    assert fewer[text.model_id] == {"value": "2 of 5"}
    assert fewer[step.model_id] == {"max": 4, "value": 2}
    assert by_trait["value"].answers[3][text.model_id] == {"value": "3 of 20"}


def test_what_does_not_come_back_is_not_recorded_but_put_right():
    slider, text = widgets.IntSlider(0, min=0, max=3), widgets.HTML("start")
    slider.observe(lambda _: setattr(text, "value", text.value + "!"), "value")
    records = record([slider, text])
    assert records.recordings == []
    assert records.silent == [slider.model_id]
    assert records.start[text.model_id]["value"] == "start"
    assert "!" in records.strayed[text.model_id]["value"]
    assert as_json(records)["start"][text.model_id] == {"value": "start"}


def test_a_control_that_builds_other_widgets_is_silent_and_spoils_none_of_them():
    menu, box, text = widgets.Dropdown(options=["a", "b"]), widgets.VBox(), widgets.HTML()

    def build(_=None):
        slider = widgets.IntSlider(max=4, description=menu.value)
        slider.observe(lambda change: setattr(text, "value", str(change["new"])), "value")
        box.children, text.value = [slider], "0"

    menu.observe(build, "value")
    build()
    (slider,) = box.children
    records = record([menu, box, text, slider])
    (recording,) = records.recordings
    assert recording.control.widget is slider
    assert recording.answers[4] == {text.model_id: {"value": "4"}}
    assert records.silent == [menu.model_id]
    assert as_json(records)["start"][box.model_id]["children"] == [f"IPY_MODEL_{slider.model_id}"]


def test_a_place_at_which_the_notebook_raises_has_no_answer():
    slider, text = widgets.IntSlider(1, min=0, max=5), widgets.HTML("1.0")
    slider.observe(lambda _: setattr(text, "value", str(1 / slider.value)), "value")
    (recording,) = record([slider, text]).recordings
    assert recording.stops == [1, 2, 3, 4, 5]
    assert slider.value == 1


def test_a_slow_slider_gets_fewer_places_all_over_its_range():
    slider, text = widgets.IntSlider(0, min=0, max=20), widgets.HTML()

    def slow(_):
        text.value = str(np.linalg.svd(np.random.default_rng(0).normal(size=(300, 300)))[1][0])

    slider.observe(slow, "value")
    slow(None)
    everything = record([slider, text], seconds=1e9).recordings[0].stops
    few = record([slider, text], seconds=0.0).recordings
    assert everything == list(range(21))
    assert few == []  # two places are not worth having


def test_the_place_where_a_slow_slider_stood_is_among_those_it_gets(monkeypatch):
    clock = iter(range(10_000))  # every look at the clock is a second later
    monkeypatch.setattr("projflow_lite.widgets.recording.time.process_time", lambda: next(clock))
    slider, text = widgets.IntSlider(7, min=0, max=20), widgets.HTML("49")
    slider.observe(lambda _: setattr(text, "value", str(slider.value**2)), "value")
    (recording,) = record([slider, text], seconds=3).recordings
    assert 7 in recording.stops
    assert len(recording.stops) < 21
    assert recording.answers[recording.stops.index(7)] == {}


def test_what_only_moves_in_the_page_needs_no_recording():
    free, board = widgets.IntSlider(), Board()
    board.handle("a", (0, 0))
    records = record([free, board])
    assert (records.recordings, records.silent) == ([], [])


def test_the_studio_stays_silent_and_is_not_run():
    made = []
    studio = WishStudio(lambda *wish: made.append(wish))
    present = [studio, studio.pad, studio.viewer, studio.joint, studio.plane, studio.prompt,
               studio.again, studio.status, *studio.children]  # fmt: skip
    records = record(present)
    assert made == []
    assert records.recordings == []
    assert studio.pad.model_id in records.silent
    assert studio.viewer.model_id not in records.silent


def test_widgets_in_one_box_stand_in_one_group():
    slider, text, box = square()
    other, lonely = widgets.IntSlider(), widgets.VBox([])
    groups = record([slider, text, box, other, lonely]).groups
    assert groups[slider.model_id] == groups[text.model_id] == groups[box.model_id]
    assert len({groups[each.model_id] for each in (slider, other, lonely)}) == 3


@pytest.mark.parametrize("count", [1, 2, 3, 10, 21, 165])
def test_coarse_to_fine_visits_everything_once_and_the_ends_first(count):
    order = coarse_to_fine(count)
    assert sorted(order) == list(range(count))
    assert order[:2] == ([0, count - 1] if count > 1 else [0])
    if count > 8:  # half of them already cover the range
        assert max(np.diff(sorted(order[: count // 2]))) <= count // 2


def test_thinning_keeps_both_ends():
    assert thinned(5) == [0, 1, 2, 3, 4]
    assert thinned(101)[0] == 0
    assert thinned(101)[-1] == 100
    assert len(thinned(101)) == 21


def test_rounding_is_not_a_change_and_a_millimetre_is():
    def pack(*numbers):
        return np.array(numbers, "<f4").tobytes()

    assert same(pack(1.0, np.nan), pack(1.0 + 1e-7, np.nan))
    assert not same(pack(1.0), pack(1.001))
    assert not same(pack(1.0), pack(1.0, 2.0))
    assert same([{"at": [0.1 + 0.2, 1]}], [{"at": [0.3, 1]}])
    assert not same([{"at": [0.301, 1]}], [{"at": [0.3, 1]}])
