"""What a page of the book holds of a notebook's widgets and plots."""

from __future__ import annotations

import base64
import json

import numpy as np
import plotly.graph_objects as go
import plotly.io as pio
import pytest

from projflow_lite.widgets import Board, WishStudio
from projflow_lite.widgets.recording import record
from projflow_lite.widgets.static_page import as_json, draw_example, in_script, start


def double(board):
    """Draw a dot at twice the place of the handle."""

    def show(*_):
        board.points("twice", [2 * np.array(board.positions["a"])])

    board.handle("a", (0.5, -0.25))
    board.on_move(show)
    show()


def decode(stored, start, blobs):
    """What the page makes of a stored array."""
    if "blob" in stored:
        return np.frombuffer(base64.b64decode(blobs[stored["blob"]]), "<f4")
    copy = start.copy()
    copy[np.frombuffer(base64.b64decode(stored["at"]), "<u4")] = np.frombuffer(
        base64.b64decode(stored["is"]), "<f4"
    )
    return copy


@pytest.mark.parametrize("cloud", [3, 400])
def test_stored_arrays_read_back_as_they_were(cloud):
    board = Board()
    board.points("cloud", np.random.default_rng(0).normal(size=(cloud, 2)))
    double(board)
    records = record([board])
    page = json.loads(json.dumps(as_json(records)))
    start = decode(page["start"][board.model_id]["data"], None, page["blobs"])
    np.testing.assert_array_equal(start, np.frombuffer(board.data, "<f4"))
    (stored,), (recording,) = page["recordings"], records.recordings
    for answer, kept in zip(stored["answers"], recording.answers, strict=True):
        if board.model_id in kept:
            wanted = np.frombuffer(kept[board.model_id].get("data", board.data), "<f4")
            got = decode(answer[board.model_id]["data"], start, page["blobs"])
            np.testing.assert_array_equal(got, wanted)
    # Two numbers of many changed: the answers must not repeat the cloud.
    if cloud == 400:
        assert len(json.dumps(stored["answers"])) < len(recording.answers) * 400


def test_data_in_a_page_cannot_end_its_script():
    text = json.dumps({"label": "</script><!-- x"})
    kept = in_script(text)
    assert "</" not in kept
    assert "<!--" not in kept
    assert json.loads(kept) == json.loads(text)


@pytest.fixture
def renderers():
    """Plotly's renderers, put back after the test."""
    before = pio.renderers.default
    yield pio.renderers
    pio.renderers.default = before


def test_a_plot_becomes_plain_data_that_asks_for_nothing(renderers):
    start()
    figure = go.Figure(go.Scatter(x=[1, 2], y=[3, 4], name="</script>"))
    html = renderers[renderers.default].to_mimebundle(figure.to_dict())["text/html"]
    assert html.count("</script>") == 1
    assert "http" not in html
    data = html[html.index(">{") + 1 : html.index("</script>")]
    assert json.loads(data)["data"][0]["y"] == [3, 4]


def test_the_example_of_a_studio_is_one_run_inside_its_pad():
    wishes = []
    studio = WishStudio(lambda *wish: wishes.append(wish))
    draw_example(studio)
    (low, high) = np.array(studio.pad.bounds).reshape(2, 2).T
    assert len(wishes) == 1
    assert np.all((studio.pad.path >= low) & (studio.pad.path <= high))
